"""Volume of the region where the splat of the particles is above half the rest density."""
import itertools

import numpy as np

from . import splat

SAMPLES = 3  # per axis, in a cell that the surface crosses
_BATCH = 100_000  # crossed cells at a time


def _corners(rho):
    """Values at the corners of each cell between neighbouring points, last axis: 2^dim corners."""
    shape = tuple(n - 1 for n in rho.shape)
    return [rho[tuple(slice(o, o + n) for o, n in zip(corner, shape))]
            for corner in itertools.product((0, 1), repeat=rho.ndim)]


def _interpolation(dim):
    """(weights of the corners at each sample, and per axis those of the slope over a sample)."""
    at = (np.arange(SAMPLES) + 0.5) / SAMPLES
    samples = list(itertools.product(at, repeat=dim))
    corners = list(itertools.product((0, 1), repeat=dim))

    def weight(sample, corner, slope_axis=None):
        parts = [(1 if c else -1) / SAMPLES if k == slope_axis else (s if c else 1 - s)
                 for k, (s, c) in enumerate(zip(sample, corner))]
        return np.prod(parts)

    values = np.array([[weight(s, c) for c in corners] for s in samples])
    slopes = [np.array([[weight(s, c, axis) for c in corners] for s in samples]) for axis in range(dim)]
    return values, slopes


def _crossed_share(corners, dim):
    """Share above 1/2 of cells with these corner values, of shape (n, 2^dim). In each sample the
    surface is a plane across the interpolated slope."""
    values, slopes = _interpolation(dim)
    share = np.empty(len(corners))
    for start in range(0, len(corners), _BATCH):
        part = corners[start:start + _BATCH]
        steep = sum(np.abs(part @ slope.T) for slope in slopes)
        inside = np.clip(0.5 + (part @ values.T - 0.5) / np.maximum(steep, 1e-12), 0, 1)
        share[start:start + _BATCH] = inside.mean(axis=1)
    return share


def _filled_share(rho):
    corners = _corners(rho)
    above = sum((c >= 0.5).astype(np.int8) for c in corners)
    share = (above == len(corners)).astype(float)
    crossed = (above > 0) & (above < len(corners))
    share[crossed] = _crossed_share(np.stack([c[crossed] for c in corners], axis=1), rho.ndim)
    return share


def splat_volume(points, spacing, surfaces):
    total = 0.0
    for tile in splat.tiles(points, spacing, surfaces):
        dim = points.shape[1]
        share = _filled_share(tile.density[(slice(1, None),) * dim])
        for axis in range(dim):
            low, high = surfaces[0][axis], surfaces[1][axis]
            at = np.clip(tile.points(axis, beyond=True), low, high)
            share *= (np.diff(at) / tile.cell).reshape((-1,) + (1,) * (dim - 1 - axis))
        total += share.sum() * tile.cell**dim
    return float(total)
