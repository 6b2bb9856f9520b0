"""What comes and goes in steps: emitters, drains and reservoirs; see pbf/emit.h."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from ._copies import Copies
from ._errors import InvalidArgumentError, check
from ._handle import Handle
from ._library import ffi, lib, new_struct
from ._numbers import Vector, items_of, real, reals, shown, uint32
from ._structs import dataclass_of
from .queries import BallVolume, BoxVolume, CapsuleVolume, Volume, struct_of


@dataclass
class Emitter:
    """What is common to `RectangleEmitter` and `DiscEmitter`, which are what to make: an opening
    across a stream. In 2D vectors may have two numbers."""

    shape: ClassVar[int]

    position: Vector = (0.0, 0.0, 0.0)
    """The middle of the opening."""
    velocity: Vector = (0.0, -1.0, 0.0)
    """Of the stream."""
    rate: float = 0.0
    """Volume a time unit; 0: as much as the opening carries."""
    jitter: float = 0.0
    """0 … 1, in spacings: so far columns of particles waver along the opening."""
    lifetime: float = 0.0
    """Of its particles; 0: for ever."""
    recycle: bool = False
    """Where the solver is full, the oldest particles make way."""
    seed: int = 0
    """Of the jitter."""
    phase: int = 0
    """Of its particles, see `Solver.phases`."""

    def _write(self, struct: Any) -> None:
        check(lib.pbf_emitter_init(struct, ffi.sizeof("pbf_emitter"), self.shape))
        for name, value in vars(self).items():
            target = getattr(struct, name)
            if isinstance(target, float):
                setattr(struct, name, real(name, value))
            elif isinstance(target, int):
                setattr(struct, name, uint32(name, int(value)))
            else:
                for i, number in enumerate(reals(name, value, (2, 3))):
                    target[i] = number


@dataclass
class RectangleEmitter(Emitter):
    """A rectangle across the stream, in 2D a line."""

    shape: ClassVar[int] = lib.PBF_EMITTER_RECTANGLE
    half_width: float = 1.0
    """Half of its first side; in 2D the only one."""
    half_height: float = 1.0
    across: Vector = (1.0, 0.0, 0.0)
    """In 3D: where the first side points."""


@dataclass
class DiscEmitter(Emitter):
    """A disc across the stream, in 2D a line: `DiscEmitter((1, 0.5, 0.5), velocity=(0, 3, 0), radius=0.1)`."""

    shape: ClassVar[int] = lib.PBF_EMITTER_DISC
    radius: float = 1.0


@dataclass
class Reservoir:
    """An open boundary of given level or pressure: a box in which fluid always stands equally
    deep. In 2D vectors may have two numbers."""

    position: Vector
    """The middle of the box."""
    half_extents: Vector
    depth: float
    """How deep, from the box's lower side, along its own y axis."""
    pressure: float = 0.0
    """Over rest density, at the lower side, beside what gravity makes."""
    orientation: Vector = (0.0, 0.0, 0.0, 1.0)
    """A unit quaternion x, y, z, w."""
    phase: int = 0
    """Of what comes, see `Solver.phases`."""
    added: int = field(default=0, compare=False)
    """Told, and not looked at where it is set: particles that came …"""
    removed: int = field(default=0, compare=False)
    """… and went since there was a reservoir of this number."""

    def _write(self, struct: Any) -> None:
        check(lib.pbf_reservoir_init(struct, ffi.sizeof("pbf_reservoir")))
        for name in ("position", "half_extents"):
            for i, number in enumerate(reals(name, getattr(self, name), (2, 3))):
                getattr(struct, name)[i] = number
        for i, number in enumerate(reals("orientation", self.orientation, (4,))):
            struct.orientation[i] = number
        struct.depth = real("depth", self.depth)
        struct.pressure = real("pressure", self.pressure)
        struct.phase = uint32("phase", self.phase)


@dataclass(frozen=True)
class InOut:
    """What came and went, in particles."""

    emitters: int
    """That there are."""
    drains: int
    emitted: int
    refused: int
    """Lost: the solver was full, or their place was outside the domain."""
    recycled: int
    """Made way for others."""
    drained: int
    expired: int
    """Their lifetime was over."""


EMITTERS: dict[int, type[Emitter]] = {kind.shape: kind for kind in (RectangleEmitter, DiscEmitter)}
VOLUMES: dict[int, type[Volume]] = {
    kind.shape: kind for kind in (BoxVolume, BallVolume, CapsuleVolume)}


def _made(kind: type[Any], struct: Any) -> Any:
    values = {}
    for name in kind.__dataclass_fields__:
        if name == "shape":
            continue
        value = getattr(struct, name)
        values[name] = tuple(value) if isinstance(value, ffi.CData) else value
    return kind(**values)


def _listed(name: str, given: Any, kind: type[Any]) -> list[Any]:
    listed = items_of(name, given, kind, f"a list of {name}")
    for i, each in enumerate(listed):
        if not isinstance(each, kind) or type(each) is kind:
            raise InvalidArgumentError(f"{name}[{i}] is {shown(each)}; it must be one of its kinds")
    return listed


class Emission(Handle):
    """What comes and goes in a solver's steps."""

    @property
    def in_out(self) -> InOut:
        """How many particles came and went so far."""
        struct = new_struct("pbf_in_out")
        self._call(lib.pbf_get_in_out, struct)
        return dataclass_of(InOut, struct)

    @property
    def emitters(self) -> list[Emitter]:
        """Copies. Assign a list to replace them all; each goes on where the one before it was."""
        found = []
        for index in range(self.in_out.emitters):
            struct = new_struct("pbf_emitter")
            self._call(lib.pbf_get_emitter, index, struct)
            made = _made(EMITTERS[struct.shape], struct)
            made.recycle = bool(made.recycle)
            found.append(made)
        return Copies(found)

    @emitters.setter
    def emitters(self, emitters: Iterable[Emitter] | Emitter) -> None:
        listed = _listed("emitters", emitters, Emitter)
        structs = ffi.new("pbf_emitter[]", max(len(listed), 1))
        for i, emitter in enumerate(listed):
            emitter._write(ffi.addressof(structs, i))
        self._call(lib.pbf_set_emitters, len(listed), structs)

    @property
    def drains(self) -> list[Volume]:
        """Volumes that particles vanish in: copies. Assign a list to replace them all."""
        found = []
        for index in range(self.in_out.drains):
            struct = new_struct("pbf_volume")
            self._call(lib.pbf_get_drain, index, struct)
            found.append(_made(VOLUMES[struct.shape], struct))
        return Copies(found)

    @drains.setter
    def drains(self, drains: Iterable[Volume] | Volume) -> None:
        listed = _listed("drains", drains, Volume)
        structs = ffi.new("pbf_volume[]", max(len(listed), 1))
        for i, volume in enumerate(listed):
            struct_of(volume, ffi.addressof(structs, i))
        self._call(lib.pbf_set_drains, len(listed), structs)

    @property
    def reservoirs(self) -> list[Reservoir]:
        """Open boundaries of given level or pressure: copies. Assign a list to replace them all."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_reservoir_count, count)
        found = []
        for index in range(count[0]):
            struct = new_struct("pbf_reservoir")
            self._call(lib.pbf_get_reservoir, index, struct)
            found.append(_made(Reservoir, struct))
        return Copies(found)

    @reservoirs.setter
    def reservoirs(self, reservoirs: Iterable[Reservoir] | Reservoir) -> None:
        listed = items_of("reservoirs", reservoirs, Reservoir, "a list of reservoirs")
        structs = ffi.new("pbf_reservoir[]", max(len(listed), 1))
        for i, reservoir in enumerate(listed):
            if not isinstance(reservoir, Reservoir):
                raise InvalidArgumentError(f"reservoirs[{i}] is {shown(reservoir)}; it must be a Reservoir")
            reservoir._write(ffi.addressof(structs, i))
        self._call(lib.pbf_set_reservoirs, len(listed), structs)
