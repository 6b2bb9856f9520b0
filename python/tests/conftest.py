"""What the tests share. They import `pbf` from wherever it is installed, or from the PYTHONPATH
that CTest sets; run on one backend with PBF_TEST_BACKEND."""
import os

import numpy as np
import pytest

import pbf

BACKEND = os.environ.get("PBF_TEST_BACKEND") or next(
    name for name in ("serial", "threads", "openmp", "reference")
    if any(backend.name == name and backend.available for backend in pbf.backends()))


def pytest_report_header():
    return f"pbf {pbf.__version__} from {os.path.dirname(pbf.__file__)}, backend {BACKEND}"


@pytest.fixture
def make():
    """Makes solvers on the backend under test, and closes them."""
    made = []

    def solver(*positional, **keywords):
        keywords.setdefault("backend", BACKEND)
        fluid = pbf.Solver(*positional, **keywords)
        made.append(fluid)
        return fluid

    yield solver
    for fluid in made:
        fluid.close()


@pytest.fixture
def dam(make):
    """A block of 10 x 10 x 10 particles in the corner of the default box."""
    return make(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05))


@pytest.fixture
def rng():
    return np.random.default_rng(7)
