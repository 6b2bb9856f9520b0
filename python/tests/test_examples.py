"""Every example runs, where the repository has them beside the tests."""
import pathlib
import re
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


def run(name, folder, *arguments):
    if not EXAMPLES.exists():
        pytest.skip("the examples are not here")
    found = subprocess.run([sys.executable, str(EXAMPLES / name), *arguments], cwd=folder,
                           capture_output=True, text=True, timeout=3600, check=True)
    return found.stdout


@pytest.mark.slow
def test_splash(tmp_path):
    assert "mean height 0.1" in run("splash.py", tmp_path)
    assert (tmp_path / "splash.png").stat().st_size > 50_000
    assert (tmp_path / "splash-moving.png").stat().st_size > 500_000


def test_fountain(tmp_path):
    """The sea takes what the fountain adds, to what the overflow lets go: the level stays."""
    lines = run("fountain.py", tmp_path).splitlines()
    levels = [float(line.split()[3].rstrip(",")) for line in lines]
    assert len(levels) == 4 and all(0.27 < level < 0.37 for level in levels)
    came = int(re.search(r"(\d+) came", lines[-1])[1])
    assert 1440 <= came <= 1450  # the opening's 3 · 12 · 0.05² · 2 s / 0.05³ and what the sea gives
    assert int(lines[-1].split()[4]) > 20
    assert (tmp_path / "fountain.png").stat().st_size > 50_000


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


def test_pouring(tmp_path):
    """Episodes have the same end each time, and those that never pour get what a mark of 0.3 … 0.8
    is worth."""
    lines = run("pouring.py", tmp_path, "1", "4").splitlines()
    assert lines[0].startswith("4 worlds of ") and "steps of environments a second" in lines[1]
    assert -0.8 < float(lines[-1].split()[2]) < -0.3
    assert (tmp_path / "pouring.png").exists()


@pytest.mark.slow
def test_pouring_is_learnt(tmp_path):
    words = run("pouring.py", tmp_path, "12", "32").splitlines()[-1].split()
    assert float(words[4]) > float(words[2]) + 0.1


def test_pouring_is_a_vector_environment(monkeypatch):
    import numpy as np
    vector = pytest.importorskip("gymnasium.vector")
    if not EXAMPLES.exists():
        pytest.skip("the examples are not here")
    monkeypatch.syspath_prepend(str(EXAMPLES))
    from pouring import Pouring
    env = Pouring(2)
    assert isinstance(env, vector.VectorEnv)
    seen, _ = env.reset(seed=3)
    assert seen in env.observation_space
    for k in range(Pouring.LENGTH):
        assert not env.ended.any()
        seen, reward, terminated, truncated, _ = env.step(np.full(env.action_space.shape, 0.5))
        assert seen in env.observation_space and not terminated.any()
    assert truncated.all() and (reward < 0).all()
    seen, reward, _, truncated, _ = env.step(np.zeros(env.action_space.shape))
    assert (seen[:, 0] == 0).all() and (reward == 0).all() and not truncated.any()
    env.close()
