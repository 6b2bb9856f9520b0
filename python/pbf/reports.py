"""What a solver and the library say of themselves."""
from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any

from ._errors import check
from ._library import ffi, lib, new_struct
from ._structs import dataclass_of

Triple = tuple[float, float, float]


class Limit(enum.IntEnum):
    """What a step can be too long for; see pbf_get_step_limit in stats.h."""

    NONE = lib.PBF_LIMIT_NONE
    GRAVITY = lib.PBF_LIMIT_GRAVITY
    ATTRACTION = lib.PBF_LIMIT_ATTRACTION
    PARTICLES = lib.PBF_LIMIT_PARTICLES
    WALLS = lib.PBF_LIMIT_WALLS
    COLLIDERS = lib.PBF_LIMIT_COLLIDERS
    TENSION = lib.PBF_LIMIT_TENSION


@dataclass(frozen=True)
class Stats:
    """Sums over all particles in their present state, particles of unit mass."""

    count: int
    iterations: int
    neighbors_max: int
    neighbors_mean: float
    center_of_mass: Triple
    position_min: Triple
    position_max: Triple
    momentum: Triple
    """A particle's mean: the sum of v over their number."""
    kinetic_energy: float
    """A particle's mean: the sum of |v|²/2 over their number."""
    speed_max: float
    density_error_mean: float
    density_error_max: float
    density_mean: float
    asleep: int
    squeezed: int
    step_limit: float
    limited_by: Limit
    substeps: int

    @classmethod
    def _of(cls, struct: Any) -> Stats:
        return dataclass_of(cls, struct, limited_by=Limit(struct.limited_by))


@dataclass(frozen=True)
class Load:
    """What the fluid does to a solid, over rest density; see pbf_collider_load in loads.h."""

    contacts: int
    impulse: Triple
    angular_impulse: Triple
    impulse_sum: Triple
    angular_impulse_sum: Triple
    time_sum: float
    penetration: float
    wetted_area: float

    @classmethod
    def _of(cls, struct: Any) -> Load:
        return dataclass_of(cls, struct)


@dataclass(frozen=True)
class Info:
    """Which backend serves a solver, and how far it has come."""

    dimension: int
    precision: int
    capacity: int
    threads: int
    device: int
    device_type: int
    fell_back: bool
    step: int
    time: float
    backend: str
    device_name: str
    build_id: str
    path: str
    fallback_reason: str

    @classmethod
    def _of(cls, struct: Any) -> Info:
        return dataclass_of(cls, struct, fell_back=bool(struct.fell_back))


@dataclass(frozen=True)
class PlanStage:
    name: str
    runs_per_step: int
    launches_per_step: int


@dataclass(frozen=True)
class PlanArray:
    name: str
    bytes_per_particle: float
    bytes: int


@dataclass(frozen=True)
class Plan:
    """What a solver runs and holds with its present parameters; nothing else exists."""

    variant: str
    bytes_per_particle: float
    bytes: int
    stages: tuple[PlanStage, ...]
    arrays: tuple[PlanArray, ...]

    @classmethod
    def _of(cls, struct: Any) -> Plan:
        stages = [dataclass_of(PlanStage, struct.stages[i]) for i in range(struct.stage_count)]
        arrays = [dataclass_of(PlanArray, struct.arrays[i]) for i in range(struct.array_count)]
        return dataclass_of(cls, struct, stages=tuple(stages), arrays=tuple(arrays))


@dataclass(frozen=True)
class StageTime:
    name: str
    milliseconds: float
    runs: int


@dataclass(frozen=True)
class BackendInfo:
    """A backend that was found, or why it can't serve."""

    name: str
    available: bool
    score: int
    device_type: int
    device_name: str
    build_id: str
    path: str
    reason: str


def backends() -> list[BackendInfo]:
    """Every backend found, and every candidate that failed to load, judged for the defaults."""
    count = ffi.new("uint32_t *")
    check(lib.pbf_get_backend_count(count))
    found = []
    for index in range(count[0]):
        info = new_struct("pbf_backend_info")
        check(lib.pbf_get_backend_info(ffi.NULL, index, info))
        found.append(dataclass_of(BackendInfo, info, available=bool(info.available)))
    return found


def load_backend(path: str) -> None:
    """Loads a plugin from an absolute path, for the life of the process."""
    import os
    check(lib.pbf_load_backend(os.fsencode(path)))
