"""Dumps with known answers, written into a temporary folder."""
import contextlib
import io
import json
import os
import shutil
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

from pbfcheck import cli  # noqa: E402  (the package lies beside this folder)


def lattice(*counts, spacing=1.0, origin=0.0):
    """Points of a lattice, the first at `origin`."""
    axes = [spacing * np.arange(float(n)) for n in counts]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(counts)) + origin


def manifest(dim, **changes):
    values = {"dimension": dim, "smoothing_radius": 2.0, "spacing": 1.0, "particle_volume": 0,
              "kernel": "wendland_c2", "gravity": [0.0] * dim, "domain_min": [-1000.0] * dim,
              "domain_max": [1000.0] * dim, "time_step": 0.01, "walls": False}
    values.update(changes)
    return values


class DumpTest(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp(prefix="pbf-check-")
        self.addCleanup(shutil.rmtree, self.root)

    def dump(self, frames, values, dtype=np.float64):
        """A new folder. frames: {step: positions or (positions, velocities)}"""
        folder = tempfile.mkdtemp(dir=self.root)
        with open(os.path.join(folder, "dump.json"), "w", encoding="utf-8") as file:
            json.dump(values, file)
        for step, frame in frames.items():
            x, v = frame if isinstance(frame, tuple) else (frame, np.zeros_like(frame))
            np.save(os.path.join(folder, f"positions_{step:06d}.npy"), x.astype(dtype))
            np.save(os.path.join(folder, f"velocities_{step:06d}.npy"), v.astype(dtype))
        return folder

    def run_check(self, *arguments):
        """(exit code, standard output, standard error)"""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                code = cli.main([str(a) for a in arguments])
            except SystemExit as stop:
                code = stop.code
        return code, out.getvalue(), err.getvalue()

    def report(self, *arguments, code=0):
        got, out, err = self.run_check(*arguments, "--json", "-")
        self.assertEqual(got, code, err + out[-2000:])
        return json.loads(out)

    def errors(self, folder, key, *arguments):
        entry = self.report("errors", folder, "--only", key, *arguments)["errors"][key]
        self.assertNotIn("reason", entry, entry.get("reason"))
        return entry

    def validation(self, name, folder, *arguments, code=0):
        entry = self.report("validate", name, folder, *arguments, code=code)["validations"][name]
        self.assertNotIn("reason", entry, entry.get("reason"))
        return entry
