#!/usr/bin/env python3
"""Writes the table of times of docs/cuda.md from what bench/gpu.sh left.

    bench/tools/times_table.py bench/results/nvidia-h200
"""
import json
import pathlib
import sys

from pages import write_table

COLUMNS = ("scene", "particles", "precision", "h/d", "neighbours", "ms a step", "min … max",
           "million particle-iterations a second", "bytes a particle", "mean density error")


def cells_of(row):
    return (row["time"] + (f", {row['extra']}" if row["extra"] not in ("", "f64") else ""), f"{row['particles']:,}", "float64" if "f64" in row["variant"] else "float32",
            f"{row['support']:.4g}", f"{row['neighbors_mean']:.1f}", f"{row['ms_per_step']:.4g}",
            f"{row['min']:.4g} … {row['max']:.4g}", f"{row['particle_iterations_per_second'] / 1e6:,.0f}",
            f"{row['bytes_per_particle']:.0f}", f"{row['density_error_mean']:.4f}")


def table(rows, machine):
    lines = ["| " + " | ".join(COLUMNS) + " |", "| --- | --: | --- |" + " --: |" * (len(COLUMNS) - 3)]
    lines += ["| " + " | ".join(cells_of(row)) + " |" for row in rows]
    return "\n".join(lines + ["", f"{machine['machine']}, driver {machine['driver']}, CUDA {machine['cuda']}, commit "
                              f"{machine['commit'][:12]}; the plugin has {machine['plugin_bytes'] / 1e6:.1f} MB."])


def main(folder):
    folder = pathlib.Path(folder)
    rows = [json.loads(line) for line in (folder / "times.json").read_text(encoding="utf-8").splitlines()]
    machine = json.loads((folder / "machine.json").read_text(encoding="utf-8"))
    write_table("docs/cuda.md", "times", table(rows, machine))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
