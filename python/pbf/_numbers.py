"""What callers pass, checked before it becomes a C number."""
from __future__ import annotations

import numbers
import operator
from collections.abc import Sequence
from typing import Any, Union

from numpy.typing import NDArray

from ._errors import InvalidArgumentError

Vector = Union[Sequence[float], NDArray[Any]]
"""A number an axis."""

UINT32_MAX = 2**32 - 1


def uint32(name: str, value: Any) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidArgumentError(
            f"{name} is {value!r}; it must be an integer, 0 … {UINT32_MAX}") from None
    if not 0 <= number <= UINT32_MAX:
        raise InvalidArgumentError(f"{name} is {number}; it must be 0 … {UINT32_MAX}")
    return number


def real(name: str, value: Any) -> float:
    if isinstance(value, numbers.Real) or hasattr(value, "__float__"):
        try:
            return float(value)
        except (TypeError, ValueError):
            pass
    raise InvalidArgumentError(f"{name} is {value!r}; it must be a number")


def reals(name: str, value: Any, lengths: tuple[int, ...]) -> list[float]:
    """A list of numbers, of one of these lengths."""
    try:
        items = list(value)
    except TypeError:
        items = []
    if isinstance(value, str) or len(items) not in lengths:
        wanted = " or ".join(str(length) for length in lengths)
        raise InvalidArgumentError(f"{name} is {value!r}; it must be a list of {wanted} numbers")
    return [real(f"{name}[{i}]", item) for i, item in enumerate(items)]
