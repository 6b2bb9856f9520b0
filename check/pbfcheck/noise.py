"""E9: noise at rest."""
import numpy as np

from .fault import NotApplicable
from .measure import Measure


class Noise(Measure):
    key = "E9"
    title = "noise at rest"
    definition = ("RMS speed / sqrt(g d), d the rest spacing; `max`: the fastest particle. Meaningful "
                  "for a fluid that should be at rest.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        g = float(np.linalg.norm(dump.manifest.gravity))
        if g == 0:
            raise NotApplicable("there is no gravity to scale the speed by")
        self.scale = np.sqrt(g * dump.rest_spacing)

    def add(self, frame):
        speed = np.linalg.norm(self.need_velocities(frame), axis=1)
        if not len(speed):
            raise NotApplicable(f"step {frame.step} has no particles")
        return {"rms": float(np.sqrt(np.mean(speed**2)) / self.scale),
                "max": float(speed.max() / self.scale)}
