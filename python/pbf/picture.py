"""Pictures of particles: shaded balls, by NumPy alone, and files of them.

An orthographic camera; a depth buffer, which balls, the edges of the domain and the colliders share.
"""
from __future__ import annotations

import os
import pathlib
import struct
import zlib
from collections.abc import Iterable
from types import TracebackType
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from ._errors import InvalidArgumentError, MissingExtraError
from ._numbers import real, reals
from . import _drawn_solids, _files
from .colliders import Box, Capsule, Collider, Solid, Sphere

if TYPE_CHECKING:
    from .solver import Solver

Vector = NDArray[np.float64]
Image = NDArray[np.uint8]

_BACKGROUND = np.array([247.0, 249.0, 252.0])
_EDGE = np.array([150.0, 158.0, 170.0])
_SOLID = np.array([196.0, 150.0, 96.0])
_RAMP = np.array([[16, 62, 138], [26, 116, 196], [72, 176, 222], [166, 222, 240], [248, 252, 255]],
                 float)
_LIGHT = np.array([-0.4, 0.75, -0.53])  # right, up, into the picture


class _Camera:
    """Axes of the picture (right, up, into it), and how a point becomes a pixel."""

    def __init__(self, lower: Vector, upper: Vector, size: tuple[int, int], flat: bool,
                 azimuth: float, elevation: float, up: Vector) -> None:
        self.width, self.height = size
        self.axes = np.eye(3) if flat else _axes(np.radians(azimuth), np.radians(elevation), up)
        corners = np.array([[(lower, upper)[i >> k & 1][k] for k in range(3)] for i in range(8)])
        seen = corners @ self.axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        extent = np.maximum(high - low, 1e-300)
        self.scale = 0.94 * min(self.width / extent[0], self.height / extent[1])
        self.middle = (low + high) / 2
        self.corners = corners

    def project(self, points: Vector) -> Vector:
        """Pixels right, pixels down, and depth in pixels."""
        seen = (points @ self.axes.T - self.middle) * self.scale
        return seen * [1, -1, 1] + [self.width / 2, self.height / 2, 0]


def _axes(azimuth: float, elevation: float, up: Vector) -> Vector:
    """Looks down by `elevation` from a place `azimuth` to the right of the front."""
    side = np.array([1.0, 0, 0]) if abs(up[0]) < 0.9 else np.array([0.0, 1, 0])
    front = np.cross(side, up)  # out of the picture, towards the one who looks
    back = -front / np.linalg.norm(front)
    side = np.cross(back, up)
    level = np.cos(azimuth) * back - np.sin(azimuth) * side
    right = np.cross(level, up)
    into = np.cos(elevation) * level - np.sin(elevation) * up
    return np.array([right, np.cross(right, into), into])


class _Canvas:
    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.colour = np.empty((height * width, 3))
        self.colour[:] = _BACKGROUND
        self.depth = np.full(height * width, np.inf)

    def balls(self, points: Vector, radius: float, colours: Vector) -> None:
        """One pixel of all balls after another. Far ones come first: of several balls in one pixel
        the last that is written, the nearest, remains."""
        order = np.argsort(-points[:, 2], kind="stable")
        points, colours = points[order], colours[order]
        column, row = np.rint(points[:, 0]).astype(int), np.rint(points[:, 1]).astype(int)
        reach = int(radius)
        light = _LIGHT / np.linalg.norm(_LIGHT)
        for dy in range(-reach, reach + 1):
            for dx in range(-reach, reach + 1):
                square = radius * radius - dx * dx - dy * dy
                if square >= 0:
                    bulge = np.sqrt(square)
                    lit = max(0.0, float(np.dot([dx, -dy, -bulge], light)) / max(radius, 1e-9))
                    self._dots(column + dx, row + dy, points[:, 2] - bulge,
                               colours * (0.5 + 0.5 * lit))

    def _dots(self, column: NDArray[Any], row: NDArray[Any], depth: Vector, colours: Vector) -> None:
        seen = (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
        pixel = row[seen] * self.width + column[seen]
        depth, colours = depth[seen], colours[seen]
        near = depth < self.depth[pixel]
        self.depth[pixel[near]] = depth[near]
        self.colour[pixel[near]] = colours[near]

    def line(self, start: Vector, end: Vector) -> None:
        count = 2 + int(2 * np.abs(end - start)[:2].max())
        along = start + (end - start) * np.linspace(0, 1, count)[:, None]
        colours = np.broadcast_to(_EDGE, along.shape)
        for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
            self._dots(np.rint(along[:, 0]).astype(int) + dx, np.rint(along[:, 1]).astype(int) + dy,
                       along[:, 2], colours)

    def surface(self, pixel: NDArray[Any], depth: Vector, normals: Vector, axes: Vector) -> None:
        """A solid, by the depth of these pixels (infinite: not there) and its normals in space."""
        near = depth < self.depth[pixel]
        seen = normals[near] @ axes.T
        lit = np.maximum(0, seen @ (_LIGHT / np.linalg.norm(_LIGHT)))
        self.depth[pixel[near]] = depth[near]
        self.colour[pixel[near]] = _SOLID * (0.55 + 0.45 * lit[:, None])


def _rays(camera: _Camera, center: Vector, radius: float) -> tuple[NDArray[Any], Vector]:
    """The pixels that a ball about `center` may be in, and a point of each one's ray, at depth 0."""
    column, row = camera.project(center)[:2]
    reach = radius * camera.scale + 1
    rows = np.arange(max(0, int(row - reach)), min(camera.height, int(row + reach) + 2))
    columns = np.arange(max(0, int(column - reach)), min(camera.width, int(column + reach) + 2))
    y, x = (grid.reshape(-1) for grid in np.meshgrid(rows, columns, indexing="ij"))
    seen = np.stack([(x - camera.width / 2) / camera.scale, (camera.height / 2 - y) / camera.scale,
                     np.zeros(len(x))], axis=1)
    return y * camera.width + x, (seen + camera.middle) @ camera.axes


def _hit_ball(start: Vector, into: Vector, center: Vector, radius: float) -> tuple[Vector, Vector]:
    """How far along each ray it meets the ball, and the normal there."""
    offset = start - center
    along = offset @ into
    square = along**2 - (offset**2).sum(axis=1) + radius**2
    distance = np.where(square >= 0, -along - np.sqrt(np.maximum(square, 0)), np.inf)
    place = offset + np.where(square >= 0, distance, 0)[:, None] * into
    return distance, place / radius


def _rotation(quaternion: Any) -> Vector:
    x, y, z, w = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def _hit_box(start: Vector, into: Vector, center: Vector, half: Vector,
             turn: Vector) -> tuple[Vector, Vector]:
    local, way = (start - center) @ turn, into @ turn
    way = np.where(np.abs(way) < 1e-12, 1e-12, way)
    one, other = (-half - local) / way, (half - local) / way
    first, last = np.minimum(one, other), np.maximum(one, other).min(axis=1)
    distance = np.where(first.max(axis=1) <= last, first.max(axis=1), np.inf)
    face = first.argmax(axis=1)
    normals = np.eye(3)[face] * -np.sign(way[face])[:, None]
    return distance, normals @ turn.T


def _hit(collider: Collider, start: Vector, into: Vector) -> tuple[Vector, Vector]:
    center, turn = _three(collider.position), _rotation(collider.orientation)
    if isinstance(collider, Box):
        return _hit_box(start, into, center, _three(collider.half_extents, 1.0), turn)
    if isinstance(collider, Sphere):
        return _hit_ball(start, into, center, collider.radius)
    if isinstance(collider, Solid):
        return _hit_solid(start, into, center, collider, turn)
    axis = turn @ _three(collider.axis)
    return _hit_capsule(start, into, center, axis / max(float(np.linalg.norm(axis)), 1e-300),
                        collider.radius, collider.half_length)


def _hit_solid(start: Vector, into: Vector, center: Vector, solid: Solid,
               turn: Vector) -> tuple[Vector, Vector]:
    assert solid.geometry is not None  # a solver's has one
    local = (start - center) @ turn / solid.scale
    distance, normals = _drawn_solids.hit(solid.geometry, local, into @ turn)
    return distance * solid.scale, normals @ turn.T


def _hit_capsule(start: Vector, into: Vector, center: Vector, axis: Vector, radius: float,
                 half: float) -> tuple[Vector, Vector]:
    """The nearest of its two balls and of the cylinder between them."""
    offset = start - center
    way = into - (into @ axis) * axis
    across = offset - (offset @ axis)[:, None] * axis
    a, b = max(float(way @ way), 1e-12), across @ way
    square = b * b - a * ((across**2).sum(axis=1) - radius**2)
    distance = (-b - np.sqrt(np.maximum(square, 0))) / a
    place = offset + distance[:, None] * into
    along = place @ axis
    distance[(square < 0) | (np.abs(along) > half)] = np.inf
    normals = (place - along[:, None] * axis) / radius
    for end in (-half, half):
        found, its = _hit_ball(start, into, center + end * axis, radius)
        near = found < distance
        distance[near], normals[near] = found[near], its[near]
    return distance, normals


def _reach(collider: Collider) -> float:
    """The radius of a ball about its position that it is in."""
    if isinstance(collider, Box):
        return float(np.linalg.norm(_three(collider.half_extents, 1.0)))
    if isinstance(collider, Solid) and collider.geometry is not None:
        return _drawn_solids.reach(collider.geometry, collider.scale)
    return collider.radius + (collider.half_length if isinstance(collider, Capsule) else 0)


def _three(values: Any, third: float = 0.0) -> Vector:
    return np.array([*values, third][:3], float)


def _colours(values: NDArray[Any], limits: tuple[float, float] | None) -> Vector:
    low, high = limits or (float(values.min()), float(values.max()))
    share = np.clip((values - low) / max(high - low, 1e-300), 0, 1) * (len(_RAMP) - 1)
    return np.stack([np.interp(share, range(len(_RAMP)), _RAMP[:, k]) for k in range(3)], axis=1)


def _values(fluid: Solver, colour: str | NDArray[Any]) -> NDArray[Any]:
    if not isinstance(colour, str):
        values = np.asarray(colour, float).reshape(-1)
        if len(values) != fluid.count:
            raise InvalidArgumentError(f"colour has {len(values)} values for {fluid.count} particles")
        return values
    if colour == "speed":
        return np.linalg.norm(fluid.velocities.astype(float), axis=1)
    if colour == "height":
        return fluid.positions.astype(float) @ _up_of(fluid)[:fluid.dimension]
    if colour in ("density", "pressure"):
        return fluid.read(colour).astype(float)
    raise InvalidArgumentError(f'colour is "{colour}"; it must be "speed", "height", "density", '
                               '"pressure" or an array of one number a particle')


def _up_of(fluid: Solver) -> Vector:
    """The axis that gravity points against, or y."""
    gravity, up = _three(fluid.gravity), np.zeros(3)
    axis = int(np.abs(gravity).argmax()) if gravity.any() else 1
    up[axis] = 1 if gravity[axis] <= 0 else -1
    return up


def _edges(corners: Vector) -> Iterable[tuple[Vector, Vector]]:
    for i in range(8):
        for k in range(3):
            if not i >> k & 1:
                yield corners[i], corners[i | 1 << k]


def render(fluid: Solver, size: tuple[int, int] = (800, 600), *,
           colour: str | NDArray[Any] = "speed", limits: tuple[float, float] | None = None,
           azimuth: float = 25.0, elevation: float = 18.0, radius: float | None = None,
           colliders: bool = True) -> Image:
    """A picture of a solver's particles, domain and colliders, of shape (height, width, 3).

    colour     "speed", "height", "density", "pressure", or an array of one number a particle
    limits     what is dark and what is light, for pictures that belong together
    azimuth, elevation  degrees from the front to the right, and up
    radius     of the balls; half of the particles' distance unless told
    Planes and containers are not drawn.
    """
    width, height = (int(side) for side in reals("size", size, (2,)))
    if not (1 <= width <= 16384 and 1 <= height <= 16384):
        raise InvalidArgumentError(f"size is {size}; both must be 1 … 16384")
    flat = fluid.dimension == 2
    lower, upper = _three(fluid.domain_min), _three(fluid.domain_max)
    camera = _Camera(lower, upper, (2 * width, 2 * height), flat, azimuth, elevation, _up_of(fluid))
    canvas = _Canvas(2 * width, 2 * height)
    for start, end in _edges(camera.project(camera.corners)):
        canvas.line(start, end)
    solids = [each for each in fluid.colliders if not each.inverted
              and isinstance(each, (Box, Sphere, Capsule, Solid))] if colliders else []
    for solid in solids:
        pixel, start = _rays(camera, _three(solid.position), _reach(solid))
        distance, normals = _hit(solid, start, camera.axes[2])
        canvas.surface(pixel, distance * camera.scale, normals, camera.axes)
    if fluid.count:
        points = np.zeros((fluid.count, 3))
        points[:, :fluid.dimension] = fluid.positions
        usual = fluid.rest_distance * (0.6 if flat else 0.5)
        ball = (usual if radius is None else radius) * camera.scale
        canvas.balls(camera.project(points), min(max(ball, 1.0), 200.0),
                     _colours(_values(fluid, colour), limits))
    image = canvas.colour.reshape(height, 2, width, 2, 3).mean(axis=(1, 3))
    return np.clip(image + 0.5, 0, 255).astype(np.uint8)


# ---- Files ---------------------------------------------------------------------------------------


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _header(image: Image) -> bytes:
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
        raise InvalidArgumentError(
            f"the image has shape {image.shape} of {image.dtype}; wanted: (height, width, 3), uint8")
    return _chunk(b"IHDR", struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 2, 0, 0, 0))


def _pixels(image: Image) -> bytes:
    rows = image.reshape(len(image), -1)
    return zlib.compress(np.insert(rows, 0, 0, axis=1).tobytes(), 6)


_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def png_bytes(image: Image) -> bytes:
    """An image of shape (height, width, 3) as a PNG file's bytes."""
    return _SIGNATURE + _header(image) + _chunk(b"IDAT", _pixels(image)) + _chunk(b"IEND", b"")


def save_png(path: Union[str, os.PathLike[str]], image: Image) -> None:
    _files.replace(path, png_bytes(image))


class Movie:
    """Pictures that move, in a file: .png (animated, as browsers show it; needs nothing) or .gif
    (by Pillow).

    >>> with pbf.Movie("water.png", fps=30) as movie:
    ...     for frame in fluid.frames(60, steps=4):
    ...         movie.add(fluid)
    """

    def __init__(self, path: Union[str, os.PathLike[str]], fps: float = 30,
                 size: tuple[int, int] = (640, 480), **options: Any) -> None:
        self.path = pathlib.Path(path)
        self.fps, self.size, self.options = real("fps", fps), size, options
        if not 0 < self.fps <= 1000:
            raise InvalidArgumentError(f"fps is {fps}; it must be above 0, and at most 1000")
        self._frames: list[Image] = []
        if self.path.suffix not in (".png", ".apng", ".gif"):
            raise InvalidArgumentError(f'{self.path.name}: a movie is a ".png" or a ".gif"')
        if self.path.suffix == ".gif":
            _pillow()

    def add(self, frame: Solver | Image) -> None:
        """A solver's present state, or an image."""
        image = frame if isinstance(frame, np.ndarray) else frame.render(self.size, **self.options)
        _header(image)
        self._frames.append(image)

    def close(self) -> None:
        """Writes the file."""
        if not self._frames:
            return
        if self.path.suffix == ".gif":
            first, *others = [_pillow().fromarray(image) for image in self._frames]
            with _files.written(self.path) as place:
                first.save(place, save_all=True, append_images=others, loop=0,
                           duration=round(1000 / self.fps))
        else:
            _files.replace(self.path, _animated(self._frames, self.fps))
        self._frames = []

    def __enter__(self) -> Movie:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


def _pillow() -> Any:
    try:
        from PIL import Image as pillow
    except ImportError:
        raise MissingExtraError("a .gif is written by Pillow, which is not installed: "
                                "pip install pillow. A .png moves without it") from None
    return pillow


def _animated(frames: list[Image], fps: float) -> bytes:
    """An animated PNG: https://www.w3.org/TR/png-3/#apng-frame-based-animation"""
    height, width = frames[0].shape[:2]
    delay = max(1, round(1000 / fps))
    parts = [_SIGNATURE, _header(frames[0]), _chunk(b"acTL", struct.pack(">II", len(frames), 0))]
    number = 0
    for index, image in enumerate(frames):
        control = struct.pack(">IIIIIHHBB", number, width, height, 0, 0, delay, 1000, 0, 0)
        parts.append(_chunk(b"fcTL", control))
        number += 1
        if index == 0:
            parts.append(_chunk(b"IDAT", _pixels(image)))
        else:
            parts.append(_chunk(b"fdAT", struct.pack(">I", number) + _pixels(image)))
            number += 1
    return b"".join([*parts, _chunk(b"IEND", b"")])
