#!/usr/bin/env python3
"""What walls make of the density errors: one law beside another, by pbf-check.

    bench/tools/walls.py measure PBF-BENCH NAME RESULT.json   runs the scenes on `reference`, keeps them under this name
    bench/tools/walls.py table RESULT.json NAME…              writes the table in docs/notes/walls.md, these side by side

PBF-BENCH may be of another commit, or be patched and switched by the environment.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

from pages import ROOT, write_table

# scene, particles (None: its own), steps, iterations
RUNS = (("still-tank", 2560, 240, 4), ("still-tank", 2560, 240, 16), ("dam-break-3d", 3840, 90, 4),
        ("drop-into-pool", 1696, 90, 8), ("cube-collapse", None, 400, 8))
FRAMES = 20
FIGURES = (("own equation", "E1", "own.interior.mean_abs", "mean"),
           ("99th percentile", "E1", "own.interior.p99", "mean"),
           ("compression, all", "E1", "own.all.compression_mean", "mean"),
           ("largest", "E1", "own.all.compression_max", "largest"),
           ("one kernel for all", "E1", "measure.interior.mean_abs", "mean"),
           ("energy at the end", "E6", "relative", "last"))


def judged(program, scene, particles, steps, iterations):
    with tempfile.TemporaryDirectory() as folder:
        dump, report = f"{folder}/dump", f"{folder}/report.json"
        size = [] if particles is None else ["--particles", str(particles)]
        subprocess.run([program, "run", "--scene", scene, *size, "--steps", str(steps), "--backend", "reference", "--set",
                        f"iterations={iterations}", "--dump", dump, "--every", str(steps // FRAMES)],
                       check=True, stdout=subprocess.DEVNULL)
        subprocess.run([sys.executable, str(ROOT / "check" / "pbf-check"), "errors", dump, "--only", "E1,E6", "--json",
                        report], check=True, stdout=subprocess.DEVNULL)
        errors = json.loads(pathlib.Path(report).read_text(encoding="utf-8"))["errors"]
        return {label: errors[error]["summary"][figure][which] for label, error, figure, which in FIGURES}


def measure(program, name, path):
    path = pathlib.Path(path)
    result = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    result[name] = [{"scene": run[0], "particles": run[1], "steps": run[2], "iterations": run[3],
                     "figures": judged(program, *run)} for run in RUNS]
    path.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def percent(value):
    return f"{100 * value:.2g}".replace("-", "−")


def table(result, names):
    labels = [label for label, *_ in FIGURES]
    lines = ["| scene | iterations | " + " | ".join(labels) + " |",
             "| --- | --: |" + " --: |" * len(labels)]
    for rows in zip(*(result[name] for name in names)):
        cells = [" → ".join(percent(row["figures"][label]) for row in rows) + " %" for label in labels]
        lines.append(f"| `{rows[0]['scene']}` | {rows[0]['iterations']} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


if __name__ == "__main__":
    if len(sys.argv) == 5 and sys.argv[1] == "measure":
        measure(*sys.argv[2:])
    elif len(sys.argv) > 3 and sys.argv[1] == "table":
        result = json.loads(pathlib.Path(sys.argv[2]).read_text(encoding="utf-8"))
        write_table("docs/notes/walls.md", "walls", table(result, sys.argv[3:]))
    else:
        sys.exit(__doc__)
