"""E7 against a tank with the exact pressure."""
import os
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest


class Hydrostatic(DumpTest):
    def tank(self, points, axis, up, pressures=None, name="pressures"):
        dim = points.shape[1]
        low, high = [0.0] * dim, [float(points[:, k].max()) for k in range(dim)]
        g = [0.0] * dim
        g[axis] = -4.0 * up
        if up > 0:
            high[axis] = 200.0
        else:
            low[axis] = -200.0
        folder = self.dump({7: points}, manifest(dim, gravity=g, walls=True, domain_min=low,
                                                 domain_max=high, time_step=0.1))
        if pressures is not None:
            np.save(os.path.join(folder, f"{name}_000007.npy"), pressures)
        return self.errors(folder, "E7")["frames"][0]

    def test_exact_pressure(self):
        points = lattice(20, 30)
        p = 4.0 * (29.5 - points[:, 1])  # depth 30 from the wall's surface at -0.5
        row = self.tank(points, 1, 1, p)
        self.assertAlmostEqual(row["depth"], 30.0, 9)
        self.assertLess(row["pressure.max"], 1e-12)
        self.assertLess(abs(row["surface.mean_error"]), 0.02)
        self.assertLess(row["surface.rms"], 0.01)

    def test_wrong_pressure_shows(self):
        points = lattice(20, 30)
        p = 4.0 * (29.5 - points[:, 1])
        p[100] += 0.02 * 4.0 * 30
        row = self.tank(points, 1, 1, p)
        self.assertAlmostEqual(row["pressure.max"], 0.02, 9)
        self.assertAlmostEqual(row["pressure.mean_signed"], 0.02 / 600, 9)

    def test_lambda_is_minus_pressure_times_the_step_squared(self):
        points = lattice(20, 30)
        row = self.tank(points, 1, 1, -4.0 * (29.5 - points[:, 1]) * 0.01, "lambdas")
        self.assertLess(row["pressure.max"], 1e-12)

    def test_gravity_the_other_way_and_along_z(self):
        points = lattice(20, 30)
        row = self.tank(points, 1, -1, 4.0 * (points[:, 1] + 0.5))
        self.assertLess(row["pressure.max"], 1e-12)
        self.assertLess(abs(row["surface.mean_error"]), 0.02)
        points = lattice(8, 8, 12)
        row = self.tank(points, 2, 1, 4.0 * (11.5 - points[:, 2]))
        self.assertLess(row["pressure.max"], 1e-12)
        self.assertLess(abs(row["surface.mean_error"]), 0.02)

    def test_surface_too_high(self):
        points = lattice(20, 30)
        points[:, 1] *= 1 + 0.4 / 29
        row = self.tank(points, 1, 1)
        self.assertAlmostEqual(row["surface.mean_error"], 0.4, delta=0.03)
        self.assertIsNone(row["pressure.max"])

    def test_sloping_surface(self):
        points = lattice(40, 30)
        rise = (points[:, 0] - 19.5) * 0.05
        points[:, 1] += rise * (points[:, 1] / 29)
        row = self.tank(points, 1, 1)
        self.assertAlmostEqual(row["surface.rms"], 0.05 * np.sqrt(40**2 / 12), delta=0.05)


if __name__ == "__main__":
    unittest.main()
