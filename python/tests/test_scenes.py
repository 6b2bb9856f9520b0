"""Scene files. The numbers of particles and of steps are what `pbf-bench list` prints."""
import json
import pathlib

import numpy as np
import pytest

import pbf
from conftest import BACKEND


@pytest.mark.parametrize("name, count", [
    ("cube-collapse", 29791), ("report-30k", 30000), ("dam-break-3d", 32 * 32 * 30),
    ("moving-paddle", 68 * 12 * 20)])
def test_counts(name, count):
    positions, velocities = pbf.load_scene(name).particles()
    assert positions.shape == velocities.shape and len(positions) == count


@pytest.mark.parametrize("name", pbf.scenes())
def test_every_scene_runs(name):
    scene = pbf.load_scene(name)
    assert scene.name == pathlib.Path(name).name and scene.description and scene.steps > 0
    fluid = scene.solver(backend=BACKEND)
    fluid.step()
    assert fluid.count == len(scene.particles()[0]) and fluid.steps_done == 1
    assert fluid.time_step == scene.params["time_step"]
    fluid.close()


def test_keywords_win():
    fluid = pbf.load_scene("dam-break-2d").solver(viscosity=0.5, capacity=9000, backend=BACKEND)
    assert fluid.viscosity == 0.5 and fluid.capacity == 9000
    fluid.close()


def test_colliders_move_by_their_stretches():
    """The paddle: 0.25 s at 0.4, 0.5 s at 0.8, 0.25 s at 0.4, and back."""
    scene = pbf.load_scene("moving-paddle")
    scene.blocks = [{"shape": "lattice", "first": [3, 0.5, 0.5], "counts": [1, 1, 1]}]
    fluid = scene.solver(backend=BACKEND)
    expected = {0: 0.45, 30: 0.55, 60: 0.75, 90: 0.95, 120: 1.05, 150: 0.95, 240: 0.45, 270: 0.55}
    for step, x in expected.items():
        fluid.step(step - fluid.steps_done)
        assert fluid.colliders[0].position[0] == pytest.approx(x, abs=1e-9), step
    with fluid.stepping(30):
        pass
    fluid.step(30)
    assert fluid.colliders[0].position[0] == pytest.approx(0.95, abs=1e-9)
    with pytest.raises(pbf.InvalidArgumentError, match="after 30"):
        fluid.begin_step(31)
    other = pbf.Solver.__new__(type(fluid))
    other.__setstate__(fluid.__getstate__())
    other.step(30)
    fluid.step(30)
    assert other.hash == fluid.hash
    fluid.close()


def test_blocks_that_turn(tmp_path):
    scene = {"version": 1, "description": "d", "purpose": "p", "dimension": 2, "steps": 1,
             "params": {"smoothing_radius": 0.1, "spacing": 0.05, "time_step": 0.01,
                        "domain_min": [-2, -2], "domain_max": [2, 2]},
             "blocks": [{"shape": "ball", "center": [0.5, 0], "radius": 0.5, "velocity": [0, 3],
                         "angular_velocity": [0, 0, 2],
                         "within": [{"slopes": [1, 0], "below": 0.5}]}]}
    path = tmp_path / "turning.json"
    path.write_text(json.dumps(scene))
    loaded = pbf.load_scene(path)
    x, v = loaded.particles()
    assert x[:, 0].max() < 0.5 and len(x) == pytest.approx(np.pi * 100 / 2, rel=0.05)
    assert v == pytest.approx(np.stack([-2 * x[:, 1], 3 + 2 * (x[:, 0] - 0.5)], axis=1))
    del scene["blocks"][0]["angular_velocity"]
    scene["blocks"][0]["velocity_gradient"] = [[0, 1], [0, 0]]
    x, v = pbf.load_scene(scene).particles()
    assert v == pytest.approx(np.stack([x[:, 1], np.full(len(x), 3.0)], axis=1))


def test_refined():
    scene = pbf.load_scene("dam-break-3d").refined(0.5)
    assert len(scene.particles()[0]) == 16 * 16 * 15
    assert scene.steps == 150 and scene.params["time_step"] == pytest.approx(1 / 60)
    with scene.solver(backend=BACKEND) as fluid:
        assert fluid.smoothing_radius == 0.2


def change(path, value):
    def apply(scene):
        at = scene
        for key in path[:-1]:
            at = at[key]
        if value is None:
            del at[path[-1]]
        else:
            at[path[-1]] = value
    return apply


@pytest.mark.parametrize("changed, words", [
    (change(["steps"], None), '"steps"'), (change(["stepps"], 3), 'did you mean "steps"'),
    (change(["dimension"], 4), '"dimension"'), (change(["params", "viscocity"], 1), "viscosity"),
    (change(["params", "gravity"], [1, 2]), "gravity"), (change(["blocks", 0, "min"], None), '"min"'),
    (change(["blocks", 0, "shape"], "cone"), "cone"), (change(["blocks"], 3), '"blocks"'),
    (change(["blocks", 0, "max"], [1, "x", 1]), '"max"'),
    (change(["colliders"], [{"shape": "torus", "position": [0, 0, 0]}]), "capsule"),
    (change(["colliders"], [{"shape": "sphere", "position": [0, 0, 0], "radus": 1}]), "radius"),
    (change(["version"], 2), '"version"')])
def test_bad_files_say_what_is_wrong(changed, words, tmp_path):
    scene = json.loads((pathlib.Path(pbf.__file__).parent / "scenes/dam-break-3d.json").read_text())
    changed(scene)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(scene))
    with pytest.raises(pbf.DataError, match=words) as caught:
        pbf.load_scene(path)
    assert "bad.json" in str(caught.value)


def test_files_that_are_none(tmp_path):
    (tmp_path / "bad.json").write_text('{"version": 1,\n oops')
    with pytest.raises(pbf.DataError, match="line 2"):
        pbf.load_scene(tmp_path / "bad.json")
    with pytest.raises(pbf.InvalidArgumentError, match='did you mean "dam-break-3d"'):
        pbf.load_scene("dam-brake-3d")
    with pytest.raises(FileNotFoundError):
        pbf.load_scene("nowhere.json")
