#!/usr/bin/env python3
"""Sizes of the library as it ships: builds it trimmed in several ways, and measures.

    bench/tools/sizes.py measure FOLDER RESULT.json [BUILD ...]    builds in FOLDER: all, or these anew
    bench/tools/sizes.py table RESULT.json                         writes the table in docs/building.md

Sizes are of stripped files. A static library has no size of its own in a program: there it is what
examples/hello.c has with the library in it.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

from pages import ROOT, write_table

FEATURES_OF_HELLO = {"wall_density", "chebyshev", "stats"}
FEATURES = [name.lower() for name in re.findall(
    r"^PBF_FEATURE\((\w+),", (ROOT / "backends" / "physics" / "features.def").read_text(encoding="utf-8"), re.MULTILINE)]
GAME = {"PBF_VARIANTS": "3d-f32", "PBF_BACKENDS": "serial;openmp;cuda", "PBF_ISAS": "sse2;avx2;avx512"}
SMALL = {"PBF_STATIC": "ON", "PBF_VARIANTS": "3d-f32", "PBF_BACKENDS": "serial", "CMAKE_BUILD_TYPE": "MinSizeRel",
         "PBF_FUSED": "OFF"}
BUILDS = {
    "whole": {},
    "whole, on CPUs": {"PBF_BACKENDS": "reference;serial;threads;openmp"},
    "a game, on CPUs": {**GAME, "PBF_BACKENDS": "serial;threads"},
    "a game": GAME,
    "a game, static": {**GAME, "PBF_STATIC": "ON"},
    "smallest, any x86-64": {**SMALL, "PBF_ISAS": "sse2;avx2;avx512"},
    "smallest, one instruction set": {**SMALL, "PBF_ISAS": "avx2"},
    "smallest, only what the program uses": {
        **SMALL, "PBF_ISAS": "avx2",
        "PBF_WITHOUT": ";".join(f for f in FEATURES if f not in FEATURES_OF_HELLO)},
}


def run(*command, **options):
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE, **options).stdout


def configure_and_build(options, folder):
    common = {"CMAKE_BUILD_TYPE": "Release", "PBF_BUILD_BENCH": "OFF", "PBF_BUILD_TESTS": "OFF",
              "PBF_BUILD_EXAMPLES": "OFF", **options}
    if "cuda" in common.get("PBF_BACKENDS", "cuda"):
        common["PBF_REQUIRE_CUDA"] = "ON"
    run("cmake", "-S", ROOT, "-B", folder, *(f"-D{key}={value}" for key, value in common.items()))
    run("cmake", "--build", folder, "--parallel", 2)


def stripped_bytes(path, folder):
    copy = folder / (path.name + ".stripped")
    shutil.copy(path, copy)
    run("strip", copy)
    return copy.stat().st_size


def program_with(folder):
    """examples/hello.c, linked against the static library as it is installed."""
    run("cmake", "--install", folder, "--prefix", folder / "tree")
    config = next((folder / "tree").rglob("pbf.pc"))
    flags = run("pkg-config", "--cflags", "--libs", "pbf", env={"PKG_CONFIG_PATH": str(config.parent), "PATH": "/usr/bin:/bin"})
    program = folder / "hello"
    run("cc", "-Os", ROOT / "examples" / "hello.c", "-o", program, "-Wl,--gc-sections", *flags.split())
    run(program)
    return program


def files_of(options, folder):
    if options.get("PBF_STATIC"):
        return [program_with(folder)]
    library = next(folder.glob("lib/libpbf.so.*.*"))
    return [library, *sorted(folder.glob("lib/pbf/backends/*.so"))]


def measured(name, work, commit):
    options, folder = BUILDS[name], work / name.replace(",", "").replace(" ", "_")
    configure_and_build(options, folder)
    files = [{"file": path.name, "bytes": stripped_bytes(path, folder)} for path in files_of(options, folder)]
    return {"name": name, "options": options, "commit": commit, "files": files, "bytes": sum(f["bytes"] for f in files)}


def measure(work, result, names):
    before = json.loads(result.read_text(encoding="utf-8"))["builds"] if names else []
    builds = {build["name"]: build for build in before}
    commit = run("git", "-C", ROOT, "rev-parse", "--short=12", "HEAD").strip()
    for name in names or BUILDS:
        builds[name] = measured(name, work, commit)
        print(f"{name}: {builds[name]['bytes']:,} bytes", flush=True)
    compiler = run("cc", "--version").splitlines()[0]
    result.write_text(json.dumps({"compiler": compiler, "builds": [builds[name] for name in BUILDS if name in builds]}, indent=2) + "\n",
                      encoding="utf-8")


def kilobytes(count):
    return f"{count / 1000:,.0f}"


def options_text(options):
    return "<br>".join(f"`{key}={value}`" for key, value in options.items())


def table(result):
    lines = ["| build | options | files | KB | commit |", "| --- | --- | --- | --: | --- |"]
    for build in result["builds"]:
        files = "<br>".join(f"{f['file']} {kilobytes(f['bytes'])}" for f in build["files"])
        lines.append(f"| {build['name']} | {options_text(build['options'])} | {files} | {kilobytes(build['bytes'])} | "
                     f"{build['commit']} |")
    lines += ["", f"Stripped, in thousands of bytes; {result['compiler']}. `hello` is `examples/hello.c` with the "
              "static library in it."]
    return "\n".join(lines)


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if len(arguments) >= 3 and arguments[0] == "measure" and set(arguments[3:]) <= set(BUILDS):
        measure(pathlib.Path(arguments[1]).resolve(), pathlib.Path(arguments[2]), arguments[3:])
    elif len(arguments) == 2 and arguments[0] == "table":
        result = json.loads(pathlib.Path(arguments[1]).read_text(encoding="utf-8"))
        write_table("docs/building.md", "sizes", table(result))
    else:
        sys.exit(__doc__)
