"""Questions by place, at a block of 0.5 m in the corner of the box, at rest."""
import numpy as np
import pytest

import pbf


def test_volumes(dam):
    ball = pbf.BallVolume((0.25, 0.5, 0.25), radius=0.2)
    flow = dam.measure(ball)
    assert flow.fraction == pytest.approx(0.5, abs=0.02)
    assert flow.volume == pytest.approx(4 / 3 * np.pi * 0.2**3)
    assert flow.centre[1] == pytest.approx(0.5 - 3 / 8 * 0.2, abs=0.005)
    assert flow.velocity == (0, 0, 0)
    box = pbf.BoxVolume((0.2, 0.2, 0.2), half_extents=(0.1, 0.1, 0.1))
    assert [each.fraction for each in dam.measure([box, ball])] == [1, flow.fraction]
    assert dam.measure([]) == []
    x = dam.positions
    near = np.linalg.norm(x - np.float32([0.25, 0.5, 0.25]), axis=1) <= 0.2
    assert dam.find_in(ball).tolist() == np.flatnonzero(near).tolist()
    assert len(dam.find_in(pbf.CapsuleVolume((2, 2, 2), radius=0.1, half_length=0.2))) == 0
    with pytest.raises(pbf.InvalidArgumentError, match="radius is -1"):
        dam.measure(pbf.BallVolume(radius=-1))
    with pytest.raises(pbf.InvalidArgumentError, match="BoxVolume"):
        dam.measure(pbf.Box())


def test_points(dam, rng):
    points = rng.uniform(0.15, 0.35, size=(4, 5, 3))
    dam.velocities = dam.positions * np.float32([1, -2, 0.5])
    found = dam.sample(points, ("density", "velocity", "wet", "pressure"))
    assert found.densities.shape == (4, 5) and found.densities == pytest.approx(1, abs=0.01)
    assert found.velocities == pytest.approx(points * [1, -2, 0.5], abs=1e-4)
    assert found.wet.all() and (found.pressures == 0).all()
    only = dam.sample((0.25, 0.9, 0.25), "wet")
    assert only.densities is None and only.wet.shape == () and not only.wet
    with pytest.raises(pbf.InvalidArgumentError, match="points of 3 numbers"):
        dam.sample([[0.5, 0.5]])
    with pytest.raises(pbf.InvalidArgumentError, match="speed"):
        dam.sample(points, ["speed"])
    with pytest.raises(pbf.InvalidArgumentError, match="fields has array"):
        dam.sample(points, [np.zeros(2)])


def test_grids(dam):
    found = dam.sample_on_grid((2, 3, 4), (0.1, 0.1, 0.1), (0.05, 0.1, 0.15))
    x = np.stack(np.meshgrid(0.1 + 0.05 * np.arange(2), 0.1 + 0.1 * np.arange(3),
                             0.1 + 0.15 * np.arange(4), indexing="ij"), axis=-1)
    assert found.densities == pytest.approx(dam.sample(x).densities, abs=1e-12)
    with pytest.raises(pbf.InvalidArgumentError, match="counts"):
        dam.sample_on_grid((2, 3), (0, 0, 0), (1, 1, 1))


def test_surfaces(dam):
    hits = dam.cast_rays([[0.25, 0.9, 0.25], [0.25, 0.9, 0.9]], (0, -1, 0))
    assert hits.distances[0] == pytest.approx(0.4, abs=0.0125) and np.isinf(hits.distances[1])
    assert hits.normals[0] == pytest.approx((0, 1, 0), abs=0.02)
    levels = dam.levels([[0.25, 7, 0.25], [0.9, 0, 0.9]])
    assert levels[0] == pytest.approx(0.5, abs=0.0125) and np.isnan(levels[1])
    with pytest.raises(pbf.InvalidArgumentError, match="must fit each other"):
        dam.cast_rays(np.zeros((2, 3)), np.ones((4, 3)))
    dam.end_queries()
    assert dam.levels((0.25, 0, 0.25)) == pytest.approx(levels[0])
