"""Several fluids in one solver; see pbf/phases.h."""
from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ._arrays import AnyArray, ids_of, pointer
from ._copies import Copies
from ._errors import InvalidArgumentError, check
from ._handle import Handle
from ._library import ffi, lib, new_struct
from ._numbers import items_of, real, shown, uint32
from ._structs import dataclass_of


@dataclass
class Phase:
    """A fluid of its own."""

    rest_density: float = 1.0
    """Over the reference density, 0.001 … 1000."""
    viscosity: float = 1.0
    """0 … 1: so much of the solver's viscosity it has."""
    user: int = 0
    """A number of yours, which nothing looks at."""


class Phases(Handle):
    """The fluids of a solver."""

    @property
    def phases(self) -> list[Phase]:
        """Copies. Assign a list to replace them all; particles keep their number."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_phase_count, count)
        found = []
        for index in range(count[0]):
            struct = new_struct("pbf_phase")
            self._call(lib.pbf_get_phase, index, struct)
            found.append(dataclass_of(Phase, struct))
        return Copies(found)

    @phases.setter
    def phases(self, phases: Iterable[Phase] | Phase) -> None:
        listed = items_of("phases", phases, Phase, "a list of phases")
        structs = ffi.new("pbf_phase[]", max(len(listed), 1))
        for i, phase in enumerate(listed):
            if not isinstance(phase, Phase):
                raise InvalidArgumentError(f"phases[{i}] is {shown(phase)}; it must be a Phase")
            check(lib.pbf_phase_init(ffi.addressof(structs, i), ffi.sizeof("pbf_phase")))
            structs[i].rest_density = real("rest_density", phase.rest_density)
            structs[i].viscosity = real("viscosity", phase.viscosity)
            structs[i].user = uint32("user", phase.user)
        self._call(lib.pbf_set_phases, len(listed), structs)

    @property
    def particle_phases(self) -> NDArray[np.uint32]:
        """The number of each particle's phase, in the order of adding. Assign an array, or
        `set_particle_phases` for some rows."""
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_count, count)
        numbers = np.empty(count[0], dtype=np.uint32)
        self._call(lib.pbf_get_particle_phases, 0, count[0],
                   ffi.cast("uint32_t *", pointer(numbers)))
        return numbers

    @particle_phases.setter
    def particle_phases(self, phases: AnyArray) -> None:
        self.set_particle_phases(phases)

    def set_particle_phases(self, phases: AnyArray, first: int = 0) -> None:
        """Sets those of the rows `first`, `first` + 1, …"""
        numbers = ids_of(phases)
        self._call(lib.pbf_set_particle_phases, uint32("first", first), len(numbers),
                   ffi.cast("uint32_t *", pointer(numbers)))
