"""Malformed dumps and wrong usage: the file is named, and what is wrong with it."""
import json
import os
import subprocess
import sys
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest

SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "pbf-check")


class Malformed(DumpTest):
    def rejected(self, folder, *words):
        code, out, err = self.run_check("errors", folder)
        self.assertEqual(code, 3, err)
        self.assertEqual(out, "")
        for word in words:
            self.assertIn(word, err)
        self.assertEqual(err.count("\n"), 1)

    def good(self):
        return self.dump({0: lattice(5, 5), 1: lattice(5, 5)}, manifest(2))

    def test_no_folder_no_manifest_no_frames(self):
        self.rejected(os.path.join(self.root, "nothing"), "nothing: is not a folder")
        folder = self.good()
        os.remove(os.path.join(folder, "dump.json"))
        self.rejected(folder, "dump.json: cannot be read")
        self.rejected(self.dump({}, manifest(2)), "holds no positions_<step, 6 digits>.npy")

    def test_manifest_text(self):
        for text, words in (("{", "is not JSON"), ("[1]", "must be an object"),
                            ("{}", 'lacks the key "dimension"'), (b"\xff\xfe", "is not JSON")):
            folder = self.good()
            with open(os.path.join(folder, "dump.json"), "wb") as file:
                file.write(text.encode() if isinstance(text, str) else text)
            self.rejected(folder, "dump.json: ", words)

    def test_manifest_values(self):
        for key, value in (("dimension", 4), ("dimension", "2"), ("smoothing_radius", 0),
                           ("smoothing_radius", "1"), ("spacing", -1), ("spacing", 5.0),
                           ("particle_volume", True), ("kernel", "cubic"), ("kernel", []), ("gravity", [1]),
                           ("gravity", [0, "g"]), ("domain_max", [-2000.0, 1.0]), ("time_step", 0),
                           ("walls", 3), ("walls", [True]), ("walls", {"velocity": [1]}),
                           ("walls", {"present": [1, 1, 1, 1]}), ("attraction", None),
                           ("particle_volume", 1e200), ("gravity", [0, -1e308]), ("time_step", 1e200),
                           ("spacing", 1e-200), ("domain_max", [1e308, 1.0])):
            folder = self.dump({0: lattice(3, 3)}, manifest(2, **{key: value}))
            name = next(iter(value)) if isinstance(value, dict) else "present" if key == "walls" and value == [True] else key
            self.rejected(folder, "dump.json", f'"{name}" is')

    def test_arrays(self):
        nan = lattice(5, 5)
        nan[7, 1] = np.nan
        large = lattice(5, 5)
        large[3, 0] = -1e155
        for array, words in ((np.zeros((5, 3)), "shape (5, 3); it must be (N, 2)"),
                             (np.zeros(5), "shape (5,)"), (np.zeros((5, 2), int), "holds int64"),
                             (np.array([[object()]]), "is not a whole .npy file"),
                             (nan, "nan at index (7, 1) and 0 more"),
                             (large, "holds -1e+155 at index (3, 0); numbers may be 1e+75 at most")):
            folder = self.good()
            np.save(os.path.join(folder, "positions_000001.npy"), array, allow_pickle=True)
            self.rejected(folder, "positions_000001.npy: ", words)

    def test_truncated(self):
        for keep in (0, 4, 60, 200):
            folder = self.good()
            path = os.path.join(folder, "positions_000000.npy")
            with open(path, "rb") as file:
                head = file.read(keep)
            with open(path, "wb") as file:
                file.write(head)
            self.rejected(folder, "positions_000000.npy: ")

    def test_velocities_of_others(self):
        folder = self.good()
        np.save(os.path.join(folder, "velocities_000001.npy"), np.zeros((24, 2)))
        self.rejected(folder, "velocities_000001.npy: has shape (24, 2); it must be (25, 2)")


class Usage(DumpTest):
    def test_wrong_usage(self):
        folder = self.dump({0: lattice(5, 5)}, manifest(2))
        for extra in (["--steps", "some"], ["--steps", "5"], ["--steps", "0:5:-1"], ["--only", "E99"],
                      ["--bound", "E1"], ["--bound", "E1.x<=a"], ["--coverage", "2"],
                      ["--measure-radius", "nan"], ["--json", "/nowhere/at/all"]):
            code, _, err = self.run_check("errors", folder, *extra)
            self.assertEqual(code, 2, extra)
            self.assertTrue(err, extra)

    def test_bounds(self):
        folder = self.dump({0: lattice(9, 9, spacing=0.9)}, manifest(2))
        for bound, code in (("E1.measure.interior.mean_signed<=0.4", 0),
                            ("E1.measure.interior.mean_signed@last<=0.01", 1),
                            ("E1.measure.interior.count>=1", 0), ("E1.measure.interior.count>=99", 1),
                            ("E1.nothing<=1", 1), ("state.outside<=0", 0)):
            got, out, _ = self.run_check("errors", folder, "--only", "E1,state", "--bound", bound)
            self.assertEqual(got, code, bound)
            self.assertIn("holds" if code == 0 else "FAILS", out)

    def test_steps(self):
        frames = {k: lattice(3, 3) for k in (0, 5, 10, 15)}
        folder = self.dump(frames, manifest(2))
        for choice, expected in (("all", [0, 5, 10, 15]), ("last", [15]), ("ends", [0, 15]), ("5", [5]),
                                 ("5:", [5, 10, 15]), (":10:2", [0, 10])):
            report = self.report("errors", folder, "--only", "state", "--steps", choice)
            self.assertEqual(report["dump"]["steps_judged"], expected)

    def test_report_is_json_and_a_table(self):
        folder = self.dump({0: lattice(12, 12)}, manifest(2, gravity=[0.0, -1.0]))
        path = os.path.join(self.root, "report.json")
        code, out, err = self.run_check("errors", folder, "--json", path)
        self.assertEqual(code, 0, err)
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
        self.assertEqual(report["tool"], "pbf-check")
        self.assertEqual(sorted(report["errors"]), sorted(
            ["state", "E1", "E2", "E3", "E4", "E5", "E6", "E7", "E8", "E9"]))
        for key, entry in report["errors"].items():
            self.assertTrue(entry["definition"] and entry["unit"])
            self.assertIn(f"{key}  {entry['title']}", out)
        self.assertIn("not judged: no --reference was given", out)

    def test_program(self):
        folder = self.dump({0: lattice(5, 5)}, manifest(2))
        run = subprocess.run([sys.executable, SCRIPT, "errors", folder, "--only", "state"],
                             capture_output=True, text=True, check=False)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertIn("rest spacing 1 ", run.stdout)

    def test_lost_output(self):
        """Is no bound that does not hold: all exit by 2, and say why unless a reader has read enough."""
        folder = self.dump({0: lattice(5, 5)}, manifest(2))
        judge = f"{sys.executable} {SCRIPT} errors {folder} --only state"
        for command in (judge, judge + " --json -", f"{sys.executable} {SCRIPT} --help"):
            for where, words in (("> /dev/full", "No space left"), (">&-", "Bad file descriptor")):
                run = subprocess.run(["bash", "-c", f"{command} {where}"], capture_output=True, text=True, check=False)
                self.assertEqual(run.returncode, 2, (command, where, run.stderr))
                self.assertRegex(run.stderr, rf"\Apbf-check: the standard output can't be written: {words}.*\n\Z")
            piped = f"( sleep 1; {command}; echo $? >&2 ) | true"
            run = subprocess.run(["bash", "-c", piped], capture_output=True, text=True, check=False)
            self.assertEqual(run.stderr, "2\n", command)
        for where in ("2>&-", "2>/dev/full", ">&- 2>&-"):
            run = subprocess.run(["bash", "-c", f"{judge} --steps some {where}"], capture_output=True, check=False)
            self.assertEqual(run.returncode, 2, where)

    def test_float32_dump(self):
        folder = self.dump({0: lattice(12, 12, spacing=0.1)}, manifest(
            2, spacing=0.1, smoothing_radius=0.2), np.float32)
        self.assertLess(self.errors(folder, "E1")["frames"][0]["measure.interior.max"], 1e-5)


if __name__ == "__main__":
    unittest.main()
