"""Geometries: any solid, as signed distances on a grid, for `Solid` colliders."""
from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _files
from ._arrays import AnyArray, numpy_of, packed, pointer, real_numbers
from ._errors import InvalidArgumentError, check
from ._library import ffi, lib, new_struct
from ._numbers import UINT32_MAX, Vector, real, reals, shown, uint32
from ._state import PathLike, state_of

if TYPE_CHECKING:
    from typing_extensions import Self


def _dimension_of(name: str, points: AnyArray) -> int:
    shape = numpy_of(name, points).shape
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise InvalidArgumentError(f"{name} has the shape {shape}; it must be (count, 2 or 3)")
    return int(shape[1])


def _corners(name: str, faces: AnyArray, columns: int) -> NDArray[Any]:
    """Numbers of vertices, of which a cast would make others."""
    given = real_numbers(name, numpy_of(name, faces))
    held = given.dtype if given.dtype.kind == "f" else None
    if held is None and given.size and not 0 <= given.min() <= given.max() <= UINT32_MAX:
        held = given.min() if given.min() < 0 else given.max()
    if held is not None and given.size:
        raise InvalidArgumentError(f"{name} holds {held}; it must hold integers, 0 … {UINT32_MAX}")
    return _contiguous(name, given, np.uint32, columns)


def _contiguous(name: str, array: AnyArray, dtype: Any, columns: int | None) -> NDArray[Any]:
    given = packed(name, numpy_of(name, array), dtype)
    if columns is not None and (given.ndim != 2 or given.shape[1] != columns):
        raise InvalidArgumentError(
            f"{name} has the shape {given.shape}; it must be (count, {columns})")
    return given


class Geometry:
    """Any solid. It lives as long as this object, or a collider of a solver, has it."""

    def __init__(self, handle: Any) -> None:
        """Of one of the C API, which is released with it; `from_mesh` and its like make one."""
        if not isinstance(handle, ffi.CData) or ffi.typeof(handle) != ffi.typeof("pbf_shape *"):
            raise InvalidArgumentError(
                f"handle is {shown(handle)}; it must be a pbf_shape * of the C API: from_grid, from_mesh, "
                "from_heights, from_points and load make geometries")
        self._handle = handle
        self._finalizer = weakref.finalize(self, lib.pbf_release_shape, handle)

    @classmethod
    def _made(cls, function: Callable[[Any, Any], int], desc: Any) -> Self:
        out = ffi.new("pbf_shape **")
        check(function(desc, out))
        return cls(out[0])

    @classmethod
    def from_grid(cls, values: AnyArray, origin: Vector, cell: float) -> Self:
        """Of distances values[i, j, k] at origin + cell (i, j, k), negative inside."""
        given = real_numbers("values", numpy_of("values", values))
        if given.ndim not in (2, 3):
            raise InvalidArgumentError(f"values has {given.ndim} axes; it must be 2 or 3")
        nodes = packed("values", given, np.float32, "F")
        desc = new_struct("pbf_grid_desc")
        desc.dimension = nodes.ndim
        for axis, start in enumerate(reals("origin", origin, (nodes.ndim,))):
            desc.nodes[axis] = uint32(f"the length of axis {axis} of values", nodes.shape[axis])
            desc.origin[axis] = start
        desc.cell = real("cell", cell)
        desc.values = ffi.cast("const float *", pointer(nodes))
        return cls._made(lib.pbf_shape_from_grid, desc)

    @classmethod
    def from_mesh(cls, mesh: Any, faces: AnyArray | None = None, *, cell: float,
                  thickness: float = 0.0) -> Self:
        """Of a closed mesh, or, with a thickness, a shell along any: vertices and faces as arrays, or
        an object that has both, as trimesh has. In 2D faces are segments."""
        if faces is None:
            if not hasattr(mesh, "faces"):
                raise InvalidArgumentError("faces is missing, and mesh has none of its own")
            mesh, faces = mesh.vertices, mesh.faces
        dimension = _dimension_of("vertices", mesh)
        points = _contiguous("vertices", mesh, np.float64, dimension)
        corners = _corners("faces", faces, dimension)
        desc = new_struct("pbf_mesh_desc")
        desc.dimension = dimension
        desc.vertex_count = uint32("the number of vertices", len(points))
        desc.face_count = uint32("the number of faces", len(corners))
        desc.vertices = ffi.cast("const double *", pointer(points))
        desc.faces = ffi.cast("const uint32_t *", pointer(corners))
        desc.cell, desc.thickness = real("cell", cell), real("thickness", thickness)
        return cls._made(lib.pbf_shape_from_mesh, desc)

    @classmethod
    def from_heights(cls, heights: AnyArray, *, spacing: float, base: float, cell: float) -> Self:
        """A terrain: heights[i, j] is the y above (i, j) spacing along x and z, in 2D heights[i];
        solid down to `base`."""
        given = real_numbers("heights", numpy_of("heights", heights))
        if given.ndim not in (1, 2):
            raise InvalidArgumentError(f"heights has {given.ndim} axes; it must be 1 or 2")
        columns = packed("heights", given, np.float64, "F")
        desc = new_struct("pbf_heights_desc")
        desc.dimension = columns.ndim + 1
        for axis, count in enumerate(columns.shape):
            desc.count[axis] = uint32(f"the length of axis {axis} of heights", count)
        desc.heights = ffi.cast("const double *", pointer(columns))
        desc.spacing, desc.base = real("spacing", spacing), real("base", base)
        desc.cell = real("cell", cell)
        return cls._made(lib.pbf_shape_from_heights, desc)

    @classmethod
    def from_points(cls, points: AnyArray, *, cell: float) -> Self:
        """The convex hull of points, shape (count, dimension)."""
        dimension = _dimension_of("points", points)
        given = _contiguous("points", points, np.float64, dimension)
        desc = new_struct("pbf_hull_desc")
        desc.dimension, desc.point_count = dimension, uint32("the number of points", len(given))
        desc.points = ffi.cast("const double *", pointer(given))
        desc.cell = real("cell", cell)
        return cls._made(lib.pbf_shape_from_points, desc)

    @classmethod
    def load(cls, source: PathLike | bytes | bytearray | memoryview) -> Self:
        """Of a file, or bytes, that `save` or pbf-bake wrote."""
        saved = state_of(source, b"PBFSHAPE")
        out = ffi.new("pbf_shape **")
        check(lib.pbf_load_shape(ffi.from_buffer(saved), len(saved), out))
        return cls(out[0])

    def save(self, path: PathLike | None = None) -> bytes:
        """As bytes, which go to a file, too, if told."""
        size = ffi.new("uint64_t *")
        check(lib.pbf_save_shape(self._handle, ffi.NULL, size))
        buffer = bytearray(size[0])
        check(lib.pbf_save_shape(self._handle, ffi.from_buffer(buffer), size))
        saved = bytes(buffer)
        if path is not None:
            _files.replace(path, saved)
        return saved

    def __copy__(self) -> Self:
        """It never changes: a copy is the same one."""
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).load, (self.save(),)

    @classmethod
    def _borrowed(cls, handle: Any) -> Self | None:
        """That of a collider, by a reference of its own."""
        if handle == ffi.NULL:
            return None
        check(lib.pbf_hold_shape(handle))
        return cls(handle)

    @property
    def handle(self) -> Any:
        """That of the C API."""
        return self._handle

    def _info(self) -> Any:
        info = new_struct("pbf_shape_info")
        check(lib.pbf_get_shape_info(self._handle, info))
        return info

    @property
    def dimension(self) -> int:
        return int(self._info().dimension)

    @property
    def volume(self) -> float:
        """Of the inside; in 2D its area."""
        return float(self._info().volume)

    @property
    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The lower and the upper corner of a box around the inside."""
        info = self._info()
        n = info.dimension
        return tuple(list(info.lower)[:n]), tuple(list(info.upper)[:n])

    @property
    def nbytes(self) -> int:
        return int(self._info().bytes)

    @property
    def values(self) -> NDArray[np.float32]:
        """The distances at its nodes, values[i, j, k] at origin + cell (i, j, k): a copy."""
        info = self._info()
        values = np.empty(list(info.nodes)[:info.dimension], np.float32, order="F")
        check(lib.pbf_get_shape_values(
            self._handle, values.size, ffi.cast("float *", values.ctypes.data)))
        return values

    @property
    def origin(self) -> tuple[float, ...]:
        """Where the first node is, in the shape's own space."""
        info = self._info()
        return tuple(list(info.origin)[:info.dimension])

    @property
    def cell(self) -> float:
        """The length between nodes."""
        return float(self._info().cell)

    def distance(self, point: Vector) -> float:
        """Of a point from the surface, negative inside."""
        at = ffi.new("double[]", reals("point", point, (self.dimension,)))
        distance = ffi.new("double *")
        check(lib.pbf_get_shape_distance(self._handle, at, distance, ffi.NULL))
        return float(distance[0])

    def __eq__(self, other: object) -> bool:
        """Whether it is the same one."""
        return isinstance(other, Geometry) and bool(self._handle == other._handle)

    def __hash__(self) -> int:
        return hash(self._handle)
