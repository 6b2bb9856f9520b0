"""Scenes in files, in the format of pbf-bench: bench/scenes/scene.schema.json."""
from __future__ import annotations

import json
import math
import os
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _files
from . import params as parameters
from ._errors import DataError, Error, InvalidArgumentError
from ._numbers import real, reals, uint32
from ._schema import Path, check, read_schema, said
from ._schema import near as near_name
from .colliders import Box, Capsule, Collider, MotionPath, Plane, Solid, Sphere
from .emission import DiscEmitter, Emitter, RectangleEmitter, Reservoir
from .fill import fill_ball, fill_box, fill_lattice
from .geometry import Geometry
from .meshes import read_mesh
from .params import Params
from .phases import Phase
from .queries import BallVolume, BoxVolume, CapsuleVolume, Volume
from .solver import Solver

if TYPE_CHECKING:
    from ._param_fields import ParamValues

_FOLDER = pathlib.Path(__file__).resolve().parent / "scenes"
_COLLIDERS: dict[str, type[Collider]] = {
    "plane": Plane, "sphere": Sphere, "capsule": Capsule, "box": Box, "shape": Solid}
_EMITTERS: dict[str, type[Emitter]] = {"rectangle": RectangleEmitter, "disc": DiscEmitter}
_DRAINS: dict[str, type[Volume]] = {
    "box": BoxVolume, "sphere": BallVolume, "capsule": CapsuleVolume}


def scenes() -> list[str]:
    """The names of the scenes that come with the package, for `load_scene`."""
    files = [*_FOLDER.glob("*.json"), *_FOLDER.glob("validation/*.json")]
    names = (file.relative_to(_FOLDER).with_suffix("").as_posix() for file in files)
    return sorted(name for name in names if not name.endswith(".schema"))


@dataclass(frozen=True)
class Stretch:
    """A collider's velocities for a while; stretches are played over and over."""

    duration: float
    velocity: tuple[float, ...]
    angular_velocity: tuple[float, ...]


@dataclass
class Scene:
    """What a file describes: particles to be, colliders and how they move, emitters, drains and
    reservoirs, parameters.

    >>> scene = pbf.load_scene("dam-break-3d")
    >>> fluid = scene.solver(backend="serial")
    >>> fluid.step(scene.steps)
    """

    name: str
    dimension: int
    params: dict[str, Any]
    blocks: list[dict[str, Any]]
    steps: int
    description: str = ""
    purpose: str = ""
    lead_in_steps: int = 0
    colliders: list[Collider] = field(default_factory=list)
    motions: list[list[Stretch]] = field(default_factory=list)
    phases: list[Phase] = field(default_factory=list)
    shapes: dict[str, dict[str, Any]] = field(default_factory=dict)
    """What the solids of colliders are made from, by their names."""
    geometries: dict[int, str] = field(default_factory=dict)
    """The names of the shapes that colliders have, by their places in the list."""
    emitters: list[Emitter] = field(default_factory=list)
    drains: list[Volume] = field(default_factory=list)
    reservoirs: list[Reservoir] = field(default_factory=list)
    capacity: int = 0
    """Room for so many particles; 0: for those of the blocks and of emitters over the steps."""

    def particles(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities at the start, each of shape (count, dimension)."""
        placed = [_fill(block, self.dimension, self.spacing) for block in self.blocks]
        none = np.zeros((0, self.dimension))  # where emitters bring all
        return (np.concatenate([none, *(x for x, _ in placed)]),
                np.concatenate([none, *(v for _, v in placed)]))

    @property
    def spacing(self) -> float:
        params = Params(**_typed(self.params))
        return params.spacing or params.smoothing_radius / 2

    def solver(self, **keywords: Any) -> SceneSolver:
        """A solver with the scene's particles. Keywords are those of `Solver`, parameters, too."""
        positions, velocities = self.particles()
        keywords.setdefault("capacity", self._capacity(len(positions)))
        fluid = SceneSolver(None, dimension=self.dimension, **{**self.params, **keywords})
        fluid.motions = list(self.motions)
        if self.phases:
            fluid.phases = self.phases
        if len(positions):
            fluid.add(positions, velocities)
        if self.phases and len(positions):
            fluid.particle_phases = self.particle_phases()
        if self.colliders:
            fluid.colliders = self._with_geometries()
        if self.emitters:
            fluid.emitters = self.emitters
        if self.drains:
            fluid.drains = self.drains
        if self.reservoirs:
            fluid.reservoirs = self.reservoirs
        return fluid

    def particle_phases(self) -> NDArray[np.uint32]:
        """The number of each particle's phase at the start."""
        counts = [len(_fill(block, self.dimension, self.spacing)[0]) for block in self.blocks]
        return np.repeat([block.get("phase", 0) for block in self.blocks], counts).astype(np.uint32)

    def _with_geometries(self) -> list[Collider]:
        made = {name: _geometry(name, shape, self.dimension) for name, shape in self.shapes.items()}
        return [replace(collider, geometry=made[self.geometries[i]]) if i in self.geometries
                else collider for i, collider in enumerate(self.colliders)]

    def _capacity(self, placed: int) -> int:
        """As pbf-bench has it: what emitters add in all steps, but no more than the domain holds."""
        if self.capacity:
            return self.capacity
        usual = Params(**_typed(self.params)).to_dict()
        time = (self.lead_in_steps + self.steps) * usual["time_step"]
        emitted, cell = 0.0, self.spacing**self.dimension
        for emitter in self.emitters:
            lasts = min(emitter.lifetime or time, time)
            emitted += math.ceil(_rate(emitter, self.dimension, self.spacing) * lasts / cell) + 1
        sides = np.subtract(usual["domain_max"], usual["domain_min"])[:self.dimension] + self.spacing
        held = max(math.ceil(1.25 * float(np.prod(sides)) / cell), placed)
        if self.reservoirs:
            return max(1, held)
        return max(1, min(placed + int(min(emitted, 2**30)), held))

    def refined(self, finer: float) -> Scene:
        """The same shapes, filled with particles so many times nearer to each other; lengths of the
        discretisation and the time step in proportion, over the same simulated time. Cells of the
        shapes' distances become finer with it, and never coarser."""
        if any(block["shape"] == "lattice" for block in self.blocks):
            raise InvalidArgumentError(f"{self.name} has a lattice of fixed counts")
        usual = Params(**_typed(self.params)).to_dict()
        params = dict(self.params)
        for name in ("smoothing_radius", "spacing", "search_cell_width", "time_step"):
            params[name] = usual[name] / finer
        params["particle_volume"] = usual["particle_volume"] / finer**self.dimension
        blocks = [{**block, "spacing": block["spacing"] / finer} if "spacing" in block else block
                  for block in self.blocks]
        shapes = {name: shape if shape["from"] == "grid" else
                  {**shape, "cell": shape["cell"] / max(finer, 1.0)}
                  for name, shape in self.shapes.items()}
        capacity = math.ceil(self.capacity * finer**self.dimension)
        return replace(self, params=params, blocks=blocks, shapes=shapes, capacity=capacity, steps=max(1, round(self.steps * finer)),
                       lead_in_steps=round(self.lead_in_steps * finer))


class SceneSolver(Solver):
    """A solver whose colliders move as its scene says, in steps of the scene's length."""

    motions: list[list[Stretch]] = []

    def step(self, steps: int = 1) -> None:
        left = uint32("steps", steps)
        while left:
            until = min([left, *self._steps_to_turns()])
            super().step(until)
            left -= until
            self._turn()

    def begin_step(self, steps: int = 1) -> None:
        until = min([uint32("steps", steps), *self._steps_to_turns()])
        if steps > until:
            raise InvalidArgumentError(
                f"steps is {steps}; colliders of this scene turn after {until}: begin no more")
        super().begin_step(steps)

    def end_step(self) -> None:
        super().end_step()
        self._turn()

    def _lengths(self, motion: Sequence[Stretch]) -> list[int]:
        return [max(1, round(stretch.duration / self.time_step)) for stretch in motion]

    def _place(self, motion: Sequence[Stretch]) -> tuple[int, int]:
        """The stretch that the next step belongs to, and how many steps are left of it."""
        lengths = self._lengths(motion)
        into, index = self.steps_done % sum(lengths), 0
        while into >= lengths[index]:
            into -= lengths[index]
            index += 1
        return index, lengths[index] - into

    def _steps_to_turns(self) -> Iterator[int]:
        for motion in self.motions:
            if len(motion) > 1:
                yield self._place(motion)[1]

    def _turn(self) -> None:
        moving = [motion for motion in self.motions if len(motion) > 1]
        if not any(self._place(each)[1] == self._lengths(each)[self._place(each)[0]]
                   for each in moving):
            return
        now = self.colliders
        for collider, motion in zip(now, self.motions):
            if motion:
                stretch = motion[self._place(motion)[0]]
                collider.velocity = stretch.velocity
                collider.angular_velocity = stretch.angular_velocity
        self.colliders = now


# ---- Reading -------------------------------------------------------------------------------------


def load_scene(source: Union[str, os.PathLike[str], Mapping[str, Any]]) -> Scene:
    """A scene by its name (see `scenes`), from a file, or from what json.load gave of one."""
    if isinstance(source, Mapping):
        return _scene_of(source, "scene", pathlib.Path())
    name = os.fspath(source)
    path = pathlib.Path(name)
    if path.suffix != ".json":
        if name not in scenes():
            raise InvalidArgumentError(f'there is no scene "{name}"{near_name(name, scenes())}; '
                                       'pbf.scenes() lists them, and a file\'s name ends in ".json"')
        path = _FOLDER / f"{name}.json"
    data = _files.content(path, _files.SCENE_MOST)
    try:
        return _scene_of(_parsed(data), path.stem, path.parent)
    except Error as error:
        raise DataError(f"{path}: {error}") from None


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of a file, in which Python would take the last of two values of a key."""
    item = dict(pairs)
    if len(item) < len(pairs):
        twice = next(key for i, (key, _) in enumerate(pairs) if key in dict(pairs[:i]))
        raise DataError(f"the key {json.dumps(twice)} stands twice in one object")
    return item


def _parsed(data: bytearray) -> Any:
    """Of whatever bytes a file holds."""
    try:
        return json.loads(data.decode("utf-8-sig"), object_pairs_hook=_once)
    except json.JSONDecodeError as error:
        raise DataError(f"line {error.lineno}: {error.msg}") from None
    except UnicodeDecodeError as error:
        raise DataError(f"byte {error.start} is not of a text in UTF-8") from None
    except RecursionError:
        raise DataError("it is nested far deeper than a scene is") from None
    except Error:
        raise
    except ValueError:  # of integers of thousands of digits
        raise DataError("a number has more digits than Python reads") from None


def _typed(values: Mapping[str, Any]) -> ParamValues:
    return values  # type: ignore[return-value]


def _scene_of(root: Any, name: str, folder: pathlib.Path) -> Scene:
    check(read_schema(_FOLDER), root)
    dimension = root["dimension"]
    params = {key: value for key, value in root["params"].items() if key != "reserved"}
    _check_vectors(params, dimension)
    scene = Scene(name, dimension, params, list(root["blocks"]), int(root["steps"]),
                  root["description"], root["purpose"], int(root.get("lead_in_steps", 0)),
                  phases=[Phase(**each) for each in root.get("phases", [])],
                  shapes={key: _with_file(key, shape, dimension, folder)
                          for key, shape in root.get("shapes", {}).items()},
                  capacity=int(root.get("capacity", 0)))
    for i, block in enumerate(scene.blocks):
        _check_block(("blocks", i), block, scene)
    for i, item in enumerate(root.get("colliders", [])):
        _add_collider(("colliders", i), item, scene)
    for i, item in enumerate(root.get("emitters", [])):
        _check_phase(("emitters", i), item, scene)
        scene.emitters.append(_object_of(("emitters", i), item, dimension, _EMITTERS))
    scene.drains = [_object_of(("drains", i), item, dimension, _DRAINS)
                    for i, item in enumerate(root.get("drains", []))]
    for i, item in enumerate(root.get("reservoirs", [])):
        _check_lengths(("reservoirs", i), item, dimension)
        _check_phase(("reservoirs", i), item, scene)
        scene.reservoirs.append(Reservoir(**item))
    return scene


def _check_vectors(params: Mapping[str, Any], dimension: int) -> None:
    parameters.write(parameters.defaults(), params, dimension)
    for key, kind in parameters.fields().items():
        count = getattr(kind, "count", None)
        if count and key in params:
            reals(f'"{key}"', params[key], (dimension * count // 3,))


_VECTORS = ("first", "counts", "min", "max", "center", "velocity", "position", "axis", "half_extents",
            "half_extents_rate", "origin", "nodes")


def _check_lengths(path: Path, item: Mapping[str, Any], dimension: int) -> None:
    """A vector has one number an axis, which the schema alone can't know."""
    for key in _VECTORS:
        if key in item and len(item[key]) != dimension:
            raise DataError(said((*path, key), f"the list has {len(item[key])} numbers; this scene's "
                                               f"dimension wants {dimension}"))


def _check_phase(path: Path, item: Mapping[str, Any], scene: Scene) -> None:
    if item.get("phase", 0) >= max(len(scene.phases), 1):
        raise DataError(said((*path, "phase"), f"the value is {item['phase']}; the scene has "
                                               f"{len(scene.phases)} phases, counted from 0"))


def _check_block(path: Path, block: Mapping[str, Any], scene: Scene) -> None:
    _check_lengths(path, block, scene.dimension)
    _check_phase(path, block, scene)
    _fill_velocities(block, np.zeros((1, scene.dimension)), scene.dimension)


def _object_of(path: Path, item: Mapping[str, Any], dimension: int,
               kinds: Mapping[str, type[Any]]) -> Any:
    """The object of the class that its shape says, whose attributes have the keys' names."""
    _check_lengths(path, item, dimension)
    values = {key: value for key, value in item.items()
              if key not in ("shape", "motion", "geometry")}
    if "path" in values:
        values["path"] = MotionPath[values["path"].upper()]
    return kinds[item["shape"]](**values)


def _numbers(source: Mapping[str, Any], key: str, count: int) -> NDArray[np.float64]:
    return np.array(reals(f'"{key}"', source.get(key, [0.0] * count), (count,)))


def _add_collider(path: Path, item: Mapping[str, Any], scene: Scene) -> None:
    collider, motion = _object_of(path, item, scene.dimension, _COLLIDERS), []
    for i, stretch in enumerate(item.get("motion", [])):
        _check_lengths((*path, "motion", i), stretch, scene.dimension)
        motion.append(Stretch(real('"duration"', stretch["duration"]),
                              tuple(_numbers(stretch, "velocity", scene.dimension)),
                              tuple(_numbers(stretch, "angular_velocity", 3))))
    if motion:
        collider.velocity = motion[0].velocity
        collider.angular_velocity = motion[0].angular_velocity
    name = item.get("geometry")
    if name is not None and name not in scene.shapes:
        raise DataError(said((*path, "geometry"), f'there is no shape "{name}"'
                             f'{near_name(name, scene.shapes)}; the scene\'s "shapes" has them by '
                             "their names"))
    if name is not None:
        scene.geometries[len(scene.colliders)] = name
    scene.colliders.append(collider)
    scene.motions.append(motion)


def _with_file(name: str, shape: Mapping[str, Any], dimension: int,
               folder: pathlib.Path) -> dict[str, Any]:
    """The same with what its file holds: vertices and faces, or distances."""
    _check_lengths(("shapes", name), shape, dimension)
    if "file" not in shape:
        return dict(shape)
    path = folder / shape["file"]
    try:
        if shape["from"] == "baked":
            return _baked(path, dimension)
        vertices, faces = read_mesh(path, dimension)
    except Error as error:
        raise DataError(said(("shapes", name, "file"), str(error))) from None
    kept = {key: value for key, value in shape.items() if key != "file"}
    return {**kept, "vertices": vertices, "faces": faces}


def _baked(path: pathlib.Path, dimension: int) -> dict[str, Any]:
    """The grid of distances that pbf-bake or Geometry.save wrote."""
    try:
        baked = Geometry.load(path)
    except OSError as error:
        raise DataError(f"{path} can't be read: {error.strerror}") from None
    except Error as error:
        raise DataError(f"{path}: {error}") from None
    if baked.dimension != dimension:
        raise DataError(f"{path} holds a shape of dimension {baked.dimension}; the scene has "
                        f"{dimension}")
    values = baked.values
    return {"from": "grid", "nodes": list(values.shape), "origin": list(baked.origin),
            "values": values.ravel(order="F"), "cell": baked.cell}


def _geometry(name: str, shape: Mapping[str, Any], dimension: int) -> Geometry:
    cell = shape["cell"]
    try:
        if shape["from"] == "mesh":
            return Geometry.from_mesh(_rows(shape["vertices"], dimension),
                                      _rows(shape["faces"], dimension), cell=cell,
                                      thickness=shape.get("thickness", 0.0))
        if shape["from"] == "points":
            return Geometry.from_points(_rows(shape["points"], dimension), cell=cell)
        if shape["from"] == "heights":
            # The file has a list along x for each z, the library's arrays x first.
            return Geometry.from_heights(_rows(shape["heights"], None if dimension == 3 else 0).T,
                                         spacing=shape["spacing"], base=shape["base"], cell=cell)
        values = np.array(shape["values"], float)
        if values.size != np.prod(shape["nodes"]):
            raise DataError(f"the list has {values.size} numbers; the nodes are "
                            f"{np.prod(shape['nodes'])}")
        return Geometry.from_grid(values.reshape(shape["nodes"], order="F"), shape["origin"], cell)
    except Error as error:
        raise DataError(said(("shapes", name), str(error))) from None


def _rows(lists: Any, length: int | None) -> NDArray[Any]:
    """Rows of `length` numbers; None: all as long as the first; 0: numbers, no rows."""
    if isinstance(lists, np.ndarray):
        return lists
    wanted = len(lists[0]) if length is None and isinstance(lists[0], list) else length
    for each in lists:
        if (len(each) if isinstance(each, list) else 0) != wanted:
            raise DataError(f"a list has {each!r}; wanted: rows of {wanted} numbers")
    return np.array(lists)


def _rate(emitter: Emitter, dimension: int, spacing: float) -> float:
    """No more volume a time unit than its columns carry, of which a side has one at least."""
    if emitter.rate > 0:
        return emitter.rate
    if isinstance(emitter, RectangleEmitter):
        sides = (emitter.half_width, emitter.half_height)
    else:
        sides = (emitter.radius,) * 2  # type: ignore[attr-defined]
    area = float(np.prod([2 * side + spacing for side in sides[:dimension - 1]]))
    return area * float(np.linalg.norm(np.array(emitter.velocity)[:dimension]))


def _points(block: Mapping[str, Any], spacing: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """The block's points and its middle, regions aside."""
    if block["shape"] == "ball":
        return fill_ball(block["center"], block["radius"], spacing), np.array(block["center"], float)
    if block["shape"] == "box":
        points = fill_box(block["min"], block["max"], spacing)
    else:
        points = fill_lattice(block["first"], block["counts"], spacing)
    if not len(points):
        return points, np.zeros(points.shape[1])
    return points, (points.min(axis=0) + points.max(axis=0)) / 2


def _inside(region: Mapping[str, Any], points: NDArray[Any]) -> NDArray[np.bool_]:
    dimension = points.shape[1]
    r = points - _numbers(region, "center", dimension)
    squares, slopes = _numbers(region, "squares", dimension), _numbers(region, "slopes", dimension)
    below: NDArray[np.bool_] = ((squares * r + slopes) * r).sum(axis=1) < real(
        '"below"', region.get("below"))
    return below


def _fill_velocities(block: Mapping[str, Any], offsets: NDArray[Any],
                     dimension: int) -> NDArray[np.float64]:
    velocities = np.broadcast_to(_numbers(block, "velocity", dimension), offsets.shape).copy()
    spin = np.zeros((len(offsets), 3))
    spin[:, :dimension] = offsets
    turned = np.cross(_numbers(block, "angular_velocity", 3), spin)
    velocities += turned[:, :dimension]
    if "velocity_gradient" in block:
        rows = [reals('"velocity_gradient"', row, (dimension,))
                for row in block["velocity_gradient"]]
        if len(rows) != dimension:
            raise DataError(f'"velocity_gradient" has {len(rows)} rows; wanted: {dimension}')
        velocities += offsets @ np.array(rows).T
    return velocities


def _fill(block: Mapping[str, Any], dimension: int,
          spacing: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points, middle = _points(block, real('"spacing"', block.get("spacing", spacing)))
    for region in block.get("within", []):
        points = points[_inside(region, points)]
    return points, _fill_velocities(block, points - middle, dimension)
