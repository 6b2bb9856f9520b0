"""A fluid: `Solver`."""
from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import params as parameters
from ._arrays import AnyArray, numpy_of
from ._callbacks import Log, log_to_logging
from ._copies import Copies
from ._errors import InvalidArgumentError
from ._library import ffi, lib, new_struct, text
from ._numbers import real, shown
from ._particles import Particles
from ._state import State
from ._steps import Steps
from .colliders import Collider, collider_of, struct_array
from .emission import Emission
from .params import Params
from .diffuse import DiffuseOf
from .phases import Phases
from .queries import Queries
from .reports import Load, Plan, StageTime, Stats

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._param_fields import ParamValues

PathLike = Union[str, "os.PathLike[str]"]

DEFAULT_CAPACITY = 100_000


class Solver(Steps, Particles, Queries, Emission, DiffuseOf, Phases, State):
    """A fluid of particles.

    >>> fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 1, 1), 0.05), domain_max=(2, 1, 1))
    >>> fluid.step(120)
    >>> fluid.positions.mean(axis=0)

    `positions` and `velocities` are any arrays of shape (count, dimension); the dimension is theirs
    unless it is given. The keywords up to `log` are what can't change later (pbf_desc in desc.h);
    `capacity` is as many particles as there are positions, or 100,000 without. All others are
    parameters, which are attributes, too: `fluid.viscosity = 0.01`.

    A solver belongs to one thread at a time; `cancel` and `snapshot` may be called from any. The
    interpreter's lock is free while the library works. It frees its memory when nothing refers to
    it, at the end of a `with` block, or by `close`; arrays of views and snapshots may outlive it.
    """

    def __init__(self, positions: AnyArray | None = None, velocities: AnyArray | None = None, *,
                 dimension: int | None = None, precision: str = "float32",
                 capacity: int | None = None, backend: str = "auto", device: int = 0,
                 threads: int = 0, strict: bool = False, isa: str | None = None,
                 determinism: str = "across machines", stream: int = 0,
                 log: Log | None = log_to_logging, params: Params | None = None,
                 **values: Unpack[ParamValues]) -> None:
        parameters.check_names(values, type(self).__name__)
        given = None if positions is None else numpy_of("positions", positions)
        if given is not None and given.ndim == 0:
            raise InvalidArgumentError(
                f"positions is {shown(positions)}; it must be an array of shape (count, dimension)")
        if dimension is None:
            dimension = 3 if given is None or given.ndim != 2 else given.shape[1]
        if capacity is None:
            capacity = DEFAULT_CAPACITY if given is None else max(1, len(given))
        self._create({"dimension": dimension, "precision": precision, "capacity": capacity,
                      "backend": backend, "device": device, "threads": threads, "strict": strict,
                      "isa": isa, "determinism": determinism}, stream, log, params, values)
        if given is not None:
            self.add(given, velocities)

    # ---- Colliders -----------------------------------------------------------------------------

    @property
    def colliders(self) -> list[Collider]:
        """As they stand and move now: copies. Assign a list to replace them all;
        `fluid.colliders += [ball]` adds one."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_collider_count, count)
        found = []
        for index in range(count[0]):
            struct = new_struct("pbf_collider")
            self._call(lib.pbf_get_collider, index, struct)
            found.append(collider_of(struct))
        return Copies(found)

    @colliders.setter
    def colliders(self, colliders: Iterable[Collider] | Collider) -> None:
        self._call(lib.pbf_set_colliders, *struct_array(colliders))

    def collider_loads(self) -> list[Load]:
        """What the fluid does to each collider; begins their sums anew. Needs params.loads."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_collider_count, count)
        return self._loads(lib.pbf_get_collider_loads, count[0])

    def wall_loads(self) -> list[Load]:
        """The same of the domain's walls, in the order of params.wall_velocity."""
        return self._loads(lib.pbf_get_wall_loads, 2 * self.dimension)

    def _loads(self, get: Any, count: int) -> list[Load]:
        structs = ffi.new("pbf_collider_load[]", max(count, 1))
        for struct in structs:
            struct.struct_size = ffi.sizeof("pbf_collider_load")
        self._call(get, count, structs)
        return [Load._of(structs[index]) for index in range(count)]

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
