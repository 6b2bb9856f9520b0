#!/usr/bin/env python3
"""Writes the tables of error against run time into README.md, docs/error-and-speed.md and docs/notes/error-against-time.md, from
the results of `pbf-bench pareto --json`, one a scene.

    bench/tools/pareto_table.py bench/results/epyc-2-cores/pareto-*.json
"""
import json
import pathlib
import sys

from pages import write_table

SHORT = {"E1.measure.interior.mean_abs@mean": "density", "E1.own.bulk.mean_abs@mean": "own equation"}
LONG = ("E1.measure.interior.mean_abs@mean", "E1.measure.interior.p99@mean", "E1.own.bulk.mean_abs@mean",
        "E1.own.interior.p99@mean", "E2.relative@largest")
LEVELS = ("1 %", "0.1 %", "0.01 %")


def significant(value, digits=3):
    return f"{float(f'{value:.{digits}g}'):,.0f}" if value >= 100 else f"{value:.{digits}g}"


def percent(error):
    return f"{significant(100 * error)} %" if error > 1e-8 else "0"


def equal_time(family):
    """Median and range of the baseline's error over this family's at the same run time."""
    equal = family.get("at_equal_time")
    if not equal:
        return ""
    median, least, most = (significant(equal[key], 2) for key in ("median", "least", "most"))
    return f"{median} ({least} … {most})"


def level_cells(family):
    cells = []
    for level in family["levels"]:
        time = level.get("seconds_per_simulated")
        sign = {"exact": "", "at_least": "≥ ", "at_most": "≤ "}
        ratio = level.get("baseline_over_this")
        cells.append("never" if time is None else
                     ("≤ " if level.get("bound") else "") + f"{significant(time)} s")
        cells.append("" if ratio is None else sign[level["ratio_is"]] + significant(ratio))
    return cells


def families_of(result, figure):
    for entry in result["analysis"]:
        if entry["figure"] == figure:
            return entry["families"]
    return []


def hull(families):
    """Settings that none of any family beats, fastest first."""
    points = sorted((point["seconds_per_simulated"], point["error"], family["title"], point["label"])
                    for family in families for point in family["front"])
    best, kept = float("inf"), []
    for point in points:
        if point[1] < best:
            best = point[1]
            kept.append(point)
    return kept


def lines_of(head, rows, left):
    rule = ["---"] * left + ["--:"] * (len(head) - left)
    return ["| " + " | ".join(row) + " |" for row in (head, rule, *rows)]


def compared(result, families, first):
    """`first`: of a short table, which has the baseline, the subject and who comes nearest to 0."""
    rows = []
    nearest = min(families, key=lambda family: family["front"][-1]["error"], default={"family": None})
    short = (result["context"]["baseline"], result["context"]["subject"], nearest["family"])
    for family in families:
        if first and family["family"] not in short:
            continue
        base = family["family"] == result["context"]["baseline"]
        rows.append((*first, family["title"], percent(family["front"][-1]["error"]),
                     "" if base else equal_time(family),
                     *("" if base and i % 2 else cell for i, cell in enumerate(level_cells(family)))))
    return rows


def head(*first):
    return (*first, "min error", "÷ at equal time", *(word for level in LEVELS for word in (level, "×")))


def source(result):
    context = result["context"]
    commits = sorted({point["outcome"]["commit"] for point in result["points"] if point["outcome"]})
    clock = "processor time" if context["clock"] == "cpu" else "wall time"
    return (f"{context['particles']:,} particles, {context['simulated']:.3g} s simulated, step "
            f"{1000 * context['time_step']:.3g} ms where not divided; {context.get('device_serial', context['cpu_model'])}, one thread, "
            f"{clock}, commit {', '.join(commits)}")


def short_table(results):
    rows = [row for figure, name in SHORT.items() for result in results
            for row in compared(result, families_of(result, figure), (name, f"`{result['context']['scene']}`"))]
    return lines_of(head("error", "scene", "method"), rows, 3)


FEW = {"plain": "the paper's plain method", "library": "the library", "wide-held": "the library, h = 3 d, `cohesion` 1"}


def few_table(results):
    """The density error alone: the least that a method comes to, and how long it takes to 1 %."""
    rows = []
    for result in results:
        families = {family["family"]: family for family in families_of(result, next(iter(SHORT)))}
        cells = []
        for name in FEW:
            least, to_one = percent(families[name]["front"][-1]["error"]), level_cells(families[name])[0]
            cells += [least, to_one]
        rows.append((f"`{result['context']['scene']}`", *cells))
    head = ("scene", *(word for title in FEW.values() for word in (f"{title}: least error", "time to 1 %")))
    return lines_of(head, rows, 1)


def long_tables(results):
    lines = []
    for result in results:
        lines += ["", f"## `{result['context']['scene']}`", "", f"{source(result)}."]
        for figure in LONG:
            families = families_of(result, figure)
            title = next(error["title"] for error in result["errors"] if error["figure"] == figure)
            lines += ["", f"**{title}** (`{figure}`)", ""]
            lines += lines_of(head("method"), compared(result, families, ()), 1)
            rows = [(f"{significant(time)} s", percent(error), title, label)
                    for time, error, title, label in hull(families)]
            lines += ["", *lines_of(("run time", "error", "on the hull", "setting"), rows, 0)]
    return lines[1:]


def main(paths):
    results = [json.loads(pathlib.Path(path).read_text(encoding="utf-8")) for path in paths]
    write_table("README.md", "error", "\n".join(few_table(results)))
    write_table("docs/error-and-speed.md", "pareto", "\n".join(short_table(results)))
    write_table("docs/notes/error-against-time.md", "pareto", "\n".join(long_tables(results)))


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
