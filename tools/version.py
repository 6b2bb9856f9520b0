#!/usr/bin/env python3
"""Writes the version, which stands in project() of CMakeLists.txt, wherever else it has to be:

    tools/version.py            writes it
    tools/version.py --check    fails where it is another one

tools/bindings.py wants to run afterwards: the description of the ABI has the numbers of the headers.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]

# File → patterns with the version as their second group.
PLACES = {
    "bindings/rust/pbf-sys/Cargo.toml": [r'(^version = ")([^"]*)(")'],
    "bindings/rust/pbf/Cargo.toml": [r'(^version = ")([^"]*)(")', r'(pbf-sys = .*version = ")([^"]*)(")'],
    "bindings/csharp/Pbf/Pbf.csproj": [r"(<Version>)([^<]*)(</Version>)"],
    "bindings/js/package.json": [r'("version": ")([^"]*)(")'],
    "packaging/vcpkg/pbf/vcpkg.json": [r'("version": ")([^"]*)(")'],
    "CITATION.cff": [r"(^version: )(\S+)()"],
}

# Those with that of the shared library.
SONAMES = {"bindings/lua/pbf/core.lua": r'("libpbf\.so\.)([\d.]*)(")', "docs/start.md": r"(`[^`]*libpbf\.so\.)([\d.]*)(`)"}


def soversion(wanted):
    """Before 1.0 the minor version changes what a program relies on."""
    major, minor, _ = wanted.split(".")
    return f"0.{minor}" if major == "0" else major


def version():
    text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"^project\(pbf VERSION (\d+\.\d+\.\d+) ", text, re.MULTILINE)[1]


def header_patterns(wanted):
    """pbf.h has its three numbers apart."""
    names = ("MAJOR", "MINOR", "PATCH")
    return [(rf"(^#define PBF_VERSION_{name} )(\d+)($)", number)
            for name, number in zip(names, wanted.split("."))]


def written(path, patterns):
    text = (ROOT / path).read_text(encoding="utf-8")
    for pattern, value in patterns:
        text, count = re.subn(pattern, lambda match: match[1] + value + match[3], text, flags=re.MULTILINE)
        if count != 1:
            sys.exit(f"{path}: {count} places, not one, look like {pattern}")
    return text


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    wanted = version()
    places = {path: [(pattern, wanted) for pattern in patterns] for path, patterns in PLACES.items()}
    places["include/pbf/pbf.h"] = header_patterns(wanted)
    for path, pattern in SONAMES.items():
        places[path] = [(pattern, soversion(wanted))]
    stale = []
    for path, patterns in places.items():
        text = written(path, patterns)
        if text != (ROOT / path).read_text(encoding="utf-8"):
            stale.append(path)
            if not check:
                (ROOT / path).write_text(text, encoding="utf-8")
                print(path)
    if check and stale:
        sys.exit(f"not of version {wanted}: {', '.join(stale)}; tools/version.py writes it")


if __name__ == "__main__":
    main()
