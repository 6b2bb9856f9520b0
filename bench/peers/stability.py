#!/usr/bin/env python3
"""The stiff and extreme cases on SPlisHSPlasH, judged by pbf-check like this library:

    build/release/bin/pbf-bench stability --quick --backend serial --only-dump --dump out/own
    bench/peers/stability.py --own out/own --peer VENV/bin/python --out out/peers
    check/pbf-check stability out/peers
"""
import argparse
import json
import pathlib
import resource
import shutil
import tempfile
import time

import peer
import replay
import setup

VARIANTS = {  # method, and what the cases' time step is divided by: its own scenes take 1 to 5 ms at this spacing
    "pbf": ("pbf", 1), "pbf-quarter": ("pbf", 4), "dfsph-quarter": ("dfsph", 4)}


def place(trial, number, job, result, divide, offset, to):
    """Moves a trial's frames from the run's folder into the case's."""
    to.mkdir(parents=True)
    times = {}
    for step in replay.frames(trial, number, offset, divide):
        times[str(step)] = result["times"][str(step)]
        for name in ("positions", "velocities"):
            shutil.copy(pathlib.Path(job["folder"]) / f"{name}_{step:06d}.npy", to)
    manifest = setup.manifest({**job, "segments": [replay.segment(trial, number, divide)]})
    iterations = result["iterations"] / max(result["steps"], 1)
    (to / "dump.json").write_text(json.dumps({**manifest, "times": times, "iterations": iterations}), encoding="utf-8")


def threads_of(trial):
    return int(trial.label.split("-")[1]) if trial.label.startswith("threads-") else 1


def run_case(case, variant, args, scratch):
    method, divide = VARIANTS[variant]
    number, own = int(case.name[:2]), case / args.backend
    facts = json.loads((own / "facts.json").read_text(encoding="utf-8"))
    told = {key: facts[key] for key in ("quick", "precision", "order", "mirror", "far") if key in facts}
    told.update(backend=variant, device="SPlisHSPlasH 2.19.0", build_id="pysplishsplash 2.19.0", trials=[], plan_bytes=0,
                steps=10, calls=[{"call": "run", "status": "PBF_OK", "sentence": ""}] * 2)
    folder, begun = args.out / case.name / variant, time.monotonic()
    shutil.rmtree(folder, ignore_errors=True)
    for trials in replay.runs(number, [replay.Trial(own / label) for label in facts["trials"]]):
        job = replay.job(trials, number, method, divide, scratch / "run")
        shutil.rmtree(job["folder"], ignore_errors=True)
        positions, velocities = trials[0].start()
        result, reason = peer.run(args.peer, scratch, job, replay.piled(number, positions), velocities,
                                  threads=threads_of(trials[0]), limit=args.limit)
        if result is None:
            told["failed"] = f"{trials[0].label}: {reason}"
            break
        for trial in trials:
            place(trial, number, job, result, divide, trials[0].steps[0], folder / trial.label)
            told["trials"].append(trial.label)
    told["seconds"] = time.monotonic() - begun
    told["peak_bytes"] = 1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "facts.json").write_text(json.dumps(told, indent=1), encoding="utf-8")


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--own", type=pathlib.Path, required=True, help="what pbf-bench stability --dump wrote")
    parser.add_argument("--backend", default="serial", help="… for this backend")
    parser.add_argument("--peer", required=True, help="a Python that has pysplishsplash")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--variant", action="append", choices=VARIANTS, default=[])
    parser.add_argument("--case", type=int, action="append", default=[])
    parser.add_argument("--limit", type=int, default=300, help="seconds for one run")
    return parser.parse_args()


def main():
    args = options()
    for case in sorted(args.own.iterdir()):
        number = int(case.name[:2])
        if args.case and number not in args.case:
            continue
        if number in replay.ABSENT or number in replay.NOT_DRIVEN or number in replay.OTHER_INTERFACE:
            continue
        for variant in args.variant or VARIANTS:
            done = (args.out / case.name / variant / "facts.json").exists()
            if done or (VARIANTS[variant][0], number) in replay.INCOMPARABLE:
                continue
            with tempfile.TemporaryDirectory() as scratch:
                run_case(case, variant, args, pathlib.Path(scratch))


if __name__ == "__main__":
    main()
