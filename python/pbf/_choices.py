"""Names in the place of the C API's numbers."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import InvalidArgumentError
from ._library import ffi, lib
from ._numbers import shown

PRECISIONS = {"float32": lib.PBF_FLOAT32, "float64": lib.PBF_FLOAT64}
DETERMINISM = {"across machines": lib.PBF_DETERMINISM_ACROSS_MACHINES,
               "per machine": lib.PBF_DETERMINISM_PER_MACHINE}
FIELDS = {
    "position": lib.PBF_FIELD_POSITION, "velocity": lib.PBF_FIELD_VELOCITY,
    "id": lib.PBF_FIELD_ID, "density": lib.PBF_FIELD_DENSITY,
    "pressure": lib.PBF_FIELD_PRESSURE}
W = {"speed": lib.PBF_W_SPEED, "density": lib.PBF_W_DENSITY, "pressure": lib.PBF_W_PRESSURE}
ORDERS = {"added": lib.PBF_ORDER_ADDED, "stored": lib.PBF_ORDER_STORED}
TYPES = {"float32": lib.PBF_TYPE_FLOAT32, "float64": lib.PBF_TYPE_FLOAT64,
          "uint32": lib.PBF_TYPE_UINT32}


def choice(name: str, value: str, known: Mapping[str, int]) -> int:
    if not isinstance(value, str) or value not in known:
        listed = ", ".join(f'"{each}"' for each in known)
        raise InvalidArgumentError(f'{name} is {shown(value)}; it must be one of {listed}')
    return known[value]


def element_type(dtype: np.dtype[Any], name: str = "out") -> int:
    """Of an array that the library writes to, or reads."""
    if not dtype.isnative:
        raise InvalidArgumentError(
            f"{name} holds {dtype.str!r}; its bytes must be in this machine's order")
    return choice("dtype", dtype.name, TYPES)


def precision_of(precision: Any) -> str:
    try:
        name = np.dtype(precision).name
    except TypeError:
        name = str(precision)
    choice("precision", name, PRECISIONS)
    return name


def chars(name: str, value: Any) -> Any:
    if value is None:
        return ffi.NULL
    if not isinstance(value, str):
        raise InvalidArgumentError(f"{name} is {shown(value)}; it must be a string")
    if "\0" in value:
        raise InvalidArgumentError(f"{name} is {value!r}; a zero would end it")
    try:
        return ffi.new("char[]", value.encode())
    except UnicodeEncodeError as error:
        raise InvalidArgumentError(f"{name} is {shown(value)}: {error}") from None
