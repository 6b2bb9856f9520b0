#!/usr/bin/env python3
"""Writes a table from a result of bench/validate: `validation` of docs/validation.md unless told, `physics`
there, or one of the notes.

    bench/tools/validation_table.py out/validation.json [physics | damping_compensation | torque]
"""
import json
import pathlib
import sys

from pages import write_table

PAGES = {"validation": "docs/validation.md", "physics": "docs/validation.md", "damping_compensation": "docs/notes/implicit-damping.md",
         "torque": "docs/notes/angular-momentum.md"}


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


def physics_lines(case):
    for row in case["figures"]:
        error = number(row["error"]) + (f" {row['unit']}" if row["unit"] and row["error"] is not None else "")
        cells = [case["title"], row["figure"], number(row["is"]), number(row["must"]), error, verdict(row)]
        yield "| " + " | ".join(cells) + " |"


def physics_table(result):
    """What pbf-bench validate has measured itself."""
    lines = ["| case | figure | is | must be | off by | bar |", "| --- | --- | --: | --: | --: | --- |"]
    for case in result["physics"]:
        lines += physics_lines(case)
    judged = [row for case in result["physics"] for row in case["figures"] if row["bar"] is not None]
    held = sum(row["holds"] for row in judged)
    return "\n".join(lines + ["", f"{held} of {len(judged)} bars hold. `{result['backend']}`; library {result['build']}."])


def main(path, name="validation"):
    result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    write_table(PAGES[name], name, physics_table(result) if name == "physics" else table(result))


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
