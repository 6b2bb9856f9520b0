"""Views without a copy, DLPack both ways, snapshots; and in which order they may be dropped."""
import gc

import numpy as np
import pytest

import pbf
from conftest import BACKEND


def test_view_is_the_memory(dam):
    dam.step(5)
    with dam.view("position") as view:
        x = view.array
        assert x.shape == (1000, 3) and not x.flags.writeable and not x.flags.owndata
        assert (x == dam.positions[view.ids]).all()
        assert np.shares_memory(x, dam.view("position").array)
        assert len(view) == 1000
        del x
    for field in ("velocity", "id", "pressure"):
        with dam.view(field) as view:
            assert (view.array == dam.read(field)[view.ids]).all()
    with pytest.raises(pbf.Error, match="mapped|density"):
        dam.view("density")


def test_steps_wait_for_views(dam):
    x = dam.view("position").array
    before = x.copy()
    with pytest.raises(pbf.StateError, match="mapped"):
        dam.step()
    assert (x == before).all() and dam.steps_done == 0
    del x
    dam.step()
    view = dam.view("velocity")
    view.release()
    with pytest.raises(pbf.StateError, match="released"):
        view.array
    dam.step()


def test_numpy_takes_views(dam):
    with dam.view("velocity") as view:
        assert (np.asarray(view) == 0).all()
        assert np.array(view, np.float64).dtype == np.float64
        assert np.from_dlpack(view).shape == (1000, 3)
    dam.step()
    assert np.from_dlpack(dam).shape == (1000, 3)
    dam.step()  # all are gone


def test_a_capsule_that_nobody_takes(dam):
    capsule = dam.view("position").__dlpack__()
    with pytest.raises(pbf.StateError):
        dam.step()
    del capsule
    dam.step()


def test_dlpack_options(dam):
    view = dam.view("position")
    assert view.__dlpack_device__() == (1, 0)
    with pytest.raises(BufferError, match="device"):
        view.__dlpack__(dl_device=(2, 0))
    copied = view.__dlpack__(copy=True)
    view.release()
    dam.step()  # a copy holds nothing
    del copied


class Foreign:
    """An array of another library, as far as DLPack goes."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_foreign_arrays_come_in(make, rng):
    x = rng.uniform(0.1, 0.9, (50, 3))
    fluid = make(Foreign(x.astype(np.float32)), Foreign(-x))
    assert (fluid.positions == x.astype(np.float32)).all()
    assert (fluid.velocities == -x.astype(np.float32)).all()
    fluid.remove(Foreign(np.array([3, 4])))
    assert fluid.count == 48


@pytest.mark.parametrize("drop", ["solver", "view"])
def test_any_order_of_dropping(drop):
    fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05), backend=BACKEND)
    expected = fluid.positions
    view = fluid.view("position")
    array = view.array
    ids = view.ids
    fluid.keep_snapshots(2)
    snapshot = fluid.snapshot()
    kept = snapshot.positions
    if drop == "solver":
        fluid.close()
        del fluid
        gc.collect()
    else:
        del view, snapshot
    assert (array == expected[ids]).all()
    assert (kept == expected).all()


def test_solvers_are_freed(make):
    """A view or a callback must not keep a solver alive, nor leave its memory behind."""
    import weakref

    fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05), backend=BACKEND,
                       log=lambda level, message: None)
    fluid.step(2)
    died = weakref.ref(fluid)
    del fluid
    assert died() is None


def test_snapshots(dam):
    with pytest.raises(pbf.StateError, match="snapshot"):
        dam.snapshot()
    dam.keep_snapshots(3)
    dam.step(4)
    with dam.snapshot() as held:
        assert held.step == 4 and held.time == pytest.approx(4 / 120) and len(held) == 1000
        expected = dam.positions
        dam.step(6)
        assert (held.positions == expected).all() and not held.positions.flags.writeable
        assert held.ids.tolist() == list(range(1000))
    with pytest.raises(pbf.StateError, match="released"):
        held.positions
    assert dam.snapshot().step == 10
    assert (dam.snapshot().velocities == dam.velocities).all()
    dam.keep_snapshots(0)


def test_empty(make):
    fluid = make()
    assert fluid.positions.shape == (0, 3)
    assert fluid.view("position").array.shape == (0, 3)
    fluid.keep_snapshots(2)
    assert fluid.snapshot().positions.shape == (0, 3)
    fluid.step()
    assert fluid.stats.count == 0
    fluid.positions = []
    assert fluid.add(np.empty((0, 3))) == range(0)
