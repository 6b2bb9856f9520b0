"""Spray, foam and air bubbles, for looks; see pbf/diffuse.h."""
from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ._arrays import AnyArray, numpy_of, packed, pointer, real_numbers, rows_of
from ._errors import InvalidArgumentError
from ._handle import Handle
from ._library import ffi, lib, new_struct
from ._numbers import Vector, real, reals, shown, uint32
from ._structs import dataclass_of


@dataclass
class Diffuse:
    """What spray, foam and bubbles are made by. `Solver.default_diffuse()` gives what suits a
    solver's spacing and gravity; change what you like, and assign it to `Solver.diffuse`."""

    capacity: int
    """At most so many at once."""
    seed: int
    interval: int
    """They move after every so many steps."""
    foam_neighbors: int
    """With fewer particles of the fluid within h: spray."""
    bubble_neighbors: int
    """With more: a bubble."""
    trapped_air_min: float
    """A speed."""
    trapped_air_max: float
    wave_crest_min: float
    wave_crest_max: float
    energy_min: float
    """Of |v|²/2."""
    energy_max: float
    trapped_air_rate: float
    """Particles a unit of time that one of the fluid makes."""
    wave_crest_rate: float
    lifetime_min: float
    lifetime_max: float
    buoyancy: float
    """Of bubbles, in gravities."""
    bubble_drag: float
    """By the fluid, 1/time."""
    spray_drag: float
    """By air at rest, 1/time."""
    scatter: float
    """So far off the fluid's velocities theirs begin, as a part of its speed."""


@dataclass(frozen=True)
class DiffuseInfo:
    """How many there are, and what became of others since they were set."""

    capacity: int
    """0: the solver has none."""
    count: int
    spray: int
    foam: int
    bubbles: int
    time: float
    generated: int
    expired: int
    recycled: int
    """Made way for younger ones."""


@dataclass(frozen=True)
class DiffuseParticles:
    """All of them at one time, the oldest first."""

    positions: NDArray[Any]
    velocities: NDArray[Any]
    ages: NDArray[Any]
    lives: NDArray[Any]
    """Times that are left to them."""
    kinds: NDArray[np.uint32]
    """0: spray, 1: foam, 2: a bubble."""
    ids: NDArray[np.uint64]


def _written(desc: Diffuse) -> Any:
    struct = new_struct("pbf_diffuse_desc")
    for field in fields(Diffuse):
        value = getattr(desc, field.name)
        whole = isinstance(getattr(struct, field.name), int)
        setattr(struct, field.name,
                uint32(field.name, value) if whole else real(field.name, value))
    return struct


class DiffuseOf(Handle):
    """The spray, foam and bubbles of a solver."""

    def default_diffuse(self) -> Diffuse:
        """What suits the solver's dimension, smoothing_radius, spacing and gravity."""
        struct = new_struct("pbf_diffuse_desc")
        self._call(lib.pbf_diffuse_init, struct, ffi.sizeof("pbf_diffuse_desc"))
        return dataclass_of(Diffuse, struct)

    @property
    def diffuse(self) -> Optional[Diffuse]:
        """A copy of what they are made by; None: there are none. Assign one to have the solver
        make and move them in its steps, None to end them."""
        if self.diffuse_info.capacity == 0:
            return None
        struct = new_struct("pbf_diffuse_desc")
        self._call(lib.pbf_get_diffuse, struct)
        return dataclass_of(Diffuse, struct)

    @diffuse.setter
    def diffuse(self, desc: Optional[Diffuse]) -> None:
        if desc is not None and not isinstance(desc, Diffuse):
            raise InvalidArgumentError(f"diffuse is {shown(desc)}; it must be a Diffuse or None")
        self._call(lib.pbf_set_diffuse, ffi.NULL if desc is None else _written(desc))

    @property
    def diffuse_info(self) -> DiffuseInfo:
        """How many there are, by kind."""
        struct = new_struct("pbf_diffuse_info")
        self._call(lib.pbf_get_diffuse_info, struct)
        return dataclass_of(DiffuseInfo, struct)

    @property
    def diffuse_particles(self) -> DiffuseParticles:
        """Copies, in new arrays."""
        count = self.diffuse_info.count
        places = [np.empty((count, self.dimension), self.dtype) for _ in range(2)]
        times = [np.empty(count, self.dtype) for _ in range(2)]
        kinds, ids = np.empty(count, np.uint32), np.empty(count, np.uint64)
        struct = new_struct("pbf_diffuse_read")
        struct.count = count
        struct.positions, struct.velocities = (pointer(array) for array in places)
        struct.ages, struct.lives = (pointer(array) for array in times)
        struct.kinds = ffi.cast("uint32_t *", pointer(kinds))
        struct.ids = ffi.cast("uint64_t *", pointer(ids))
        self._call(lib.pbf_read_diffuse, struct)
        return DiffuseParticles(*places, *times, kinds, ids)

    def add_diffuse(self, positions: AnyArray, lives: AnyArray,
                    velocities: Optional[AnyArray] = None) -> None:
        """Adds some of your own; without velocities at rest. `lives`: one number, or one for
        each."""
        places = rows_of("positions", positions, self.dimension, self.dtype)
        given = real_numbers("lives", numpy_of("lives", lives))
        if given.ndim > 1 or (given.ndim == 1 and len(given) != len(places)):
            raise InvalidArgumentError(
                f"lives has the shape {given.shape}; it must be one number, or {len(places)}")
        times = packed("lives", np.broadcast_to(given, len(places)), self.dtype)
        speeds = (None if velocities is None else
                  rows_of("velocities", velocities, self.dimension, self.dtype))
        if speeds is not None and len(speeds) != len(places):
            raise InvalidArgumentError(
                f"velocities has {len(speeds)} rows; it must have as many as positions, "
                f"{len(places)}")
        self._call(lib.pbf_add_diffuse, len(places), pointer(places),
                   ffi.NULL if speeds is None else pointer(speeds), pointer(times))

    def shift_diffuse(self, way: Vector) -> None:
        """Moves all of them, as where the origin of the world is moved."""
        numbers = ffi.new("double[3]")
        for i, number in enumerate(reals("way", way, (self.dimension,))):
            numbers[i] = number
        self._call(lib.pbf_shift_diffuse, numbers)
