"""What the library tells a solver's log, and what that raises."""
from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from ._library import ffi, lib, text

Log = Callable[[int, str], None]

logger = logging.getLogger("pbf")


def log_to_logging(level: int, message: str) -> None:
    """Where a solver's sentences go unless it is told otherwise: the logger "pbf"."""
    logger.log(logging.WARNING if level == lib.PBF_LOG_WARNING else logging.INFO, "%s", message)


class Callbacks:
    """The log's C function, and what the caller's has raised. It must not refer to the solver,
    which it outlives."""

    def __init__(self, log: Log | None) -> None:
        self.log = log
        self.raised: BaseException | None = None
        self.function = ffi.NULL if log is None else ffi.callback("pbf_log_fn", self._call)

    def _call(self, user: Any, level: int, message: Any) -> None:
        try:
            if self.log is not None:
                self.log(level, text(message))
        except BaseException as error:  # no exception may cross the library
            self.raised = self.raised or error

    def reraise(self) -> None:
        if self.raised is not None:
            error, self.raised = self.raised, None
            raise error


def destroy(handle: Any, callbacks: Callbacks) -> None:
    lib.pbf_destroy(handle)
    callbacks.log = None
