#!/usr/bin/env python3
"""Rivals of the density solve's acceleration: error against pairs of passes over neighbours.

    bench/tools/rivals.py measure BUILD RESULT.json    runs BUILD's pbf-bench, judges with pbf-check
    bench/tools/rivals.py table RESULT.json            writes the tables in docs/notes/solver-alternatives.md

BUILD has bench/results/…/rivals.patch applied: one thread, `serial` only, methods chosen by the
environment. RESULT.json is written after every run, and a run that it has is not done again.
"""
import csv
import json
import math
import multiprocessing
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import types

from pages import ROOT, write_table

sys.path.insert(0, str(ROOT / "check"))
from pbfcheck.dump import Dump  # noqa: E402  (the package is found by the line before)
from pbfcheck.judge import errors_of  # noqa: E402

FRAMES = 4
PERTURBATIONS = (0, 1e-3)  # of gravity: a splash is another one each time
SPACING, GRAVITY, TIME_STEP = 0.05, 9.81, 1 / 120  # of all scenes, before --particles scales them


def column(layers, columns, grid):
    return {"version": 1, "description": "A column of water at rest", "purpose": "Deep water", "dimension": 3,
            "params": {"smoothing_radius": 2 * SPACING, "spacing": SPACING, "time_step": TIME_STEP,
                       "gravity": [0, -GRAVITY, 0], "pressure_grid": grid,
                       "domain_max": [columns * SPACING, 1.3 * layers * SPACING, columns * SPACING]},
            "blocks": [{"shape": "box", "min": [0, 0, 0], "max": [columns * SPACING, layers * SPACING, columns * SPACING]}],
            "steps": 480, "scaling": {"rule": "refine"}}


# name: scene, --particles, steps, further settings
SCENES = {
    "dam-break-3d": ("dam-break-3d", 3840, 90, ["pressure_grid=0"]),
    "drop-into-pool": ("drop-into-pool", 1720, 90, ["pressure_grid=0"]),
    "still-tank": ("still-tank", 2560, 240, ["pressure_grid=0"]),
    "column-40": (column(40, 12, 0), None, 480, []),
    "column-100": (column(100, 8, 2), None, 480, []),
}


def method(name, iterations, divide=1, **environment):
    return [{"method": name, "iterations": n, "divide": divide, "environment": environment} for n in iterations]


def methods():
    points = method("Chebyshev", (2, 3, 4, 5, 6, 8, 16, 32, 64))
    points += method("warm start, 0.25 of λ", (2, 4, 8), RIVAL="cheb", RIVAL_WARM=0.25)
    points += method("warm start, 0.5 of λ", (4,), RIVAL="cheb", RIVAL_WARM=0.5)
    points += method("warm start, 0.5 of λ smoothed", (4, 8), RIVAL="cheb", RIVAL_WARM=0.5, RIVAL_WARM_TYPE=3)
    points += method("warm start, 0.75 of λ smoothed", (2, 4, 8), RIVAL="cheb", RIVAL_WARM=0.75, RIVAL_WARM_TYPE=3)
    points += method("warm start, 0.75 of λ smoothed longer", (2, 4, 8), RIVAL="cheb", RIVAL_WARM=0.75, RIVAL_WARM_TYPE=3, RIVAL_EMA=0.05)
    points += method("Chebyshev, Δt/2", (1, 2, 4), divide=2) + method("Chebyshev, Δt/4", (1, 2), divide=4)
    points += method("divergence-free solve after it: 1", (4,), RIVAL_DF=1)
    points += method("divergence-free solve after it: 2", (2, 4, 8), RIVAL_DF=2)
    points += method("divergence-free solve after it: 4", (4,), RIVAL_DF=4)
    points += method("divergence-free solve after it: 2, warm", (4,), RIVAL_DF=2, RIVAL_DF_WARM=1)
    for omega in (1, 1.5, 1.7):
        points += method(f"Gauss-Seidel, ω = {omega}", (2, 4, 8), RIVAL="gs", RIVAL_OMEGA=omega)
    for omega in (1, 1.5):
        points += method(f"Gauss-Seidel, 8 colours, ω = {omega}", (4, 8), RIVAL="gs", RIVAL_OMEGA=omega, RIVAL_COLORS=8)
    for window in (1, 3, 5):
        points += method(f"Anderson, window {window}", (4, 8, 16), RIVAL="anderson", RIVAL_M=window)
    points += method("Anderson, window 5, restarted", (8, 16), RIVAL="anderson", RIVAL_M=5, RIVAL_FLIP=0.1)
    points += method("Jacobi, ω = 1.4", (4, 16, 64), RIVAL="jacobi", RIVAL_OMEGA=1.4)
    points += method("Jacobi, ω = 1.9", (4, 16, 64), RIVAL="jacobi", RIVAL_OMEGA=1.9)
    points += method("Nesterov, restarted", (4, 16, 64), RIVAL="nesterov")
    points += method("Chebyshev of the fourth kind", (4, 8, 16), RIVAL="cheb4")
    points += method("Chebyshev, restarted by the set", (8, 16), RIVAL="cheb", RIVAL_FLIP=0.02)
    points += method("Chebyshev, restarted by the gradient", (8, 16), RIVAL="cheb", RIVAL_RESTART=1)
    points += method("conjugate gradients", (4, 16), RIVAL="cg")
    points += method("Jacobi, ω = 1", (4, 16), RIVAL="jacobi", RIVAL_OMEGA=1) + method("Jacobi, ω = 0.5", (4, 16), RIVAL="jacobi", RIVAL_OMEGA=0.5)
    return points


def passes_a_step(point):
    """Pairs of passes: one finds densities, one moves."""
    environment = point["environment"]
    further = environment.get("RIVAL_DF", 0) + (0.5 if environment.get("RIVAL_DF_WARM") else 0)
    return point["iterations"] + further + (0.5 if environment.get("RIVAL_WARM") else 0)


def command(build, scene, point, steps, perturbation, folder):
    source, particles, _, settings = SCENES[scene]
    if not isinstance(source, str):
        path = folder / "scene.json"
        path.write_text(json.dumps(source), encoding="utf-8")
        source = path
    settings = [*settings, f"iterations={point['iterations']}", f"gravity=[0,{-GRAVITY * (1 + perturbation)},0]"]
    if point["divide"] > 1:
        settings.append(f"time_step={TIME_STEP / point['divide']}")
    words = [build / "bin" / "pbf-bench", "run", "--scene", source, "--backend", "serial", "--precision", "f32", "--steps", steps]
    if particles:
        words += ["--particles", particles]
    for setting in settings:
        words += ["--set", setting]
    return [str(word) for word in words]


def environment_of(point):
    return {**os.environ, **{key: str(value) for key, value in point["environment"].items()}}


OPTIONS = types.SimpleNamespace(measure_radius=3.0, coverage=0.95, wall_density="mirror", reference=None, floor=None, cell=4.0,
                                agree=0.1, gate_shift=0.0)


def judge(build, scene, point, perturbation):
    steps = SCENES[scene][2] * point["divide"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        words = command(build, scene, point, steps, perturbation, folder)
        subprocess.run(words + ["--dump", str(folder / "dump"), "--every", str(steps // FRAMES), "--csv", str(folder / "trace.csv")],
                       check=True, stdout=subprocess.DEVNULL, env=environment_of(point))
        with open(folder / "trace.csv", encoding="utf-8") as file:
            trace = list(csv.DictReader(file))
        dump = Dump(str(folder / "dump"))
        errors = errors_of(dump, dump.steps[1:], ["E1", "E2", "E6"], OPTIONS)
    e1 = errors["E1"]["summary"]
    later = trace[len(trace) // 6:]
    last = trace[-len(trace) // 4:]
    energies = [float(row["kinetic_energy"]) + GRAVITY * (1 + perturbation) * float(row["com_y"]) for row in trace]
    return {"E1 mean": e1["measure.interior.mean_abs"]["mean"], "E1 p99": e1["measure.interior.p99"]["mean"],
            "E1 own mean": e1["own.interior.mean_abs"]["mean"], "E1 own p99": e1["own.interior.p99"]["mean"],
            "excess mean": statistics.mean(float(row["density_error_mean"]) for row in later),
            "excess most": statistics.mean(float(row["density_error_max"]) for row in later),
            "energy": energies[-1] / energies[0], "energy most": max(energies) / energies[0],
            "volume": errors["E2"]["summary"]["relative"]["last"],
            "speed": statistics.mean(2 * float(row["kinetic_energy"]) for row in last) ** 0.5 / (GRAVITY * SPACING) ** 0.5}


def processor_time(words, environment):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, env=environment)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def times_of(build, scene, runs=3):
    """Milliseconds a step of the library as it is."""
    rows = {}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for iterations in (2, 4, 8, 16):
            point = {"iterations": iterations, "divide": 1, "environment": {}}
            steps = SCENES[scene][2]
            ends = [min(processor_time(command(build, scene, point, n, 0, folder), environment_of(point)) for _ in range(runs)) for n in (1, steps)]
            rows[iterations] = 1e3 * (ends[1] - ends[0]) / (steps - 1)
    return rows


def task(job):
    build, scene, point, perturbation = job
    try:
        return judge(build, scene, point, perturbation)
    except Exception as error:  # a rival that falls apart is a result, too
        return {"failed": str(error)[:200]}


def key_of(row):
    return json.dumps([row["scene"], row["method"], row["iterations"], row["divide"], row["environment"], row["perturbation"]], sort_keys=True)


def is_run(scene, point, perturbation):
    """Not all are worth their time: the pressure grid hides who iterates how, and scalar loops take a minute."""
    name, iterations = point["method"], point["iterations"]
    if perturbation and scene != "dam-break-3d":
        return False
    if scene == "column-100":
        return any(word in name for word in ("Chebyshev", "start", "diverg")) and "restart" not in name and "kind" not in name
    return scene != "column-40" or not ("Gauss" in name and iterations != 4 or iterations == 64 and name != "Chebyshev")


def measure(build, result):
    data = json.loads(result.read_text(encoding="utf-8")) if result.exists() else {"rows": [], "times": {}}
    done = {key_of(row) for row in data["rows"]}
    rows = [{"scene": scene, **point, "perturbation": perturbation} for point in methods() for scene in SCENES
            for perturbation in PERTURBATIONS if is_run(scene, point, perturbation)]
    rows = [row for row in rows if key_of(row) not in done]
    with multiprocessing.Pool(2) as pool:
        jobs = [(build, row["scene"], row, row["perturbation"]) for row in rows]
        for number, (row, figures) in enumerate(zip(rows, pool.imap(task, jobs))):
            data["rows"].append({**row, "passes": passes_a_step(row) * row["divide"], "figures": figures})
            if number % 6 == 0 or number + 1 == len(rows):
                result.write_text(json.dumps(data, indent=0), encoding="utf-8")
                print(number + 1, "of", len(rows), flush=True)
    for scene in SCENES:
        if scene not in data["times"]:
            data["times"][scene] = times_of(build, scene)
            result.write_text(json.dumps(data, indent=0), encoding="utf-8")


def means(data):
    """{scene: {(method, iterations, divide): {figure: mean over perturbations}}}, without runs that fell apart."""
    runs = {}
    for row in data["rows"]:
        if "failed" not in row["figures"]:
            key = (row["method"], row["iterations"], row["divide"])
            runs.setdefault(row["scene"], {}).setdefault(key, []).append(row)
    return {scene: {key: {**{name: statistics.mean(row["figures"][name] for row in rows) for name in rows[0]["figures"]},
                          "passes": rows[0]["passes"] / rows[0]["divide"]} for key, rows in points.items()}
            for scene, points in runs.items()}


def line(times):
    """(milliseconds a step without iterations, milliseconds an iteration): least squares."""
    x, y = [int(n) for n in times], list(times.values())
    each = statistics.covariance(x, y) / statistics.variance(x)
    return statistics.mean(y) - each * statistics.mean(x), each


def chebyshev_at(points, figure, iterations):
    """Chebyshev's error with so many iterations: straight in its logarithm between those that were run."""
    known = sorted((n, at[figure]) for (name, n, divide), at in points.items() if name == "Chebyshev" and divide == 1)
    for (n0, e0), (n1, e1) in zip(known, known[1:]):
        if n0 <= iterations <= n1:
            s = (iterations - n0) / (n1 - n0)
            return math.exp((1 - s) * math.log(e0) + s * math.log(e1))
    return None


def ratio(points, cost, key, figure):
    """Error over Chebyshev's for the same time."""
    at = points.get(key)
    if at is None:
        return ""
    fixed, each = cost
    same_time = (key[2] * (fixed + each * at["passes"]) - fixed) / each
    own = chebyshev_at(points, figure, same_time)
    return "" if own is None else f"{at[figure] / own:.2g}"


RATIOS = [("excess mean", "dam-break-3d"), ("excess mean", "drop-into-pool"), ("excess mean", "still-tank"), ("excess mean", "column-40"),
          ("excess mean", "column-100"), ("E1 mean", "dam-break-3d"), ("E1 mean", "drop-into-pool"), ("E1 mean", "still-tank"), ("E1 p99", "dam-break-3d")]


def is_shown(name, iterations, divide):
    """The others are in the results, and say the same."""
    return divide > 1 or "longer" in name or iterations in (4, 8, 16) and name not in ("Jacobi, ω = 0.5", "Anderson, window 3")


def method_rows(data):
    points, rows = means(data), []
    costs = {scene: line(times) for scene, times in data["times"].items()}
    for point in methods():
        key = (point["method"], point["iterations"], point["divide"])
        if key[0] == "Chebyshev" or not is_shown(*key):
            continue
        cells = [ratio(points[scene], costs[scene], key, figure) for figure, scene in RATIOS]
        dam, tank, column = (points[scene].get(key) for scene in ("dam-break-3d", "still-tank", "column-40"))
        cells += [f"{100 * dam['energy']:.1f} %" if dam else "", f"{tank['speed']:.2f}" if tank else "", f"{column['speed']:.2f}" if column else ""]
        rows.append(f"| {key[0]} | {key[1]} | {passes_a_step(point):g} | " + " | ".join(cells) + " |")
    return rows


def percent(value):
    return f"{100 * value:.2g} %" if value >= 1e-7 else "0 %"


def chebyshev_rows(data):
    points, rows = means(data), []
    for n in sorted(n for name, n, divide in points["dam-break-3d"] if name == "Chebyshev"):
        cells = []
        for scene in SCENES:
            at = points[scene][("Chebyshev", n, 1)]
            cells += [f"{percent(at['excess mean'])}, {percent(at['E1 mean'])}"]
        at = [points[scene][("Chebyshev", n, 1)] for scene in ("dam-break-3d", "still-tank", "column-40")]
        fixed, each = line(data["times"]["dam-break-3d"])
        cells += [percent(at[0]["E1 p99"]), f"{100 * at[0]['energy']:.1f} %", f"{at[1]['speed']:.2f}", f"{at[2]['speed']:.2f}", f"{fixed + each * n:.2f}"]
        rows.append(f"| {n} | " + " | ".join(cells) + " |")
    return rows


def table(result):
    data = json.loads(result.read_text(encoding="utf-8"))
    write_table("docs/notes/solver-alternatives.md", "rivals-own", "\n".join([
        "| iterations | dam break | drop | tank | 40 layers | 100 layers | dam: p99 | energy | tank: speed | 40: speed | ms |",
        "| --: " * 11 + "|"] + chebyshev_rows(data)))
    write_table("docs/notes/solver-alternatives.md", "rivals", "\n".join([
        "| method | iterations | passes | dam: excess | drop | tank | 40 | 100 | dam: E1 | drop | tank | dam: p99 | energy | tank: speed | 40: speed |",
        "| --- " + "| --: " * 14 + "|"] + method_rows(data)))


if __name__ == "__main__":
    if sys.argv[1] == "measure":
        measure(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]))
    else:
        table(pathlib.Path(sys.argv[2]))
