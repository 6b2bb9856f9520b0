#!/usr/bin/env python3
"""Checks that what documents and comments refer to exists, without a network.

    links.py ROOT

In Markdown files: the targets of relative links, and their anchors, which are those that GitHub makes of headings; and the
paths in code (`lib/check.h`, `bench/tools/*.py`) that begin with a folder of the root. In all sources: each docs/….md that is
named; in comments of C, C++ and CUDA each source file, by the end of its path (`physics/sleep.h`). In documents with tables
that scripts write: markers come in pairs, each name once. docs/architecture.md names all folders of lib/ and backends/.
"""
import pathlib
import re
import sys
import urllib.parse

SKIPPED = {"build", "out", ".git", "__pycache__"}
SOURCES = {".c", ".h", ".cpp", ".cu", ".py", ".sh", ".txt", ".cmake", ".json", ".def"}
LINK = re.compile(r"\[(?:[^\[\]]|\[[^\[\]]*\])*\]\(([^()\s]+(?:\([^()]*\))?)\)")
FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^#{1,6} +(.+?) *#*$", re.MULTILINE)
NAMED = re.compile(r"\bdocs/[\w/.-]+\.(?:md|svg)\b")
CODE = re.compile(r"`([^`\n]+)`")
PATH = re.compile(r"(?<![\w/.<-])([\w.-]+)/((?:[\w.*-]+/)*[\w.*-]*)")
COMMENTED = {".c", ".h", ".cpp", ".hpp", ".cu", ".def"}
COMMENT = re.compile(r"/\*(.*?)\*/|(?<![:\"/])//([^\n]*)", re.DOTALL)
FILE = re.compile(r"(?<![\w/.<\"*-])((?:[\w-]+/)*[\w-]+\.(?:h|c|cpp|hpp|cu|def))\b(?![\"(/])")
ELSEWHERE = {"errno.h", "windows.h"}  # the system's
INSTALLED = "lib/pbf/"  # where plugins are in an installation


def files_of(root):
    for path in sorted(root.rglob("*")):
        if path.is_file() and not SKIPPED.intersection(path.relative_to(root).parts):
            yield path


def anchors_of(text):
    found = set()
    for heading in HEADING.findall(FENCE.sub("", text)):
        plain = LINK.sub(lambda link: link[0][1:link[0].index("](")], heading)
        slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        again = 0
        while f"{slug}-{again}" in found if again else slug in found:
            again += 1
        found.add(f"{slug}-{again}" if again else slug)
    return found


def wrong_links(page, text, anchors):
    for target in LINK.findall(FENCE.sub("", text)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (page.parent / urllib.parse.unquote(name)).resolve() if name else page
        if not path.exists():
            yield f"{target}: no such file"
        elif anchor and urllib.parse.unquote(anchor) not in anchors(path):
            yield f"{target}: no such heading"


def wrong_tables(text):
    open_table, names = None, set()
    for number, line in enumerate(text.splitlines(), 1):
        start = re.fullmatch(r"<!-- table: (.+) -->", line)
        if start and (open_table or start[1] in names):
            yield f"line {number}: the table {start[1]} begins inside another one, or twice"
        elif start:
            open_table = start[1]
            names.add(open_table)
        elif line == "<!-- end -->":
            if not open_table:
                yield f"line {number}: an end without a table"
            open_table = None
    if open_table:
        yield f"the table {open_table} has no end"


def wrong_paths(root, text):
    """Of a document: paths in code that begin with a folder of the root."""
    for code in CODE.findall(FENCE.sub("", text)):
        for first, rest in PATH.findall(code):
            path = f"{first}/{rest}".rstrip("/.")
            if first in SKIPPED | {".", ".."} or not (root / first).is_dir() or path.startswith(INSTALLED):
                continue
            if not (any(root.glob(path)) if "*" in path else (root / path).exists()):
                yield f"{path}: no such file"


def wrong_files(endings, text):
    """Of a source: files that comments name."""
    for block, line in COMMENT.findall(text):
        for name in FILE.findall(block or line):
            if name not in endings and name not in ELSEWHERE:
                yield f"{name}: no such file"


def missing_folders(root, paths):
    """Folders of lib/ and backends/ that docs/architecture.md does not name."""
    text = (root / "docs/architecture.md").read_text(encoding="utf-8")
    parts = [path.relative_to(root).parts for path in paths]
    folders = {each[1] for each in parts if each[0] in {"lib", "backends"} and len(each) > 2}
    for folder in sorted(folders):
        if f"{folder}/" not in text:
            yield f"docs/architecture.md: it does not say what {folder}/ holds"


def endings_of(root, paths):
    """All that paths end with: lib/check.h and check.h."""
    parts = [path.relative_to(root).parts for path in paths]
    return {"/".join(each[k:]) for each in parts for k in range(len(each))}


def main(root):
    root = pathlib.Path(root).resolve()
    known, paths = {}, list(files_of(root))
    endings = endings_of(root, paths)

    def anchors(path):
        if path not in known:
            known[path] = anchors_of(path.read_text(encoding="utf-8")) if path.suffix == ".md" else set()
        return known[path]

    wrong, links = list(missing_folders(root, paths)), 0
    for path in paths:
        markdown = path.suffix == ".md"
        if not markdown and path.suffix not in SOURCES and path.name != "run":
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        found = [f"{name}: no such file" for name in NAMED.findall(text) if not (root / name).exists()]
        if markdown:
            links += len(LINK.findall(text))
            found += [*wrong_links(path, text, anchors), *wrong_tables(text), *wrong_paths(root, text)]
        elif path.suffix in COMMENTED and "third_party" not in path.parts:
            found += wrong_files(endings, text)
        wrong += [f"{path.relative_to(root)}: {each}" for each in dict.fromkeys(found)]
    print("\n".join(wrong) if wrong else f"{links} links hold")
    return 1 if wrong or not links else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
