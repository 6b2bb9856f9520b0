#!/usr/bin/env python3
"""What becomes of particles placed at random, with and without pre-stabilization.

    bench/tools/starts.py measure LIBPBF.so COMMIT RESULT.json    runs them through the library, on `serial`
    bench/tools/starts.py table RESULT.json                       writes the table in docs/stability.md

Starts are 1,728 particles at random in a box 12 spacings wide, in 12 layers or, where it is denser than at rest, in as
many fewer; newcomers a share of as many as rest there in a lattice, at random among them. A second is simulated with
the defaults and this time step. What is told, as medians over SEEDS: by how much the energy exceeds that before the
step at most, in g d for each particle that was placed, and what this step costs.
"""
import ctypes
import json
import pathlib
import statistics
import sys
import time

import numpy as np

from pages import ROOT, write_table

sys.path.insert(0, str(ROOT / "examples"))
from ctypes_demo import Desc, Params  # noqa: E402

SPACING, GRAVITY, WIDE, LAYERS = 0.05, 9.81, 12, 12
STEPS = (0.0005, 0.0022, 1 / 120, 1 / 60)
DENSITIES = (1, 1.5, 3)
SHARES = (0.02, 0.1, 0.4)
SEEDS = (1, 2, 3)


class Fluid:
    def __init__(self, pbf, time_step, prestabilization, positions):
        self.pbf, self.handle, self.count = pbf, ctypes.c_void_p(), 0
        desc, params = Desc(), Params()
        self.check(pbf.pbf_desc_init(ctypes.byref(desc), ctypes.sizeof(desc)))
        self.check(pbf.pbf_params_init(ctypes.byref(params), ctypes.sizeof(params)))
        desc.capacity, desc.backend, desc.strict = 2 * len(positions), b"serial", 1
        params.time_step = time_step
        if not prestabilization:
            params.prestabilization = 0
        for axis, spacings in enumerate((WIDE, 3 * LAYERS, WIDE)):
            params.domain_max[axis] = spacings * SPACING
        self.check(pbf.pbf_create(ctypes.byref(desc), ctypes.byref(params), ctypes.byref(self.handle)))
        self.add(positions)

    def add(self, positions):
        self.check(self.pbf.pbf_add_particles(self.handle, len(positions), self.pointer(positions), None, None))
        self.count += len(positions)

    def check(self, status):
        if status:
            raise RuntimeError(self.pbf.pbf_last_error().decode())

    @staticmethod
    def pointer(array):
        return array.ctypes.data_as(ctypes.c_void_p)

    def step(self, steps):
        self.check(self.pbf.pbf_step(self.handle, steps))

    def energy(self):
        """Of all, over g d: potential, kinetic."""
        x, v = np.empty((self.count, 3), np.float32), np.empty((self.count, 3), np.float32)
        self.check(self.pbf.pbf_get_positions(self.handle, 0, self.count, self.pointer(x)))
        self.check(self.pbf.pbf_get_velocities(self.handle, 0, self.count, self.pointer(v)))
        return x[:, 1].sum(dtype=float) / SPACING, 0.5 * (v.astype(float) ** 2).sum() / (GRAVITY * SPACING)

    def close(self):
        self.pbf.pbf_destroy(self.handle)


def anywhere(count, layers, seed):
    box = np.array([WIDE, layers, WIDE]) * SPACING
    return (np.random.default_rng(seed).uniform(0.001, 0.999, (count, 3)) * box).astype(np.float32)


def lattice():
    axes = [(np.arange(n) + 0.5) * SPACING for n in (WIDE, LAYERS, WIDE)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float32)


def place(pbf, row, prestabilization, seed):
    """A fluid before the step that is asked about, and how many of it have been placed."""
    all_particles = WIDE * LAYERS * WIDE
    if "density" in row:
        start = anywhere(all_particles, LAYERS / row["density"], seed)
        return Fluid(pbf, row["time_step"], prestabilization, start), all_particles
    fluid, newcomers = Fluid(pbf, row["time_step"], prestabilization, lattice()), round(row["share"] * all_particles)
    fluid.step(max(1, round(0.1 / row["time_step"])))
    fluid.add(anywhere(newcomers, LAYERS, seed))
    return fluid, newcomers


def run(pbf, row, prestabilization, seed):
    fluid, placed = place(pbf, row, prestabilization, seed)
    before, energies = fluid.energy(), []
    begin = time.perf_counter()
    fluid.step(1)
    first, later = time.perf_counter() - begin, []
    for _ in range(max(1, round(1 / row["time_step"]))):
        energies.append(sum(fluid.energy()))
        begin = time.perf_counter()
        fluid.step(1)
        later.append(time.perf_counter() - begin)
    end = fluid.energy()
    fluid.close()
    return {"gained": (max(energies) - sum(before)) / placed, "rest": (end[0] - before[0]) / placed,
            "first": first / statistics.median(later)}


def measure(library, commit, path):
    pbf, rows = ctypes.CDLL(library), []
    pbf.pbf_last_error.restype = ctypes.c_char_p
    for kind in [{"density": density} for density in DENSITIES] + [{"share": share} for share in SHARES]:
        for time_step in STEPS:
            row = {**kind, "time_step": time_step}
            for name, on in (("thrown", 0), ("projected", 1)):
                runs = [run(pbf, row, on, seed) for seed in SEEDS]
                row[name] = {key: statistics.median(r[key] for r in runs) for key in runs[0]}
            rows.append(row)
            print(json.dumps(row), flush=True)
    result = {"commit": commit, "particles": WIDE * LAYERS * WIDE, "seeds": len(SEEDS), "rows": rows}
    pathlib.Path(path).write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


def table(result):
    lines = ["| placed | time step, ms | energy gained without, g d | with | of which it keeps as height "
             "| that step takes as long as |", "| --- | --: | --: | --: | --: | --: |"]
    for row in result["rows"]:
        off, on = row["thrown"], row["projected"]
        what = f"all, at density {row['density']:g}" if "density" in row else f"{100 * row['share']:g} % more"
        lines.append(f"| {what} | {1e3 * row['time_step']:.2g} | {off['gained']:{',.0f' if off['gained'] >= 100 else '.3g'}} | {on['gained']:.2g} "
                     f"| {on['rest']:.2g} | {on['first']:.0f} others |")
    lines += ["", f"`serial`, {result['particles']:,} particles, one second, medians of {result['seeds']} each; "
              f"commit {result['commit'][:12]}."]
    return "\n".join(lines)


def main(words):
    if len(words) == 4 and words[0] == "measure":
        return measure(*words[1:])
    if len(words) == 2 and words[0] == "table":
        result = json.loads(pathlib.Path(words[1]).read_text(encoding="utf-8"))
        return write_table(ROOT / "docs" / "stability.md", "starts", table(result))
    return sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
