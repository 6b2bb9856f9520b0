"""What callers pass, checked before it becomes a C number."""
from __future__ import annotations

import numbers
import operator
from collections.abc import Sequence
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from ._errors import InvalidArgumentError

Vector = Union[Sequence[float], NDArray[Any]]
"""A number an axis."""

UINT32_MAX = 2**32 - 1
ADDRESS_MAX = 2**64 - 1


def shown(value: Any) -> str:
    """In a sentence, however long it is: Python does not write integers of 5,000 digits."""
    try:
        text = repr(value)
    except Exception:
        return f"{type(value).__name__} that can't be written"
    return text if len(text) <= 100 else f"{text[:97]}…"


def items_of(name: str, given: Any, kind: type[Any], wanted: str) -> list[Any]:
    """What a list holds, or the only one."""
    if isinstance(given, kind):
        return [given]
    try:
        return list(given)
    except TypeError:
        raise InvalidArgumentError(f"{name} is {shown(given)}; it must be {wanted}") from None


def integer(name: str, value: Any, most: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidArgumentError(
            f"{name} is {shown(value)}; it must be an integer, 0 … {most}") from None
    if not 0 <= number <= most:
        raise InvalidArgumentError(f"{name} is {shown(number)}; it must be 0 … {most}")
    return number


def uint32(name: str, value: Any) -> int:
    return integer(name, value, UINT32_MAX)


def _is_real(value: Any) -> bool:
    """NumPy makes a float of complex numbers, and of what a mask hides, as well."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.dtype.kind in "biuf" and value.size == 1 and not np.ma.is_masked(value)
    return hasattr(value, "__float__") and not (
        isinstance(value, numbers.Complex) and not isinstance(value, numbers.Real))


def real(name: str, value: Any) -> float:
    if type(value) is float:  # most are
        return value
    if _is_real(value):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise InvalidArgumentError(f"{name} is {shown(value)}; it must be a number")


def reals(name: str, value: Any, lengths: tuple[int, ...]) -> list[float]:
    """A list of numbers, of one of these lengths."""
    try:
        items = list(value)
    except TypeError:
        items = []
    if isinstance(value, str) or len(items) not in lengths:
        wanted = " or ".join(str(length) for length in lengths)
        raise InvalidArgumentError(f"{name} is {shown(value)}; it must be a list of {wanted} numbers")
    if all(type(item) is float for item in items):
        return items
    return [real(f"{name}[{i}]", item) for i, item in enumerate(items)]
