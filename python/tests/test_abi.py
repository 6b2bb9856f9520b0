"""cffi's view of the header against the compiler's."""
import dataclasses
import pathlib
import shutil
import subprocess

import pytest

import pbf

HEADER = pathlib.Path(__file__).resolve().parents[2] / "include"


def structs():
    names = [name for name in pbf.ffi.list_types()[0] if name.startswith("pbf_")]
    kinds = {name: pbf.ffi.typeof(name) for name in names}
    return {name: kind for name, kind in kinds.items() if kind.kind == "struct" and kind.fields}


def test_layouts_are_the_compilers(tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or not HEADER.exists():
        pytest.skip("needs a C compiler and pbf.h")
    lines = ["#include <pbf/all.h>", "#include <stddef.h>", "#include <stdio.h>", "int main(void) {"]
    expected = []
    for name, kind in structs().items():
        lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
        expected.append(f"{name} {pbf.ffi.sizeof(kind)}")
        for field, info in kind.fields:
            lines.append(f'printf("{name}.{field} %zu\\n", offsetof({name}, {field}));')
            expected.append(f"{name}.{field} {info.offset}")
    source, program = tmp_path / "layout.c", tmp_path / "layout"
    source.write_text("\n".join([*lines, "return 0; }"]))
    subprocess.run([compiler, "-I", str(HEADER), "-o", str(program), str(source)], check=True)
    printed = subprocess.run([str(program)], check=True, capture_output=True, text=True).stdout
    assert printed.split("\n")[:-1] == expected
    assert len(expected) > 150  # that something was looked at


def test_every_function_of_the_header_is_in_the_library():
    functions = [name for name in dir(pbf.lib) if name.startswith("pbf_")]
    assert len(functions) > 45
    for name in functions:
        assert getattr(pbf.lib, name)


def test_constants():
    assert pbf.lib.PBF_MAX_CAPACITY == 0x3FFFFFFF
    assert pbf.lib.PBF_ERROR_CANCELLED == -13
    assert pbf.__version__ == ".".join(
        str(getattr(pbf.lib, f"PBF_VERSION_{part}")) for part in ("MAJOR", "MINOR", "PATCH"))


@pytest.mark.parametrize("struct, kind", [
    ("pbf_stats", pbf.Stats), ("pbf_info", pbf.Info), ("pbf_plan", pbf.Plan),
    ("pbf_plan_stage", pbf.PlanStage), ("pbf_plan_array", pbf.PlanArray),
    ("pbf_stage_time", pbf.StageTime), ("pbf_backend_info", pbf.BackendInfo),
    ("pbf_collider", pbf.Box)])
def test_reports_have_every_field(struct, kind):
    fields = [name for name, _ in pbf.ffi.typeof(struct).fields]
    left_out = {"struct_size", "reserved", "stage_count", "array_count"}
    if struct == "pbf_collider":
        left_out.add("shape")
    assert {field.name for field in dataclasses.fields(kind)} == set(fields) - left_out


def test_every_parameter_is_an_attribute():
    fields = [name for name, _ in pbf.ffi.typeof("pbf_params").fields]
    assert list(pbf.params.fields()) == [
        name for name in fields if name not in ("struct_size", "reserved")]


def test_every_status_has_an_exception():
    statuses = {getattr(pbf.lib, name) for name in dir(pbf.lib) if name.startswith("PBF_ERROR_")}
    classes = {kind.status for kind in pbf.Error.__subclasses__()}
    assert classes == statuses
