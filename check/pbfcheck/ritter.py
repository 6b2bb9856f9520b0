"""Dam break on a dry bed against Ritter's shallow-water solution."""
import numpy as np

from .fault import NotApplicable
from .scene_axes import floor_and_ceiling, vertical
from .spray import is_spray
from .surface import height_map
from .validation import Validation
from .validation_data import RITTER, source, table


class Ritter(Validation):
    name = "ritter"
    title = "dry-bed dam break, shallow water"
    definition = (
        "RMS of h/h0 - (4/9)(1 - xi/2)^2 over -1 <= xi <= 1.5, xi = (x - x0)/(t sqrt(g h0)), of the "
        "frames before the rarefaction meets the back wall. Asymptotic only: shallow-water theory "
        "knows no vertical acceleration, so early frames must differ. `last`: the last such frame.")

    def run(self, dump, frames, options):
        axis, up, g = vertical(dump.manifest)
        flow = 0 if axis != 0 else 1
        d, data = dump.rest_spacing, table(RITTER)
        rows, start = [], None
        for frame in frames:
            x = frame.positions[~is_spray(frame.positions, d)]
            surfaces = dump.manifest.walls.surfaces(frame.time)
            floor = floor_and_ceiling(surfaces, axis, up)[0]
            if start is None:
                if frame.step != 0:
                    raise NotApplicable("the dam is read from step 0, which is not among the frames")
                if not np.isfinite(floor):
                    raise NotApplicable("the domain has no floor")
                dam = x[:, flow].max() + d / 2
                start = (dam, (up * x[:, axis]).max() + d / 2 - floor, dam - x[:, flow].min() + d / 2)
                continue
            dam, h0, length = start
            reach = frame.time * np.sqrt(g * h0)
            if reach > length:
                break
            top = height_map(x, d, surfaces, axis, up)
            xi = (top.columns[:, top.axes.index(flow)] - dam) / reach
            judged = (xi >= -1) & (xi <= 1.5)
            if not judged.any():
                continue
            apart = (top.heights[judged] - floor) / h0 - np.interp(xi[judged], data["xi"], data["h"])
            rows.append({"step": frame.step, "time": frame.time,
                         "profile.rms": float(np.sqrt(np.mean(apart**2))),
                         "dam.height": float(np.mean((top.heights[np.abs(xi) < 0.1] - floor) / h0))
                         if np.any(np.abs(xi) < 0.1) else None})
        if not rows:
            raise NotApplicable("no frame between step 0 and the rarefaction's arrival at the back wall")
        return {"profile.rms.last": rows[-1]["profile.rms"],
                "profile.rms.largest": max(r["profile.rms"] for r in rows),
                "dam.height.last": rows[-1]["dam.height"], "source": source(RITTER)}, rows
