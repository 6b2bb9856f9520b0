"""Meshes in OBJ files (v, f, and in 2D l; all else is left out) and STL files, text or binary."""
from __future__ import annotations

import math
import os
import pathlib
import re
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _files
from ._errors import DataError

Mesh = tuple[NDArray[np.float64], NDArray[np.uint32]]


def read_mesh(path: Union[str, os.PathLike[str]], dimension: int = 3) -> Mesh:
    """Vertices, shape (count, dimension), and faces: triangles, in 2D segments."""
    path = pathlib.Path(path)
    ending = path.suffix.lower()
    if ending not in (".obj", ".stl"):
        raise DataError(f'{path} ends in "{ending}"; meshes are read from .obj and .stl files, '
                        'and shapes of pbf-bake where "from" is "baked"')
    try:
        content = _files.content(path, _files.MESH_MOST)
    except OSError as error:
        raise DataError(f"{path} can't be read: {error.strerror}") from None
    if ending == ".obj":
        return _obj(path, content.decode("utf-8-sig", "replace"), dimension)
    if dimension != 3:
        raise DataError(f"{path}: STL files hold triangles; in 2D an OBJ file with lines does")
    return _stl(path, content)


_NUMBER = re.compile(r"[0-9+\-.eE]+")  # Python has more: 1_000, inf, digits of other scripts
_INDEX = re.compile(r"[+-]?[0-9]{1,18}(/.*)?")


def _vertex(word: str, count: int) -> int:
    number = int(word.split("/")[0]) if _INDEX.fullmatch(word) else 0
    index = count + number if number < 0 else number - 1
    if number == 0 or not 0 <= index < count:
        raise DataError(f'"{word}" is none of the {count} vertices before it')
    return index


def _obj(path: pathlib.Path, text: str, dimension: int) -> Mesh:
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                vertices.append(_numbers(words[1:1 + dimension], dimension))
            elif words[:1] == [("l", "f")[dimension - 2]]:
                faces += _fan([_vertex(word, len(vertices)) for word in words[1:]], dimension)
        except DataError as error:
            raise DataError(f"{path}:{number}: {error}") from None
    if not faces:
        raise DataError(f"{path} has no {'faces' if dimension == 3 else 'lines (l)'}")
    return np.array(vertices, np.float64), np.array(faces, np.uint32)


def _number(word: str) -> float:
    try:
        number = float(word) if _NUMBER.fullmatch(word) else math.nan
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise DataError(f'"{word}" is no number')
    return number


def _numbers(words: list[str], count: int) -> list[float]:
    if len(words) != count:
        raise DataError("a vertex has too few numbers")
    return [_number(word) for word in words]


def _fan(corners: list[int], dimension: int) -> list[list[int]]:
    """Faces of more than three corners become triangles, lines their segments."""
    if len(corners) < dimension:
        raise DataError("there are too few corners")
    first = corners[:1] if dimension == 3 else []
    return [[*first, corners[i - 1], corners[i]] for i in range(dimension - 1, len(corners))]


def _stl(path: pathlib.Path, content: bytearray) -> Mesh:
    """Every triangle has its own vertices; the library joins those in one place."""
    triangles = int.from_bytes(content[80:84], "little")
    vertices: NDArray[Any]
    if triangles and len(content) == 84 + 50 * triangles:  # "solid" may stand in a binary one, too
        rows = np.frombuffer(content, np.uint8, offset=84).reshape(triangles, 50)
        vertices = np.ascontiguousarray(rows[:, 12:48]).view("<f4").reshape(-1, 3).astype(float)
    else:
        lines = [line.split() for line in content.decode("utf-8", "replace").splitlines()]
        vertices = np.array([_numbers(words[1:4], 3) for words in lines if words[:1] == ["vertex"]])
    if not len(vertices) or len(vertices) % 3:
        raise DataError(f"{path} has {len(vertices)} vertices, which make no triangles; is it an STL "
                        "file?")
    return vertices, np.arange(len(vertices), dtype=np.uint32).reshape(-1, 3)
