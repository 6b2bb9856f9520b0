#!/usr/bin/env python3
"""Writes the tables of docs/many-worlds.md from what `pbf-bench worlds` and `startup` have measured.

    bench/tools/worlds_table.py FOLDER…      each a folder of bench/results

A folder has worlds.json, startup.json, or both; each is a run's --json.
"""
import json
import pathlib
import statistics
import sys

from pages import write_table

WAYS = {"batch": "in a batch", "one after another": "one solver after another", "one world": "one world of as many"}


def read(folders, name):
    for folder in map(pathlib.Path, folders):
        if (folder / name).exists():
            yield folder.name, json.loads((folder / name).read_text(encoding="utf-8"))


def worlds(folders):
    lines = ["| machine | backend | way | worlds x particles | threads | ms a step of all | million particle-steps a second | of one world |",
             "| --- | --- | --- | --: | --: | --: | --: | --: |"]
    for name, run in read(folders, "worlds.json"):
        ran = [row for row in run["rows"] if row["ms_per_step"]]
        whole = {row["backend"]: row["particle_steps_per_second"] for row in ran if row["way"] == "one world"}
        for row in ran:
            rate = row["particle_steps_per_second"]
            part = f"{100 * rate / whole[row['backend']]:.0f} %" if row["backend"] in whole else ""
            lines.append(f"| {name} | {row['backend']} | {WAYS[row['way']]} | {row['worlds']:,} x {row['particles']:,} | {row['threads']} | "
                         f"{statistics.median(row['ms_per_step']):.4g} | {rate / 1e6:.3g} | {part} |")
    return "\n".join(lines)


def startup(folders):
    lines = ["| machine | backend | particles | first solver of a process, ms | a later one: create | … and to its first step | destroy | "
             "a batch's world: create | reset |",
             "| --- | --- | --: | --: | --: | --: | --: | --: | --: |"]
    for name, run in read(folders, "startup.json"):
        for row in (row for row in run["rows"] if not row["reason"]):
            times = (row["first_ms"], row["create_ms"], row["create_ms"] + row["step_ms"], row["destroy_ms"], row["world_ms"], row["reset_ms"])
            lines.append(f"| {name} | {row['backend']} | {row['particles']:,} | " + " | ".join(f"{ms:.3g}" for ms in times) + " |")
    return "\n".join(lines)


def main(folders):
    write_table("docs/many-worlds.md", "worlds", worlds(folders))
    write_table("docs/many-worlds.md", "startup", startup(folders))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
