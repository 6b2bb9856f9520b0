"""Drops, long runs, and calls that must be refused."""
import numpy as np

from .everywhere import centre, failed_calls, refusals
from .figure import at_least, at_most, exactly
from .files import first, frames, last
from .shared import momentum_drifts, noise, volume


def misuse(files):
    figures, note = refusals(files)
    return figures + [exactly("calls failed that should not", failed_calls(files))], note


def colliding_drops(files):
    dump = files.trial("drops")
    linear, angular = momentum_drifts(dump)
    start, end = first(dump), last(dump)
    left = start.velocities[:, 0] > 0
    gap = end.positions[~left, 0].mean() - end.positions[left, 0].mean()
    met = 1 - gap / (start.positions[~left, 0].mean() - start.positions[left, 0].mean())
    return [at_most("linear momentum, relative drift", linear, 1e-5),
            at_most("angular momentum, relative drift", angular, 1e-5),
            at_least("share of their distance that the drops have closed", met, 0.3)]


def _growth(files, label):
    tenth, end = (next(m["resident"] for m in files.fact("memory") if m["when"] == f"{label}, {when}")
                  for when in ("a tenth", "the end"))
    return (end - tenth) / 2**20


def long_runs(files):
    rest, motion = files.trial("rest"), files.trial("motion")
    d = rest.rest_spacing
    settled = [f for f in frames(rest) if f.step >= rest.steps[-1] / 10]
    drift = max(np.linalg.norm(centre(f) - centre(settled[0])) for f in settled) / d
    third = len(settled) // 3
    early = np.mean([noise(rest, f) for f in settled[:third]])
    late = np.mean([noise(rest, f) for f in settled[-third:]])
    kept = max(abs(volume(motion, f) / volume(motion, first(motion)) - 1) for f in frames(motion)[-10:])
    return [at_most("at rest: centre of mass drifts by, in spacings", drift, 0.01),
            at_most("at rest: noise at the end, over sqrt(g d)", late, 0.01),
            at_most("at rest: noise in the last third over the first", late / max(early, 1e-9), 1.05),
            at_most("at rest: volume lost or gained", abs(volume(rest, last(rest)) / volume(rest, first(rest)) - 1), 0.02),
            at_most("shaken: volume lost or gained", kept, 0.02),
            at_most("at rest: memory grown, MiB", _growth(files, "rest"), 1),
            at_most("shaken: memory grown, MiB", _growth(files, "motion"), 1)]
