"""Kernels, walls and splat surfaces against integrals."""
import unittest

import numpy as np
from scipy.integrate import quad

from synthetic import lattice
from pbfcheck.kernels import KERNELS, rest_spacing
from pbfcheck.surface import lattice_margin
from pbfcheck.walls import half_space_share, half_space_table, mirror_images


class Kernels(unittest.TestCase):
    def test_unit_integral(self):
        for name, kernel in KERNELS.items():
            for dim in (2, 3):
                shell = (lambda r: 2 * np.pi * r) if dim == 2 else (lambda r: 4 * np.pi * r * r)
                total = quad(lambda r: shell(r) * float(kernel(r, 0.7, dim)), 0, 0.7)[0]
                self.assertAlmostEqual(total, 1.0, 9, f"{name} {dim}D")
                self.assertEqual(float(kernel(0.71, 0.7, dim)), 0.0)

    def test_rest_spacing_stays_where_the_lattice_is_at_rest(self):
        self.assertEqual(rest_spacing("wendland_c2", 2.0, 1.0, 0.97, 3), (1.0, "spacing"))


class Walls(unittest.TestCase):
    def test_half_of_the_kernel_lies_behind_a_plane_through_its_centre(self):
        for dim in (2, 3):
            z, beyond = half_space_table("wendland_c2", 2.0, dim)
            self.assertAlmostEqual(beyond[0], 0.5, 4)
            self.assertEqual(beyond[-1], 0.0)

    def test_half_space_against_a_sum_over_points(self):
        axis = (np.arange(800) + 0.5) / 800 * 2 - 1
        x, y = np.meshgrid(axis, axis)
        expected = KERNELS["wendland_c2"](np.hypot(x, y), 1.0, 2)[x > 0.3].sum() * (2 / 800) ** 2
        z, beyond = half_space_table("wendland_c2", 1.0, 2)
        self.assertAlmostEqual(np.interp(0.3, z, beyond), expected, 4)

    def test_half_space_lends_the_first_layer_what_a_lattice_would(self):
        for dim, h in ((2, 2.0), (3, 2.0), (3, 3.0)):
            behind = lattice(*[9] * dim, origin=-4.0)
            behind = behind[behind[:, 0] < 0]
            lent = KERNELS["wendland_c2"](np.linalg.norm(behind, axis=1), h, dim).sum()
            surfaces = np.full(dim, -np.inf), np.full(dim, np.inf)
            surfaces[0][0] = -0.5
            share = half_space_share(np.zeros((1, dim)), surfaces, "wendland_c2", h, 1.0)[0]
            self.assertAlmostEqual(share, lent, 4)

    def test_mirror_continues_a_lattice_beyond_a_corner(self):
        points = lattice(6, 6)
        surfaces = np.array([-0.5, -0.5]), np.array([np.inf, np.inf])
        ghosts = mirror_images(points, surfaces, 3.0)
        every = {tuple(p) for p in np.concatenate([points, ghosts]).round(9)}
        wanted = {(float(x), float(y)) for x in range(-3, 6) for y in range(-3, 6)}
        self.assertEqual(every, wanted)
        self.assertEqual(len(ghosts), len(wanted) - 36)  # none twice

    def test_mirror_continues_a_slab_thinner_than_the_reach(self):
        points = lattice(2, 1)  # between walls two spacings apart
        surfaces = np.array([-0.5, -np.inf]), np.array([1.5, np.inf])
        ghosts = mirror_images(points, surfaces, 4.0)
        self.assertEqual(sorted(ghosts[:, 0].round(9)), [-4, -3, -2, -1, 2, 3, 4, 5])


class Surface(unittest.TestCase):
    def test_margin_of_a_flat_lattice(self):
        for dim in (2, 3):
            self.assertAlmostEqual(lattice_margin(dim), 0.5, delta=0.15)


if __name__ == "__main__":
    unittest.main()
