"""E3: distance to a reference run."""
import numpy as np

from .dump import Dump
from .fault import DumpFault, NotApplicable
from .measure import Measure


def cell_density_distance(a, b, cell):
    """L1 distance of the particle counts on a grid, over the total count: 0 … 1."""
    both = np.concatenate([a, b])
    keys = np.floor(both / cell).astype(np.int64)
    _, number = np.unique(keys, axis=0, return_inverse=True)
    number = number.reshape(-1)
    cells = int(number.max()) + 1
    counts = [np.bincount(part, minlength=cells) / len(part)
              for part in (number[:len(a)], number[len(a):])]
    return float(np.abs(counts[0] - counts[1]).sum() / 2)


class ReferenceDistance(Measure):
    key = "E3"
    title = "distance to the reference"
    definition = (
        "`rms`: sqrt(mean |x - x_ref|^2)/d of like-numbered particles; it says something while "
        "`trajectories_agree`. `cells`: half the L1 distance of the shares of particles on a grid "
        "of `cell` spacings, 0 … 1, for the time after. `floor.…`: the same between the "
        "reference and a second one that started a hair apart: no solver can go under it. "
        "Trajectories agree while the floor's rms (without a floor: the rms) is below `agree`.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        if not options.reference:
            raise NotApplicable("no --reference was given")
        self.reference = Dump(options.reference)
        self.floor = Dump(options.floor) if options.floor else None
        self.agree = True
        for other in filter(None, (self.reference, self.floor)):
            if other.dimension != dump.dimension:
                raise DumpFault(other.manifest.path, f'"dimension" is {other.dimension}; '
                                f"{dump.manifest.path} has {dump.dimension}")

    def _step_at(self, other, time):
        """The step of another run at this time: its time step may be a fraction of this one's."""
        step = round(time / other.manifest.time_step)
        if abs(step * other.manifest.time_step - time) > 1e-6 * max(self.dump.manifest.time_step, time):
            raise DumpFault(other.manifest.path, f"has no step at time {time:.9g}")
        return step

    def _figures(self, a, b):
        d = self.dump.rest_spacing
        apart = np.linalg.norm(a - b, axis=1) if a.shape == b.shape else None
        return {"rms": float(np.sqrt(np.mean(apart**2)) / d) if apart is not None else None,
                "max": float(apart.max() / d) if apart is not None else None,
                "cells": cell_density_distance(a, b, self.options.cell * d)}

    def add(self, frame):
        reference = self.reference.frame(self._step_at(self.reference, frame.time))
        if not len(frame.positions) or not len(reference.positions):
            raise NotApplicable(f"step {frame.step} has no particles")
        row = self._figures(frame.positions, reference.positions)
        judge = row["rms"]
        if self.floor:
            other = self.floor.frame(self._step_at(self.floor, frame.time))
            floor = self._figures(other.positions, reference.positions)
            judge = floor["rms"]
            row.update({f"floor.{key}": value for key, value in floor.items()})
        # Once they have parted, meeting again is chance.
        self.agree = self.agree and judge is not None and judge < self.options.agree
        row["trajectories_agree"] = self.agree
        return row

    def finish(self, rows):
        return {"reference": self.options.reference, "cell": self.options.cell,
                "agree": self.options.agree}
