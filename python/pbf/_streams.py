"""What a program prints, where its standard output may be closed, or full, or a pipe of which the reader is gone."""
from __future__ import annotations

import argparse
import errno
import os
import sys
from typing import Any


class LostOutput(Exception):
    """What was to be printed is lost; no text where a reader has read enough."""


def _drop_the_rest() -> None:
    """What is left in the buffer would be tried again as the interpreter ends."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


def show(text: str) -> None:
    """Prints it, now."""
    if sys.stdout is None:
        raise LostOutput(f"the standard output can't be written: {os.strerror(errno.EBADF)}")
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except OSError as error:
        _drop_the_rest()
        reason = "" if error.errno == errno.EPIPE else f"the standard output can't be written: {error.strerror}"
        raise LostOutput(reason) from error


def tell(text: str) -> None:
    """Prints it where errors go, if anywhere."""
    try:
        if sys.stderr is not None:
            sys.stderr.write(text)
            sys.stderr.flush()
    except OSError:
        pass


class Parser(argparse.ArgumentParser):
    """Prints by these."""

    def _print_message(self, message: str, file: Any = None) -> None:
        if message:
            (show if file is sys.stdout else tell)(message)
