"""A fluid: `Solver`."""
from __future__ import annotations

import logging
import math
import os
import pathlib
import struct as binary
import threading
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import params as parameters
from ._arrays import CPU, AnyArray, ids_of, numpy_of, pointer, rows_of
from ._errors import CapacityError, DataError, Error, InvalidArgumentError, StateError, check
from ._errors import last_error
from ._library import ffi, lib, new_struct, text
from ._numbers import UINT32_MAX, Vector, real, reals, uint32
from ._param_fields import ParamFields
from .colliders import Collider, collider_of, struct_array
from .fill import fill_ball, fill_box
from .params import Params
from .progress import progress_of
from .reports import Info, Plan, StageTime, Stats
from .views import Snapshot, View

if TYPE_CHECKING:
    from typing_extensions import Self, Unpack

    from ._param_fields import ParamValues

PathLike = Union[str, "os.PathLike[str]"]
Log = Callable[[int, str], None]

_PRECISIONS = {"float32": lib.PBF_FLOAT32, "float64": lib.PBF_FLOAT64}
_FIELDS = {
    "position": lib.PBF_FIELD_POSITION, "velocity": lib.PBF_FIELD_VELOCITY,
    "id": lib.PBF_FIELD_ID, "density": lib.PBF_FIELD_DENSITY,
    "pressure": lib.PBF_FIELD_PRESSURE}
_W = {"speed": lib.PBF_W_SPEED, "density": lib.PBF_W_DENSITY, "pressure": lib.PBF_W_PRESSURE}
_ORDERS = {"added": lib.PBF_ORDER_ADDED, "stored": lib.PBF_ORDER_STORED}
_TYPES = {"float32": lib.PBF_TYPE_FLOAT32, "float64": lib.PBF_TYPE_FLOAT64,
          "uint32": lib.PBF_TYPE_UINT32}

DEFAULT_CAPACITY = 100_000

logger = logging.getLogger("pbf")


def log_to_logging(level: int, message: str) -> None:
    """Where a solver's sentences go unless it is told otherwise: the logger "pbf"."""
    logger.log(logging.WARNING if level == lib.PBF_LOG_WARNING else logging.INFO, "%s", message)


def _choice(name: str, value: str, known: Mapping[str, int]) -> int:
    if value not in known:
        listed = ", ".join(f'"{each}"' for each in known)
        raise InvalidArgumentError(f'{name} is {value!r}; it must be one of {listed}')
    return known[value]


def _precision_of(precision: Any) -> str:
    try:
        name = np.dtype(precision).name
    except TypeError:
        name = str(precision)
    _choice("precision", name, _PRECISIONS)
    return name


def _chars(name: str, value: Any) -> Any:
    if value is None:
        return ffi.NULL
    if not isinstance(value, str):
        raise InvalidArgumentError(f"{name} is {value!r}; it must be a string")
    return ffi.new("char[]", value.encode())


def _struct_of(params: Params) -> Any:
    if not isinstance(params, Params):
        raise InvalidArgumentError(f"params is {params!r}; it must be a Params")
    return params.copy()._get_params()


class _Callbacks:
    """The log's C function, and what the caller's has raised. It must not refer to the solver,
    which it outlives."""

    def __init__(self, log: Log | None) -> None:
        self.log = log
        self.raised: BaseException | None = None
        self.function = ffi.NULL if log is None else ffi.callback("pbf_log_fn", self._call)

    def _call(self, user: Any, level: int, message: Any) -> None:
        try:
            if self.log is not None:
                self.log(level, text(message))
        except BaseException as error:  # no exception may cross the library
            self.raised = self.raised or error

    def reraise(self) -> None:
        if self.raised is not None:
            error, self.raised = self.raised, None
            raise error


def _destroy(handle: Any, callbacks: _Callbacks) -> None:
    lib.pbf_destroy(handle)
    callbacks.log = None


class Solver(ParamFields):
    """A fluid of particles.

    >>> fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 1, 1), 0.05), domain_max=(2, 1, 1))
    >>> fluid.step(120)
    >>> fluid.positions.mean(axis=0)

    `positions` and `velocities` are any arrays of shape (count, dimension); the dimension is theirs
    unless it is given. The keywords up to `log` are what can't change later (pbf_desc in pbf.h);
    `capacity` is as many particles as there are positions, or 100,000 without. All others are
    parameters, which are attributes, too: `fluid.viscosity = 0.01`.

    A solver belongs to one thread at a time; `cancel` and `snapshot` may be called from any. The
    interpreter's lock is free while the library works. It frees its memory when nothing refers to
    it, at the end of a `with` block, or by `close`; arrays of views and snapshots may outlive it.
    """

    def __init__(self, positions: AnyArray | None = None, velocities: AnyArray | None = None, *,
                 dimension: int | None = None, precision: str = "float32",
                 capacity: int | None = None, backend: str = "auto", device: int = 0,
                 threads: int = 0, strict: bool = False, isa: str | None = None, stream: int = 0,
                 log: Log | None = log_to_logging, params: Params | None = None,
                 **values: Unpack[ParamValues]) -> None:
        parameters.check_names(values, type(self).__name__)
        given = None if positions is None else numpy_of("positions", positions)
        if given is not None and given.ndim == 0:
            raise InvalidArgumentError(
                f"positions is {positions!r}; it must be an array of shape (count, dimension)")
        if dimension is None:
            dimension = 3 if given is None or given.ndim != 2 else given.shape[1]
        if capacity is None:
            capacity = DEFAULT_CAPACITY if given is None else max(1, len(given))
        self._create({"dimension": dimension, "precision": precision, "capacity": capacity,
                      "backend": backend, "device": device, "threads": threads, "strict": strict,
                      "isa": isa}, stream, log, params, values)
        if given is not None:
            self.add(given, velocities)

    # ---- Life ----------------------------------------------------------------------------------

    def _create(self, desc: dict[str, Any], stream: int, log: Log | None, params: Params | None,
                values: Mapping[str, Any]) -> None:
        precision = _precision_of(desc["precision"])
        desc = {**desc, "precision": precision}
        callbacks = _Callbacks(log)
        struct = ffi.new("pbf_desc *")
        check(lib.pbf_desc_init(struct, ffi.sizeof("pbf_desc")))
        for name in ("dimension", "capacity", "threads"):
            setattr(struct, name, uint32(name, desc[name]))
        struct.precision = _PRECISIONS[precision]
        struct.device = uint32("device", desc["device"])
        struct.strict = bool(desc["strict"])
        struct.backend = backend = _chars("backend", desc["backend"])
        struct.isa = isa = _chars("isa", desc["isa"])
        struct.stream = ffi.cast("void *", stream)
        struct.log = callbacks.function
        first = parameters.defaults() if params is None else _struct_of(params)
        parameters.write(first, values, struct.dimension)
        made = ffi.new("pbf_solver **")
        check(lib.pbf_create(struct, first, made))
        del backend, isa
        self._stream = stream
        self._adopt(made[0], desc, callbacks)
        callbacks.reraise()

    def _adopt(self, handle: Any, desc: dict[str, Any], callbacks: _Callbacks) -> None:
        self._handle, self._desc, self._callbacks = handle, desc, callbacks
        self._snapshots = 0
        self._keeps_previous = False
        # At the interpreter's exit, too, while its threads may still log.
        self._finalizer = weakref.finalize(self, _destroy, handle, callbacks)

    @property
    def handle(self) -> Any:
        """The pbf_solver of the C API, for calls through `pbf.lib`."""
        if self.closed:
            raise StateError("this solver has been closed", lib.PBF_ERROR_STATE)
        return self._handle

    @property
    def closed(self) -> bool:
        finalizer = getattr(self, "_finalizer", None)
        return finalizer is None or not finalizer.alive

    def close(self) -> None:
        """Frees the solver; steps that run are cancelled. A second call does nothing."""
        if not self.closed:
            self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def _call(self, function: Any, *arguments: Any) -> None:
        """One call of the library; what the log has raised in it comes after it."""
        check(function(self.handle, *arguments))
        self._callbacks.reraise()

    # ---- Parameters ----------------------------------------------------------------------------

    def _get_params(self) -> Any:
        struct = new_struct("pbf_params")
        self._call(lib.pbf_get_params, struct)
        return struct

    def _set_params(self, values: Mapping[str, Any]) -> None:
        struct = self._get_params()
        parameters.write(struct, values, self.dimension)
        self._call(lib.pbf_set_params, struct)

    def _dimension(self) -> int:
        return self.dimension

    def set(self, **values: Unpack[ParamValues]) -> None:
        """Sets several parameters at once; none where one of them is refused."""
        parameters.check_names(values, "Solver.set")
        self._set_params(values)

    @property
    def params(self) -> Params:
        """All parameters: a copy. Assign one to set them all."""
        return Params._of(self._get_params())

    @params.setter
    def params(self, params: Params) -> None:
        self._call(lib.pbf_set_params, _struct_of(params))

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            near = parameters.near(name)
            if near:
                raise AttributeError(f'a Solver has no attribute "{name}"; did you mean "{near}"?')
        super().__setattr__(name, value)

    # ---- What it is ----------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        return int(self._desc["dimension"])

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of positions and velocities."""
        return np.dtype(self._desc["precision"])

    @property
    def capacity(self) -> int:
        """As many particles fit; `reserve` changes it."""
        return int(self._desc["capacity"])

    @property
    def info(self) -> Info:
        struct = new_struct("pbf_info")
        self._call(lib.pbf_get_info, struct)
        return Info._of(struct)

    @property
    def backend(self) -> str:
        """The backend that serves."""
        return self.info.backend

    @property
    def time(self) -> float:
        """The sum of the steps' lengths."""
        return self.info.time

    @property
    def steps_done(self) -> int:
        return self.info.step

    @property
    def rest_distance(self) -> float:
        """The distance of particles at rest: `spacing`, or half of `smoothing_radius`."""
        struct = self._get_params()
        return float(struct.spacing or struct.smoothing_radius / 2)

    def __repr__(self) -> str:
        if self.closed:
            return "<pbf.Solver, closed>"
        try:
            info = self.info
            return (f"<pbf.Solver: {self.count} particles in {info.dimension}D, "
                    f"{self.dtype.name}, {info.backend}, {info.time:g} after {info.step} steps>")
        except Error as error:
            return f"<pbf.Solver: {error}>"

    # ---- Steps ---------------------------------------------------------------------------------

    def step(self, steps: int = 1) -> None:
        """Runs so many time steps. Ctrl-C ends a call of several between two of them; what is done
        stands. A GPU works on after the call: whatever reads waits for it."""
        steps = uint32("steps", steps)
        if steps > 1 and threading.current_thread() is threading.main_thread():
            self._step_interruptibly(steps)
        else:
            self._call(lib.pbf_step, steps)

    def _step_interruptibly(self, steps: int) -> None:
        """The library's own thread runs the steps, another waits for them in C, and this one where
        Python's signal handlers run."""
        failures: list[Error] = []
        handle, ended = self.handle, threading.Event()

        def wait() -> None:
            status = lib.pbf_end_step(handle)
            if status:
                failures.append(last_error(status))
            ended.set()

        waiter = threading.Thread(target=wait, name="pbf-step", daemon=True)
        self._call(lib.pbf_begin_step, steps)
        try:
            waiter.start()
            ended.wait()  # Thread.join takes a thread that it is interrupted in for ended
        except BaseException:
            lib.pbf_cancel(handle)
            if waiter.ident is None:  # it could not be started
                wait()
            ended.wait()
            raise
        if failures:
            raise failures[0]
        self._callbacks.reraise()

    def begin_step(self, steps: int = 1) -> None:
        """Has steps run beside what this thread does next; `end_step` waits for them."""
        self._call(lib.pbf_begin_step, uint32("steps", steps))

    def end_step(self) -> None:
        self._call(lib.pbf_end_step)

    @contextmanager
    def stepping(self, steps: int = 1) -> Iterator[None]:
        """Steps that run beside a `with` block, and have ended after it."""
        self.begin_step(steps)
        try:
            yield
        except BaseException:
            self.cancel()
            lib.pbf_end_step(self.handle)
            raise
        self.end_step()

    def cancel(self) -> None:
        """Has the call of steps that is inside the solver raise `CancelledError`; from any thread."""
        check(lib.pbf_cancel(self.handle))

    def synchronize(self) -> None:
        """Waits for a GPU; raises what a step met after the call had returned."""
        self._call(lib.pbf_synchronize)

    def frames(self, count: int, *, steps: int = 1, progress: bool = False) -> Iterator[int]:
        """Frame after frame, `steps` steps before each.

        >>> for frame in fluid.frames(60, steps=2, progress=True):
        ...     pictures.append(fluid.render())
        """
        for frame in progress_of(range(uint32("count", count)), progress, "frame"):
            self.step(steps)
            yield frame

    def run(self, seconds: float | None = None, *, steps: int | None = None,
            progress: bool = False) -> None:
        """Runs so long, or so many steps, perhaps with a progress bar (tqdm's)."""
        if (seconds is None) == (steps is None):
            raise TypeError("run wants either seconds or steps")
        if steps is None:
            seconds = real("seconds", seconds)
            if not 0 <= seconds / self.time_step <= UINT32_MAX:
                raise InvalidArgumentError(
                    f"seconds is {seconds}; in steps of {self.time_step:g} it must be 0 … "
                    f"{UINT32_MAX * self.time_step:g}")
            steps = math.ceil(seconds / self.time_step - 1e-6)
        steps = uint32("steps", steps)
        if not progress:
            self.step(steps)
            return
        batch = max(1, steps // 200)
        starts = progress_of(range(0, steps, batch), True, "batch", steps)
        for start in starts:
            self.step(min(batch, steps - start))

    @property
    def step_limit(self) -> float:
        """The longest `time_step` that the present state stands, undivided."""
        limit = ffi.new("double *")
        self._call(lib.pbf_get_step_limit, limit)
        return float(limit[0])

    # ---- Particles -----------------------------------------------------------------------------

    @property
    def count(self) -> int:
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_count, count)
        return int(count[0])

    def __len__(self) -> int:
        return self.count

    def __bool__(self) -> bool:
        return True

    def add(self, positions: AnyArray, velocities: AnyArray | None = None) -> range:
        """Adds particles, and gives their ids. `velocities`: one each, one for all, or None: at
        rest."""
        rows = rows_of("positions", positions, self.dimension, self.dtype)
        speeds = None
        if velocities is not None:
            speeds = rows_of("velocities", velocities, self.dimension, self.dtype)
            if len(speeds) == 1 and len(rows) != 1:
                speeds = np.ascontiguousarray(np.broadcast_to(speeds, rows.shape))
            if len(speeds) != len(rows):
                raise InvalidArgumentError(
                    f"there are {len(rows)} positions and {len(speeds)} velocities")
        first = ffi.new("uint32_t *")
        try:
            self._call(lib.pbf_add_particles, uint32("count", len(rows)), pointer(rows),
                       ffi.NULL if speeds is None else pointer(speeds), first)
        except CapacityError as error:
            raise CapacityError(
                f"{error.sentence}. In Python: Solver(capacity=…), or Solver.reserve") from None
        return range(first[0], first[0] + len(rows))

    def add_box(self, lower: Vector, upper: Vector,
                velocity: Vector | None = None) -> range:
        """Fills a box with particles at rest density."""
        return self.add(fill_box(lower, upper, self.rest_distance), velocity)

    def add_ball(self, center: Vector, radius: float,
                 velocity: Vector | None = None) -> range:
        """Fills a ball, in 2D a disc, with particles at rest density."""
        return self.add(fill_ball(center, radius, self.rest_distance), velocity)

    def remove(self, ids: AnyArray) -> None:
        """Removes the particles with these ids; none where one id is unknown."""
        array = ids_of(ids)
        self._call(lib.pbf_remove_particles, len(array), ffi.cast("uint32_t *", pointer(array)))

    def _box(self, lower: Vector | None, upper: Vector | None) -> tuple[Any, Any]:
        corners = []
        for name, given, none in (("lower", lower, -math.inf), ("upper", upper, math.inf)):
            values = [none] * 3
            if given is not None:
                listed = [none if value is None else value for value in given]
                values[:self.dimension] = reals(name, listed, (self.dimension,))
            corners.append(ffi.new("double[3]", values))
        return corners[0], corners[1]

    def remove_in_box(self, lower: Vector | None = None,
                      upper: Vector | None = None) -> int:
        """Removes what is in a box, and says how many they were. None is no bound."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_remove_in_box, *self._box(lower, upper), count)
        return int(count[0])

    def find_in_box(self, lower: Vector | None = None,
                    upper: Vector | None = None) -> NDArray[np.uint32]:
        """The ids of what is in a box, ascending. None is no bound."""
        count, box = ffi.new("uint32_t *"), self._box(lower, upper)
        self._call(lib.pbf_find_in_box, *box, 0, ffi.NULL, count)
        ids = np.empty(count[0], np.uint32)
        if len(ids):
            self._call(lib.pbf_find_in_box, *box, len(ids),
                       ffi.cast("uint32_t *", pointer(ids)), count)
        return ids

    @property
    def positions(self) -> NDArray[Any]:
        """A copy, of shape (count, dimension), in the order of adding. Assign to set all."""
        return self.read("position")

    @positions.setter
    def positions(self, positions: AnyArray) -> None:
        self._set_all("positions", positions)

    @property
    def velocities(self) -> NDArray[Any]:
        """As `positions`."""
        return self.read("velocity")

    @velocities.setter
    def velocities(self, velocities: AnyArray) -> None:
        self._set_all("velocities", velocities)

    @property
    def ids(self) -> NDArray[np.uint32]:
        """A copy, increasing: ids are never used again."""
        return self.read("id")

    @property
    def densities(self) -> NDArray[Any]:
        """Density over rest density; looks for neighbours."""
        return self.read("density")

    @property
    def pressures(self) -> NDArray[Any]:
        """Pressure over rest density of the last step; looks for neighbours."""
        return self.read("pressure")

    def _set_all(self, name: str, values: AnyArray) -> None:
        rows = rows_of(name, values, self.dimension, self.dtype)
        if len(rows) != self.count:
            raise InvalidArgumentError(
                f"{name} has {len(rows)} rows for {self.count} particles; Solver.set_{name} sets "
                "some of them, Solver.add and Solver.remove change their number")
        self._set_rows(name, rows, 0)

    def _set_rows(self, name: str, values: AnyArray, first: int) -> None:
        rows = rows_of(name, values, self.dimension, self.dtype)
        self._call(getattr(lib, f"pbf_set_{name}"), uint32("first", first), len(rows),
                   pointer(rows))

    def set_positions(self, positions: AnyArray, first: int = 0) -> None:
        """Sets those of the rows `first`, `first` + 1, …"""
        self._set_rows("positions", positions, first)

    def set_velocities(self, velocities: AnyArray, first: int = 0) -> None:
        """Sets those of the rows `first`, `first` + 1, …"""
        self._set_rows("velocities", velocities, first)

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
        struct.field = _choice("field", field, _FIELDS)
        struct.order = _choice("order", order, _ORDERS)
        struct.first = uint32("first", first)
        struct.behind = real("behind", behind)
        if isinstance(w, str):
            struct.w = _choice("w", w, _W)
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
        struct.element_type = _choice("dtype", out.dtype.name, _TYPES)
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

    def keep_previous(self, enabled: bool = True) -> None:
        """Keeps the positions from before the last step, for `read(behind=…)`."""
        self._call(lib.pbf_keep_previous, bool(enabled))
        self._keeps_previous = bool(enabled)

    # ---- Without a copy ------------------------------------------------------------------------

    def view(self, field: str = "position") -> View:
        """One field in the solver's own memory: "position", "velocity", "id" or "pressure"."""
        return View(self, _choice("field", field, _FIELDS))

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
        return Snapshot(self)

    # ---- Colliders -----------------------------------------------------------------------------

    @property
    def colliders(self) -> list[Collider]:
        """As they stand and move now: copies. Assign a list to replace them all."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_collider_count, count)
        found = []
        for index in range(count[0]):
            struct = new_struct("pbf_collider")
            self._call(lib.pbf_get_collider, index, struct)
            found.append(collider_of(struct))
        return found

    @colliders.setter
    def colliders(self, colliders: Iterable[Collider] | Collider) -> None:
        self._call(lib.pbf_set_colliders, *struct_array(colliders))

    def move_colliders(self, targets: Iterable[Collider] | Collider, duration: float) -> None:
        """Has each reach its target's pose and size in so long a time, and then stand still."""
        self._call(lib.pbf_move_colliders, *struct_array(targets), real("duration", duration))

    # ---- What happened -------------------------------------------------------------------------

    @property
    def stats(self) -> Stats:
        struct = new_struct("pbf_stats")
        self._call(lib.pbf_get_stats, struct)
        return Stats._of(struct)

    @property
    def plan(self) -> Plan:
        struct = new_struct("pbf_plan")
        self._call(lib.pbf_get_plan, struct)
        return Plan._of(struct)

    def set_timing(self, enabled: bool = True) -> None:
        """Whether stages are timed; switching on clears the times."""
        self._call(lib.pbf_set_timing, bool(enabled))

    @property
    def timings(self) -> dict[str, StageTime]:
        struct = new_struct("pbf_timings")
        self._call(lib.pbf_get_timings, struct)
        stages = (struct.stages[i] for i in range(struct.stage_count))
        return {text(stage.name): StageTime(text(stage.name), stage.milliseconds, stage.runs)
                for stage in stages}

    # ---- State ---------------------------------------------------------------------------------

    def save(self, path: PathLike | None = None) -> bytes:
        """Parameters, colliders, time and particles as bytes, which go to a file, too, if told."""
        size = ffi.new("uint64_t *")
        self._call(lib.pbf_save, ffi.NULL, size)
        buffer = bytearray(size[0])
        self._call(lib.pbf_save, ffi.from_buffer(buffer), size)
        state = bytes(buffer[:size[0]])
        if path is not None:
            pathlib.Path(path).write_bytes(state)
        return state

    def load(self, source: PathLike | bytes | bytearray | memoryview) -> None:
        """Replaces the whole state by a saved one, of the same dimension and precision."""
        state = _state_of(source)
        self._call(lib.pbf_load, ffi.from_buffer(state), len(state))

    @classmethod
    def restore(cls, source: PathLike | bytes | bytearray | memoryview, *,
                capacity: int | None = None, **desc: Any) -> Self:
        """A new solver in a saved state, of its dimension and precision."""
        state = _state_of(source)
        dimension, precision, count = _kind_of(state)
        solver = cls(dimension=dimension, precision=precision,
                     capacity=max(count, 1) if capacity is None else capacity, **desc)
        solver.load(state)
        return solver

    def reserve(self, capacity: int) -> None:
        """Makes room for so many particles: a new solver in the same state takes this one's place,
        with the same bits. Views and snapshots that are held stay as they are."""
        state, snapshots, keeps = self.save(), self._snapshots, self._keeps_previous
        desc = {**self._desc, "capacity": uint32("capacity", capacity)}
        old = self._finalizer
        larger = Solver.__new__(Solver)
        larger._create(desc, self._stream, self._callbacks.log, self.params, {})
        larger.load(state)
        larger._finalizer.detach()
        self._adopt(larger._handle, desc, larger._callbacks)
        old()
        self._keep(snapshots, keeps)

    def _keep(self, snapshots: int, previous: bool) -> None:
        if snapshots:
            self.keep_snapshots(snapshots)
        if previous:
            self.keep_previous()

    @property
    def hash(self) -> int:
        """64 bits over step, count, ids, positions and velocities."""
        value = ffi.new("uint64_t *")
        self._call(lib.pbf_hash, value)
        return int(value[0])

    def __getstate__(self) -> dict[str, Any]:
        own = {name: value for name, value in vars(self).items() if not name.startswith("_")}
        return {"desc": self._desc, "state": self.save(), "snapshots": self._snapshots,
                "keeps_previous": self._keeps_previous, "attributes": own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._create(state["desc"], 0, log_to_logging, None, {})
        self.load(state["state"])
        self._keep(state["snapshots"], state["keeps_previous"])
        self.__dict__.update(state["attributes"])

    def copy(self) -> Self:
        """A second solver in the same state."""
        made = type(self).__new__(type(self))
        made.__setstate__(self.__getstate__())
        return made

    __copy__ = copy

    # ---- Pictures ------------------------------------------------------------------------------

    def render(self, size: tuple[int, int] = (800, 600), **options: Any) -> NDArray[np.uint8]:
        """A picture of the present state, of shape (height, width, 3): see `pbf.render`."""
        from .picture import render
        return render(self, size, **options)

    def save_picture(self, path: PathLike, size: tuple[int, int] = (800, 600),
                     **options: Any) -> None:
        """Writes `render` as a PNG file."""
        from .picture import save_png
        save_png(path, self.render(size, **options))

    def _repr_png_(self) -> bytes | None:
        """What Jupyter shows."""
        if self.closed:
            return None
        from .picture import png_bytes
        return png_bytes(self.render((640, 480)))


def _state_of(source: PathLike | bytes | bytearray | memoryview) -> bytes | bytearray | memoryview:
    if isinstance(source, (bytes, bytearray, memoryview)):
        return source
    return pathlib.Path(source).read_bytes()


def _kind_of(state: bytes | bytearray | memoryview) -> tuple[int, str, int]:
    """Dimension, precision and count of a saved state: the head of lib/state/snapshot.h. All else
    of it the library checks."""
    head = "<8s8xII12xI"
    if len(state) >= binary.calcsize(head):
        magic, dimension, precision, count = binary.unpack_from(head, state)
        names = {bits: name for name, bits in _PRECISIONS.items()}
        if magic == b"PBFSTATE" and dimension in (2, 3) and precision in names:
            return dimension, names[precision], min(count, UINT32_MAX)
    raise DataError("the saved state does not begin as one; Solver.restore takes what Solver.save "
                    "wrote", lib.PBF_ERROR_DATA)
