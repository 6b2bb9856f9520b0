#!/usr/bin/env python3
"""Builds the library for other systems and processors, runs the same tests there, and writes what came of it to
bench/results/platforms.json, and from that the tables of docs/platforms.md and README.md.

    tools/platforms.py NAME...              these; all without a name
    tools/platforms.py --packages NAME...   prints the packages of Debian that they want
    tools/platforms.py --tables             writes the tables alone

PBF_VARIANTS in the environment says which dimensions and precisions, 3d-f32;2d-f64 where it is unset.

A platform is an entry of PLATFORMS. One that is not named keeps its result.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "bench" / "tools"))
from pages import write_table  # noqa: E402

RESULTS = ROOT / "bench" / "results" / "platforms.json"
VARIANTS = os.environ.get("PBF_VARIANTS", "3d-f32;2d-f64")
COMMON = ["-DCMAKE_BUILD_TYPE=Release", "-DPBF_BACKENDS=reference;serial;threads", f"-DPBF_VARIANTS={VARIANTS}",
          "-DPBF_WERROR=ON", "-DPBF_BUILD_BENCH=OFF", "-DPBF_BUILD_EXAMPLES=OFF", "-DPBF_BUILD_TESTS=ON"]
# Tests of tests/api that want what POSIX alone has, or Linux.
OF_POSIX = {"batch_failures", "begun_logs", "beyond_memory", "cycles", "exceptions", "forks", "fp_environment", "interrupted", "locale", "thread_cancelled"}
# Those that take minutes where a processor is emulated, or has the scalar loops alone, with what begins as they do: tests
# that were parted from them.
SLOW = {"adhesion", "buoyancy", "damping_compensation", "deep", "deep_choice", "deep_wide", "depenetration", "diffuse", "diffuse_held", "emitters", "full", "inner_room", "loads", "many_colliders", "no_slip", "openings", "overlap",
        "partitions", "periodic", "phases", "queries", "ranges", "reservoirs", "shapes_fluid", "slosh", "steps", "surface", "surface_tension", "tiles", "walls"}


def toolchain(name):
    return [f"-DCMAKE_TOOLCHAIN_FILE={ROOT}/cmake/toolchains/{name}.cmake"]


# only: targets in place of the usual ones. what: as the tables say it. packages: of Debian, beside those of a build. options: of CMake. strip: of its binary
# utilities. python: packages of PyPI, in build/zig. without: targets that it has not got. more: those that it alone has. runs: False where nothing can run it here.
# slow: whether the tests in SLOW are left out.
PLATFORMS = {
    "gcc": {"what": "Linux x86-64, GCC", "packages": ["gcc", "g++"], "strip": "strip",
            "options": ["-DCMAKE_C_COMPILER=gcc", "-DCMAKE_CXX_COMPILER=g++"]},
    "clang": {"what": "Linux x86-64, clang", "packages": ["clang"], "strip": "strip",
              "options": ["-DCMAKE_C_COMPILER=clang", "-DCMAKE_CXX_COMPILER=clang++"]},
    "i686": {"what": "Linux x86, 32-bit", "packages": ["gcc-i686-linux-gnu", "g++-i686-linux-gnu"],
             "strip": "i686-linux-gnu-strip", "options": toolchain("i686-linux-gnu"), "without": ["test_abi_layout"], "slow": True},
    "arm64": {"what": "Linux AArch64, under qemu", "strip": "aarch64-linux-gnu-strip",
              "packages": ["gcc-aarch64-linux-gnu", "g++-aarch64-linux-gnu", "qemu-user-static"],
              "options": toolchain("aarch64-linux-gnu"), "slow": True},
    "mingw": {"what": "Windows x86-64 by mingw-w64, under Wine", "strip": "x86_64-w64-mingw32-strip",
              "packages": ["gcc-mingw-w64-x86-64", "g++-mingw-w64-x86-64", "wine", "wine64"],
              "options": [*toolchain("x86_64-w64-mingw32"), "-DPBF_BACKENDS=reference;serial;threads;openmp"],
              "more": ["test_loader_windows", "pbf_backend_openmp"]},
    "macos": {"what": "macOS AArch64, by Zig", "packages": ["python3-venv"], "python": ["ziglang"], "strip": "true",
              "options": toolchain("aarch64-macos"), "runs": False},
    "wasm": {"what": "WebAssembly by Emscripten, under node", "packages": ["emscripten"], "only": ["wasm_tests"],
             "options": [*toolchain("wasm32-emscripten"), "-DPBF_BACKENDS=serial"], "slow": True},
    "wasm-threads": {"what": "WebAssembly with threads by Emscripten, under node", "packages": ["emscripten"], "only": ["wasm_tests"],
                     "options": [*toolchain("wasm32-emscripten"), "-DPBF_BACKENDS=threads"], "slow": True},
}


def run(log, *command):
    log.write(f"$ {' '.join(map(str, command))}\n")
    log.flush()
    # Where Debian's Emscripten finds what it wants of node, for a node that is not Debian's.
    environment = {"NODE_PATH": "/usr/share/nodejs", **os.environ, "WINEDEBUG": "-all"}
    return subprocess.run(list(map(str, command)), cwd=ROOT, stdout=log, stderr=subprocess.STDOUT, env=environment).returncode


def api_tests(platform):
    """Of tests/api, by name: so that a new one is among them."""
    names = {file.stem for file in (ROOT / "tests" / "api").glob("*.c")} - OF_POSIX
    slow = {name for name in names if any(f"{name}_".startswith(f"{one}_") for one in SLOW)}
    return sorted(names - slow if platform.get("slow") else names)


def pattern(platform):
    return rf"^(same_bits\.|abi\.layout|loader_windows\.|api\.({'|'.join(api_tests(platform))})\.(ballistic|serial|threads)$)"


def targets(platform):
    if "only" in platform:
        return platform["only"]
    names = ["pbf", "pbf_backend_reference", "pbf_backend_serial", "pbf_backend_threads"]
    if platform.get("runs", True):
        names += ["same_bits", "stubs", "test_abi_layout", *(f"test_api_{name}" for name in api_tests(platform))]
    return [name for name in names if name not in platform.get("without", [])] + platform.get("more", [])


def outcomes(record):
    """Of each test in CTest's own record: passed, skipped or failed."""
    found = {}
    for case in re.findall(r"<testcase .*?(?:/>|</testcase>)", record.read_text(errors="replace"), re.DOTALL):
        name = re.search(r'name="([^"]*)"', case)[1]
        status = re.search(r'status="([^"]*)"', case)[1]
        found[name] = {"run": "passed", "notrun": "skipped", "disabled": "skipped"}.get(status, "failed")
    return found


def cached(build, name):
    found = re.search(rf"^{name}:[^=]*=(.*)$", (build / "CMakeCache.txt").read_text(), re.MULTILINE)
    return found[1] if found else ""


def compiler(build):
    for file in build.glob("CMakeFiles/*/CMakeCCompiler.cmake"):
        text = file.read_text()
        return " ".join(re.search(rf'set\(CMAKE_C_COMPILER_{key} "([^"]*)"\)', text)[1] for key in ("ID", "VERSION"))
    return ""


def kilobytes(platform, build):
    """Of libpbf and of `serial` with what it shares, stripped."""
    sizes = {}
    for key, patterns in {"libpbf": ["lib/libpbf.so", "bin/libpbf.dll", "lib/libpbf.dylib", "js/pbf.wasm", "js/pbf-threads.wasm"],
                          "serial": ["*/pbf/backends/pbf_backend_serial.*", "*/pbf/backends/pbf_cpu.*"]}.items():
        for file in (file for pattern in patterns for file in build.glob(pattern)):
            copy = build / f"{file.name}.stripped"
            shutil.copy(file.resolve(), copy)
            if "strip" in platform:
                subprocess.run([*platform["strip"].split(), copy], check=False)
            sizes[key] = sizes.get(key, 0) + copy.stat().st_size
    return {key: round(size / 1000) for key, size in sizes.items()}


def commit():
    words = ["git", "-C", str(ROOT), "rev-parse", "--short=12", "HEAD"]
    return subprocess.run(words, text=True, stdout=subprocess.PIPE, check=False).stdout.strip()


def measure(name):
    """A platform's result; null where it could not be built."""
    platform = PLATFORMS[name]
    build = ROOT / "build" / f"platform-{name}"
    build.mkdir(parents=True, exist_ok=True)
    with open(build / "log.txt", "w", encoding="utf-8") as log:
        steps = [[sys.executable, "-m", "venv", ROOT / "build" / "zig"],
                 [ROOT / "build" / "zig" / "bin" / "pip", "install", "-q", *platform["python"]]] if "python" in platform else []
        steps += [["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", *COMMON, *platform["options"]],
                 ["cmake", "--build", build, "--target", *targets(platform)]]
        if any(run(log, *step) for step in steps):
            print(f"platforms: {name} could not be built; the log is {build / 'log.txt'}", file=sys.stderr)
            return None
        found = {}
        if platform.get("runs", True):
            (build / "tests.xml").unlink(missing_ok=True)
            run(log, "ctest", "--test-dir", build, "-R", pattern(platform), "-LE", "^long$", "-j", os.cpu_count(), "--timeout", 1800, "--output-on-failure",
                "--output-junit", build / "tests.xml")
            if not (build / "tests.xml").exists():
                print(f"platforms: {name}: the tests did not end; the log is {build / 'log.txt'}", file=sys.stderr)
                return None
            found = outcomes(build / "tests.xml")
    result = {"what": platform["what"], "compiler": compiler(build), "commit": commit(), "kilobytes": kilobytes(platform, build),
              "variants": cached(build, "PBF_VARIANTS"), "tests": found}
    count = {word: list(found.values()).count(word) for word in ("passed", "skipped", "failed")}
    print(f"platforms: {name}: {count['passed']} passed, {count['skipped']} skipped, {count['failed']} failed")
    for test, outcome in sorted(found.items()):
        if outcome == "failed":
            print(f"platforms: {name}: {test} failed; the log is {build / 'log.txt'}", file=sys.stderr)
    return result


def pinned_sets(tests):
    """Instruction sets with which `serial`, or `threads` where it is alone, gave all pinned hashes."""
    passed = [test.split(".") for test, outcome in tests.items() if test.startswith("same_bits.") and outcome == "passed"]
    backend = "serial" if any(words[1] == "serial" for words in passed) else "threads"
    return [words[2] for words in passed if words[1] == backend]


def row(name, result):
    tests = result["tests"]
    count = [list(tests.values()).count(word) for word in ("passed", "skipped", "failed")]
    sizes = result["kilobytes"]
    if not tests:
        count, bits = ["not run", "", ""], "not run"
    else:
        bits = ", ".join(pinned_sets(tests))
    cells = [f"`{name}`", result["what"], result["compiler"], result["variants"].replace(";", ", "), bits, *map(str, count), str(sizes.get("libpbf", "")),
             str(sizes.get("serial", "")), result["commit"]]
    return f"| {' | '.join(cells)} |"


def write_tables(results):
    known = {name: results[name] for name in PLATFORMS if name in results}
    head = ["| name | platform | compiler | built | the pinned bits with | passed | skipped | failed | libpbf, KB | `serial`, KB | commit |",
            "| --- | --- | --- | --- | --- | --: | --: | --: | --: | --: | --- |"]
    write_table("docs/platforms.md", "platforms", "\n".join(head + [row(name, result) for name, result in known.items()]))
    same = [result["what"] for result in known.values() if result["tests"] and "failed" not in result["tests"].values()]
    write_table("README.md", "platforms", f"Tested with the same bits on: {'; '.join(same)}. [What ran where](docs/platforms.md).")


def known_results():
    return json.loads(RESULTS.read_text()) if RESULTS.exists() else {}


def main():
    arguments = sys.argv[1:]
    if arguments == ["--tables"]:
        return write_tables(known_results())
    asks_packages = arguments[:1] == ["--packages"]
    names = arguments[asks_packages:] or list(PLATFORMS)
    unknown = [name for name in names if name not in PLATFORMS]
    if unknown:
        sys.exit(f"platforms: there is no {unknown[0]}; known are {', '.join(PLATFORMS)}")
    if asks_packages:
        return print(*dict.fromkeys(package for name in names for package in PLATFORMS[name]["packages"]))
    failed = False
    for name in names:
        result = measure(name)
        failed |= result is None or "failed" in result["tests"].values()
        if result:
            results = {**known_results(), name: result}
            RESULTS.write_text(json.dumps(results, indent=1) + "\n")
            write_tables(results)
    return sys.exit(failed)


if __name__ == "__main__":
    main()
