"""Fluid that sleeps: as the awake run, and awake on touch."""
import numpy as np

from .everywhere import fastest
from .figure import at_least, at_most, exactly
from .files import first, frames, last
from .shared import noise, volume
from .same import different


def sleep_and_wake(files):
    asleep, awake, woken = files.trial("asleep"), files.trial("awake"), files.trial("woken")
    touched = files.trial("touched")
    count, d = len(first(asleep).positions), awake.rest_spacing
    usual = np.mean([volume(awake, f) for f in frames(awake)])
    unit = np.sqrt(np.linalg.norm(awake.manifest.gravity) * d)
    woken_frames = frames(woken)[1:]
    gap = files.fact("gap at the touch") / d
    moved = np.linalg.norm(last(touched).positions - first(touched).positions, axis=1).max() / d
    return [exactly("awake, of those that should sleep", count - files.fact("asleep")),
            exactly("numbers that changed in sleep", different(first(asleep), last(asleep))),
            at_most("volume asleep, off that of the awake run by", abs(volume(asleep, last(asleep)) / usual - 1), 0.01),
            exactly("asleep after a change of parameters", files.fact("asleep after the change")),
            at_most("noise after waking, over sqrt(g d)", max(noise(woken, f) for f in woken_frames), 0.1),
            at_most("fastest after waking, over sqrt(g d)", max(fastest(f) for f in woken_frames) / unit, 1),
            exactly("awake before the touch", count - files.fact("asleep before the touch")),
            exactly("none awake at the touch", files.fact("asleep at the touch") == count),
            at_least("share still asleep at the touch", files.fact("asleep at the touch") / count, 0.5),
            at_least("ball from the fluid as it wakes, in spacings", gap, 0),
            at_most("ball from the fluid as it wakes, in spacings (h is 2)", gap, 2),
            at_least("moved by the ball, in spacings", moved, 0.5)]
