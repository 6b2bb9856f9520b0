"""Exceptions: one for each status of base.h, with the library's sentence."""
from __future__ import annotations

from unicodedata import category

from ._library import lib, text


def one_line(sentence: str) -> str:
    """With what is quoted in it: a name may hold what ends a line, rules a terminal or is no character."""
    if sentence.isprintable():
        return sentence
    return "".join("?" if category(char) in ("Cc", "Cs", "Zl", "Zp") else char for char in sentence)


class Error(Exception):
    """A call of the library has failed.

    `sentence` is what the library says of it (also `str(error)`), `status` the number in base.h and
    `name` its name there, as "PBF_ERROR_CAPACITY".
    """

    status: int = 0

    def __init__(self, sentence: str, status: int | None = None) -> None:
        self.sentence = one_line(sentence)
        super().__init__(self.sentence)
        if status is not None:
            self.status = status

    @property
    def name(self) -> str:
        return text(lib.pbf_status_string(self.status))

    def __reduce__(self) -> tuple[type[Error], tuple[str, int]]:
        return type(self), (self.sentence, self.status)


class InvalidArgumentError(Error, ValueError):
    """A value is out of range, not a number, infinite or of a wrong shape."""

    status = lib.PBF_ERROR_INVALID_ARGUMENT


class StructSizeError(Error):
    """A struct is larger than the library knows: it is older than this package."""

    status = lib.PBF_ERROR_STRUCT_SIZE


class OutOfMemoryError(Error, MemoryError):
    """The host or the device has no memory left."""

    status = lib.PBF_ERROR_OUT_OF_MEMORY


class CapacityError(Error):
    """More particles than the solver's capacity; `Solver.reserve` makes room."""

    status = lib.PBF_ERROR_CAPACITY


class NotFoundError(Error, LookupError):
    """No particle, backend or item of that name or number."""

    status = lib.PBF_ERROR_NOT_FOUND


class UnavailableError(Error):
    """No backend can serve this solver."""

    status = lib.PBF_ERROR_UNAVAILABLE


class UnsupportedError(Error):
    """This build or backend does not have it."""

    status = lib.PBF_ERROR_UNSUPPORTED


class BusyError(Error):
    """Another call is inside this solver."""

    status = lib.PBF_ERROR_BUSY


class StateError(Error):
    """Not now: a view is alive, for example."""

    status = lib.PBF_ERROR_STATE


class DeviceError(Error):
    """A call of the device has failed."""

    status = lib.PBF_ERROR_DEVICE


class PluginError(Error):
    """A backend broke the plugin rules."""

    status = lib.PBF_ERROR_PLUGIN


class DataError(Error, ValueError):
    """A saved state or a scene file is truncated, damaged or of another kind."""

    status = lib.PBF_ERROR_DATA


class CancelledError(Error):
    """`Solver.cancel` has ended the call; what it has done stands."""

    status = lib.PBF_ERROR_CANCELLED


class MissingExtraError(ImportError):
    """What was asked for needs a package that is not installed; the sentence names it."""


_CLASSES = {
    kind.status: kind
    for kind in (InvalidArgumentError, StructSizeError, OutOfMemoryError, CapacityError,
                 NotFoundError, UnavailableError, UnsupportedError, BusyError, StateError,
                 DeviceError, PluginError, DataError, CancelledError)
}


def last_error(status: int) -> Error:
    """The exception for a call of this thread that has just failed."""
    return _CLASSES.get(status, Error)(text(lib.pbf_last_error()), status)


def check(status: int) -> None:
    if status != 0:
        raise last_error(status)
