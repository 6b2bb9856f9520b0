"""Questions to the fluid: what is in a volume, at a point, along a ray; see pbf/query.h."""
from __future__ import annotations

import math
import numbers
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import AnyArray, numpy_of, packed, pointer
from ._errors import InvalidArgumentError, check
from ._handle import Handle
from ._library import ffi, lib, new_struct
from ._numbers import Vector, items_of, real, reals, shown, uint32

Reals = NDArray[np.float64]


@dataclass
class Volume:
    """What is common to `BoxVolume`, `BallVolume` and `CapsuleVolume`. In 2D vectors may have two
    numbers."""

    shape: ClassVar[int]

    position: Vector = (0.0, 0.0, 0.0)
    """The centre."""
    orientation: Vector = (0.0, 0.0, 0.0, 1.0)
    """A unit quaternion x, y, z, w."""

    def _write(self, struct: Any) -> None:
        check(lib.pbf_volume_init(struct, ffi.sizeof("pbf_volume"), self.shape))
        for name, value in vars(self).items():
            target = getattr(struct, name)
            if isinstance(target, float):
                setattr(struct, name, real(name, value))
                continue
            for i, number in enumerate(reals(name, value, (4,) if name == "orientation" else (2, 3))):
                target[i] = number


@dataclass
class BoxVolume(Volume):
    """A box: `BoxVolume((1, 0.5, 0.5), half_extents=(0.1, 0.2, 0.1))`."""

    shape: ClassVar[int] = lib.PBF_VOLUME_BOX
    half_extents: Vector = (1.0, 1.0, 1.0)


@dataclass
class BallVolume(Volume):
    """A ball: `BallVolume((1, 0.5, 0.5), radius=0.1)`."""

    shape: ClassVar[int] = lib.PBF_VOLUME_SPHERE
    radius: float = 1.0


@dataclass
class CapsuleVolume(Volume):
    """All within `radius` of a segment."""

    shape: ClassVar[int] = lib.PBF_VOLUME_CAPSULE
    axis: Vector = (0.0, 1.0, 0.0)
    """The direction, before `orientation` turns it."""
    radius: float = 1.0
    half_length: float = 1.0
    """From the centre to either end of the segment."""


class Flow(NamedTuple):
    """What of the fluid is in a volume."""

    volume: float
    """Of the whole volume."""
    fraction: float
    """How much of it is below the surface, 0 … 1."""
    centre: tuple[float, ...]
    """Of that part, where buoyancy acts; the volume's position where there is none."""
    velocity: tuple[float, ...]
    """Its mean."""


class Samples(NamedTuple):
    """What was asked for at points; None: that was not."""

    densities: Reals | None
    velocities: Reals | None
    pressures: Reals | None
    wet: NDArray[np.bool_] | None


class Hits(NamedTuple):
    """Where rays meet the surface."""

    distances: Reals
    """Infinite where that is nowhere."""
    normals: Reals
    """Unit vectors out of the fluid; 0 where nothing is met."""


def struct_of(volume: Volume, target: Any) -> None:
    if not isinstance(volume, Volume) or type(volume) is Volume:
        raise InvalidArgumentError(
            f"volume is {shown(volume)}; it must be a BoxVolume, BallVolume or CapsuleVolume")
    volume._write(target)


def _array(number: Any) -> Any:
    return ffi.cast("double *", pointer(number)) if number is not None else ffi.NULL


FIELDS = ("density", "velocity", "pressure", "wet")


class Queries(Handle):
    """How a solver is asked by place."""

    def _points(self, name: str, points: AnyArray) -> Reals:
        given = numpy_of(name, points)
        if given.ndim == 0 or given.shape[-1] != self.dimension or given.dtype.kind not in "fiu":
            raise InvalidArgumentError(
                f"{name} has the shape {given.shape} and holds {given.dtype}; it must hold points "
                f"of {self.dimension} numbers")
        return packed(name, given, np.float64)

    def find_in(self, volume: Volume) -> NDArray[np.uint32]:
        """The ids of the particles in a volume, ascending."""
        struct, count = ffi.new("pbf_volume *"), ffi.new("uint32_t *")
        struct_of(volume, struct)
        self._call(lib.pbf_find_in_volume, struct, 0, ffi.NULL, count)
        ids = np.empty(count[0], np.uint32)
        if len(ids):
            self._call(lib.pbf_find_in_volume, struct, len(ids), ffi.cast("uint32_t *", pointer(ids)),
                       count)
        return ids

    def measure(self, volumes: Volume | Iterable[Volume]) -> Any:
        """How much of a volume is below the surface, and how that flows: a `Flow`, or a list of
        them for a list of volumes."""
        listed = items_of("volumes", volumes, Volume, "a BoxVolume, BallVolume or CapsuleVolume, or a list of them")
        structs = ffi.new("pbf_volume[]", max(len(listed), 1))
        flows = ffi.new("pbf_volume_flow[]", max(len(listed), 1))
        for i, volume in enumerate(listed):
            struct_of(volume, ffi.addressof(structs, i))
            flows[i].struct_size = ffi.sizeof("pbf_volume_flow")
        self._call(lib.pbf_measure_volumes, len(listed), structs, flows)
        n = self.dimension
        found = [Flow(flows[i].volume, flows[i].fraction, tuple(flows[i].centre)[:n],
                      tuple(flows[i].velocity)[:n]) for i in range(len(listed))]
        return found[0] if isinstance(volumes, Volume) else found

    def _samples(self, shape: tuple[int, ...], fields: Iterable[str]) -> tuple[Any, Samples]:
        wanted = (fields,) if isinstance(fields, str) else tuple(fields)
        for field in wanted:
            if not isinstance(field, str) or field not in FIELDS:
                raise InvalidArgumentError(f"fields has {shown(field)}; each must be one of {FIELDS}")
        count = uint32("the number of points", math.prod(shape))
        density, pressure = (np.empty(shape) if field in wanted else None
                             for field in ("density", "pressure"))
        velocity = np.empty((*shape, self.dimension)) if "velocity" in wanted else None
        wet = np.empty(shape, np.bool_) if "wet" in wanted else None
        struct = new_struct("pbf_samples")
        struct.count = count
        struct.densities, struct.velocities = _array(density), _array(velocity)
        struct.pressures = _array(pressure)
        struct.wet = ffi.cast("uint8_t *", pointer(wet)) if wet is not None else ffi.NULL
        return struct, Samples(density, velocity, pressure, wet)

    def sample(self, points: AnyArray,
               fields: Iterable[str] = ("density", "velocity")) -> Samples:
        """Fields at points, an array of shape (…, dimension): "density", "velocity", "pressure" and
        "wet", whether there is water."""
        x = self._points("points", points)
        struct, samples = self._samples(x.shape[:-1], fields)
        struct.points = _array(x)
        if struct.count:
            self._call(lib.pbf_sample, struct)
        return samples

    def sample_on_grid(self, counts: Iterable[int], origin: Vector, step: Vector | float,
                       fields: Iterable[str] = ("density", "velocity")) -> Samples:
        """The same at the points origin + index * step, in arrays of the shape `counts`. A single
        number is the step along all axes."""
        grid = new_struct("pbf_sample_grid")
        n = self.dimension
        listed = items_of("counts", counts, type(None), f"a list of {n} numbers")
        if len(listed) != n:
            raise InvalidArgumentError(f"counts is {shown(listed)}; it must have {n} numbers")
        shape = tuple(uint32("counts", count) for count in listed)
        steps = (step,) * n if isinstance(step, numbers.Real) else step
        for k, (a, b) in enumerate(zip(reals("origin", origin, (n,)), reals("step", steps, (n,)))):
            grid.counts[k], grid.origin[k], grid.step[k] = shape[k], a, b
        struct, samples = self._samples(shape, fields)
        if struct.count:
            self._call(lib.pbf_sample_on_grid, grid, struct)
        return samples

    def cast_rays(self, origins: AnyArray, directions: AnyArray,
                  length: float = float("inf")) -> Hits:
        """Where rays first meet the surface: arrays of shape (…, dimension)."""
        x, to = self._points("origins", origins), self._points("directions", directions)
        try:
            x, to = (np.ascontiguousarray(each) for each in np.broadcast_arrays(x, to))
        except ValueError:
            raise InvalidArgumentError(
                f"origins has the shape {x.shape} and directions {to.shape}; they must fit each "
                "other") from None
        distances, normals = np.empty(x.shape[:-1]), np.empty(x.shape)
        self._call(lib.pbf_cast_rays, uint32("the number of rays", distances.size), _array(x),
                   _array(to), real("length", length), _array(distances), _array(normals))
        return Hits(distances, normals)

    def levels(self, points: AnyArray) -> Reals:
        """How high the water stands at points of shape (…, dimension), against gravity; NaN where
        there is none."""
        x = self._points("points", points)
        levels = np.empty(x.shape[:-1])
        self._call(lib.pbf_get_levels, uint32("the number of points", levels.size), _array(x),
                   _array(levels))
        return levels

    def end_queries(self) -> None:
        """Gives back the memory that queries keep."""
        self._call(lib.pbf_end_queries)
