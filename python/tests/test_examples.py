"""Every example runs, where the repository has them beside the tests."""
import pathlib
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


def run(name, folder, *arguments):
    if not EXAMPLES.exists():
        pytest.skip("the examples are not here")
    found = subprocess.run([sys.executable, str(EXAMPLES / name), *arguments], cwd=folder,
                           capture_output=True, text=True, timeout=300, check=True)
    return found.stdout


@pytest.mark.slow
def test_splash(tmp_path):
    assert "mean height 0.1" in run("splash.py", tmp_path)
    assert (tmp_path / "splash.png").stat().st_size > 50_000
    assert (tmp_path / "splash-moving.png").stat().st_size > 500_000


def test_environment(tmp_path):
    """The same start gives the same episode, and the policy brings the water to the middle."""
    lines = run("environment.py", tmp_path, "2").splitlines()
    ends = [line.split(": ")[1] for line in lines]
    assert ends[0] == ends[1] and abs(float(ends[0].split()[-4])) < 0.1
    assert (tmp_path / "tank.png").exists()


def test_training_data(tmp_path):
    import numpy as np
    run("training_data.py", tmp_path, "data.npz", "2")
    data = np.load(tmp_path / "data.npz")
    assert data["positions0000"].shape == data["velocities0001"].shape == (30, 416, 3)
    assert data["positions0000"][-1, :, 1].mean() < data["positions0000"][0, :, 1].mean() - 0.2
    h5py = pytest.importorskip("h5py")
    run("training_data.py", tmp_path, "data.h5", "2")
    with h5py.File(tmp_path / "data.h5") as file:
        assert (file["run0001/positions"][:] == data["positions0001"]).all()
        assert file["run0000"].attrs["smoothing_radius"] == 0.1


@pytest.mark.slow
def test_export(tmp_path):
    for name in ("meshio", "pxr", "pysplashsurf"):
        pytest.importorskip(name)
    assert "triangles" in run("export.py", tmp_path)
    names = {path.name for path in (tmp_path / "exported").iterdir()}
    assert {"fluid.pvd", "fluid_0014.vtu", "fluid.usdc", "particles.ply", "surface.ply"} <= names
