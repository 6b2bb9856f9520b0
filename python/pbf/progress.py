"""Progress bars, by tqdm."""
from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeVar

from ._errors import MissingExtraError

T = TypeVar("T")


def progress_of(items: Iterable[T], shown: bool, unit: str, steps: int | None = None) -> Iterator[T]:
    """The items, with a bar if it is to be shown: over them, or over `steps` steps in all."""
    if not shown:
        return iter(items)
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise MissingExtraError(
            "progress=True draws with tqdm, which is not installed: pip install tqdm") from None
    if steps is None:
        return iter(tqdm(items, unit=unit))
    return _by_steps(list(items), tqdm(total=steps, unit="step"), steps)


def _by_steps(starts: list[T], bar: object, steps: int) -> Iterator[T]:
    """`starts` are the numbers of steps that have been done before each."""
    with bar:  # type: ignore[attr-defined]
        for start, after in zip(starts, [*starts[1:], steps]):
            yield start
            bar.update(after - start)  # type: ignore[attr-defined, operator]
