"""E8: a collapsing column against Martin & Moyce 1952."""
import numpy as np

from .fault import NotApplicable
from .measure import Measure
from .scene_axes import vertical
from .spray import is_spray
from .stats import rms
from .surface import height_map
from .validation import Validation
from .validation_data import FRONT, HEIGHT, source, table

WIDTH_TO_HEIGHT = 2.0  # n^2 of the tables
BACK_STRIP = 2.0  # spacings


class DamBreak(Measure):
    key = "E8"
    title = "dam break"
    definition = (
        "A column a wide and 2a high at the low end of the flow axis. Front Z = x_front/a against "
        "table 2 at T = t sqrt(2 g/a): RMS of (Z - Z_exp)/Z_exp. Height at the back wall "
        "H = eta/(2a) against table 6 at tau = t sqrt(g/a), another time than T: RMS and max of "
        "H - H_exp. The front is half a spacing beyond the foremost particle that is not spray; eta "
        "is the half-density height over the 2 spacings next to the wall. Both are interpolated at "
        "the table's times, while the front has not met the far wall. `gate_shift` is added to T "
        "and, over sqrt(2), to tau. `best_shift` is no verdict: the shift of T that fits best.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.vertical, self.up, self.g = vertical(dump.manifest)
        self.flow = 0 if self.vertical != 0 else 1
        self.start = None

    def _begin(self, frame):
        d, x = self.dump.rest_spacing, frame.positions
        if frame.step != 0:
            raise NotApplicable("the column's size is read from step 0, which is not among the frames")
        low, high = x.min(axis=0) - d / 2, x.max(axis=0) + d / 2
        width, height = high[self.flow] - low[self.flow], high[self.vertical] - low[self.vertical]
        if abs(height / width - WIDTH_TO_HEIGHT) > 0.05 * WIDTH_TO_HEIGHT:
            raise NotApplicable(f"the first frame is {width:.6g} wide and {height:.6g} high; the tables "
                                "hold for a column twice as high as wide")
        self.start, self.a = low[self.flow], width
        self.floor = low[self.vertical] if self.up > 0 else -high[self.vertical]
        self.end = self.dump.manifest.walls.surfaces(0.0)[1][self.flow]

    def add(self, frame):
        if not len(frame.positions):
            raise NotApplicable(f"step {frame.step} has no particles")
        if self.start is None:
            self._begin(frame)
        d = self.dump.rest_spacing
        x = frame.positions[~is_spray(frame.positions, d)]
        if not len(x):
            raise NotApplicable(f"step {frame.step} has no fluid but spray")
        front = x[:, self.flow].max() + d / 2
        surfaces = self.dump.manifest.walls.surfaces(frame.time)
        strip = x[x[:, self.flow] < self.start + (BACK_STRIP + 3) * d]
        eta = 0.0
        if len(strip):
            top = height_map(strip, d, surfaces, self.vertical, self.up)
            along = top.columns[:, top.axes.index(self.flow)]
            near = along < self.start + BACK_STRIP * d
            if near.any():
                eta = np.average(top.heights[near], weights=top.weights[near]) - self.floor
        rate = np.sqrt(self.g / self.a)
        shift = self.options.gate_shift
        return {"T": float(np.sqrt(2) * rate * frame.time + shift),
                "tau": float(rate * frame.time + shift / np.sqrt(2)),
                "Z": float((front - self.start) / self.a), "H": float(eta / (2 * self.a)),
                "met_far_wall": bool(front > self.end - d)}

    def finish(self, rows):
        free = [row for row in rows if not row["met_far_wall"]]
        if len(free) < 2:
            raise NotApplicable("fewer than two frames before the front meets the far wall")
        time, tau, z, h = (np.array([row[k] for row in free]) for k in ("T", "tau", "Z", "H"))
        front, height = table(FRONT), table(HEIGHT)
        error = front_errors(time, z, front)
        within = (height["tau"] >= tau[0]) & (height["tau"] <= tau[-1])
        apart = np.interp(height["tau"][within], tau, h) - height["H"][within]
        shifts = np.linspace(-0.5, 0.5, 201)
        fits = [rms(front_errors(time + s, z, front)) for s in shifts]
        best = int(np.argmin(fits))
        return {"front.rms": rms(error), "front.mean_signed": float(error.mean()),
                "front.points": len(error), "height.rms": rms(apart),
                "height.max": float(np.abs(apart).max()), "height.points": int(within.sum()),
                "a": float(self.a), "gate_shift": self.options.gate_shift,
                "best_shift": float(shifts[best]), "best_shift.front.rms": fits[best],
                "source": [source(FRONT), source(HEIGHT)], "bars": dict(DamBreakRun.bars)}


class DamBreakRun(Validation):
    name = "dam-break"
    title = "dam break"
    definition = DamBreak.definition
    bars = {"front.rms": 0.05, "height.max": 0.05}

    def run(self, dump, frames, options):
        error = DamBreak(dump, options)
        rows = [{"step": frame.step, "time": frame.time, **error.add(frame)} for frame in frames]
        figures = error.finish(rows)
        figures.pop("bars")
        return figures, rows


def front_errors(time, z, front):
    """Relative errors at the table's times within the run."""
    within = (front["T"] >= time[0]) & (front["T"] <= time[-1])
    if not within.any():
        return np.array([np.inf])
    return np.interp(front["T"][within], time, z) / front["Z"][within] - 1
