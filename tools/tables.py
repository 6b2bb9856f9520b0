#!/usr/bin/env python3
"""Writes what follows from the tables in backends/physics and bench/scene (*.def) and is no C:

    tools/tables.py            writes it
    tools/tables.py --check    fails where a file is not as it would be written

    docs/parameters.md             the parameter reference, whole
    docs/defaults.md               the parameters' defaults
    docs/building.md               the features that a build may be without
    bench/scenes/scene.schema.json the properties of a scene's params, and its phases, colliders,
                                   emitters, drains, reservoirs and shapes, by which programs and the Python
                                   package read scenes
    python/pbf/_param_fields.py    the parameters as attributes of the Python package
"""
import argparse
import difflib
import json
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[1]

INTEGER = "offset name default type min max hint when feature doc".split()
REAL = ("offset name default range when min_solver low high usual feature projected unit "
        "doc").split()
REALS = "offset name count default low high projected unit doc".split()
FIELD = "name type range of presence doc".split()
OBJECTS = ["phase", "collider", "emitter", "drain", "reservoir", "shape"]
COLUMNS = {"PBF_PARAM_INTEGER": INTEGER, "PBF_PARAM_REAL": REAL, "PBF_PARAM_REALS": REALS,
           "PBF_FEATURE": ["name", "refusal"],
           **{f"PBF_{name.upper()}_FIELD": FIELD for name in OBJECTS}}

# By lib/check.h's ranges: words, and the schema's (a definition's name, or the whole).
RANGES = {
    "ANY": ("finite", {"type": "number", "description": "a number"}),
    "AT_LEAST_ZERO": ("≥ 0", "non_negative"),
    "ABOVE_ZERO": ("> 0", "positive"),
    "FRACTION": ("0 … 1", "share"),
    "FRACTION_OR_CHOICE": ("-1, 0 … 1", {
        "type": "number", "minimum": -1, "maximum": 1,
        "description": "-1, or a number from 0 to 1"}),
    "FRACTION_OF_RADIUS": ("> 0, < 1", {
        "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1,
        "description": "a number between 0 and 1"}),
    "GRID_WIDTH": ("-1, 0, 1 … 1000", {
        "type": "number", "minimum": -1, "description": "-1, 0, or a number, at least 1"}),
}
UINT32_MAX = 2**32 - 1


def split_arguments(text):
    """The arguments at the beginning of `text`, up to the parenthesis that closes them."""
    arguments, depth, start = [], 0, 0
    for match in re.finditer(r'"(?:[^"\\]|\\.)*"|[(),]', text):
        depth += {"(": 1, ")": -1}.get(match.group(), 0)
        if depth < 0 or (depth == 0 and match.group() == ","):
            arguments.append(text[start:match.start()].strip())
            start = match.end()
        if depth < 0:
            return arguments
    raise ValueError(f"an entry does not end: {text[:60]}")


def joined(argument):
    """A string literal, perhaps of several pieces, without its quotes; anything else as it is."""
    pieces = re.findall(r'"((?:[^"\\]|\\.)*)"', argument)
    return "".join(pieces) if argument.startswith('"') else argument


def replaced(pattern, between, text):
    """`text` with `between` in place of what the pattern has between its two groups."""
    changed, count = re.subn(pattern, lambda match: f"{match[1]}{between}\n{match[2]}", text)
    if count != 1:
        raise ValueError(f"{count} places, not one, look like {pattern}")
    return changed


def read_table(name):
    """The entries of a table: dicts by column, `macro` being the kind."""
    text = (ROOT / name).read_text(encoding="utf-8")
    entries = []
    for match in re.finditer(r"^(PBF_\w+)\(", text, re.MULTILINE):
        columns, values = COLUMNS[match.group(1)], split_arguments(text[match.end():])
        if len(values) != len(columns):
            raise ValueError(f"{name}: {len(values)} columns in {values}; wanted: {columns}")
        entry = dict(zip(columns, map(joined, values)))
        entries.append({"macro": match.group(1).replace("PBF_PARAM_", ""), **entry})
    return entries


def names_of(param):
    """ONE_OF("a", "b") → ["a", "b"]; none of a NUMBER."""
    return re.findall(r'"(\w+)"', param["type"])


def constants_of(param, header):
    """The public constants that the names stand for; they must be in the header."""
    prefix = re.search(r"PBF_\w+_", param["hint"]).group()
    constants = [prefix + name.upper() for name in names_of(param)]
    for constant in constants:
        if not re.search(rf"\b{constant} =", header):
            raise ValueError(f"{param['name']}: params.h has no {constant}")
    return constants


# ---- scene.schema.json ---------------------------------------------------------------------------


def listed(names, last):
    quoted = [f'"{name}"' for name in names]
    return f"{', '.join(quoted[:-1])} {last} {quoted[-1]}"


def integer_schema(param):
    names = names_of(param)
    if param["type"].startswith("ONE_OF"):
        return {"enum": names, "description": listed(names, "or")}
    if param["type"].startswith("SOME_OF"):
        some = ", ".join(f'"{name}"' for name in names)
        return {"type": "array", "minItems": min(int(param["min"]), 1), "uniqueItems": True,
                "items": {"enum": names, "description": listed(names, "or")},
                "description": f"a list of some of {some}, each at most once"}
    least = int(param["min"])
    most = UINT32_MAX if param["max"] == "UINT32_MAX" else int(param["max"])
    words = f"at least {least}" if most == UINT32_MAX else f"{least} … {most}"
    return {"type": "integer", "minimum": least, "maximum": most,
            "description": f"an integer, {words}"}


def schema_of(param):
    if param["macro"] == "INTEGER":
        return integer_schema(param)
    if param["macro"] == "REALS":
        return {"$ref": f"#/definitions/{ {'3': 'vector', '6': 'walls'}[param['count']] }"}
    schema = RANGES[param["range"]][1]
    return {"$ref": f"#/definitions/{schema}"} if isinstance(schema, str) else schema


# What the objects are called, the key that tells their kind, and keys that are no member.
WORDS = {
    "phase": "an object of fields of pbf_phase (phases.h): a fluid of its own",
    "collider": "an object of fields of pbf_collider (colliders.h), those of its shape, and, when it moves in "
                "stretches, motion",
    "emitter": "an object of fields of pbf_emitter (emit.h), those of its shape",
    "drain": "an object of fields of pbf_volume (query.h), those of its shape",
    "reservoir": "an object of fields of pbf_reservoir (emit.h)",
    "shape": "what a solid is made from (shapes.h): \"mesh\" with vertices and faces, or a file, "
             "\"heights\", \"points\" of a hull, or a \"grid\" of distances, and cell; or "
             "\"baked\" with a file",
}
KIND_KEYS = {"collider": "shape", "emitter": "shape", "drain": "shape", "shape": "from"}
MORE_KEYS = {"collider": {"motion": {"$ref": "#/definitions/motion"}}}
# The schema's definition, or the whole, and the words for its values.
FIELD_TYPES = {
    "INTEGER": ({"type": "integer", "minimum": 0, "maximum": UINT32_MAX}, "an integer, at least 0"),
    "FLAG": ({"type": "boolean"}, "true or false"),
    "VECTOR": ("vector", "a list of one number an axis"),
    "VECTOR3": ("vector3", "a list of three numbers"),
    "QUATERNION": ("quaternion", "a unit quaternion x, y, z, w"),
    "NAME": ({"type": "string", "minLength": 1}, "a name in quotes"),
    "TEXT": ({"type": "string", "minLength": 1}, "a path in quotes"),
    "POINTS": ("points", None), "FACES": ("faces", None), "HEIGHTS": ("heights", None),
    "NUMBERS": ("numbers", None), "COUNTS": ("counts", "a list of one count an axis"),
}
NUMBER_WORDS = {"ANY": "a number", "ABOVE_ZERO": "a number above 0",
                "AT_LEAST_ZERO": "a number, at least 0", "FRACTION": "a number, 0 … 1"}


def field_schema(field):
    if names_of(field):
        schema, words = {"enum": names_of(field)}, listed(names_of(field), "or")
    elif field["type"] == "NUMBER":
        schema, words = RANGES[field["range"]][1], NUMBER_WORDS[field["range"]]
    else:
        schema, words = FIELD_TYPES[field["type"]]
    if isinstance(schema, str):
        schema = {"$ref": f"#/definitions/{schema}"}
    return {**schema, "description": f"{words} ({field['doc']})" if words else field["doc"]}


def kinds_of(field):
    """KINDS("sphere", "capsule") → both; None: all."""
    return re.findall(r'"(\w+)"', field["of"]) or None


def allowed(fields, more):
    return {"properties": {name: True for name in [*(field["name"] for field in fields), *more]},
            "additionalProperties": False}


def kind_schema(kind, key, fields, more):
    """What one kind of an object has and needs."""
    own = [field for field in fields if kind in (kinds_of(field) or [kind])]
    either = [field for field in own if field["presence"] == "EITHER"]
    alone = either if len(either) == 1 else []  # it stands in place of nothing
    needed = [field["name"] for field in own
              if kinds_of(field) and field["presence"] == "NEEDED" or field in alone]
    then = allowed(own, more)
    if needed:
        then = {"required": needed, **then}
    if len(either) > 1:  # the text stands in place of the others
        text = [field for field in either if field["type"] == "TEXT"]
        listed_in_scene = [field for field in either if field not in text]
        then = {"required": needed,
                "if": {"required": [field["name"] for field in text]},
                "then": allowed([field for field in own if field not in listed_in_scene], more),
                "else": {"required": [field["name"] for field in listed_in_scene],
                         **allowed([field for field in own if field not in text], more)}}
    return {"if": {"properties": {key: {"const": kind}}, "required": [key]}, "then": then}


def in_lines(items, indent):
    space = " " * indent
    return ",\n".join(space + item for item in items)


def object_schema(name, fields):
    more, key = MORE_KEYS.get(name, {}), KIND_KEYS.get(name)
    needed = [field["name"] for field in fields
              if field["presence"] == "NEEDED" and not kinds_of(field)]
    head = {"type": "object", "required": needed, "additionalProperties": False,
            "description": WORDS[name]}
    members = [f"{json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in head.items()]
    properties = {**{field["name"]: field_schema(field) for field in fields}, **more}
    lines = [f"{json.dumps(k)}: {json.dumps(v, ensure_ascii=False)}" for k, v in properties.items()]
    members.append('"properties": {\n' + in_lines(lines, 8) + "\n      }")
    if key:
        kinds = names_of(next(field for field in fields if field["name"] == key))
        rules = [json.dumps(kind_schema(kind, key, fields, more)) for kind in kinds]
        members.append('"allOf": [\n' + in_lines(rules, 8) + "\n      ]")
    return f'    "{name}": {{\n' + in_lines(members, 6) + "\n    },"


def objects_text(entries, text):
    written = "\n".join(
        object_schema(name, [entry for entry in entries
                             if entry["macro"] == f"PBF_{name.upper()}_FIELD"])
        for name in OBJECTS)
    pattern = r'(    "motion": \{\n(?:.*\n)*?    \},\n)(?:.*\n)*?(    "scaling": \{\n)'
    return replaced(pattern, written, text)


def schema_text(params, text):
    properties = ",\n".join(
        f'        "{param["name"]}": {json.dumps(schema_of(param), ensure_ascii=False)}'
        for param in params)
    pattern = (r'(    "params": \{\n      "type"(?:.*\n)*?      "properties": \{\n)'
               r"(?:.*\n)*?(      \}\n)")
    return replaced(pattern, properties, text)


# ---- _param_fields.py -----------------------------------------------------------------------------

PYTHON = '''"""The parameters as attributes. Written by tools/tables.py from backends/physics/params.def."""
from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict, Union

from ._numbers import Vector
from ._param_kinds import (Collide, CollideField, Holder, Integer, Kernel, KernelField, Method,
                           MethodField, Number, Periodic, PeriodicField, Reals)


class ParamFields(Holder):
{fields}


class ParamValues(TypedDict, total=False):
    """What the parameters' keywords take."""

{values}
'''

# The enumerations have classes of their own.
PYTHON_CLASSES = {"kernel": "Kernel", "solver": "Method", "collide": "Collide", "periodic": "Periodic"}


def python_kind(param):
    if param["name"] in PYTHON_CLASSES:
        return PYTHON_CLASSES[param["name"]] + "Field("
    kind = {"INTEGER": "Integer(", "REAL": "Number("}.get(param["macro"])
    return kind or f"Reals({param['count']}, "


def python_doc(param, header):
    words = [param["doc"]]
    if param.get("unit", "1") != "1":
        words.append(f"Unit: {param['unit']}.")
    words += [f"Range: {range_words(param, header)}.", f"Default: {default_words(param)}."]
    return " ".join(words).replace("\\", "\\\\").replace('"', '\\"')


def python_field(param, header):
    start = f"    {param['name']} = {python_kind(param)}"
    lines = textwrap.wrap(python_doc(param, header), 88, break_long_words=False)
    texts = [f'        "{line} "' for line in lines[:-1]] + [f'        "{lines[-1]}")']
    return start.rstrip() + "\n" + "\n".join(texts)


def python_value(param):
    name = param["name"]
    if name in PYTHON_CLASSES:
        listed = ", Sequence[str]" if param["type"].startswith("SOME_OF") else ""
        kind = f'"Union[{PYTHON_CLASSES[name]}, int, str{listed}]"'
    else:
        kind = {"INTEGER": "int", "REAL": "float"}.get(param["macro"], "Vector")
    return f"    {name}: {kind}"


def python_text(params, header):
    params = [param for param in params if param["name"] != "reserved"]
    return PYTHON.format(fields="\n".join(python_field(param, header) for param in params),
                         values="\n".join(map(python_value, params)))


# ---- docs ----------------------------------------------------------------------------------------

REFERENCE = """# Parameters

The members of `pbf_params`, in its order; [params.h](../include/pbf/params.h) says more of each. Scene files and `--set` of
`pbf-bench` have the same names. Units are the caller's own, as long as they are consistent; h is `smoothing_radius`. In 2D
every third component is ignored.

A build may be without a [feature](building.md#features): it then refuses parameters above 0 that need it.

{table}

Written by `tools/tables.py` from `backends/physics/params.def`.
"""


def table(head, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


def code(text):
    return f"`{text}`"


def range_words(param, header):
    if param["macro"] == "REALS":
        return "finite"
    if param["macro"] == "REAL":
        words = RANGES[param["range"]][0]
        if param["min_solver"] != "JACOBI":
            words += f"; 0 unless {code('PBF_SOLVER_' + param['min_solver'])}"
    elif names_of(param):
        last = ", " if param["type"].startswith("ONE_OF") else " + "
        words = last.join(map(code, constants_of(param, header)))
    else:
        words = f"≥ {param['min']}" if param["max"] == "UINT32_MAX" else f"{param['min']} … {param['max']}"
    if param["when"] != "ALWAYS":
        words += f", with `{param['when'][len('WITH('):-1]}`"
    return words


def type_words(param):
    kind = {"INTEGER": "uint32_t", "REAL": "double"}.get(param["macro"])
    return code(kind or f"double[{param['count']}]")


def default_words(param):
    value = param["default"]
    if value.startswith("PBF_LIST("):
        value = "{" + value[len("PBF_LIST("):-1] + "}"
    return " + ".join(map(code, value.split(" | ")))


def reference_row(param, header):
    feature = param.get("feature", "NONE")
    unit = param.get("unit", "1")
    return [code(param["name"]), type_words(param), "" if unit == "1" else unit,
            range_words(param, header), default_words(param), param["doc"],
            "" if feature == "NONE" else code(feature.lower())]


def reference_text(params, header):
    head = ["name", "type", "unit", "range", "default", "what it does", "feature"]
    rows = [reference_row(param, header) for param in params if param["name"] != "reserved"]
    return REFERENCE.format(table=table(head, rows))


def building_text(features, text):
    rows = [[code(feature["name"].lower()), feature["refusal"]] for feature in features]
    written = table(["name", "a build without it answers: built without …"], rows)
    pattern = r"(<!-- table: features -->\n)(?:.*\n)*?(<!-- end -->)"
    return replaced(pattern, written, text)


def defaults_text(params, text):
    rows = [[f"[`{param['name']}`](guide.md#{anchor_of(param['name'])})", default_words(param),
             "" if param.get("unit", "1") == "1" else param["unit"]] for param in params if param["name"] != "reserved"]
    pattern = r"(<!-- table: defaults -->\n)(?:.*\n)*?(<!-- end -->)"
    return replaced(pattern, table(["member", "default", "unit"], rows), text)


def anchor_of(name):
    """Of the heading of docs/guide.md in which the parameter is named."""
    for heading in re.findall(r"^### (`.*)$", read("docs/guide.md"), flags=re.MULTILINE):
        if code(name) in heading:
            return re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")
    sys.exit(f"docs/guide.md has no heading for {name}")


# ---- all -----------------------------------------------------------------------------------------


def read(path):
    path = ROOT / path
    return path.read_text(encoding="utf-8") if path.exists() else ""


def outputs():
    """Path → what it should hold."""
    params, features = read_table("backends/physics/params.def"), read_table("backends/physics/features.def")
    return {
        "docs/parameters.md": reference_text(params, read("include/pbf/params.h")),
        "docs/defaults.md": defaults_text(params, read("docs/defaults.md")),
        "docs/building.md": building_text(features, read("docs/building.md")),
        "bench/scenes/scene.schema.json":
            objects_text(read_table("bench/scene/objects.def"),
                         schema_text(params, read("bench/scenes/scene.schema.json"))),
        "python/pbf/_param_fields.py": python_text(params, read("include/pbf/params.h")),
    }


def difference(path, wanted):
    lines = difflib.unified_diff(read(path).splitlines(), wanted.splitlines(), path,
                                 "by the tables", lineterm="", n=0)
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing")
    check = parser.parse_args().check
    stale = {path: wanted for path, wanted in outputs().items() if wanted != read(path)}
    for path, wanted in stale.items():
        if check:
            print(difference(path, wanted))
        else:
            (ROOT / path).write_text(wanted, encoding="utf-8")
            print(path)
    if check and stale:
        sys.exit(f"not as the tables have it: {', '.join(stale)}; tools/tables.py writes it")


if __name__ == "__main__":
    main()
