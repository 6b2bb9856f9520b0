"""What a type checker says of the package, and of programs that use it."""
import os
import pathlib
import subprocess
import sys

import pytest

import pbf

GOOD = """
import numpy as np
import pbf
fluid = pbf.Solver([[0.5, 0.5, 0.5]], viscosity=0.1, kernel="wendland_c2", collide=["after_solve"])
fluid.gravity = (0, -1, 0)
fluid.set(iterations=3)
speed: float = fluid.stats.speed_max
x: np.ndarray = fluid.positions
with fluid.view("position") as view:
    first: float = float(view.array[0, 0])
kind: pbf.Method = fluid.solver
other: pbf.Solver = fluid.copy()
"""
BAD = ['fluid.viscosity = "thick"', "fluid.set(iterations=[3])", "pbf.Solver(viscocity=1.0)",
       "fluid.colliders = 3", 'fluid.step("one")', "fluid.stats.speed_max = 3.0"]


@pytest.mark.slow
def test_programs_are_checked(tmp_path):
    pytest.importorskip("mypy")
    good, bad = tmp_path / "good.py", tmp_path / "bad.py"
    good.write_text(GOOD)
    bad.write_text("\n".join(["import pbf", "fluid = pbf.Solver()", *BAD]))
    environment = {**os.environ, "MYPYPATH": str(pathlib.Path(pbf.__file__).parents[1])}
    if "site-packages" in pbf.__file__:
        del environment["MYPYPATH"]
    found = [subprocess.run([sys.executable, "-m", "mypy", str(file)], capture_output=True,
                            text=True, env=environment, cwd=tmp_path) for file in (good, bad)]
    assert found[0].returncode == 0, found[0].stdout
    lines = {int(line.split(":")[1]) for line in found[1].stdout.splitlines() if ": error:" in line}
    assert lines == set(range(3, 3 + len(BAD))), found[1].stdout
