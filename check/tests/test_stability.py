"""Verdicts on stability cases: each judge is given a folder that passes and the same with one defect."""
import json
import os
import shutil
import unittest

import numpy as np

from synthetic import DumpTest, lattice, manifest

STILL = manifest(3, gravity=[0, -10, 0], domain_min=[0.0] * 3, domain_max=[6.0, 60.0, 6.0], walls=True)
FREE = manifest(3)


class StabilityTest(DumpTest):
    def case(self, number, trials, values=STILL, **facts):
        """Adds a case's folder: trials {label: frames}."""
        folder = os.path.join(self.root, "suite", f"{number:02d}-case", "serial")
        shutil.rmtree(os.path.join(self.root, "suite"), ignore_errors=True)
        os.makedirs(folder)
        for label, frames in trials.items():
            shutil.move(self.dump(frames, values), os.path.join(folder, label))
        facts = {"backend": "serial", "precision": "f32", "trials": list(trials), **facts}
        with open(os.path.join(folder, "facts.json"), "w", encoding="utf-8") as file:
            json.dump(facts, file)
        return os.path.join(self.root, "suite")

    def verdict(self, *arguments, code, **facts):
        report = self.report("stability", self.case(*arguments, **facts), code=code)
        return report["verdicts"][-1]

    def holds(self, *arguments, **facts):
        entry = self.verdict(*arguments, code=0, **facts)
        self.assertEqual(entry["verdict"], "holds", entry)

    def fails(self, figure, *arguments, **facts):
        entry = self.verdict(*arguments, code=1, **facts)
        self.assertEqual(entry["verdict"], "fails", entry)
        failed = [f["name"] for f in entry["figures"] if not f["holds"]]
        self.assertTrue([name for name in failed if figure in name] or figure in entry["reason"], entry)


class Everywhere(StabilityTest):
    block = lattice(4, 4, 4, origin=0.5)

    def test_whole(self):
        self.holds(7, {"dam": {0: self.block, 1: self.block}})

    def test_lost_outside_not_finite(self):
        self.fails("particles lost", 7, {"dam": {0: self.block, 1: self.block[1:]}})
        self.fails("outside", 7, {"dam": {0: self.block, 1: self.block + [2.6, 0, 0]}})
        broken = self.block.copy()
        broken[3, 1] = np.nan
        self.fails("not finite", 7, {"dam": {0: self.block, 1: broken}})

    def test_energy(self):
        self.fails("energy gained", 7, {"dam": {0: self.block, 1: self.block + [0, 0.1, 0]}})

    def test_did_not_run(self):
        self.fails("signal 11", 7, {}, failed="crashed with signal 11")
        for outcome in ("absent", "unavailable"):
            entry = self.verdict(31, {}, code=0, **{outcome: "why"})
            self.assertEqual((entry["verdict"], entry["reason"]), (outcome, "why"))

    def test_no_folder(self):
        for folder in (os.path.join(self.root, "nothing"), self.root):
            self.assertEqual(self.run_check("stability", folder)[0], 3)


class Refusals(StabilityTest):
    good = {"call": "pbf_add_particles", "status": "PBF_ERROR_CAPACITY", "sentence": "capacity is 3",
            "names": "capacity", "unchanged": True}

    def test_refusals(self):
        state = {"state": {0: lattice(2, 2, 2, origin=0.5)}}
        self.holds(26, state, refusals=[self.good])
        for figure, change in (("accepted", {"status": "PBF_OK"}), ("naming", {"sentence": "no"}),
                               ("touched", {"unchanged": False})):
            self.fails(figure, 26, state, refusals=[self.good, {**self.good, **change}])


class Motion(StabilityTest):
    def test_parabola(self):
        start = np.array([[3.0, 50.0, 3.0]])

        def at(n, error=0.0):
            moved = -10 * 0.01**2 * n * (n + 1) / 2
            return start + [0, moved * (1 + error), 0], np.array([[0, -0.1 * n, 0]])

        self.holds(4, {"fall": {0: at(0), 50: at(50)}})
        self.fails("parabola", 4, {"fall": {0: at(0), 50: at(50, 1e-5)}})

    def test_plate(self):
        block = lattice(3, 3, 3, origin=0.5)
        behind = block.copy()
        behind[5, 0] = 4.0
        labels = ("straight", "aslant", "domain", "swept")
        facts = {"plate": 3.5, "swept_speed": 0.0}
        self.holds(16, {k: {0: block, 1: block} for k in labels}, **facts)
        self.fails("escaped", 16, {k: {0: block, 1: behind, 2: block} for k in labels}, **facts)
        self.fails("left behind", 16, {k: {0: block, 1: block} for k in labels}, plate=3.5, swept_speed=-200.0)

    def test_drops(self):
        left, right = lattice(3, 3, 3), lattice(3, 3, 3, origin=0.0) + [8.0, 0.5, 0]
        x = np.concatenate([left, right])
        v = np.repeat([[1.0, 0, 0], [-1.0, 0, 0]], 27, axis=0)
        after = x + 3.5 * v  # they pass through each other: nothing is lost but the sense
        self.holds(29, {"drops": {0: (x, v), 350: (after, v)}}, FREE)
        self.fails("linear", 29, {"drops": {0: (x, v), 350: (after, v + [1e-3, 0, 0])}}, FREE)
        turned = v + 1e-3 * np.cross([0, 0, 1], after - after.mean(axis=0))
        self.fails("angular", 29, {"drops": {0: (x, v), 350: (after, turned)}}, FREE)
        self.fails("closed", 29, {"drops": {0: (x, v), 350: (x, v)}}, FREE)

    def test_bits(self):
        x = lattice(3, 3, 3, origin=0.5)
        other = x.copy()
        other[4, 1] = np.nextafter(other[4, 1], 1)
        self.holds(32, {"whole": {4: x}, "resumed": {4: x}})
        self.fails("differ", 32, {"whole": {4: x}, "resumed": {4: other}})
        self.fails("apart", 32, {"whole": {4: x}, "resumed": {5: x}})
        self.holds(33, {"threads-1": {4: x}, "threads-2": {4: x}})
        self.fails("differ", 33, {"threads-1": {4: x}, "threads-2": {4: other}})


class LongRuns(StabilityTest):
    tank = lattice(6, 6, 6, origin=0.5)

    def case_30(self, last, memory=0):
        steps = range(0, 1001, 50)
        frames = {s: self.tank for s in steps}
        frames[1000] = last
        told = [{"when": f"{label}, {when}", "resident": 2**30 + (memory if when == "the end" else 0)}
                for label in ("rest", "motion") for when in ("a tenth", "the end")]
        return 30, {"rest": frames, "motion": dict.fromkeys(steps, self.tank)}, told

    def test_long_runs(self):
        number, trials, told = self.case_30(self.tank)
        self.holds(number, trials, memory=told)
        number, trials, told = self.case_30(self.tank - [0, 0.02, 0])
        self.fails("drifts", number, trials, memory=told)
        noisy = np.full(self.tank.shape, 0.5)
        number, trials, told = self.case_30((self.tank, noisy))
        self.fails("noise", number, trials, memory=told)
        number, trials, told = self.case_30(self.tank, memory=2**22)
        self.fails("memory", number, trials, memory=told)


class Residuals(StabilityTest):
    def test_many_iterations(self):
        def labels(*squeezed):
            return {f"iterations-{10**k}": {1: s * lattice(5, 5, 5, origin=1.0)} for k, s in enumerate(squeezed)}

        self.holds(12, labels(0.9, 0.95, 1.0), FREE)
        self.fails("rise", 12, labels(0.9, 0.85, 1.0), FREE)
        self.fails("residual of 1,000", 12, labels(0.9, 0.9, 0.9), FREE)
        self.holds(12, labels(1.1, 1.1, 1.1), FREE)
        self.fails("rise", 12, labels(1.1, 0.9, 1.1), FREE)


if __name__ == "__main__":
    unittest.main()
