"""E2 against shapes of known volume."""
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest


def ball(radius, dim):
    n = int(2 * radius) + 3
    points = lattice(*[n] * dim, origin=-(n - 1) / 2 + 0.137)
    return points[np.einsum("ij,ij->i", points, points) < radius**2]


class Volume(DumpTest):
    def rows(self, frames, **changes):
        dim = next(iter(frames.values())).shape[1]
        return self.errors(self.dump(frames, manifest(dim, **changes)), "E2")["frames"]

    def test_disc_and_ball(self):
        # The half-density surface lies 0.03 spacings inside a flat lattice's, more where it is curved.
        for radius, dim, exact in ((20.0, 2, np.pi * 400), (12.0, 3, 4 / 3 * np.pi * 1728)):
            row = self.rows({0: ball(radius, dim)})[0]
            self.assertAlmostEqual(row["volume"] / exact, 1, delta=0.02)

    def test_growth_of_an_expanded_body(self):
        # A thinner fluid reaches half the rest density a little farther in: small bodies lose a part.
        for points in (ball(25.0, 2), ball(11.0, 3)):
            dim = points.shape[1]
            rows = self.rows({0: points, 1: points * 1.01, 2: points * 0.99, 3: points * 1.1})
            for row, factor in zip(rows[1:], (1.01, 0.99, 1.1)):
                self.assertAlmostEqual(row["relative"] / (factor**dim - 1), 1, delta=0.25)

    def test_tank_and_a_risen_surface_is_seen(self):
        for counts in ((60, 30), (16, 16, 16)):
            dim = len(counts)
            points = lattice(*counts)
            risen = points.copy()
            risen[:, 1] *= 1.005
            top = [n - 1.0 for n in counts]
            top[1] = 100.0
            rows = self.rows({0: points, 5: risen}, walls=True, domain_min=[0.0] * dim, domain_max=top)
            self.assertAlmostEqual(rows[0]["against_rest"], 0, delta=0.04 / counts[1])
            self.assertAlmostEqual(rows[1]["relative"], 0.005 * (counts[1] - 1) / counts[1],
                                   delta=0.02 / counts[1])

    def test_spray_keeps_its_volume(self):
        points = lattice(40, 20)
        thrown = points.copy()
        top = points[:, 1] == 19
        thrown[top] = np.stack([np.arange(40) * 5.0, np.full(40, 60.0)], 1)
        rows = self.rows({0: points, 1: thrown}, walls=True, domain_min=[0.0, 0.0],
                         domain_max=[39.0, 500.0], gravity=[0.0, -1.0])
        self.assertEqual(rows[1]["spray_particles"], 40)
        self.assertAlmostEqual(rows[1]["relative"], 0, delta=2e-3)
        self.assertAlmostEqual(rows[1]["splat_only"], -0.05, delta=2e-3)

    def test_lost_fluid_is_lost_volume(self):
        points = lattice(30, 30)
        rows = self.rows({0: points, 1: points[points[:, 1] < 27]})
        self.assertAlmostEqual(rows[1]["relative"], -0.1, delta=3e-3)

    def test_far_apart_bodies_do_not_span_one_grid(self):
        body = lattice(8, 8, 8)
        rows = self.rows({0: body, 1: np.concatenate([body, body + 1e5])})
        self.assertAlmostEqual(rows[1]["relative"], 1.0, 6)


if __name__ == "__main__":
    unittest.main()
