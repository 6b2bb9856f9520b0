"""Volume of the region where the splat of the particles is above half the rest density."""
import numpy as np

from . import splat


def _filled_share(tile):
    """Share of each cell below the plane that has the density's value and gradient there. Exact for
    a surface along the cells."""
    rho = tile.density
    inner = (slice(1, -1),) * rho.ndim
    slope = np.zeros_like(rho[inner])
    for axis in range(rho.ndim):
        ahead = tuple(slice(2, None) if k == axis else slice(1, -1) for k in range(rho.ndim))
        behind = tuple(slice(None, -2) if k == axis else slice(1, -1) for k in range(rho.ndim))
        slope += np.abs(rho[ahead] - rho[behind]) / 2
    excess = rho[inner] - 0.5
    steep = np.maximum(slope, 1e-12)
    return np.clip(0.5 + excess / steep, 0, 1)


def _inside_share(tile, axis, low, high):
    """Share of each cell's width between two planes."""
    edges = tile.edges(axis)
    left, right = np.clip(edges[:-1], low, high), np.clip(edges[1:], low, high)
    return (right - left) / tile.cell


def splat_volume(points, spacing, surfaces):
    total = 0.0
    for tile in splat.tiles(points, spacing, surfaces):
        share = _filled_share(tile)
        for axis in range(share.ndim):
            inside = _inside_share(tile, axis, surfaces[0][axis], surfaces[1][axis])
            share *= inside.reshape((-1,) + (1,) * (share.ndim - 1 - axis))
        total += share.sum() * tile.cell**share.ndim
    return float(total)
