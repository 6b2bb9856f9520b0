"""bindings/js: what the module for browsers and node knows of the ABI, and what TypeScript sees of it.

    abi.g.mjs      numbers, and where the fields of structs lie in WebAssembly, with pointers of 32 bits
    abi.g.d.mts     an interface for each struct that programs see
    layout.g.c     that the compiler lays the structs out so; it is compiled into the module
    exports.g.json the functions that the module exports
"""
import json

from .words import COMMENT

SCALARS = {"char": ("text", 1), "uint8_t": ("u8", 1), "int32_t": ("i32", 4), "uint32_t": ("u32", 4),
           "int64_t": ("i64", 8), "uint64_t": ("u64", 8), "double": ("f64", 8)}
# In JavaScript: memory of others' and threads have no place there.
LEFT_OUT = ("pbf_export_dlpack", "pbf_batch_export_dlpack", "pbf_load_backend", "pbf_read", "pbf_write", "pbf_get_anisotropies", "pbf_begin_step",
            "pbf_end_step", "pbf_cancel", "pbf_set_snapshots", "pbf_acquire_snapshot", "pbf_release_snapshot",
            "pbf_get_backend_count", "pbf_get_backend_info", "pbf_keep_previous")
# Structs that programs see, by the names that they have there.
SEEN = {"pbf_params": "Params", "pbf_collider": "Collider", "pbf_collider_load": "ColliderLoad",
        "pbf_stats": "Stats", "pbf_info": "Info",
        "pbf_plan_stage": "PlanStage", "pbf_plan_array": "PlanArray", "pbf_plan": "Plan",
        "pbf_stage_time": "StageTime", "pbf_timings": "Timings",
        "pbf_volume": "Volume", "pbf_volume_flow": "Flow", "pbf_emitter": "Emitter", "pbf_in_out": "InOut",
        "pbf_reservoir": "Reservoir", "pbf_diffuse_desc": "Diffuse", "pbf_diffuse_info": "DiffuseInfo",
        "pbf_phase": "Phase", "pbf_shape_info": "ShapeInfo"}
USED = ["pbf_desc", *SEEN, "pbf_view", "pbf_read_desc", "pbf_samples", "pbf_sample_grid", "pbf_diffuse_read", "pbf_grid_desc",
        "pbf_mesh_desc", "pbf_heights_desc", "pbf_hull_desc", "pbf_batch_info"]
NOT_SEEN = ("struct_size", "reserved")
# Fields that are something else there than a number.
TYPES = {("pbf_collider", "shape"): '"plane" | "sphere" | "capsule" | "box" | Shape', ("pbf_collider", "geometry"): None,
         ("pbf_volume", "shape"): '"box" | "sphere" | "capsule"', ("pbf_emitter", "shape"): '"rectangle" | "disc"'}


def camel(name):
    first, *others = name.split("_")
    return first + "".join(part[:1].upper() + part[1:] for part in others)


def is_exported(name):
    return name not in LEFT_OUT


def layout(kind, structs):
    """(what it is, bytes, alignment, how many)"""
    if "scalar" in kind:
        name, size = SCALARS[kind["scalar"]]
        return name, size, size, None
    if "array" in kind:
        name, size, alignment, _ = layout(kind["array"], structs)
        return name, size * kind["count"], alignment, kind["count"]
    if "struct" in kind:
        held = structs[kind["struct"]]
        return kind["struct"], held["size"], held["alignment"], None
    return "pointer", 4, 4, None


def structs_of(description):
    """Name → size, alignment and fields (name, what it is, offset, how many)."""
    structs = {}
    for name in USED:
        offset, alignment, fields = 0, 1, []
        for field in description["structs"][name]["fields"]:
            what, size, step, count = layout(field["type"], structs)
            offset = -(-offset // step) * step
            fields.append((field["name"], what, offset, count))
            offset, alignment = offset + size, max(alignment, step)
        structs[name] = {"size": -(-offset // alignment) * alignment, "alignment": alignment, "fields": fields}
    return structs


def numbers_of(description):
    numbers = dict(description["numbers"])
    for enum in description["enums"]:
        numbers.update(enum)
    return {name.removeprefix("PBF_"): value for name, value in numbers.items()}


def module(description):
    lines = [f"// {COMMENT}", "export const constants = Object.freeze({"]
    lines += [f"  {name}: {value}," for name, value in numbers_of(description).items()]
    lines += ["});", "", "// Of each field what it is, where it lies and, of an array, how many it has.",
              "export const structs = {"]
    for name, struct in structs_of(description).items():
        lines += [f"  {name}: {{", f"    size: {struct['size']},", "    fields: {"]
        for field, what, offset, count in struct["fields"]:
            lines.append(f"      {camel(field)}: {json.dumps([what, offset] + ([count] if count else []))},")
        lines += ["    },", "  },"]
    return "\n".join(lines + ["};"]) + "\n"


def type_of(what, count):
    if what == "text":
        return "string"
    one = SEEN.get(what, "number")
    return f"{one}[]" if count else one


def declarations(description):
    lines = [f"// {COMMENT} Fields are those of the C headers, which say what each is.",
             'import type { Shape } from "./pbf.mjs";', ""]
    for name, value in SEEN.items():
        fields = [field for field in structs_of(description)[name]["fields"] if field[0] not in NOT_SEEN]
        lines += [f"export interface {value} {{",
                  *(f"  {camel(field)}: {TYPES.get((name, field), type_of(what, count))};" for field, what, _, count in fields
                    if TYPES.get((name, field), "") is not None), "}", ""]
    lines += ["export declare const constants: {"]
    lines += [f"  readonly {name}: {value};" for name, value in numbers_of(description).items()]
    return "\n".join(lines + ["};"]) + "\n"


def asserts(description):
    lines = [f"/* {COMMENT} */", "#include <pbf/all.h>", "#include <stddef.h>", ""]
    for name, struct in structs_of(description).items():
        lines.append(f"_Static_assert(sizeof({name}) == {struct['size']}, \"as abi.g.mjs has it\");")
        lines += [f"_Static_assert(offsetof({name}, {field}) == {offset}, \"as abi.g.mjs has it\");"
                  for field, _, offset, _ in struct["fields"]]
    return "\n".join(lines) + "\n"


def exports(description):
    names = [f"_{name}" for name in description["functions"] if is_exported(name)]
    return json.dumps(["_malloc", "_free", "_pbf_js_log_function", *names], indent=0) + "\n"


def files(description):
    return {"bindings/js/abi.g.mjs": module(description), "bindings/js/abi.g.d.mts": declarations(description),
            "bindings/js/layout.g.c": asserts(description), "bindings/js/exports.g.json": exports(description)}
