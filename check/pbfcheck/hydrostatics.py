"""E7: hydrostatic pressure and the height of the surface."""
import numpy as np

from .fault import NotApplicable
from .measure import Measure
from .scene_axes import floor_and_ceiling, vertical
from .spray import is_spray
from .surface import height_map


class Hydrostatics(Measure):
    key = "E7"
    title = "hydrostatics"
    definition = (
        "`pressure.max`: max |p - rho g (H - z)|/(rho g H) over all particles but spray, z and the "
        "depth H from the wall's surface below; `pressure.rms`, `pressure.mean_signed` likewise. "
        "p/rho0 from pressures_<step>.npy, or -lambda/dt^2 from lambdas_<step>.npy (accumulated "
        "over the step's iterations, below 0 in compression). H: N rest volumes over the "
        "cross-section of the box. `surface.mean_error`: mean height of the surface less H, in rest "
        "spacings; `surface.rms`: its RMS about its own mean. Meaningful for a box of fluid at rest.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        self.axis, self.up, self.g = vertical(dump.manifest)
        surfaces = dump.manifest.walls.surfaces(0.0)
        sides = [k for k in range(dump.dimension) if k != self.axis]
        floor = floor_and_ceiling(surfaces, self.axis, self.up)[0]
        if not np.isfinite(floor) or not all(np.isfinite(s[k]) for s in surfaces for k in sides):
            raise NotApplicable("the domain has no floor, or is open on a side")
        self.sides = sides

    def _pressures(self, frame):
        """p/rho0 of each particle, or None where nothing was dumped."""
        count = len(frame.positions)
        if self.dump.has("pressures", frame.step):
            return self.dump.scalars("pressures", frame.step, count)
        if self.dump.has("lambdas", frame.step):
            dt = self.dump.manifest.time_step
            return -self.dump.scalars("lambdas", frame.step, count) / dt**2
        return None

    def add(self, frame):
        dump, d = self.dump, self.dump.rest_spacing
        surfaces = dump.manifest.walls.surfaces(frame.time)
        x = frame.positions
        spray = is_spray(x, d)
        if spray.all():
            raise NotApplicable(f"step {frame.step} has no fluid but spray")
        floor = floor_and_ceiling(surfaces, self.axis, self.up)[0]
        section = float(np.prod([surfaces[1][k] - surfaces[0][k] for k in self.sides]))
        depth = len(x) * dump.rest_volume / section
        heights = height_map(x[~spray], d, surfaces, self.axis, self.up)
        mean = float(np.average(heights.heights, weights=heights.weights))
        spread = np.average((heights.heights - mean) ** 2, weights=heights.weights)
        row = {"depth": depth, "surface.mean_error": (mean - floor - depth) / d,
               "surface.rms": float(np.sqrt(spread)) / d, "pressure.max": None, "pressure.rms": None,
               "pressure.mean_signed": None}
        pressures = self._pressures(frame)
        if pressures is not None:
            z = self.up * x[:, self.axis] - floor
            error = ((pressures - self.g * (depth - z)) / (self.g * depth))[~spray]
            row.update({"pressure.max": float(np.abs(error).max()),
                        "pressure.rms": float(np.sqrt(np.mean(error**2))),
                        "pressure.mean_signed": float(error.mean())})
        return row
