"""Saved states, pickles and copies."""
import copy
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import pbf
from conftest import BACKEND


@pytest.fixture
def run_in(dam):
    dam.viscosity = 0.01
    dam.colliders = pbf.Sphere((0.8, 0.2, 0.5), radius=0.1, velocity=(-0.1, 0, 0))
    dam.step(10)
    return dam


def test_save_and_load(run_in, tmp_path):
    state = run_in.save(tmp_path / "state.pbf")
    assert (tmp_path / "state.pbf").read_bytes() == state
    run_in.step(10)
    end = run_in.hash
    for source in (state, bytearray(state), memoryview(state), tmp_path / "state.pbf",
                   str(tmp_path / "state.pbf")):
        run_in.load(source)
        assert run_in.steps_done == 10
        run_in.step(10)
        assert run_in.hash == end


def test_restore(run_in):
    state = run_in.save()
    with pbf.Solver.restore(state, backend=BACKEND) as other:
        assert (other.count, other.dimension, other.dtype, other.viscosity) == (1000, 3, "f4", 0.01)
        assert other.colliders == run_in.colliders and other.hash == run_in.hash
    flat = pbf.Solver([[0.5, 0.5]], precision="float64", backend=BACKEND)
    with pbf.Solver.restore(flat.save(), capacity=7) as other:
        assert (other.dimension, other.dtype, other.capacity) == (2, "f8", 7)


def test_damaged_states(run_in):
    state = run_in.save()
    before = run_in.hash
    broken = bytearray(state)
    broken[len(broken) // 2] ^= 1
    for bad in (b"", b"water", state[:-1], state + b"x", bytes(broken)):
        with pytest.raises(pbf.DataError) as caught:
            run_in.load(bad)
        assert isinstance(caught.value, ValueError) and run_in.hash == before
        with pytest.raises(pbf.DataError):
            pbf.Solver.restore(bad)
    with pbf.Solver([[0.5, 0.5]], backend=BACKEND) as flat:
        with pytest.raises(pbf.DataError, match="2D"):
            flat.load(state)


@pytest.mark.parametrize("way", [lambda fluid: pickle.loads(pickle.dumps(fluid)), copy.copy,
                                 copy.deepcopy, lambda fluid: fluid.copy()])
def test_pickles_and_copies_go_on_alike(run_in, way):
    run_in.keep_snapshots(2)
    run_in.label = "mine"
    other = way(run_in)
    assert other.hash == run_in.hash and other.params == run_in.params
    assert other.label == "mine" and other.colliders == run_in.colliders
    run_in.step(5)
    assert other.hash != run_in.hash
    other.step(5)
    assert other.hash == run_in.hash
    assert other.snapshot().step == 15
    other.close()


def test_pickle_of_a_class_of_ones_own(run_in):
    other = pickle.loads(pickle.dumps(Pool(run_in.positions, backend=BACKEND)))
    assert type(other) is Pool and other.count == 1000


class Pool(pbf.Solver):
    pass


@pytest.mark.parametrize("forged", [
    lambda state: None, lambda state: {}, lambda state: list(state), lambda state: {**state, "desc": {}},
    lambda state: {**state, "desc": None}, lambda state: {**state, "state": 3},
    lambda state: {**state, "desc": {**state["desc"], "more": 1}},
    lambda state: {**state, "snapshots": "many"},
    lambda state: {**state, "attributes": {"_handle": 0}}, lambda state: {**state, "attributes": {5: 0}}])
def test_a_pickle_of_something_else_is_refused(run_in, forged):
    made = pbf.Solver.__new__(pbf.Solver)
    with pytest.raises(pbf.DataError, match="is not that of a solver"):
        made.__setstate__(forged(run_in.__getstate__()))
    assert made.closed


def test_an_old_file_stays_where_a_new_one_finds_no_room(run_in, tmp_path):
    resource = pytest.importorskip("resource")
    run_in.save(tmp_path / "kept.state")
    before = (tmp_path / "kept.state").read_bytes()
    run_in.step(3)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))  # as on a full disk
    try:
        with pytest.raises(OSError):
            run_in.save(tmp_path / "kept.state")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (tmp_path / "kept.state").read_bytes() == before
    assert [left.name for left in tmp_path.iterdir()] == ["kept.state"]
    run_in.save(tmp_path / "kept.state")
    assert (tmp_path / "kept.state").read_bytes() != before


def test_states_are_bytes_of_any_memory(run_in, make):
    state = bytearray(run_in.save())
    state += bytes(-len(state) % 4)
    words = memoryview(np.frombuffer(state, np.float32))
    apart = memoryview(np.repeat(np.frombuffer(run_in.save(), np.uint8), 2))[::2]
    assert pbf.Solver.restore(apart).hash == run_in.hash
    if len(state) == len(run_in.save()):
        assert pbf.Solver.restore(words).hash == run_in.hash


def test_files_are_replaced_where_they_are(run_in, tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    (there / "a.state").write_bytes(b"old")
    (there / "a.state").chmod(0o640)
    (tmp_path / "link.state").symlink_to("there/a.state")
    run_in.save(tmp_path / "link.state")
    assert (tmp_path / "link.state").is_symlink()
    assert (there / "a.state").stat().st_mode & 0o777 == 0o640
    assert (there / "a.state").read_bytes() == run_in.save()
    long = tmp_path / ("n" * 250)  # no longer name is to be had beside it
    run_in.save(long)
    assert long.read_bytes() == run_in.save()
    with pytest.raises(OSError):
        run_in.save("/dev/full")
    with open(tmp_path / "out", "wb") as out:
        child = subprocess.run([sys.executable, "-c", "import pbf, sys; pbf.save_png('/dev/stdout', "
                                "pbf.Solver(capacity=1).render((32, 32))); sys.stderr.write('done')"],
                               stdout=out, stderr=subprocess.PIPE, check=True)
    assert child.stderr == b"done"
    assert (tmp_path / "out").read_bytes().startswith(b"\x89PNG")
    assert sorted(left.name for left in tmp_path.rglob("*.new*")) == []


def test_geometries_are_copied_and_pickled():
    corner = pbf.Geometry.from_points(np.vstack([np.zeros((1, 3)), np.eye(3)]), cell=0.1)
    for made in (copy.copy(corner), copy.deepcopy(corner), pickle.loads(pickle.dumps(corner))):
        assert made.volume == corner.volume and (made.values == corner.values).all()


def test_what_is_no_state_is_read_no_further():
    for endless in ("/dev/zero", "/dev/full"):
        with pytest.raises(pbf.DataError, match="begin"):
            pbf.Solver.restore(endless)
        with pytest.raises(pbf.DataError, match="begin"):
            pbf.Geometry.load(endless)


def test_states_come_through_pipes(run_in, tmp_path):
    state = run_in.save() + bytes(1 << 20)  # more than a pipe holds, and more than one part
    with pytest.raises(pbf.DataError) as as_bytes:
        pbf.Solver.restore(state)
    assert restored(state, tmp_path / "long") == as_bytes.value.sentence
    assert restored(run_in.save(), tmp_path / "whole") == run_in.hash


def restored(state, pipe):
    """The hash of what comes through a pipe, or the sentence that it is none."""
    os.mkfifo(pipe)
    writer = threading.Thread(target=pipe.write_bytes, args=(state,))
    writer.start()
    try:
        return pbf.Solver.restore(pipe).hash
    except pbf.DataError as error:
        return error.sentence
    finally:
        writer.join()
