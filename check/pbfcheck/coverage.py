"""Which particles are interior: how much of the ball around each is filled by fluid or wall.

Independent of any density. Fluid is the union of balls of one rest spacing around the particles,
shrunk again by about half a spacing (a morphological closing): it ends half a spacing beyond the
outer particles, like their own cells, and has no holes inside even where the fluid is stretched,
so an expanded fluid stays interior. A lone particle or a thread of spray keeps a ball of half a
spacing, fills next to nothing of its surroundings and never counts.
"""
import itertools

import numpy as np

from .spray import is_spray
from .tiles import particle_tiles

VOXELS_PER_SPACING = {2: 6, 3: 3}
# In spacings. Half a spacing, less the mean depth of the dips between the balls of a flat layer.
SHRINK = {2: 0.43, 3: 0.37}


def _offsets(radius, dim):
    """Whole-numbered offsets of length at most `radius`."""
    n = int(np.floor(radius))
    return [o for o in itertools.product(range(-n, n + 1), repeat=dim)
            if sum(c * c for c in o) <= radius * radius]


def _mark_balls(shape, at, radius):
    """Voxels whose centre lies within `radius` of a point; `at` and `radius` in voxels."""
    covered = np.zeros(shape, bool)
    flat = covered.reshape(-1)
    dim = len(shape)
    home = np.floor(at).astype(np.int64)
    within = at - home - 0.5
    strides = np.array([int(np.prod(shape[k + 1:])) for k in range(dim)], np.int64)
    base = home @ strides
    n = int(np.ceil(radius))
    squares = {o: (o - within) ** 2 for o in range(-n, n + 1)}
    for offset in itertools.product(range(-n, n + 1), repeat=dim):
        distance2 = sum(squares[o][:, k] for k, o in enumerate(offset))
        flat[base[distance2 <= radius * radius] + int(np.dot(offset, strides))] = True
    return covered


def _mark_walls(covered, origin, voxel, surfaces, margin):
    """The walls' matter, grown by `margin`: the shrinking takes it back where no fluid is near."""
    for axis, (low, high) in enumerate(zip(*surfaces)):
        centres = origin[axis] + (np.arange(covered.shape[axis]) + 0.5) * voxel
        behind = (centres < low + margin) | (centres > high - margin)
        covered[(slice(None),) * axis + (behind,)] = True


def _shrink(covered, radius):
    """Voxels with no uncovered voxel within `radius` voxels."""
    kept = covered.copy()
    for offset in _offsets(radius, covered.ndim):
        here = tuple(slice(max(0, -o), min(n, n - o)) for o, n in zip(offset, covered.shape))
        there = tuple(slice(max(0, o), min(n, n + o)) for o, n in zip(offset, covered.shape))
        kept[here] &= covered[there]
    return kept


def _filled_shares(filled, at, radius):
    """Share of filled voxels among those with their centre within `radius` of each point. The ball is
    cut into rows of voxels; running sums give each row's count."""
    dim = filled.ndim
    runs = np.zeros(filled.shape[:-1] + (filled.shape[-1] + 1,), np.int32)
    np.cumsum(filled, axis=-1, out=runs[..., 1:])
    flat = runs.reshape(-1)
    strides = np.array([int(np.prod(runs.shape[k + 1:])) for k in range(dim - 1)], np.int64)
    last = at[:, -1] - 0.5
    home = np.floor(at[:, :-1]).astype(np.int64)
    base = home @ strides
    within = at[:, :-1] - home - 0.5
    inside = np.zeros(len(at), np.int64)
    total = np.zeros(len(at), np.int64)
    n = int(np.ceil(radius)) + 1
    squares = {o: (o - within) ** 2 for o in range(-n, n + 1)}
    for offset in itertools.product(range(-n, n + 1), repeat=dim - 1):
        left = radius * radius - sum(squares[o][:, k] for k, o in enumerate(offset))
        hit = np.flatnonzero(left > 0)
        if not len(hit):
            continue
        half = np.sqrt(left[hit])
        start = np.ceil(last[hit] - half).astype(np.int64)
        end = np.floor(last[hit] + half).astype(np.int64) + 1
        row = base[hit] + int(np.dot(offset, strides))
        inside[hit] += flat[row + end] - flat[row + start]
        total[hit] += end - start
    return inside / total


def covered_shares(points, radii, spacing, surfaces):
    """{radius: share of the ball of that radius around each point that is filled by fluid or wall}; 0
    for spray, which still fills the surroundings of others."""
    count, dim = points.shape
    shares = {radius: np.zeros(count) for radius in radii}
    per_spacing = VOXELS_PER_SPACING[dim]
    voxel = spacing / per_spacing
    reach = max(radii) + spacing / 2 + spacing + 2 * voxel  # ball, shrinking, balls of the fluid
    pad = reach + spacing + 2 * voxel
    wanted = np.flatnonzero(~is_spray(points, spacing))
    for index in particle_tiles(points, wanted, pad, voxel):
        low, high = points[index].min(axis=0), points[index].max(axis=0)
        origin = low - pad
        shape = tuple(int(n) for n in np.ceil((high + pad - origin) / voxel).astype(int) + 1)
        near = points[np.all((points >= low - reach) & (points <= high + reach), axis=1)]
        covered = _mark_balls(shape, (near - origin) / voxel, float(per_spacing))
        _mark_walls(covered, origin, voxel, surfaces, SHRINK[dim] * spacing)
        # The nearest uncovered centre lies half a voxel beyond the edge on average.
        filled = _shrink(covered, SHRINK[dim] * per_spacing + 0.5)
        for radius, share in shares.items():
            share[index] = _filled_shares(filled, (points[index] - origin) / voxel, radius / voxel)
    return shares
