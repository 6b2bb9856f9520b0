#!/usr/bin/env python3
"""Writes the README's speed-up table from a result of `pbf-bench speedup --json`.

    bench/tools/readme_table.py bench/results/nvidia-h200/speedup.json
"""
import json
import pathlib
import sys

from pages import write_table

REPORT_MS = {"naive": 29904, "openmp": 2557, "cuda": 768}  # the report's own figures, 100 steps
HEAD = ("backend", "device", "threads", "ms for 100 steps", "min … max", "× naive", "the report: ms",
        "× the report", "density error")


def significant(value):
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def cells(row):
    _, backend, threads = row["name"].split("/")
    count = threads.split(":")[1]
    report = REPORT_MS.get(backend)
    if row.get("error_occurred"):
        return (backend, "", "", row["error_message"], "", "", "", "", "")
    return (backend, row["label"], "" if backend == "cuda" else count, significant(row["real_time"]),
            f"{significant(row['ms_min'])} … {significant(row['ms_max'])}",
            significant(row["speedup_vs_naive"]), f"{report:,}" if report else "",
            significant(report / row["real_time"]) if report else "",
            f"{100 * row['density_error_mean']:.1f} %")


def table(result):
    lines = ["| " + " | ".join(HEAD) + " |", "| --- | --- " + "| --: " * (len(HEAD) - 2) + "|"]
    lines += ["| " + " | ".join(cells(row)) + " |" for row in result["benchmarks"]
              if row["run_type"] == "iteration"]
    context = result["context"]
    runs = max(row["repetitions"] for row in result["benchmarks"])
    builds = sorted({value for key, value in context.items() if key.startswith("build_")})
    lines += ["", f"Medians, {context['cpu_model']} with {context['num_cpus']} CPUs, "
              f"library {'; '.join(builds)}, commit {context['commit']}. The naive row is one run, the "
              f"others {runs}. The density error is that of the scene's own parameters, which ask for "
              "a rest density that 5 iterations do not reach: every row makes the same error."]
    return "\n".join(lines)


def main(path):
    result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    write_table("README.md", "speedup", table(result))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
