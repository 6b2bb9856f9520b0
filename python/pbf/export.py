"""Files for other programs: PLY, VTK for ParaView, USD, Alembic; and the surface of a fluid."""
from __future__ import annotations

import importlib
import os
import pathlib
import re
import subprocess
import sys
from contextlib import ExitStack
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, Union
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from . import _files
from ._arrays import numpy_of
from ._errors import InvalidArgumentError, MissingExtraError, StateError, one_line
from ._numbers import real, shown

if TYPE_CHECKING:
    from .solver import Solver

PathLike = Union[str, "os.PathLike[str]"]


class Particles(Protocol):
    """What is written of a fluid: a Solver has it, and a frame that pbf-bench has written."""

    @property
    def positions(self) -> NDArray[Any]: ...
    @property
    def velocities(self) -> NDArray[Any]: ...
    @property
    def ids(self) -> NDArray[Any]: ...
    @property
    def count(self) -> int: ...
    @property
    def dimension(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def gravity(self) -> tuple[float, ...]: ...
    @property
    def rest_distance(self) -> float: ...
    @property
    def domain_min(self) -> tuple[float, ...]: ...
    @property
    def domain_max(self) -> tuple[float, ...]: ...


_TYPES = {"f4": "float", "f8": "double", "i4": "int", "u4": "uint", "u1": "uchar"}


def _need(module: str, package: str, what: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        raise MissingExtraError(
            f"{what} needs {package}, which is not installed: pip install {package}, or this "
            "package with its extra: pip install '.[export]'") from None


def _frames_a_second(fps: Any) -> float:
    rate = real("fps", fps)
    if not 0 < rate < float("inf"):
        raise InvalidArgumentError(f"fps is {rate:g}; it must be above 0, and finite")
    return rate


def _need_open(path: pathlib.Path, points: Any) -> None:
    if points is None:
        raise StateError(f"{path.name} is closed, and takes no more frames")


class _Columns(NamedTuple):
    """What a format takes as further columns."""

    names: str  # a regular expression …
    named: str  # … in words
    taken: tuple[str, ...]
    types: tuple[str, ...]
    widest: int  # numbers a particle

    def of(self, given: dict[str, Any], count: int) -> dict[str, NDArray[Any]]:
        """In the machine's own byte order."""
        return {name: self._column(name, column, count) for name, column in given.items()}

    def _column(self, name: str, column: Any, count: int) -> NDArray[Any]:
        if name in self.taken or not name.isprintable() or not re.fullmatch(self.names, name):
            raise InvalidArgumentError(
                f"a column can't be called {shown(name)}; a name is of {self.named}, and none of "
                f"{', '.join(self.taken)}")
        values = numpy_of(name, column)
        width = values.shape[1] if values.ndim == 2 else 1
        if (values.ndim not in (1, 2)[:self.widest] or len(values) != count or not 1 <= width <= self.widest
                or values.dtype.str[1:] not in self.types):
            numbers = "one number" if self.widest == 1 else f"1 to {self.widest} numbers"
            raise InvalidArgumentError(
                f"{name} has shape {values.shape} of {values.dtype}; it must have {numbers} for each of the "
                f"{count} particles, of {', '.join(np.dtype(kind).name for kind in self.types)}")
        return values.astype(values.dtype.newbyteorder("="), copy=False)


def _in_space(vectors: NDArray[Any]) -> NDArray[Any]:
    """Three numbers each, in 2D, too."""
    if vectors.shape[1] == 3:
        return vectors
    padded = np.zeros((len(vectors), 3), vectors.dtype)
    padded[:, :2] = vectors
    return padded


# ---- PLY -----------------------------------------------------------------------------------------


_PLY_COLUMNS = _Columns(
    names="[!-~]+", named="ASCII's letters, digits and signs", taken=("x", "y", "z", "vx", "vy", "vz", "id"),
    types=tuple(_TYPES), widest=1)


def _record(columns: list[tuple[str, NDArray[Any]]], count: int) -> NDArray[Any]:
    fields = [(name, "<" + column.dtype.str[1:]) for name, column in columns]
    table = np.empty(count, fields)
    for name, column in columns:
        table[name] = column
    return table


def _ply(vertices: list[tuple[str, NDArray[Any]]], count: int,
         triangles: NDArray[Any] | None = None) -> bytes:
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {count}"]
    lines += [f"property {_TYPES[column.dtype.str[1:]]} {name}" for name, column in vertices]
    if triangles is not None:
        lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
    data = [("\n".join([*lines, "end_header"]) + "\n").encode(), _record(vertices, count).tobytes()]
    if triangles is not None:
        faces = np.empty(len(triangles), [("n", "u1"), ("corners", "<i4", 3)])
        faces["n"], faces["corners"] = 3, triangles
        data.append(faces.tobytes())
    return b"".join(data)


def _axes(vectors: NDArray[Any], names: str) -> list[tuple[str, NDArray[Any]]]:
    spatial = _in_space(vectors)
    return [(name, spatial[:, k]) for k, name in enumerate(names.split())]


def write_ply(path: PathLike, fluid: Particles, **columns: NDArray[Any]) -> None:
    """The particles as a cloud of points: x, y, z, vx, vy, vz, id, and further columns, of one
    number a particle, by name."""
    table = [*_axes(fluid.positions, "x y z"), *_axes(fluid.velocities, "vx vy vz"),
             ("id", fluid.ids)]
    table += _PLY_COLUMNS.of(columns, fluid.count).items()
    _files.replace(path, _ply(table, fluid.count))


# ---- ParaView ------------------------------------------------------------------------------------


_VTK_COLUMNS = _Columns(
    names='[^"&<>]+', named='what can be printed, without ", &, < and >', taken=("velocity", "id"),
    types=("f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"), widest=9)


class VtkSeries:
    """A time series for ParaView: NAME.pvd, which it opens, and a NAME_0000.vtu each frame, with
    velocity and id of each particle, of a Solver density, too.

    >>> with pbf.VtkSeries("out/dam.pvd") as series:
    ...     for frame in fluid.frames(60, steps=4):
    ...         series.add(fluid)
    """

    def __init__(self, path: PathLike) -> None:
        self._meshio = _need("meshio", "meshio", "a .vtu file")
        self.path = pathlib.Path(path)
        if self.path.suffix != ".pvd":
            raise InvalidArgumentError(f'{self.path.name}: a series ends in ".pvd"')
        self._frames: list[tuple[float, str]] = []

    def add(self, fluid: Particles, **columns: NDArray[Any]) -> pathlib.Path:
        """The present state as the next frame; further columns by name. Gives the file's path."""
        count = fluid.count
        further = _VTK_COLUMNS.of(columns, count)
        densities = getattr(fluid, "densities", None)
        if densities is not None:
            further.setdefault("density", densities)
        mesh = self._meshio.Mesh(
            _in_space(fluid.positions), [("vertex", np.arange(count).reshape(-1, 1))],
            point_data={"velocity": _in_space(fluid.velocities), "id": fluid.ids.astype(np.int64),
                        **further})
        file = self.path.with_name(f"{self.path.stem}_{len(self._frames):04d}.vtu")
        file.parent.mkdir(parents=True, exist_ok=True)
        with _files.written(file) as place:
            mesh.write(place)
        self._frames.append((fluid.time, file.name))
        self._write()
        return file

    def _write(self) -> None:
        """After each frame, so that a run that ends early leaves what ParaView can open."""
        lines = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "<Collection>"]
        lines += [f'<DataSet timestep="{time!r}" part="0" file={quoteattr(name)}/>'
                  for time, name in self._frames]
        text = "\n".join([*lines, "</Collection>", "</VTKFile>", ""])
        _files.replace(self.path, text.encode("utf-8"))

    def __enter__(self) -> VtkSeries:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        return None


# ---- USD -----------------------------------------------------------------------------------------


def _need_prim(path: Any, prim: Any) -> None:
    if isinstance(prim, str) and prim[:1] == "/" and path.IsValidPathString(prim) and path(prim).IsPrimPath():
        return
    raise InvalidArgumentError(f'prim is {shown(prim)}; it must be an absolute path of names, as "/fluid"')


class UsdPoints:
    """Particles as points of USD, a time sample each frame: .usdc, .usda or .usd.

    >>> with pbf.UsdPoints("dam.usdc", fps=30) as usd:
    ...     for frame in fluid.frames(60, steps=4):
    ...         usd.add(fluid)
    """

    def __init__(self, path: PathLike, fps: float = 24.0, prim: str = "/fluid") -> None:
        what = "a USD file"
        usd, geometry = _need("pxr.Usd", "usd-core", what), _need("pxr.UsdGeom", "usd-core", what)
        self._vt = _need("pxr.Vt", "usd-core", what)
        self._error = _need("pxr.Tf", "usd-core", what).ErrorException
        self.path = pathlib.Path(path)
        if self.path.suffix not in (".usd", ".usda", ".usdc"):
            raise InvalidArgumentError(f'{self.path.name} must end in ".usd", ".usda" or ".usdc"')
        _need_prim(_need("pxr.Sdf", "usd-core", what).Path, prim)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self._frame = 0
        self._stage = usd.Stage.CreateInMemory()
        self._stage.SetTimeCodesPerSecond(_frames_a_second(fps))
        self._points = geometry.Points.Define(self._stage, prim)
        self._stage.SetDefaultPrim(self._points.GetPrim())
        self._geometry = geometry

    def add(self, fluid: Particles) -> None:
        """The present state as the next frame."""
        _need_open(self.path, self._points)
        if self._frame == 0:
            gravity = np.abs(np.array([*fluid.gravity, 0.0])[:3])
            up = self._geometry.Tokens.z if gravity.argmax() == 2 else self._geometry.Tokens.y
            self._geometry.SetStageUpAxis(self._stage, up)
            self._geometry.SetStageMetersPerUnit(self._stage, 1)  # USD's own default is a centimetre
        vectors = self._vt.Vec3fArray.FromNumpy
        points, time = self._points, self._frame
        points.CreatePointsAttr().Set(vectors(_in_space(fluid.positions).astype(np.float32)), time)
        points.CreateVelocitiesAttr().Set(
            vectors(_in_space(fluid.velocities).astype(np.float32)), time)
        points.CreateIdsAttr().Set(
            self._vt.Int64Array.FromNumpy(fluid.ids.astype(np.int64)), time)
        widths = np.full(fluid.count, fluid.rest_distance, np.float32)
        points.CreateWidthsAttr().Set(self._vt.FloatArray.FromNumpy(widths), time)
        self._frame += 1

    def close(self) -> None:
        """Writes the file. Where that fails, the old one stays, and it may be tried again."""
        if self._stage is None:
            return
        self._stage.SetStartTimeCode(0)
        self._stage.SetEndTimeCode(max(0, self._frame - 1))
        with _files.written(self.path, by_name=True) as place:
            self._export(place)
        self._stage = self._points = None

    def _export(self, place: pathlib.Path) -> None:
        try:
            done, why = self._stage.GetRootLayer().Export(str(place)), ""
        except self._error as error:
            done, why = False, ": " + str(error).strip().partition("\n")[0].rpartition(" : ")[2]
        if not done:
            raise OSError(one_line(f"{self.path} can't be written{why}"))

    def __enter__(self) -> UsdPoints:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


# ---- Alembic -------------------------------------------------------------------------------------


def _start_writer(place: pathlib.Path, interval: float, name: str) -> subprocess.Popen[bytes]:
    program = pathlib.Path(__file__).with_name("_alembic_writer.py")
    command = [sys.executable, "-I", str(program), os.pathsep.join(sys.path), str(place), repr(interval), name]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


class AlembicPoints:
    """Particles as points of Alembic, a sample each frame: .abc.

    >>> with pbf.AlembicPoints("dam.abc", fps=30) as alembic:
    ...     for frame in fluid.frames(60, steps=4):
    ...         alembic.add(fluid)
    """

    def __init__(self, path: PathLike, fps: float = 24.0, name: str = "fluid") -> None:
        for module in ("alembic3d.AbcGeom", "alembic3d.AbcCoreAbstract", "alembic3d.Abc", "imath"):
            _need(module, "alembic3d", "an Alembic file")
        self.path = pathlib.Path(path)
        if self.path.suffix != ".abc":
            raise InvalidArgumentError(f'{self.path.name} must end in ".abc"')
        if not isinstance(name, str) or not name or not name.isprintable() or "/" in name:
            raise InvalidArgumentError(f'name is {shown(name)}; it must be a name without "/", as "fluid"')
        interval = 1 / _frames_a_second(fps)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with ExitStack() as file:
            place = file.enter_context(_files.written(self.path, by_name=True))
            self._writer: Any = _start_writer(place, interval, name)
            self._await_line()
            self._file = file.pop_all()

    def _await_line(self) -> None:
        """Which the writer gives when it has done what it was told."""
        if not self._writer.stdout.readline():
            self._end(self._writer)

    def _end(self, writer: Any) -> None:
        words = writer.communicate()[1].decode("utf-8", "replace").splitlines()
        if writer.returncode:
            why = next((line.strip() for line in reversed(words) if line.strip()), f"exit {writer.returncode}")
            raise OSError(one_line(f"{self.path} can't be written: {why}"))

    def _send(self, frame: list[NDArray[Any]]) -> None:
        try:
            for part in frame:
                self._writer.stdin.write(part.tobytes())
            self._writer.stdin.flush()
        except BrokenPipeError:
            pass  # then there is no line
        self._await_line()

    def add(self, fluid: Particles) -> None:
        """The present state as the next frame. Where that fails, the old file stays."""
        _need_open(self.path, self._writer)
        frame = [np.array([fluid.count], "<i8"), np.array([fluid.rest_distance], "<f4"),
                 _in_space(fluid.positions).astype("<f4"), _in_space(fluid.velocities).astype("<f4"),
                 fluid.ids.astype("<i4")]
        try:
            self._send(frame)
        except BaseException as error:  # an interrupt leaves half a frame
            writer, self._writer = self._writer, None
            writer.kill()
            writer.communicate()
            self._file.__exit__(type(error), error, None)
            raise

    def close(self) -> None:
        """Writes what is left, and puts the file in its place."""
        writer, self._writer = self._writer, None
        if writer:
            with self._file:
                self._end(writer)

    def __enter__(self) -> AlembicPoints:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


# ---- The surface ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Surface:
    """A mesh of triangles, with a normal at each vertex that points out of the fluid."""

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: NDArray[np.float64]

    def save(self, path: PathLike) -> None:
        """As .ply, with normals; other formats (.obj, .stl, .vtu, …) by meshio."""
        file = pathlib.Path(path)
        if file.suffix == ".ply":
            table = [*_axes(self.vertices.astype(np.float32), "x y z"),
                     *_axes(self.normals.astype(np.float32), "nx ny nz")]
            _files.replace(file, _ply(table, len(self.vertices), self.triangles))
            return
        meshio = _need("meshio", "meshio", f"a {file.suffix} file")
        data = {} if file.suffix in (".obj", ".stl") else {"normals": self.normals}
        with _files.written(file) as place:
            meshio.Mesh(self.vertices, [("triangle", self.triangles)], point_data=data).write(place)


def _smoothed(fluid: Particles, smoothing: float) -> NDArray[Any]:
    if not smoothing:
        return fluid.positions
    from .solver import Solver
    if not isinstance(fluid, Solver):
        raise InvalidArgumentError("particle_smoothing needs a Solver, which finds neighbours")
    return fluid.anisotropies(smoothing=smoothing, radius=fluid.smoothing_radius).positions


def surface(fluid: Particles, *, smoothing_length: float = 2.0, cube_size: float = 0.75,
            threshold: float = 0.6, smoothing: int = 15, particle_smoothing: float = 0.0,
            within_domain: bool = True) -> Surface:
    """The surface of a fluid in 3D, by splashsurf: marching cubes about the particles, smoothed.

    Lengths are in radii of a particle, which is half of the distance of particles. A smaller
    `cube_size` is finer and takes longer; `smoothing` is how often the mesh is smoothed.
    `particle_smoothing`, 0 … 1, first moves particles so far to the mean of those within
    `smoothing_radius` (Solver.anisotropies): bumps of single particles go, and at 1 some 0.4
    distances of particles of the fluid's outside with them.
    `within_domain` takes triangles off that are outside of the domain's walls.
    """
    splash = _need("pysplashsurf", "pysplashsurf", "a surface")
    if fluid.dimension != 3:
        raise InvalidArgumentError("a surface is of a fluid in 3D; this solver is in 2D")
    none = np.empty((0, 3))
    if fluid.count == 0:
        return Surface(none, np.empty((0, 3), np.int64), none)
    # Of float64 the library takes arrays in the order of C alone.
    points = np.ascontiguousarray(_smoothed(fluid, particle_smoothing), np.float64)
    limits: dict[str, Any] = {}
    if within_domain:
        limits = {"mesh_aabb_min": list(fluid.domain_min), "mesh_aabb_max": list(fluid.domain_max)}
    mesh, _ = splash.reconstruction_pipeline(
        points, particle_radius=fluid.rest_distance / 2, smoothing_length=smoothing_length,
        cube_size=cube_size, iso_surface_threshold=threshold, mesh_smoothing_iters=smoothing,
        mesh_smoothing_weights=smoothing > 0, mesh_cleanup=smoothing > 0, compute_normals=True,
        **limits)
    attributes = mesh.point_attributes
    return Surface(np.asarray(mesh.mesh.vertices, np.float64),
                   np.asarray(mesh.mesh.triangles, np.int64),
                   np.asarray(attributes["normals"], np.float64))
