"""A solver's life, its parameters and what it is."""
from __future__ import annotations

import weakref
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import params as parameters
from ._callbacks import Callbacks, Log, Told, destroy
from ._choices import DETERMINISM, PRECISIONS, chars, choice, precision_of
from ._errors import Error, InvalidArgumentError, check
from ._library import ffi, lib, new_struct
from ._numbers import ADDRESS_MAX, integer, shown, uint32
from ._owned import Owned
from ._param_fields import ParamFields
from .params import Params
from .reports import Info

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._param_fields import ParamValues


def desc_struct(desc: Mapping[str, Any], stream: int, callbacks: Callbacks) -> tuple[Any, Any]:
    """A pbf_desc, and what it points to."""
    struct = ffi.new("pbf_desc *")
    check(lib.pbf_desc_init(struct, ffi.sizeof("pbf_desc")))
    for name in ("dimension", "capacity", "threads"):
        setattr(struct, name, uint32(name, desc[name]))
    struct.precision = PRECISIONS[desc["precision"]]
    struct.determinism = choice("determinism", desc["determinism"], DETERMINISM)
    struct.device = uint32("device", desc["device"])
    struct.strict = bool(desc["strict"])
    struct.backend = backend = chars("backend", desc["backend"])
    struct.isa = isa = chars("isa", desc["isa"])
    struct.stream = ffi.cast("void *", integer("stream", stream, ADDRESS_MAX))
    struct.log = callbacks.function
    return struct, (backend, isa)


def params_struct(params: Params) -> Any:
    if not isinstance(params, Params):
        raise InvalidArgumentError(f"params is {shown(params)}; it must be a Params")
    return params.copy()._get_params()


class Handle(Owned, ParamFields):
    """A pbf_solver, which is freed when nothing refers to it."""

    _what = "solver"

    # ---- Life ----------------------------------------------------------------------------------

    def _create(self, desc: dict[str, Any], stream: int, log: Log | None, params: Params | None,
                values: Mapping[str, Any]) -> None:
        desc = {**desc, "precision": precision_of(desc["precision"])}
        self._told = Told(log)
        callbacks = Callbacks(self._told)
        struct, kept = desc_struct(desc, stream, callbacks)
        first = parameters.defaults() if params is None else params_struct(params)
        parameters.write(first, values, struct.dimension)
        self._made = made = ffi.new("pbf_solver **")
        self._finalizer = self._own(made, callbacks)
        try:
            check(lib.pbf_create(struct, first, made))
            callbacks.reraise()
        except BaseException:
            self._finalizer()
            raise
        del kept
        self._stream = stream
        self._take(made[0], desc, callbacks)

    def _take(self, handle: Any, desc: dict[str, Any], callbacks: Callbacks) -> None:
        self._handle, self._desc, self._callbacks = handle, desc, callbacks
        self._snapshots = 0
        self._keeps_previous = False
        self._batch: Any = None

    def _own(self, place: Any, callbacks: Callbacks) -> Any:
        """Before a solver is there: it is freed whatever interrupts the call that makes it. At the
        interpreter's exit, too, while its threads may still log."""
        return weakref.finalize(self, destroy, place, callbacks)

    def _become(self, other: Handle) -> None:
        """Has the solver of another one, which has none then; an interrupt finds either, whole."""
        old, new = self._finalizer, self._own(other._made, other._callbacks)
        other._finalizer.detach()
        names = ("_handle", "_desc", "_callbacks", "_told", "_snapshots", "_keeps_previous", "_made")
        vars(self).update({name: vars(other)[name] for name in names}, _finalizer=new)
        old()

    def synchronize(self) -> None:
        """Waits for a GPU; raises what a step met after the call had returned."""
        self._call(lib.pbf_synchronize)

    # ---- Parameters ----------------------------------------------------------------------------

    def _get_params(self) -> Any:
        struct = new_struct("pbf_params")
        self._call(lib.pbf_get_params, struct)
        return struct

    def _set_params(self, values: Mapping[str, Any]) -> None:
        struct = self._get_params()
        parameters.write(struct, values, self.dimension)
        self._call(lib.pbf_set_params, struct)

    def _dimension(self) -> int:
        return self.dimension

    def set(self, **values: Unpack[ParamValues]) -> None:
        """Sets several parameters at once; none where one of them is refused."""
        parameters.check_names(values, "Solver.set")
        self._set_params(values)

    @property
    def params(self) -> Params:
        """All parameters: a copy. Assign one to set them all."""
        return Params._of(self._get_params())

    @params.setter
    def params(self, params: Params) -> None:
        self._call(lib.pbf_set_params, params_struct(params))

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            near = parameters.near(name)
            if near:
                raise AttributeError(f'a Solver has no attribute "{name}"; did you mean "{near}"?')
        super().__setattr__(name, value)

    # ---- What it is ----------------------------------------------------------------------------

    @property
    def dimension(self) -> int:
        return int(self._desc["dimension"])

    @property
    def dtype(self) -> np.dtype[Any]:
        """Of positions and velocities."""
        return np.dtype(self._desc["precision"])

    @property
    def count(self) -> int:
        count = ffi.new("uint32_t *")
        self._call(lib.pbf_get_count, count)
        return int(count[0])

    @property
    def capacity(self) -> int:
        """As many particles fit; `reserve` changes it."""
        return int(self._desc["capacity"])

    @property
    def info(self) -> Info:
        struct = new_struct("pbf_info")
        self._call(lib.pbf_get_info, struct)
        return Info._of(struct)

    @property
    def backend(self) -> str:
        """The backend that serves."""
        return self.info.backend

    @property
    def time(self) -> float:
        """The sum of the steps' lengths."""
        return self.info.time

    @property
    def steps_done(self) -> int:
        return self.info.step

    @property
    def rest_distance(self) -> float:
        """The distance of particles at rest: `spacing`, or half of `smoothing_radius`."""
        struct = self._get_params()
        return float(struct.spacing or struct.smoothing_radius / 2)

    def __repr__(self) -> str:
        if self.closed:
            return "<pbf.Solver, closed>"
        try:
            info = self.info
            return (f"<pbf.Solver: {self.count} particles in {info.dimension}D, "
                    f"{self.dtype.name}, {info.backend}, {info.time:g} after {info.step} steps>")
        except Error as error:
            return f"<pbf.Solver: {error}>"
