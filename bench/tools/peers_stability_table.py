#!/usr/bin/env python3
"""Writes the table of other solvers into docs/notes/other-solvers.md, and the sentence about it into docs/error-and-speed.md, from
what pbf-check has said of bench/peers/stability.py's dumps.

    bench/tools/peers_stability_table.py MACHINE REPORT.json

The verdicts go into bench/results/MACHINE/peers-stability.json first.
"""
import json
import sys

from pages import ROOT, write_table
from stability_table import cell, shortened

TITLES = {"pbf": "PBF", "pbf-quarter": "PBF, Δt/4", "dfsph-quarter": "DFSPH, Δt/4"}


def verdicts_of(path):
    with open(path, encoding="utf-8") as file:
        entries = json.load(file)["verdicts"]
    kept = []
    for entry in entries:
        if "given up" in entry["reason"]:  # for want of time here: no result
            continue
        told = {"reason": "positions that are not a number"} if "not finite" in entry["reason"] else {}
        kept.append({**shortened(entry, "pysplishsplash 2.19.0"), **told})
    return kept


def counted(verdicts, name):
    of = [entry for entry in verdicts if entry["backend"] == name]
    return sum(entry["verdict"] == "holds" for entry in of), len(of)


def ours(machine, cases):
    """The same cases on this library's serial backend."""
    path = ROOT / "bench" / "results" / machine / "stability.json"
    entries = [entry for entry in json.loads(path.read_text(encoding="utf-8"))["verdicts"]
               if entry["backend"] == "serial" and entry["case"] in cases]
    return sum(entry["verdict"] == "holds" for entry in entries), len(entries)


def table(verdicts):
    found = {(entry["case"], entry["backend"]): entry for entry in verdicts}
    cases = sorted({entry["case"] for entry in verdicts})
    lines = ["| # | " + " | ".join(TITLES.values()) + " |", "| --: |" + " --- |" * len(TITLES)]
    for case in cases:
        lines.append(f"| {case} | " + " | ".join(cell(found.get((case, name))) for name in TITLES) + " |")
    counts = [(title, *counted(verdicts, name)) for name, title in TITLES.items()]
    return "\n".join(lines + [""] + [f"- {title}: {held} of {tried} hold" for title, held, tried in counts])


def sentence(verdicts, machine):
    held, tried = ours(machine, {entry["case"] for entry in verdicts})
    theirs = "; ".join("{} {} of {}".format(title, *counted(verdicts, name)) for name, title in TITLES.items())
    return (f"Of the {tried} [stiff cases](notes/other-solvers.md#stiff-cases) that SPlisHSPlasH 2.19.0 was\n"
            f"driven through at quick sizes, the same judge finds that `serial` holds {held}; SPlisHSPlasH's {theirs}.")


def main(machine, path):
    verdicts = verdicts_of(path)
    rows = ",\n".join("  " + json.dumps(entry, ensure_ascii=False) for entry in verdicts)
    results = ROOT / "bench" / "results" / machine / "peers-stability.json"
    results.write_text('{\n "verdicts": [\n' + rows + "\n ]\n}\n", encoding="utf-8")
    write_table("docs/notes/other-solvers.md", "peers-stability", table(verdicts))
    write_table("docs/error-and-speed.md", "peers-stability", sentence(verdicts, machine))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
