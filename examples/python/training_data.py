"""Trajectories to learn from: positions of every frame of many runs that differ in how they start.

    python examples/python/training_data.py [FILE.h5 or FILE.npz] [RUNS]

An .h5 file (by h5py) grows run by run and holds more than memory does; an .npz needs nothing.
"""
import sys

import numpy as np

import pbf

FRAMES, STEPS = 30, 4


def start(rng):
    """Two balls of water at random places, with random velocities."""
    fluid = pbf.Solver(capacity=5000, spacing=0.05, smoothing_radius=0.1)
    for x in (0.25, 0.75):
        center = (x, rng.uniform(0.3, 0.7), rng.uniform(0.3, 0.7))
        fluid.add_ball(center, 0.18, rng.uniform(-1, 1, 3))
    return fluid


def trajectory(fluid):
    """Positions and velocities, of shape (frame, particle, 3), read where they are to lie."""
    shape = (FRAMES, fluid.count, 3)
    positions, velocities = np.empty(shape, np.float32), np.empty(shape, np.float32)
    for frame in fluid.frames(FRAMES, steps=STEPS):
        fluid.read("position", positions[frame])
        fluid.read("velocity", velocities[frame])
    return positions, velocities


def write_hdf5(path, runs):
    import h5py
    with h5py.File(path, "w") as file:
        for number, (params, positions, velocities) in enumerate(runs):
            group = file.create_group(f"run{number:04d}")
            group.create_dataset("positions", data=positions, compression="lzf")
            group.create_dataset("velocities", data=velocities, compression="lzf")
            group.attrs.update({name: value for name, value in params.items()})


def write_npz(path, runs):
    arrays = {}
    for number, (_, positions, velocities) in enumerate(runs):
        arrays[f"positions{number:04d}"], arrays[f"velocities{number:04d}"] = positions, velocities
    np.savez_compressed(path, **arrays)


def simulate(count):
    rng = np.random.default_rng(1)
    for number in range(count):
        with start(rng) as fluid:
            positions, velocities = trajectory(fluid)
            print(f"run {number}: {positions.shape[1]} particles, {positions.nbytes >> 10} KiB")
            yield fluid.params.to_dict(), positions, velocities


def main(path="training.npz", count="3"):
    write = write_hdf5 if path.endswith((".h5", ".hdf5")) else write_npz
    write(path, simulate(int(count)))
    print("wrote", path)


if __name__ == "__main__":
    main(*sys.argv[1:])
