"""Parameters as attributes and keywords."""
import copy
import math
import pickle

import pytest

import pbf


def test_defaults_are_the_headers(dam):
    """As docs/parameters.md has them."""
    assert dam.smoothing_radius == 0.1
    assert dam.spacing == 0
    assert dam.rest_distance == 0.05
    assert dam.time_step == 1 / 120
    assert dam.iterations == 4
    assert dam.gravity == (0, -9.81, 0)
    assert dam.kernel is pbf.Kernel.WENDLAND_C2
    assert dam.solver is pbf.Method.CHEBYSHEV
    assert dam.collide == pbf.Collide.AFTER_PREDICTION | pbf.Collide.IN_ITERATION
    assert dam.wall_velocity == (0,) * 6
    assert dam.pressure_grid == -1


def test_keywords_attributes_and_set_are_the_same(make):
    fluid = make(viscosity=0.25, gravity=(0, -1, 0), solver="jacobi", collide=["after_solve"])
    assert (fluid.viscosity, fluid.gravity) == (0.25, (0, -1, 0))
    assert fluid.solver is pbf.Method.JACOBI and fluid.collide is pbf.Collide.AFTER_SOLVE
    fluid.viscosity = 0.5
    assert fluid.viscosity == 0.5 and fluid.gravity == (0, -1, 0)
    fluid.set(viscosity=0.75, iterations=7, kernel=pbf.Kernel.POLY6_SPIKY)
    assert (fluid.viscosity, fluid.iterations) == (0.75, 7)
    fluid.params = pbf.Params(iterations=9)
    assert (fluid.viscosity, fluid.iterations) == (0, 9)


def test_a_set_that_is_refused_changes_nothing(dam):
    with pytest.raises(pbf.InvalidArgumentError, match="time_step is -1"):
        dam.set(viscosity=0.5, time_step=-1)
    assert dam.viscosity == 0


@pytest.mark.parametrize("name, value, words", [
    ("viscosity", math.nan, "viscosity is NaN"), ("viscosity", "much", "must be a number"),
    ("iterations", 0, "iterations is 0"), ("iterations", -3, "iterations is -3"),
    ("iterations", 2.5, "must be an integer"), ("gravity", 9.81, "a list of 3 numbers"),
    ("gravity", (0, 1), "a list of 3 numbers"), ("gravity", (0, "g", 0), r"gravity\[1\]"),
    ("kernel", "cubic", '"wendland_c2", "poly6_spiky"'), ("collide", ["never"], "after_solve"),
    ("collide", 0, "collide is 0"), ("wall_density", 2, "wall_density is 2"),
    ("domain_max", (0, 0, 0), "domain")])
def test_bad_values_raise_a_sentence(dam, name, value, words):
    before = dam.params
    with pytest.raises(pbf.InvalidArgumentError, match=words) as caught:
        setattr(dam, name, value)
    assert isinstance(caught.value, ValueError)
    assert dam.params == before


def test_misspelt_names_are_refused(dam):
    with pytest.raises(TypeError, match='did you mean "viscosity"'):
        pbf.Solver(viscocity=1)
    with pytest.raises(TypeError, match='did you mean "iterations"'):
        dam.set(iteration=3)
    with pytest.raises(AttributeError, match='did you mean "gravity"'):
        dam.gravtiy = (0, 0, 0)
    with pytest.raises(TypeError, match="no parameter"):
        pbf.Params().colour = 3
    dam.label = "mine"  # what is like no parameter is the caller's own
    assert dam.label == "mine"


def test_params_by_themselves():
    params = pbf.Params(viscosity=0.5)
    assert repr(params) == "Params(viscosity=0.5)"
    assert params != pbf.Params() and pbf.Params() == pbf.Params()
    for other in (copy.copy(params), copy.deepcopy(params), pickle.loads(pickle.dumps(params))):
        assert other == params
        other.viscosity = 1
        assert params.viscosity == 0.5
    with pytest.raises(pbf.InvalidArgumentError):
        params.update(viscosity=2, gravity=1)
    assert params.viscosity == 0.5


def test_params_are_a_copy(dam):
    dam.params.viscosity = 3
    assert dam.viscosity == 0


def test_vectors_can_not_be_changed_in_place(dam):
    with pytest.raises(TypeError):
        dam.gravity[1] = 0
