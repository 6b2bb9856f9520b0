"""A tank in solid rotation: its surface is a paraboloid."""
import numpy as np

from .fault import NotApplicable, UsageFault
from .scene_axes import vertical
from .spray import is_spray
from .surface import height_map
from .validation import Validation


class RotatingTank(Validation):
    name = "rotating-tank"
    title = "rotating tank"
    definition = (
        "Surface heights fitted by eta = eta_0 + c r^2 up to --radius (else the nearest side wall, "
        "less 2 spacings) around --center (else the domain's). `curvature.error`: c over "
        "Omega^2/(2g), less 1. `shape.rms`: RMS of eta - eta_0 - Omega^2 r^2/(2g) over the rise at "
        "that radius, eta_0 fitted. Omega by --omega. Last frame; all frames in the rows.")
    bars = {"curvature.error": 0.02, "shape.rms": 0.02}

    def run(self, dump, frames, options):
        axis, up, g = vertical(dump.manifest)
        if not options.omega:
            raise UsageFault("rotating-tank needs --omega, in radians a time unit")
        sides = [k for k in range(dump.dimension) if k != axis]
        low, high = (bound[sides] for bound in dump.manifest.walls.surfaces(0.0))
        centre = np.array(options.center) if options.center else (low + high) / 2
        if len(centre) != len(sides) or not np.all(np.isfinite(centre)):
            raise UsageFault(f"--center needs {len(sides)} finite numbers, one a horizontal axis")
        d = dump.rest_spacing
        radius = options.radius or float(np.min(np.minimum(centre - low, high - centre))) - 2 * d
        if not np.isfinite(radius) or radius <= 0:
            raise UsageFault("--radius must say how far out the surface is judged, above 0")
        exact = options.omega**2 / (2 * g)
        rows = []
        for frame in frames:
            x = frame.positions[~is_spray(frame.positions, d)]
            surface = height_map(x, d, dump.manifest.walls.surfaces(frame.time), axis, up)
            r2 = np.square(surface.columns - centre).sum(axis=1)
            near = r2 <= radius**2
            if near.sum() < 8:
                raise NotApplicable(f"step {frame.step} has a surface over {int(near.sum())} columns "
                                    f"within radius {radius:g}; 8 would do")
            slope, _ = np.polyfit(r2[near], surface.heights[near], 1)
            left = surface.heights[near] - exact * r2[near]
            rows.append({"step": frame.step, "time": frame.time,
                         "curvature.error": float(slope / exact - 1),
                         "shape.rms": float(left.std() / (exact * radius**2))})
        last = rows[-1]
        return {"curvature.error": last["curvature.error"], "shape.rms": last["shape.rms"],
                "omega": options.omega, "radius": radius}, rows
