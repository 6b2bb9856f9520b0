"""The structs of examples/ctypes_demo.py."""
from .words import is_text

SCALARS = {"char": "c.c_char", "int32_t": "c.c_int32", "uint32_t": "c.c_uint32",
           "int64_t": "c.c_int64", "uint64_t": "c.c_uint64", "float": "c.c_float", "double": "c.c_double"}
CLASSES = {"pbf_desc": "Desc", "pbf_params": "Params", "pbf_view": "View"}


def type_of(kind):
    if "scalar" in kind:
        return SCALARS[kind["scalar"]]
    if "array" in kind:
        return f"{type_of(kind['array'])} * {kind['count']}"
    if is_text(kind):
        return "c.c_char_p"
    target = kind.get("pointer", {})
    if "scalar" in target and target["scalar"] in SCALARS:
        return f"c.POINTER({SCALARS[target['scalar']]})"
    return "c.c_void_p"


def mirror(name, value):
    lines, line = [], "       "
    for field in value["fields"]:
        entry = f'("{field["name"]}", {type_of(field["type"])}),'
        if len(line) + 1 + len(entry) > 99:
            lines.append(line)
            line = "       "
        line += " " + entry
    fields = "\n".join([*lines, line])
    return f"class {CLASSES[name]}(c.Structure):\n    _fields_ = [\n{fields}\n    ]\n"


def text(description):
    return "\n\n".join(mirror(name, description["structs"][name]) for name in CLASSES)
