#!/usr/bin/env python3
"""Writes the table of other solvers into docs/stability.md, and the sentence about it into README.md, from
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
        reason = "positions that are not a number" if "not finite" in entry["reason"] else entry["reason"]
        kept.append({**shortened(entry, "pysplishsplash 2.19.0"), "reason": reason})
    return kept


def counted(verdicts, name):
    of = [entry for entry in verdicts if entry["backend"] == name]
    return sum(entry["verdict"] == "holds" for entry in of), len(of)


def ours(machine, cases):
    """The same cases on this library's serial backend."""
    path = ROOT / "bench" / "results" / machine / "stability.json"
    entries = [e for e in json.loads(path.read_text(encoding="utf-8"))["verdicts"] if e["backend"] == "serial" and e["case"] in cases]
    return sum(entry["verdict"] == "holds" for entry in entries), len(entries)


def table(verdicts):
    found = {(entry["case"], entry["backend"]): entry for entry in verdicts}
    cases = sorted({entry["case"] for entry in verdicts})
    lines = ["| # | " + " | ".join(TITLES.values()) + " |", "| --: |" + " --- |" * len(TITLES)]
    for case in cases:
        lines.append(f"| {case} | " + " | ".join(cell(found.get((case, name))) for name in TITLES) + " |")
    lines += ["", *(f"- {title}: {counted(verdicts, name)[0]} of {counted(verdicts, name)[1]} hold" for name, title in TITLES.items())]
    return "\n".join(lines)


def sentence(verdicts, machine):
    told_of = [f"{title} {counted(verdicts, name)[0]} of {counted(verdicts, name)[1]}" for name, title in TITLES.items()]
    own = ours(machine, {entry["case"] for entry in verdicts})
    return (f"Of the {own[1]} [stiff cases](docs/stability.md#the-same-cases-on-other-solvers) that SPlisHSPlasH 2.19.0 was driven through, the same "
            f"judge finds that `serial` holds {own[0]}, and it: " + "; ".join(told_of) + ".")


def main(machine, path):
    verdicts = verdicts_of(path)
    rows = ",\n".join("  " + json.dumps(entry, ensure_ascii=False) for entry in verdicts)
    (ROOT / "bench" / "results" / machine / "peers-stability.json").write_text('{\n "verdicts": [\n' + rows + "\n ]\n}\n", encoding="utf-8")
    write_table("docs/stability.md", "peers", table(verdicts))
    write_table("README.md", "peers-stability", sentence(verdicts, machine))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
