"""Judges what json.load gave by bench/scenes/scene.schema.json, whose descriptions say what is wanted in
words: the keywords that it uses, and no others."""
from __future__ import annotations

import difflib
import functools
import json
import math
import pathlib
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Union

from ._errors import DataError
from ._numbers import shown

Schema = Union[bool, Mapping[str, Any]]
Path = tuple[Union[str, int], ...]


class Fault(NamedTuple):
    """What is wrong with the value at a path."""

    path: Path
    sentence: str


def read_schema(folder: pathlib.Path) -> Mapping[str, Any]:
    return _parsed(folder / "scene.schema.json")


@functools.lru_cache(maxsize=1)
def _parsed(path: pathlib.Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def check(root: Mapping[str, Any], value: Any) -> None:
    """Raises `DataError` for the innermost value that the schema refuses: outer ones fail because of
    it."""
    faults = list(_faults(root, root, value, (), str(root.get("description", ""))))
    if faults:
        raise DataError(said(*max(faults, key=lambda fault: len(fault.path))))


def said(path: Path, sentence: str) -> str:
    """A fault's sentence, with its path as pbf-bench writes it: /colliders/0/radius."""
    where = "".join(f"/{step}" for step in path)
    return f"{where}: {sentence}" if where else sentence


def near(name: str, known: Any) -> str:
    found = difflib.get_close_matches(name, list(known), 1)
    return f' (did you mean "{found[0]}"?)' if found else ""


def _shown(value: Any) -> str:
    try:
        text = json.dumps(value, ensure_ascii=False)
    except (TypeError, ValueError):
        text = shown(value)
    return text if len(text) <= 60 else text[:60] + "…"


def _is_number(value: Any) -> bool:
    try:
        return (isinstance(value, (int, float)) and not isinstance(value, bool)
                and math.isfinite(value))
    except OverflowError:  # an integer that no float holds
        return False


def _is_integer(value: Any) -> bool:
    return _is_number(value) and value == int(value)


_TYPES = {
    "object": lambda value: isinstance(value, Mapping),
    "array": lambda value: isinstance(value, list),
    "string": lambda value: isinstance(value, str),
    "boolean": lambda value: isinstance(value, bool),
    "number": _is_number,
    "integer": _is_integer,
}
_BOUNDS = {
    "minimum": lambda value, bound: not _is_number(value) or value >= bound,
    "maximum": lambda value, bound: not _is_number(value) or value <= bound,
    "exclusiveMinimum": lambda value, bound: not _is_number(value) or value > bound,
    "exclusiveMaximum": lambda value, bound: not _is_number(value) or value < bound,
    "minLength": lambda value, bound: not isinstance(value, str) or len(value) >= bound,
    "minItems": lambda value, bound: not isinstance(value, list) or len(value) >= bound,
    "maxItems": lambda value, bound: not isinstance(value, list) or len(value) <= bound,
    "const": lambda value, wanted: _same(value, wanted),
    "enum": lambda value, wanted: any(_same(value, each) for each in wanted),
    "uniqueItems": lambda value, wanted: not isinstance(value, list) or not any(
        _same(each, other) for i, each in enumerate(value) for other in value[:i]),
    "type": lambda value, names: any(
        _TYPES[name](value) for name in ([names] if isinstance(names, str) else names)),
}


def _same(value: Any, other: Any) -> bool:
    return isinstance(value, bool) == isinstance(other, bool) and bool(value == other)


def _resolved(root: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    """What a $ref stands for; a description beside it is nearer to the value."""
    if "$ref" not in schema:
        return schema
    found: Any = root
    for step in schema["$ref"].split("/")[1:]:
        found = found[step]
    return {**found, **{key: schema[key] for key in schema if key != "$ref"}}


def _faults(root: Mapping[str, Any], schema: Schema, value: Any, path: Path,
            wanted: str) -> Iterator[Fault]:
    if isinstance(schema, bool):
        return
    schema = _resolved(root, schema)
    wanted = schema.get("description", wanted)
    if not all(holds(value, schema[key]) for key, holds in _BOUNDS.items() if key in schema):
        yield Fault(path, f"the value is {_shown(value)}; wanted: {wanted}")
        return
    if isinstance(value, Mapping):
        yield from _faults_of_object(root, schema, value, path, wanted)
    if isinstance(value, list) and "items" in schema:
        for i, item in enumerate(value):
            yield from _faults(root, schema["items"], item, (*path, i), wanted)
    for part in schema.get("allOf", []):
        yield from _faults(root, part, value, path, wanted)
    if "if" in schema:
        holds = not any(_faults(root, schema["if"], value, path, wanted))
        yield from _faults(root, schema.get("then" if holds else "else", True), value, path, wanted)


def _faults_of_object(root: Mapping[str, Any], schema: Mapping[str, Any], value: Mapping[str, Any],
                      path: Path, wanted: str) -> Iterator[Fault]:
    known = schema.get("properties", {})
    for key in schema.get("required", []):
        if key not in value:
            yield Fault(path, f'"{key}" is missing; wanted: {wanted}')
    others = schema.get("additionalProperties", True)
    for key, item in value.items():
        if key in known or isinstance(others, Mapping):
            yield from _faults(root, known.get(key, others), item, (*path, key), wanted)
        elif others is False:
            yield Fault((*path, key), f'the key "{key}" does not belong here'
                        f"{near(str(key), known)}; wanted: {wanted}")
