"""Many worlds in one call."""
import gc

import numpy as np
import pytest

import pbf
from conftest import BACKEND

WORLDS = 4
BLOCK = pbf.fill_box((0.2, 0), (0.5, 0.3), 0.05)
KIND = {"spacing": 0.05, "smoothing_radius": 0.15, "backend": BACKEND}


@pytest.fixture
def batch():
    with pbf.Batch(WORLDS, BLOCK, threads=2, **KIND) as made:
        yield made


def alone(steps, change=lambda fluid: None):
    with pbf.Solver(BLOCK, **KIND) as fluid:
        change(fluid)
        fluid.step(steps)
        return fluid.hash


def test_worlds_are_as_alone(batch):
    for k, world in enumerate(batch):
        world.gravity = (k, -9.81)
    batch.step(5)
    batch.step(3)
    for k, world in enumerate(batch):
        assert world.hash == alone(8, lambda fluid, k=k: fluid.set(gravity=(k, -9.81)))
    assert len(batch) == WORLDS and batch.times.tolist() == pytest.approx([8 / 120] * WORLDS)
    assert batch[-1] is batch[WORLDS - 1]
    with pytest.raises(IndexError, match="world is 4; the batch has 4 worlds"):
        batch[4]


def test_gravity_and_masks(batch):
    gravity = np.zeros((WORLDS, 3))
    gravity[:, 0] = np.arange(WORLDS)
    batch.set_gravity(gravity)
    batch.set_gravity([9, 9], mask=[False, True, False, False])
    assert [world.gravity[:2] for world in batch] == [(0, 0), (9, 9), (2, 0), (3, 0)]
    batch.set(viscosity=0.01, mask=np.arange(WORLDS) > 1)
    assert [world.viscosity for world in batch] == [0, 0, 0.01, 0.01]
    with pytest.raises(pbf.InvalidArgumentError, match="world 2: params.gravity"):
        batch.set_gravity(np.where(np.arange(WORLDS)[:, None] == 2, np.nan, np.zeros((WORLDS, 3))))
    assert list(batch.failures) == [2] and "NaN" in batch.failures[2]
    with pytest.raises(pbf.InvalidArgumentError, match=r"mask has the shape \(2,\)"):
        batch.step(1, mask=[True, False])
    with pytest.raises(pbf.InvalidArgumentError, match="gravity has the shape"):
        batch.set_gravity(np.zeros((WORLDS + 1, 3)))


def test_reset(batch):
    batch.step(3)
    batch.set_start()
    start = [world.hash for world in batch]
    batch.step(4)
    later = [world.hash for world in batch]
    batch.reset(mask=[True, False, False, True])
    assert [world.hash for world in batch] == [start[0], later[1], later[2], start[3]]
    with pbf.Solver(BLOCK, **KIND) as fluid:
        fluid.step(9)
        batch.set_start(fluid.save(), mask=[False, False, True, False])
        batch.reset()
        assert batch[2].hash == fluid.hash and batch[1].hash == start[1]


def test_targets(batch):
    """Each ball is where it was sent, when it was to be there."""
    batch.set_colliders(pbf.Sphere(position=(0.7, 0.5), radius=0.1))
    targets = np.zeros((WORLDS, 1, 2))
    targets[:, 0] = [[0.7 - 0.05 * k, 0.3] for k in range(WORLDS)]
    batch.move_colliders(targets, duration=6 / 120)
    batch.step(6)
    for k, world in enumerate(batch):
        assert world.colliders[0].position[:2] == pytest.approx(targets[k, 0])
    turn = np.array([0, 0, np.sin(0.1), np.cos(0.1)])
    batch.move_colliders(targets, turn[None], duration=6 / 120)
    batch.step(6)
    assert batch[3].colliders[0].orientation == pytest.approx(turn)
    with pytest.raises(pbf.InvalidArgumentError, match="world 0: count is 2"):
        batch.move_colliders(np.zeros((2, 3)), duration=1)


def test_emitters():
    with pbf.Batch(WORLDS, capacity=9, dimension=2, **KIND) as batch:
        drops = np.full((WORLDS, 1, 2), 0.5)
        drops[:, 0, 0] = 0.2 * np.arange(1, WORLDS + 1)
        batch.add(drops, velocities=[[0, -1]], mask=[1, 1, 0, 1])
        batch.add([[0.5, 0.1]], mask=[1, 0, 0, 0])
        assert batch.counts.tolist() == [2, 1, 0, 1]
        seen = batch.positions
        assert seen.shape == (WORLDS, 2, 2)
        assert seen[3, 0] == pytest.approx([0.8, 0.5]) and (seen[2] == 0).all()
        assert (batch.velocities[1, 0] == [0, -1]).all()
        with pytest.raises(pbf.CapacityError, match="world 0: count is 8"):
            batch.add(np.random.default_rng(1).uniform(0.2, 0.8, (8, 2)))
        assert batch.counts.tolist() == [2, 9, 8, 9]  # the others have got theirs


def test_reading(batch):
    batch.step(2)
    for field in ("position", "velocity", "density", "id"):
        found = batch.read(field)
        for k, world in enumerate(batch):
            assert (found[k] == world.read(field)).all()
    wide = np.full((WORLDS, 40, 4), -1.0, np.float64)
    batch.read("position", wide[:, :len(BLOCK)], components=4, w="speed", mask=[0, 1, 1, 1])
    assert (wide[0] == -1).all() and (wide[:, len(BLOCK):] == -1).all()
    assert wide[2, 3, :2] == pytest.approx(batch[2].positions[3], abs=1e-6)
    assert wide[2, 3, 3] == pytest.approx(np.linalg.norm(batch[2].velocities[3]), abs=1e-6)
    assert batch.read("position", first=30, rows=9).shape == (WORLDS, 9, 2)
    assert (batch.read("position", first=30, rows=9)[:, len(BLOCK) - 30:] == 0).all()
    with pytest.raises(pbf.InvalidArgumentError, match="out has the shape"):
        batch.read("position", np.zeros((3, 5, 2), np.float32))
    one_world = np.lib.stride_tricks.as_strided(np.zeros((5, 2), np.float32), (WORLDS, 5, 2), (0, 8, 4))
    with pytest.raises(pbf.InvalidArgumentError, match="one after another"):
        batch.read("position", one_world)
    with pytest.raises(pbf.InvalidArgumentError, match="this machine's order"):
        batch.read("position", dtype=np.dtype(np.float32).newbyteorder())


def test_tensors(batch):
    expected = batch.positions
    taken = np.from_dlpack(batch.tensor("position"))
    tensor = batch.tensor("id", rows=3)
    shown = tensor.array
    again = np.from_dlpack(tensor)
    batch.step(3)
    batch.close()
    del tensor
    gc.collect()
    assert (taken == expected).all() and taken.shape == (WORLDS, len(BLOCK), 2)
    assert shown[1, :, 0].tolist() == again[1, :, 0].tolist() == [0, 1, 2]
    with pytest.raises(pbf.StateError, match="closed"):
        batch.step()


def test_worlds_end_with_the_batch():
    batch = pbf.Batch(2, BLOCK, **KIND)
    world = batch[1]
    del batch
    gc.collect()
    world.step()  # which has kept it
    with pytest.raises(pbf.StateError, match="world of a batch"):
        world.reserve(1000)
    other = world.copy()
    world._batch.close()
    assert world.closed and not other.closed
    with pytest.raises(pbf.StateError, match="closed"):
        world.step()
    other.step()
    other.close()


def test_failures(batch):
    """Walls that meet stop one world alone."""
    batch[2].wall_velocity = (0, -60, 0, 0)
    with pytest.raises(pbf.StateError, match="world 2: .*no room"):
        batch.step(5)
    assert list(batch.failures) == [2]
    assert [world.steps_done for world in batch] == [5, 5, 1, 5]
    batch.step(1, mask=[1, 1, 0, 1])
    assert batch.failures == {}


def test_arguments():
    with pytest.raises(pbf.InvalidArgumentError, match="neither positions nor a capacity"):
        pbf.Batch(3)
    with pytest.raises(pbf.InvalidArgumentError, match="worlds is 0"):
        pbf.Batch(0, BLOCK, **KIND)
    with pytest.raises(TypeError, match="viscosty"):
        pbf.Batch(1, BLOCK, viscosty=1)
    with pytest.raises(pbf.InvalidArgumentError, match="positions has the shape"):
        pbf.Batch(3, np.zeros((2, 4, 2)), **KIND)
