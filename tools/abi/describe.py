"""The public headers as clang sees them, and sizes and offsets as the C compiler has them.

A type is one of
    {"scalar": "uint32_t"}                      of the names in SCALARS
    {"pointer": TYPE, "const": BOOL}            to const, or not
    {"array": TYPE, "count": N}
    {"struct": "pbf_params"}, {"opaque": "pbf_solver"}
    {"callback": "pbf_log_fn"}                  a pointer to a function
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile

SCALARS = {"void", "char", "uint8_t", "int32_t", "uint32_t", "int64_t", "uint64_t", "float", "double",
           "pbf_status"}


class NoCompiler(Exception):
    pass


def run(command, **keywords):
    try:
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **keywords).stdout
    except FileNotFoundError as error:
        raise NoCompiler(f"{command[0]} is not here") from error


def tree(header):
    clang = shlex.split(os.environ.get("CLANG", "clang"))
    return json.loads(run(clang + ["-x", "c", "-std=c11", "-fsyntax-only", "-I", str(header.parents[1]), "-Xclang",
                                   "-ast-dump=json", str(header)]))["inner"]


def split_parameters(text):
    """"void *, void (*)(int, int)" → its two parts."""
    parts, depth, start = [], 0, 0
    for at, character in enumerate(text + ","):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if character == "," and depth == 0:
            parts.append(text[start:at].strip())
            start = at + 1
    return [] if parts == ["void"] else parts


class Names:
    """What a name in a type stands for; callbacks without a name get one from where they are."""

    def __init__(self, nodes):
        complete = {node["name"] for node in nodes
                    if node["kind"] == "RecordDecl" and node.get("completeDefinition") and "name" in node}
        all_records = {node["name"] for node in nodes if node["kind"] == "RecordDecl" and "name" in node}
        self.structs = complete
        self.opaque = all_records - complete
        self.callbacks = {}
        self.pointed_to = set()  # opaque types that something points to
        for node in nodes:
            if node["kind"] == "TypedefDecl" and node["name"].startswith("pbf_"):
                spelled = node["type"]["qualType"]
                if "(*)" in spelled:
                    self.callbacks[node["name"]] = self.signature(spelled)

    def signature(self, spelled):
        returned, parameters = re.fullmatch(r"(.*?)\(\*\)\((.*)\)", spelled).groups()
        return {"returns": self.type_of(returned),
                "parameters": [self.type_of(one) for one in split_parameters(parameters)]}

    def type_of(self, spelled, place=None):
        spelled = spelled.strip()
        if "(*)" in spelled:
            self.callbacks[place] = self.signature(spelled)
            return {"callback": place}
        array = re.fullmatch(r"(.*)\[(\d+)\]", spelled)
        if array:
            return {"array": self.type_of(array[1]), "count": int(array[2])}
        if spelled.endswith("*"):
            target = spelled[:-1].strip()
            constant = target.startswith("const ") and not target.endswith("*")  # else it is further in
            return {"pointer": self.type_of(target.removeprefix("const ") if constant else target), "const": constant}
        name = spelled.removeprefix("struct ")
        for kind, known in (("scalar", SCALARS), ("struct", self.structs), ("opaque", self.opaque),
                            ("callback", self.callbacks)):
            if name in known:
                if kind == "opaque":
                    self.pointed_to.add(name)
                return {kind: name}
        raise ValueError(f"the description knows no type {spelled!r}")


def enumerators(nodes):
    """Each enum as {name: value}; what is not written out counts on from the one before."""
    enums = []
    for node in nodes:
        if node["kind"] != "EnumDecl":
            continue
        enum, following = {}, 0
        for constant in node["inner"]:
            if constant["kind"] != "EnumConstantDecl":
                continue
            written = [inner["value"] for inner in constant.get("inner", []) if "value" in inner]
            value = int(written[0]) if written else following
            enum[constant["name"]] = value
            following = value + 1
        enums.append(enum)
    return enums


def numbers(headers):
    """#define PBF_… with a number."""
    text = "".join(header.read_text(encoding="utf-8") for header in headers)
    found = re.findall(r"^#define (PBF_\w+) (0x[0-9a-f]+|\d+)u?$", text, re.MULTILINE)
    return {name: int(value, 0) for name, value in found}


def structs_of(nodes, names):
    return {node["name"]: [{"name": field["name"],
                            "type": names.type_of(field["type"]["qualType"],
                                                  f"{node['name']}_{field['name']}_fn")}
                           for field in node["inner"] if field["kind"] == "FieldDecl"]
            for node in nodes
            if node["kind"] == "RecordDecl" and node.get("completeDefinition")
            and node.get("name", "").startswith("pbf_")}


def functions_of(nodes, names):
    functions = {}
    for node in nodes:
        if node["kind"] == "FunctionDecl" and node["name"].startswith("pbf_"):
            functions[node["name"]] = {
                "returns": names.type_of(node["type"]["qualType"].split("(")[0]),
                "parameters": [{"name": inner["name"], "type": names.type_of(inner["type"]["qualType"])}
                               for inner in node.get("inner", []) if inner["kind"] == "ParmVarDecl"]}
    return functions


def layout_program(structs, header):
    lines = ["#include <stddef.h>", "#include <stdio.h>", f"#include <pbf/{header.name}>", "int main(void) {"]
    for struct, fields in structs.items():
        lines.append(f'  printf("%zu\\n", sizeof({struct}));')
        for field in fields:
            lines.append(f'  printf("%zu %zu\\n", offsetof({struct}, {field["name"]}), '
                         f'sizeof((({struct} *)0)->{field["name"]}));')
    return "\n".join(lines + ["  return 0;", "}", ""])


def with_layout(structs, header):
    """Adds size, and each field's offset and size, as a compiled program prints them."""
    with tempfile.TemporaryDirectory() as folder:
        source, program = pathlib.Path(folder) / "layout.c", pathlib.Path(folder) / "layout"
        source.write_text(layout_program(structs, header), encoding="utf-8")
        run(shlex.split(os.environ.get("CC", "cc")) + ["-I", str(header.parents[1]), str(source), "-o", str(program)])
        printed = iter(run([str(program)]).splitlines())
    described = {}
    for struct, fields in structs.items():
        size = int(next(printed))
        for field in fields:
            field["offset"], field["size"] = map(int, next(printed).split())
        described[struct] = {"size": size, "fields": fields}
    return described


def describe(header, headers):
    """`header` includes `headers`."""
    nodes = tree(header)
    names = Names(nodes)
    structs = with_layout(structs_of(nodes, names), header)
    functions = functions_of(nodes, names)
    return {"comment": f"include/pbf/{header.name} on a system with 64-bit pointers; written by tools/bindings.py",
            "numbers": numbers(headers), "enums": enumerators(nodes),
            "opaque": sorted(names.pointed_to),
            "callbacks": names.callbacks, "structs": structs, "functions": functions}


def as_text(description):
    """JSON with a line for each field, parameter list and constant, so that differences are read."""
    def compact(value):
        return json.dumps(value, ensure_ascii=False)

    def block(mapping):
        return ",\n".join(f'    "{name}": {compact(value)}' for name, value in mapping.items())

    def struct(name, value):
        fields = ",\n".join(f"      {compact(field)}" for field in value["fields"])
        return f'    "{name}": {{"size": {value["size"]}, "fields": [\n{fields}]}}'

    return (f'{{\n  "comment": {compact(description["comment"])},\n'
            f'  "numbers": {{\n{block(description["numbers"])}\n  }},\n'
            '  "enums": [\n' + ",\n".join(f"    {compact(enum)}" for enum in description["enums"]) + "\n  ],\n"
            f'  "opaque": {compact(description["opaque"])},\n'
            f'  "callbacks": {{\n{block(description["callbacks"])}\n  }},\n'
            '  "structs": {\n' + ",\n".join(struct(*item) for item in description["structs"].items()) + "\n  },\n"
            f'  "functions": {{\n{block(description["functions"])}\n  }}\n}}\n')
