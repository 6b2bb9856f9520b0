"""What callers pass as arrays, as NumPy's; memory of the library, as NumPy's."""
from __future__ import annotations

from typing import Any, Literal, Protocol, Union

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ._errors import InvalidArgumentError
from ._library import ffi

CPU = 1  # DLPack's number


class SupportsDLPack(Protocol):
    """An array of PyTorch, CuPy, JAX, …"""

    def __dlpack__(self, *, stream: Any = ...) -> Any: ...

    def __dlpack_device__(self) -> tuple[int, int]: ...


AnyArray = Union[ArrayLike, SupportsDLPack]


def _on_host(array: Any) -> Any:
    """The same tensor in host memory, by the ways that PyTorch, CuPy and JAX have."""
    for way in ("detach", "cpu", "get"):
        if hasattr(array, way):
            array = getattr(array, way)()
    return array


def numpy_of(name: str, array: AnyArray) -> NDArray[Any]:
    """Any array as NumPy's, without a copy where it is in host memory."""
    if isinstance(array, np.ma.MaskedArray) and np.ma.is_masked(array):
        raise InvalidArgumentError(f"{name} has masked numbers; fill them, or leave their rows out")
    if isinstance(array, np.ndarray):
        return array
    if hasattr(array, "__dlpack__") and hasattr(array, "__dlpack_device__"):
        try:
            array = _by_dlpack(array)
        except Exception as error:
            raise _not_made(name, error) from error
    try:
        return np.asarray(array)
    except Exception as error:
        raise _not_made(name, error) from error


def _not_made(name: str, error: Exception) -> InvalidArgumentError:
    return InvalidArgumentError(
        f"{name} can't be made a NumPy array: {type(error).__name__}: {error}")


def _by_dlpack(array: Any) -> Any:
    """NumPy's in host memory, or what NumPy may make one of by other ways."""
    if array.__dlpack_device__()[0] != CPU or getattr(array, "requires_grad", False):
        array = _on_host(array)
    if isinstance(array, np.ndarray) or array.__dlpack_device__()[0] != CPU:
        return array
    try:
        return np.from_dlpack(array)
    except BufferError:
        return array


def host_memory_of(name: str, array: Any) -> NDArray[Any]:
    """An array in host memory that can be written to, not a copy."""
    if isinstance(array, np.ndarray):
        return array
    try:
        device = getattr(array, "__dlpack_device__", lambda: (None,))()[0]
        if device == CPU:
            return np.from_dlpack(array)
    except Exception as error:
        raise _not_made(name, error) from error
    raise InvalidArgumentError(
        f"{name} is a {type(array).__name__}; it must be an array in host memory, or one with "
        "__cuda_array_interface__")


def real_numbers(name: str, array: NDArray[Any]) -> NDArray[Any]:
    if array.dtype.kind not in "fiu":
        raise InvalidArgumentError(f"{name} holds {array.dtype}; it must hold real numbers")
    return array


def packed(name: str, array: NDArray[Any], dtype: DTypeLike, order: Literal["C", "F"] = "C"
           ) -> NDArray[Any]:
    """As the library reads it, of this type, without gaps and aligned: no copy where it is so. What the
    type does not hold is told by the number that was given."""
    given = real_numbers(name, array)
    with np.errstate(over="ignore", invalid="ignore"):
        cast: NDArray[Any] = np.require(given, dtype, [order, "A", "E"])
    if given.dtype.kind == "f" and given.dtype.itemsize > cast.dtype.itemsize:
        lost = np.isfinite(given) & ~np.isfinite(cast)
        if lost.any():
            at = tuple(int(index) for index in np.argwhere(lost)[0])
            place = "".join(f"[{index}]" for index in at)
            raise InvalidArgumentError(
                f"{name}{place} is {given[at]}; it must be a number that {cast.dtype.name} holds, at "
                f"most {np.finfo(cast.dtype).max:.2g} in size")
    return cast


def rows_of(name: str, array: AnyArray, dimension: int, dtype: DTypeLike) -> NDArray[Any]:
    """An array of shape (count, dimension), as the library reads it: no copy where it is so."""
    given = numpy_of(name, array)
    if given.ndim == 1 and given.size in (0, dimension):
        given = given.reshape(-1, dimension)
    if given.ndim != 2 or given.shape[1] != dimension:
        raise InvalidArgumentError(
            f"{name} has the shape {given.shape}; this solver wants (count, {dimension})")
    return packed(name, given, dtype)


def ids_of(ids: AnyArray) -> NDArray[np.uint32]:
    given = numpy_of("ids", ids)
    if given.size and (given.dtype.kind not in "iu" or given.min() < 0
                       or given.max() > np.iinfo(np.uint32).max):
        raise InvalidArgumentError(f"ids are of {given.dtype}; they must be integers, 0 … 4294967295")
    return np.require(given, np.uint32, ["C", "A", "E"]).reshape(-1)


def pointer(array: NDArray[Any]) -> Any:
    return ffi.cast("void *", array.ctypes.data)


class _Memory:
    """What NumPy keeps as the base of an array: it holds the owner of the memory."""

    def __init__(self, owner: Any, interface: dict[str, Any]) -> None:
        self.owner = owner
        self.__array_interface__ = interface


def readonly_array(owner: Any, data: Any, shape: tuple[int, ...], dtype: DTypeLike,
                   strides: tuple[int, ...] | None = None) -> NDArray[Any]:
    """An array over memory of the library, which lives as long as any array over it."""
    if 0 in shape:
        empty = np.empty(shape, dtype)
        empty.flags.writeable = False
        return empty
    address = int(ffi.cast("uintptr_t", data))
    return np.asarray(_Memory(owner, {
        "version": 3, "shape": shape, "strides": strides, "typestr": np.dtype(dtype).str,
        "data": (address, True)}))
