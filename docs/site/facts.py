#!/usr/bin/env python3
"""Under each parameter's heading in docs/guide.md, its unit, range and default as docs/parameters.md has them:

    facts.py            writes them
    facts.py --check    fails where they differ, or where a parameter has no heading
"""
import pathlib
import re
import sys

DOCS = pathlib.Path(__file__).resolve().parents[1]
HEADING = re.compile(r"^(### (`\w+`(?:, `\w+`)*)\n)\n(?:\*[^\n]+\*\n\n)?", re.MULTILINE)


def facts():
    rows = {}
    for line in (DOCS / "parameters.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("| `"):
            name, _, unit, allowed, default, *_ = [cell.strip() for cell in line.strip("|").split("|")]
            rows[name.strip("`")] = f"{unit or 'no unit'}; {allowed}; default {default}"
    return rows


def main(check):
    path = DOCS / "guide.md"
    text, known, seen = path.read_text(encoding="utf-8"), facts(), []

    def line(match):
        names = re.findall(r"\w+", match[2])
        seen.extend(names)
        missing = [name for name in names if name not in known]
        if missing:
            sys.exit(f"docs/guide.md: there is no parameter {missing[0]}")
        several = len({known[name] for name in names}) > 1
        words = ". ".join(f"`{name}`: {known[name]}" for name in names) if several else known[names[0]]
        return f"{match[1]}\n*{words}*\n\n"

    new = HEADING.sub(line, text)
    left = [name for name in known if name not in seen]
    if left:
        sys.exit(f"docs/guide.md has no heading for {', '.join(left)}")
    if new != text and check:
        print("docs/guide.md: units, ranges or defaults differ from docs/parameters.md; docs/site/facts.py writes them")
        return 1
    if new != text:
        path.write_text(new, encoding="utf-8")
    print(f"{len(seen)} parameters are as docs/parameters.md has them")
    return 0


if __name__ == "__main__":
    if sys.argv[1:] not in ([], ["--check"]):
        sys.exit(__doc__)
    sys.exit(main(bool(sys.argv[1:])))
