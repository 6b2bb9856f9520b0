"""E8 and Ritter's profile against fluid laid out along the published data itself."""
import os
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest
from pbfcheck.validation_data import FRONT, HEIGHT, table

D = 1 / 32


def column(left, right, height):
    """Lattice between left and right; its top and right layers end there, half a spacing inside."""
    x = np.arange(right - D / 2, left, -D)
    y = np.arange(height - D / 2, 0, -D)
    return np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)


class MartinMoyce(DumpTest):
    G = 2.0  # with a = 1: T = 2 t, tau = sqrt(2) t

    def run_along(self, front_factor=1.0, height_shift=0.0, front_rate=1.0, **changes):
        front, height = table(FRONT), table(HEIGHT)
        frames = {}
        for step in range(0, 165, 3):
            t = step * 0.01
            z = np.interp(2 * t * front_rate, front["T"], front["Z"])
            h = np.interp(np.sqrt(2) * t, height["tau"], height["H"])
            if step == 0:
                frames[0] = lattice(32, 64, spacing=D, origin=D / 2)
                continue
            z *= front_factor
            tail = column(0.5, z, 4 * D)
            frames[step] = np.concatenate([column(0.0, 0.5, 2 * (h + height_shift)), tail])
        values = manifest(2, spacing=D, smoothing_radius=2 * D, gravity=[0.0, -self.G],
                          walls={"offset": 0.0}, domain_min=[0.0, 0.0], domain_max=[8.0, 8.0])
        values.update(changes)
        return self.dump(frames, values)

    def test_the_tables_themselves(self):
        entry = self.validation("dam-break", self.run_along())
        self.assertAlmostEqual(entry["figures"]["a"], 1.0, 9)
        self.assertLess(entry["figures"]["front.rms"], 0.004)
        self.assertLess(entry["figures"]["height.max"], 0.01)
        self.assertEqual(entry["figures"]["front.points"], 15)
        self.assertLess(abs(entry["figures"]["best_shift"]), 0.021)

    def test_known_offsets(self):
        figures = self.validation("dam-break", self.run_along(1.03, -0.02))["figures"]
        self.assertAlmostEqual(figures["front.mean_signed"], 0.03, delta=0.003)
        self.assertAlmostEqual(figures["front.rms"], 0.03, delta=0.004)
        self.assertAlmostEqual(figures["height.rms"], 0.02, delta=0.006)

    def test_a_late_front_fails(self):
        # A front that mistakes t sqrt(g/a) for T.
        self.validation("dam-break", self.run_along(front_rate=np.sqrt(0.5)), code=1)

    def test_frames_after_the_far_wall_are_left_out(self):
        folder = self.run_along(domain_max=[3.0, 8.0])
        figures = self.validation("dam-break", folder)["figures"]
        self.assertLess(figures["front.points"], 12)
        self.assertLess(figures["front.rms"], 0.004)

    def test_spray_is_no_front(self):
        folder = self.run_along()
        os.remove(os.path.join(folder, "velocities_000081.npy"))
        path = os.path.join(folder, "positions_000081.npy")
        np.save(path, np.concatenate([np.load(path), [[6.0, 1.0], [6.0, 1.02]]]))
        self.assertLess(self.validation("dam-break", folder)["figures"]["front.rms"], 0.004)

    def test_gate_shift(self):
        late = self.validation("dam-break", self.run_along(), "--gate-shift", "0.175", code=1)["figures"]
        self.assertGreater(abs(late["front.mean_signed"]), 0.02)
        self.assertAlmostEqual(late["best_shift"], -0.175, delta=0.02)

    def test_wrong_column(self):
        folder = self.dump({0: lattice(20, 20)}, manifest(2, gravity=[0.0, -1.0]))
        entry = self.report("errors", folder, "--only", "E8")["errors"]["E8"]
        self.assertIn("twice as high as wide", entry["reason"])


class DryBed(DumpTest):
    def frames(self, factor=1.0):
        d, h0, length = 0.05, 2.0, 12.0
        frames = {0: column_of(lambda x: np.where(x < 0, h0, 0.0), d, -length, 20.0)}
        for step in (100, 200):
            t = step * 0.01
            def profile(x, t=t):
                xi = x / (t * np.sqrt(h0))
                h = np.where(xi < -1, h0, h0 * 4 / 9 * np.square(1 - np.minimum(xi, 2) / 2))
                return np.where(xi < -1, h, factor * h)
            frames[step] = column_of(profile, d, -length, 20.0)
        return self.dump(frames, manifest(2, spacing=d, smoothing_radius=2 * d, gravity=[0.0, -1.0],
                                          walls={"offset": 0.0}, domain_min=[-12.0, 0.0],
                                          domain_max=[20.0, 5.0]))

    def test_profile(self):
        entry = self.validation("ritter", self.frames())
        self.assertLess(entry["figures"]["profile.rms.last"], 0.01)
        self.assertAlmostEqual(entry["figures"]["dam.height.last"], 4 / 9, delta=0.02)

    def test_a_profile_too_low(self):
        self.assertGreater(self.validation("ritter", self.frames(0.8))["figures"]["profile.rms.last"], 0.04)


def column_of(height, d, left, right):
    """Columns of particles whose top cell ends at height(x)."""
    points = []
    for x in np.arange(left + d / 2, right, d):
        y = np.arange(float(height(np.array(x))) - d / 2, 0, -d)
        points.append(np.stack([np.full(len(y), x), y], 1))
    return np.concatenate(points)


if __name__ == "__main__":
    unittest.main()
