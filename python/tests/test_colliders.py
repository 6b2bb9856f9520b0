"""Colliders."""
import copy
import pickle

import numpy as np
import pytest

import pbf


def test_they_come_back_as_they_were_set(dam):
    given = [pbf.Sphere((0.75, 0.5, 0.5), radius=0.1), pbf.Plane((0, 0.01, 0)),
             pbf.Capsule((0.8, 0.5, 0.5), radius=0.05, half_length=0.2, axis=(1, 0, 0)),
             pbf.Box((0.8, 0.8, 0.8), half_extents=(0.1, 0.05, 0.02), velocity=(0.1, 0, 0))]
    for collider in given:
        collider.path = pbf.MotionPath.STRAIGHT  # what AUTO becomes
    dam.colliders = given
    assert dam.colliders == given
    dam.colliders = []
    assert dam.colliders == []
    dam.colliders = given[0]
    assert dam.colliders == given[:1]


def test_loads(make):
    fluid = make(pbf.fill_box((0, 0, 0), (0.5, 0.3, 0.5), 0.05), domain_max=(0.5, 1, 0.5), loads=1)
    fluid.colliders = [pbf.Sphere((0.25, 0.8, 0.25), radius=0.05)]
    fluid.step(120)
    fluid.wall_loads()
    fluid.step(60)
    (ball,), walls = fluid.collider_loads(), fluid.wall_loads()
    weight = 600 * 0.05 ** 3 * 9.81
    assert walls[2].impulse_sum[1] / walls[2].time_sum == pytest.approx(-weight, rel=0.01)
    assert walls[2].contacts > 0 and ball.contacts == 0 and ball.impulse_sum == (0, 0, 0)


def test_a_ball_keeps_fluid_out(make):
    fluid = make(pbf.fill_box((0, 0.3, 0), (1, 0.6, 1), 0.05))
    fluid.colliders = pbf.Sphere((0.5, 0.0, 0.5), radius=0.3)
    fluid.step(120)
    distance = np.linalg.norm(fluid.positions - [0.5, 0, 0.5], axis=1)
    assert distance.min() > 0.3
    assert fluid.positions[:, 1].min() < 0.1  # it has fallen beside the ball


def test_move(dam):
    dam.colliders = pbf.Sphere((0.8, 0.5, 0.5), radius=0.1)
    dam.move_colliders(pbf.Sphere((0.8, 0.7, 0.5), radius=0.15), duration=0.1)
    dam.step(6)
    assert dam.colliders[0].position == pytest.approx((0.8, 0.6, 0.5))
    dam.step(6)
    assert dam.colliders[0].position == pytest.approx((0.8, 0.7, 0.5))
    assert dam.colliders[0].radius == pytest.approx(0.15)
    dam.step(6)
    assert dam.colliders[0].position == pytest.approx((0.8, 0.7, 0.5))


def test_two_dimensions(make):
    fluid = make(pbf.fill_box((0, 0), (0.5, 0.5), 0.05))
    fluid.colliders = [pbf.Box((0.8, 0.2), half_extents=(0.1, 0.2)), pbf.Sphere((0.8, 0.8), radius=0.1)]
    fluid.step(10)
    assert fluid.colliders[0].half_extents[:2] == (0.1, 0.2)


@pytest.mark.parametrize("collider, words", [
    (pbf.Sphere((0, 0, 0), radius=-1), "radius"), (pbf.Sphere((0, 0, np.nan)), "position"),
    (pbf.Box((0, 0, 0), half_extents=3), "half_extents"), ("ball", "must be a Plane"),
    (pbf.Plane(axis=(0, 0, 0)), "axis"), (pbf.Sphere(orientation=(0, 0, 1)), "orientation")])
def test_bad_ones(dam, collider, words):
    with pytest.raises(pbf.InvalidArgumentError, match=words):
        dam.colliders = [collider]
    assert dam.colliders == []


def test_too_many(dam):
    with pytest.raises(pbf.Error, match="4096"):
        dam.colliders = [pbf.Sphere((2, 2, 2), radius=0.1)] * 4097


def test_moving_others(dam):
    dam.colliders = pbf.Sphere((0.8, 0.8, 0.8), radius=0.1)
    for targets in ([], pbf.Plane()):
        with pytest.raises(pbf.InvalidArgumentError):
            dam.move_colliders(targets, 1.0)
    with pytest.raises(pbf.InvalidArgumentError, match="duration"):
        dam.move_colliders(dam.colliders, 0)


def _box_mesh(half):
    points = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * half
    quads = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))
    faces = [corners for a, b, c, d in quads for corners in ((a, b, c), (a, c, d))]
    return points, np.array(faces)


def test_geometries_of_all_kinds():
    points, faces = _box_mesh(0.2)
    box = pbf.Geometry.from_mesh(points, faces, cell=0.02)
    hull = pbf.Geometry.from_points(points, cell=0.02)
    terrain = pbf.Geometry.from_heights(np.full((3, 3), 0.4), spacing=0.2, base=0, cell=0.02)
    axes = np.meshgrid(*[np.arange(-0.3, 0.31, 0.02)] * 3, indexing="ij")
    ball = pbf.Geometry.from_grid(np.sqrt(sum(a * a for a in axes)) - 0.2, (-0.3, -0.3, -0.3), 0.02)
    for made in (box, hull, ball):
        assert made.distance((0.25, 0, 0)) == pytest.approx(0.05, abs=1e-3)
        assert made.dimension == 3
    assert terrain.distance((0.2, 0.45, 0.2)) == pytest.approx(0.05, abs=1e-3)
    assert box.volume == pytest.approx(0.064, rel=0.02)
    with pytest.raises(pbf.InvalidArgumentError, match="open"):
        pbf.Geometry.from_mesh(points, faces[1:], cell=0.02)
    shell = pbf.Geometry.from_mesh(points, faces[1:], cell=0.02, thickness=0.04)
    assert shell.distance((0, 0, 0.2)) < 0 < shell.distance((0, 0, 0))


def test_a_solid_keeps_its_geometry():
    box = pbf.Geometry.from_mesh(*_box_mesh(0.2), cell=0.02)
    fluid = pbf.Solver(capacity=10)
    fluid.colliders = [pbf.Solid((0.5, 0.5, 0.5), geometry=box, scale=0.5)]
    distance = box.distance((0, 0, 0))
    del box
    back, = fluid.colliders
    assert back.geometry.distance((0, 0, 0)) == distance and back.scale == 0.5
    with pytest.raises(pbf.InvalidArgumentError, match="geometry is null"):
        fluid.colliders = [pbf.Solid()]


def test_a_geometry_comes_back_from_a_file(tmp_path):
    box = pbf.Geometry.from_mesh(*_box_mesh(0.2), cell=0.02)
    saved = box.save(tmp_path / "box.pbfshape")
    assert (tmp_path / "box.pbfshape").read_bytes() == saved
    for again in (pbf.Geometry.load(tmp_path / "box.pbfshape"), pbf.Geometry.load(saved)):
        assert again.distance((0.1, 0.23, 0)) == box.distance((0.1, 0.23, 0))
        assert again.cell == 0.02 and again.bounds == box.bounds
    values = box.values
    middle = tuple(round(-at / box.cell) for at in box.origin)
    assert values[middle] == pytest.approx(-0.2, abs=box.cell)
    assert pbf.Geometry.from_grid(values, box.origin, box.cell).save() == saved
    with pytest.raises(pbf.DataError, match="cut short"):
        pbf.Geometry.load(b"PBFSHAPE")
    with pytest.raises(pbf.DataError, match="another hash"):
        pbf.Geometry.load(saved[:64] + bytes(8) + saved[72:])


def test_lists_that_are_read_are_copies():
    """What would change a copy alone is an error, not nothing."""
    fluid = pbf.Solver(capacity=10)
    ball = pbf.Sphere((0.5, 0.5, 0.5), radius=0.1)
    fluid.colliders = ball
    for change in (lambda: fluid.colliders.append(ball), lambda: fluid.colliders.pop(),
                   lambda: fluid.colliders.__setitem__(0, ball), lambda: fluid.drains.extend([])):
        with pytest.raises(TypeError, match=r"fluid\.colliders, ball"):
            change()
    fluid.colliders += [ball]
    assert len(fluid.colliders) == 2
    mine = list(fluid.colliders)
    mine.append(ball)
    fluid.colliders = mine
    assert len(copy.deepcopy(fluid.colliders)) == len(pickle.loads(pickle.dumps(fluid.colliders))) == 3
    assert fluid.emitters == fluid.drains == fluid.reservoirs == fluid.phases == []


def test_a_single_phase_may_stand_alone():
    fluid = pbf.Solver(capacity=10)
    fluid.phases = pbf.Phase(rest_density=0.5)
    assert fluid.phases == [pbf.Phase(rest_density=0.5)]


def test_snapshots_that_are_not_kept_say_how():
    fluid = pbf.Solver(capacity=10)
    with pytest.raises(pbf.StateError, match=r"keep_snapshots\(3\)"):
        fluid.snapshot()
    assert fluid.sample_on_grid((2, 2, 2), (0, 0, 0), 0.5).densities.shape == (2, 2, 2)


def test_a_solid_is_filled_with_particles():
    box = pbf.Geometry.from_mesh(*_box_mesh(0.2), cell=0.02)
    points = pbf.fill_geometry(box, 0.05, position=(1, 0, 0))
    assert 8**3 - 8 <= len(points) <= 8**3  # of a lattice that fits; corners are rounded off
    assert np.allclose(points.min(axis=0), (0.825, -0.175, -0.175), atol=1e-6)
    cell = 0.02
    axes = np.meshgrid(*[np.arange(-0.4, 0.41, cell)] * 3, indexing="ij")
    ball = pbf.Geometry.from_grid(np.sqrt(sum(a * a for a in axes)) - 0.3, (-0.4,) * 3, cell)
    points = pbf.fill_geometry(ball, 0.02)
    assert len(points) * 0.02**3 == pytest.approx(4 / 3 * np.pi * 0.295**3, rel=0.01)
    with pytest.raises(pbf.InvalidArgumentError, match="must be a Geometry"):
        pbf.fill_geometry(3, 0.05)
