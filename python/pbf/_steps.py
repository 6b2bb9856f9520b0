"""Time steps."""
from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from ._errors import Error, InvalidArgumentError, check, last_error
from ._handle import Handle
from ._library import ffi, lib
from ._numbers import UINT32_MAX, real, uint32
from .progress import progress_of


def _starts(thread: threading.Thread) -> bool:
    try:
        thread.start()
    except RuntimeError:  # of Python's, where the system has no more threads for this user
        return False
    return True


class Steps(Handle):
    """How a solver steps."""

    def step(self, steps: int = 1) -> None:
        """Runs so many time steps. Ctrl-C ends a call of several between two of them; what is done
        stands. A GPU works on after the call: whatever reads waits for it."""
        steps = uint32("steps", steps)
        if steps <= 1 or threading.current_thread() is not threading.main_thread():
            self._call(lib.pbf_step, steps)
        elif not self._step_interruptibly(steps):
            for _ in range(steps):
                self._call(lib.pbf_step, 1)

    def _step_interruptibly(self, steps: int) -> bool:
        """The library's own thread runs the steps, another begins and ends them in C, which no
        interrupt can come between, and this one waits where Python's signal handlers run. False where
        the system gives no thread: nothing has been done then."""
        failures: list[Error] = []
        refused = False
        handle, gate = self.handle, threading.Lock()
        begun, given_up, ended = threading.Event(), threading.Event(), threading.Event()

        def work() -> None:
            nonlocal refused
            with gate:
                if given_up.is_set():
                    return
                begun.set()
                status = lib.pbf_begin_step(handle, steps)
            refused = status == lib.PBF_ERROR_OUT_OF_MEMORY
            if not status:
                status = lib.pbf_end_step(handle)
            if status and not refused:
                failures.append(last_error(status))
            ended.set()

        try:
            if not _starts(threading.Thread(target=work, name="pbf-step", daemon=True)):
                return False
            ended.wait()  # Thread.join takes a thread that it is interrupted in for ended
        except BaseException:
            given_up.set()
            with gate:
                lib.pbf_cancel(handle)
            if begun.is_set():
                ended.wait()
            raise
        if failures:
            raise failures[0]
        self._callbacks.reraise()
        return not refused

    def begin_step(self, steps: int = 1) -> None:
        """Has steps run beside what this thread does next; `end_step` waits for them, and raises
        what the log has raised in them."""
        check(lib.pbf_begin_step(self.handle, uint32("steps", steps)))

    def end_step(self) -> None:
        self._call(lib.pbf_end_step)

    @contextmanager
    def stepping(self, steps: int = 1) -> Iterator[None]:
        """Steps that run beside a `with` block, and have ended after it."""
        begun = False
        try:
            self.begin_step(steps)
            begun = True
            yield
            self.end_step()
        except BaseException as error:
            if begun or not isinstance(error, Error):  # an interrupt may come after the begin
                self.cancel()
                lib.pbf_end_step(self.handle)
            raise

    def cancel(self) -> None:
        """Has the call of steps that is inside the solver raise `CancelledError`; from any thread."""
        check(lib.pbf_cancel(self.handle))

    def frames(self, count: int, *, steps: int = 1, progress: bool = False) -> Iterator[int]:
        """Frame after frame, `steps` steps before each.

        >>> for frame in fluid.frames(60, steps=2, progress=True):
        ...     pictures.append(fluid.render())
        """
        for frame in progress_of(range(uint32("count", count)), progress, "frame"):
            self.step(steps)
            yield frame

    def run(self, seconds: float | None = None, *, steps: int | None = None,
            progress: bool = False) -> None:
        """Runs so long, or so many steps, perhaps with a progress bar (tqdm's)."""
        if (seconds is None) == (steps is None):
            raise TypeError("run wants either seconds or steps")
        if steps is None:
            seconds = real("seconds", seconds)
            if not 0 <= seconds / self.time_step <= UINT32_MAX:
                raise InvalidArgumentError(
                    f"seconds is {seconds}; in steps of {self.time_step:g} it must be 0 … "
                    f"{UINT32_MAX * self.time_step:g}")
            steps = math.ceil(seconds / self.time_step - 1e-6)
        steps = uint32("steps", steps)
        if not progress:
            self.step(steps)
            return
        batch = max(1, steps // 200)
        starts = progress_of(range(0, steps, batch), True, "batch", steps)
        for start in starts:
            self.step(min(batch, steps - start))

    @property
    def step_limit(self) -> float:
        """The longest `time_step` that the present state stands, undivided."""
        limit = ffi.new("double *")
        self._call(lib.pbf_get_step_limit, limit)
        return float(limit[0])
