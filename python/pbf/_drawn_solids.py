"""Where rays meet solids of any form, for pictures."""
from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import check
from ._library import ffi, lib
from .geometry import Geometry

Vector = NDArray[np.float64]

_NODES = 64  # along the longest side: finer than what a picture shows
_KEPT = 16
_fields: OrderedDict[int, Field] = OrderedDict()


@dataclass(frozen=True)
class Field:
    """A geometry's distances at nodes around it, in its own space; in 2D alike along z."""

    lower: Vector
    cell: float
    values: NDArray[np.float64]

    def at(self, points: Vector) -> Vector:
        """Linear between nodes, and outside of them at the nearest place within."""
        last = np.array(self.values.shape) - 1
        place = np.clip((points - self.lower) / self.cell, 0, last)
        first = np.minimum(place.astype(int), np.maximum(last - 1, 0))
        part = place - first
        total = np.zeros(len(points))
        for corner in np.ndindex(2, 2, 2):
            node = np.minimum(first + corner, last)
            weight = np.where(corner, part, 1 - part).prod(axis=1)
            total += weight * self.values[tuple(node.T)]
        return total

    def slope(self, points: Vector) -> Vector:
        steps = np.eye(3) * self.cell
        return np.stack([self.at(points + step) - self.at(points - step) for step in steps], axis=1)


def field_of(geometry: Geometry) -> Field:
    """Asked of the library once for each content of a geometry."""
    key = geometry._info().hash
    if key not in _fields:
        _fields[key] = _sampled(geometry)
        if len(_fields) > _KEPT:
            _fields.popitem(last=False)
    _fields.move_to_end(key)
    return _fields[key]


def _sampled(geometry: Geometry) -> Field:
    dimension = geometry.dimension
    lower, upper = (np.array(end, float) for end in geometry.bounds)
    cell = max(float((upper - lower).max()) / (_NODES - 3), 1e-300)
    counts = np.ceil((upper - lower) / cell).astype(int) + 3
    lower = lower - cell
    point, distance = ffi.new("double[3]"), ffi.new("double *")
    values = np.empty(counts)
    for node in np.ndindex(*counts):
        for axis in range(dimension):
            point[axis] = lower[axis] + cell * node[axis]
        check(lib.pbf_get_shape_distance(geometry.handle, point, distance, ffi.NULL))
        values[node] = distance[0]
    if dimension == 2:
        values, lower = values[:, :, None], np.append(lower, 0.0)
    return Field(lower, cell, values)


def reach(geometry: Geometry, scale: float) -> float:
    """The radius of a ball about its origin that it is in."""
    lower, upper = (np.array(end, float) for end in geometry.bounds)
    return scale * float(np.linalg.norm(np.maximum(np.abs(lower), np.abs(upper))))


def hit(geometry: Geometry, start: Vector, way: Vector) -> tuple[Vector, Vector]:
    """How far along each ray in its own space the solid is met, infinite where it is not, and the
    normal there. `way` has the length 1."""
    field = field_of(geometry)
    if geometry.dimension == 2:
        return _hit_flat(field, start, way)
    last = field.lower + field.cell * (np.array(field.values.shape) - 1)
    along, end = _within(field.lower, last, start, way)
    going = along < end
    for _ in range(4 * _NODES):
        if not going.any():
            break
        near = field.at(start[going] + along[going, None] * way)
        along[going] += np.where(near > 0.05 * field.cell, np.maximum(near, 0.1 * field.cell), 0)
        met = np.zeros(len(along), bool)
        met[going] = near <= 0.05 * field.cell
        going &= ~met & (along < end)
    seen = along < end
    place = start + np.where(seen, along, 0)[:, None] * way
    slope = field.slope(place)
    normals = slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-300)
    return np.where(seen, along, np.inf), normals


def _hit_flat(field: Field, start: Vector, way: Vector) -> tuple[Vector, Vector]:
    inside = field.at(start) < 0
    normals = np.zeros_like(start)
    normals[:, 2] = -np.sign(way[2])
    return np.where(inside, 0.0, np.inf), normals


def _within(lower: Vector, upper: Vector, start: Vector, way: Any) -> tuple[Vector, Vector]:
    """Where rays enter a box and leave it."""
    way = np.where(np.abs(way) < 1e-12, 1e-12, way)
    one, other = (lower - start) / way, (upper - start) / way
    return np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
