#!/usr/bin/env python3
"""Writes the README's speed-up table from a result of `pbf-bench speedup --json`, and its sentence on
GPUs from what bench/gpu.sh and bench/gpu-ranks.sh left.

    bench/tools/readme_table.py bench/results/nvidia-h200/speedup.json bench/results/nvidia-h200/times.json \\
        bench/results/nvidia-h200-x4/ranks-times.json bench/results/nvidia-h200-x2/ranks-largest.json
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
    errors = [row["density_error_mean"] for row in result["benchmarks"] if not row.get("error_occurred")]
    builds = sorted({value for key, value in context.items() if key.startswith("build_")})
    lines += ["", f"Medians, {context['cpu_model']} with {context['num_cpus']} CPUs, "
              f"library {'; '.join(builds)}, commit {context['commit']}. The naive row is one run, the "
              f"others {runs}. The density error is that of the scene's own parameters, which ask for "
              "a rest density that 5 iterations do not reach; "
              f"the rows have {100 * min(errors):.1f} … {100 * max(errors):.1f} %."]
    return "\n".join(lines)


def lines_of(path):
    return [json.loads(line) for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines()]


def time_of(rows, million, **wanted):
    """Milliseconds a step, and the device, of the first row of about so many million particles."""
    row = next(row for row in rows if abs(row["particles"] / (million * 1e6) - 1) < 0.02
               and all(row[key] == value for key, value in wanted.items()))
    return f"{row['ms_per_step']:.3g} ms", row["device"].replace("NVIDIA ", "").split()[0]


def gpus(times, ranks, largest):
    """The defaults, h of two spacings in float32, of one dam break."""
    usual = [row for row in times if row["support"] == 2 and row["extra"] == ""]
    one, device = time_of(usual, 1)
    alone, other = time_of(ranks, 16, ranks=0)
    four, _ = time_of(ranks, 16, ranks=4)
    billion, _ = time_of(largest, 1000, ranks=2)
    return (f"A million particles in 3D take {one} a step on an {device}; 16 million {alone} on an {other}, "
            f"and {four} on [four](docs/many-ranks.md#gpus); a billion fit on two, and take {billion}.")


def main(speedup, times, ranks, largest):
    result = json.loads(pathlib.Path(speedup).read_text(encoding="utf-8"))
    write_table("README.md", "speedup", table(result))
    write_table("README.md", "gpus", gpus(*map(lines_of, (times, ranks, largest))))


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
