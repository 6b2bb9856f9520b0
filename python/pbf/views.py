"""Particles without a copy: views of the solver's own memory, and snapshots."""
from __future__ import annotations

import ctypes
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import CPU, readonly_array
from ._errors import StateError, UnsupportedError, check
from ._library import ffi, lib, new_struct
from ._owned import Uncopied

if TYPE_CHECKING:
    from ._handle import Handle

_PyCapsule_New = ctypes.PYFUNCTYPE(
    ctypes.py_object, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)(
        ("PyCapsule_New", ctypes.pythonapi))
_PyCapsule_IsValid = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p)(
    ("PyCapsule_IsValid", ctypes.pythonapi))
_PyCapsule_GetPointer = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi))


def _delete(tensor: Any) -> None:
    tensor.deleter(tensor)


@ctypes.PYFUNCTYPE(None, ctypes.c_void_p)  # type: ignore[untyped-decorator]
def _free_capsule(capsule: int) -> None:
    """Whoever takes a tensor out of its capsule renames it, and frees the tensor itself."""
    if _PyCapsule_IsValid(capsule, b"dltensor"):
        _delete(ffi.cast("DLManagedTensor *", _PyCapsule_GetPointer(capsule, b"dltensor")))


def _delete_held(place: Any) -> None:
    tensor, place[0] = place[0], ffi.NULL
    if tensor:
        tensor.deleter(tensor)


def place_for_tensor() -> Any:
    """Where a call puts a tensor, which ends with it: from the call on, whatever interrupts it."""
    return ffi.gc(ffi.new("struct DLManagedTensor **"), _delete_held)


def capsule_of(place: Any) -> Any:
    """Which takes the tensor out of its place, and which the consumer empties, or which frees it."""
    address = int(ffi.cast("uintptr_t", place[0]))
    free = ctypes.cast(_free_capsule, ctypes.c_void_p)
    place[0] = ffi.NULL
    return _PyCapsule_New(address, b"dltensor", free)


def _export(solver: Handle, field: int) -> Any:
    place = place_for_tensor()
    check(lib.pbf_export_dlpack(solver.handle, field, place))
    return place


def dtype_of(tensor: Any) -> np.dtype[Any]:
    return np.dtype(f"{'iuf'[tensor.dtype.code]}{tensor.dtype.bits // 8}")


class _Exported:
    """A tensor of one field. The solver's particles can't change until it is gone."""

    def __init__(self, solver: Handle, field: int) -> None:
        self._callbacks = solver._callbacks
        self._place = _export(solver, field)
        self.managed = self._place[0]

    @property
    def device(self) -> tuple[int, int]:
        device = self.managed.dl_tensor.device
        return device.device_type, device.device_id

    def array(self) -> NDArray[Any]:
        tensor = self.managed.dl_tensor
        dtype, dims = dtype_of(tensor), range(tensor.ndim)
        shape = tuple(tensor.shape[k] for k in dims)
        strides = tuple(tensor.strides[k] * dtype.itemsize for k in dims)
        if shape[1] == 1:
            shape, strides = shape[:1], strides[:1]
        return readonly_array(self, tensor.data, shape, dtype, strides)


class View(Uncopied):
    """One field in the solver's own memory, in the order in which it lies there; `ids` tells it.

    While the view, or an array or tensor made of it, is alive, what would change the particles
    raises `StateError`. Use it in a `with` block, or let go of it:

    >>> with fluid.view("position") as view:
    ...     mean = view.array.mean(axis=0)

    It may outlive the solver. It is read-only: PyTorch and others, which know no such thing, must
    not write to it.
    """

    def __init__(self, solver: Handle, field: int) -> None:
        self._solver: Handle | None = solver
        self._field = field
        self._exported: _Exported | None = _Exported(solver, field)
        self._ids: NDArray[np.uint32] | None = None
        self._array: NDArray[Any] | None = None

    def _held(self) -> _Exported:
        if self._exported is None:
            raise StateError("this view has been released")
        return self._exported

    @property
    def array(self) -> NDArray[Any]:
        """The view as a NumPy array without a copy, of shape (count, dimension) or (count,)."""
        exported = self._held()
        if exported.device[0] != CPU:
            raise UnsupportedError(
                "the view is in a GPU's memory, which NumPy can't see: torch.from_dlpack(view) or "
                "cupy.from_dlpack(view) take it there, Solver.read copies it to the host")
        if self._array is None:
            self._array = exported.array()
        return self._array

    @property
    def ids(self) -> NDArray[np.uint32]:
        """Which element is which particle."""
        self._held()
        if self._ids is None and self._solver is not None:
            self._ids = View(self._solver, lib.PBF_FIELD_ID).array
        assert self._ids is not None
        return self._ids

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        array = self.array
        if dtype is not None and np.dtype(dtype) != array.dtype:
            return array.astype(dtype)
        return array.copy() if copy else array

    def __dlpack_device__(self) -> tuple[int, int]:
        return self._held().device

    def __dlpack__(self, *, stream: Any = None, max_version: tuple[int, int] | None = None,
                   dl_device: tuple[int, int] | None = None, copy: bool | None = None) -> Any:
        """A capsule of shape (count, components); its consumer keeps the view alive."""
        device = self.__dlpack_device__()
        if dl_device is not None and tuple(map(int, dl_device)) != device:
            raise BufferError(f"the view is on device {device}, not on {dl_device}")
        if copy:
            if device[0] != CPU:
                raise BufferError("the view can't copy a GPU's memory; its consumer can")
            return np.array(self.array).__dlpack__()
        solver = self._solver
        if solver is None or solver.closed:
            raise BufferError("the view's solver is closed")
        if device[0] != CPU:
            solver.synchronize()  # whatever stream the consumer works on
        return capsule_of(_export(solver, self._field))

    def __len__(self) -> int:
        return int(self._held().managed.dl_tensor.shape[0])

    def release(self) -> None:
        """Lets go of the memory; arrays and tensors made of the view hold it until they are gone."""
        self._exported = self._array = self._ids = self._solver = None

    def __enter__(self) -> View:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.release()


class _Held:
    """A snapshot that is held until nothing refers to this."""

    def __init__(self, solver: Handle) -> None:
        self._callbacks = solver._callbacks
        self.struct = ffi.gc(new_struct("pbf_snapshot"), lib.pbf_release_snapshot)
        check(lib.pbf_acquire_snapshot(solver.handle, self.struct))


class Snapshot:
    """The state at the end of a step, which stays as it is while it is held, also beside steps that
    run, and after the solver is gone. Arrays of it are read-only and without a copy."""

    def __init__(self, solver: Handle) -> None:
        held = _Held(solver)
        struct = held.struct
        count, dtype = struct.count, np.dtype(f"f{struct.element_type}")
        shape = (count, struct.dimension)
        self.step: int = struct.step
        self.time: float = struct.time
        self.count: int = count
        self._arrays: dict[str, NDArray[Any]] | None = {
            "positions": readonly_array(held, struct.positions, shape, dtype),
            "velocities": readonly_array(held, struct.velocities, shape, dtype),
            "ids": readonly_array(held, struct.ids, (count,), np.uint32)}

    def _array(self, name: str) -> NDArray[Any]:
        if self._arrays is None:
            raise StateError("this snapshot has been released")
        return self._arrays[name]

    @property
    def positions(self) -> NDArray[Any]:
        return self._array("positions")

    @property
    def velocities(self) -> NDArray[Any]:
        return self._array("velocities")

    @property
    def ids(self) -> NDArray[np.uint32]:
        return self._array("ids")

    def __len__(self) -> int:
        return self.count

    def release(self) -> None:
        """Lets go of it; arrays that were taken from it hold it until they are gone."""
        self._arrays = None

    def __enter__(self) -> Snapshot:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.release()
