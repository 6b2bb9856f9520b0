"""Whether the particles are all there and inside the walls."""
import numpy as np

from .measure import Measure

ROUNDING = 1e-6  # of the bound's size: a float32 solver clamps to the nearest float32


class Containment(Measure):
    key = "state"
    title = "particles"
    definition = ("`count`; `lost`: the first frame's count less this one's; `outside`: particles whose "
                  "centre is beyond the domain's bounds at that time by more than float32 rounding; "
                  "`outside_by`: the farthest, in rest spacings. Values that are not finite never get "
                  "this far: they are a malformed dump.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.first = None

    def add(self, frame):
        x = frame.positions
        if self.first is None:
            self.first = len(x)
        beyond = np.zeros(len(x))
        for bound, sign in zip(self.dump.manifest.walls.bounds(frame.time), (-1, 1)):
            slack = ROUNDING * np.where(np.isfinite(bound), np.abs(bound), 0)
            beyond = np.maximum(beyond, (sign * (x - bound) - slack).max(axis=1, initial=0.0))
        return {"count": len(x), "lost": self.first - len(x), "outside": int((beyond > 0).sum()),
                "outside_by": float(beyond.max(initial=0.0) / self.dump.rest_spacing)}
