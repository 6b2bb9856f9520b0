"""One run: pbf-bench dumps it, pbf-check judges it, a few frames are kept for the plots."""
import contextlib
import glob
import io
import json
import os
import subprocess
import time
from dataclasses import dataclass

import numpy as np
from pbfcheck.cli import main as pbf_check

from . import ROOT
from .fault import RunFault

SCENES = os.path.join(ROOT, "bench", "scenes", "validation")


@dataclass
class Run:
    case: str
    finer: float
    particles: int
    seconds: float  # of the simulation, the dumps included
    dump: dict  # pbf-check's description of it
    reports: dict  # judgement → pbf-check's report
    pictures: list  # (time, positions, speeds) of a few frames


def scene_path(case):
    return os.path.join(SCENES, case.name + ".json")


def scene_of(case):
    with open(scene_path(case), encoding="utf-8") as file:
        return json.load(file)


def start(command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise RunFault(f"{command[0]} can't be started: {error.strerror}") from error
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip()).splitlines()
        said = words[-1] if words else "nothing"
        raise RunFault(f"{' '.join(command)} ended with {done.returncode} and said: {said}")


def _simulate(case, finer, options, folder):
    every = max(1, round(scene_of(case)["steps"] * finer / case.frames))
    command = [options.program, "run", "--scene", scene_path(case), "--backend", options.backend,
               "--precision", options.precision or case.precision, "--dump", folder,
               "--every", str(every)]
    if finer != 1:
        command += ["--finer", repr(float(finer))]
    if options.threads:
        command += ["--threads", str(options.threads)]
    for setting in options.set:
        command += ["--set", setting]
    began = time.monotonic()
    start(command)
    return time.monotonic() - began


def _judge(arguments, bounds, folder, report):
    """In this process, which has one thread: starting Python and SciPy would take longer than judging."""
    command = [*arguments, folder, "--json", report]
    for bound in bounds:
        command += ["--bound", bound]
    table, complaint = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(table), contextlib.redirect_stderr(complaint):
        code = pbf_check(command)
    if code not in (0, 1):
        raise RunFault(complaint.getvalue().strip())
    with open(report, encoding="utf-8") as file:
        return json.load(file)


def _add_decay(report):
    """The decay time of an oscillation counted in its exact periods."""
    for entry in report["validations"].values():
        figures = entry.get("figures", {})
        if "decay_time" in figures:
            decay = figures["decay_time"]
            figures["decay_periods"] = decay / figures["period.exact"] if decay else None


def _pictures(folder, time_step, wanted=3):
    paths = sorted(glob.glob(os.path.join(folder, "positions_*.npy")))
    chosen = sorted({round(k * (len(paths) - 1) / (wanted - 1)) for k in range(wanted)})
    pictures = []
    for path in (paths[k] for k in chosen):
        step = int(path[-10:-4])
        velocities = np.load(path.replace("positions_", "velocities_"))
        pictures.append((step * time_step, np.load(path), np.linalg.norm(velocities, axis=1)))
    return pictures


def run(case, finer, options, folder):
    """Runs and judges one case at one resolution in a folder of its own."""
    dump = os.path.join(folder, "dump")
    seconds = _simulate(case, finer, options, dump)
    report = os.path.join(folder, "report.json")
    reports = {"main": _judge(case.judge, case.quick if options.quick else (), dump, report),
               "energy": _judge(("errors", "--only", "E6"), (), dump, report)}
    for name, arguments in case.further.items():
        reports[name] = _judge(arguments, (), dump, report)
    _add_decay(reports["main"])
    described = reports["main"]["dump"]
    pictures = _pictures(dump, described["time_step"])
    return Run(case.name, finer, len(pictures[0][1]), seconds, described, reports, pictures)
