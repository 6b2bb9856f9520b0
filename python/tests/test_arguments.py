"""What callers pass that is none of what a call wants, or lies in memory in another way."""
import copy
import gc
import pickle
import threading
import warnings

import numpy as np
import pytest

import pbf
from pbf import _files


def corners():
    return np.array([[x, y, z] for x in (-.1, .1) for y in (-.1, .1) for z in (-.1, .1)])


def solids():
    """Each of a geometry that nothing else refers to."""
    yield pbf.Solid(geometry=pbf.Geometry.from_points(corners(), cell=0.01), position=(2, 0.5, 0.5))


def unaligned(array):
    """The same numbers a byte off their alignment, as behind the head of a file."""
    room = bytearray(1 + array.nbytes)
    made = np.frombuffer(room, array.dtype, array.size, offset=1).reshape(array.shape)
    made[...] = array
    assert not made.flags.aligned
    return made


def test_colliders_may_come_from_a_generator(make):
    fluid = make(capacity=10, domain_max=(3, 1, 1))
    fluid.colliders = solids()
    gc.collect()
    assert fluid.colliders[0].geometry.volume == pytest.approx(0.008, rel=0.1)
    batch = pbf.Batch(2, capacity=10, backend=fluid.backend, domain_max=(3, 1, 1))
    batch.set_colliders(solids())
    assert len(batch[1].colliders) == 1


@pytest.mark.parametrize("value", [
    np.complex64(0.1 + 2j), np.array(0.1 + 1j), 0.1 + 1j, np.ma.masked, np.datetime64("2020"),
    np.array([0.1, 0.2]), np.array("0.1")])
def test_what_is_no_real_number(dam, value):
    before = dam.viscosity
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(pbf.InvalidArgumentError, match="viscosity is .*; it must be a number"):
            dam.viscosity = value
    assert dam.viscosity == before


def test_numbers_beyond_the_precision_are_told_as_given(make):
    fluid = make(capacity=10, domain_max=(3, 1, 1))
    fluid.add([[0.5, 0.5, 0.5]])
    fluid.diffuse = fluid.default_diffuse()
    batch = pbf.Batch(1, capacity=10, backend=fluid.backend)
    far = [[0, 0, 1e300]]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for call, said in (
                (lambda: fluid.add(far), r"positions\[0\]\[2\] is 1e\+300"),
                (lambda: fluid.set_velocities(far), r"velocities\[0\]\[2\] is 1e\+300"),
                (lambda: fluid.set_accelerations(far), r"accelerations\[0\]\[2\] is 1e\+300"),
                (lambda: fluid.write("velocity", np.array(far, np.longdouble)), r"array\[0\]\[2\] is 1e\+300"),
                (lambda: fluid.add_diffuse([[0.5, 0.5, 0.5]], 1e300), r"lives\[0\] is 1e\+300"),
                (lambda: batch.add(far), r"positions\[0\]\[0\]\[2\] is 1e\+300"),
                (lambda: pbf.Geometry.from_grid(np.full((4, 4), 1e300), (0, 0), 1), r"values\[0\]\[0\] is 1e\+300")):
            with pytest.raises(pbf.InvalidArgumentError, match=said + ".*a number that float32 holds"):
                call()
        with pytest.raises(pbf.InvalidArgumentError, match="is NaN"):
            fluid.set_velocities([[0, 0, float("nan")]])


def test_arrays_need_not_be_aligned(make):
    fluid, other = (make(capacity=10, domain_max=(3, 1, 1)) for _ in range(2))
    at = np.linspace(0.2, 0.8, 12).reshape(4, 3)
    for one, way in ((fluid, unaligned), (other, np.array)):
        one.add(way(at.astype(np.float32)))
        one.set_velocities(way(at.astype(np.float32)))
        one.write("velocity", way(at))
        one.remove(way(np.array([1], np.uint32)))
    assert fluid.hash == other.hash
    assert np.array_equal(fluid.sample(unaligned(at)).densities, fluid.sample(at).densities)
    assert np.array_equal(fluid.levels(unaligned(at)), fluid.levels(at), equal_nan=True)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], np.uint32)
    tips = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    whole = pbf.Geometry.from_mesh(tips, faces, cell=0.1)
    assert pbf.Geometry.from_mesh(unaligned(tips), unaligned(faces), cell=0.1).volume == whole.volume
    hull = pbf.Geometry.from_points(unaligned(tips), cell=0.1)
    assert hull.volume == pbf.Geometry.from_points(tips, cell=0.1).volume


def test_numbers_that_no_count_holds(dam):
    for call, said in (
            (lambda: pbf.Geometry.from_grid(np.zeros((2**33, 0, 3)), (0, 0, 0), 1), "axis 0 of values is 8589934592"),
            (lambda: pbf.Geometry.from_heights(np.zeros((2**33, 0)), spacing=1, base=0, cell=1),
             "axis 0 of heights is 8589934592"),
            (lambda: dam.sample_on_grid((2**31, 2**31, 4), (0, 0, 0), 0.1), "points is 18446744073709551616"),
            (lambda: dam.sample_on_grid((2**31, 2**31, 4), (0, 0, 0), 0.1, ()), "points is 18446744073709551616"),
            (lambda: dam.sample_on_grid(5, (0, 0, 0), 0.1), "counts is 5; it must be a list of 3 numbers"),
            (lambda: dam.remove_in_box(5), "lower is 5; it must be a list of 3 numbers"),
            (lambda: dam.remove_in_box(np.array(5)), r"lower is array\(5\); it must be a list of 3 numbers"),
            (lambda: pbf.Geometry(5), "handle is 5; it must be a pbf_shape"),
            (lambda: pbf.Solver(capacity=10, log=5), "log is 5; it must be a function")):
        with pytest.raises(pbf.InvalidArgumentError, match=said):
            call()
    assert dam.sample_on_grid((2, 2, 2), (0, 0, 0), np.float32(0.1)).densities.shape == (2, 2, 2)


@pytest.mark.parametrize("name", ["colliders", "emitters", "drains", "reservoirs", "phases"])
def test_lists_that_are_none(dam, name):
    for value in (5, None, np.array(1.0), print):
        with pytest.raises(pbf.InvalidArgumentError, match=f"{name} is .*; it must be a list of {name}"):
            setattr(dam, name, value)
    with pytest.raises(pbf.InvalidArgumentError, match=rf"{name}\[0\] is '(x+)…; it must be"):
        setattr(dam, name, ["x" * 100_000])


def test_a_reservoir_has_a_whole_phase(dam):
    with pytest.raises(pbf.InvalidArgumentError, match="phase is 0.5; it must be an integer"):
        dam.reservoirs = pbf.Reservoir((0.5, 0.5, 0.5), half_extents=(0.1, 0.1, 0.1), depth=0.1, phase=0.5)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, pickle.dumps])
def test_what_holds_memory_is_not_copied(dam, way):
    """A tensor's memory went with the array of its copy; a batch's copy was closed with it."""
    batch = pbf.Batch(2, capacity=10, backend=dam.backend)
    with dam.view() as view:
        for held in (batch, batch.tensor(), view):
            with pytest.raises(TypeError, match="can't be copied or pickled"):
                way(held)


def test_worlds_are_numbered_by_integers(dam):
    batch = pbf.Batch(2, capacity=10, backend=dam.backend)
    assert batch[np.int64(-1)] is batch[1]
    for wrong in (slice(0, 1), 0.0, "a", None):
        with pytest.raises(pbf.InvalidArgumentError, match="world is .*; it must be an integer"):
            batch[wrong]


def test_threads_write_one_file(tmp_path):
    path, failed = tmp_path / "state", []

    def write(content):
        try:
            for _ in range(50):
                _files.replace(path, content)
        except OSError as error:
            failed.append(error)

    writers = [threading.Thread(target=write, args=(letter * 100000,)) for letter in (b"a", b"b", b"c")]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert not failed
    assert path.read_bytes() in (letter * 100000 for letter in (b"a", b"b", b"c"))
    assert list(tmp_path.iterdir()) == [path]
