"""Many worlds of one kind: `Batch`."""
from __future__ import annotations

import operator
import weakref
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import params as parameters
from ._arrays import CPU, AnyArray, numpy_of, packed, pointer, readonly_array, real_numbers
from ._callbacks import Callbacks, Log, Told, log_to_logging
from ._choices import FIELDS, W, choice, element_type, precision_of
from ._errors import InvalidArgumentError, UnsupportedError, check
from ._handle import desc_struct, params_struct
from ._library import ffi, lib, new_struct, text
from ._numbers import real, shown, uint32
from ._owned import Owned, Uncopied
from ._state import state_of
from .colliders import Collider, struct_array
from .params import Params
from .solver import PathLike, Solver
from .views import capsule_of, dtype_of, place_for_tensor

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._param_fields import ParamValues


def _destroy(place: Any, callbacks: Callbacks, worlds: Any) -> None:
    for world in list(worlds.values()):
        world._finalizer.detach()
    handle, place[0] = place[0], ffi.NULL
    lib.pbf_batch_destroy(handle)
    callbacks.drop()


def _leave(handle: Any, callbacks: Callbacks) -> None:
    """What closing a world does, which ends with its batch."""


class BatchTensor(Uncopied):
    """One field of all worlds at one time, of shape (worlds, rows, components), in memory of its own:
    for `torch.from_dlpack(…)` and its like, or as `array`."""

    def __init__(self, place: Any, callbacks: Callbacks) -> None:
        self._callbacks = callbacks
        self._place = place
        self._taken = self._shown = False

    def _held(self) -> Any:
        if self._taken:
            raise BufferError("this tensor has been taken by another array")
        return self._place[0].dl_tensor

    @property
    def array(self) -> NDArray[Any]:
        """As a NumPy array without a copy."""
        tensor = self._held()
        if tensor.device.device_type != CPU:
            raise UnsupportedError(
                "the tensor is in a GPU's memory, which NumPy can't see: torch.from_dlpack(tensor) "
                "takes it there, Batch.read copies it to the host")
        self._shown = True
        shape = tuple(tensor.shape[k] for k in range(tensor.ndim))
        return readonly_array(self, tensor.data, shape, dtype_of(tensor))

    def __dlpack_device__(self) -> tuple[int, int]:
        device = self._held().device
        return device.device_type, device.device_id

    def __dlpack__(self, *, stream: Any = None, max_version: tuple[int, int] | None = None,
                   dl_device: tuple[int, int] | None = None, copy: bool | None = None) -> Any:
        """A capsule, once: its consumer owns the memory from then on."""
        device = self.__dlpack_device__()
        if dl_device is not None and tuple(map(int, dl_device)) != device:
            raise BufferError(f"the tensor is on device {device}, not on {dl_device}")
        if copy or self._shown:  # arrays of it must not lose their memory to another owner
            return np.array(self.array).__dlpack__()
        self._taken = True
        return capsule_of(self._place)


class Batch(Uncopied, Owned):
    """`worlds` fluids alike in kind and capacity, stepped in one call, each as it would be alone.

    >>> batch = pbf.Batch(64, pbf.fill_box((0, 0), (0.5, 0.3), 0.025), spacing=0.025)
    >>> batch.set_start()
    >>> batch.step(4)
    >>> batch.positions.mean(axis=1)      # (64, 2)
    >>> batch.reset(mask=batch.positions[:, :, 1].max(axis=1) > 0.9)

    `positions` and `velocities` are arrays of shape (count, dimension), for all worlds alike, or
    (worlds, count, dimension). All other keywords are those of `Solver`; `threads` is how many
    threads step worlds. Arrays of a batch have the world as their first index. `mask`, of shape
    (worlds,), says which worlds a call is for; None: all.

    `batch[k]` is world k as a `Solver`, with all that one can do, until the batch is closed. Where a
    world fails the others go on; the call then raises what the first one met, and `failures` has
    the sentences of all.
    """

    _what = "batch"

    def __init__(self, worlds: int, positions: AnyArray | None = None,
                 velocities: AnyArray | None = None, *, dimension: int | None = None,
                 precision: str = "float32", capacity: int | None = None, backend: str = "auto",
                 device: int = 0, threads: int = 0, strict: bool = False, isa: str | None = None,
                 determinism: str = "across machines", stream: int = 0, log: Log | None = log_to_logging, params: Params | None = None,
                 **values: Unpack[ParamValues]) -> None:
        parameters.check_names(values, type(self).__name__)
        given = None if positions is None else numpy_of("positions", positions)
        if given is not None and given.ndim not in (2, 3):
            raise InvalidArgumentError(
                f"positions has the shape {given.shape}; it must be (count, dimension) or "
                "(worlds, count, dimension)")
        if dimension is None:
            dimension = 3 if given is None else given.shape[-1]
        if capacity is None:
            if given is None:
                raise InvalidArgumentError(
                    "neither positions nor a capacity is given: a batch wants to know how many "
                    "particles a world may have")
            capacity = max(1, given.shape[-2])
        self._create(uint32("worlds", worlds), {
            "dimension": dimension, "precision": precision_of(precision), "capacity": capacity,
            "backend": backend, "device": device, "threads": threads, "strict": strict,
            "isa": isa, "determinism": determinism}, stream, log, params, values)
        if given is not None:
            self.add(given, velocities)

    # ---- Life ----------------------------------------------------------------------------------

    def _create(self, worlds: int, desc: dict[str, Any], stream: int, log: Log | None,
                params: Params | None, values: Any) -> None:
        self._told = Told(log)
        callbacks = Callbacks(self._told)
        struct, kept = desc_struct(desc, stream, callbacks)
        first = parameters.defaults() if params is None else params_struct(params)
        parameters.write(first, values, struct.dimension)
        made = ffi.new("pbf_batch **")
        self._worlds: Any = weakref.WeakValueDictionary()
        self._finalizer = weakref.finalize(self, _destroy, made, callbacks, self._worlds)
        try:
            check(lib.pbf_batch_create(struct, first, worlds, made))
            callbacks.reraise()
        except BaseException:
            self._finalizer()
            raise
        del kept
        self._handle, self._desc, self._callbacks = made[0], desc, callbacks
        self._count = worlds

    # ---- Worlds --------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, world: int) -> Solver:
        """World `world` as a solver; negative numbers count from the end."""
        try:
            world = operator.index(world)
        except TypeError:
            raise InvalidArgumentError(f"world is {shown(world)}; it must be an integer") from None
        index = world + self._count if world < 0 else world
        if not 0 <= index < self._count:
            raise IndexError(f"world is {world}; the batch has {self._count} worlds")
        found = self._worlds.get(index)
        if found is None or found.closed:
            solver = ffi.new("pbf_solver **")
            self._call(lib.pbf_batch_get_world, index, solver)
            found = Solver.__new__(Solver)
            found._take(solver[0], dict(self._desc), self._callbacks)
            found._batch, found._stream = self, 0
            found._finalizer = weakref.finalize(found, _leave, solver[0], self._callbacks)
            self._worlds[index] = found
        return found

    def __iter__(self) -> Iterator[Solver]:
        return (self[k] for k in range(self._count))

    @property
    def dimension(self) -> int:
        return int(self._desc["dimension"])

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of positions and velocities."""
        return np.dtype(self._desc["precision"])

    @property
    def capacity(self) -> int:
        """As many particles fit into a world."""
        return int(self._desc["capacity"])

    @property
    def threads(self) -> int:
        """Threads that step worlds; 0 on a GPU."""
        info = new_struct("pbf_batch_info")
        self._call(lib.pbf_batch_get_info, info)
        return int(info.threads)

    @property
    def failures(self) -> dict[int, str]:
        """World → sentence, of those that have failed in the last call that goes through worlds."""
        statuses = np.zeros(self._count, np.int32)
        self._call(lib.pbf_batch_get_statuses, ffi.cast("pbf_status *", pointer(statuses)))
        found, sentence = {}, ffi.new("char **")
        for world in np.flatnonzero(statuses).tolist():
            self._call(lib.pbf_batch_get_sentence, world, ffi.cast("const char **", sentence))
            found[world] = text(sentence[0])
        return found

    def __repr__(self) -> str:
        if self.closed:
            return "<pbf.Batch, closed>"
        return (f"<pbf.Batch: {self._count} worlds of up to {self.capacity} particles in "
                f"{self.dimension}D, {self.dtype.name}, {self[0].backend}>")

    def _mask(self, mask: AnyArray | None) -> tuple[Any, Any]:
        """Its bytes, or NULL, and the array that they lie in."""
        if mask is None:
            return ffi.NULL, None
        given = numpy_of("mask", mask)
        if given.shape != (self._count,) or given.dtype.kind not in "biu":
            raise InvalidArgumentError(
                f"mask has the shape {given.shape} and holds {given.dtype}; it must be of shape "
                f"({self._count},), a truth value each")
        chosen = np.ascontiguousarray(given != 0).view(np.uint8)
        return ffi.cast("uint8_t *", pointer(chosen)), chosen

    # ---- Steps and starts ----------------------------------------------------------------------

    def step(self, steps: int = 1, mask: AnyArray | None = None) -> None:
        """Runs so many time steps of each world; Ctrl-C comes after them."""
        chosen, kept = self._mask(mask)
        self._call(lib.pbf_batch_step, chosen, uint32("steps", steps))

    def set_start(self, state: PathLike | bytes | bytearray | memoryview | None = None,
                  mask: AnyArray | None = None) -> None:
        """What `reset` goes back to: a state of `Solver.save`, one copy for all these worlds; None:
        the present state of each."""
        chosen, kept = self._mask(mask)
        if state is None:
            self._call(lib.pbf_batch_set_start, chosen, ffi.NULL, 0)
            return
        found = state_of(state)
        self._call(lib.pbf_batch_set_start, chosen, ffi.from_buffer(found), len(found))

    def reset(self, mask: AnyArray | None = None) -> None:
        """Back to the start: parameters, colliders, time and particles."""
        chosen, kept = self._mask(mask)
        self._call(lib.pbf_batch_reset, chosen)

    # ---- Actions -------------------------------------------------------------------------------

    def _doubles(self, name: str, array: AnyArray, shape: tuple[int, ...]) -> NDArray[np.float64]:
        """Numbers of this shape, or of one without worlds, which is then each one's. In 2D vectors
        may have two numbers."""
        given = numpy_of(name, array)
        real_numbers(name, given)
        if self.dimension == 2 and shape[-1] == 3 and given.ndim and given.shape[-1] == 2:
            given = np.concatenate([given, np.zeros((*given.shape[:-1], 1))], axis=-1)
        if given.shape not in (shape, shape[1:]):
            raise InvalidArgumentError(
                f"{name} has the shape {given.shape}; it must be {shape}, or {shape[1:]} for all "
                "worlds alike")
        return packed(name, np.broadcast_to(given, shape), np.float64)

    def set_gravity(self, gravity: AnyArray, mask: AnyArray | None = None) -> None:
        """Of each world: shape (worlds, 3), or (3,) for all alike."""
        chosen, kept = self._mask(mask)
        numbers = self._doubles("gravity", gravity, (self._count, 3))
        self._call(lib.pbf_batch_set_gravity, chosen, ffi.cast("double *", pointer(numbers)))

    def set(self, mask: AnyArray | None = None, **values: Unpack[ParamValues]) -> None:
        """Parameters, the same for all these worlds, one world after another."""
        parameters.check_names(values, "Batch.set")
        self._mask(mask)
        for k in range(self._count) if mask is None else np.flatnonzero(numpy_of("mask", mask)):
            self[int(k)].set(**values)

    def set_colliders(self, colliders: Iterable[Collider] | Collider,
                      mask: AnyArray | None = None) -> None:
        """Replaces all colliders, by the same ones in all these worlds."""
        chosen, kept = self._mask(mask)
        self._call(lib.pbf_batch_set_colliders, chosen, *struct_array(colliders))

    def move_colliders(self, positions: AnyArray, orientations: AnyArray | None = None, *,
                       duration: float, mask: AnyArray | None = None) -> None:
        """Has the colliders of each world, all that it has, reach positions, shape (worlds,
        colliders, 3), and orientations, shape (worlds, colliders, 4), in so long a time."""
        chosen, kept = self._mask(mask)
        given = numpy_of("positions", positions)
        if given.ndim not in (2, 3):
            raise InvalidArgumentError(
                f"positions has the shape {given.shape}; it must be (worlds, colliders, 3)")
        count = given.shape[-2]
        places = self._doubles("positions", given, (self._count, count, 3))
        turns = None
        if orientations is not None:
            turns = self._doubles("orientations", orientations, (self._count, count, 4))
        self._call(lib.pbf_batch_move_colliders, chosen, count,
                   ffi.cast("double *", pointer(places)),
                   ffi.NULL if turns is None else ffi.cast("double *", pointer(turns)),
                   real("duration", duration))

    def _rows(self, name: str, array: AnyArray) -> NDArray[Any]:
        given = numpy_of(name, array)
        if given.ndim == 2:
            given = np.broadcast_to(given, (self._count, *given.shape))
        if given.ndim != 3 or given.shape[0] != self._count or given.shape[2] != self.dimension:
            raise InvalidArgumentError(
                f"{name} has the shape {given.shape}; it must be ({self._count}, count, "
                f"{self.dimension}), or (count, {self.dimension}) for all worlds alike")
        return real_numbers(name, given)

    def add(self, positions: AnyArray, velocities: AnyArray | None = None,
            mask: AnyArray | None = None) -> None:
        """Adds particles, as emitters do: shape (worlds, count, dimension), or (count, dimension)
        for all alike."""
        places = self._rows("positions", positions)
        speeds = None if velocities is None else self._rows("velocities", velocities)
        if speeds is not None and speeds.shape != places.shape:
            raise InvalidArgumentError(
                f"velocities has the shape {speeds.shape}, positions {places.shape}")
        chosen = self._mask(mask)[1]
        counts = np.full(self._count, places.shape[1], np.uint32)
        if chosen is not None:
            counts *= chosen
            places = places[chosen != 0]
            speeds = None if speeds is None else speeds[chosen != 0]
        given = packed("positions", places, self.dtype)
        moving = None if speeds is None else packed("velocities", speeds, self.dtype)
        self._call(lib.pbf_batch_add_particles, ffi.cast("uint32_t *", pointer(counts)),
                   pointer(given), ffi.NULL if moving is None else pointer(moving))

    # ---- Observations --------------------------------------------------------------------------

    @property
    def counts(self) -> NDArray[np.uint32]:
        """Particles of each world."""
        counts = np.zeros(self._count, np.uint32)
        self._call(lib.pbf_batch_get_counts, ffi.cast("uint32_t *", pointer(counts)))
        return counts

    @property
    def times(self) -> NDArray[np.float64]:
        """The sum of each world's steps."""
        return np.array([world.time for world in self])

    @property
    def positions(self) -> NDArray[Any]:
        """A copy, of shape (worlds, count, dimension), in the order of adding. Where a world has
        fewer particles than another its last rows are 0."""
        return self.read("position")

    @property
    def velocities(self) -> NDArray[Any]:
        """As `positions`."""
        return self.read("velocity")

    def read(self, field: str, out: NDArray[Any] | None = None, *, first: int = 0,
             rows: int | None = None, dtype: DTypeLike | None = None, components: int = 0,
             w: str | float | None = None, mask: AnyArray | None = None) -> NDArray[Any]:
        """One field ("position", "velocity", "id", "density" or "pressure") of each world, as
        `Solver.read`, into an array of shape (worlds, rows, components), or (worlds, rows) of one
        component.

        out         the array to write to; its rows, and those of worlds, may lie apart
        first, rows  of each world: as many as the one has that has most, unless told
        """
        chosen, kept = self._mask(mask)
        struct = new_struct("pbf_read_desc")
        struct.field = choice("field", field, FIELDS)
        struct.first = uint32("first", first)
        if isinstance(w, str):
            struct.w = choice("w", w, W)
        elif w is not None:
            struct.w_value = real("w", w)
        width = self.dimension if field in ("position", "velocity") else 1
        width = uint32("components", components) or (width if w is None else 4)
        if out is None:
            if rows is None:
                rows = max(0, int(self.counts.max()) - struct.first)
            usual = np.uint32 if field == "id" else self.dtype
            shape = (self._count, uint32("rows", rows), width)
            out = np.zeros(shape[:2 if width == 1 else 3], usual if dtype is None else dtype)
        self._check_layout(out, rows, width)
        struct.element_type = element_type(out.dtype)
        struct.count, struct.components = out.shape[1], width
        struct.stride = out.strides[1] if out.shape[1] > 1 else 0
        struct.data = pointer(out)
        if out.size:
            self._call(lib.pbf_batch_read, chosen, struct,
                       out.strides[0] if self._count > 1 else 0)
        return out

    def _check_layout(self, out: Any, rows: int | None, width: int) -> None:
        wanted = (self._count, "rows" if rows is None else rows, width)
        if not isinstance(out, np.ndarray) or not out.flags.writeable:
            raise InvalidArgumentError(
                f"out is {type(out).__name__}; it must be a NumPy array that can be written to")
        shape = (*out.shape, 1) if out.ndim == 2 else out.shape
        fits = len(shape) == 3 and shape[0] == self._count and shape[2] == width
        if not fits or (rows is not None and shape[1] != rows):
            raise InvalidArgumentError(f"out has the shape {out.shape}; it must be {wanted}")
        apart = all(step > 0 or (step == 0 and number < 2)
                    for step, number in zip(out.strides[:2], out.shape))
        if not apart or (out.ndim == 3 and width > 1 and out.strides[2] != out.itemsize):
            raise InvalidArgumentError(
                f"out has the strides {out.strides}; the numbers of a row must lie side by side, "
                "and rows and worlds one after another")

    def tensor(self, field: str = "position", rows: int | None = None) -> BatchTensor:
        """The same for PyTorch, JAX and others, in memory that the tensor takes along."""
        place = place_for_tensor()
        self._call(lib.pbf_batch_export_dlpack, choice("field", field, FIELDS),
                   0 if rows is None else uint32("rows", rows), place)
        return BatchTensor(place, self._callbacks)
