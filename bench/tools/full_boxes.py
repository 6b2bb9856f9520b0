#!/usr/bin/env python3
"""Boxes that are full, or hold more than they have room for: how many eddies in them gain energy or lose it,
and how often water at rest has more pressure than its weight makes. The figures of docs/stability.md.

    bench/tools/full_boxes.py build/release/lib/libpbf.so [backend]
"""
import ctypes as c
import itertools
import pathlib
import sys

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))

from ctypes_demo import Desc, Params  # noqa: E402  (the folder has just become known)

STEPS = ((4, 0.2), (4, 0.02), (16, 0.1))  # iterations, and how many spacings a speed of 1 goes in a step
FILLS = (1, 1.01, 1.05, 1.2, 2)
GRAVITY = 10


def eddy(x):
    """Taylor and Green's, in the first two axes of a box of side 1."""
    v = np.zeros_like(x)
    v[:, 0] = np.sin(np.pi * x[:, 0]) * np.cos(np.pi * x[:, 1])
    v[:, 1] = -np.cos(np.pi * x[:, 0]) * np.sin(np.pi * x[:, 1])
    return v


class Box:
    def __init__(self, pbf, backend, dimension, support, fill, iterations, part, turns):
        layers = 48 if dimension == 2 else 16
        spacing, side = 1 / layers, fill ** (-1 / dimension)
        x = (np.indices((layers,) * dimension).reshape(dimension, -1).T + 0.5) * spacing
        v = eddy(x) if turns else np.zeros_like(x)
        x = x * side + np.random.default_rng(1).uniform(-0.05, 0.05, x.shape) * spacing
        self.pbf, self.solver, self.count, self.dimension = pbf, c.c_void_p(), len(x), dimension
        desc, params = Desc(), Params()
        self.check(pbf.pbf_desc_init(c.byref(desc), c.sizeof(desc)))
        self.check(pbf.pbf_params_init(c.byref(params), c.sizeof(params)))
        desc.dimension, desc.capacity, desc.backend = dimension, len(x), backend
        params.spacing, params.smoothing_radius = spacing, support * spacing
        params.time_step, params.iterations = part * spacing, iterations
        params.gravity[1] = 0 if turns else -GRAVITY
        for axis in range(3):
            params.domain_max[axis] = side
        self.check(pbf.pbf_create(c.byref(desc), c.byref(params), c.byref(self.solver)))
        x, v = (np.ascontiguousarray(a, np.float32) for a in (x.clip(1e-3 * spacing, side - 1e-3 * spacing), v))
        self.check(pbf.pbf_add_particles(self.solver, len(x), x.ctypes, v.ctypes, None))

    def check(self, status):
        if status:
            raise RuntimeError(self.pbf.pbf_last_error().decode())

    def step(self, steps):
        self.check(self.pbf.pbf_step(self.solver, steps))

    def get(self, name, components):
        values = np.empty((self.count, components), np.float32)
        self.check(getattr(self.pbf, f"pbf_get_{name}")(self.solver, 0, self.count, values.ctypes))
        return values.astype(float)

    def energy(self):
        return (self.get("velocities", self.dimension) ** 2).sum() / self.count / 2

    def close(self):
        self.pbf.pbf_destroy(self.solver)


def main(path, backend="serial"):
    pbf = c.CDLL(path)
    pbf.pbf_last_error.restype = c.c_char_p
    gains, keeps, pressures = [], [], []
    for dimension, support, fill, (iterations, part), turns in itertools.product(
            (2, 3), (2, 2.5, 3), FILLS, STEPS, (True, False)):
        box = Box(pbf, backend.encode(), dimension, support, fill, iterations, part, turns)
        steps, energies = int(0.5 * (48 if dimension == 2 else 16) / part / 8), [box.energy()]
        for _ in range(8):
            box.step(steps)
            energies.append(box.energy())
        if turns:
            gains.append(max(energies) / energies[0])
            keeps.append(energies[-1] / energies[0])
        else:
            pressures.append(box.get("pressures", 1).mean() / (GRAVITY / 2))
        box.close()
    print(f"{len(gains)} eddies: {sum(g > 1.15 for g in gains)} gain more than 15 % of their energy, {max(gains):.3g} times"
          f" at most; {sum(k < 0.3 for k in keeps)} lose more than 70 %")
    print(f"{len(pressures)} at rest: {sum(p > 4 for p in pressures)} have more than four times the pressure of their weight,"
          f" {max(pressures):.3g} times at most")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
