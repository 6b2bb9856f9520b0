#!/usr/bin/env python3
"""One run of SPlisHSPlasH in a process of its own:

    splishsplash.py JOB.json

JOB.json has method, spacing, planes (min and max of its wall particles, or null), surfaces, configuration
(parameters other than its defaults), segments (each of steps, time_steps, which repeat, and gravity), frames
(steps that are dumped), folder (with positions.npy and velocities.npy of the start; gets the dump and
result.json).
"""
import json
import os
import pathlib
import sys
import time

import numpy as np
import pysplishsplash as sph

import setup


class Fluid:
    """Arrays in the order of the start: the solver sorts its particles."""

    def __init__(self, simulation):
        self.model = simulation.getFluidModel(0)
        self.count = self.model.numActiveParticles()

    def buffer(self, name):
        return np.asarray(self.model.getFieldBuffer(name))[:self.count]

    def order(self):
        return np.argsort(self.buffer("id"))

    def get(self, name):
        return self.buffer(name)[self.order()].copy()

    def set(self, name, values):
        self.buffer(name)[self.order()] = values


def configure(stepper, settings):
    """Its scene file has names for these, too, but without its window it does not read them."""
    numbers = {stepper.getName(k): k for k in range(stepper.numParameters())}
    for name, value in settings.items():
        whole = str(stepper.getType(numbers[name])).endswith("UINT32")
        (stepper.setValueUInt if whole else stepper.setValueFloat)(numbers[name], value)


class Run:
    def __init__(self, base, job):
        self.base, self.job = base, job
        self.simulation = sph.Simulation.getCurrent()
        self.clock = sph.TimeManager.getCurrent()
        self.fluid = Fluid(self.simulation)
        self.folder = pathlib.Path(job["folder"])
        self.frames, self.times = set(job["frames"]), {}
        self.step = self.iterations = 0
        self.time = 0.0  # the solver's own is in float32
        self.wall = self.cpu = 0.0

    def dump(self):
        if self.step not in self.frames:
            return
        for field, name in (("position", "positions"), ("velocity", "velocities")):
            np.save(self.folder / f"{name}_{self.step:06d}.npy", self.fluid.get(field))
        self.times[str(self.step)] = self.time

    def advance(self, stepper, time_step):
        self.clock.setTimeStepSize(time_step)
        wall, cpu = time.perf_counter(), time.process_time()
        stepper.step()
        self.wall += time.perf_counter() - wall
        self.cpu += time.process_time() - cpu
        self.step += 1
        self.time += time_step
        self.iterations += stepper.getNumIterations()

    def run(self):
        self.fluid.set("velocity", np.load(self.folder / "velocities.npy"))
        self.dump()
        stepper = self.simulation.getTimeStep()
        configure(stepper, self.job.get("configuration", {}))
        for segment in self.job["segments"]:
            self.simulation.setVec3ValueReal(sph.Simulation.GRAVITATION, segment["gravity"])
            for k in range(segment["steps"]):
                self.advance(stepper, segment["time_steps"][k % len(segment["time_steps"])])
                self.dump()

    def result(self):
        density = self.fluid.get("density")
        density = density / 1000 if len(density) and density.mean() > 10 else density  # PBF's are relative already
        walls = [self.simulation.getBoundaryModel(i).numberOfParticles()
                 for i in range(self.simulation.numberOfBoundaryModels())]
        return {"steps": self.step, "seconds_wall": self.wall, "seconds_cpu": self.cpu,
                "iterations": self.iterations, "times": self.times, "particles": self.fluid.count,
                "wall_particles": sum(walls),
                "own_compression_mean": float(np.maximum(density - 1, 0).mean()) if len(density) else 0.0}


def prepare(job):
    folder = job["folder"]
    with open(f"{folder}/cube.obj", "w", encoding="utf-8") as file:
        file.write(setup.unit_cube())
    with open(f"{folder}/start.pda", "w", encoding="utf-8") as file:
        file.write(setup.particle_file(np.load(f"{folder}/positions.npy")))
    with open(f"{folder}/scene.json", "w", encoding="utf-8") as file:
        json.dump(setup.scene(folder, job), file)
    base = sph.Exec.SimulatorBase()
    base.init(sceneFile=f"{folder}/scene.json", useGui=False, initialPause=False, useCache=False,
              outputDir=f"{folder}/output")
    base.initSimulation()
    return base


def main(path):
    job = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    base = prepare(job)

    def after_first_step():
        # Walls are sampled within runSimulation(), which returns only at the end: one step makes them, and
        # a reset undoes it. _exit() spares the solver's own end, which prints its timings.
        base.reset()
        run = Run(base, job)
        run.run()
        folder = pathlib.Path(job["folder"])
        (folder / "dump.json").write_text(json.dumps({**setup.manifest(job), "times": run.times}), encoding="utf-8")
        (folder / "result.json").write_text(json.dumps(run.result()), encoding="utf-8")
        os._exit(0)

    base.setTimeStepCB(after_first_step)
    base.runSimulation()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
