"""The validation runs against motions laid out by the closed forms."""
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest
from pbfcheck.ellipse import exact_axes, exact_period
from pbfcheck.validation_data import ELLIPTIC_PATCH, OSCILLATING_DROP, table


def disc(radius, d):
    n = int(2 * radius / d) + 3
    points = lattice(n, n, spacing=d, origin=-(n - 1) / 2 * d)
    return points[np.hypot(*points.T) < radius]


class Ellipses(DumpTest):
    D = 0.04

    def dump_along(self, times, a, rate, attraction=0.0, b_factor=1.0):
        start = disc(1.0, self.D)
        v = rate * start * [-1.0, 1.0]
        frames = {round(t / 1e-6): start * [s, b_factor / s if t > 0 else 1 / s]
                  for t, s in zip(times, a)}
        frames[0] = (start, v)
        return self.dump(frames, manifest(2, spacing=self.D, smoothing_radius=2 * self.D, time_step=1e-6,
                                          attraction=attraction))

    def test_equations_against_the_published_tables(self):
        data = table(ELLIPTIC_PATCH)
        np.testing.assert_allclose(exact_axes(data["tau"], 1.0, 1.0, 0.0), data["a"], atol=2e-8)
        data = table(OSCILLATING_DROP)
        np.testing.assert_allclose(exact_axes(data["t"], 1.0, -0.5, 1.0), data["a"], atol=3e-6)
        self.assertAlmostEqual(exact_period(-0.5, 1.0), 4.567375, 5)
        self.assertAlmostEqual(exact_period(0.5, 1.0), 4.567375, 5)

    def test_patch_along_the_table(self):
        data = table(ELLIPTIC_PATCH)
        figures = self.validation("elliptic-patch", self.dump_along(data["tau"], data["a"], 1.0))["figures"]
        # The particles' cells are stretched here, in a fluid they are not: (d/a)²/24 of the axis.
        self.assertLess(figures["axes.max"], 0.004)
        self.assertAlmostEqual(figures["rate"], 1.0, 9)
        self.assertAlmostEqual(figures["radius"], 1.0, delta=0.01)

    def test_patch_that_grows(self):
        data = table(ELLIPTIC_PATCH)
        folder = self.dump_along(data["tau"], data["a"], 1.0, b_factor=1.05)
        figures = self.validation("elliptic-patch", folder, code=1)["figures"]
        self.assertAlmostEqual(figures["axes.max"], 0.05, delta=0.003)
        self.assertAlmostEqual(figures["area.max"], 0.05, delta=0.004)

    def test_drop_along_the_table(self):
        data = table(OSCILLATING_DROP)
        folder = self.dump_along(data["t"], data["a"], -0.5, attraction=1.0)
        figures = self.validation("oscillating-drop", folder)["figures"]
        self.assertLess(figures["axes.max"], 0.003)
        self.assertLess(abs(figures["period.error"]), 0.002)
        self.assertAlmostEqual(figures["amplitude.kept"], 1.0, delta=0.01)

    def test_drop_that_is_slow_and_dies(self):
        data = table(OSCILLATING_DROP)
        log_a = np.interp(data["t"] / 1.05, data["t"], np.log(data["a"])) * np.exp(-0.05 * data["t"])
        folder = self.dump_along(data["t"], np.exp(log_a), -0.5, attraction=1.0)
        figures = self.validation("oscillating-drop", folder, code=1)["figures"]
        self.assertAlmostEqual(figures["period.error"], 0.05, delta=0.005)
        self.assertAlmostEqual(figures["amplitude.kept"], np.exp(-0.05 * 1.05 * 4.567), delta=0.02)


class Swings(DumpTest):
    def sloshing(self, slow=1.0, mode=1):
        length, depth, g, d = 4.0, 1.0, 9.0, 0.05
        k = mode * np.pi / length
        omega = np.sqrt(g * k * np.tanh(k * depth)) / slow
        x0 = lattice(80, 20, spacing=d, origin=d / 2)
        frames = {}
        for step in range(0, 400, 8):
            x = x0.copy()
            # Mass moved sideways piles up into an elevation 0.05 cos(k x).
            x[:, 0] -= 0.05 / (depth * k) * np.sin(k * x0[:, 0]) * np.cos(omega * step * 0.01)
            frames[step] = x
        return self.dump(frames, manifest(2, spacing=d, smoothing_radius=2 * d, gravity=[0.0, -g],
                                          walls={"offset": 0.0}, domain_min=[0.0, 0.0],
                                          domain_max=[length, 3.0]))

    def test_sloshing(self):
        for mode in (1, 2):
            figures = self.validation("sloshing", self.sloshing(mode=mode), "--mode", mode)["figures"]
            self.assertLess(abs(figures["period.error"]), 1e-3)
            self.assertAlmostEqual(figures["amplitude"], 0.05, delta=0.001)
            self.assertAlmostEqual(figures["depth"], 1.0, 9)

    def test_slow_sloshing(self):
        figures = self.validation("sloshing", self.sloshing(1.04), code=1)["figures"]
        self.assertAlmostEqual(figures["period.error"], 0.04, delta=1e-3)

    def test_too_short_a_run(self):
        folder = self.sloshing()
        code, out, _ = self.run_check("validate", "sloshing", folder, "--steps", "0:80:1")
        self.assertEqual(code, 1)
        self.assertIn("not judged: the run lasts", out)

    def test_u_tube(self):
        length, g = 3.0, 6.0
        omega = np.sqrt(2 * g / length)
        frames = {}
        for step in range(0, 600, 10):
            right = round(1000 * (1 + 0.2 * np.exp(-0.1 * step * 0.01) * np.cos(omega * step * 0.01)))
            x = np.where(np.arange(2000) < right, 3.0, 1.0)
            frames[step] = np.stack([x, np.linspace(0, 1, 2000)], 1)
        folder = self.dump(frames, manifest(2, gravity=[0.0, -g], walls=True, domain_min=[0.0, 0.0],
                                            domain_max=[4.0, 9.0]))
        figures = self.validation("u-tube", folder, "--length", length)["figures"]
        self.assertLess(abs(figures["period.error"]), 3e-3)
        self.assertAlmostEqual(figures["decay_time"], 10.0, delta=0.7)
        self.validation("u-tube", folder, "--length", 3.3, code=1)
        self.assertEqual(self.run_check("validate", "u-tube", folder)[0], 2)


class Rotation(DumpTest):
    def tank(self, dim, omega, g=5.0):
        d = 0.05 if dim == 2 else 0.1
        half = 2.0
        n = int(round(2 * half / d))
        sideways = lattice(*[n] * (dim - 1), spacing=d, origin=-half + d / 2)
        points = []
        for at in sideways:
            eta = 0.6 + omega**2 * np.square(at).sum() / (2 * g)
            y = np.arange(eta - d / 2, 0, -d)
            points.append(np.insert(np.repeat(at[None], len(y), 0), 1, y, axis=1))
        low, high = [-half] * dim, [half] * dim
        low[1], high[1] = 0.0, 9.0
        return self.dump({0: np.concatenate(points)},
                         manifest(dim, spacing=d, smoothing_radius=2 * d, gravity=[0.0, -g, 0.0][:dim],
                                  walls={"offset": 0.0}, domain_min=low, domain_max=high))

    def test_paraboloid(self):
        for dim in (2, 3):
            folder = self.tank(dim, 2.0)
            figures = self.validation("rotating-tank", folder, "--omega", 2.0)["figures"]
            self.assertLess(abs(figures["curvature.error"]), 0.015)
            self.assertLess(figures["shape.rms"], 0.015)

    def test_another_speed(self):
        entry = self.validation("rotating-tank", self.tank(2, 2.0), "--omega", 2.1, code=1)
        self.assertAlmostEqual(entry["figures"]["curvature.error"], (2 / 2.1) ** 2 - 1, delta=0.01)


class Falling(DumpTest):
    def fall(self, position, floor=0.0):
        x0 = lattice(3, 3, spacing=5.0, origin=50.0)
        v0 = np.tile([1.0, 0.5], (9, 1))
        g, dt = np.array([0.0, -3.0]), 0.02
        frames = {n: (x0 + n * dt * v0 + position(n, dt) * g, v0 + n * dt * g) for n in range(0, 200, 20)}
        return self.dump(frames, manifest(2, gravity=g.tolist(), time_step=dt, walls=True,
                                          domain_min=[0.0, floor], domain_max=[100.0, 100.0]))

    def test_the_schemes_own_parabola(self):
        figures = self.validation("free-fall", self.fall(lambda n, dt: dt * dt * n * (n + 1) / 2))["figures"]
        self.assertLess(figures["position.max"], 1e-12)
        self.assertEqual(figures["frames"], 9)
        self.assertAlmostEqual(figures["parabola"], 1 / 180, 9)

    def test_ends_where_a_wall_is_met(self):
        # After 80 steps the lowest would be at 50 + 0.8 - 3.89; from then on they lie on the floor.
        folder = self.fall(lambda n, dt: dt * dt * (n * (n + 1) if n < 80 else 0) / 2, floor=48.0)
        self.assertEqual(self.validation("free-fall", folder)["figures"]["frames"], 3)

    def test_another_scheme_fails(self):
        self.validation("free-fall", self.fall(lambda n, dt: (n * dt) ** 2 / 2), code=1)


class Drops(DumpTest):
    def collision(self, push=0.0):
        drop = disc(1.0, 0.1)
        v = np.tile([0.5, 0.0], (len(drop), 1))
        apart = (np.concatenate([drop - [2, 0.3], drop + [2, 0.3]]), np.concatenate([v, -v]))
        # Met and turning: all the angular momentum that there was, in solid rotation.
        x = np.concatenate([drop - [0.93, 0.05], drop + [0.93, 0.05]])
        momentum = (apart[0][:, 0] * apart[1][:, 1] - apart[0][:, 1] * apart[1][:, 0]).sum()
        spin = momentum / np.square(x).sum()
        w = spin * np.stack([-x[:, 1], x[:, 0]], 1) + [push, 0.0]
        return self.dump({0: apart, 9: (x, w)}, manifest(2, spacing=0.1, smoothing_radius=0.2))

    def test_momentum_kept(self):
        figures = self.validation("colliding-drops", self.collision())["figures"]
        self.assertLess(figures["linear.max"], 1e-13)
        self.assertLess(figures["angular.max"], 1e-13)

    def test_momentum_gained(self):
        figures = self.validation("colliding-drops", self.collision(0.001), code=1)["figures"]
        self.assertAlmostEqual(figures["linear.max"], 0.001 / 0.5, 6)

    def test_drops_that_never_meet(self):
        code, out, _ = self.run_check("validate", "colliding-drops", self.collision(), "--steps", "0")
        self.assertEqual(code, 1)
        self.assertIn("have not met", out)


if __name__ == "__main__":
    unittest.main()
