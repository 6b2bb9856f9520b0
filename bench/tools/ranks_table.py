#!/usr/bin/env python3
"""Makes a table of what bench/gpu-ranks.sh has measured.

  ranks_table.py RANKS_TIMES.json

Speedups are over the solver without ranks of as many particles; of weak scaling over the one of as
many particles a rank.
"""
import json
import sys


def load(path):
    with open(path, encoding="utf-8") as lines:
        return [json.loads(line) for line in lines if line.startswith("{")]


def alone(runs, particles):
    """The solver without ranks of about so many particles, or None."""
    near = [r for r in runs if r["ranks"] == 0 and abs(r["particles"] / particles - 1) < 0.02]
    return near[0] if near else None


def name(run):
    """How many ranks, and how they exchange."""
    return f"{run['ranks'] or 'none'}{', staged' if run.get('staged') else ''}"


def rows(runs):
    for run in runs:
        ranks, ms = run["ranks"], run["ms_per_step"]
        whole, part = alone(runs, run["particles"]), alone(runs, run["particles"] / max(ranks, 1))
        yield [
            f"{run['particles']:,}", name(run), f"{ms:.4g}", f"{run['min']:.4g} … {run['max']:.4g}",
            f"{whole['ms_per_step'] / ms:.2f}" if whole else "",
            f"{part['ms_per_step'] / ms:.3f}" if part and ranks > 1 else "",
            f"{run['bytes'] / run['particles']:.0f}",
        ]


def main(path):
    head = ["particles", "ranks", "ms a step", "min … max", "speedup", "weak scaling", "bytes a particle"]
    print("| " + " | ".join(head) + " |")
    print("| " + " | ".join(["--:"] * len(head)) + " |")
    for row in rows(load(path)):
        print("| " + " | ".join(row) + " |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
