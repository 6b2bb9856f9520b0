"""Fields of the particles: read, seen without a copy, or in snapshots."""
from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ._arrays import AnyArray, host_memory_of, numpy_of, packed, pointer, real_numbers
from ._choices import FIELDS, ORDERS, W, choice, element_type
from ._device import DeviceArray, SupportsCuda, device_array_of, place
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

    def read(self, field: str, out: Any = None, *, first: int = 0,
             count: int | None = None, dtype: DTypeLike | None = None, components: int = 0,
             w: str | float | None = None, order: str = "added",
             behind: float = 0.0, stream: Any = None) -> Any:
        """One field ("position", "velocity", "id", "density" or "pressure") into an array, which it
        gives: NumPy's, or `out`.

        out         the array to write to, whatever its stride from row to row, so that no other
                    memory is taken: a column of a vertex buffer, shared memory; of a solver on a
                    GPU an array there, too, of PyTorch, CuPy, …, for which the host does not wait
        first, count  rows; all those after `first` unless told
        dtype       "float32" or "float64"; the solver's own unless told
        components  numbers a particle: 3 or 4 for vectors in 2D, too
        w           what the fourth is: a number, "speed", "density" or "pressure"
        order       "added", or "stored": as they lie in memory, which is read fastest
        behind      positions so many steps back, 0 … 1; see `keep_previous`
        stream      of an array on a GPU: the stream that works on it, where that is not the array's
                    own or the current one
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
            device_array_of("out", out, stream)
        else:
            result = out
            out, count, components = self._layout(out, count, components, stream)
        struct.element_type = element_type(out.dtype)
        struct.count, struct.components = count, components
        struct.stride = out.strides[0] if len(out) > 1 else 0
        if isinstance(out, DeviceArray):
            place(struct, out, lib.PBF_DEVICE_CUDA)
        else:
            struct.data = pointer(out)
        if count:
            self._call(lib.pbf_read, struct)
        return result

    def _layout(self, out: Any, count: int | None, components: int, stream: Any
                ) -> tuple[NDArray[Any] | DeviceArray, int, int]:
        """The caller's array, how many rows of it are written to, and how many numbers of each."""
        array: NDArray[Any] | DeviceArray | None = device_array_of("out", out, stream)
        if array is None:
            array = host_memory_of("out", out)
        writeable = array.writeable if isinstance(array, DeviceArray) else array.flags.writeable
        if not writeable or array.ndim not in (1, 2):
            raise InvalidArgumentError(
                f"out has {array.ndim} dimensions and is {'' if writeable else 'not '}"
                "writeable; it must be an array of one or two, writeable")
        width = self._check_rows_of("out", array)
        if count is None:
            count = len(array)
        if count > len(array) or components > width:
            raise InvalidArgumentError(
                f"out has the shape {array.shape}: too small for {count} rows of {components}")
        return array, uint32("count", count), components or width

    @staticmethod
    def _check_rows_of(name: str, array: NDArray[Any] | DeviceArray) -> int:
        """How many numbers a row has, which must lie side by side."""
        if len(array) == 0:  # the strides of which NumPy leaves open
            return 1 if array.ndim == 1 else array.shape[1]
        tight = array.ndim == 1 or array.shape[1] == 1 or array.strides[1] == array.itemsize
        if not tight or array.strides[0] < 0 or (array.strides[0] == 0 and len(array) > 1):
            raise InvalidArgumentError(
                f"{name} has the strides {array.strides}; the numbers of a row must lie side by "
                "side, and the rows one after another")
        return 1 if array.ndim == 1 else array.shape[1]

    def write(self, field: str, array: AnyArray | SupportsCuda, *, first: int = 0,
              stream: Any = None) -> None:
        """Positions or velocities of the rows `first`, `first` + 1, … from an array of shape
        (count, dimension) or wider; further columns are left alone.

        On a GPU that the solver runs on it may be an array of PyTorch, CuPy, …: velocities are then
        written there, and the host does not wait. Some that are not finite are told by the next
        `step` or `synchronize`, and none is written. `stream` as in `read`.
        """
        struct = new_struct("pbf_write_desc")
        struct.field = choice("field", field, FIELDS)
        struct.first = uint32("first", first)
        found: NDArray[Any] | DeviceArray | None = device_array_of("array", array, stream)
        if found is None:
            given = real_numbers("array", numpy_of("array", array))
            own = given.dtype.name in ("float32", "float64") and given.dtype.isnative
            aligned = given if given.flags.aligned else given.copy()
            found = aligned if own else packed("array", given, self.dtype)
        if found.ndim != 2 or not self.dimension <= found.shape[1] <= 4:
            raise InvalidArgumentError(
                f"array has the shape {found.shape}; it must be (count, {self.dimension} … 4)")
        struct.components = self._check_rows_of("array", found)
        struct.count = uint32("count", len(found))
        struct.element_type = element_type(found.dtype, "array")
        struct.stride = found.strides[0] if len(found) > 1 else 0
        if isinstance(found, DeviceArray):
            place(struct, found, lib.PBF_DEVICE_CUDA)
        else:
            struct.data = pointer(found)
        if len(found):
            self._call(lib.pbf_write, struct)

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
