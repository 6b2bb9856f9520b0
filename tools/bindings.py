#!/usr/bin/env python3
"""Writes the description of the ABI and what follows from it:

    tools/bindings.py             writes it; wants clang and a C compiler
    tools/bindings.py --check     fails where a file is not as it would be written; without clang
                                  only sizes and offsets are compared with the header

    bindings/abi.json             the description: what the compilers see in the headers that include/pbf/all.h names
    bindings/rust/pbf-sys/src/lib.rs
    bindings/csharp/Pbf/Native.g.cs
    bindings/lua/pbf/cdef.lua
    bindings/js/abi.g.mjs, abi.g.d.mts, layout.g.c, exports.g.json
    examples/ctypes_demo.py       its structs
    docs/bindings.md              the table of what the objects of each language have
"""
import argparse
import difflib
import json
import pathlib
import re
import sys

from abi import coverage, csharp, ctypes_mirror, describe, js, lua, rust
from public_headers import public_headers

ROOT = pathlib.Path(__file__).resolve().parents[1]
ABI = "bindings/abi.json"
HEADERS = public_headers(ROOT)
ALL = ROOT / "include/pbf/all.h"
TABLE = r"(<!-- table: functions -->\n)(?:.*\n)*?(<!-- end -->\n)"
STRUCTS = r"(# structs: written by tools/bindings.py\n)(?:.*\n)*?(# end of structs\n)"


def read(path):
    path = ROOT / path
    return path.read_text(encoding="utf-8") if path.exists() else ""


def with_part(path, place, part):
    """A file with what is written into it between two lines."""
    changed, count = re.subn(place, lambda match: f"{match[1]}{part}{match[2]}", read(path))
    if count != 1:
        raise ValueError(f"{path} has {count} places for what is written there, not one")
    return changed


def outputs(description):
    """Path → what it should hold."""
    return {
        ABI: describe.as_text(description),
        "bindings/rust/pbf-sys/src/lib.rs": rust.text(description),
        "bindings/csharp/Pbf/Native.g.cs": csharp.text(description),
        "bindings/lua/pbf/cdef.lua": lua.text(description),
        **js.files(description),
        "examples/ctypes_demo.py": with_part("examples/ctypes_demo.py", STRUCTS, ctypes_mirror.text(description)),
        "docs/bindings.md": with_part("docs/bindings.md", TABLE, coverage.text(ROOT, HEADERS, description["functions"])),
    }


def described(check):
    try:
        return describe.describe(ALL, HEADERS)
    except describe.NoCompiler as error:
        if not check:
            sys.exit(f"{error}, and the description is its")
        print(f"{error}: of the header only sizes and offsets are compared")
        description = json.loads(read(ABI))
        fields = {name: value["fields"] for name, value in description["structs"].items()}
        description["structs"] = describe.with_layout(fields, ALL)
        return description


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing")
    check = parser.parse_args().check
    stale = []
    for path, wanted in outputs(described(check)).items():
        if wanted == read(path):
            continue
        stale.append(path)
        if check:
            lines = difflib.unified_diff(read(path).splitlines(), wanted.splitlines(), path,
                                         "by the header", lineterm="", n=0)
            print("\n".join(list(lines)[:40]))
        else:
            (ROOT / path).parent.mkdir(parents=True, exist_ok=True)
            (ROOT / path).write_text(wanted, encoding="utf-8")
            print(path)
    if check and stale:
        sys.exit(f"not as the header has it: {', '.join(stale)}; tools/bindings.py writes it")


if __name__ == "__main__":
    main()
