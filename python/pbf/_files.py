"""Files that are written whole or not at all, and read as far as they can be what they are taken for."""
from __future__ import annotations

import errno
import itertools
import os
import pathlib
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from ._errors import DataError

SCENE_MOST = 16 << 20  # bytes, as for pbf-bench
MESH_MOST = 256 << 20


def content(path: str | os.PathLike[str], most: int | None, mark: bytes = b"") -> bytearray:
    """All of a file, a pipe or whatever the system can read. What does not begin with `mark` is read no
    further: a device may have no end, and what takes the bytes says that they are none of its own."""
    found = bytearray()
    with open(os.fspath(path), "rb") as file:  # a number would be a descriptor of another file's
        while found[:len(mark)] == mark[:len(found)]:
            part = file.read(1 << 20)
            found += part
            if not part:
                break
            if most is not None and len(found) > most:
                raise DataError(f"{os.fspath(path)} has more than {most} bytes, the most that such a file has")
    return found


def _in_place(path: str) -> bool:
    """What is no file, as a pipe, has none beside it, and /dev/stdout is one that holds more."""
    return path.startswith(("/dev/", "/proc/")) or (os.path.exists(path) and not os.path.isfile(path))


_number = itertools.count()


def _beside(target: pathlib.Path) -> pathlib.Path | None:
    """An empty file with the same ending, by which some writers choose, and a name that no other thread,
    or process of this number in a container, writes to; None in a folder where none can be made, though
    the file that is there can perhaps be written."""
    while True:
        name = f"{target.stem}.{os.getpid()}.{next(_number)}.new{target.suffix}"
        fresh = target.with_name(name)
        try:
            fresh.touch(exist_ok=False)
        except FileExistsError:
            continue
        except OSError as error:
            if error.errno in (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENAMETOOLONG):
                return None
            raise
        return fresh


def _take_its_place(fresh: pathlib.Path, target: pathlib.Path) -> None:
    if target.exists():
        shutil.copymode(target, fresh)
    try:
        os.replace(fresh, target)
    except OSError as error:
        if error.errno not in (errno.EBUSY, errno.EACCES, errno.EPERM):
            raise
        shutil.copyfile(fresh, target)  # a file that is mounted by itself, or another user's
        fresh.unlink()


@contextmanager
def _elsewhere(path: str | os.PathLike[str]) -> Iterator[pathlib.Path]:
    """A file of its own, for writers that replace what has the name, or go back in it; copied in the end."""
    with tempfile.TemporaryDirectory() as folder:
        place = pathlib.Path(folder) / pathlib.Path(path).name
        yield place
        with open(place, "rb") as whole, open(path, "wb") as file:
            shutil.copyfileobj(whole, file)


@contextmanager
def written(path: str | os.PathLike[str], by_name: bool = False) -> Iterator[pathlib.Path]:
    """Where to write: beside the file that is there, and in its place once it is whole. Where it can't
    be written, as on a full disk, the old one stays. `by_name`: by what takes a name alone, of a file."""
    target = pathlib.Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    fresh = None if _in_place(os.fspath(path)) else _beside(target)
    if fresh is None and by_name:
        with _elsewhere(path) as place:
            yield place
        return
    if fresh is None:
        yield pathlib.Path(path)
        return
    try:
        yield fresh
        _take_its_place(fresh, target)
    except BaseException:
        fresh.unlink(missing_ok=True)
        raise


def replace(path: str | os.PathLike[str], content: bytes) -> None:
    with written(path) as place:
        place.write_bytes(content)
