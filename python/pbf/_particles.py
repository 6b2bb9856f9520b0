"""Particles: added, removed, found, and set."""
from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import AnyArray, ids_of, pointer, rows_of
from ._errors import CapacityError, InvalidArgumentError
from ._library import ffi, lib
from ._numbers import Vector, items_of, reals, uint32
from ._reading import Reading
from .fill import fill_ball, fill_box


class Particles(Reading):
    """A solver's particles."""

    def __len__(self) -> int:
        return self.count

    def __bool__(self) -> bool:
        return True

    def add(self, positions: AnyArray, velocities: AnyArray | None = None) -> range:
        """Adds particles, and gives their ids. `velocities`: one each, one for all, or None: at
        rest."""
        rows = rows_of("positions", positions, self.dimension, self.dtype)
        speeds = None
        if velocities is not None:
            speeds = rows_of("velocities", velocities, self.dimension, self.dtype)
            if len(speeds) == 1 and len(rows) != 1:
                speeds = np.ascontiguousarray(np.broadcast_to(speeds, rows.shape))
            if len(speeds) != len(rows):
                raise InvalidArgumentError(
                    f"there are {len(rows)} positions and {len(speeds)} velocities")
        first = ffi.new("uint32_t *")
        try:
            self._call(lib.pbf_add_particles, uint32("count", len(rows)), pointer(rows),
                       ffi.NULL if speeds is None else pointer(speeds), first)
        except CapacityError as error:
            raise CapacityError(
                f"{error.sentence}. In Python: Solver(capacity=…), or Solver.reserve") from None
        return range(first[0], first[0] + len(rows))

    def add_box(self, lower: Vector, upper: Vector,
                velocity: Vector | None = None) -> range:
        """Fills a box with particles at rest density."""
        return self.add(fill_box(lower, upper, self.rest_distance), velocity)

    def add_ball(self, center: Vector, radius: float,
                 velocity: Vector | None = None) -> range:
        """Fills a ball, in 2D a disc, with particles at rest density."""
        return self.add(fill_ball(center, radius, self.rest_distance), velocity)

    def remove(self, ids: AnyArray) -> None:
        """Removes the particles with these ids; none where one id is unknown."""
        array = ids_of(ids)
        self._call(lib.pbf_remove_particles, len(array), ffi.cast("uint32_t *", pointer(array)))

    def _box(self, lower: Vector | None, upper: Vector | None) -> tuple[Any, Any]:
        corners = []
        for name, given, none in (("lower", lower, -math.inf), ("upper", upper, math.inf)):
            values = [none] * 3
            if given is not None:
                wanted = f"a list of {self.dimension} numbers"
                listed = [none if value is None else value
                          for value in items_of(name, given, type(None), wanted)]
                values[:self.dimension] = reals(name, listed, (self.dimension,))
            corners.append(ffi.new("double[3]", values))
        return corners[0], corners[1]

    def remove_in_box(self, lower: Vector | None = None,
                      upper: Vector | None = None) -> int:
        """Removes what is in a box, and says how many they were. None is no bound."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_remove_in_box, *self._box(lower, upper), count)
        return int(count[0])

    def find_in_box(self, lower: Vector | None = None,
                    upper: Vector | None = None) -> NDArray[np.uint32]:
        """The ids of what is in a box, ascending. None is no bound."""
        count, box = ffi.new("uint32_t *"), self._box(lower, upper)
        self._call(lib.pbf_find_in_box, *box, 0, ffi.NULL, count)
        ids = np.empty(count[0], np.uint32)
        if len(ids):
            self._call(lib.pbf_find_in_box, *box, len(ids),
                       ffi.cast("uint32_t *", pointer(ids)), count)
        return ids

    @property
    def positions(self) -> NDArray[Any]:
        """A copy, of shape (count, dimension), in the order of adding. Assign to set all."""
        return self.read("position")

    @positions.setter
    def positions(self, positions: AnyArray) -> None:
        self._set_all("positions", positions)

    @property
    def velocities(self) -> NDArray[Any]:
        """As `positions`."""
        return self.read("velocity")

    @velocities.setter
    def velocities(self, velocities: AnyArray) -> None:
        self._set_all("velocities", velocities)

    @property
    def ids(self) -> NDArray[np.uint32]:
        """A copy, increasing: ids are never used again."""
        return self.read("id")

    @property
    def densities(self) -> NDArray[Any]:
        """Density over rest density; looks for neighbours."""
        return self.read("density")

    @property
    def pressures(self) -> NDArray[Any]:
        """Pressure over rest density of the last step; looks for neighbours."""
        return self.read("pressure")

    def _set_all(self, name: str, values: AnyArray) -> None:
        rows = rows_of(name, values, self.dimension, self.dtype)
        if len(rows) != self.count:
            raise InvalidArgumentError(
                f"{name} has {len(rows)} rows for {self.count} particles; Solver.set_{name} sets "
                "some of them, Solver.add and Solver.remove change their number")
        self._set_rows(name, rows, 0)

    def _set_rows(self, name: str, values: AnyArray, first: int) -> None:
        rows = rows_of(name, values, self.dimension, self.dtype)
        self._call(getattr(lib, f"pbf_set_{name}"), uint32("first", first), len(rows),
                   pointer(rows))

    def set_positions(self, positions: AnyArray, first: int = 0) -> None:
        """Sets those of the rows `first`, `first` + 1, …"""
        self._set_rows("positions", positions, first)

    def set_velocities(self, velocities: AnyArray, first: int = 0) -> None:
        """Sets those of the rows `first`, `first` + 1, …"""
        self._set_rows("velocities", velocities, first)

    def set_accelerations(self, accelerations: AnyArray | None, first: int = 0) -> None:
        """Accelerations beside gravity of the rows `first`, `first` + 1, …, in each step until
        they are set anew; None takes those of all particles away."""
        if accelerations is None:
            self._call(lib.pbf_set_accelerations, uint32("first", first), 0, ffi.NULL)
        else:
            self._set_rows("accelerations", accelerations, first)
