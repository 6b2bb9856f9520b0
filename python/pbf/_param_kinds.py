"""The kinds of parameters, as descriptors; `_param_fields.py`, which is generated, names them."""
from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence
from typing import Any, Union

from ._errors import InvalidArgumentError
from ._library import lib
from ._numbers import Vector, real, reals, uint32


class Kernel(enum.IntEnum):
    """Density kernel, and the gradient that moves particles."""

    WENDLAND_C2 = lib.PBF_KERNEL_WENDLAND_C2
    POLY6_SPIKY = lib.PBF_KERNEL_POLY6_SPIKY


class Method(enum.IntEnum):
    """How the density solve iterates: the parameter `solver`."""

    JACOBI = lib.PBF_SOLVER_JACOBI
    CHEBYSHEV = lib.PBF_SOLVER_CHEBYSHEV


class Collide(enum.IntFlag):
    """When walls and colliders act within a step."""

    AFTER_PREDICTION = lib.PBF_COLLIDE_AFTER_PREDICTION
    IN_ITERATION = lib.PBF_COLLIDE_IN_ITERATION
    AFTER_SOLVE = lib.PBF_COLLIDE_AFTER_SOLVE


class Periodic(enum.IntFlag):
    """Axes along which the domain's two faces are one."""

    X = lib.PBF_PERIODIC_X
    Y = lib.PBF_PERIODIC_Y
    Z = lib.PBF_PERIODIC_Z


class Holder:
    """What has parameters: `Params`, and a `Solver`, which gets and sets them by a call."""

    def _get_params(self) -> Any:
        raise NotImplementedError

    def _set_params(self, values: Mapping[str, Any]) -> None:
        raise NotImplementedError

    def _dimension(self) -> int | None:
        return None


class Param:
    """A field of pbf_params as an attribute."""

    def __init__(self, doc: str) -> None:
        self.__doc__ = doc
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def _value(self, holder: Holder) -> Any:
        return getattr(holder._get_params(), self.name)

    def _assign(self, holder: Holder, value: Any) -> None:
        holder._set_params({self.name: value})

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        raise NotImplementedError


class Number(Param):
    """A double."""

    def __get__(self, holder: Any, owner: type | None = None) -> float:
        return self if holder is None else self._value(holder)  # type: ignore[return-value]

    def __set__(self, holder: Any, value: float) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, real(self.name, value))


class Integer(Param):
    """A uint32_t."""

    def __get__(self, holder: Any, owner: type | None = None) -> int:
        return self if holder is None else self._value(holder)  # type: ignore[return-value]

    def __set__(self, holder: Any, value: int) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, uint32(self.name, value))


def _member(kind: type[enum.IntEnum], name: str, value: Any) -> int:
    if not isinstance(value, str):
        return uint32(name, value)
    try:
        return int(kind[value.upper()])
    except KeyError:
        known = ", ".join(f'"{member.name.lower()}"' for member in kind)
        raise InvalidArgumentError(f'{name} is "{value}"; it must be one of {known}') from None


class KernelField(Param):
    def __get__(self, holder: Any, owner: type | None = None) -> Kernel:
        return self if holder is None else Kernel(self._value(holder))  # type: ignore[return-value]

    def __set__(self, holder: Any, value: Union[Kernel, int, str]) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, _member(Kernel, self.name, value))


class MethodField(Param):
    def __get__(self, holder: Any, owner: type | None = None) -> Method:
        return self if holder is None else Method(self._value(holder))  # type: ignore[return-value]

    def __set__(self, holder: Any, value: Union[Method, int, str]) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, _member(Method, self.name, value))


def _bits(kind: type[enum.IntFlag], name: str, value: Any) -> int:
    """Bits; also a name or a list of names."""
    if isinstance(value, (str, list, tuple, set, frozenset)):
        names = [value] if isinstance(value, str) else value
        value = 0
        for each in names:
            value |= _member(kind, name, each)  # type: ignore[arg-type]
    return uint32(name, value)


class CollideField(Param):
    """Bits; also a list of names."""

    def __get__(self, holder: Any, owner: type | None = None) -> Collide:
        return self if holder is None else Collide(self._value(holder))  # type: ignore[return-value]

    def __set__(self, holder: Any, value: Union[Collide, int, str, Sequence[str]]) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, _bits(Collide, self.name, value))


class PeriodicField(Param):
    """Bits; also a list of names."""

    def __get__(self, holder: Any, owner: type | None = None) -> Periodic:
        return self if holder is None else Periodic(self._value(holder))  # type: ignore[return-value]

    def __set__(self, holder: Any, value: Union[Periodic, int, str, Sequence[str]]) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        setattr(struct, self.name, _bits(Periodic, self.name, value))


class Reals(Param):
    """A number an axis, or one a wall. In 2D the last third of them is not used, nor given."""

    def __init__(self, count: int, doc: str) -> None:
        super().__init__(doc)
        self.count = count

    def _length(self, dimension: int) -> int:
        return dimension * self.count // 3

    def __get__(self, holder: Any, owner: type | None = None) -> tuple[float, ...]:
        if holder is None:
            return self  # type: ignore[return-value]
        return tuple(self._value(holder))[:self._length(holder._dimension() or 3)]

    def __set__(self, holder: Any, value: Vector) -> None:
        self._assign(holder, value)

    def write(self, struct: Any, value: Any, dimension: int | None) -> None:
        lengths = (self._length(2), self.count)
        if dimension == 3:
            lengths = (self.count, self.count)
        values = reals(self.name, value, tuple(dict.fromkeys(lengths)))
        field = getattr(struct, self.name)
        for i, number in enumerate(values):
            field[i] = number
