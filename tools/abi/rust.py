"""bindings/rust/pbf-sys/src/lib.rs: the declarations, and that this compiler lays them out alike."""
from .words import COMMENT, is_status

SCALARS = {"void": "c_void", "char": "c_char", "uint8_t": "u8", "int32_t": "i32", "uint32_t": "u32", "int64_t": "i64",
           "uint64_t": "u64", "float": "f32", "double": "f64", "pbf_status": "pbf_status"}

HEAD = f"""//! The C API of pbf (`include/pbf/all.h`), which says what each of these is. {COMMENT}
#![allow(non_camel_case_types)]

use std::os::raw::{{c_char, c_void}};

/// A code: [`PBF_OK`] or one of `PBF_ERROR_…`.
pub type pbf_status = i32;
"""


def type_of(kind):
    if "scalar" in kind:
        return SCALARS[kind["scalar"]]
    if "pointer" in kind:
        return f"*{'const' if kind['const'] else 'mut'} {type_of(kind['pointer'])}"
    if "array" in kind:
        return f"[{type_of(kind['array'])}; {kind['count']}]"
    return kind.get("struct") or kind.get("opaque") or kind["callback"]


def returned(kind):
    return "" if kind == {"scalar": "void"} else f" -> {type_of(kind)}"


def constants(description):
    lines = [f"pub const {name}: u32 = {value};" for name, value in description["numbers"].items()]
    for enum in description["enums"]:
        kind = "pbf_status" if is_status(enum) else "u32"
        lines += [f"pub const {name}: {kind} = {value};" for name, value in enum.items()]
    return "\n".join(lines)


def opaque(name):
    return (f"#[repr(C)]\npub struct {name} {{\n    _opaque: [u8; 0],\n"
            "    _not_send: std::marker::PhantomData<*mut u8>,\n}")


def callback(name, signature):
    parameters = ", ".join(map(type_of, signature["parameters"]))
    return (f"pub type {name} =\n    Option<unsafe extern \"C\" fn({parameters})"
            f"{returned(signature['returns'])}>;")


def struct(name, value):
    fields = "\n".join(f"    pub {field['name']}: {type_of(field['type'])}," for field in value["fields"])
    return f"#[repr(C)]\n#[derive(Clone, Copy)]\npub struct {name} {{\n{fields}\n}}"


def layout(name, value):
    offsets = "\n".join(f"        assert_eq!(offset!({name}, {field['name']}), {field['offset']});"
                        for field in value["fields"])
    return (f"    #[test]\n    fn {name}_lies_as_in_c() {{\n"
            f"        assert_eq!(size_of::<{name}>(), {value['size']});\n{offsets}\n    }}")


TESTS = """#[cfg(all(test, target_pointer_width = "64"))]
mod layout {{
    use super::*;
    use std::mem::{{size_of, MaybeUninit}};

    macro_rules! offset {{
        ($struct:ty, $field:ident) => {{{{
            let place = MaybeUninit::<$struct>::uninit();
            let start = place.as_ptr();
            unsafe {{ std::ptr::addr_of!((*start).$field) as usize - start as usize }}
        }}}};
    }}

{tests}
}}"""


def function(name, value):
    parameters = "".join(f"\n        {one['name']}: {type_of(one['type'])},"
                         for one in value["parameters"])
    end = "\n    " if parameters else ""
    return f"    pub fn {name}({parameters}{end}){returned(value['returns'])};"


def text(description):
    functions = "\n".join(function(*item) for item in description["functions"].items())
    parts = [HEAD.rstrip(), constants(description), *map(opaque, description["opaque"]),
             *(callback(*item) for item in description["callbacks"].items()),
             *(struct(*item) for item in description["structs"].items()),
             f'extern "C" {{\n{functions}\n}}',
             TESTS.format(tests="\n\n".join(layout(*item) for item in description["structs"].items()))]
    return "\n\n".join(parts) + "\n"
