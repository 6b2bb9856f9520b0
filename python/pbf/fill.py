"""Positions of particles that fill a shape, `spacing` apart and half of that off its faces."""
from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._errors import InvalidArgumentError
from ._library import lib
from ._numbers import Vector, real, reals, shown, uint32
from .geometry import Geometry

Positions = NDArray[np.float64]


def _spacing(spacing: float) -> float:
    spacing = real("spacing", spacing)
    if not (spacing > 0 and np.isfinite(spacing)):
        raise InvalidArgumentError(f"spacing is {spacing}; it must be above 0 and finite")
    return spacing


def fill_lattice(first: Vector, counts: Sequence[int], spacing: float) -> Positions:
    """`counts` particles along the axes, the first one at `first`; x runs fastest."""
    spacing = _spacing(spacing)
    start = reals("first", first, (2, 3))
    if len(counts) != len(start):
        raise InvalidArgumentError(f"counts is {shown(counts)}; it must have as many numbers as first")
    numbers = [uint32(f"counts[{i}]", count) for i, count in enumerate(counts)]
    if math.prod(numbers) > lib.PBF_MAX_CAPACITY:
        raise InvalidArgumentError(
            f"counts is {shown(counts)}, which is {math.prod(numbers)} particles; at most "
            f"{lib.PBF_MAX_CAPACITY} fit into a solver")
    axes = [x + spacing * np.arange(n) for x, n in zip(start, numbers)]
    grid = np.meshgrid(*reversed(axes), indexing="ij")  # the last axis runs slowest
    return np.stack([axis.reshape(-1) for axis in reversed(grid)], axis=1)


def fill_box(lower: Vector, upper: Vector, spacing: float) -> Positions:
    """As many particles as fit between two corners, to the nearest number along each axis."""
    spacing = _spacing(spacing)
    low = reals("lower", lower, (2, 3))
    high = reals("upper", upper, (len(low),))
    counts = []
    for axis, (a, b) in enumerate(zip(low, high)):
        cells = np.floor((b - a) / spacing + 0.5)
        if not 0 <= cells <= 1e6:
            raise InvalidArgumentError(
                f"along axis {axis} the box is from {a} to {b}, which is {cells:g} particles; "
                "0 … 1000000 would do")
        counts.append(int(cells))
    return fill_lattice([x + spacing / 2 for x in low], counts, spacing)


def fill_ball(center: Vector, radius: float, spacing: float) -> Positions:
    """The points of a lattice about `center` that are nearer to it than `radius`; in 2D a disc."""
    spacing, radius = _spacing(spacing), real("radius", radius)
    if not 0 < radius <= 1e6 * spacing:
        raise InvalidArgumentError(
            f"radius is {radius}; it must be above 0, and at most a million spacings, {1e6 * spacing:g}")
    middle = np.array(reals("center", center, (2, 3)))
    half = np.ceil(radius / spacing) * spacing
    points = fill_box(middle - half, middle + half, spacing)
    return points[((points - middle) ** 2).sum(axis=1) < radius**2]


def fill_geometry(geometry: Geometry, spacing: float, position: Vector | None = None) -> Positions:
    """The points of a lattice inside of a solid, of a mesh for example, that are half a spacing from
    its surface, to a quarter of its cell; `position` is where its own origin lies."""
    spacing = _spacing(spacing)
    if not isinstance(geometry, Geometry):
        raise InvalidArgumentError(f"geometry is {shown(geometry)}; it must be a Geometry")
    lower, upper = geometry.bounds
    points = fill_box(lower, upper, spacing)
    least = 0.5 * spacing - 0.25 * geometry.cell  # next to edges, which are rounded off, distances are less
    deep = np.array([geometry.distance(point) for point in points]) <= -least
    offset = 0.0 if position is None else np.array(reals("position", position, (len(lower),)))
    return points[deep] + offset
