"""Particles that are added, removed, read and set."""
import re

import numpy as np
import pytest

import pbf


def test_add_gives_ids_and_remove_takes_them(make):
    fluid = make(capacity=10)
    assert fluid.add([[0.1, 0.1, 0.1], [0.2, 0.2, 0.2]]) == range(0, 2)
    assert fluid.add((0.3, 0.3, 0.3), velocities=(1, 2, 3)) == range(2, 3)
    assert len(fluid) == fluid.count == 3
    fluid.remove([1])
    assert fluid.ids.tolist() == [0, 2]
    assert fluid.velocities.tolist() == [[0, 0, 0], [1, 2, 3]]
    assert fluid.add([[0.4, 0.4, 0.4]]) == range(3, 4)
    with pytest.raises(pbf.NotFoundError, match="1"):
        fluid.remove([1])
    assert fluid.count == 3
    assert bool(make()) and len(make()) == 0


def test_boxes(dam):
    low = dam.find_in_box(upper=(None, 0.1, None))
    x = dam.positions
    assert low.tolist() == np.flatnonzero(x[:, 1] <= 0.1).tolist() and len(low) == 200
    assert dam.remove_in_box(lower=(0.25, 0, 0), upper=(1, 1, 1)) == 500
    assert dam.count == 500
    assert dam.remove_in_box(lower=(0.9, 0.9, 0.9)) == 0
    assert len(dam.find_in_box(lower=(0.9, 0.9, 0.9))) == 0
    with pytest.raises(pbf.InvalidArgumentError, match="list of 3"):
        dam.remove_in_box((0, 0))


def test_velocities_for_all_or_each(make):
    x = pbf.fill_box((0, 0, 0), (0.2, 0.2, 0.2), 0.05)
    fluid = make(x, (0, 0, 1))
    assert (fluid.velocities == [0, 0, 1]).all()
    other = make(x, np.arange(3 * len(x)).reshape(-1, 3))
    assert other.velocities[5].tolist() == [15, 16, 17]
    with pytest.raises(pbf.InvalidArgumentError, match="64 positions and 2 velocities"):
        make(x, np.zeros((2, 3)))


def test_setting(dam, rng):
    v = rng.normal(size=(1000, 3)).astype(np.float32)
    dam.velocities = v
    assert (dam.velocities == v).all()
    dam.set_velocities([[7, 8, 9]], first=5)
    assert dam.velocities[5].tolist() == [7, 8, 9] and (dam.velocities[6] == v[6]).all()
    dam.positions = dam.positions + np.float32(0.125)
    assert dam.positions.min() == pytest.approx(0.15)
    with pytest.raises(pbf.InvalidArgumentError, match="3 rows for 1000 particles"):
        dam.positions = np.zeros((3, 3))
    with pytest.raises(pbf.Error):
        dam.set_positions(np.zeros((2, 3)), first=999)


def test_accelerations(make):
    fluid = make([[0.2, 0.5, 0.5], [0.5, 0.5, 0.5], [0.8, 0.5, 0.5]], gravity=(0, 0, 0),
                 time_step=0.01)
    fluid.set_accelerations([[0, 2, 0], [1, 0, 0]], first=1)
    fluid.step(10)
    right = [[0, 0, 0], [0, 0.2, 0], [0.1, 0, 0]]
    assert np.allclose(fluid.velocities, right, atol=1e-6)
    saved = fluid.save()
    fluid.set_accelerations(None)
    fluid.step(1)
    assert np.allclose(fluid.velocities, right, atol=1e-6)
    fluid.load(saved)
    fluid.step(10)
    assert np.allclose(fluid.velocities, 2 * np.array(right), atol=1e-6)


@pytest.mark.parametrize("positions, words", [
    ([[0.5, 0.5]], "shape"), ([[0.5, 0.5, np.nan]], "NaN"), ([[5, 0.5, 0.5]], "domain"),
    ("water", "real numbers|shape"), ([[1j, 0, 0]], "real numbers"), (np.zeros((2, 2, 3)), "shape"),
    ([[0, 0, 0], [1, 2]], "array"), (np.ma.masked_less([[0.5, 0.5, 0.1]], 0.2), "masked")])
def test_bad_positions(make, positions, words):
    fluid = make(capacity=10)
    with pytest.raises(pbf.InvalidArgumentError, match=words):
        fluid.add(positions)
    assert fluid.count == 0


def test_capacity(make):
    fluid = make([[0.1, 0.1, 0.1]], viscosity=0.01)
    with pytest.raises(pbf.CapacityError, match="reserve") as caught:
        fluid.add([[0.2, 0.2, 0.2]])
    assert caught.value.name == "PBF_ERROR_CAPACITY" and fluid.count == 1
    fluid.step(3)
    before = fluid.hash
    fluid.keep_snapshots(3)
    fluid.reserve(5)
    assert (fluid.hash, fluid.capacity, fluid.viscosity) == (before, 5, 0.01)
    assert fluid.add([[0.2, 0.2, 0.2]]) == range(1, 2)
    fluid.step()
    assert fluid.snapshot().count == 2
    with pytest.raises(pbf.CapacityError):
        fluid.reserve(1)
    assert fluid.count == 2


def test_read_into_a_layout(dam, rng):
    dam.step(3)
    dam.velocities = rng.normal(size=(1000, 3))
    x, v = dam.positions, dam.velocities
    vertices = np.zeros(1000, [("position", "f4", 4), ("colour", "u1", 4)])
    vertices["colour"] = 255
    out = vertices["position"]
    assert dam.read("position", out, w="speed") is out
    assert (vertices["position"][:, :3] == x).all()
    assert vertices["position"][:, 3] == pytest.approx(np.linalg.norm(v, axis=1), rel=1e-6)
    assert (vertices["colour"] == 255).all()
    assert (dam.read("position", w=1)[:, 3] == 1).all()
    assert (dam.read("position", first=10, count=5) == x[10:15]).all()
    assert dam.read("position", dtype="float64").dtype == np.float64
    stored, ids = dam.read("position", order="stored"), dam.read("id", order="stored")
    assert (stored == x[ids]).all()
    column = np.empty(2000, np.float32)
    dam.read("density", column[::2])
    assert (column[::2] == dam.densities).all()


def test_reading_and_writing_none(make):
    """Of an array without rows NumPy may say that its strides are 0."""
    fluid = make([[0.2, 0.2, 0.2]])
    for rows in (np.empty((0, 3), fluid.dtype), np.empty((5, 3), fluid.dtype)[:0]):
        assert fluid.read("position", rows, first=1) is rows
        fluid.write("velocity", rows)
    fluid.remove([0])
    fluid.read("id", np.empty(0, np.uint32))
    fluid.read("velocity", np.empty((fluid.count, 4), np.float64))


def test_read_refuses(dam):
    for arguments, words in [
            ({"field": "colour"}, '"position"'), ({"field": "position", "order": "sorted"}, "stored"),
            ({"field": "position", "w": "mass"}, "speed"),
            ({"field": "position", "dtype": "int8"}, "float32"),
            ({"field": "position", "behind": 0.5}, "pbf_keep_previous"),
            ({"field": "position", "first": 990, "count": 11}, "1000")]:
        with pytest.raises(pbf.Error, match=words):
            dam.read(**arguments)
    with pytest.raises(pbf.InvalidArgumentError, match="side by side"):
        dam.read("position", np.empty((3, 1000), np.float32).T)
    with pytest.raises(pbf.InvalidArgumentError, match="too small"):
        dam.read("position", np.empty((10, 3), np.float32), count=11)
    with pytest.raises(pbf.InvalidArgumentError, match="out is a list"):
        dam.read("density", [0.0] * 1000)
    locked = np.empty((10, 3), np.float32)
    locked.flags.writeable = False
    with pytest.raises(pbf.InvalidArgumentError, match="not writeable"):
        dam.read("position", locked)
    swapped = np.zeros((1000, 3), np.dtype(np.float32).newbyteorder())
    with pytest.raises(pbf.InvalidArgumentError, match="this machine's order"):
        dam.read("position", swapped)
    one_row = np.lib.stride_tricks.as_strided(np.zeros(3, np.float32), (1000, 3), (0, 4))
    with pytest.raises(pbf.InvalidArgumentError, match="one after another"):
        dam.read("position", one_row)
    assert not swapped.any() and not one_row.any()


def test_between_two_steps(dam):
    dam.keep_previous()
    before = dam.positions
    dam.step()
    after = dam.positions
    assert (dam.read("position", behind=1) == before).all()
    assert dam.read("position", behind=0.25) == pytest.approx(0.75 * after + 0.25 * before, abs=1e-6)


def test_fill():
    assert pbf.fill_box((0, 0, 0), (1, 0.5, 0.25), 0.05).shape == (20 * 10 * 5, 3)
    box = pbf.fill_box((0, 0), (0.1, 0.1), 0.05)
    assert box == pytest.approx(np.array(
        [[0.025, 0.025], [0.075, 0.025], [0.025, 0.075], [0.075, 0.075]]))
    ball = pbf.fill_ball((1, 2, 3), 0.5, 0.02)
    assert len(ball) == pytest.approx(4 / 3 * np.pi * 0.5**3 / 0.02**3, rel=0.01)
    assert np.linalg.norm(ball - [1, 2, 3], axis=1).max() < 0.5
    assert ball.mean(axis=0) == pytest.approx([1, 2, 3])
    assert pbf.fill_lattice((1, 1), (3, 2), 0.5).tolist()[:4] == [[1, 1], [1.5, 1], [2, 1], [1, 1.5]]
    for call in (lambda: pbf.fill_box((0, 0, 0), (1, 1, 1), 0), lambda: pbf.fill_box((0, 0), (1,), 1),
                 lambda: pbf.fill_ball((0, 0), -1, 1), lambda: pbf.fill_box((1, 1), (0, 0), 0.1),
                 lambda: pbf.fill_lattice((0, 0), (1, -1), 1)):
        with pytest.raises(pbf.InvalidArgumentError):
            call()
    with pytest.raises(pbf.InvalidArgumentError, match="at most a million spacings, 50000"):
        pbf.fill_ball((0, 0), 1e9, 0.05)


def test_add_shapes(make):
    fluid = make(capacity=3000)
    assert len(fluid.add_box((0, 0, 0), (0.5, 0.5, 0.5))) == 1000
    ball = fluid.add_ball((0.5, 0.8, 0.5), 0.15, (0, -2, 0))
    assert ball.start == 1000 and len(ball) == fluid.count - 1000
    assert (fluid.velocities[ball.start:] == [0, -2, 0]).all()


def test_anisotropies(make):
    """Of a block, inside the identity, and on the middle of a face flat: what the sums over a half lattice give."""
    fluid = make(pbf.fill_box((0.1, 0.1, 0.1), (0.9, 0.9, 0.9), 0.05))
    positions, stretches = fluid.anisotropies(smoothing=0.5)
    assert positions.shape == (fluid.count, 3) and stretches.shape == (fluid.count, 3, 3)
    assert stretches.dtype == positions.dtype == np.float32
    middle = np.abs(fluid.positions - 0.525).max(axis=1).argmin()
    assert stretches[middle] == pytest.approx(np.eye(3), abs=1e-4)
    assert positions[middle] == pytest.approx(fluid.positions[middle], abs=1e-5)
    side = np.abs(fluid.positions - [0.525, 0.875, 0.525]).max(axis=1).argmin()
    assert stretches[side] == pytest.approx(np.diag([1.03036, 0.38133, 1.03036]), abs=1e-4)
    assert positions[side] == pytest.approx(
        fluid.positions[side] - [0, 0.5 * 1.0258809 * 0.05, 0], abs=1e-5)
    some = fluid.anisotropies(smoothing=0.5, first=7, count=3)
    assert (some.positions == positions[7:10]).all() and (some.stretches == stretches[7:10]).all()
    with pytest.raises(pbf.InvalidArgumentError, match="anisotropy.radius is 9"):
        fluid.anisotropies(radius=9)
    assert len(make(dimension=2).anisotropies().stretches) == 0


def test_write_from_a_layout(make):
    given = np.arange(12.0).reshape(3, 4) / 16
    for dtype in (np.float32, np.float64, np.int64, np.dtype(np.float32).newbyteorder()):
        fluid = make([[0.2, 0.2, 0.2], [0.4, 0.2, 0.2], [0.6, 0.2, 0.2], [0.8, 0.2, 0.2]])
        rows = (16 * given).astype(dtype) if dtype is np.int64 else given.astype(dtype)
        fluid.write("velocity", rows, first=1)
        assert (fluid.velocities[0] == 0).all()
        assert (fluid.velocities[1:] == rows[:, :3]).all()
        fluid.write("position", given[::2, :3] + 0.125)
        assert (fluid.positions[:2] == given[::2, :3] + 0.125).all()


def test_write_refuses(make):
    fluid = make([[0.2, 0.2, 0.2], [0.4, 0.2, 0.2]])
    before = fluid.hash
    for array, error, words in (
            ([[1.0, 2.0]], pbf.InvalidArgumentError, "array has the shape (1, 2)"),
            ([[np.nan, 0, 0]], pbf.InvalidArgumentError, "velocities[0][0] is NaN"),
            (np.zeros((3, 3)), pbf.InvalidArgumentError, "first is 0 and count 3"),
            (np.zeros((1, 6))[:, ::2], pbf.InvalidArgumentError, "array has the strides")):
        with pytest.raises(error, match=re.escape(words)):
            fluid.write("velocity", array)
    with pytest.raises(pbf.InvalidArgumentError, match=r"write.field is 4"):
        fluid.write("density", [[1.0, 2.0, 3.0]])
    with pytest.raises(pbf.InvalidArgumentError, match="stream is given"):
        fluid.write("velocity", [[1.0, 2.0, 3.0]], stream=1)
    assert fluid.hash == before


class OnGpu:
    """As arrays of a GPU describe themselves; the memory is never looked at here."""

    def __init__(self, shape, readonly=False):
        self.__cuda_array_interface__ = {"version": 3, "shape": shape, "typestr": "<f4", "strides": None,
                                         "data": (1 << 20, readonly), "stream": 1}


def test_arrays_on_a_gpu_want_a_solver_there(make):
    fluid = make([[0.2, 0.2, 0.2], [0.4, 0.2, 0.2]])
    if fluid.backend == "cuda":
        pytest.skip("the solver is on a GPU")
    with pytest.raises(pbf.UnsupportedError, match=r"read.device_type is 2"):
        fluid.read("position", OnGpu((2, 3)))
    with pytest.raises(pbf.UnsupportedError, match=r"write.device_type is 2"):
        fluid.write("velocity", OnGpu((2, 4)))
    with pytest.raises(pbf.InvalidArgumentError, match="not writeable"):
        fluid.read("position", OnGpu((2, 3), readonly=True))
    with pytest.raises(pbf.InvalidArgumentError, match="stream is"):
        fluid.write("velocity", OnGpu((2, 3)), stream="mine")


class Liar:
    """What says of itself what can't be."""

    def __init__(self, said):
        self.said = said

    @property
    def __cuda_array_interface__(self):
        if isinstance(self.said, Exception):
            raise self.said
        return self.said


GOOD = {"version": 3, "shape": (2, 3), "typestr": "<f4", "strides": None, "data": (1 << 20, False)}


@pytest.mark.parametrize("said", [
    None, {}, [], 5, OSError("gone"), ValueError("no"),
    *({**GOOD, key: value} for key, value in (
        ("shape", None), ("shape", (-1, 3)), ("shape", (2.5, 3)), ("shape", "ab"), ("shape", (2**63, 3)),
        ("shape", ()), ("typestr", "xyz"), ("typestr", None), ("typestr", "|O8"), ("strides", (12,)),
        ("strides", (12, 4, 1)), ("strides", (0, 4)), ("strides", (2**70, 4)), ("strides", (12.5, 4)),
        ("data", None), ("data", (-5, False)), ("data", (2**70, False)), ("data", ("x", False)),
        ("mask", [1, 0]), ("stream", "x"), ("stream", -3), ("stream", 2**70)))])
def test_arrays_that_lie(make, said):
    fluid = make([[0.2, 0.2, 0.2], [0.4, 0.2, 0.2]])
    before = fluid.hash
    for call in (fluid.read, fluid.write):
        with pytest.raises(pbf.InvalidArgumentError):
            call("velocity", Liar(said) if said is not None else object())
    assert fluid.hash == before


class Broken:
    def __init__(self, device, capsule):
        self.device, self.capsule = device, capsule

    def __dlpack_device__(self):
        if isinstance(self.device, Exception):
            raise self.device
        return self.device

    def __dlpack__(self, **_options):
        if isinstance(self.capsule, Exception):
            raise self.capsule
        return self.capsule


@pytest.mark.parametrize("array", [
    Broken(ValueError("no"), None), Broken(5, 7), Broken((1, 0), BufferError("no")),
    Broken((1, 0), object()), "abc", np.zeros((2, 3), complex), np.zeros((2, 3), object),
    np.zeros((2, 3), "M8[s]"), np.zeros((2, 3), bool), {"a": 1}, (k for k in range(3))])
def test_arrays_of_no_numbers(make, array):
    fluid = make([[0.2, 0.2, 0.2], [0.4, 0.2, 0.2]])
    before = fluid.hash
    for call in (lambda: fluid.write("velocity", array), lambda: fluid.set_velocities(array),
                 lambda: fluid.read("velocity", array)):
        with pytest.raises(pbf.InvalidArgumentError):
            call()
    assert fluid.hash == before


def test_numbers_that_no_sentence_holds(make):
    fluid = make([[0.2, 0.2, 0.2]])
    for call in (lambda: fluid.step(10**5000), lambda: fluid.set(time_step=10**400),
                 lambda: fluid.read(["position"]), lambda: make(backend="\ud800"),
                 lambda: make(stream=2**64), lambda: make(stream=1.5)):
        with pytest.raises(pbf.InvalidArgumentError) as error:
            call()
        assert len(str(error.value)) < 300
