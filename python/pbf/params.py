"""Parameters: what may change between steps."""
from __future__ import annotations

import difflib
import warnings
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from ._errors import check
from ._library import ffi, lib, new_struct
from ._param_fields import ParamFields
from ._param_kinds import Collide, Kernel, Method, Param, Periodic

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._param_fields import ParamValues

__all__ = ["Collide", "Kernel", "Method", "Params", "Periodic"]


def fields() -> dict[str, Param]:
    """Name → descriptor, in the order of params.h."""
    return {name: kind for name, kind in vars(ParamFields).items() if isinstance(kind, Param)}


def near(name: str) -> str | None:
    """The parameter that a misspelt name is nearest to."""
    found = difflib.get_close_matches(name, fields(), 1, 0.75)
    return found[0] if found else None


def check_names(names: Mapping[str, Any], what: str) -> None:
    """Refuses the name of no parameter as Python refuses an unknown keyword."""
    known = fields()
    for name in names:
        if name not in known:
            meant = near(name)
            hint = f'; did you mean "{meant}"?' if meant else ""
            raise TypeError(f'{what} has no parameter "{name}"{hint}')


def write(struct: Any, values: Mapping[str, Any], dimension: int | None) -> None:
    known = fields()
    for name, value in values.items():
        known[name].write(struct, value, dimension)


def defaults() -> Any:
    struct = ffi.new("pbf_params *")
    check(lib.pbf_params_init(struct, ffi.sizeof("pbf_params")))
    return struct


class Params(ParamFields):
    """A set of parameters by itself: attributes, keywords, equality, and a `repr` of what is not
    the default.

    >>> Params(viscosity=0.01, gravity=(0, -1.6, 0))
    Params(gravity=(0.0, -1.6, 0.0), viscosity=0.01)
    """

    def __init__(self, **values: Unpack[ParamValues]) -> None:
        self._struct = defaults()
        self.update(**values)

    @classmethod
    def _of(cls, struct: Any) -> Params:
        params = cls.__new__(cls)
        params._struct = struct
        return params

    def _get_params(self) -> Any:
        return self._struct

    def _set_params(self, values: Mapping[str, Any]) -> None:
        write(self._struct, values, None)

    def update(self, **values: Unpack[ParamValues]) -> None:
        """Sets several at once; none where one of them is of a wrong type."""
        check_names(values, "Params")
        changed = self.copy()
        changed._set_params(values)
        self._struct = changed._struct

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_"):
            check_names({name: value}, "Params")
        super().__setattr__(name, value)

    def copy(self) -> Params:
        struct = new_struct("pbf_params")
        struct[0] = self._struct[0]
        return Params._of(struct)

    __copy__ = copy

    def to_dict(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in fields()}

    def __iter__(self) -> Iterator[tuple[str, Any]]:
        return iter(self.to_dict().items())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Params) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        usual = Params().to_dict()
        changed = (f"{name}={value!r}" for name, value in self if value != usual[name])
        return f"Params({', '.join(changed)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _params_of, (self.to_dict(),)


def _params_of(values: dict[str, Any]) -> Params:
    known = fields()
    unknown = [name for name in values if name not in known]
    if unknown:
        warnings.warn(f"pickled by another version: no parameter {', '.join(unknown)}", stacklevel=2)
    return Params(**{name: values[name] for name in values if name in known})
