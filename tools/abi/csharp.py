"""bindings/csharp/Pbf/Native.g.cs: structs with sequential layout, constants and P/Invoke."""
from .words import COMMENT, camel, is_status, is_text

SCALARS = {"void": "void", "uint8_t": "byte", "int32_t": "int", "uint32_t": "uint", "int64_t": "long",
           "uint64_t": "ulong", "float": "float", "double": "double", "pbf_status": "Status"}
VECTORS = {("double", 3): "Vector3d", ("double", 4): "Vector4d", ("double", 6): "Walls",
           ("uint32_t", 2): "Vector2u", ("uint32_t", 3): "Vector3u"}
OWNED = {name: f"Native{camel(name)}" for name in (
    "pbf_desc", "pbf_allocator", "pbf_read_desc", "pbf_anisotropy_desc", "pbf_diffuse_read", "pbf_samples", "pbf_sample_grid",
    "pbf_grid_desc", "pbf_mesh_desc", "pbf_heights_desc", "pbf_hull_desc", "pbf_collider",
    "pbf_view", "pbf_snapshot")}  # with pointers: a class or a method wraps them
OBJECTS = {"pbf_collider": {"geometry": "Pbf.Shape"}}  # seen with these classes for pointers
HANDLES = {"pbf_solver": "SolverHandle", "pbf_batch": "BatchHandle", "pbf_shape": "ShapeHandle"}
# A SafeHandle that is disposed of, or not made yet, takes part in no other call.
RAW = {"pbf_destroy", "pbf_unmap", "pbf_batch_destroy", "pbf_hold_shape", "pbf_release_shape"}
KEYWORDS = {"params": "parameters"}
ARRAYS = {"ids", "counts", "distances", "normal", "normals", "levels", "loads", "flows", "phases"}  # written to


def struct_name(name):
    return OWNED.get(name, camel(name))


def field_of(field):
    """The declaration of a field."""
    kind, name = field["type"], camel(field["name"])
    if "array" in kind:
        of, count = kind["array"], kind["count"]
        if (of.get("scalar"), count) in VECTORS:
            return f"public {VECTORS[of['scalar'], count]} {name};"
        if of == {"scalar": "char"}:
            return (f"[MarshalAs(UnmanagedType.ByValTStr, SizeConst = {count})]\n"
                    f"        public string {name};")
        element = SCALARS[of["scalar"]] if "scalar" in of else struct_name(of["struct"])
        return (f"[MarshalAs(UnmanagedType.ByValArray, SizeConst = {count})]\n"
                f"        public {element}[] {name};")
    if "scalar" in kind:
        return f"public {SCALARS[kind['scalar']]} {name};"
    return f"public IntPtr {name};"  # a pointer, to data or to a function


def struct(name, value):
    fields = "\n".join("        " + field_of(field) for field in value["fields"])
    access = "internal" if name in OWNED else "public"
    return ("    [StructLayout(LayoutKind.Sequential, CharSet = CharSet.Ansi)]\n"
            f"    {access} partial struct {struct_name(name)}\n    {{\n{fields}\n    }}")


def with_objects(name, objects, value):
    """The struct that programs see, which keeps alive what its pointers point to."""
    fields = [(camel(field["name"]), objects.get(field["name"])) for field in value["fields"]]
    declared = "\n".join(f"        public {objects[field['name']]} {camel(field['name'])};" if field["name"] in objects
                         else "        " + field_of(field) for field in value["fields"])
    out = ",\n".join(f"                {field} = {kind}.AddressOf({field})" if kind else f"                {field} = {field}"
                     for field, kind in fields)
    back = "\n".join(f"            {field} = {kind}.At(from.{field});" if kind else f"            {field} = from.{field};"
                     for field, kind in fields)
    return (f"    public partial struct {camel(name)}\n    {{\n{declared}\n\n"
            f"        internal {camel(name)}({struct_name(name)} from)\n        {{\n{back}\n        }}\n\n"
            f"        internal {struct_name(name)} ForC()\n        {{\n"
            f"            return new {struct_name(name)}\n            {{\n{out}\n            }};\n        }}\n    }}")


def parameter_of(function, parameter):
    kind, name = parameter["type"], KEYWORDS.get(parameter["name"], parameter["name"])
    if "scalar" in kind:
        return f"{SCALARS[kind['scalar']]} {name}"
    if "pointer" in kind:
        target = kind["pointer"]
        if target.get("opaque") in HANDLES and function not in RAW:
            return f"{HANDLES[target['opaque']]} {name}"  # which can't be destroyed while a call is inside
        if "pointer" in target:
            return f"out IntPtr {name}"
        if "struct" in target and not kind["const"] and name not in ARRAYS:
            return f"ref {struct_name(target['struct'])} {name}"
        if target.get("scalar") in ("uint32_t", "uint64_t", "double") and not kind["const"] and name not in ARRAYS:
            return f"ref {SCALARS[target['scalar']]} {name}"
    return f"IntPtr {name}"


def returned(kind):
    return "IntPtr" if "pointer" in kind else SCALARS[kind["scalar"]]


def function(name, value):
    parameters = ", ".join(parameter_of(name, one) for one in value["parameters"])
    return ("        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]\n"
            f"        internal static extern {returned(value['returns'])} {name}({parameters});")


def callback(name, signature):
    kinds = []
    for index, kind in enumerate(signature["parameters"]):
        kinds.append(f"{SCALARS[kind['scalar']] if 'scalar' in kind else 'IntPtr'} argument{index}")
    return ("    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]\n"
            f"    internal delegate {returned(signature['returns'])} {camel(name)}({', '.join(kinds)});")


def constants(description):
    lines = [f"        public const uint {camel(name)} = {value};"
             for name, value in description["numbers"].items()]
    for enum in description["enums"]:
        if not is_status(enum):
            lines += [f"        public const uint {camel(name)} = {value};" for name, value in enum.items()]
    return "    /// <summary>What the C headers call PBF_….</summary>\n    public static class Constants\n    {\n" + "\n".join(lines) + "\n    }"


def status(description):
    enum = next(filter(is_status, description["enums"]))
    lines = ",\n".join(f"        {camel(name, 'PBF_ERROR_')} = {value}" for name, value in enum.items())
    return f"    public enum Status\n    {{\n{lines}\n    }}"


def layout(description):
    """For the test: what Marshal must say of each struct."""
    lines = []
    for name, value in description["structs"].items():
        offsets = ", ".join(f'"{camel(field["name"])}={field["offset"]}"' for field in value["fields"])
        lines.append(f"            {{ typeof({struct_name(name)}), new[] {{ \"{value['size']}\", {offsets} }} }}")
    return ("    /// <summary>Sizes and offsets of the C compiler, for tests.</summary>\n"
            "    internal static class Layout\n    {\n"
            "        internal static readonly Dictionary<Type, string[]> Structs = new Dictionary<Type, string[]>\n"
            "        {\n" + ",\n".join(lines) + "\n        };\n    }")


def text(description):
    functions = "\n".join(function(*item) for item in description["functions"].items())
    native = ("    internal static class Native\n    {\n"
              "#if UNITY_IOS && !UNITY_EDITOR\n"
              '        internal const string Library = "__Internal";\n'
              "#else\n"
              '        internal const string Library = "pbf";\n'
              "#endif\n" + functions + "\n    }")
    parts = [status(description), constants(description),
             *(callback(*item) for item in description["callbacks"].items()),
             *(struct(*item) for item in description["structs"].items()),
             *(with_objects(name, objects, description["structs"][name]) for name, objects in OBJECTS.items()),
             native, layout(description)]
    return (f"// {COMMENT}\n#pragma warning disable 1591\nusing System;\n"
            "using System.Collections.Generic;\nusing System.Runtime.InteropServices;\n\n"
            "namespace Pbf\n{\n" + "\n\n".join(parts) + "\n}\n")
