"""A folder of dumped frames."""
import os
import re
from dataclasses import dataclass
from typing import Optional

import numpy as np

from .fault import DumpFault, UsageFault
from .kernels import rest_spacing
from .manifest import LARGEST, read_manifest

_POSITIONS = re.compile(r"positions_(\d{6,})\.npy$")


@dataclass(frozen=True)
class Frame:
    step: int
    time: float
    positions: np.ndarray  # float64, shape (N, dim), in the order of adding
    velocities: Optional[np.ndarray]
    precision: str  # of the file: "float32" or "float64"
    path: str


def _load(path, shape):
    try:
        array = np.load(path, allow_pickle=False)
    except OSError as error:
        raise DumpFault(path, f"cannot be read ({error.strerror or error})") from error
    except (ValueError, EOFError) as error:
        raise DumpFault(path, f"is not a whole .npy file: {error}") from error
    if not isinstance(array, np.ndarray) or array.dtype not in (np.float32, np.float64):
        kind = getattr(array, "dtype", type(array).__name__)
        raise DumpFault(path, f"holds {kind}; it must be float32 or float64")
    if len(array.shape) != len(shape) or any(w is not None and n != w
                                             for n, w in zip(array.shape, shape)):
        wanted = ", ".join("N" if n is None else str(n) for n in shape)
        raise DumpFault(path, f"has shape {array.shape}; it must be ({wanted}{',' * (len(shape) == 1)})")
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        where = tuple(int(i) for i in bad[0])
        raise DumpFault(path, f"holds {array[where]} at index {where} and {len(bad) - 1} more values "
                              "that are not finite")
    large = np.argwhere(np.abs(array) > LARGEST)
    if len(large):
        where = tuple(int(i) for i in large[0])
        raise DumpFault(path, f"holds {array[where]:g} at index {where}; numbers may be {LARGEST:g} at most")
    return array


class Dump:
    """The manifest and the frames, which are read when asked for."""

    def __init__(self, folder):
        if not os.path.isdir(folder):
            raise DumpFault(folder, "is not a folder")
        self.folder = folder
        self.manifest = read_manifest(folder)
        names = (_POSITIONS.match(name) for name in os.listdir(folder))
        self.steps = sorted(int(match.group(1)) for match in names if match)
        if not self.steps:
            raise DumpFault(folder, "holds no positions_<step, 6 digits>.npy")
        m = self.manifest
        self.rest_spacing, self.rest_source = rest_spacing(
            m.kernel, m.smoothing_radius, m.spacing, m.particle_volume, m.dimension)

    @property
    def dimension(self):
        return self.manifest.dimension

    @property
    def rest_volume(self):
        """Volume of a particle in the rest lattice."""
        return self.rest_spacing ** self.dimension

    def path(self, what, step):
        return os.path.join(self.folder, f"{what}_{step:06d}.npy")

    def has(self, what, step):
        return os.path.exists(self.path(what, step))

    def frame(self, step):
        path = self.path("positions", step)
        positions = _load(path, (None, self.dimension))
        velocities = None
        if self.has("velocities", step):
            velocities = _load(self.path("velocities", step), positions.shape).astype(float)
        return Frame(step, self.manifest.time_of(step), positions.astype(float), velocities,
                     str(positions.dtype), path)

    def scalars(self, what, step, count):
        """A field of one number a particle."""
        return _load(self.path(what, step), (count,)).astype(float)

    def select(self, choice):
        """Steps by name: all, last, ends (first and last), a number, or START:END:STRIDE."""
        try:
            if choice == "all":
                return self.steps
            if choice == "last":
                return self.steps[-1:]
            if choice == "ends":
                return sorted({self.steps[0], self.steps[-1]})
            if ":" in choice:
                start, end, stride = (int(p) if p else None for p in (choice + "::").split(":")[:3])
                wanted = [s for s in self.steps
                          if (start is None or s >= start) and (end is None or s <= end)]
                if stride is not None and stride < 1:
                    raise ValueError
                wanted = wanted[::stride or 1]
            else:
                wanted = [s for s in self.steps if s == int(choice)]
        except ValueError:
            raise UsageFault(f'--steps is "{choice}"; it must be all, last, ends, a step or '
                             "START:END:STRIDE") from None
        if not wanted:
            raise UsageFault(f'--steps "{choice}" meets none of the {len(self.steps)} dumped steps '
                             f"{self.steps[0]} … {self.steps[-1]} of {self.folder}")
        return wanted
