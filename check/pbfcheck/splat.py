"""Density of the particles on a grid of points: where it is above one half, there is fluid."""
import itertools
from dataclasses import dataclass

import numpy as np

from .kernels import calibrated_volume, wendland_c2
from .tiles import cell_tiles
from .walls import mirror_images

RADIUS = 2.0  # of the splat's Wendland kernel, in spacings
CELLS_PER_SPACING = 2


@dataclass(frozen=True)
class Tile:
    origin: np.ndarray  # the first point
    cell: float  # distance of the points
    density: np.ndarray  # one layer of points more on every side

    def points(self, axis, beyond=False):
        """Coordinates of the points along an axis; `beyond`: with the layer above the last."""
        return self.origin[axis] + self.cell * np.arange(self.density.shape[axis] - (1 if beyond else 2))


def _ball_cells(shape, at, reach):
    """Per offset: (flat indices, squared distances in cells) of the grid points within `reach`."""
    dim = len(shape)
    strides = np.array([int(np.prod(shape[k + 1:])) for k in range(dim)], np.int64)
    home = np.floor(at).astype(np.int64)
    within = at - home - 0.5
    base = home @ strides
    n = int(np.ceil(reach))
    inner = np.all((home >= n) & (home < np.array(shape) - n), axis=1)
    squares = {o: (o - within) ** 2 for o in range(-n, n + 1)}
    for offset in itertools.product(range(-n, n + 1), repeat=dim):
        distance2 = sum(squares[o][:, k] for k, o in enumerate(offset))
        hit = distance2 < reach * reach
        if not inner.all():
            cell = home + np.array(offset)
            hit &= inner | np.all((cell >= 0) & (cell < shape), axis=1)
        hit = np.flatnonzero(hit)
        yield base[hit] + int(np.dot(offset, strides)), distance2[hit]


def _add_balls(density, at, reach, weight):
    """Adds weight(squared distance in cells) of every particle to the grid points within `reach`, which
    stand in the middle of the array's cells."""
    flat = density.reshape(-1)
    cells, weights, pending = [], [], 0
    batch = max(4_000_000, len(flat))  # a batch costs a pass over the whole grid
    for index, distance2 in _ball_cells(density.shape, at, reach):
        cells.append(index)
        weights.append(weight(distance2))
        pending += len(index)
        if pending >= batch:
            flat += np.bincount(np.concatenate(cells), np.concatenate(weights), len(flat))
            cells, weights, pending = [], [], 0
    if pending:
        flat += np.bincount(np.concatenate(cells), np.concatenate(weights), len(flat))


def tiles(points, spacing, surfaces, axes=None):
    """Tiles that together hold every grid point in reach of a particle, each once. Along axes that are not
    in `axes` a tile spans the whole fluid."""
    dim = points.shape[1]
    h = RADIUS * spacing
    cell = spacing / CELLS_PER_SPACING
    volume = calibrated_volume("wendland_c2", RADIUS, 1.0, dim) * spacing**dim
    reach = h / cell
    everything = np.concatenate([points, mirror_images(points, surfaces, h + cell)])
    # Points stand on a wall, so that a wall at rest cuts no cell between them.
    origin = np.where(np.isfinite(surfaces[0]), surfaces[0], 0.0) - cell / 2
    halo = int(np.ceil(reach)) + 1
    for first, last, index in cell_tiles(everything, origin, cell, halo, axes or range(dim)):
        density = np.zeros(tuple(last - first + 2))
        corner = origin + cell * (first - 1)
        _add_balls(density, (everything[index] - corner) / cell, reach,
                   lambda d2: volume * wendland_c2(np.sqrt(d2) * cell, h, dim))
        yield Tile(corner + 1.5 * cell, cell, density)
