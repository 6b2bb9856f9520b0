#!/usr/bin/python3
"""Draws the figures of docs/error-and-speed.md from committed results, with Matplotlib (python3-matplotlib):

    bench/tools/figures.py PARETO_FOLDER TIMES SPEEDUP
    bench/tools/figures.py bench/results/epyc-2-cores bench/results/nvidia-h100/times.json bench/results/nvidia-h200/speedup.json
"""
import json
import pathlib
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

PICTURES = pathlib.Path(__file__).resolve().parents[2] / "docs" / "pictures"
SCENES = ("dam-break-3d", "drop-into-pool", "still-tank")
FIGURE = "E1.measure.interior.mean_abs@mean"
FAMILIES = {"plain": ("the paper's plain method", "#b0443c", "s"), "library": ("the library", "#2a6fb0", "o"),
            "wide-held": ("h = 3 d, cohesion 1", "#2f8f5b", "^")}


def load(path):
    return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))


def style():
    # The same bytes from the same results; letters as letters, which are small.
    plt.rcParams.update({"svg.hashsalt": "pbf", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 10,
                         "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False})


def save(figure, name):
    figure.savefig(PICTURES / name, metadata={"Date": None, "Creator": None}, bbox_inches="tight", facecolor="white")
    print(f"docs/pictures/{name}: {(PICTURES / name).stat().st_size // 1000} KB")


def error_against_time(folder):
    figure, axes = plt.subplots(1, len(SCENES), figsize=(10, 3.4), sharey=True)
    for scene, axis in zip(SCENES, axes):
        result = load(pathlib.Path(folder) / f"pareto-{scene}.json")
        entry = next(entry for entry in result["analysis"] if entry["figure"] == FIGURE)
        for family in entry["families"]:
            if family["family"] in FAMILIES:
                label, color, marker = FAMILIES[family["family"]]
                front = family["front"]
                axis.loglog([p["seconds_per_simulated"] for p in front], [100 * p["error"] for p in front], marker=marker,
                            color=color, label=label, markersize=5, linewidth=1.3)
        axis.set_title(scene)
        axis.set_xlabel("computing, s for 1 s")
    axes[0].set_ylabel("mean density error, %")
    axes[0].legend(fontsize=8, loc="lower left")
    save(figure, "error-against-time.svg")


def speed(times, speedup):
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.4))
    bars = [(row["name"].split("/"), row["real_time"] / 100) for row in load(speedup)["benchmarks"] if row["run_type"] == "iteration"]
    names = [backend if backend in ("naive", "cuda", "serial") else f"{backend}, {threads.split(':')[1]}" for (_, backend, threads), _ in bars]
    left.barh(names[::-1], [ms for _, ms in bars][::-1], color="#2a6fb0")
    left.set_xscale("log")
    left.set_xlabel("ms a step")
    left.set_title("30,000 particles in 2D, by backend and threads")
    rows = [json.loads(line) for line in pathlib.Path(times).read_text(encoding="utf-8").splitlines() if line.startswith("{")]
    for ratio, color, marker in ((2.0, "#2a6fb0", "o"), (3.0, "#2f8f5b", "^")):
        points = sorted((row["particles"], row["ms_per_step"]) for row in rows if usual(row) and abs(row["support"] - ratio) < 0.01)
        right.loglog(*zip(*points), color=color, marker=marker, markersize=5, linewidth=1.3, label=f"H100, h = {ratio:g} d")
    right.set_xlabel("particles in 3D")
    right.set_ylabel("ms a step")
    right.set_title("a dam break, 4 iterations, float32")
    right.legend(fontsize=8)
    save(figure, "speed.svg")


def usual(row):
    return row["time"] == "shallow-dam-break" and row["extra"] == "" and "f32" in row["variant"]


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    style()
    error_against_time(sys.argv[1])
    speed(*sys.argv[2:])
