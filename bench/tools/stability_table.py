#!/usr/bin/env python3
"""Writes the tables of docs/stability.md from what pbf-bench stability --json has reported.

    bench/tools/stability_table.py MACHINE COMMIT REPORT.json…

The verdicts of the reports go into bench/results/MACHINE/stability.json first, those of full sizes into
stability-full.json, each with the figure that is nearest to its bound; other backends that stand there stay.
"""
import json
import pathlib
import sys

from pages import ROOT, write_table

ORDER = ("reference", "serial", "openmp", "cuda")


def shortened(entry, commit):
    """A verdict and the figures that miss their bound, or the nearest to it where all hold."""
    told = [f for f in entry["figures"] if not f["holds"]] or entry["figures"][:1]
    return {**{key: entry[key] for key in ("case", "backend", "quick", "device", "verdict", "reason")},
            "commit": commit, "seconds": round(entry["seconds"], 2),
            "figures": [{key: f[key] for key in ("name", "shown", "bound_shown")} for f in told]}


def merged(path, reports, commit):
    new = [shortened(entry, commit) for report in reports for entry in report["verdicts"]]
    tried = {(entry["backend"], entry["case"]) for entry in new}
    old = json.loads(path.read_text(encoding="utf-8"))["verdicts"] if path.exists() else []
    kept = [entry for entry in old if (entry["backend"], entry["case"]) not in tried]
    return sorted(kept + new, key=lambda entry: (entry["case"], ORDER.index(entry["backend"])))


def cell(entry):
    if entry is None:
        return "not run"
    if entry["verdict"] != "fails":
        return entry["verdict"]
    if not entry["figures"]:
        return "**fails**: " + entry["reason"]
    worst, more = entry["figures"][0], len(entry["figures"]) - 1
    others = f", and {more} more" if more else ""
    return f'**fails**: {worst["name"]} {worst["shown"]}, bound {worst["bound_shown"]}{others}'


def row(case, entries):
    cells = [cell(entry) for entry in entries]
    shown = ["the same" if k > 0 and text == cells[k - 1] else text for k, text in enumerate(cells)]
    return f"| {case} | " + " | ".join(shown) + " |"


def summary(name, verdicts):
    of = [entry for entry in verdicts if entry["backend"] == name]
    held = sum(entry["verdict"] == "holds" for entry in of)
    device = next((entry["device"] for entry in of if entry["device"]), "")
    sizes = "quick sizes" if all(entry["quick"] for entry in of) else "full sizes"
    commits = ", ".join(sorted({entry["commit"] for entry in of}))
    return f"- {name}: {held} of {len(of)} hold; {sizes}, {device}, commit {commits}"


def table(verdicts):
    backends = [name for name in ORDER if any(entry["backend"] == name for entry in verdicts)]
    found = {(entry["case"], entry["backend"]): entry for entry in verdicts}
    rows = {case: [found.get((case, name)) for name in backends] for case in sorted({entry["case"] for entry in verdicts})}
    held = [case for case, entries in rows.items() if all(e and e["verdict"] == "holds" for e in entries)]
    lines = ["Held by all of these: " + ", ".join(map(str, held)) + ".", "",
             "| # | " + " | ".join(backends) + " |", "| --: |" + " --- |" * len(backends)]
    lines += [row(case, entries) for case, entries in rows.items() if case not in held]
    return "\n".join(lines + [""] + [summary(name, verdicts) for name in backends])


def main(machine, commit, paths):
    reports = [json.loads(pathlib.Path(name).read_text(encoding="utf-8")) for name in paths]
    sizes = {entry["quick"] for report in reports for entry in report["verdicts"]}
    if len(sizes) != 1:
        sys.exit("stability_table.py: quick and full sizes do not go into one table")
    quick = sizes.pop()
    path = ROOT / "bench" / "results" / machine / ("stability.json" if quick else "stability-full.json")
    verdicts = merged(path, reports, commit)
    rows = ",\n".join("  " + json.dumps(entry, ensure_ascii=False) for entry in verdicts)
    path.write_text('{\n "verdicts": [\n' + rows + "\n ]\n}\n", encoding="utf-8")
    write_table("docs/stability.md", "verdicts" if quick else "verdicts-full", table(verdicts))


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
