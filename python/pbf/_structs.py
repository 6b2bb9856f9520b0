"""From structs of the library to dataclasses, by the names of their fields."""
from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

from ._library import ffi, text

T = TypeVar("T")


def plain(value: Any) -> Any:
    """A field's value without cffi's types: strings, tuples and numbers."""
    if not isinstance(value, ffi.CData):
        return value
    if ffi.typeof(value).kind == "array":
        if ffi.typeof(value).item.cname == "char":
            return text(value)
        return tuple(plain(item) for item in value)
    return value


def dataclass_of(kind: type[T], struct: Any, **others: Any) -> T:
    """`kind` with the struct's fields of the same names; `others` are given as they are."""
    names = [field.name for field in dataclasses.fields(kind)]  # type: ignore[arg-type]
    values = {name: plain(getattr(struct, name)) for name in names if name not in others}
    return kind(**values, **others)
