"""E10 on errors of known order."""
import json
import os
import unittest

from synthetic import DumpTest, lattice, manifest


class Order(DumpTest):
    def reports(self, error_of):
        paths = []
        x = lattice(6, 6)
        for k, dt in enumerate((0.04, 0.01, 0.02)):
            run = self.dump({0: x, 4: x + [error_of(dt), 0.0]}, manifest(2, time_step=dt))
            reference = self.dump({0: x, 4: x}, manifest(2, time_step=dt))
            paths.append(os.path.join(self.root, f"{k}.json"))
            self.assertEqual(self.run_check("errors", run, "--only", "E3", "--reference", reference,
                                            "--json", paths[-1])[0], 0)
        return paths

    def test_second_order(self):
        e10 = self.report("order", *self.reports(lambda dt: 30 * dt**2), "--error", "E3.rms@last")
        e10 = e10["errors"]["E10"]
        self.assertAlmostEqual(e10["slope"], 2.0, 9)
        self.assertTrue(e10["monotone"])
        self.assertEqual([round(v, 9) for v in e10["parameters"]], [0.04, 0.02, 0.01])

    def test_not_monotone(self):
        e10 = self.report("order", *self.reports(lambda dt: 0.3 if dt == 0.02 else dt),
                          "--error", "E3.rms@last")["errors"]["E10"]
        self.assertFalse(e10["monotone"])

    def test_iterations_fall_upwards(self):
        paths = self.reports(lambda dt: dt)
        e10 = self.report("order", *paths, "--error", "E3.rms", "--by", "iterations", "--values", 10, 40, 20)
        self.assertAlmostEqual(e10["errors"]["E10"]["slope"], -1.0, 9)
        self.assertTrue(e10["errors"]["E10"]["monotone"])

    def test_faults(self):
        paths = self.reports(lambda dt: dt)
        code, _, err = self.run_check("order", *paths, "--error", "E3.nothing")
        self.assertEqual(code, 3)
        self.assertIn('has no figure "E3.nothing"', err)
        code, _, err = self.run_check("order", *paths, "--error", "E3.rms", "--by", "iterations")
        self.assertEqual((code, "iterations" in err), (3, True))
        with open(paths[0], "w", encoding="utf-8") as file:
            json.dump({"tool": "other"}, file)
        self.assertEqual(self.run_check("order", *paths, "--error", "E3.rms")[0], 3)


if __name__ == "__main__":
    unittest.main()
