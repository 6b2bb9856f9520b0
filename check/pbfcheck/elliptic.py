"""Stretching elliptic patch and oscillating drop, against their exact equations of motion."""
import numpy as np

from .dump import Dump
from .ellipse import axes_of, exact_axes, exact_period, strain_rate
from .fault import DumpFault, NotApplicable
from .oscillation import fit_oscillation
from .validation import Validation
from .validation_data import ELLIPTIC_PATCH, OSCILLATING_DROP, source


class _Ellipse(Validation):
    data = ""

    def _check(self, dump: Dump):
        if dump.dimension != 2:
            raise NotApplicable("the patch is two-dimensional")
        if np.any(dump.manifest.gravity):
            raise NotApplicable("the patch knows no gravity")

    def _trace(self, dump, frames):
        rows, start = [], None
        for frame in frames:
            axes = axes_of(frame.positions, dump.rest_spacing)
            if start is None:
                if frame.velocities is None:
                    raise DumpFault(dump.path("velocities", frame.step),
                                    "is missing; the first frame's velocities start the exact motion")
                start = (strain_rate(frame.positions, frame.velocities), axes.centre)
            rows.append({"step": frame.step, "time": frame.time, "x_axis": axes.x, "y_axis": axes.y,
                         "tilt": axes.tilt,
                         "centre_drift": float(np.linalg.norm(axes.centre - start[1]))})
        return rows, start[0]

    def _compare(self, rows, rate, attraction):
        """Adds the exact axes to the rows; the radius is that of a circle of the first frame's area."""
        first = rows[0]
        radius = np.sqrt(first["x_axis"] * first["y_axis"])
        a0 = np.sqrt(first["x_axis"] / first["y_axis"])
        exact = exact_axes([row["time"] for row in rows], a0, rate, attraction)
        for row, a in zip(rows, exact):
            row["x_exact"], row["y_exact"] = float(a * radius), float(radius / a)
        errors = np.array([[row["x_axis"] / row["x_exact"] - 1, row["y_axis"] / row["y_exact"] - 1]
                           for row in rows])
        area = np.array([row["x_axis"] * row["y_axis"] for row in rows]) / radius**2 - 1
        return {"axes.max": float(np.abs(errors).max()),
                "axes.rms": float(np.sqrt(np.mean(errors**2))),
                "area.max": float(area[np.argmax(np.abs(area))]),
                "tilt.max": max(abs(row["tilt"]) for row in rows),
                "centre_drift.max": max(row["centre_drift"] for row in rows),
                "radius": float(radius), "rate": rate, "source": source(self.data)}


class EllipticPatch(_Ellipse):
    name = "elliptic-patch"
    title = "stretching elliptic patch"
    data = ELLIPTIC_PATCH
    definition = ("Semi-axes from the second moments of the particles against the exact motion with "
                  "the first frame's axes and strain rate: relative errors over all frames. "
                  "`area.max`: signed change of the product of the axes.")
    bars = {"axes.max": 0.02}

    def run(self, dump, frames, options):
        self._check(dump)
        if dump.manifest.attraction != 0:
            raise NotApplicable("the patch knows no attraction; this is oscillating-drop's")
        rows, rate = self._trace(dump, frames)
        return {**self._compare(rows, rate, 0.0), "duration": rows[-1]["time"] * abs(rate)}, rows


class OscillatingDrop(_Ellipse):
    name = "oscillating-drop"
    title = "oscillating drop"
    data = OSCILLATING_DROP
    definition = ("As elliptic-patch, under an acceleration -attraction x. `period.error`: relative, of "
                  "the fitted log of the ratio of the axes. `amplitude.kept`: its amplitude a period "
                  "later, over that at first.")
    bars = {"axes.max": 0.02, "period.error": 0.02}

    def run(self, dump, frames, options):
        self._check(dump)
        if dump.manifest.attraction <= 0:
            raise NotApplicable(f'"attraction" in {dump.manifest.path} is {dump.manifest.attraction:g}; '
                                "the drop needs it above 0")
        rows, rate = self._trace(dump, frames)
        figures = self._compare(rows, rate, dump.manifest.attraction)
        period = exact_period(rate, dump.manifest.attraction)
        swing = fit_oscillation([row["time"] for row in rows],
                                [np.log(row["x_axis"] / row["y_axis"]) for row in rows])
        figures.update({"period": swing.period, "period.exact": period,
                        "period.error": swing.period / period - 1,
                        "amplitude.kept": float(np.exp(-swing.period / swing.decay_time))})
        return figures, rows
