"""Forces and parameters that jump."""
from types import SimpleNamespace

from ..energy import Energy
from .figure import at_most
from .files import first, frames, last
from .shared import compression, energy_gain, noise, volume


def heavy(files):
    dump, after, settled = (files.trial(label) for label in ("heavy", "after", "settling"))
    worst = max(compression(dump, f).mean() for f in frames(dump))
    return [at_most("mean compression under 1,000 g", worst, 10),
            at_most("volume lost or gained, once recovered",
                    abs(volume(after, last(after)) / volume(settled, last(settled)) - 1), 0.01),
            at_most("speed at the end over sqrt(g d)", noise(after, last(after)), 0.1)]


def flipping_gravity(files):
    trials = [dump for _, dump in files.trials("second-")]
    start, end = trials[0], trials[-1]
    worst = max(compression(dump, f).mean() for dump in trials for f in frames(dump))
    gain = max(energy_gain(dump) for dump in trials)
    return [at_most("volume lost or gained", abs(volume(end, last(end)) / volume(start, first(start)) - 1), 0.01),
            at_most("largest mean compression", worst, 0.25),
            at_most("energy gained between flips", gain, 1e-3)]


# Energy that a change may set free, over that of the fluid: 5 % more volume lifts it by 5 %.
JUMP = {"support-up": 0.02, "support-back": 0.02, "lighter": 0.1, "heavier": 0.02,
        "gravity-doubled": 0.005, "gravity-sideways": 0.005}


def sudden_changes(files):
    figures = []
    for label, dump in files.trials():
        if label in JUMP:
            measure = Energy(dump, SimpleNamespace())
            gain = max(measure.add(f)["relative"] for f in frames(dump))
            figures.append(at_most(f"{label}: energy gained", gain, JUMP[label]))
    return figures
