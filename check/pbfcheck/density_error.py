"""E1: density."""
import numpy as np

from . import stats
from .coverage import covered_shares
from .density import densities
from .kernels import calibrated_volume
from .measure import Measure
from .walls import distance_to_walls


class DensityError(Measure):
    key = "E1"
    title = "density"
    definition = (
        "e = rho/rho0 - 1 of the interior particles, those whose kernel ball is filled by fluid or "
        "wall to at least the share in `coverage`, judged by a union of balls and not by a density. "
        "`measure.…`: Wendland C2 of one radius for every contestant, calibrated on the lattice at "
        "rest; `own.…`: the solver's kernel and particle volume. `….interior.…`: all of these; "
        "`….bulk.…`: those of them whose ball meets no wall. `….all.compression_…`: max(e, 0) over "
        "all particles, spray and surface included. mean_signed below 0: the fluid has expanded.")

    def __init__(self, dump, options):
        super().__init__(dump, options)
        m, d = dump.manifest, dump.rest_spacing
        h = options.measure_radius * d
        self.kernels = {
            "measure": ("wendland_c2", h, calibrated_volume("wendland_c2", h, d, dump.dimension)),
            "own": (m.kernel, m.smoothing_radius, m.particle_volume)}

    def _one(self, frame, name, shares):
        kernel, h, volume = self.kernels[name]
        dump, options = self.dump, self.options
        surfaces = dump.manifest.walls.surfaces(frame.time)
        x = frame.positions
        error = densities(x, kernel, h, volume, surfaces, dump.rest_spacing,
                          options.wall_density) - 1
        interior = shares[h] >= options.coverage
        bulk = interior & (distance_to_walls(x, surfaces) >= h)
        squeezed = np.maximum(error, 0)
        row = {"interior_share": float(interior.mean()) if len(x) else None}
        row.update(stats.prefixed("interior", stats.of_errors(error[interior])))
        row.update(stats.prefixed("bulk", stats.of_errors(error[bulk])))
        row["all.compression_mean"] = float(squeezed.mean()) if len(x) else None
        row["all.compression_max"] = float(squeezed.max()) if len(x) else None
        return stats.prefixed(name, row)

    def add(self, frame):
        radii = {h for _, h, _ in self.kernels.values()}
        surfaces = self.dump.manifest.walls.surfaces(frame.time)
        shares = covered_shares(frame.positions, radii, self.dump.rest_spacing, surfaces)
        return {**self._one(frame, "measure", shares), **self._one(frame, "own", shares)}

    def finish(self, rows):
        return {"coverage": self.options.coverage, "wall_density": self.options.wall_density,
                "wall_offset": self.dump.manifest.walls.offset,
                "kernels": {name: {"kernel": k, "radius": h, "particle_volume": v}
                            for name, (k, h, v) in self.kernels.items()}}
