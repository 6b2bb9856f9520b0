"""Writes points of Alembic in a process of its own: where a file can't be written, as on a full disk, alembic3d
ends the process that it is in.

    _alembic_writer.py MODULES FILE SECONDS_A_FRAME NAME     modules are looked for in these folders

A frame comes by standard input: the number of particles (int64), the width of each (float32), positions and
velocities (3 float32 a particle), ids (int32). A line goes to standard output when the file is open, and one
for each frame that is written. What went wrong is said on standard error.
"""
from __future__ import annotations

import os
import sys
from typing import IO, Any

sys.path[:] = sys.argv.pop(1).split(os.pathsep)

import imath  # noqa: E402
import numpy as np  # noqa: E402
from alembic3d import Abc, AbcCoreAbstract, AbcGeom  # noqa: E402


def _read(stream: IO[bytes], kind: str, count: int) -> Any:
    size = count * np.dtype(kind).itemsize
    numbers = stream.read(size)
    if len(numbers) != size:
        raise EOFError("a frame is cut short")
    return np.frombuffer(numbers, kind)


def _sample(stream: IO[bytes], count: int) -> Any:
    width = _read(stream, "<f4", 1)
    positions, velocities = (_read(stream, "<f4", 3 * count).reshape(count, 3) for _ in range(2))
    ids = _read(stream, "<i4", count)
    widths = AbcGeom.OFloatGeomParamSample(
        imath.FloatArrayFromBuffer(np.full(count, width[0], np.float32)), AbcGeom.GeometryScope.kVertexScope)
    return AbcGeom.OPointsSchemaSample(imath.V3fArrayFromBuffer(positions), imath.IntArrayFromBuffer(ids),
                                       imath.V3fArrayFromBuffer(velocities), widths)


def _write(path: str, interval: float, name: str) -> None:
    archive = Abc.OArchive(path)
    points = AbcGeom.OPoints(archive.getTop(), name)
    sampling = AbcCoreAbstract.TimeSampling(interval, 0.0)
    points.getSchema().setTimeSampling(archive.addTimeSampling(sampling))
    print("open", flush=True)
    while head := sys.stdin.buffer.read(8):
        points.getSchema().set(_sample(sys.stdin.buffer, int.from_bytes(head, "little")))
        print("frame", flush=True)
    # The file is whole once nothing refers to the archive, at the end of this function.


if __name__ == "__main__":
    _write(sys.argv[1], float(sys.argv[2]), sys.argv[3])
