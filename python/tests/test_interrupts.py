"""An interrupt at any line of the package leaves a solver that goes on, and nothing held."""
import copy
import os
import sys

import numpy as np
import pytest

import pbf

from conftest import BACKEND

PACKAGE = os.path.dirname(pbf.__file__)
AS_ONE = {"capsule_of", "_delete_held", "_free_capsule"}  # where no interrupt comes between two lines without calls


class Interrupt(KeyboardInterrupt):
    pass


def interrupted_at(number, act):
    """Whether `act` has come to the line of that number, at which it was interrupted."""
    left = [number]

    def at_line(frame, event, _argument):
        if event == "line":
            left[0] -= 1
            if left[0] < 0:
                sys.settrace(None)
                raise Interrupt(f"{frame.f_code.co_name}:{frame.f_lineno}")
        return at_line

    def at_call(frame, _event, _argument):
        inside = frame.f_code.co_filename.startswith(PACKAGE)
        return at_line if inside and frame.f_code.co_name not in AS_ONE else None

    before = sys.gettrace()
    sys.settrace(at_call)
    try:
        act()
    except Interrupt:
        return True
    finally:
        sys.settrace(before)
    return False


def steps(fluid):
    fluid.step(20)


def stepping(fluid):
    with fluid.stepping(20):
        pass


def view(fluid):
    with fluid.view() as view:
        np.asarray(view)


def tensor(fluid):
    np.from_dlpack(fluid)


def snapshot(fluid):
    fluid.keep_snapshots(3)
    assert fluid.snapshot().positions.shape


def copied(fluid):
    copy.copy(fluid).close()


def reserved(fluid):
    fluid.reserve(fluid.capacity + 1)


@pytest.mark.parametrize("act", [steps, stepping, view, tensor, snapshot, copied, reserved])
def test_interrupts(act):
    fluid = pbf.Solver(pbf.fill_box((0.1, 0.1, 0.1), (0.3, 0.3, 0.3), 0.05), backend=BACKEND)
    number = 0
    while interrupted_at(number, lambda: act(fluid)):
        fluid.step(1)
        assert np.isfinite(fluid.positions).all()
        fluid.keep_snapshots(0)  # refused while one is held
        number += 1
    assert number > 3


def test_what_a_log_raises_ends_begun_steps():
    """It comes from the thread that runs the steps, at any time after their begin."""
    def refuse(_level, message):
        raise RuntimeError(message)

    for _ in range(20):
        fluid = pbf.Solver(pbf.fill_box((0.1, 0.1), (0.3, 0.3), 0.05), backend=BACKEND, log=refuse)
        fluid.gravity = (0, -1000, 0)  # of which steps are too long
        with pytest.raises(RuntimeError, match="step"):
            fluid.step(50)
        fluid.step(2)
        fluid.begin_step(2)
        fluid.end_step()
        fluid.close()
