#!/usr/bin/env python3
"""Error against run time, this library beside SPlisHSPlasH, on one machine by turns:

    bench/peers/hull.py --program build/release/bin/pbf-bench --peer VENV/bin/python --json FILE [SCENE ...]

README.md beside this file says how. Started again with the same file, it does what is missing.
"""
import argparse
import itertools
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

import peer
import setup

HERE = pathlib.Path(__file__).resolve().parent
CHECK = HERE.parents[1] / "check" / "pbf-check"
FEW = 20000  # particles above which a scene gets few settings


def products(vary):
    """Every combination of the lists in each of `vary`."""
    for lists in vary:
        for values in itertools.product(*lists.values()):
            yield dict(zip(lists, values))


def configuration(settings):
    """The peer's parameters of a setting; a number of iterations is its least and its most."""
    found = {key: value for key, value in settings.items() if key not in ("divide_time_step", "iterations")}
    if "iterations" in settings:
        found.update(minIterations=settings["iterations"], maxIterations=settings["iterations"])
    return found


def label(settings):
    words = {"iterations": "{} iterations", "maxError": "tolerance {} %", "maxErrorV": "of divergence {} %"}
    told = [words[key].format(value) for key, value in settings.items() if key in words]
    divide = settings["divide_time_step"]
    return ", ".join([*told, "Δt" if divide == 1 else f"Δt/{divide}"])


def value(frame, key):
    """The compression of a set of particles is the mean of max(e, 0), half of the mean of |e| and of e."""
    if key.endswith(".compression"):
        of = key.removesuffix("compression")
        size, signed = frame.get(of + "mean_abs"), frame.get(of + "mean_signed")
        return None if size is None else (size + signed) / 2
    return None if frame.get(key) is None else abs(frame[key])


def figure(report, name):
    """As pbf-bench pareto reads it: over the frames after the start."""
    entry, rest = name.split(".", 1)
    key, over = rest.split("@")
    values = [value(frame, key) for frame in report["errors"][entry]["frames"][1:]]
    values = [v for v in values if v is not None]
    if not values:
        return None
    return max(values) if over == "largest" else sum(values) / len(values)


def judged(folder, figures):
    keys = ",".join(sorted({name.split(".")[0] for name in figures}))
    report = folder / "report.json"
    command = [sys.executable, "-B", str(CHECK), "errors", str(folder), "--only", keys, "--json", str(report)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, "can't be judged: " + done.stderr.strip().splitlines()[-1]
    found = json.loads(report.read_text(encoding="utf-8"))
    return {name: figure(found, name) for name in figures}, ""


class Scene:
    def __init__(self, name, entry, args, scratch):
        self.name, self.entry, self.args, self.scratch = name, entry, args, scratch
        start = scratch / "start"
        self.options = ["--scene", name, "--particles", str(entry["particles"])]
        subprocess.run([args.program, "run", *self.options, "--backend", "serial", "--threads", "1", "--steps", "1",
                        "--dump", str(start)], check=True, stdout=subprocess.DEVNULL)
        self.positions = np.load(start / "positions_000000.npy")
        self.manifest = json.loads((start / "dump.json").read_text(encoding="utf-8"))

    def planes(self):
        """Those of the peer's wall particles."""
        low, high, spacing = (self.manifest[key] for key in ("domain_min", "domain_max", "spacing"))
        return (low, high) if self.entry.get("wall_particles_at_bounds") else setup.wall_planes(low, high, spacing)

    def job(self, family, settings):
        m, frames = self.manifest, self.entry["frames"]
        step = m["time_step"] / settings["divide_time_step"]
        steps = round(self.entry["duration"] / step)
        planes = self.planes()
        return {"method": family["method"], "spacing": m["spacing"], "planes": planes,
                "surfaces": setup.wall_surfaces(planes, m["spacing"]),
                "configuration": configuration(settings),
                "segments": [{"steps": steps, "time_steps": [step], "gravity": m["gravity"]}],
                "frames": [steps * k // frames for k in range(frames + 1)], "folder": str(self.scratch / "run")}


def run_peer(scene, family, settings, point, figures):
    job = scene.job(family, settings)
    shutil.rmtree(job["folder"], ignore_errors=True)
    result, reason = peer.run(scene.args.peer, scene.scratch, job, scene.positions, limit=scene.args.limit)
    if result is None:
        point["reason"] = reason
        return
    point["seconds"].append(result["seconds_cpu"] / scene.entry["duration"])
    point["iterations_mean"] = result["iterations"] / result["steps"]
    if set(figures) - set(point["errors"]):
        errors, reason = judged(pathlib.Path(job["folder"]), figures)
        point.update(errors=errors or {}, **({"reason": reason} if reason else {}))


def run_library(scene, repetitions, json_file):
    sweep = "sweep-few.json" if scene.entry["particles"] > FEW else "sweep.json"
    subprocess.run([scene.args.program, "pareto", *scene.options, "--duration", str(scene.entry["duration"]),
                    "--frames", str(scene.entry["frames"]), "--repetitions", str(repetitions), "--cpu-time",
                    "--patience", str(scene.args.limit), "--dumps", str(scene.scratch / "own"),
                    "--sweep", str(HERE / sweep), "--json", str(json_file),
                    "--html", str(scene.scratch / "pareto.html")], check=True, stdout=subprocess.DEVNULL)


def library_points(scene, json_file, known, figures):
    """The points of pbf-bench pareto as those of the peer, their dumps judged as its are."""
    results = json.loads(json_file.read_text(encoding="utf-8"))
    simulated = results["context"]["simulated"]
    titles = {f["family"]: f["title"] for entry in results["analysis"] for f in entry["families"]}
    points = []
    for index, point in enumerate(results["points"]):
        outcome, folder = point["outcome"], scene.scratch / "own" / str(index)
        errors = known.get((point["family"], point["label"]), {}).get("errors", {})
        if set(figures) - set(errors) and folder.exists():
            errors = judged(folder, figures)[0] or {}
            shutil.rmtree(folder)
        found = {"family": point["family"], "title": titles.get(point["family"], point["family"]), "label": point["label"],
                 "seconds": [s / simulated for s in outcome["seconds"]], "errors": errors}
        points.append({**found, "reason": outcome["reason"]} if outcome.get("reason") else found)
    return points, results["context"]


def measure(scene, result, plan, save):
    families = plan["few" if scene.entry["particles"] > FEW else "families"]
    points = {(p["family"], p["label"]): p for p in result["points"]}
    own = pathlib.Path(f"{scene.args.json}.{scene.name}")
    for round_ in range(1, scene.args.repetitions + 1):
        for family in families:
            for settings in products(family["vary"]):
                new = {"family": family["name"], "title": family["title"], "label": label(settings), "seconds": [],
                       "errors": {}}
                point = points.setdefault((family["name"], label(settings)), new)
                if point.get("reason") or len(point["seconds"]) >= round_:
                    continue
                run_peer(scene, family, settings, point, plan["figures"])
                result["points"] = list(points.values())
                save()
        run_library(scene, round_, own)
        added, context = library_points(scene, own, points, plan["figures"])
        planned = {(f["name"], label(settings)) for f in families for settings in products(f["vary"])}
        points = {key: p for key, p in points.items() if key in planned}  # a plan may have changed in between
        points.update({(p["family"], p["label"]): p for p in added})
        result.update(points=list(points.values()), particles=len(scene.positions),
                      time_step=scene.manifest["time_step"], simulated=scene.entry["duration"],
                      cpu_model=context["cpu_model"], commit=context["commit"])
        save()


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="pbf-bench")
    parser.add_argument("--peer", required=True, help="a Python that has pysplishsplash")
    parser.add_argument("--json", required=True, help="results; goes on where this file ends")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--limit", type=int, default=600, help="seconds for one run")
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    return parser.parse_args()


def main():
    args, plan = options(), json.loads((HERE / "hull.json").read_text(encoding="utf-8"))
    path = pathlib.Path(args.json)
    results = {"peer": "SPlisHSPlasH 2.19.0", "scenes": {}}
    if path.exists():
        results = json.loads(path.read_text(encoding="utf-8"))

    def save():
        path.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")

    for name in args.scenes or plan["scenes"]:
        with tempfile.TemporaryDirectory() as scratch:
            scene = Scene(name, plan["scenes"][name], args, pathlib.Path(scratch))
            measure(scene, results["scenes"].setdefault(name, {"points": []}), plan, save)


if __name__ == "__main__":
    main()
