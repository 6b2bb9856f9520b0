#!/usr/bin/python3
"""Draws the speedup of one scene on several GPUs beside what a cost model says, up to eight of them, with
Matplotlib (python3-matplotlib), and prints the model's table:

    bench/tools/ranks_plot.py bench/results/nvidia-h200-x4/ranks-times.json

A step of N particles on P ranks takes w (N / P + held) + e + r: w a particle, from the largest scene of
one solver without ranks; e what does not follow N, which is left of the smallest one; r what one rank
takes more than none there. `held` are others' particles, 2.8 layers of the lattice at each cut.
"""
import json
import sys

from figures import plt, save, style

LAYERS, GPUS = 2.8, (1, 2, 4, 8)
COLORS = ("#b0443c", "#2a6fb0", "#2f8f5b", "#8a5fb0")


def load(path):
    with open(path, encoding="utf-8") as lines:
        return [json.loads(line) for line in lines if line.startswith("{")]


def model_of(runs):
    alone = {run["particles"]: run["ms_per_step"] for run in runs if run["ranks"] == 0}
    smallest, largest = min(alone), max(alone)
    each = alone[largest] / largest
    one_rank = next(run["ms_per_step"] for run in runs if run["ranks"] == 1 and run["particles"] == smallest)
    rest, ranks = alone[smallest] - each * smallest, one_rank - alone[smallest]

    def time(particles, section, count):
        held = LAYERS * section * min(count - 1, 2)
        return each * (particles / count + held) + rest + (ranks if count > 1 else 0)

    return time


def strong(runs):
    """Scenes that were timed on several numbers of GPUs: particles, section, times."""
    scenes = {}
    for run in runs:
        scenes.setdefault((run["particles"], run["section"]), {})[max(run["ranks"], 1)] = run["ms_per_step"]
        if run["ranks"] == 0:
            scenes[run["particles"], run["section"]]["alone"] = run["ms_per_step"]
    return {key: times for key, times in sorted(scenes.items()) if "alone" in times and len(times) > 2}


def main(path):
    runs = load(path)
    time = model_of(runs)
    style()
    figure, axis = plt.subplots(figsize=(5.2, 3.6))
    axis.plot(GPUS, GPUS, color="#999999", linewidth=0.8, linestyle=":", label="as many as GPUs")
    print("| particles | GPUs | measured, ms | model, ms | measured speedup | model |\n| --: | --: | --: | --: | --: | --: |")
    for ((particles, section), times), color in zip(strong(runs).items(), COLORS):
        alone = times["alone"]
        shown = [count for count in GPUS if count in times and count > 1]
        axis.plot([1, *shown], [1, *(alone / times[count] for count in shown)], "o", color=color, label=f"{particles / 1e6:.0f} million")
        axis.plot(GPUS, [1, *(alone / time(particles, section, count) for count in GPUS[1:])], color=color, linewidth=1)
        for count in GPUS[1:]:
            told, seen = time(particles, section, count), times.get(count)
            print(f"| {particles:,} | {count} | {f'{seen:.4g}' if seen else ''} | {told:.4g} | "
                  f"{f'{alone / seen:.2f}' if seen else ''} | {alone / told:.2f} |")
    axis.set_xscale("log", base=2)
    axis.set_yscale("log", base=2)
    axis.set_xticks(GPUS, [str(count) for count in GPUS])
    axis.set_yticks(GPUS, [str(count) for count in GPUS])
    axis.set_xlabel("GPUs")
    axis.set_ylabel("speedup over one")
    axis.legend(fontsize=8)
    save(figure, "ranks.svg")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
