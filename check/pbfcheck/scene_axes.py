"""Which way is up."""
import numpy as np

from .fault import NotApplicable


def vertical(manifest):
    """(axis, direction of up: +1 or -1, |g|) of a gravity along one axis."""
    g = manifest.gravity
    along = np.flatnonzero(g)
    if len(along) != 1:
        raise NotApplicable(f"gravity is {g.tolist()}; this needs gravity along one axis")
    axis = int(along[0])
    return axis, -1 if g[axis] > 0 else 1, float(abs(g[axis]))


def floor_and_ceiling(surfaces, axis, up):
    """Heights (along up) of the wall surfaces below and above."""
    low, high = surfaces[0][axis], surfaces[1][axis]
    return (low, high) if up > 0 else (-high, -low)
