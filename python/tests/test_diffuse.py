"""Spray, foam and air bubbles."""
import numpy as np
import pytest

import pbf


def test_a_dam_makes_foam(make):
    block = pbf.fill_box((0, 0, 0), (0.5, 0.8, 0.4), 0.05)
    fluid, plain = make(block, domain_max=(1.2, 1.2, 0.4)), make(block, domain_max=(1.2, 1.2, 0.4))
    assert fluid.diffuse is None and len(fluid.diffuse_particles.ids) == 0
    desc = fluid.default_diffuse()
    desc.capacity, desc.energy_min = 200, 0.2
    fluid.diffuse = desc
    assert fluid.diffuse == desc
    fluid.run(seconds=0.6)
    plain.run(seconds=0.6)
    assert np.array_equal(fluid.positions, plain.positions)
    info, foam = fluid.diffuse_info, fluid.diffuse_particles
    assert info.count == len(foam.ids) <= 200 < info.generated
    assert info.generated == info.count + info.expired + info.recycled
    assert (np.bincount(foam.kinds, minlength=3) == (info.spray, info.foam, info.bubbles)).all()
    assert (np.diff(foam.ids.astype(int)) > 0).all() and (foam.lives > 0).all()
    assert foam.positions.shape == foam.velocities.shape == (info.count, 3)
    fluid.diffuse = None
    assert fluid.diffuse is None


def test_spray_falls(make):
    fluid = make(capacity=100)
    fluid.diffuse = fluid.default_diffuse()
    fluid.add_diffuse([[0.5, 0.9, 0.5], [0.25, 0.9, 0.5]], 10, velocities=[[0, 0, 0], [1, 0, 0]])
    fluid.shift_diffuse((0, 0.05, 0))
    time = 12 * fluid.params.time_step
    fluid.step(12)
    fallen = 0.95 + 0.5 * fluid.params.gravity[1] * time ** 2
    foam = fluid.diffuse_particles
    right = np.array([[0.5, fallen, 0.5], [0.25 + time, fallen, 0.5]])
    assert foam.positions == pytest.approx(right, abs=1e-6)
    assert foam.ages == pytest.approx(time) and foam.lives == pytest.approx(10 - time)


def test_refusals(make):
    fluid = make(capacity=100)
    with pytest.raises(pbf.StateError, match="pbf_set_diffuse"):
        fluid.add_diffuse([[0.5, 0.5, 0.5]], 1)
    with pytest.raises(pbf.InvalidArgumentError, match="diffuse is 7"):
        fluid.diffuse = 7
    desc = fluid.default_diffuse()
    desc.energy_max = 0.0
    with pytest.raises(pbf.InvalidArgumentError, match="energy_max"):
        fluid.diffuse = desc
    assert fluid.diffuse is None
    fluid.diffuse = fluid.default_diffuse()
    with pytest.raises(pbf.InvalidArgumentError, match="lives has the shape"):
        fluid.add_diffuse([[0.5, 0.5, 0.5]], [1, 2])
    for lives in ("long", [10**400], [1j]):
        with pytest.raises(pbf.InvalidArgumentError, match="lives holds .*must hold real numbers"):
            fluid.add_diffuse([[0.5, 0.5, 0.5]], lives)
    with pytest.raises(pbf.InvalidArgumentError, match="way"):
        fluid.shift_diffuse((1, 2))
