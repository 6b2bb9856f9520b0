"""libpbf itself: its declarations, as they were preprocessed from all.h, and the library, loaded.

`ffi` and `lib` are cffi's, in ABI mode: nothing is compiled against Python. Whatever the package
does not wrap can be called through them.
"""
from __future__ import annotations

import pathlib
from typing import Any

import cffi

_FOLDER = pathlib.Path(__file__).resolve().parent

# DLPack's tensor, which views.h only names: https://dmlc.github.io/dlpack/latest/c_api.html
_DLPACK = """
typedef struct { int32_t device_type; int32_t device_id; } DLDevice;
typedef struct { uint8_t code; uint8_t bits; uint16_t lanes; } DLDataType;
typedef struct {
  void *data; DLDevice device; int32_t ndim; DLDataType dtype;
  int64_t *shape; int64_t *strides; uint64_t byte_offset;
} DLTensor;
typedef struct DLManagedTensor {
  DLTensor dl_tensor; void *manager_ctx; void (*deleter)(struct DLManagedTensor *);
} DLManagedTensor;
"""


def _load() -> tuple[Any, Any]:
    declarations, library = _FOLDER / "_pbf.h", _FOLDER / "lib" / "libpbf.so"
    for path in (declarations, library):
        if not path.exists():
            raise ImportError(
                f"{path} is missing: this is the package's source, not its installed form. "
                "`pip install .` in the repository's root builds and installs it.")
    found = cffi.FFI()
    found.cdef(_DLPACK + declarations.read_text(encoding="utf-8"))
    return found, found.dlopen(str(library))


ffi, lib = _load()


def text(chars: Any) -> str:
    """A C string as one of Python's."""
    return str(ffi.string(chars).decode("utf-8", "replace"))


def new_struct(name: str) -> Any:
    """A struct of zeros that says its size."""
    struct = ffi.new(name + " *")
    struct.struct_size = ffi.sizeof(struct[0])
    return struct


def version() -> str:
    """The library's version at run time."""
    number = lib.pbf_version()
    return f"{number // 1000000}.{number // 1000 % 1000}.{number % 1000}"
