"""dump.json: what a dump's particles mean."""
import json
import math
import os
from dataclasses import dataclass

import numpy as np

from .fault import DumpFault
from .kernels import KERNELS, calibrated_volume
from .walls import Walls

FILE_NAME = "dump.json"
LARGEST = 1e75  # number of a dump, of which fourth powers are finite
MOST_SPACINGS = 10  # of a smoothing_radius, as the library has it
REQUIRED = ("dimension", "smoothing_radius", "spacing", "particle_volume", "kernel", "gravity",
            "domain_min", "domain_max", "time_step")


@dataclass(frozen=True)
class Manifest:
    path: str
    dimension: int
    smoothing_radius: float
    spacing: float
    particle_volume: float
    kernel: str
    gravity: np.ndarray
    time_step: float
    walls: Walls
    attraction: float  # a further acceleration -attraction (x - attraction_center)
    attraction_center: np.ndarray
    times: dict  # of steps, where the time step has changed
    phases: tuple  # rest densities of several fluids
    raw: dict

    def time_of(self, step):
        return self.times.get(step, step * self.time_step)


class _Reader:
    """Typed look-ups in a JSON object; a fault names the file, the key and the value."""

    def __init__(self, path, values):
        self.path = path
        self.values = values

    def fault(self, key, wants):
        raise DumpFault(self.path, f'"{key}" is {json.dumps(self.values.get(key))}; it must be {wants}')

    def number(self, key, default=None, minimum=-math.inf, above=-math.inf):
        value = self.values.get(key, default)
        limit = f"at least {minimum:g}" if minimum > -math.inf else f"above {above:g}"
        wants = "a finite number" if max(minimum, above) == -math.inf else f"a finite number {limit}"
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self.fault(key, wants)
        if value < minimum or value <= above:
            self.fault(key, wants)
        if abs(value) > LARGEST:
            self.fault(key, f"{LARGEST:g} at most")
        return float(value)

    def vector(self, key, length, default=None, null=None):
        """`length` numbers, more are ignored (2D scenes carry a z); `null` stands for JSON's null."""
        value = self.values.get(key)
        if value is None and default is not None:
            return np.array(default, float)
        wants = f"a list of at least {length} finite numbers"
        if not isinstance(value, list) or len(value) < length:
            self.fault(key, wants)
        numbers = [null if v is None else v for v in value[:length]]
        for v in numbers:
            if isinstance(v, bool) or not isinstance(v, (int, float)) or math.isnan(v):
                self.fault(key, wants)
            if LARGEST < abs(v) < math.inf:
                self.fault(key, f"a list of numbers of {LARGEST:g} at most")
        return np.array(numbers, float)


def _read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            values = json.load(file)
    except OSError as error:
        raise DumpFault(path, f"cannot be read ({error.strerror}); a dump folder holds {FILE_NAME} "
                              "beside its positions_<step>.npy") from error
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise DumpFault(path, f"is not JSON: {error}") from error
    if not isinstance(values, dict):
        raise DumpFault(path, f"holds a JSON {type(values).__name__}; it must be an object")
    missing = [key for key in REQUIRED if key not in values]
    if missing:
        raise DumpFault(path, "lacks the key " + ", ".join(f'"{key}"' for key in missing))
    return values


def _read_walls(reader, dim, spacing):
    lower = reader.vector("domain_min", dim, null=-math.inf)
    upper = reader.vector("domain_max", dim, null=math.inf)
    if not np.all(lower < upper):
        reader.fault("domain_max", f"above domain_min {lower.tolist()} on every axis")
    entry = reader.values.get("walls")
    if isinstance(entry, bool) or entry is None:
        entry = {"present": [entry is not False] * (2 * dim)}
    elif isinstance(entry, list):
        entry = {"present": entry}
    if not isinstance(entry, dict):
        reader.fault("walls", "true, false, null, a list of booleans or an object")
    inner = _Reader(f"{reader.path}: walls", entry)
    present = entry.get("present", [True] * (2 * dim))
    if (not isinstance(present, list) or len(present) < 2 * dim
            or not all(isinstance(p, bool) for p in present)):
        inner.fault("present", f"{2 * dim} booleans: x min, x max, y min, …")
    motion = {key: inner.vector(key, 2 * dim, default=np.zeros(2 * dim))
              for key in ("velocity", "amplitude", "frequency", "phase")}
    offset = inner.number("offset", default=spacing / 2, minimum=0)
    return Walls(lower, upper, np.array(present[:2 * dim]), offset=offset, **motion)


def _read_times(reader):
    """{step: time} from {"step": time}."""
    entry = reader.values.get("times")
    if entry is None:
        return {}
    if not isinstance(entry, dict):
        reader.fault("times", "an object of a time for each step")
    inner = _Reader(f"{reader.path}: times", entry)
    if not all(key.isdecimal() for key in entry):
        reader.fault("times", "an object whose keys are steps")
    return {int(key): inner.number(key) for key in entry}


def _read_phases(reader):
    entry = reader.values.get("phases", [])
    if not isinstance(entry, list):
        reader.fault("phases", "a list of rest densities")
    return tuple(reader.vector("phases", len(entry), default=[])) if entry else ()


def read_manifest(folder):
    path = os.path.join(folder, FILE_NAME)
    reader = _Reader(path, _read_json(path))
    dim = reader.values["dimension"]
    if dim not in (2, 3) or isinstance(dim, bool):
        reader.fault("dimension", "2 or 3")
    dim = int(dim)
    h = reader.number("smoothing_radius", above=0)
    spacing = reader.number("spacing", minimum=0) or h / 2
    if spacing >= h:
        reader.fault("spacing", f"below smoothing_radius {h:g}")
    if spacing * MOST_SPACINGS < h:
        reader.fault("spacing", f"at least a {MOST_SPACINGS}th of smoothing_radius {h:g}")
    kernel = reader.values["kernel"]
    if not isinstance(kernel, str) or kernel not in KERNELS:
        reader.fault("kernel", " or ".join(f'"{name}"' for name in KERNELS))
    volume = reader.number("particle_volume", minimum=0) or calibrated_volume(kernel, h, spacing, dim)
    return Manifest(
        path=path, dimension=dim, smoothing_radius=h, spacing=spacing, particle_volume=volume,
        kernel=kernel, gravity=reader.vector("gravity", dim),
        time_step=reader.number("time_step", above=0),
        walls=_read_walls(reader, dim, spacing),
        attraction=reader.number("attraction", default=0.0),
        attraction_center=reader.vector("attraction_center", dim, default=np.zeros(dim)),
        times=_read_times(reader), phases=_read_phases(reader), raw=reader.values)
