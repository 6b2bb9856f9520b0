#!/usr/bin/env python3
"""Writes the tables of this library beside SPlisHSPlasH into docs/error-and-speed.md and docs/notes/other-solvers.md, from the
results of bench/peers/hull.py.

    bench/tools/peers_table.py bench/results/epyc-2-cores/peers.json
"""
import json
import pathlib
import statistics
import sys

from pages import write_table

LEVELS = (0.01, 0.001, 0.0001)
ERRORS = {"E1.own.bulk.mean_abs@mean": "own equation", "E1.own.bulk.compression@mean": "compression",
          "E1.measure.bulk.mean_abs@mean": "density"}
PEERS = {"splishsplash-dfsph": "DFSPH", "splishsplash-pbf": "SPlisHSPlasH's PBF"}
OWN = "this library"
FEW_FIGURES = ("E1.own.bulk.mean_abs@mean", "E1.own.bulk.compression@mean", "E1.own.all.compression_mean@mean",
               "E1.own.all.compression_max@largest", "E2.relative@largest")
FEW = "cube-collapse"  # a few settings, told one by one


def method(point):
    return PEERS.get(point["family"], OWN)


def setting(point):
    return point["label"] + (", pressure grid" if point["family"] == "grid" else "")


def seconds(point):
    return statistics.median(point["seconds"])


def measured(scene, error):
    """(method, seconds for one simulated, error, setting) of what has all of them."""
    return [(method(p), seconds(p), p["errors"][error], setting(p)) for p in scene["points"]
            if p["seconds"] and p["errors"].get(error) is not None]


def cheapest(points, level):
    return min((p for p in points if p[2] <= level), key=lambda p: p[1], default=None)


def beaten_by(points, others):
    """Those of `points` that nothing in `others` is at least as fast and as exact as."""
    return [p for p in points if not any(o[1] <= p[1] and o[2] <= p[2] for o in others)]


def significant(value):
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def percent(error):
    return f"{significant(100 * error)} %"


def lines_of(head, rows, left):
    rule = ["---"] * left + ["--:"] * (len(head) - left)
    return ["| " + " | ".join(row) + " |" for row in (head, rule, *rows)]


def level_cells(points, own):
    cells = []
    for level in LEVELS:
        best, mine = cheapest(points, level), cheapest(own, level)
        cells.append("never" if best is None else f"{significant(best[1])} s")
        cells.append("" if best is None or mine is None or points is own else significant(best[1] / mine[1]))
    return cells


def hull_rows(results):
    rows = []
    for error, name in ERRORS.items():
        for scene, result in results["scenes"].items():
            if scene == FEW:
                continue
            points = measured(result, error)
            own = [p for p in points if p[0] == OWN]
            for who in (*PEERS.values(), OWN):
                found = [p for p in points if p[0] == who]
                if found:
                    better = "" if who == OWN else str(len(beaten_by(found, own)))
                    rows.append((name, f"`{scene}`", who, percent(min(p[2] for p in found)),
                                 *level_cells(own if who == OWN else found, own), better))
    return rows


HULL_HEAD = ("error", "scene", "method", "min error",
             *(word for level in LEVELS for word in (f"{100 * level:g} %", "×")), "below the library's hull")


def few_rows(result):
    order = lambda p: (method(p) == OWN, p["family"] if method(p) != OWN else "", seconds(p))  # noqa: E731
    step = result["time_step"]
    return [(method(p), setting(p), significant(1000 * seconds(p) * step),
             f'{significant(1000 * min(p["seconds"]) * step)} … {significant(1000 * max(p["seconds"]) * step)}',
             *(percent(p["errors"][figure]) for figure in FEW_FIGURES))
            for p in sorted((p for p in result["points"] if p["seconds"]), key=order) if set(FEW_FIGURES) <= set(p["errors"])]


FEW_HEAD = ("method", "setting", "ms a step", "min … max", "own equation", "compression", "compression, all", "largest",
            "volume")


def source(results):
    told = []
    for scene, r in results["scenes"].items():
        runs = max(len(p["seconds"]) for p in r["points"])
        told.append(f'`{scene}`: {r["particles"]:,} particles, {r["simulated"]:.3g} s, step {1000 * r["time_step"]:.3g} ms '
                    f'where not divided, {runs} run{"s" if runs > 1 else ""} a setting')
    first = next(iter(results["scenes"].values()))
    return (f'{results["peer"]} and commit {first["commit"]} by turns on one machine ({first["cpu_model"]}), one thread '
            "each, processor time. " + "; ".join(told) + ".")


def tables(results):
    lines = [source(results), "", *lines_of(HULL_HEAD, hull_rows(results), 3)]
    if FEW in results["scenes"]:
        lines += ["", f"`{FEW}`:", "", *lines_of(FEW_HEAD, few_rows(results["scenes"][FEW]), 2)]
    return "\n".join(lines)


def main(path):
    results = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    write_table("docs/notes/other-solvers.md", "peers", tables(results))
    if FEW in results["scenes"]:
        write_table("docs/error-and-speed.md", "peers", "\n".join(lines_of(FEW_HEAD, few_rows(results["scenes"][FEW]), 2)))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
