#!/usr/bin/env python3
"""Builds the users' site from docs/: Sphinx with MyST, and the header's reference by Doxygen and Breathe.

    build.py WORK OUT

docs/ is written to be read where it lies. So its pages are first staged in WORK: docs/README.md becomes the first page, its headings
and tables become the menu, and links that leave docs/ lead to pages which show the file, with what it links to, or list the folder.
Sphinx then runs with warnings as errors, on missing references, too.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from pygments.lexers import get_lexer_by_name
from pygments.token import Error

import header_filter

SITE = pathlib.Path(__file__).resolve().parent
ROOT = SITE.parents[1]
LINK = re.compile(r"(\[(?:[^\[\]]|\[[^\[\]]*\])*\]\()([^()\s]+)(\))")
FENCE = re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.MULTILINE | re.DOTALL)
PICTURES = {".svg", ".png", ".webp", ".gif"}
LANGUAGES = {".c": "c", ".h": "c", ".cpp": "cpp", ".cu": "cpp", ".def": "c", ".py": "python", ".json": "json",
             ".sh": "sh", ".cmake": "cmake", ".rs": "rust", ".cs": "csharp", ".lua": "lua", ".hpp": "cpp"}
sys.path.append(str(ROOT / "tools"))
from public_headers import public_headers  # noqa: E402

HEADERS = [str(path.relative_to(ROOT)) for path in public_headers(ROOT)]
ELSEWHERE = ["python.md", "bindings.md"]  # pages that the menu has where they are there


class Stage:
    """Where each file of the repository lies among the staged ones."""

    def __init__(self, folder):
        self.folder = folder
        self.waiting, self.done = [], set()

    def place(self, path):
        """The staged file for a file or folder of the repository, which will be there."""
        self.waiting.append(path)
        inside = path.relative_to(ROOT)
        if path.is_dir():
            return self.folder / "source" / inside / "index.md"
        if inside == pathlib.Path("docs/README.md"):
            return self.folder / "index.md"
        if inside.parts[0] == "docs" and (path.suffix == ".md" or path.suffix in PICTURES):
            return self.folder / pathlib.Path(*inside.parts[1:])
        name = inside if path.suffix == ".md" or path.suffix in PICTURES else inside.with_name(inside.name + ".md")
        return self.folder / "source" / name

    def write_all(self):
        while self.waiting:
            path = self.waiting.pop()
            if path in self.done:
                continue
            self.done.add(path)
            target = self.place(path)
            target.parent.mkdir(parents=True, exist_ok=True)
            if path.is_dir():
                target.write_text(self.listing(path, target), encoding="utf-8")
            elif path.suffix in PICTURES:
                shutil.copyfile(path, target)
            elif path.suffix == ".md":
                target.write_text(self.page(path, target), encoding="utf-8")
            else:
                target.write_text(shown(path), encoding="utf-8")

    def page(self, path, target):
        text = path.read_text(encoding="utf-8")
        links = lambda part: LINK.sub(lambda link: link[1] + self.link(path, target, link[2]) + link[3], part)
        out, at = [], 0
        for fence in FENCE.finditer(text):
            out += [links(text[at:fence.start()]), fence[0]]
            at = fence.end()
        text = "".join(out) + links(text[at:])
        return orphan(text) if target.is_relative_to(self.folder / "source") else text

    def link(self, path, target, url):
        if re.match(r"[a-z]+:", url) or url.startswith("#"):
            return url
        name, _, anchor = url.partition("#")
        place = self.place((path.parent / name).resolve())
        return os.path.relpath(place, target.parent) + ("#" + anchor if anchor else "")

    def listing(self, path, target):
        tracked = subprocess.run(["git", "ls-files", "--", path], cwd=ROOT, capture_output=True, text=True)
        files = [ROOT / name for name in tracked.stdout.split()] or [each for each in path.iterdir() if each.is_file()]
        lines = [f"# `{path.relative_to(ROOT)}/`", ""]
        for file in sorted(files):
            name = f"`{file.relative_to(path)}`"
            small = file.suffix in LANGUAGES and file.stat().st_size < 20000 and file.parent == path
            lines.append(f"- [{name}]({os.path.relpath(self.place(file), target.parent)})" if small else f"- {name}")
        return orphan("\n".join(lines) + "\n")


def titled(text, page):
    """Rows of a table that begin with a page's file name, as they do where no site is, begin with its title."""
    def title(link):
        return f"| [{re.search('^# (.+)', (page.parent / link[1]).read_text(encoding='utf-8'), re.MULTILINE)[1]}]({link[1]})"

    return re.sub(r"^\| \[[^\]]+\.md\]\(([^()#]+\.md)\)", title, text, flags=re.MULTILINE)


def orphan(text):
    return "---\norphan: true\n---\n\n" + text


def shown(path):
    text = path.read_text(encoding="utf-8", errors="replace")
    fence = "`" * (1 + max([2, *(len(run) for run in re.findall("`+", text))]))
    return orphan(f"# `{path.relative_to(ROOT)}`\n\n{fence}{language_of(path, text)}\n{text}{fence}\n")


def language_of(path, text):
    """That of its suffix, but plain where Pygments does not know all of it, of which Sphinx would warn."""
    language = LANGUAGES.get(path.suffix, "text")
    kinds = {kind for kind, _ in get_lexer_by_name(language).get_tokens(text)}
    return "text" if Error in kinds else language


def menus(readme):
    """A menu for each heading, of the pages that its lines begin with; README's own table of contents, so to say."""
    listed = []
    for part in re.split(r"^## ", readme, flags=re.MULTILINE)[1:]:
        title, _, body = part.partition("\n")
        pages = [page for page in re.findall(r"^\| \[[^\]]+\]\(([^()#]+\.md)\)", body, flags=re.MULTILINE)
                 if not page.startswith("..")]
        listed.append((title.strip(), pages))
    named = {page for _, pages in listed for page in pages}
    for page in ELSEWHERE:
        if page not in named and (ROOT / "docs" / page).exists():
            listed[0][1].append(page)
    next(pages for _, pages in listed if "parameters.md" in pages).append("api.md")
    toctree = "```{{toctree}}\n:hidden:\n:caption: {}\n\n{}\n```\n"
    entries = lambda pages: "\n".join("notes/README" if page == "notes/README.md" else page[:-3] for page in pages)
    return "\n" + "\n".join(toctree.format(title, entries(pages)) for title, pages in listed if pages)


def reference_of(header):
    """What stands at its head, then a section for each group of declarations."""
    text = (ROOT / header).read_text(encoding="utf-8")
    rules = header_filter.without_stars(text[2:text.index("*/")])
    rules = re.sub(r"^ {2}(\w+) +", r"\n\1\n: ", rules, flags=re.MULTILINE)
    rules = re.sub(r"^ {10,}", "  ", rules, flags=re.MULTILINE).replace("<", "&lt;")
    page = [f"From [`{header}`](source/{header}.md).", "", rules.strip(), ""]
    for title in header_filter.SECTION.findall(text):
        title = title.split(":")[0]
        page += [f"## {title}", "", f"```{{doxygengroup}} {header_filter.slug(title)}", ":content-only:", ":members:", ":undoc-members:", "```", ""]
    return page


def reference():
    """The page of the headers."""
    first, *others = HEADERS
    page = ["# API reference", "", *reference_of(first)]
    for header in others:
        page += [f"## {pathlib.Path(header).name}", "", *reference_of(header)]
    return "\n".join(page)


def run(command, **more):
    done = subprocess.run(command, check=False, **more)
    if done.returncode:
        sys.exit(f"build.py: {command[0]} failed")


def doxygen(work):
    settings = (SITE / "Doxyfile").read_text(encoding="utf-8")
    inputs = " ".join(f'"{ROOT}/{header}"' for header in HEADERS)
    settings += f'INPUT = {inputs}\nOUTPUT_DIRECTORY = "{work}"\n'
    settings += f'INPUT_FILTER = "{sys.executable} {SITE}/header_filter.py"\n'
    run(["doxygen", "-"], input=settings.encode())
    for page in (work / "xml").glob("struct*.xml"):  # Breathe makes a link of it, to nowhere
        text = page.read_text(encoding="utf-8")
        page.write_text(re.sub(r"\s*<includes .*?</includes>", "", text), encoding="utf-8")


def check_weight(out, page, most):
    """What a browser loads for a page, in bytes."""
    text = (out / page).read_text(encoding="utf-8")
    files = set(re.findall(r'<(?:link rel="stylesheet"|script|img)[^>]*? (?:href|src)="([^"?:]+)', text))
    bytes_of = lambda name: (out / name).stat().st_size
    total = bytes_of(page) + sum(bytes_of(name) for name in files)
    if total > most:
        sys.exit(f"build.py: {page} and what it loads have {total} bytes, more than {most}")
    return total


def main(work, out):
    work, out = pathlib.Path(work).resolve(), pathlib.Path(out).resolve()
    for folder in (work / "pages", work / "xml", out):
        shutil.rmtree(folder, ignore_errors=True)
    work.mkdir(parents=True, exist_ok=True)
    doxygen(work)
    stage = Stage(work / "pages")
    for page in sorted(ROOT.glob("docs/**/*.md")):
        stage.place(page)
    for header in HEADERS:
        stage.place(ROOT / header)
    stage.write_all()
    index = stage.folder / "index.md"
    index.write_text(titled(index.read_text(encoding="utf-8"), index) + menus((ROOT / "docs/README.md").read_text(encoding="utf-8")), encoding="utf-8")
    notes = stage.folder / "notes/README.md"
    notes.write_text(notes.read_text(encoding="utf-8") + "\n```{toctree}\n:hidden:\n:glob:\n\n*\n```\n", encoding="utf-8")
    (stage.folder / "api.md").write_text(reference(), encoding="utf-8")
    run([sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-n", "-q", "-j", "auto", "-c", SITE,
         "-d", work / "doctrees", stage.folder, out],
        env={**os.environ, "PBF_DOCS_XML": str(work / "xml")})
    print(f"build.py: the first page has {check_weight(out, 'index.html', 300000) // 1000} KB with all that it loads")
    api = out / "api.html"  # the menu of a page has Doxygen's own names for enums that have none
    api.write_text(re.sub(r">@\d+<", ">constants<", api.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
