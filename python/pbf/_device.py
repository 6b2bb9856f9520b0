"""Arrays in the memory of a GPU, by the interface that PyTorch, CuPy, Numba and others have."""
from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np

from ._errors import InvalidArgumentError
from ._library import ffi

LEGACY_DEFAULT = 1  # CUDA's handle of the default stream; 0 would be none


class SupportsCuda(Protocol):
    """An array on a GPU of PyTorch, CuPy, Numba, …"""

    @property
    def __cuda_array_interface__(self) -> Mapping[str, Any]: ...


class DeviceArray(NamedTuple):
    """What NumPy's arrays say of themselves, of one on a GPU."""

    data: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    dtype: np.dtype[Any]
    writeable: bool
    stream: int

    @property
    def ndim(self) -> int:
        return len(self.shape)

    @property
    def itemsize(self) -> int:
        return self.dtype.itemsize

    def __len__(self) -> int:
        return self.shape[0]


def _current_stream(array: Any, interface: Mapping[str, Any]) -> int:
    """The stream in which the array is worked on. PyTorch's arrays do not say."""
    stream = interface.get("stream")
    torch = sys.modules.get("torch")
    if stream is None and torch is not None and isinstance(array, torch.Tensor):
        stream = torch.cuda.current_stream(array.device).cuda_stream
    return int(stream or LEGACY_DEFAULT)


def stream_handle(stream: Any) -> int:
    """A handle as an integer: PyTorch's streams and CuPy's have one."""
    for name in ("cuda_stream", "ptr", "handle"):
        stream = getattr(stream, name, stream)
    try:
        return int(stream) or LEGACY_DEFAULT
    except (TypeError, ValueError):
        raise InvalidArgumentError(
            f"stream is {stream!r}; it must be a cudaStream_t as an integer, or a stream of PyTorch "
            "or CuPy") from None


def device_array_of(name: str, array: Any, stream: Any = None) -> DeviceArray | None:
    """None of an array in host memory."""
    try:
        interface = getattr(array, "__cuda_array_interface__", None)
    except (AttributeError, RuntimeError, TypeError) as error:
        raise InvalidArgumentError(f"{name} can't be used on a GPU: {error}") from error
    if interface is None:
        if stream is not None:
            raise InvalidArgumentError(f"stream is given, and {name} is not on a GPU")
        return None
    dtype, shape = np.dtype(interface["typestr"]), tuple(interface["shape"])
    strides = interface.get("strides")
    if strides is None:
        strides = tuple(dtype.itemsize * int(np.prod(shape[k + 1:])) for k in range(len(shape)))
    data, readonly = interface["data"]
    used = _current_stream(array, interface) if stream is None else stream_handle(stream)
    return DeviceArray(int(data or 0), shape, tuple(strides), dtype, not readonly, used)


def place(struct: Any, array: DeviceArray, device_type: int) -> None:
    """Has a description name the array's memory."""
    struct.data = ffi.cast("void *", array.data)
    struct.device_type = device_type
    struct.stream = ffi.cast("void *", array.stream)
