#!/usr/bin/env python3
"""Makes two files of the library and one CPU backend, for projects that want no build of its own:

    tools/amalgamate.py FOLDER [3d-f32]     writes FOLDER/pbf_all.c, FOLDER/pbf_all.cpp and FOLDER/pbf/*.h

What is in them: libpbf with `serial` linked in, of one dimension and precision, with the scalar loops over pairs. They are
compiled as CONTRIBUTING.md says of all sources, C17 and C++17:

    cc -std=gnu17 -O3 -fno-math-errno -fno-trapping-math -c pbf_all.c
    c++ -std=gnu++17 -O3 -fno-tree-vectorize -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno -c pbf_all.cpp

and linked with -lm -pthread. Other flags of a project change no bit; older standards and -ffast-math are refused. A file's own names that another one has as well get its number.
"""
import pathlib
import re
import shutil
import sys

from public_headers import public_headers

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDERS = [ROOT / "lib", ROOT / "backends", ROOT / "include", ROOT / "third_party"]
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"].*$', re.MULTILINE)
C_SOURCES = [f"backends/cpu/{name}.c" for name in ("build", "core", "isa", "plugin", "team_serial")]
# Where a definition of a file's own begins: functions, variables and types.
STATIC = re.compile(r"^(?:PBF_UNSANITIZED )?static (?:inline |PBF_ALWAYS_INLINE |_Thread_local |_Atomic |const )*[\w *]*?[ *]+(\w+) ?[\[(=;]",
                    re.MULTILINE)
TYPE = re.compile(r"^(?:typedef (?:struct|enum|union) \w* ?\{[^}]*\} (\w+);|typedef [^;{]*?\(?\*?(\w+)\)?(?:\([^;]*\))?;|}\s*(\w+);)", re.MULTILINE)
MACRO = re.compile(r"^#define (\w+)", re.MULTILINE)
AT_LOAD = re.compile(r"^PBF_AT_LOAD\((\w+)\)", re.MULTILINE)
ENUM = re.compile(r"^(?:typedef )?enum(?: \w+)? \{([^}]*)\}", re.MULTILINE)


def find(name, beside):
    for folder in [beside, *FOLDERS]:
        if (folder / name).is_file():
            return (folder / name).resolve()
    return None


class Joined:
    """Text with what it includes in place, each header once; tables (.def) as often as they are asked for."""

    def __init__(self, generated):
        self.generated = generated
        self.seen = set()

    def text(self, path):
        return self.put(path.read_text(encoding="utf-8"), path.parent)

    def put(self, text, beside):
        return INCLUDE.sub(lambda match: self.included(match, beside), text)

    def included(self, match, beside):
        name = match[1]
        if name in self.generated:
            if name in self.seen:
                return ""
            self.seen.add(name)
            return self.generated[name]
        path = find(name, beside)
        if path is None:
            return match[0]  # the system's
        if path.suffix != ".def" and path in self.seen and "#ifndef" in path.read_text(encoding="utf-8")[:2000]:
            return ""
        self.seen.add(path)
        return self.text(path)


def own_names(text):
    names = {match[1] for match in STATIC.finditer(text)} | set(MACRO.findall(text))
    for match in TYPE.finditer(text):
        names.add(match[1] or match[2] or match[3])
    for match in ENUM.finditer(text):
        names |= set(re.findall(r"(?:^|,)\s*(\w+)", match[1]))
    names |= set(AT_LOAD.findall(text))
    return {name for name in names if name and not name.startswith(("PBF_", "pbf_", "_"))}  # those are the project's


def renamed(text, names, number):
    """A member after a dot or an arrow is no name of the file's own, nor is a word in a text or a comment."""
    if not names:
        return text
    word = re.compile(r'"(?:\\.|[^"\\\n])*"|/\*.*?\*/|(?<![\w.>])(' + "|".join(sorted(names)) + r")\b|(?<=->)\w+", re.DOTALL)
    return word.sub(lambda match: f"{match[1]}_{number}" if match[1] else match[0], text)


def library_sources():
    text = (ROOT / "lib" / "CMakeLists.txt").read_text(encoding="utf-8")
    listed = re.search(r"set\(sources\n(.*?)\)\n", text, re.DOTALL)[1].split()
    of_system = [f"../backends/common/{name}" for name in ("system_posix.c", "waits.c", "module_held.c")]
    posix = [part for name in listed for part in (of_system if name == "${system}" else [name.replace("${PBF_SYSTEM}", "posix")])]
    return [*(ROOT / "lib" / name for name in posix), ROOT / "lib/plugin/discover_linked.c", *(ROOT / name for name in C_SOURCES)]


def refusal(what, condition):
    return f'#if {condition}\n#error "pbf: {what}"\n#endif\n'


# Products are rounded before they are added, also where a project's flags let the compiler fuse the two; a header's functions
# that the one file does not use are no mistake.
PRAGMAS = """#pragma GCC diagnostic ignored "-Wunused-function"
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off")
#endif
"""
# As the project's own build has it; and C++20 would have numbers of enumerations be written otherwise.
CPP_PRAGMAS = PRAGMAS + """#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#if __cplusplus > 201703L
#pragma GCC diagnostic ignored "-Wdeprecated-enum-float-conversion"
#pragma GCC diagnostic ignored "-Wdeprecated-enum-enum-conversion"
#ifdef __clang__
#pragma GCC diagnostic ignored "-Wdeprecated-anon-enum-enum-conversion"
#endif
#endif
"""


def build_header(dimension, bits):
    return (f"#define PBF_EACH_VARIANT(DO) DO({dimension}, {bits})\n#define PBF_EACH_ISA(DO) DO(scalar, SCALAR)\n"
            "#define PBF_EACH_FUSED_ISA(DO)\n"
            "#define PBF_WITHOUT (0)\n#define PBF_PLUGIN_SUFFIX \".so\"\n")


def c_file(generated):
    version = re.search(r"project\(pbf VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    head = ("/* libpbf and its backend `serial` in one file, written by tools/amalgamate.py. */\n"
            + refusal("this file is C: compile it by -std=gnu17", "defined(__cplusplus) || __STDC_VERSION__ < 201112L") + PRAGMAS +
            "#define _GNU_SOURCE\n"
            "#define PBF_STATIC_LIBRARY\n#define PBF_BACKEND_NAME \"serial\"\n"
            f"#define PBF_BUILD_ID \"{version}, amalgamated\"\n#define PBF_LINKED\n#define PBF_LINKED_ENTRY pbf_backend_negotiate_serial\n")
    joined, parts = Joined(generated), [head]
    texts = {path: re.sub(r"^#define _GNU_SOURCE.*\n", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
             for path in library_sources()}
    names = {path: own_names(text) for path, text in texts.items()}
    headers = [path for folder in ("lib", "backends/common", "backends/cpu") for path in (ROOT / folder).rglob("*.h")]
    count = {name: 1 for path in headers for name in own_names(path.read_text(encoding="utf-8"))}
    for own in names.values():
        for name in own:
            count[name] = count.get(name, 0) + 1
    for number, (path, text) in enumerate(texts.items()):
        clashing = {name for name in names[path] if count[name] > 1}
        parts.append(f"\n/* {path.relative_to(ROOT)} */\n" + joined.put(renamed(text, clashing, number), path.parent))
    return "".join(parts)


def cpp_file(generated, dimension, bits):
    real = "float" if bits == "32" else "double"
    out = ["/* The CPU backend of one kind of fluid, written by tools/amalgamate.py. */\n",
           refusal("this file is C++17: compile it by -std=gnu++17", "!defined(__cplusplus) || __cplusplus < 201703L"), CPP_PRAGMAS,
           f"#define PBF_DIM {dimension}\n"
           f"#define PBF_BITS {bits}\n#define PBF_REAL {real}\n#define PBF_LANES_SCALAR\n"]
    joined = Joined(generated)
    for source, api in (("backend", f"cpu_{dimension}d_f{bits}"), ("kernels", f"cpu_scalar_{dimension}d_f{bits}")):
        out.append(f"#undef PBF_VARIANT_API\n#define PBF_VARIANT_API {api}\n" + joined.text(ROOT / f"backends/cpu/{source}.cpp"))
    return "".join(out)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    kind = re.fullmatch(r"([23])d-f(32|64)", sys.argv[2] if len(sys.argv) == 3 else "3d-f32")
    if not kind:
        sys.exit("amalgamate: the kind is one of 2d-f32, 2d-f64, 3d-f32, 3d-f64")
    dimension, bits = kind[1], kind[2]
    generated = {"pbf_build.h": build_header(dimension, bits), "pbf_linked.h": "#define PBF_EACH_LINKED(DO) DO(serial)\n",
                 "pbf_cpu_sources.h": "#define PBF_CPU_SOURCES \"in one file\"\n"}
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "pbf_all.c").write_text(c_file(generated), encoding="utf-8")
    (folder / "pbf_all.cpp").write_text(cpp_file(generated, dimension, bits), encoding="utf-8")
    (folder / "pbf").mkdir(exist_ok=True)
    for header in [ROOT / "include/pbf/all.h", *public_headers(ROOT)]:
        shutil.copyfile(header, folder / "pbf" / header.name)


if __name__ == "__main__":
    main()
