"""E3, E4, E5, E6, E9 and the particles' state against known motions."""
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest


def turn(points, angle):
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


class Momentum(DumpTest):
    def test_rigid_rotation_keeps_both(self):
        x = lattice(20, 10)
        v = 0.7 * np.stack([-(x[:, 1] - 4.5), x[:, 0] - 9.5], 1)
        centre = np.array([9.5, 4.5])
        later = (turn(x - centre, 1.1) + centre, turn(v, 1.1))
        folder = self.dump({0: (x, v), 3: later}, manifest(2))
        for key in ("E4", "E5"):
            self.assertLess(self.errors(folder, key)["frames"][1]["relative"], 1e-13)

    def test_known_drift_of_spin(self):
        for dim in (2, 3):
            x = lattice(*[8] * dim)
            v = np.zeros_like(x)
            v[:, 0], v[:, 1] = -(x[:, 1] - 3.5), x[:, 0] - 3.5
            folder = self.dump({0: (x, v), 1: (x, 1.01 * v)}, manifest(dim))
            row = self.errors(folder, "E5")["frames"][1]
            arm = np.linalg.norm(x - 3.5, axis=1)
            spin = np.square(x[:, :2] - 3.5).sum()
            scale = 1.01 * np.sum(arm * np.linalg.norm(v, axis=1))
            self.assertAlmostEqual(row["relative"], 0.01 * spin / scale, 12)
            self.assertLess(self.errors(folder, "E4")["frames"][1]["relative"], 1e-14)

    def test_particles_of_several_masses_are_not_judged(self):
        x = lattice(4, 4)
        frames = {0: (x, np.ones_like(x)), 1: (x, np.ones_like(x))}
        for phases, judged in (([1.0, 0.7], False), ([1.0, 1.0], True)):
            folder = self.dump(frames, manifest(2, phases=phases))
            for key in ("E4", "E5", "E6"):
                entry = self.report("errors", folder, "--only", key)["errors"][key]
                self.assertEqual("frames" in entry, judged)
                self.assertEqual("rest densities" in entry.get("reason", ""), not judged)

    def test_known_drift_of_momentum(self):
        x = lattice(10, 10)
        v = np.zeros_like(x)
        v[:, 0] = np.where(np.arange(100) % 2, 1.0, -1.0)  # no momentum, but speed
        pushed = v.copy()
        pushed[:, 1] += 0.1
        folder = self.dump({0: (x, v), 1: (x, pushed)}, manifest(2))
        row = self.errors(folder, "E4")["frames"][1]
        self.assertAlmostEqual(row["relative"], 10.0 / (100 * np.hypot(1, 0.1)), 12)

    def test_at_rest(self):
        folder = self.dump({0: lattice(4, 4), 1: lattice(4, 4)}, manifest(2))
        self.assertEqual(self.errors(folder, "E4")["frames"][1]["relative"], 0.0)

    def test_other_particles_have_no_drift(self):
        folder = self.dump({0: lattice(4, 4), 1: lattice(4, 5)}, manifest(2))
        entry = self.report("errors", folder, "--only", "E4")["errors"]["E4"]
        self.assertIn("step 1 has 20 particles, the first frame 16", entry["reason"])

    def test_missing_velocities_are_named(self):
        import os
        folder = self.dump({0: lattice(4, 4)}, manifest(2))
        os.remove(os.path.join(folder, "velocities_000000.npy"))
        code, _, err = self.run_check("errors", folder, "--only", "E5")
        self.assertEqual(code, 3)
        self.assertIn("velocities_000000.npy: is missing", err)


class EnergyOfMotion(DumpTest):
    def test_gravity(self):
        x = np.full((5, 2), 10.0)
        x[:, 0] = np.arange(5)
        at = lambda y, speed: (x * [1, 0] + [0, y], np.full((5, 2), [0.0, -speed]))  # noqa: E731
        # g = 2 from the floor at 0: E = 2 y + speed²/2 = 20, 20, 16, 18
        folder = self.dump({0: at(10, 0), 1: at(9, 2), 2: at(8, 0), 3: at(9, 0)},
                           manifest(2, gravity=[0.0, -2.0], domain_min=[0.0, 0.0], walls=True))
        entry = self.errors(folder, "E6")
        for row, expected in zip(entry["frames"], (0, 0, -0.2, -0.1)):
            self.assertAlmostEqual(row["relative"], expected, 12)
        self.assertAlmostEqual(entry["figures"]["highest_gain"], 0.1, 12)
        self.assertAlmostEqual(entry["frames"][1]["kinetic"], 2.0, 12)

    def test_gravity_upwards_counts_from_the_ceiling(self):
        x = np.array([[0.0, 4.0]])
        folder = self.dump({0: x, 1: x - [0, 1]}, manifest(2, gravity=[0.0, 3.0], walls=True,
                                                           domain_min=[-9.0, 0.0], domain_max=[9.0, 6.0]))
        self.assertAlmostEqual(self.errors(folder, "E6")["frames"][1]["relative"], 0.5, 12)

    def test_attraction(self):
        x = np.array([[3.0, 0.0], [0.0, 4.0]])
        folder = self.dump({0: x, 1: 2 * x}, manifest(2, attraction=2.0, attraction_center=[0.0, 0.0]))
        entry = self.errors(folder, "E6")
        self.assertAlmostEqual(entry["frames"][0]["potential"], 12.5, 12)
        self.assertAlmostEqual(entry["frames"][1]["relative"], 3.0, 12)

    def test_moving_walls_are_noted(self):
        folder = self.dump({0: (lattice(3, 3), lattice(3, 3))}, manifest(2, walls={
            "velocity": [0, 0.1, 0, 0]}))
        self.assertIn("walls move", self.errors(folder, "E6")["note"])


class NoiseAtRest(DumpTest):
    def test_known_speed(self):
        x = lattice(10, 10, spacing=0.5)
        v = np.full((100, 2), 0.03) * np.where(np.arange(100) % 2, 1, -1)[:, None]
        folder = self.dump({0: (x, v)}, manifest(2, gravity=[0.0, -8.0], spacing=0.5, smoothing_radius=1.0))
        row = self.errors(folder, "E9")["frames"][0]
        self.assertAlmostEqual(row["rms"], 0.03 * np.sqrt(2) / 2, 12)

    def test_needs_gravity(self):
        folder = self.dump({0: lattice(3, 3)}, manifest(2))
        self.assertIn("no gravity", self.report("errors", folder, "--only", "E9")["errors"]["E9"]["reason"])


class Distance(DumpTest):
    def test_known_shift(self):
        x = lattice(12, 12, spacing=0.2)
        size = {"spacing": 0.2, "smoothing_radius": 0.4}
        run = self.dump({10: x + [0.06, 0.08]}, manifest(2, **size))
        # The reference takes half the time step: its step 20 is this run's 10.
        reference = self.dump({20: x}, manifest(2, time_step=0.005, **size))
        row = self.errors(run, "E3", "--reference", reference)["frames"][0]
        self.assertAlmostEqual(row["rms"], 0.5, 12)
        self.assertFalse(row["trajectories_agree"])

    def test_cells(self):
        x = lattice(8, 8, origin=0.5)  # four cells of 4 spacings
        half = x.copy()
        half[x[:, 0] < 4] += [100.0, 0.0]
        for moved, expected in ((x, 0.0), (half, 0.5), (x + 100.0, 1.0)):
            run, reference = self.dump({0: moved}, manifest(2)), self.dump({0: x}, manifest(2))
            row = self.errors(run, "E3", "--reference", reference)["frames"][0]
            self.assertAlmostEqual(row["cells"], expected, 12)

    def test_floor_decides_when_trajectories_part(self):
        x = lattice(8, 8)
        run = self.dump({0: x, 1: x + 3.0, 2: x, 3: x}, manifest(2))
        reference = self.dump({k: x for k in range(4)}, manifest(2))
        floor = self.dump({0: x + 1e-6, 1: x + 0.01, 2: x + 0.2, 3: x}, manifest(2))
        rows = self.errors(run, "E3", "--reference", reference, "--floor", floor)["frames"]
        self.assertEqual([r["trajectories_agree"] for r in rows], [True, True, False, False])
        self.assertAlmostEqual(rows[2]["floor.rms"], 0.2 * np.sqrt(2), 12)

    def test_reference_without_that_time(self):
        run = self.dump({5: lattice(4, 4)}, manifest(2))
        reference = self.dump({5: lattice(4, 4)}, manifest(2, time_step=0.02))
        code, _, err = self.run_check("errors", run, "--only", "E3", "--reference", reference)
        self.assertEqual(code, 3)
        self.assertIn("has no step at time 0.05", err)


class State(DumpTest):
    def test_outside_and_lost(self):
        x = lattice(4, 4)
        out = x[1:].copy()
        out[0] = [-0.5, 3.25]
        folder = self.dump({0: x, 1: out}, manifest(2, walls=True, domain_min=[0.0, 0.0],
                                                    domain_max=[3.0, 3.0]), np.float32)
        rows = self.errors(folder, "state")["frames"]
        self.assertEqual((rows[0]["outside"], rows[0]["lost"]), (0, 0))
        self.assertEqual((rows[1]["outside"], rows[1]["lost"]), (1, 1))
        self.assertAlmostEqual(rows[1]["outside_by"], 0.5, 9)

    def test_float32_rounding_of_a_bound_is_no_escape(self):
        bound = 204.55
        x = np.array([[1.0, np.float64(np.nextafter(np.float32(bound), np.float32(1000)))]])
        folder = self.dump({0: x}, manifest(2, walls=True, domain_max=[500.0, bound],
                                            domain_min=[0.0, 0.0]), np.float32)
        self.assertEqual(self.errors(folder, "state")["frames"][0]["outside"], 0)


if __name__ == "__main__":
    unittest.main()
