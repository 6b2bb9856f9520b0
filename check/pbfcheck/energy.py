"""E6: energy."""
import numpy as np

from .fault import NotApplicable
from .measure import Measure


class Energy(Measure):
    key = "E6"
    title = "energy"
    definition = (
        "(E_kin + E_pot - E_0)/E_0, signed: above 0 it has gained. Particles of unit mass; potential "
        "of gravity from the lowest corner of the domain along gravity (of the first frame's "
        "particles where the domain is open), of attraction from its centre. `highest_gain`: the "
        "largest rise above an earlier frame's energy, over E_0.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.need_one_mass()
        self.first = None
        self.count = None

    def _zero(self, frame):
        m = self.dump.manifest
        lower, upper = m.walls.bounds(frame.time)
        lowest = np.where(m.gravity > 0, upper, lower)
        x = frame.positions
        of_particles = np.where(m.gravity > 0, x.max(axis=0), x.min(axis=0))
        return np.where(np.isfinite(lowest), lowest, of_particles)

    def add(self, frame):
        v = self.need_velocities(frame)
        m = self.dump.manifest
        if self.count is None:
            self.count = len(v)
            if not self.count:
                raise NotApplicable("the first frame has no particles")
            self.zero = self._zero(frame)
        if len(v) != self.count:
            raise NotApplicable(f"step {frame.step} has {len(v)} particles, the first frame {self.count}")
        kinetic = 0.5 * float(np.square(v).sum())
        arm = frame.positions - m.attraction_center
        potential = (-float(((frame.positions - self.zero) @ m.gravity).sum())
                     + 0.5 * m.attraction * float(np.square(arm).sum()))
        total = kinetic + potential
        if self.first is None:
            self.first, self.least = total, total
        self.least = min(self.least, total)
        return {"relative": self._over(total - self.first), "gain": self._over(total - self.least),
                "kinetic": kinetic / self.count, "potential": potential / self.count}

    def _over(self, difference):
        return difference / abs(self.first) if self.first else None

    def finish(self, rows):
        notes = []
        if self.dump.manifest.walls.moving:
            notes.append("walls move: their work is part of this")
        if rows and not self.first:
            notes.append("E_0 is 0: no relative figure")
        gains = [row["gain"] for row in rows if row["gain"] is not None]
        return {"highest_gain": max(gains, default=None), **({"note": "; ".join(notes)} if notes else {})}
