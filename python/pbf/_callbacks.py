"""What the library tells a solver's log, and what that raises."""
from __future__ import annotations

import logging
import weakref
from collections.abc import Callable
from typing import Any

from ._errors import InvalidArgumentError
from ._library import ffi, lib, text
from ._numbers import shown

Log = Callable[[int, str], None]

logger = logging.getLogger("pbf")


def log_to_logging(level: int, message: str) -> None:
    """Where a solver's sentences go unless it is told otherwise: the logger "pbf"."""
    logger.log(logging.WARNING if level == lib.PBF_LOG_WARNING else logging.INFO, "%s", message)


class Told:
    """What is told to, held by the solver alone: where it refers to the solver in turn, as a method
    of what has it does, the collector frees both."""

    def __init__(self, log: Log | None) -> None:
        if log is not None and not callable(log):
            raise InvalidArgumentError(
                f"log is {shown(log)}; it must be a function of a level and a sentence, or None")
        self.log = log


class Callbacks:
    """The log's C function, and what the caller's has raised. It must not refer to the solver,
    which it outlives, or keep what does."""

    def __init__(self, told: Told) -> None:
        self._told = weakref.ref(told)
        self.raised: BaseException | None = None
        self.function = ffi.NULL if told.log is None else ffi.callback("pbf_log_fn", self._call)

    @property
    def log(self) -> Log | None:
        told = self._told()
        return None if told is None else told.log

    def drop(self) -> None:
        told = self._told()
        if told is not None:
            told.log = None

    def _call(self, user: Any, level: int, message: Any) -> None:
        try:
            log = self.log
            if log is not None:
                log(level, text(message))
        except BaseException as error:  # no exception may cross the library
            self.raised = self.raised or error

    def reraise(self) -> None:
        if self.raised is not None:
            error, self.raised = self.raised, None
            raise error


def destroy(place: Any, callbacks: Callbacks) -> None:
    """Of what pbf_create has put there, if it has."""
    handle, place[0] = place[0], ffi.NULL
    lib.pbf_destroy(handle)
    callbacks.drop()
