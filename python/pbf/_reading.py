"""Fields of the particles: read, seen without a copy, or in snapshots."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ._arrays import CPU, pointer
from ._choices import FIELDS, ORDERS, TYPES, W, choice
from ._errors import InvalidArgumentError, StateError
from ._handle import Handle
from ._library import ffi, lib, new_struct
from ._numbers import real, uint32
from .views import Snapshot, View


class Anisotropies(NamedTuple):
    """What renderers draw in place of balls: ellipsoids x + r A u, |u| <= 1, with r half of the
    distance of particles, x a row of `positions` and A one of `stretches`."""

    positions: NDArray[Any]  # (count, dimension), smoothed
    stretches: NDArray[Any]  # (count, dimension, dimension), symmetric


class Reading(Handle):
    """How a solver's particles are read."""

    def read(self, field: str, out: NDArray[Any] | None = None, *, first: int = 0,
             count: int | None = None, dtype: DTypeLike | None = None, components: int = 0,
             w: str | float | None = None, order: str = "added",
             behind: float = 0.0) -> NDArray[Any]:
        """One field ("position", "velocity", "id", "density" or "pressure") into an array.

        out         the array to write to, whatever its stride from row to row, so that no other
                    memory is taken: a column of a vertex buffer, shared memory
        first, count  rows; all those after `first` unless told
        dtype       "float32" or "float64"; the solver's own unless told
        components  numbers a particle: 3 or 4 for vectors in 2D, too
        w           what the fourth is: a number, "speed", "density" or "pressure"
        order       "added", or "stored": as they lie in memory, which is read fastest
        behind      positions so many steps back, 0 … 1; see `keep_previous`
        """
        struct = new_struct("pbf_read_desc")
        struct.field = choice("field", field, FIELDS)
        struct.order = choice("order", order, ORDERS)
        struct.first = uint32("first", first)
        struct.behind = real("behind", behind)
        if isinstance(w, str):
            struct.w = choice("w", w, W)
        elif w is not None:
            struct.w_value = real("w", w)
        width = self.dimension if field in ("position", "velocity") else 1
        if out is None:
            if count is None:
                count = max(0, self.count - struct.first)
            components = uint32("components", components) or (width if w is None else 4)
            usual = np.uint32 if field == "id" else self.dtype
            shape = (uint32("count", count), components)[:1 if components == 1 else 2]
            result = out = np.empty(shape, usual if dtype is None else dtype)
        else:
            result = out
            out, count, components = self._layout(out, count, components)
        struct.element_type = choice("dtype", out.dtype.name, TYPES)
        struct.count, struct.components = count, components
        struct.stride = out.strides[0] if len(out) > 1 else 0
        struct.data = pointer(out)
        if count:
            self._call(lib.pbf_read, struct)
        return result

    def _layout(self, out: Any, count: int | None, components: int) -> tuple[NDArray[Any], int, int]:
        """The caller's array, how many rows of it are written to, and how many numbers of each."""
        array = out
        if not isinstance(out, np.ndarray):
            device = getattr(out, "__dlpack_device__", lambda: None)()
            if device is None or device[0] != CPU:
                raise InvalidArgumentError(
                    f"out is a {type(out).__name__}; it must be an array in host memory")
            array = np.from_dlpack(out)
        if not array.flags.writeable or array.ndim not in (1, 2):
            raise InvalidArgumentError(
                f"out has {array.ndim} dimensions and is {'' if array.flags.writeable else 'not '}"
                "writeable; it must be an array of one or two, writeable")
        tight = array.ndim == 1 or array.shape[1] == 1 or array.strides[1] == array.itemsize
        if not tight or array.strides[0] < 0:
            raise InvalidArgumentError(
                f"out has the strides {array.strides}; the numbers of a row must lie side by side, "
                "and the rows one after another")
        width = 1 if array.ndim == 1 else array.shape[1]
        if count is None:
            count = len(array)
        if count > len(array) or components > width:
            raise InvalidArgumentError(
                f"out has the shape {array.shape}: too small for {count} rows of {components}")
        return array, uint32("count", count), components or width

    def anisotropies(self, *, smoothing: float = 0.9, radius: float = 0.0, max_ratio: float = 0.0,
                     lone_scale: float = 0.0, min_neighbors: int = 0, first: int = 0,
                     count: int | None = None) -> Anisotropies:
        """Smoothed positions and anisotropies for renderers, after Yu & Turk 2013: see
        pbf_get_anisotropies in anisotropy.h. Computed anew in each call.

        smoothing   how far positions move to the mean of their surroundings, 0 … 1
        radius      of the surroundings; 0: two smoothing radii
        max_ratio   of the longest axis and any other; 0: 4
        lone_scale  the size of a particle with fewer than `min_neighbors`; 0: 0.5
        """
        struct = new_struct("pbf_anisotropy_desc")
        struct.first = uint32("first", first)
        struct.min_neighbors = uint32("min_neighbors", min_neighbors)
        for name, value in (("smoothing", smoothing), ("radius", radius), ("max_ratio", max_ratio),
                            ("lone_scale", lone_scale)):
            setattr(struct, name, real(name, value))
        rows = max(0, self.count - struct.first) if count is None else uint32("count", count)
        made = Anisotropies(np.empty((rows, self.dimension), self.dtype),
                            np.empty((rows, self.dimension, self.dimension), self.dtype))
        struct.count = rows
        struct.positions, struct.stretches = pointer(made.positions), pointer(made.stretches)
        self._call(lib.pbf_get_anisotropies, struct)
        return made

    def keep_previous(self, enabled: bool = True) -> None:
        """Keeps the positions from before the last step, for `read(behind=…)`."""
        self._call(lib.pbf_keep_previous, bool(enabled))
        self._keeps_previous = bool(enabled)

    # ---- Without a copy ------------------------------------------------------------------------

    def view(self, field: str = "position") -> View:
        """One field in the solver's own memory: "position", "velocity", "id" or "pressure"."""
        return View(self, choice("field", field, FIELDS))

    def __dlpack__(self, **options: Any) -> Any:
        return self.view("position").__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        info = self.info
        return info.device_type, info.device

    def keep_snapshots(self, number: int = 3) -> None:
        """Has each call of `step` end with a snapshot, in so many places by turns; 0: no more."""
        self._call(lib.pbf_set_snapshots, uint32("number", number))
        self._snapshots = number

    def snapshot(self) -> Snapshot:
        """The latest one, from any thread, also while steps run; after `keep_snapshots`."""
        try:
            return Snapshot(self)
        except StateError as error:
            if self._snapshots:
                raise
            raise StateError(f"{error.sentence}. In Python: keep_snapshots(3)", error.status) from None
