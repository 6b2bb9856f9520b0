"""bindings/lua/pbf/cdef.lua: the declarations as C, for LuaJIT's ffi.cdef."""
from .words import COMMENT


def spelled(kind, name=""):
    """A declaration of `name`; without one, the type."""
    if "array" in kind:
        return f"{spelled(kind['array'], name)}[{kind['count']}]"
    if "pointer" in kind:
        constant = "const " if kind["const"] else ""
        return f"{constant}{spelled(kind['pointer'])} *{name}"
    base = kind.get("scalar") or kind.get("struct") or kind.get("opaque") or kind["callback"]
    base = "struct " + base if kind.get("opaque") == "DLManagedTensor" else base
    return f"{base} {name}".rstrip()


def parameters(kinds):
    return ", ".join(kinds) or "void"


def text(description):
    lines = ["typedef int32_t pbf_status;"]
    for enum in description["enums"]:
        lines += ["enum {", *(f"  {name} = {value}," for name, value in enum.items()), "};"]
    lines += ["enum {", *(f"  {name} = {value}," for name, value in description["numbers"].items()), "};"]
    for name in description["opaque"]:
        lines.append(f"struct {name};" if name == "DLManagedTensor" else f"typedef struct {name} {name};")
    for name, value in description["callbacks"].items():
        kinds = parameters(map(spelled, value["parameters"]))
        lines.append(f"typedef {spelled(value['returns'], '(*' + name + ')')}({kinds});")
    for name, value in description["structs"].items():
        lines += [f"typedef struct {name} {{",
                  *(f"  {spelled(field['type'], field['name'])};" for field in value["fields"]),
                  f"}} {name};"]
    for name, value in description["functions"].items():
        kinds = parameters(spelled(one["type"], one["name"]) for one in value["parameters"])
        lines.append(f"{spelled(value['returns'], name)}({kinds});")
    layouts = "\n".join(
        f"  {name} = {{size = {value['size']}, "
        + ", ".join(f"{field['name']} = {field['offset']}" for field in value["fields"]) + "},"
        for name, value in description["structs"].items())
    declarations = "\n".join(lines)
    return (f"-- {COMMENT}\nlocal ffi = require(\"ffi\")\nffi.cdef [[\n{declarations}\n]]\n"
            "-- Where the C compiler has each field; spec for the test of this module.\n"
            f"return {{\n{layouts}\n}}\n")
