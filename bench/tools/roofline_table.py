#!/usr/bin/env python3
"""Writes the roofline tables of docs/notes/cuda.md from hardware counters, two steps and more of each scene:

    bench/tools/roofline_table.py bench/results/nvidia-h200 COMMIT

METRICS are what the files hold; they are ncu's own CSV:

    ncu --clock-control none --csv --metrics … --launch-skip 3000 --launch-count 40 gpu_check time …
"""
import csv
import pathlib
import statistics
import sys
from collections import defaultdict

from pages import write_table

METRICS = ("gpu__time_duration.sum", "lts__t_bytes.sum", "dram__bytes.sum", "smsp__inst_executed.sum",
           "smsp__sass_thread_inst_executed_op_fadd_pred_on.sum",
           "smsp__sass_thread_inst_executed_op_fmul_pred_on.sum",
           "smsp__sass_thread_inst_executed_op_ffma_pred_on.sum")
UNITS = {"dram__throughput": "memory", "lts__throughput": "L2", "l1tex__throughput": "L1",
         "sm__inst_executed": "issue"}
SHARE = ".avg.pct_of_peak_sustained_elapsed"
STAGES = {"predict_kernel": "predict", "scatter_kernel": "sort: scatter", "place_kernel": "sort: place",
          "list_kernel": "search", "lambda_kernel": "λ", "move_kernel": "move", "weigh_kernel": "grid: densities",
          "deep_cells_kernel": "grid: cells", "deep_nodes_kernel": "grid: nodes",
          "deep_guess_kernel": "grid: guess", "deep_solve_kernel": "grid: solve", "carry_kernel": "grid: moves"}
PEAK_BYTES, PEAK_FLOPS = 4.8e12, 66.9e12  # of an H200's device memory and float32 units, a second


def launches(path):
    """Stage and counters of every kernel that ran, in order."""
    found = {}
    with open(path, encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            name = row["Kernel Name"].removeprefix("void ").split("<")[0].split("(")[0]
            stage = STAGES.get(name, "sort: scan" if "Scan" in row["Kernel Name"] else name)
            entry = found.setdefault(int(row["ID"]), (stage, {}))
            entry[1][row["Metric Name"]] = float(row["Metric Value"].replace(",", ""))
    return [found[key] for key in sorted(found)]


def whole_steps(runs):
    """Those between the first prediction and the last one, and how many steps they are."""
    starts = [k for k, (stage, _) in enumerate(runs) if stage == "predict"]
    return runs[starts[0]:starts[-1]], len(starts) - 1


def line(stage, steps, all_counters):
    middle = {name: statistics.median(c[name] for c in all_counters) for name in all_counters[0]}
    time, l2, memory, instructions, add, multiply, both = (middle[name] for name in METRICS)
    flops = add + multiply + 2 * both
    busiest = max(UNITS, key=lambda unit: middle[unit + SHARE])
    seconds = time * 1e-9
    return [stage, f"{time / 1000:.1f}", f"{len(all_counters) / steps:.0f}", f"{l2 / 1e6:.0f}", f"{memory / 1e6:.0f}",
            f"{instructions / 1e6:.1f}", f"{flops / 1e6:,.0f}", f"{100 * memory / seconds / PEAK_BYTES:.0f} %",
            f"{100 * flops / seconds / PEAK_FLOPS:.0f} %", f"{UNITS[busiest]} {middle[busiest + SHARE]:.0f} %"]


def table(path, commit):
    runs, steps = whole_steps(launches(path))
    stages = defaultdict(list)
    for stage, counters in runs:
        stages[stage].append(counters)
    total = sum(c[METRICS[0]] for _, c in runs) / steps / 1000
    search = sum(c[METRICS[0]] for s, c in runs if s.startswith(("sort", "search", "predict"))) / steps / 1000
    head = ("stage", "µs", "runs", "L2, MB", "device memory, MB", "instructions, million", "float32 operations, million",
            "share of memory's limit", "of arithmetic's", "busiest unit")
    lines = ["| " + " | ".join(head) + " |", "| --- |" + " --: |" * (len(head) - 2) + " --- |"]
    lines += ["| " + " | ".join(line(stage, steps, stages[stage])) + " |" for stage in stages]
    return "\n".join(lines + ["", f"{total:.0f} µs of kernels a step, {search:.0f} of them for prediction, sort and search; "
                                  f"NVIDIA H200, commit {commit}, `{path.name}`."])


def main(folder, commit):
    folder = pathlib.Path(folder)
    write_table("docs/notes/cuda.md", "roofline", table(folder / "ncu-1m.csv", commit))
    write_table("docs/notes/cuda.md", "roofline-grid", table(folder / "ncu-1m-grid.csv", commit))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
