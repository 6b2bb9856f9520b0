"""Cases of pbf-bench stability as jobs for the peer: the same starts, steps and frames.

What a case does is read from what `pbf-bench stability --only-dump` has written for one of this library's
backends: a trial's dump holds its start, its forces, its time step and its frames.
"""
import json
import pathlib

import numpy as np

import setup

# Trials that go on where the one before ended; in the other cases every trial starts by itself.
CHAINED = {13, 14}
# Bodies whose walls are so far off that they would only be many wall particles.
FREE = {2, 29}
ABSENT = {16: "a plate 0.1 d thin: walls are particles d apart", 17: "a plate 0.1 d thin: walls are particles d apart",
          31: "it has no sleep"}
NOT_DRIVEN = {18: "moving walls", 19: "moving walls", 28: "h and volumes that change", 30: "a moving wall",
              32: "saved states", 34: "moving walls"}
# One step leaves DFSPH nothing to compare: it solves for a density that it predicts, at a pressure of its own.
INCOMPARABLE = {("dfsph", 12)}
OTHER_INTERFACE = {20, 21, 22, 23, 25, 26, 27}
# This library takes coincident particles apart when they are added, so that its dump is not the start.
PILES = {1: ((0.5, 0.5, 0.5),), 2: ((1, 1, 1), (1.05, 1.02, 1.01))}
FAR = {4096: "far-4096", 1000000: "far-1000000"}  # case 15 beside what this library runs


def piled(number, positions):
    """Each particle in the nearest of the points in which a case has put it."""
    if number not in PILES:
        return positions
    piles = np.array(PILES[number])
    nearest = np.linalg.norm(positions[:, None] - piles, axis=2).argmin(axis=1)
    return piles[nearest]


class Trial:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.label = self.folder.name
        self.manifest = json.loads((self.folder / "dump.json").read_text(encoding="utf-8"))
        self.steps = sorted(int(step) for step in self.manifest["times"])

    def start(self):
        first = f"{self.steps[0]:06d}.npy"
        return np.load(self.folder / f"positions_{first}"), np.load(self.folder / f"velocities_{first}")

    @property
    def spacing(self):
        return self.manifest["spacing"] or self.manifest["smoothing_radius"] / 2


def time_steps(trial, number):
    """The lengths of a trial's steps, which repeat."""
    step = trial.manifest["time_step"]
    return (step, 10 * step) if number == 10 and trial.label == "alternating" else (step,)


def repeated(number, divide):
    """Case 12 is about one step, however long; elsewhere the time is what stays."""
    return 1 if number == 12 else divide


def segment(trial, number, divide):
    count = (trial.steps[-1] - trial.steps[0]) * repeated(number, divide)
    return {"steps": count, "time_steps": [step / divide for step in time_steps(trial, number)],
            "gravity": trial.manifest["gravity"]}


def frames(trial, number, offset, divide):
    return [(step - offset) * repeated(number, divide) for step in trial.steps]


def job(trials, number, method, divide, folder):
    """One run: of one trial, or of several that go on from each other."""
    first = trials[0]
    m, spacing, offset = first.manifest, first.spacing, first.steps[0]
    planes = None if number in FREE else setup.wall_planes(m["domain_min"], m["domain_max"], spacing)
    bounds = setup.wall_planes(m["domain_min"], m["domain_max"], spacing)
    configuration = {}
    if number == 12:
        configuration = {"minIterations": m["iterations"], "maxIterations": m["iterations"], "maxError": 1e-6}
    return {"method": method, "spacing": spacing, "planes": planes, "surfaces": bounds,
            "configuration": configuration, "folder": str(folder),
            "segments": [segment(trial, number, divide) for trial in trials],
            "frames": sorted({f for trial in trials for f in frames(trial, number, offset, divide)})}


def shifted(trial, by):
    """The same trial elsewhere."""
    other = Trial(trial.folder)
    for key in ("domain_min", "domain_max"):
        other.manifest[key] = [c + by for c in other.manifest[key]]
    positions, velocities = trial.start()
    other.label = FAR[by]
    other.start = lambda: (positions.astype(np.float64) + by, velocities)
    return other


def runs(number, trials):
    """Lists of trials, one for each run."""
    if number in CHAINED:
        return [trials]
    more = [[shifted(trials[0], by)] for by in FAR] if number == 15 else []
    return [[trial] for trial in trials] + more
