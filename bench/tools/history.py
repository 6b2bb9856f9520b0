#!/usr/bin/env python3
"""How long a step took, commit by commit, on the machines that bench/gpu.sh has run on.

    bench/tools/history.py gather           adds what git's history has of bench/results/*/times.json to
                                            bench/results/history.json
    bench/tools/history.py add FOLDER       adds the times.json and machine.json that bench/gpu.sh left there
    bench/tools/history.py draw             writes docs/history.md's table and picture from that
    bench/tools/history.py check            fails where the table is another one
    bench/tools/history.py cost [PERCENT]   names what became so much slower or faster (5 unless told) from one
                                            measurement to the next, and the commits between that change code of a step
"""
import collections
import json
import pathlib
import subprocess
import sys

from pages import ROOT, write_table

HISTORY = ROOT / "bench" / "results" / "history.json"
PICTURE = ROOT / "docs" / "pictures" / "history.svg"
CODE = ("backends", "lib")  # what a step runs
# Drawn and in the table: scene, particles, h/d, extra.
SHOWN = (("report-30k", 30000, 1.913, ""), ("shallow-dam-break", 30720, 1.667, ""),
         ("shallow-dam-break", 30720, 2, ""),
         ("shallow-dam-break", 1004670, 1.667, ""), ("shallow-dam-break", 1004670, 2, ""),
         ("shallow-dam-break", 1004670, 3, ""))


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], check=True, capture_output=True, text=True).stdout


def key_of(row):
    precision = "f64" if "f64" in row["variant"] else "f32"
    extra = row.get("extra", "").replace("f64", "")
    return json.dumps([row["time"], row["particles"], round(row["support"], 3), extra, precision])


def file_at(commit, path):
    try:
        return git("show", f"{commit}:{path}")
    except subprocess.CalledProcessError:
        return None


def date_of(commit, otherwise):
    try:
        return git("show", "-s", "--format=%cI", commit).strip()
    except subprocess.CalledProcessError:  # a commit that history does not have any more
        return otherwise


def measurement(times, machine, date):
    rows = [json.loads(row) for row in times.splitlines() if row.startswith('{"time"')]
    return {"machine": machine["machine"], "commit": machine["commit"][:7], "date": date_of(machine["commit"], date),
            "ms_per_step": {key_of(row): row["ms_per_step"] for row in rows if row.get("backend", "cuda") == "cuda"}}


def measurement_in(folder):
    folder = pathlib.Path(folder)
    machine = json.loads((folder / "machine.json").read_text(encoding="utf-8"))
    return measurement((folder / "times.json").read_text(encoding="utf-8"), machine, "")


def measurements():
    """Of all times.json that were ever committed, the oldest first."""
    for path in sorted(set(git("log", "--format=", "--name-only", "--", "bench/results/*/times.json").split())):
        for line in git("log", "--reverse", "--format=%H %cI", "--", path).splitlines():
            commit, date = line.split()
            text, machine = file_at(commit, path), file_at(commit, str(pathlib.Path(path).parent / "machine.json"))
            if not text or not machine:
                continue
            yield measurement(text, json.loads(machine), date)


def add(found):
    """Adds measurements to the history; those that it has stay."""
    known = json.loads(HISTORY.read_text(encoding="utf-8")) if HISTORY.exists() else []
    by_commit = {(m["machine"], m["commit"]): m for m in known}
    for m in found:
        by_commit.setdefault((m["machine"], m["commit"]), m)
    ordered = sorted(by_commit.values(), key=lambda m: (m["machine"], m["date"]))
    HISTORY.write_text("[\n" + ",\n".join(json.dumps(m, sort_keys=True) for m in ordered) + "\n]\n", encoding="utf-8")


def series():
    """By machine and what was run: (date, commit, ms), in order."""
    all_series = collections.defaultdict(list)
    for m in json.loads(HISTORY.read_text(encoding="utf-8")):
        for key, ms in m["ms_per_step"].items():
            all_series[m["machine"], key].append((m["date"], m["commit"], ms))
    return all_series


def shown_key(scene, particles, support, extra):
    return json.dumps([scene, particles, float(support), extra, "f32"])


def label(scene, particles, support, extra):
    return f"`{scene}`, {particles:,}, h = {support:.4g} d" + (f", {extra}" if extra else "")


def table():
    measured = json.loads(HISTORY.read_text(encoding="utf-8"))
    lines = ["| machine | commit | date | " + " | ".join(label(*s) for s in SHOWN) + " |",
             "| --- | --- | --- |" + " --: |" * len(SHOWN)]
    for m in measured:
        cells = [m["ms_per_step"].get(shown_key(*s)) for s in SHOWN]
        if any(cells):
            lines.append(f"| {m['machine']} | {m['commit']} | {m['date'][:10]} | "
                         + " | ".join("" if ms is None else f"{1000 * ms:.4g}" for ms in cells) + " |")
    return "\n".join(lines + ["", "Microseconds a step, medians, `cuda`, float32."])


def draw():
    import matplotlib  # noqa: PLC0415 only this command needs it
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "pbf"
    from matplotlib import pyplot  # noqa: PLC0415
    measured = json.loads(HISTORY.read_text(encoding="utf-8"))
    machines = sorted({m["machine"] for m in measured})
    figure, axes = pyplot.subplots(1, len(machines), figsize=(9, 4), sharey=True, layout="constrained")
    for axis, machine in zip(axes, machines):
        for shown in SHOWN:
            points = [m["ms_per_step"].get(shown_key(*shown)) for m in measured if m["machine"] == machine]
            axis.plot([k for k, ms in enumerate(points) if ms], [1000 * ms for ms in points if ms], ".-",
                      label=label(*shown).replace("`", ""))
        axis.set_title(machine, fontsize=9)
        axis.set_xlabel("measurement")
        axis.grid(alpha=0.3)
    axes[0].set_yscale("log")
    axes[0].set_ylabel("µs a step")
    axes[0].legend(fontsize=7)
    figure.savefig(PICTURE, metadata={"Date": None})
    write_table("docs/history.md", "history", table())


def changes(percent):
    for (machine, key), points in sorted(series().items()):
        for (_, before, old), (_, after, new) in zip(points, points[1:]):
            if abs(new / old - 1) > percent / 100:
                yield machine, json.loads(key), before, old, after, new


def cost(percent):
    between = collections.defaultdict(list)
    for machine, key, before, old, after, new in changes(percent):
        between[machine, before, after].append(f"{key[0]}, {key[1]:,}, h = {key[2]:.4g} d {key[3]} {key[4]}: "
                                               f"{old:.4g} -> {new:.4g} ms ({100 * (new / old - 1):+.0f} %)")
    for (machine, before, after), what in between.items():
        print(f"\n{machine}, {before} to {after}")
        print("\n".join("  " + line for line in what))
        try:
            print(git("log", "--format=    %h %s", f"{before}..{after}", "--", *CODE).rstrip())
        except subprocess.CalledProcessError:
            print("    (one of the two is not in this history)")


if __name__ == "__main__":
    if sys.argv[1:] == ["gather"]:
        add(measurements())
    elif sys.argv[1:2] == ["add"] and len(sys.argv) == 3:
        add([measurement_in(sys.argv[2])])
    elif sys.argv[1:] == ["draw"]:
        draw()
    elif sys.argv[1:] == ["check"]:
        sys.exit(table() not in (ROOT / "docs" / "history.md").read_text(encoding="utf-8"))
    elif sys.argv[1:2] == ["cost"] and len(sys.argv) < 4:
        cost(float(sys.argv[2]) if len(sys.argv) == 3 else 5)
    else:
        sys.exit(__doc__)
