#!/usr/bin/env python3
"""Writes the table of docs/notes/unused-features.md from results of bench/tools/unused.sh, one a backend.

    bench/tools/unused_table.py RESULT.json…
"""
import json
import pathlib
import sys

from pages import write_table


def percent(ratio):
    return f"{100 * (ratio - 1):+.1f} %"


def lines_of(result):
    first = result["builds"][0]
    for row in result["builds"][1:]:
        if "reason" in row:
            yield (result["backend"], row["name"].replace("_", " ", 1), row["reason"], "", "", "", "")
            continue
        low, high = row["ratio_middle_half"]
        yield (result["backend"], row["name"].replace("_", " ", 1), percent(row["ratio_median"]), f"{percent(low)} … {percent(high)}",
               percent(row["ms_per_step_least"] / first["ms_per_step_least"]),
               f"{row['bytes'] - first['bytes']}", "the same" if row["state"] == first["state"] else "others")


def threads_of(result):
    return {0: "", 1: ", 1 thread"}.get(result["threads"], f", {result['threads']} threads")


def table(results):
    lines = ["| backend | build | time, median | middle half | min time | bytes | bits |",
             "| --- | --- | --: | --: | --: | --: | --- |"]
    for result in results:
        lines += ["| " + " | ".join(cells) + " |" for cells in lines_of(result)]
    for result in results:
        lines += ["", f"{result['backend']}: {result['scene']}, {result['particles']:,} particles, "
                  f"{result['time']} time of "
                  f"{len(result['builds'][0]['ms_per_step'])} rounds of {result['steps_a_round']} steps on "
                  f"{result['device']}{threads_of(result)}, commit {result['commit']}."]
    return "\n".join(lines)


def main(paths):
    results = [json.loads(pathlib.Path(path).read_text(encoding="utf-8")) for path in paths]
    write_table("docs/notes/unused-features.md", "unused", table(results))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
