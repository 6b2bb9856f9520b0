"""Scenes in files, in the format of pbf-bench: bench/scenes/scene.schema.json."""
from __future__ import annotations

import difflib
import json
import os
import pathlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import params as parameters
from ._errors import DataError, Error, InvalidArgumentError
from ._numbers import real, reals, uint32
from .colliders import Box, Capsule, Collider, Plane, Sphere
from .fill import fill_ball, fill_box, fill_lattice
from .params import Params
from .solver import Solver

if TYPE_CHECKING:
    from ._param_fields import ParamValues

_FOLDER = pathlib.Path(__file__).resolve().parent / "scenes"
_SHAPES: dict[str, type[Collider]] = {
    "plane": Plane, "sphere": Sphere, "capsule": Capsule, "box": Box}
_BLOCKS = {"box": ("min", "max"), "ball": ("center", "radius"), "lattice": ("first", "counts")}
_BLOCK = {"shape", "spacing", "velocity", "angular_velocity", "velocity_gradient", "within"}
_COLLIDER = {"shape", "inverted", "position", "orientation", "velocity", "angular_velocity", "axis",
             "half_extents", "radius", "half_length", "motion"}
_SCENE = {"$schema", "version", "description", "purpose", "dimension", "params", "blocks",
          "colliders", "lead_in_steps", "steps", "scaling"}
_NEEDED = ("version", "dimension", "params", "blocks", "steps")


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
    """What a file describes: particles to be, colliders and how they move, parameters.

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

    def particles(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions and velocities at the start, each of shape (count, dimension)."""
        placed = [_fill(block, self.dimension, self.spacing) for block in self.blocks]
        return (np.concatenate([x for x, _ in placed]), np.concatenate([v for _, v in placed]))

    @property
    def spacing(self) -> float:
        params = Params(**_typed(self.params))
        return params.spacing or params.smoothing_radius / 2

    def solver(self, **keywords: Any) -> SceneSolver:
        """A solver with the scene's particles. Keywords are those of `Solver`, parameters, too."""
        positions, velocities = self.particles()
        fluid = SceneSolver(positions, velocities, dimension=self.dimension,
                            **{**self.params, **keywords})
        fluid.motions = list(self.motions)
        if self.colliders:
            fluid.colliders = self.colliders
        return fluid

    def refined(self, finer: float) -> Scene:
        """The same shapes, filled with particles so many times nearer to each other; lengths of the
        discretisation and the time step in proportion, over the same simulated time."""
        if any(block["shape"] == "lattice" for block in self.blocks):
            raise InvalidArgumentError(f"{self.name} has a lattice of fixed counts")
        usual = Params(**_typed(self.params)).to_dict()
        params = dict(self.params)
        for name in ("smoothing_radius", "spacing", "search_cell_width", "time_step"):
            params[name] = usual[name] / finer
        params["particle_volume"] = usual["particle_volume"] / finer**self.dimension
        blocks = [{**block, "spacing": block["spacing"] / finer} if "spacing" in block else block
                  for block in self.blocks]
        return replace(self, params=params, blocks=blocks, steps=max(1, round(self.steps * finer)),
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
        return _scene_of(source, "scene")
    name = os.fspath(source)
    path = pathlib.Path(name)
    if path.suffix != ".json":
        if name not in scenes():
            near = difflib.get_close_matches(name, scenes(), 1)
            hint = f' did you mean "{near[0]}"?' if near else ""
            raise InvalidArgumentError(f'there is no scene "{name}";{hint} pbf.scenes() lists them, '
                                       'and a file\'s name ends in ".json"')
        path = _FOLDER / f"{name}.json"
    try:
        return _scene_of(json.loads(path.read_text(encoding="utf-8")), path.stem)
    except json.JSONDecodeError as error:
        raise DataError(f"{path}: line {error.lineno}: {error.msg}") from None
    except Error as error:
        raise DataError(f"{path}: {error}") from None


def _check_keys(where: str, given: Any, known: set[str]) -> None:
    if not isinstance(given, Mapping):
        raise DataError(f"{where} is {given!r}; it must be an object")
    for key in given:
        if key not in known:
            near = difflib.get_close_matches(str(key), known, 1)
            hint = f' did you mean "{near[0]}"?' if near else ""
            raise DataError(f'{where} has the unknown key "{key}"{hint}')


def _listed(where: str, given: Any) -> list[Any]:
    if not isinstance(given, list):
        raise DataError(f"{where} is {given!r}; it must be a list")
    return given


def _typed(values: Mapping[str, Any]) -> ParamValues:
    return values  # type: ignore[return-value]


def _scene_of(root: Any, name: str) -> Scene:
    _check_keys("the scene", root, _SCENE)
    for key in _NEEDED:
        if key not in root:
            raise DataError(f'the scene has no "{key}"')
    if root["version"] != 1 or root["dimension"] not in (2, 3):
        raise DataError(f'"version" is {root["version"]} and "dimension" {root["dimension"]}; '
                        "they must be 1, and 2 or 3")
    dimension = root["dimension"]
    _check_keys('"params"', root["params"], {*parameters.fields(), "reserved"})
    params = {key: value for key, value in root["params"].items() if key != "reserved"}
    _check_vectors(params, dimension)
    blocks = _listed('"blocks"', root["blocks"])
    scene = Scene(name, dimension, params, blocks, uint32('"steps"', root["steps"]),
                  root.get("description", ""), root.get("purpose", ""),
                  uint32('"lead_in_steps"', root.get("lead_in_steps", 0)))
    for i, block in enumerate(blocks):
        _check_block(f'"blocks"[{i}]', block, dimension)
    for i, item in enumerate(_listed('"colliders"', root.get("colliders", []))):
        collider, motion = _collider_of(f'"colliders"[{i}]', item, dimension)
        scene.colliders.append(collider)
        scene.motions.append(motion)
    return scene


def _check_vectors(params: Mapping[str, Any], dimension: int) -> None:
    parameters.write(parameters.defaults(), params, dimension)
    for key, kind in parameters.fields().items():
        count = getattr(kind, "count", None)
        if count and key in params:
            reals(f'"{key}"', params[key], (dimension * count // 3,))


def _check_block(where: str, block: Any, dimension: int) -> None:
    shape = block.get("shape") if isinstance(block, Mapping) else None
    if shape not in _BLOCKS:
        raise DataError(f'{where} has the shape {shape!r}; it must be "lattice", "box" or "ball"')
    _check_keys(where, block, _BLOCK | set(_BLOCKS[shape]))
    for key in _BLOCKS[shape]:
        if key not in block:
            raise DataError(f'{where} has no "{key}"')
        if key == "radius":
            real(f'{where}: "radius"', block[key])
        else:
            reals(f'{where}: "{key}"', block[key], (dimension,))
    _fill_velocities(block, np.zeros((1, dimension)), dimension)
    for i, region in enumerate(block.get("within", [])):
        _check_keys(f'{where}: "within"[{i}]', region, {"center", "squares", "slopes", "below"})


def _numbers(source: Mapping[str, Any], key: str, count: int) -> NDArray[np.float64]:
    return np.array(reals(f'"{key}"', source.get(key, [0.0] * count), (count,)))


def _collider_of(where: str, item: Any, dimension: int) -> tuple[Collider, list[Stretch]]:
    _check_keys(where, item, _COLLIDER)
    if item.get("shape") not in _SHAPES or "position" not in item:
        raise DataError(f'{where} needs a "position" and a "shape", one of {", ".join(_SHAPES)}')
    motion = []
    for stretch in _listed(f'{where}: "motion"', item.get("motion", [])):
        _check_keys(f'{where}: "motion"', stretch, {"duration", "velocity", "angular_velocity"})
        motion.append(Stretch(real('"duration"', stretch.get("duration")),
                              tuple(_numbers(stretch, "velocity", dimension)),
                              tuple(_numbers(stretch, "angular_velocity", 3))))
    values = {key: value for key, value in item.items() if key not in ("shape", "motion")}
    collider = _SHAPES[item["shape"]](**values)
    if motion:
        collider.velocity = motion[0].velocity
        collider.angular_velocity = motion[0].angular_velocity
    return collider, motion


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
                for row in _listed('"velocity_gradient"', block["velocity_gradient"])]
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
