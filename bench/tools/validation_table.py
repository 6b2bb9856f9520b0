#!/usr/bin/env python3
"""Writes the table of docs/accuracy.md from a result of bench/validate.

    bench/tools/validation_table.py out/validation.json
"""
import json
import pathlib
import sys

START, END = "<!-- table: validation -->", "<!-- end -->"
PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "accuracy.md"


def number(value):
    return "" if value is None else f"{value:.2g}" if abs(value) < 1e-3 else f"{value:.3g}"


def verdict(row):
    if row["bar"] is None:
        return ""
    return f"{row['bar']:g} {'holds' if row['holds'] else 'missed'}"


def lines_of(case):
    for row in case["rows"]:
        cells = [case["title"], row["figure"], *map(number, row["values"]), number(row["order"]), verdict(row)]
        yield "| " + " | ".join(cells) + " |"


def table(result):
    runs = max(len(case["runs"]) for case in result["cases"])
    names = ("coarse", "medium", "fine", "finer", "finest")[:runs]
    lines = ["| case | figure | " + " | ".join(names) + " | order | bar |",
             "| --- | --- | " + " | ".join(["--:"] * (runs + 1)) + " | --- |"]
    for case in result["cases"]:
        lines += lines_of(case)
    settings = ", ".join(result["settings"]) or "the scenes' own parameters"
    return "\n".join(lines + ["", f"`{result['backend']}`, {settings}; library {result['build']}."])


def main(path):
    before, rest = PAGE.read_text(encoding="utf-8").split(START)
    after = rest.split(END, 1)[1]
    text = table(json.loads(pathlib.Path(path).read_text(encoding="utf-8")))
    PAGE.write_text(f"{before}{START}\n{text}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
