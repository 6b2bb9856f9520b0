"""E4 and E5: linear and angular momentum."""
import numpy as np

from .fault import NotApplicable
from .measure import Measure


def angular(x, v):
    """Angular momentum of particles of unit mass, as a vector of length 1 (2D) or 3."""
    turn = np.cross(np.pad(x, ((0, 0), (0, 3 - x.shape[1]))), np.pad(v, ((0, 0), (0, 3 - v.shape[1]))))
    return turn.sum(axis=0)


class _Momentum(Measure):
    """Subclasses say what is conserved, and its scale."""

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.need_one_mass()
        self.first = None
        self.count = None

    def _conserved(self, frame, v):
        """(vector, sum of the sizes of its terms)"""
        raise NotImplementedError

    def add(self, frame):
        v = self.need_velocities(frame)
        if self.first is None:
            self._start(frame)
        if len(v) != self.count:
            raise NotApplicable(f"step {frame.step} has {len(v)} particles, the first frame "
                                f"{self.count}: momentum was added or taken")
        total, scale = self._conserved(frame, v)
        if self.first is None:
            self.first = total
        return {"drift": float(np.linalg.norm(total - self.first)), "scale": scale}

    def _start(self, frame):
        self.count = len(frame.positions)

    def finish(self, rows):
        largest = max((row["scale"] for row in rows), default=0.0)
        for row in rows:
            row["relative"] = row["drift"] / largest if largest > 0 else 0.0
        free = not np.any(self.dump.manifest.gravity) and self.dump.manifest.attraction == 0
        note = "" if free else ("gravity or attraction act: what they and the walls give is part of "
                                "this drift")
        return {"note": note} if note else {}


class LinearMomentum(_Momentum):
    key = "E4"
    title = "linear momentum"
    definition = ("|P(t) - P(0)| / max over frames of sum |v_i|, particles of unit mass. Meaningful "
                  "without gravity and away from walls. Drift and scale: the two terms.")

    def _conserved(self, frame, v):
        return v.sum(axis=0), float(np.linalg.norm(v, axis=1).sum())


class AngularMomentum(_Momentum):
    key = "E5"
    title = "angular momentum"
    definition = ("|L(t) - L(0)| / max over frames of sum |x_i - c| |v_i|, about the first frame's "
                  "centre of mass c. Meaningful without gravity and away from walls.")

    def _start(self, frame):
        super()._start(frame)
        self.centre = frame.positions.mean(axis=0) if len(frame.positions) else 0.0

    def _conserved(self, frame, v):
        arm = frame.positions - self.centre
        size = np.linalg.norm(arm, axis=1) * np.linalg.norm(v, axis=1)
        return angular(arm, v), float(size.sum())
