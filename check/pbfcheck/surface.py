"""Height map of the free surface: the highest crossing of half the rest density, per column."""
from dataclasses import dataclass

import numpy as np

from . import splat
from .kernels import calibrated_volume, lattice_points, wendland_c2


@dataclass(frozen=True)
class HeightMap:
    columns: np.ndarray  # horizontal coordinates of the columns' centres, shape (n, dim - 1)
    weights: np.ndarray  # share of the column's area inside the walls
    heights: np.ndarray  # along up
    axes: tuple  # horizontal axes


def lattice_margin(dim):
    """Height of the half-density surface over the top layer of a lattice, in spacings. The fluid of
    that layer ends at one half; the difference is the splat's own bias."""
    points = lattice_points(splat.RADIUS + 1, dim)
    below = points[points[:, -1] <= 0]
    volume = calibrated_volume("wendland_c2", splat.RADIUS, 1.0, dim)
    z = np.linspace(0, 1, 101)
    sideways = (np.arange(4) + 0.5) / 4 - 0.5
    shifts = np.stack(np.meshgrid(*[sideways] * (dim - 1), indexing="ij"), -1).reshape(-1, dim - 1)
    margins = []
    for shift in shifts:
        horizontal2 = ((below[:, :-1] - shift) ** 2).sum(axis=1)
        distance = np.sqrt(horizontal2 + (z[:, None] - below[:, -1]) ** 2)
        rho = volume * wendland_c2(distance, splat.RADIUS, dim).sum(axis=1)
        margins.append(np.interp(0.5, rho[::-1], z[::-1]))
    return float(np.mean(margins))


def _top_crossings(density, bottom, cell):
    """Per column of the last axis, whose first point is at `bottom`: height of the highest crossing of
    1/2, NaN where there is none."""
    above = density >= 0.5
    reversed_first = np.argmax(above[..., ::-1], axis=-1)
    found = above.any(axis=-1)
    top = np.clip(density.shape[-1] - 1 - reversed_first, 0, density.shape[-1] - 2)
    inner = np.take_along_axis(density, top[..., None], -1)[..., 0]
    outer = np.take_along_axis(density, top[..., None] + 1, -1)[..., 0]
    share = (inner - 0.5) / np.maximum(inner - outer, 1e-300)
    return np.where(found, bottom + cell * (top + np.clip(share, 0, 1)), np.nan)


def height_map(points, spacing, surfaces, axis, up):
    """Heights over the columns that hold fluid; spray is the caller's to leave out."""
    dim = points.shape[1]
    horizontal = tuple(k for k in range(dim) if k != axis)
    order = list(horizontal) + [axis]
    turned = points[:, order].copy()
    turned[:, -1] *= up
    low, high = surfaces[0][order].copy(), surfaces[1][order].copy()
    if up < 0:
        low[-1], high[-1] = -high[-1], -low[-1]
    correction = (0.5 - lattice_margin(dim)) * spacing
    columns, weights, heights = [], [], []
    for tile in splat.tiles(turned, spacing, (low, high), axes=range(dim - 1)):
        inner = tile.density[(slice(1, -1),) * (dim - 1)]
        bottom = tile.origin[-1] - tile.cell
        # What lies behind a ceiling is mirrored fluid: no surface of this one.
        behind = bottom + tile.cell * np.arange(inner.shape[-1]) > high[-1]
        inner = np.where(behind, 0.0, inner)
        height = np.minimum(_top_crossings(inner, bottom, tile.cell) + correction, high[-1])
        weight = np.ones(height.shape)
        for k in range(dim - 1):
            at = tile.points(k)
            inside = (np.clip(at + tile.cell / 2, low[k], high[k])
                      - np.clip(at - tile.cell / 2, low[k], high[k]))
            weight *= (inside / tile.cell).reshape((-1,) + (1,) * (dim - 2 - k))
        centres = np.stack(np.meshgrid(*[tile.points(k) for k in range(dim - 1)], indexing="ij"), -1)
        keep = (weight > 0) & np.isfinite(height)
        columns.append(centres[keep])
        weights.append(weight[keep])
        heights.append(height[keep])
    if not columns:
        return HeightMap(np.zeros((0, dim - 1)), np.zeros(0), np.zeros(0), horizontal)
    return HeightMap(np.concatenate(columns), np.concatenate(weights), np.concatenate(heights),
                     horizontal)
