"""Saved states: bytes, files, pickles, copies."""
from __future__ import annotations

import os
import struct as binary
from typing import TYPE_CHECKING, Any, Union

from . import _files
from ._callbacks import log_to_logging
from ._choices import PRECISIONS
from ._errors import DataError, StateError
from ._library import ffi, lib
from ._numbers import UINT32_MAX, uint32
from ._reading import Reading

if TYPE_CHECKING:
    from typing_extensions import Self

PathLike = Union[str, "os.PathLike[str]"]


class State(Reading):
    """A solver's whole state."""

    def save(self, path: PathLike | None = None) -> bytes:
        """Parameters, colliders, time and particles as bytes, which go to a file, too, if told."""
        size = ffi.new("uint64_t *")
        self._call(lib.pbf_save, ffi.NULL, size)
        buffer = bytearray(size[0])
        self._call(lib.pbf_save, ffi.from_buffer(buffer), size)
        state = bytes(buffer[:size[0]])
        if path is not None:
            _files.replace(path, state)
        return state

    def load(self, source: PathLike | bytes | bytearray | memoryview) -> None:
        """Replaces the whole state by a saved one, of the same dimension and precision."""
        state = state_of(source)
        self._call(lib.pbf_load, ffi.from_buffer(state), len(state))

    @classmethod
    def restore(cls, source: PathLike | bytes | bytearray | memoryview, *,
                capacity: int | None = None, **desc: Any) -> Self:
        """A new solver in a saved state, of its dimension and precision. Without `capacity` it has
        room for the particles of the state alone: emitters and reservoirs need more."""
        state = state_of(source)
        dimension, precision, count = _kind_of(state)
        make: Any = cls
        solver: Self = make(dimension=dimension, precision=precision,
                     capacity=max(count, 1) if capacity is None else capacity, **desc)
        solver.load(state)
        return solver

    def reserve(self, capacity: int) -> None:
        """Makes room for so many particles: a new solver in the same state takes this one's place,
        with the same bits. Views and snapshots that are held stay as they are."""
        if self._batch is not None:
            raise StateError("this solver is a world of a batch, whose capacity it has",
                             lib.PBF_ERROR_STATE)
        state, snapshots, keeps = self.save(), self._snapshots, self._keeps_previous
        desc = {**self._desc, "capacity": uint32("capacity", capacity)}
        larger = type(self).__new__(type(self))
        larger._create(desc, self._stream, self._callbacks.log, self.params, {})
        larger.load(state)
        larger._keep(snapshots, keeps)
        self._become(larger)

    def _keep(self, snapshots: int, previous: bool) -> None:
        if snapshots:
            self.keep_snapshots(snapshots)
        if previous:
            self.keep_previous()

    @property
    def hash(self) -> int:
        """64 bits over step, count, ids, positions and velocities."""
        value = ffi.new("uint64_t *")
        self._call(lib.pbf_hash, value)
        return int(value[0])

    def __getstate__(self) -> dict[str, Any]:
        own = {name: value for name, value in vars(self).items() if not name.startswith("_")}
        return {"desc": self._desc, "state": self.save(), "snapshots": self._snapshots,
                "keeps_previous": self._keeps_previous, "attributes": own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        _check_pickled(state)
        self._create(state["desc"], 0, log_to_logging, None, {})
        self.load(state["state"])
        self._keep(state["snapshots"], state["keeps_previous"])
        self.__dict__.update(state["attributes"])

    def copy(self) -> Self:
        """A second solver in the same state."""
        made = type(self).__new__(type(self))
        made.__setstate__(self.__getstate__())
        return made

    __copy__ = copy


_DESC = {"dimension", "precision", "capacity", "backend", "device", "threads", "strict", "isa",
         "determinism"}
_PICKLED = {"desc": dict, "state": bytes, "snapshots": int, "keeps_previous": bool,
            "attributes": dict}


def _check_pickled(state: Any) -> None:
    """Whether it is what a solver gives to a pickle, of this version."""
    are_there = isinstance(state, dict) and set(state) == set(_PICKLED) and all(
        isinstance(state[name], kind) for name, kind in _PICKLED.items())
    if not are_there or set(state["desc"]) != _DESC or not all(
            isinstance(name, str) and not name.startswith("_") for name in state["attributes"]):
        raise DataError("the pickled state is not that of a solver, or of another version",
                        lib.PBF_ERROR_DATA)


def state_of(source: PathLike | bytes | bytearray | memoryview, mark: bytes = b"PBFSTATE"
             ) -> bytes | bytearray | memoryview:
    if isinstance(source, memoryview):  # of whatever numbers, side by side or not
        return source.tobytes()
    if isinstance(source, (bytes, bytearray)):
        return source
    return _files.content(source, None, mark)


def _kind_of(state: bytes | bytearray | memoryview) -> tuple[int, str, int]:
    """Dimension, precision and count of a saved state: the head of lib/state/snapshot.h. All else
    of it the library checks."""
    head = "<8s8xII12xI"
    if len(state) >= binary.calcsize(head):
        magic, dimension, precision, count = binary.unpack_from(head, state)
        names = {bits: name for name, bits in PRECISIONS.items()}
        if magic == b"PBFSTATE" and dimension in (2, 3) and precision in names:
            return dimension, names[precision], min(count, UINT32_MAX)
    raise DataError("the saved state does not begin as one; Solver.restore takes what Solver.save "
                    "wrote", lib.PBF_ERROR_DATA)
