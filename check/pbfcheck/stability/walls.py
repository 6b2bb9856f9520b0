"""Thin walls, pistons, thin domains, and particles that would leave."""
import numpy as np

from .figure import at_least, at_most, exactly
from .files import first, frames, last
from .everywhere import refusals
from .shared import compression, energy_gain, noise, volume
from .time_step import GAIN


def _crossed(dump, plate, speed=0.0):
    """Particles that were once beyond the plate, more than float32's rounding of its place."""
    beyond = np.zeros(len(first(dump).positions), bool)
    for frame in frames(dump):
        beyond |= frame.positions[:, 0] > (plate + speed * frame.time) * (1 + 1e-6)
    return int(beyond.sum())


def fast_at_thin_wall(files):
    plate = files.fact("plate")
    figures = [exactly(f"{label}: escaped through the plate", _crossed(files.trial(label), plate))
               for label in ("straight", "aslant")]
    swept = _crossed(files.trial("swept"), plate, files.fact("swept_speed"))
    figures.append(exactly("a plate at 50 h a step: left behind", swept))
    for label in ("straight", "aslant", "domain"):
        figures.append(at_most(f"{label}: energy gained", energy_gain(files.trial(label)), GAIN))
    return figures


def long_at_thin_wall(files):
    dump = files.trial("dam")
    return [exactly("escaped", _crossed(dump, files.fact("plate"))),
            at_most("speed at the end over sqrt(g d)", noise(dump, last(dump)), 0.1)]


def _depth(frame):
    return float(frame.positions[:, 1].mean())


def _recovered(files):
    settled, after = files.trial("settling"), files.trial("after")
    return [at_most("volume lost or gained, once recovered",
                    abs(volume(after, last(after)) / volume(settled, last(settled)) - 1), 0.01),
            at_most("speed at the end over sqrt(g d)", noise(after, last(after)), 0.3)]


def piston(files):
    dump = files.trial("stroke")
    deepest = max(_depth(f) for f in frames(dump)) / _depth(first(dump))
    worst = max(compression(dump, f).mean() for f in frames(dump))
    return [at_least("mean height at the stroke's end over that at first", deepest, 1.8),
            at_most("largest mean compression", worst, 0.15)] + _recovered(files)


def overfull_piston(files):
    dump = files.trial("stroke")
    squeezed = dump.frame(dump.steps[len(dump.steps) // 2])
    room = np.prod(np.subtract(*reversed(dump.manifest.walls.bounds(squeezed.time))))
    excess = len(squeezed.positions) * dump.rest_volume / room - 1
    told = files.fact("reported")["density_error_mean"]
    return [at_least("reported mean density error over the overload", told / excess, 0.3),
            at_least("mean compression over the overload", compression(dump, squeezed).mean() / excess, 0.5),
            ] + _recovered(files)


def thin_domain(files):
    # Eight particles that rise by a hundredth of a spacing gain that much.
    return [at_most(f"{label}: energy gained", energy_gain(dump), 0.01) for label, dump in files.trials()]


def leaving(files):
    figures, note = refusals(files)
    return figures, note
