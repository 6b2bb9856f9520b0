"""The life of a solver: threads, signals, forks, the interpreter's end, exceptions in callbacks."""
import logging
import os
import pickle
import subprocess
import sys
import textwrap
import threading
import time

import pytest

import pbf
from conftest import BACKEND

BOX = "pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05)"


def run(program, expected=0):
    """What another interpreter prints. It must end as expected, and say nothing else."""
    found = subprocess.run([sys.executable, "-c", "import pbf\n" + textwrap.dedent(program)],
                           capture_output=True, text=True, timeout=3600)
    assert (found.returncode, found.stderr) == (expected, "")
    return found.stdout


def test_close(dam):
    assert "1000 particles in 3D" in repr(dam)
    with dam as entered:
        assert entered is dam
    assert dam.closed and repr(dam) == "<pbf.Solver, closed>" and dam._repr_png_() is None
    dam.close()
    for call in (dam.step, lambda: dam.step(5), lambda: dam.positions, lambda: dam.cancel(),
                 lambda: dam.view("position"), lambda: dam.viscosity, lambda: dam.save()):
        with pytest.raises(pbf.StateError, match="closed"):
            call()


def test_creation_that_fails_leaves_nothing():
    for keywords, kind in [
            ({"backend": "abacus", "strict": True}, pbf.NotFoundError),
            ({"backend": BACKEND, "dimension": 4}, pbf.InvalidArgumentError),
            ({"precision": "float16"}, pbf.InvalidArgumentError),
            ({"capacity": 0}, pbf.InvalidArgumentError),
            ({"capacity": -1}, pbf.InvalidArgumentError),
            ({"backend": 3}, pbf.InvalidArgumentError),
            ({"device": "first"}, pbf.InvalidArgumentError),
            ({"params": {"viscosity": 1}}, pbf.InvalidArgumentError),
            ({"positions": 5}, pbf.InvalidArgumentError),
            ({"isa": "mmx", "backend": BACKEND}, pbf.Error),
            ({"determinism": "never"}, pbf.InvalidArgumentError),
            ({"positions": [[9, 9, 9]]}, pbf.InvalidArgumentError)]:
        with pytest.raises(kind) as caught:
            pbf.Solver(**keywords)
        assert len(str(caught.value)) > 20  # a sentence
        assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


def test_interpreter_exits_with_everything_alive():
    assert run(f"""
        fluid = pbf.Solver({BOX}, log=print)
        fluid.step(3)
        fluid.keep_snapshots(2)
        held, view = fluid.snapshot(), fluid.view("position")
        array, capsule = view.array, view.__dlpack__()
        print("end")
        """) == "end\n"


def test_interpreter_exits_beside_steps():
    assert run(f"""
        fluid = pbf.Solver({BOX}, log=print)
        fluid.begin_step(1000000)
        print("end")
        """) == "end\n"


def test_interpreter_ends_solvers_first():
    """Before it takes modules apart, while threads of theirs may still log."""
    assert run(f"""
        import os
        class Owner:
            def __del__(self): # what is printed so late may be flushed no more
                os.write(1, b"%r\\n" % self.fluid.closed)
        owner = Owner()
        owner.fluid = pbf.Solver({BOX}, backend="{BACKEND}")
        """) == "True\n"


def test_ctrl_c_ends_steps():
    program = f"""
        import os, signal, threading, time
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell ignores it for what runs in its background
        fluid = pbf.Solver({BOX}, backend="{BACKEND}")
        begins = threading.Event()
        def interrupt():
            begins.wait()
            time.sleep(0.5)
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=interrupt).start()
        try:
            begins.set()
            fluid.step(4000000000)
        except KeyboardInterrupt:
            done = fluid.steps_done
            fluid.step(2)
            print(0 < done < 4000000000, fluid.steps_done == done + 2)
        """
    assert run(program) == "True True\n"


def test_fork():
    """Both processes go on with the same bits."""
    hashes = run(f"""
        import os
        import warnings
        fluid = pbf.Solver({BOX}, backend="{BACKEND}", threads=2)
        fluid.step(5)
        warnings.filterwarnings("ignore", "This process", DeprecationWarning)  # of threads, from Python 3.12 on
        child = os.fork()
        fluid.step(5)
        os.write(1, b"%d\\n" % fluid.hash)  # at once: two processes write
        if child:
            assert os.waitpid(child, 0)[1] == 0
        """).split()
    assert len(hashes) == 2 and hashes[0] == hashes[1]


def test_other_threads_run_meanwhile(make):
    """The interpreter's lock is free in a step: this thread counts while another one steps."""
    fluid = make(pbf.fill_box((0, 0, 0), (1, 1, 1), 0.05))
    stepper = threading.Thread(target=lambda: fluid.step(30))
    counted = 0
    stepper.start()
    while stepper.is_alive():
        counted += 1
        time.sleep(0.001)
    assert fluid.steps_done == 30 and counted > 5


WITHOUT_THREADS = """
import os, resource, sys, threading
import pbf
fluid = pbf.Solver([[0.5, 0.5, 0.5], [0.52, 0.5, 0.5]], backend=sys.argv[2])
if os.getuid() == 0:
    os.setuid(65534)  # root may have as many as it likes

def no_more():
    resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))

if sys.argv[1] == "its own":
    run = threading.Thread.run
    threading.Thread.run = lambda thread: (no_more(), run(thread))
else:
    no_more()
fluid.step(5)
print(fluid.info.step, fluid.hash)
"""


@pytest.mark.parametrize("which", ["Python's", "its own"])
def test_steps_without_threads(make, which):
    """Where the system gives none, the thread that calls runs them."""
    pytest.importorskip("resource")
    fluid = make([[0.5, 0.5, 0.5], [0.52, 0.5, 0.5]])
    fluid.step(5)
    command = [sys.executable, "-c", WITHOUT_THREADS, which, BACKEND]
    child = subprocess.run(command, capture_output=True, text=True, check=False)
    assert child.stderr == "" and child.stdout.split() == ["5", str(fluid.hash)]


def test_a_number_is_no_file():
    for number in (0, 987654):
        with pytest.raises(TypeError):
            pbf.Solver.restore(number)


def test_busy_and_cancel(dam):
    with pytest.raises(pbf.StateError, match="pbf_begin_step"):
        dam.end_step()
    dam.begin_step(4000000000)
    with pytest.raises(pbf.BusyError):
        dam.step()
    with pytest.raises(pbf.BusyError):
        dam.positions
    assert "BUSY" in repr(dam) or "run in this solver" in repr(dam)
    dam.cancel()
    with pytest.raises(pbf.CancelledError):
        dam.end_step()
    done = dam.steps_done
    dam.step(2)
    assert dam.steps_done == done + 2


def test_an_exception_beside_steps_cancels_them(dam):
    with pytest.raises(RuntimeError, match="mine"):
        with dam.stepping(4000000000):
            raise RuntimeError("mine")
    dam.step()


def test_snapshots_beside_steps(dam):
    dam.keep_snapshots(3)
    dam.begin_step(3)
    dam.snapshot().positions
    dam.end_step()
    assert dam.snapshot().step == 3


def test_closing_beside_steps():
    fluid = pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05), backend=BACKEND)
    fluid.begin_step(4000000000)
    fluid.close()


TOO_LONG = {"time_step": 0.2}  # g dt² is several spacings: the log is told


def test_log_goes_to_logging(make, caplog):
    with caplog.at_level(logging.INFO, "pbf"):
        make([[0.5, 0.5, 0.5]], **TOO_LONG).step()
    warnings = [record for record in caplog.records if record.levelno == logging.WARNING]
    assert warnings and warnings[0].name == "pbf" and "gravity" in warnings[0].getMessage()


@pytest.mark.parametrize("steps", [1, 2])
def test_exceptions_cross_callbacks(make, steps):
    def log(level, message):
        if level == pbf.lib.PBF_LOG_WARNING:
            raise KeyError(message)

    fluid = make([[0.5, 0.5, 0.5]], log=log, **TOO_LONG)
    with pytest.raises(KeyError, match="gravity"):
        fluid.step(steps)
    fluid.step()  # as ever: it is told once
    assert fluid.steps_done == steps + 1


def test_silence(make, capfd):
    make([[0.5, 0.5, 0.5]], log=None, **TOO_LONG).step()
    assert capfd.readouterr() == ("", "")


def test_a_name_has_no_zero_in_it():
    for name in ("backend", "isa"):
        with pytest.raises(pbf.InvalidArgumentError, match="a zero would end it"):
            pbf.Solver(**{name: "serial\0x"})


def test_log_may_refer_to_its_solver():
    """A cycle, which the collector frees."""
    import gc
    import weakref

    class Owner:
        def __init__(self):
            self.fluid = pbf.Solver([[0.5, 0.5, 0.5]], log=self.told, backend=BACKEND)

        def told(self, level, message):
            self.last = message

    owner = Owner()
    owner.fluid.reserve(7)
    died = weakref.ref(owner.fluid)
    owner.fluid.step()
    del owner
    gc.collect()
    assert died() is None


def test_progress(dam, capsys):
    pytest.importorskip("tqdm")
    dam.run(steps=10, progress=True)
    assert dam.steps_done == 10 and "10/10" in capsys.readouterr().err
    assert len(list(dam.frames(3, steps=2, progress=True))) == 3
    with pytest.raises(TypeError, match="either"):
        dam.run()


def test_missing_extras_say_so(dam, monkeypatch, tmp_path):
    for name in ("tqdm", "tqdm.auto", "meshio", "pxr.Usd", "alembic3d.AbcGeom", "pysplashsurf", "PIL"):
        monkeypatch.setitem(sys.modules, name, None)
    for call, package in [
            (lambda: dam.run(steps=1, progress=True), "tqdm"),
            (lambda: pbf.VtkSeries(tmp_path / "a.pvd"), "meshio"),
            (lambda: pbf.UsdPoints(tmp_path / "a.usdc"), "usd-core"),
            (lambda: pbf.AlembicPoints(tmp_path / "a.abc"), "alembic3d"),
            (lambda: pbf.surface(dam), "pysplashsurf"),
            (lambda: pbf.Movie(tmp_path / "a.gif"), "pillow")]:
        with pytest.raises(pbf.MissingExtraError, match=f"pip install {package}") as caught:
            call()
        assert isinstance(caught.value, ImportError)


def test_backends():
    found = {backend.name: backend for backend in pbf.backends()}
    assert found[BACKEND].available and os.path.exists(found[BACKEND].path)
    assert all(backend.available or backend.reason for backend in found.values())
    with pytest.raises(pbf.Error):
        pbf.load_backend("/nowhere/pbf_backend_none.so")


def test_reports(dam):
    dam.set_timing()
    dam.step(3)
    assert sum(stage.milliseconds for stage in dam.timings.values()) > 0
    assert dam.plan.bytes > 1000 * 12 and dam.plan.stages and dam.plan.arrays[0].name
    assert dam.plan.variant.startswith("3d-f32")
    assert dam.info.capacity == dam.capacity == 1000
    assert dam.info.backend == dam.backend
    assert dam.step_limit == dam.stats.step_limit > 0
    assert isinstance(dam.stats.limited_by, pbf.Limit)
    dam.synchronize()
