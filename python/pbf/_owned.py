"""What holds a handle of the C API, and frees it once."""
from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Any

from ._callbacks import Callbacks, Told
from ._errors import StateError, check
from ._library import lib

if TYPE_CHECKING:
    from typing_extensions import Self


class Uncopied:
    """What holds memory of the library: a copy would hold the same, and free it once more, or not know
    that it is gone."""

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise TypeError(f"a {type(self).__name__} can't be copied or pickled, as it holds memory of the "
                        "library; arrays of it can, and saved states")


class Owned:
    """A handle that its finalizer frees: at `close`, at the end of a `with` block, or when nothing
    refers to it."""

    _what: str  # in sentences
    _handle: Any
    _callbacks: Callbacks
    _told: Told
    _finalizer: Any

    @property
    def handle(self) -> Any:
        """That of the C API, for calls through `pbf.lib`."""
        if self.closed:
            raise StateError(f"this {self._what} has been closed", lib.PBF_ERROR_STATE)
        return self._handle

    @property
    def closed(self) -> bool:
        finalizer = getattr(self, "_finalizer", None)
        return finalizer is None or not finalizer.alive

    def close(self) -> None:
        """Frees it; steps that run are cancelled. A second call does nothing."""
        if not self.closed:
            self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def _call(self, function: Any, *arguments: Any) -> None:
        """One call of the library; what the log has raised in it comes after it."""
        check(function(self.handle, *arguments))
        self._callbacks.reraise()
