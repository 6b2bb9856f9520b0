"""Position based fluids.

>>> import pbf
>>> fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 1, 1), 0.05), domain_max=(2, 1, 1))
>>> fluid.run(seconds=1, progress=True)
>>> fluid.save_picture("water.png")

`Solver` is a fluid, `load_scene` one that is described in a file, `fill_…` places particles. All
failures are `pbf.Error`. `pbf.lib` and `pbf.ffi` are the C API.
"""
from ._errors import (BusyError, CancelledError, CapacityError, DataError, DeviceError, Error,
                      InvalidArgumentError, MissingExtraError, NotFoundError, OutOfMemoryError,
                      PluginError, StateError, StructSizeError, UnavailableError, UnsupportedError)
from ._library import ffi, lib, version
from ._reading import Anisotropies
from .batch import Batch, BatchTensor
from .colliders import Box, Capsule, Collider, MotionPath, Plane, Shape, Solid, Sphere
from .diffuse import Diffuse, DiffuseInfo, DiffuseParticles
from .dump import Dump, DumpFrame, load_dump
from .export import AlembicPoints, Surface, UsdPoints, VtkSeries, surface, write_ply
from .emission import DiscEmitter, Emitter, InOut, RectangleEmitter, Reservoir
from .fill import fill_ball, fill_box, fill_geometry, fill_lattice
from .geometry import Geometry
from .params import Collide, Kernel, Method, Params, Periodic
from .phases import Phase
from .picture import Movie, png_bytes, render, save_png
from .queries import (BallVolume, BoxVolume, CapsuleVolume, Flow, Hits, Samples, Volume)
from .reports import (BackendInfo, Info, Limit, Load, Plan, PlanArray, PlanStage, StageTime, Stats,
                      backends, load_backend)
from .scene import Scene, SceneSolver, load_scene, scenes
from .solver import Solver
from .views import Snapshot, View

__version__ = version()

__all__ = [
    "AlembicPoints", "Anisotropies", "BackendInfo", "BallVolume", "Batch", "BatchTensor", "Box",
    "BoxVolume", "BusyError", "CancelledError", "CapacityError", "Capsule", "CapsuleVolume",
    "Collide", "Collider", "DataError", "DeviceError", "Diffuse", "DiffuseInfo",
    "DiffuseParticles", "DiscEmitter", "Dump", "DumpFrame", "Emitter", "Error", "Flow", "Geometry", "Hits", "InOut", "Info", "InvalidArgumentError",
    "Kernel", "Limit", "Load", "Method", "MissingExtraError", "MotionPath", "Movie",
    "NotFoundError", "OutOfMemoryError", "Params", "Periodic", "Phase", "Plan", "PlanArray",
    "PlanStage", "Plane",
    "PluginError", "RectangleEmitter", "Reservoir", "Samples", "Scene", "SceneSolver", "Shape", "Snapshot", "Solid",
    "Solver", "Sphere", "StageTime", "StateError", "Stats", "StructSizeError", "Surface",
    "UnavailableError", "UnsupportedError", "UsdPoints", "View", "Volume", "VtkSeries",
    "__version__", "backends", "ffi", "fill_ball", "fill_box", "fill_geometry",
    "fill_lattice", "lib",
    "load_backend", "load_dump", "load_scene", "png_bytes", "render", "save_png", "scenes",
    "surface", "version", "write_ply"]
