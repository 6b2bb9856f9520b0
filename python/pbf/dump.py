"""What `pbf-bench run --dump` writes: a folder of NumPy files, frame by frame."""
from __future__ import annotations

import json
import os
import pathlib
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _files
from ._errors import DataError
from ._numbers import shown

_POSITIONS = re.compile(r"positions_(\d{6,})\.npy$")


@dataclass(frozen=True)
class DumpFrame:
    """The particles after some step of a run, for `write_ply`, `VtkSeries`, `UsdPoints`,
    `AlembicPoints` and `surface`."""

    step: int
    time: float
    positions: NDArray[Any]
    velocities: NDArray[Any]
    pressures: NDArray[Any] | None
    gravity: tuple[float, ...]
    rest_distance: float
    domain_min: tuple[float, ...]
    domain_max: tuple[float, ...]

    @property
    def count(self) -> int:
        return len(self.positions)

    @property
    def dimension(self) -> int:
        return int(self.positions.shape[1])

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Files are in the order of adding, and a scene removes nothing."""
        return np.arange(self.count, dtype=np.uint32)


def _is_number(value: Any) -> bool:
    """One that float64 holds."""
    return (isinstance(value, (int, float)) and not isinstance(value, bool)
            and abs(value) <= sys.float_info.max)


def _is_vector(value: Any, dimension: int) -> bool:
    return (isinstance(value, list) and len(value) >= dimension
            and all(number is None or _is_number(number) for number in value))


def _first_wrong(about: dict[str, Any]) -> tuple[str, str] | None:
    """The first member that is not what it must be, and what that is."""
    dimension, times = about["dimension"], about.get("times", {})
    if isinstance(dimension, bool) or dimension not in (2, 3):
        return "dimension", "2 or 3"
    for key in ("smoothing_radius", "time_step", "spacing"):
        if not _is_number(about[key]) or about[key] < 0:
            return key, "a number, at least 0"
    for key in ("gravity", "domain_min", "domain_max"):
        if not _is_vector(about[key], dimension):
            return key, f"a list of {dimension} numbers, or null where there is no bound"
    if not isinstance(times, dict) or not all(map(_is_number, times.values())):
        return "times", "a number for each step"
    return None


class Dump(Sequence[DumpFrame]):
    """The frames of a folder, in the order of time; each is read when it is asked for.

    >>> for frame in pbf.load_dump("out/my"):
    ...     print(frame.time, frame.positions.max(axis=0))
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = pathlib.Path(folder)
        self.about = self._about()
        found = (_POSITIONS.match(name) for name in os.listdir(self.folder))
        self.steps = sorted(int(match[1]) for match in found if match)
        if not self.steps:
            raise DataError(f"{self.folder} holds no positions_<step, 6 digits>.npy")

    def _about(self) -> dict[str, Any]:
        path = self.folder / "dump.json"
        try:
            about = json.loads(_files.content(path, _files.SCENE_MOST).decode("utf-8"))
        except OSError as error:
            raise DataError(f"{path} can't be read ({error.strerror}); pbf-bench run --dump "
                            f"{self.folder} writes such a folder") from None
        except DataError:
            raise
        except (ValueError, RecursionError) as error:
            raise DataError(f"{path} is not JSON: {error}") from None
        wanted = ("dimension", "smoothing_radius", "spacing", "gravity", "domain_min", "domain_max",
                  "time_step")
        missing = [key for key in wanted if not isinstance(about, dict) or key not in about]
        if missing:
            raise DataError(f"{path} has no {', '.join(missing)}")
        wrong = _first_wrong(about)
        if wrong:
            key, demand = wrong
            raise DataError(f"{path}: {key} is {shown(about[key])}; it must be {demand}")
        return dict(about)

    def _array(self, what: str, step: int, shape: tuple[int, ...]) -> NDArray[Any]:
        path = self.folder / f"{what}_{step:06d}.npy"
        try:
            array = np.load(path, allow_pickle=False)
            holds_numbers = array.dtype.kind == "f" and array.ndim == len(shape)
        except Exception as error:  # of a damaged head NumPy raises whatever its parser does
            raise DataError(f"{path} can't be read: {error}") from None
        if not holds_numbers:
            raise DataError(f"{path} holds {array.dtype} in {array.ndim} dimensions; it must hold real "
                            f"numbers in {len(shape)}")
        if array.shape[1:] != shape[1:] or (shape[0] >= 0 and len(array) != shape[0]):
            raise DataError(f"{path} has shape {array.shape}, which does not fit {shape}")
        return np.asarray(array)

    def _frame(self, step: int) -> DumpFrame:
        about, dimension = self.about, int(self.about["dimension"])

        def vector(key: str) -> tuple[float, ...]:
            """An open side of the domain has no bound."""
            return tuple(float("nan") if value is None else float(value)
                         for value in about[key][:dimension])

        positions = self._array("positions", step, (-1, dimension))
        pressures = None
        if (self.folder / f"pressures_{step:06d}.npy").exists():
            pressures = self._array("pressures", step, (len(positions),))
        return DumpFrame(
            step=step, time=float(about.get("times", {}).get(str(step), step * about["time_step"])),
            positions=positions, velocities=self._array("velocities", step, positions.shape),
            pressures=pressures, gravity=vector("gravity"), domain_min=vector("domain_min"),
            domain_max=vector("domain_max"),
            rest_distance=float(about["spacing"] or about["smoothing_radius"] / 2))

    def __len__(self) -> int:
        return len(self.steps)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self._frame(step) for step in self.steps[index]]
        return self._frame(self.steps[index])

    def __iter__(self) -> Iterator[DumpFrame]:
        return map(self._frame, self.steps)


def load_dump(folder: Union[str, os.PathLike[str]]) -> Dump:
    """The frames that `pbf-bench run --dump FOLDER` has written."""
    return Dump(folder)
