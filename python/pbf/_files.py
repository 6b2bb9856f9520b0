"""Files that are written whole or not at all."""
from __future__ import annotations

import os
import pathlib
import shutil


def replace(path: str | os.PathLike[str], content: bytes) -> None:
    """Beside the file that is there, and in its place once it is whole: where it can't be written,
    as on a full disk, the old one stays. What is no file, as a pipe, has none beside it."""
    if os.path.exists(path) and not os.path.isfile(path):
        pathlib.Path(path).write_bytes(content)
        return
    target = pathlib.Path(os.path.realpath(path))
    fresh = target.with_name(f"{target.name}.{os.getpid()}.new")
    try:
        fresh.write_bytes(content)
        if target.exists():
            shutil.copymode(target, fresh)
        os.replace(fresh, target)
    except BaseException:
        fresh.unlink(missing_ok=True)
        raise
