"""The cases that pbf-bench validate runs and measures itself: what can't be told from particles alone, or
is done in several parts. Here are their names, and the bounds of the quick form."""
import json
import os
import time

from .fault import RunFault
from .runs import start

# case → largest errors of figures that are known to hold, by the figures' names
CASES = {
    "laplace": {"pressure in drops over Laplace's, mean": 0.25, "pressure in discs over Laplace's, mean": 0.35},
    "rayleigh": {"period of drops over Rayleigh's, mean": 0.25, "period of discs over Rayleigh's, mean": 0.35},
    "contact-angle": {"2D, 90°, mean": 12},
    "couette": {"between planes, velocity over the closed form": 0.03, "shear stress on the lid over ν U/H": 0.12,
                "between cylinders, velocity over the closed form": 0.08},
    "poiseuille": {"steady, velocity over the closed form": 0.03,
                   "after a tenth of the time, velocity over the closed form": 0.03},
    "stokes-sphere": {"mean velocity at a given force over Hasimoto's, as it has gone by one spacing": 0.04},
    "layers-sort": {"particles out of their layer at the end": 0.15,
                    "weight on the floor over that of the fluids": 0.01},
    "rayleigh-taylor": {"growth over linear theory, 1 : 3, on a lattice": 0.1},
    "lock-exchange": {"front over 0.5 sqrt(g' H), h = 3 d": 0.2},
    "taylor-green": {"viscosity that their decay tells, after three spacings": 0.12},
    "volume-flow": {"particles that have come": 1, "level less the volume over the area": 0.5},
    "current-tank": {"level, farthest": 1, "what goes over what comes": 0.02},
    "reservoir-level": {"level with nothing that comes, mean": 0.5, "level with an inlet, mean": 0.5},
    "reservoir-channel": {"levels 0.1 apart, particles at the end over those at the middle": 0.03},
    "reservoir-pressure": {"from 1.5 to 0.5, what comes over the closed form": 0.05,
                           "from 1.5 to 0.5, what goes over the closed form": 0.05},
    "buoyancy": {"lift of a cube of 0.5 of water's density, N over ρ0": 0.02, "part below the level of a cube of 0.5": 0.04},
    "wall-force": {"momentum of fluid and walls, over that of the column at √(2gH)": 1e-4,
                   "weight on the floor at rest, N/m over ρ0": 0.01},
    "jet": {"force on the plate over ρ Q V": 0.06},
    "towed-ball": {},
    "friction": {"30°, μ = 0.2: gain over g (sin a - μ cos a)": 0.02, "30°, μ = 0.4: gain over g (sin a - μ cos a)": 0.02},
    "queries": {"level less the volume over the area": 0.5, "where rays meet it, the same": 0.5,
                "pressure over ρ g times the depth": 0.05, "density inside": 0.01,
                "part below the level of a box set half into it": 0.02,
                "velocity of a linear field, largest error": 1e-5},
}


def measure(name, options, folder):
    """pbf-bench's report of one case, with the time that it took."""
    path = os.path.join(folder, "physics.json")
    command = [options.program, "validate", "--case", name, "--backend", options.backend, "--json", path,
               "--finer", repr(float(options.finer))]
    if options.precision:
        command += ["--precision", options.precision]
    if options.threads:
        command += ["--threads", str(options.threads)]
    if options.quick:
        command += ["--quick"]
    for setting in options.set:
        command += ["--set", setting]
    began = time.monotonic()
    start(command)
    seconds = time.monotonic() - began
    try:
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
    except (OSError, ValueError) as error:
        raise RunFault(f"{path} can't be read: {error}") from error
    return {**report["cases"][0], "seconds": seconds, "build": report["build"]}


def bounds_missed(result):
    """Sentences on what the quick form's bounds do not allow."""
    figures = {figure["figure"]: figure for figure in result["figures"]}
    for name, limit in CASES[result["case"]].items():
        figure = figures.get(name)
        error = figure["error"] if figure else None
        if error is None or not abs(error) <= limit:
            yield f"{result['case']}: {name} is off by {error}; it must be at most {limit:g}"
