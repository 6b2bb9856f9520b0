#!/usr/bin/env python3
"""The API reference has the headers' declarations, all of them, as they are.

    reference.py ROOT

docs/site/header_filter.py shows Doxygen a header with its comments marked. Without comments what it shows is the header; and each
function and struct, opaque ones, too, is in a group, which is what the reference's sections are made of.
"""
import importlib.util
import pathlib
import re
import sys


def code_of(text):
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    text = re.sub(r"typedef (struct (\w+) \{.*?^\}) \2;", r"\1;", text, flags=re.MULTILINE | re.DOTALL)
    return [line.strip() for line in text.splitlines() if line.strip()]


def check(header_filter, header):
    """Names of its functions and structs, and what is wrong."""
    shown = header_filter.converted(header)
    wrong = []
    if code_of(shown) != code_of(header):
        wrong.append("the filter changes declarations")
    inside = "".join(re.findall(r"@\{ \*/(.*?)/\*\* @\}", shown, flags=re.DOTALL))
    names = re.findall(r"^PBF_API [^;(]*?\b(pbf_\w+)\(|^typedef struct (pbf_\w+) \{", header, flags=re.MULTILINE)
    names = [name for pair in names for name in pair if name]
    opaque = re.findall(r"^typedef struct (pbf_\w+) \1;", header, flags=re.MULTILINE)
    wrong += [f"{name} is in no group" for name in opaque if f"typedef struct {name} {name};" not in inside]
    wrong += [f"{name} is in no group" for name in names if not re.search(rf"\b{name}\b *[({{]", inside)]
    return names, wrong


def main(root):
    root = pathlib.Path(root)
    sys.path.append(str(root / "tools"))
    from public_headers import public_headers
    spec = importlib.util.spec_from_file_location("header_filter", root / "docs/site/header_filter.py")
    header_filter = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(header_filter)
    names, wrong = [], []
    for header in public_headers(root):
        found, faults = check(header_filter, header.read_text(encoding="utf-8"))
        names += found
        wrong += [f"{header.name}: {fault}" for fault in faults]
    print("\n".join(wrong) if wrong else f"{len(names)} functions and structs are in the reference")
    return 1 if wrong or len(names) < 70 else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
