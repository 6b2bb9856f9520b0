"""Two drops that collide without gravity: momentum stays."""
from .fault import NotApplicable
from .momentum import AngularMomentum, LinearMomentum
from .spray import groups
from .validation import Validation

import numpy as np


class CollidingDrops(Validation):
    name = "colliding-drops"
    title = "momentum of colliding drops"
    definition = ("Largest relative drift of linear and of angular momentum (as E4 and E5), of a run that "
                  "starts as at least two connected groups and in which all of them meet in one.")
    bars = {"linear.max": 1e-5, "angular.max": 1e-5}

    def run(self, dump, frames, options):
        if np.any(dump.manifest.gravity) or dump.manifest.attraction:
            raise NotApplicable("gravity or attraction act on the drops")
        linear, angular = LinearMomentum(dump, options), AngularMomentum(dump, options)
        rows, drops, met = [], None, False
        p_rows, l_rows = [], []
        for frame in frames:
            number = groups(frame.positions, dump.rest_spacing)
            sizes = np.bincount(number)
            large = int((sizes >= 3**dump.dimension).sum())
            if drops is None:
                drops = number if large >= 2 else None
                if drops is None:
                    raise NotApplicable(f"step {frame.step} holds {large} drop; it must hold at least two")
            p_rows.append(linear.add(frame))
            l_rows.append(angular.add(frame))
            met = met or _one_group(drops, number)
            rows.append({"step": frame.step, "time": frame.time, "drops": large})
        if not met:
            raise NotApplicable("the drops have not met by the last frame")
        linear.finish(p_rows)
        angular.finish(l_rows)
        for row, p, l in zip(rows, p_rows, l_rows):
            row["linear"], row["angular"] = p["relative"], l["relative"]
        return {"linear.max": max(r["linear"] for r in rows),
                "angular.max": max(r["angular"] for r in rows)}, rows


def _one_group(drops, number):
    """Whether some connected group holds particles of every drop at first."""
    most = np.bincount(number).argmax()
    large = np.flatnonzero(np.bincount(drops) > 1)
    return bool(np.isin(large, drops[number == most]).all())
