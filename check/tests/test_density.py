"""E1 against lattices, whose density is known."""
import unittest
from unittest import mock

import numpy as np

from synthetic import DumpTest, lattice, manifest
from pbfcheck.coverage import covered_shares
from pbfcheck.stats import of_errors
from pbfcheck.volume import splat_volume


class Density(DumpTest):
    def last(self, points, *arguments, **changes):
        folder = self.dump({0: points}, manifest(points.shape[1], **changes))
        return self.errors(folder, "E1", *arguments)["frames"][0]

    def test_perfect_lattice_has_no_error(self):
        for counts in ((24, 24), (12, 12, 12)):
            row = self.last(lattice(*counts))
            for kernel in ("measure", "own"):
                self.assertLess(row[f"{kernel}.interior.max"], 1e-12)
                self.assertGreater(row[f"{kernel}.interior.count"], 6 ** len(counts))
            # Two layers off on every side; the corners of what is left may go, too.
            inner = np.prod([n - 4 for n in counts])
            self.assertGreaterEqual(row["measure.interior.count"], inner - 2 ** len(counts))
            self.assertLessEqual(row["measure.interior.count"], inner)

    def test_density_is_that_of_the_kernels_sum(self):
        # Squeezed to a spacing of 0.9 the sum over the lattice is computed here, term by term.
        for dim, norm in ((2, 7 / (np.pi * 9)), (3, 21 / (2 * np.pi * 27))):
            def density(spacing):
                r = spacing * np.linalg.norm(lattice(*[9] * dim, origin=-4.0), axis=1) / 3
                q = r[r < 1]
                return norm * np.sum((1 - q) ** 4 * (4 * q + 1))
            row = self.last(lattice(*[16] * dim, spacing=0.9))
            expected = density(0.9) / density(1.0) - 1
            self.assertAlmostEqual(row["measure.interior.highest"], expected, 9)
            self.assertAlmostEqual(row["measure.interior.lowest"], expected, delta=1e-3)

    def test_compressed_lattice_shows_its_factor(self):
        for counts in ((60, 40), (20, 20, 20)):
            dim = len(counts)
            spacing = 1.02 ** (-1 / dim)  # 2 % denser
            row = self.last(lattice(*counts, spacing=spacing))
            self.assertAlmostEqual(row["measure.interior.mean_signed"], 0.02, delta=1e-3)
            self.assertAlmostEqual(row["measure.interior.mean_abs"], 0.02, delta=1e-3)
            self.assertAlmostEqual(row["measure.all.compression_max"], 0.02, delta=1e-3)

    def test_expansion_does_not_hide(self):
        for counts in ((40, 40), (16, 16, 16)):
            dim = len(counts)
            row = self.last(lattice(*counts, spacing=0.7 ** (-1 / dim)))  # 30 % thinner
            self.assertAlmostEqual(row["measure.interior.mean_signed"], -0.3, delta=0.02)
            self.assertGreater(row["measure.interior.count"], 0.4 * np.prod(counts))

    def test_spray_does_not_dilute(self):
        rng = np.random.default_rng(7)
        for counts in ((30, 30), (14, 14, 14)):
            block = lattice(*counts, spacing=0.98)
            spray = rng.uniform(50, 300, (len(block), len(counts)))
            alone = self.last(block)
            mixed = self.last(np.concatenate([block, spray]))
            for figure in ("count", "mean_abs", "rms", "p99", "max", "mean_signed"):
                self.assertAlmostEqual(mixed[f"measure.interior.{figure}"],
                                       alone[f"measure.interior.{figure}"], 12, figure)
            self.assertAlmostEqual(mixed["measure.interior_share"],
                                   alone["measure.interior_share"] / 2, 12)

    def test_stray_particles_near_the_surface_are_not_interior(self):
        block = lattice(30, 20)
        strays = np.array([[8.0, 21.0], [8.6, 22.3], [20.0, 21.5]])
        alone, mixed = self.last(block), self.last(np.concatenate([block, strays]))
        self.assertLess(mixed["measure.interior.max"], 0.05)
        self.assertLessEqual(mixed["measure.interior.count"] - alone["measure.interior.count"], 8)

    def test_a_hole_is_an_error_or_not_interior(self):
        points = lattice(31, 31)
        hole = np.all(points == 15, axis=1)
        row = self.last(points[~hole])
        self.assertLess(row["measure.interior.lowest"], -0.05)

    def test_lattice_against_walls_is_interior_and_exact(self):
        for counts in ((20, 20), (10, 10, 10)):
            dim = len(counts)
            top = [n - 1.0 for n in counts]
            row = self.last(lattice(*counts), walls=True, domain_min=[0.0] * dim, domain_max=top)
            self.assertEqual(row["measure.interior.count"], np.prod(counts))
            self.assertLess(row["measure.interior.max"], 1e-12)
            self.assertLess(row["own.interior.max"], 1e-12)
            # A ball of 3 spacings meets no wall from 2.5 layers on.
            self.assertEqual(row["measure.bulk.count"], np.prod([n - 6 for n in counts]))

    def test_wall_surface_can_stand_on_the_bound(self):
        points = lattice(20, 20, origin=0.5)
        row = self.last(points, walls={"offset": 0.0}, domain_min=[0.0, 0.0], domain_max=[20.0, 20.0])
        self.assertEqual(row["measure.interior.count"], 400)
        self.assertLess(row["measure.interior.max"], 1e-12)

    def test_without_wall_density_the_wall_shows(self):
        points = lattice(20, 20)
        values = dict(walls=True, domain_min=[0.0, 0.0], domain_max=[19.0, 19.0])
        row = self.last(points, "--wall-density", "none", **values)
        self.assertLess(row["measure.interior.lowest"], -0.2)
        self.assertLess(row["measure.bulk.max"], 1e-12)
        row = self.last(points, "--wall-density", "integral", **values)
        self.assertLess(row["measure.interior.max"], 0.03)
        self.assertGreater(row["measure.interior.max"], 1e-4)

    def test_moving_wall(self):
        points = lattice(20, 20)
        values = manifest(2, domain_min=[0.0, 0.0], domain_max=[18.0, 19.0], walls={
            "velocity": [0, 2.0, 0, 0], "amplitude": [0, 0.5, 0, 0],
            "frequency": [0, np.pi, 0, 0], "phase": [0, 0, 0, 0]}, time_step=0.5)
        # At step 1, time 0.5: 18 + 2 * 0.5 + 0.5 sin(pi/2) = 19.5
        wide = points.copy()
        wide[points[:, 0] == 19, 0] = 19.0
        row = self.errors(self.dump({1: wide}, values), "E1")["frames"][0]
        self.assertLess(row["measure.interior.lowest"], -0.01)  # half a spacing of gap
        values["walls"]["amplitude"][1] = 0.0
        row = self.errors(self.dump({1: wide}, values), "E1")["frames"][0]
        self.assertLess(row["measure.interior.max"], 1e-12)

    def test_own_kernel_poly6(self):
        # Term by term, with the 2D constant 4/(pi h^8) and a volume that is not calibrated.
        h, volume = 2.2, 0.9
        r2 = np.square(lattice(7, 7, origin=-3.0)).sum(axis=1)
        expected = volume * np.sum(4 / (np.pi * h**8) * (h * h - r2[r2 < h * h]) ** 3) - 1
        row = self.last(lattice(20, 20), kernel="poly6_spiky", smoothing_radius=h,
                        particle_volume=volume)
        self.assertAlmostEqual(row["own.interior.mean_signed"], expected, 12)

    def test_rest_spacing_follows_the_constraint_where_the_start_is_not_at_rest(self):
        # The start is 0.575 apart, the solver's own constraint holds at a wider lattice.
        values = manifest(2, kernel="poly6_spiky", smoothing_radius=1.1, spacing=0.575,
                          particle_volume=0.5138132684248845)
        folder = self.dump({0: lattice(30, 30, spacing=0.575)}, values)
        report = self.report("errors", folder, "--only", "E1")
        d = report["dump"]["rest_spacing"]
        r2 = d * d * np.square(lattice(5, 5, origin=-2.0)).sum(axis=1)
        density = 0.5138132684248845 * np.sum(4 / (np.pi * 1.1**8) * np.maximum(1.21 - r2, 0) ** 3)
        self.assertAlmostEqual(density, 1.0, 9)
        self.assertGreater(d, 0.6)
        self.assertGreater(report["errors"]["E1"]["frames"][0]["own.interior.mean_signed"], 0.4)

    def test_figures_of_a_known_sample(self):
        errors = np.append(np.linspace(-1, 1, 201), 3.0)  # 202 values
        figures = of_errors(errors)
        size = np.sort(np.abs(errors))
        self.assertEqual(figures["count"], 202)
        self.assertAlmostEqual(figures["mean_abs"], (2 * np.arange(1, 101).sum() / 100 + 3) / 202, 12)
        self.assertAlmostEqual(figures["mean_signed"], 3 / 202, 12)
        self.assertAlmostEqual(figures["rms"], np.sqrt((errors**2).sum() / 202), 12)
        self.assertTrue(size[198] <= figures["p99"] <= size[200])
        self.assertEqual((figures["max"], figures["lowest"], figures["highest"]), (3.0, -1.0, 3.0))

    def test_space_cut_into_tiles_gives_the_same(self):
        rng = np.random.default_rng(5)
        for counts in ((40, 30), (12, 10, 14)):
            dim = len(counts)
            points = lattice(*counts) + rng.normal(0, 0.1, (int(np.prod(counts)), dim))
            surfaces = np.full(dim, -np.inf), np.full(dim, np.inf)
            whole = splat_volume(points, 1.0, surfaces), covered_shares(points, [3.0], 1.0, surfaces)[3.0]
            with mock.patch("pbfcheck.tiles._allowed", lambda count: 1500):
                cut = splat_volume(points, 1.0, surfaces), covered_shares(points, [3.0], 1.0, surfaces)[3.0]
            self.assertAlmostEqual(cut[0], whole[0], 8)
            # Each tile's voxels start at its own corner.
            self.assertLess(np.abs(cut[1] - whole[1]).max(), 0.03)

    def test_no_particles(self):
        row = self.last(np.zeros((0, 3)))
        self.assertEqual(row["measure.interior.count"], 0)
        self.assertIsNone(row["measure.interior.mean_abs"])


if __name__ == "__main__":
    unittest.main()
