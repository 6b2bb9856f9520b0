"""Sloshing tank and U-tube: periods of standing motion against linear theory."""
import numpy as np

from .fault import NotApplicable, UsageFault
from .oscillation import fit_oscillation
from .scene_axes import vertical
from .validation import Validation


def _period_figures(time, signal, exact):
    swing = fit_oscillation(time, signal)
    return {"period": swing.period, "period.exact": exact, "period.error": swing.period / exact - 1,
            "amplitude": swing.amplitude, "decay_time": swing.decay_time,
            "fit.residual": swing.residual}


class Sloshing(Validation):
    name = "sloshing"
    title = "sloshing tank"
    definition = (
        "Period of the mode k = n pi/L against omega^2 = g k tanh(k H), linear: small amplitudes. "
        "The mode's amplitude is 2 V/(L w) sum cos(k x_i), the elevation's projection on it; L from "
        "wall surface to wall surface, H the rest volume over the cross-section. --mode n.")
    bars = {"period.error": 0.02}

    def run(self, dump, frames, options):
        axis, _, g = vertical(dump.manifest)
        flow = 0 if axis != 0 else 1
        low, high = dump.manifest.walls.surfaces(0.0)
        sizes = high - low
        sides = [k for k in range(dump.dimension) if k != axis]
        if not np.all(np.isfinite(sizes[sides])):
            raise NotApplicable("the tank is open on a side")
        length = sizes[flow]
        width = float(np.prod([sizes[k] for k in sides if k != flow]))
        k = options.mode * np.pi / length
        rows, depth = [], None
        for frame in frames:
            depth = len(frame.positions) * dump.rest_volume / (length * width)
            phase = np.cos(k * (frame.positions[:, flow] - low[flow])).sum()
            rows.append({"step": frame.step, "time": frame.time,
                         "elevation": float(2 * dump.rest_volume / (length * width) * phase)})
        exact = 2 * np.pi / np.sqrt(g * k * np.tanh(k * depth))
        figures = _period_figures([r["time"] for r in rows], [r["elevation"] for r in rows], exact)
        return {**figures, "mode": options.mode, "length": float(length), "depth": float(depth)}, rows


class UTube(Validation):
    name = "u-tube"
    title = "U-tube"
    definition = (
        "Period of the level difference against omega^2 = 2 g/l, l the fluid's length along the tube "
        "(--length). The signal is the share of particles right of the middle (--middle, else that "
        "of the domain) less the share left of it.")
    bars = {"period.error": 0.02}

    def run(self, dump, frames, options):
        axis, _, g = vertical(dump.manifest)
        flow = 0 if axis != 0 else 1
        if not options.length or options.length <= 0:
            raise UsageFault("u-tube needs --length, the fluid's length along the tube, above 0")
        low, high = dump.manifest.walls.bounds(0.0)
        middle = options.middle if options.middle is not None else (low[flow] + high[flow]) / 2
        if not np.isfinite(middle):
            raise UsageFault("the domain is open: u-tube needs --middle")
        rows = []
        for frame in frames:
            side = np.sign(frame.positions[:, flow] - middle)
            rows.append({"step": frame.step, "time": frame.time, "difference": float(side.mean())})
        exact = 2 * np.pi / np.sqrt(2 * g / options.length)
        figures = _period_figures([r["time"] for r in rows], [r["difference"] for r in rows], exact)
        return {**figures, "length": options.length, "middle": float(middle)}, rows
