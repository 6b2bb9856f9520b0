"""Lists of copies of what a solver has."""
from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NoReturn, TypeVar

T = TypeVar("T")


class Copies(list[T]):
    """A list that can't be changed: the solver would not know of it. It is assigned anew, as in
    `fluid.colliders += [ball]`."""

    def _refuse(self, *_positional: Any, **_keywords: Any) -> NoReturn:
        raise TypeError("this list holds copies of what the solver has; assign another one, as in "
                        "fluid.colliders = [*fluid.colliders, ball], or change list(…) of it")

    append = extend = insert = pop = remove = clear = sort = reverse = _refuse
    __setitem__ = __delitem__ = __imul__ = _refuse

    def __iadd__(self, more: Iterable[T]) -> list[T]:  # type: ignore[misc, override]
        return [*self, *more]

    def __reduce__(self) -> tuple[type[list[T]], tuple[list[T]]]:
        return list, (list(self),)
