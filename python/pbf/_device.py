"""Arrays in the memory of a GPU, by the interface that PyTorch, CuPy, Numba and others have."""
from __future__ import annotations

import math
import operator
import sys
from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np

from ._errors import InvalidArgumentError
from ._library import ffi
from ._numbers import ADDRESS_MAX, integer, shown

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
    return integer("stream", 0 if stream is None else stream, ADDRESS_MAX) or LEGACY_DEFAULT


def stream_handle(stream: Any) -> int:
    """A handle as an integer: PyTorch's streams and CuPy's have one."""
    found = stream
    for name in ("cuda_stream", "ptr", "handle"):
        found = getattr(found, name, found)
    try:
        return integer("stream", found, ADDRESS_MAX) or LEGACY_DEFAULT
    except InvalidArgumentError:
        raise InvalidArgumentError(
            f"stream is {shown(stream)}; it must be a cudaStream_t as an integer, or a stream of "
            "PyTorch or CuPy") from None


def _numbers(name: str, given: Any, least: int) -> tuple[int, ...]:
    found = tuple(operator.index(number) for number in given)
    if not all(least <= number < 2**63 for number in found):
        raise ValueError(f"{name} is {shown(found)}")
    return found


def _layout(interface: Mapping[str, Any]) -> tuple[np.dtype[Any], tuple[int, ...], tuple[int, ...]]:
    dtype, shape = np.dtype(str(interface["typestr"])), _numbers("shape", interface["shape"], 0)
    if interface.get("mask") is not None:
        raise ValueError("some of its numbers are masked")
    given = interface.get("strides")
    if given is None:
        return dtype, shape, tuple(
            dtype.itemsize * math.prod(shape[k + 1:]) for k in range(len(shape)))
    strides = _numbers("strides", given, -2**63)
    if len(strides) != len(shape):
        raise ValueError(f"strides is {shown(given)} and shape {shown(shape)}")
    return dtype, shape, strides


def _described(array: Any, interface: Mapping[str, Any], stream: Any) -> DeviceArray:
    dtype, shape, strides = _layout(interface)
    data, readonly = interface["data"]
    used = _current_stream(array, interface) if stream is None else stream_handle(stream)
    return DeviceArray(integer("data", data or 0, ADDRESS_MAX), shape, strides, dtype, not readonly,
                       used)


def device_array_of(name: str, array: Any, stream: Any = None) -> DeviceArray | None:
    """None of an array in host memory. Whatever an object says of itself may be wrong."""
    try:
        interface = getattr(array, "__cuda_array_interface__", None)
        if interface is not None:
            return _described(array, interface, stream)
    except InvalidArgumentError:
        raise
    except Exception as error:
        raise InvalidArgumentError(
            f"{name} can't be used on a GPU, by what its __cuda_array_interface__ says: "
            f"{type(error).__name__}: {error}") from error
    if stream is not None:
        raise InvalidArgumentError(f"stream is given, and {name} is not on a GPU")
    return None


def place(struct: Any, array: DeviceArray, device_type: int) -> None:
    """Has a description name the array's memory."""
    struct.data = ffi.cast("void *", array.data)
    struct.device_type = device_type
    struct.stream = ffi.cast("void *", array.stream)
