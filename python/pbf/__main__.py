"""Files for other programs, of what `pbf-bench run --dump FOLDER` has written:

    python -m pbf export FOLDER water.pvd          a time series for ParaView
    python -m pbf export FOLDER water.usdc         USD: Blender, Houdini, usdview
    python -m pbf export FOLDER water.abc          Alembic
    python -m pbf export FOLDER water.ply          a file for each frame: water_0000.ply, …
    python -m pbf export FOLDER water.obj --surface    the same, a mesh of the surface in each
"""
from __future__ import annotations

import argparse
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

from . import _errors, export
from ._streams import LostOutput, Parser, show, tell
from .dump import Dump, DumpFrame, load_dump

_SERIES = {".pvd": export.VtkSeries, ".abc": export.AlembicPoints, ".usd": export.UsdPoints,
           ".usda": export.UsdPoints, ".usdc": export.UsdPoints}

_MESHES = {".ply", ".obj", ".stl", ".vtu"}


def _one_a_frame(frames: Dump, to: pathlib.Path, surface: bool) -> int:
    if to.suffix not in (_MESHES if surface else {".ply"}):
        raise _errors.InvalidArgumentError(
            f"{to.name}: particles go to .ply, .pvd, .abc, .usd, .usda or .usdc, surfaces "
            "(--surface) to .ply, .obj, .stl or .vtu")
    to.parent.mkdir(parents=True, exist_ok=True)
    for number, frame in enumerate(frames):
        file = to.with_name(f"{to.stem}_{number:04d}{to.suffix}")
        if surface:
            export.surface(frame).save(file)
        else:
            export.write_ply(file, frame, **_columns(frame))
    return len(frames)


def _columns(frame: DumpFrame) -> dict[str, Any]:
    return {} if frame.pressures is None else {"pressure": frame.pressures}


def _series(frames: Dump, to: pathlib.Path, fps: float) -> int:
    kind: Any = _SERIES[to.suffix]
    with kind(to) if to.suffix == ".pvd" else kind(to, fps=fps) as series:
        for frame in frames:
            series.add(frame, **(_columns(frame) if to.suffix == ".pvd" else {}))
    return len(frames)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = Parser(prog="python -m pbf", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("export", help="files for other programs")
    one.add_argument("folder", help="what pbf-bench run --dump has written")
    one.add_argument("to", type=pathlib.Path, help="the file; its ending says of which kind")
    one.add_argument("--fps", type=float, default=30, help="frames a second, of USD and Alembic: 30")
    one.add_argument("--surface", action="store_true", help="a mesh in place of the particles")
    try:
        given = parser.parse_args(arguments)
        frames = load_dump(given.folder)
        as_series = given.to.suffix in _SERIES and not given.surface
        count = (_series(frames, given.to, given.fps) if as_series
                 else _one_a_frame(frames, given.to, given.surface))
        show(f"{count} frames: {given.to}\n")
    except (_errors.Error, _errors.MissingExtraError, OSError, LostOutput) as error:
        if str(error):
            tell(f"pbf: {error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
