"""Colliders: planes, spheres, capsules, boxes and solids of any geometry."""
from __future__ import annotations

import enum
import weakref
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from typing import Any, ClassVar

from ._errors import InvalidArgumentError, check
from ._library import ffi, lib
from ._numbers import Vector, items_of, real, reals, shown, uint32
from .geometry import Geometry


class Shape(enum.IntEnum):
    PLANE = lib.PBF_COLLIDER_PLANE
    SPHERE = lib.PBF_COLLIDER_SPHERE
    CAPSULE = lib.PBF_COLLIDER_CAPSULE
    BOX = lib.PBF_COLLIDER_BOX
    SHAPE = lib.PBF_COLLIDER_SHAPE


class MotionPath(enum.IntEnum):
    """How a collider that turns goes from where it is set; see PBF_PATH_… in colliders.h."""

    AUTO = lib.PBF_PATH_AUTO
    STRAIGHT = lib.PBF_PATH_STRAIGHT
    SCREW = lib.PBF_PATH_SCREW


# Fields whose third component has a value of its own in 2D, where it is not given.
_THIRD = {"half_extents": 1.0}


@dataclass
class Collider:
    """What is common to all shapes; `Plane`, `Sphere`, `Capsule`, `Box` and `Solid` are what to
    make.

    In 2D vectors may have two numbers; `angular_velocity` has three, of which the third turns.
    """

    shape: ClassVar[Shape]

    position: Vector = (0.0, 0.0, 0.0)
    """The centre; of a plane: any point of it."""
    orientation: Vector = (0.0, 0.0, 0.0, 1.0)
    """A unit quaternion x, y, z, w."""
    velocity: Vector = (0.0, 0.0, 0.0)
    angular_velocity: Vector = (0.0, 0.0, 0.0)
    """Radians a time unit, about `position`."""
    axis: Vector = (0.0, 1.0, 0.0)
    """Of a plane the normal, of a capsule the direction, before `orientation` turns it."""
    half_extents: Vector = (1.0, 1.0, 1.0)
    """Of a box."""
    radius: float = 1.0
    """Of a sphere or a capsule."""
    half_length: float = 1.0
    """Of a capsule: from the centre to either end of its segment."""
    half_extents_rate: Vector = (0.0, 0.0, 0.0)
    radius_rate: float = 0.0
    half_length_rate: float = 0.0
    geometry: Geometry | None = None
    """Of a solid."""
    scale: float = 1.0
    """Of a solid: how many times as large as its geometry."""
    scale_rate: float = 0.0
    duration: float = 0.0
    """So long it moves and grows, and then stands still; 0: for ever."""
    friction: float = 0.0
    """Coulomb's coefficient, against the collider's own motion; see pbf_params.wall_friction."""
    static_friction: float = 0.0
    no_slip: float = 0.0
    adhesion: float = 0.0
    """Of fluid with a surface tension, (1 + cos contact angle) / 2; see pbf_params.wall_adhesion."""
    inverted: bool = False
    """A container: the fluid stays inside."""
    path: MotionPath = MotionPath.AUTO
    last_velocity: Vector = field(default=(0.0, 0.0, 0.0), compare=False)
    """Told, and not looked at where it is set: the velocities with which it has come there …"""
    last_angular_velocity: Vector = field(default=(0.0, 0.0, 0.0), compare=False)
    """… those that it had before it was set anew."""

    def _write(self, struct: Any) -> Geometry | None:
        """Its geometry, which has to live as long as the struct is looked at."""
        check(lib.pbf_collider_init(struct, ffi.sizeof("pbf_collider"), self.shape))
        struct.inverted = bool(self.inverted)
        struct.path = uint32("path", self.path)
        geometry: Geometry | None = None
        for name in (each.name for each in fields(self)):
            value = getattr(self, name)
            if name in ("inverted", "path"):
                continue
            if name == "geometry":
                if value is not None and not isinstance(value, Geometry):
                    raise InvalidArgumentError(f"geometry is {shown(value)}; it must be a Geometry")
                geometry = value
                struct.geometry = ffi.NULL if value is None else value.handle
                continue
            if isinstance(getattr(struct, name), float):
                setattr(struct, name, real(name, value))
                continue
            lengths = (4,) if name == "orientation" else (2, 3)
            numbers = reals(name, value, (3,) if name.endswith("angular_velocity") else lengths)
            if len(numbers) == 2:
                numbers.append(_THIRD.get(name, 0.0))
            setattr(struct, name, numbers)
        return geometry


@dataclass
class Plane(Collider):
    """Fluid stays on the side of `axis`, the normal."""

    shape: ClassVar[Shape] = Shape.PLANE


@dataclass
class Sphere(Collider):
    shape: ClassVar[Shape] = Shape.SPHERE


@dataclass
class Capsule(Collider):
    shape: ClassVar[Shape] = Shape.CAPSULE


@dataclass
class Box(Collider):
    shape: ClassVar[Shape] = Shape.BOX


@dataclass
class Solid(Collider):
    """Of a `geometry`: distances on a grid, a mesh, a terrain, a hull."""

    shape: ClassVar[Shape] = Shape.SHAPE


KINDS: dict[int, type[Collider]] = {kind.shape: kind for kind in (Plane, Sphere, Capsule, Box, Solid)}


def collider_of(struct: Any) -> Collider:
    values: dict[str, Any] = {}
    for name in (each.name for each in fields(Collider)):
        if name == "geometry":
            values["geometry"] = Geometry._borrowed(struct.geometry)
            continue
        value = getattr(struct, name)
        values[name] = tuple(value) if isinstance(value, ffi.CData) else value
    values.update(inverted=bool(struct.inverted), path=MotionPath(struct.path))
    return KINDS[struct.shape](**values)


_geometries: weakref.WeakKeyDictionary[Any, list[Geometry | None]] = weakref.WeakKeyDictionary()
"""Of arrays of structs: colliders that nothing else refers to, as those that a generator makes, are gone
before the library looks at them."""


def struct_array(colliders: Iterable[Collider] | Collider) -> tuple[int, Any]:
    """Their number, and an array of structs."""
    listed = items_of("colliders", colliders, Collider, "a list of colliders")
    for i, collider in enumerate(listed):
        if not isinstance(collider, Collider) or type(collider) is Collider:
            raise InvalidArgumentError(
                f"colliders[{i}] is {shown(collider)}; it must be a Plane, Sphere, Capsule, Box or Solid")
    array = ffi.new("pbf_collider[]", max(len(listed), 1))
    _geometries[array] = [collider._write(ffi.addressof(array, i)) for i, collider in enumerate(listed)]
    return len(listed), array
