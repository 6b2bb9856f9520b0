"""The table of docs/bindings.md: which of the C API's functions the objects of each language call.

A row is a section of a header, so that a new one is a row, and its functions are missed, without
anything written here. A function is had by a language whose files name it; declarations that are
written from abi.json do not count.
"""
import re

from .words import COMMENT

SECTION = re.compile(r"^/\* ---- (.*?) -+ \*/$")
FUNCTION = re.compile(r"^PBF_API [^(]*?\b(pbf_\w+)\(")
# Language → its files; those that tools/bindings.py writes say so in their first line.
SOURCES = {"C++": "include/pbf/pbf.hpp", "Rust": "bindings/rust/pbf/src/*.rs", "C#": "bindings/csharp/Pbf/*.cs",
           "Lua": "bindings/lua/**/*.lua", "JavaScript": "bindings/js/*.mjs"}


def sections(headers):
    """(header, title, functions) of each section that has functions."""
    found = []
    for header in headers:
        title, functions = "", []
        for line in [*header.read_text(encoding="utf-8").splitlines(), "/* ---- end - */"]:
            begins, declares = SECTION.match(line), FUNCTION.match(line)
            if declares:
                functions.append(declares[1])
            if begins:
                if functions:
                    found.append((header.name, title, functions))
                title, functions = begins[1], []
    return found


def named(root, pattern):
    texts = [path.read_text(encoding="utf-8") for path in sorted(root.glob(pattern))]
    return {name for text in texts if COMMENT not in text.split("\n", 1)[0] for name in re.findall(r"\bpbf_\w+", text)}


def cell(functions, known):
    count = sum(name in known for name in functions)
    return "all" if count == len(functions) else f"{count} of {len(functions)}" if count else "–"


def text(root, headers, functions):
    """`functions`: all that the description has, each of which is in a section."""
    known = {language: named(root, pattern) for language, pattern in SOURCES.items()}
    rows = sections(headers)
    lost = set(functions) - {name for _, _, names in rows for name in names}
    if lost:
        raise ValueError(f"in no section of a header: {', '.join(sorted(lost))}")
    lines = [f"| | {' | '.join(SOURCES)} |", "| --- " * (len(SOURCES) + 1) + "|"]
    lines += [f"| `{header}`: {title.split(':')[0].lower()} | "
              + " | ".join(cell(names, known[language]) for language in SOURCES) + " |" for header, title, names in rows]
    lines.append("")
    for language in SOURCES:
        missing = [f"`{name}`" for _, _, names in rows for name in names if name not in known[language]]
        if missing:
            lines.append(f"- {language} lacks {', '.join(missing)}.")
    return "\n".join(lines) + "\n"
