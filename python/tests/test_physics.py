"""Values that are known without the library."""
import numpy as np
import pytest

import pbf


def test_free_fall(make):
    """Symplectic Euler: after n steps a particle has fallen g dt² n (n + 1) / 2."""
    fluid = make([[0.5, 0.9, 0.5]], time_step=0.01, precision="float64")
    fluid.step(10)
    assert fluid.positions[0] == pytest.approx([0.5, 0.9 - 9.81 * 1e-4 * 55, 0.5], abs=1e-12)
    assert fluid.velocities[0] == pytest.approx([0, -0.981, 0], abs=1e-12)
    assert fluid.time == pytest.approx(0.1)
    assert fluid.steps_done == 10


def test_momentum_is_kept_without_gravity_and_walls(make):
    """Two balls meet: forces between particles come in pairs, so that momentum stays 0."""
    one = pbf.fill_ball((-0.3, 0.02, 0), 0.25, 0.05)
    fluid = make(dimension=3, capacity=2 * len(one), gravity=(0, 0, 0), precision="float64",
                 domain_min=(-5, -5, -5), domain_max=(5, 5, 5))
    fluid.add(one, (1, 0, 0))
    fluid.add(-one, (-1, 0, 0))
    before = fluid.stats.kinetic_energy
    fluid.step(60)
    assert before == pytest.approx(0.5)
    assert np.abs(fluid.velocities.sum(axis=0)).max() < 1e-9 * fluid.count
    assert fluid.stats.kinetic_energy < 0.9 * before  # they did meet


def test_hydrostatics(make):
    """Water at rest: p/rho0 = g times the depth."""
    fluid = make(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05), domain_max=(0.5, 1, 0.5),
                 time_step=1 / 240, iterations=8)
    fluid.step(960)
    height, pressure = fluid.positions[:, 1], fluid.pressures
    inside = (height > 0.1) & (height < 0.4)
    slope = np.polyfit(height[inside], pressure[inside], 1)[0]
    assert slope == pytest.approx(-9.81, rel=0.1)
    assert fluid.stats.density_mean == pytest.approx(1, abs=0.02)
    assert fluid.stats.speed_max < 0.2


def test_filled_at_rest_density(make):
    """Spacing³ is a particle's volume: a lattice has density 1 inside."""
    fluid = make(pbf.fill_box((0, 0, 0), (1, 1, 1), 0.05))
    x = fluid.positions
    inside = ((x > 0.2) & (x < 0.8)).all(axis=1)
    assert inside.sum() == 12**3
    assert fluid.densities[inside] == pytest.approx(1, abs=1e-5)


def test_stats_are_what_numpy_says(dam):
    dam.step(20)
    x, v, stats = dam.positions.astype(float), dam.velocities.astype(float), dam.stats
    assert stats.count == len(x) == 1000
    assert stats.center_of_mass == pytest.approx(tuple(x.mean(axis=0)), abs=1e-6)
    assert stats.momentum == pytest.approx(tuple(v.mean(axis=0)), abs=1e-6)
    assert stats.kinetic_energy == pytest.approx((v**2).sum(axis=1).mean() / 2, rel=1e-6)
    assert stats.position_min == pytest.approx(tuple(x.min(axis=0)), abs=1e-6)
    assert stats.speed_max == pytest.approx(np.sqrt((v**2).sum(axis=1)).max(), rel=1e-6)


def test_two_dimensions(make):
    fluid = make(pbf.fill_box((0, 0), (0.5, 0.5), 0.05), smoothing_radius=0.15, spacing=0.05)
    fluid.step(5)
    assert fluid.positions.shape == (100, 2)
    assert fluid.gravity == (0, -9.81)
    assert fluid.domain_max == (1, 1)
    fluid.gravity = (1, 0)
    assert fluid.params.gravity[:2] == (1, 0)


@pytest.mark.parametrize("seconds", [-1, float("nan"), float("inf"), 1e300, "long"])
def test_times_that_are_none(dam, seconds):
    with pytest.raises(pbf.InvalidArgumentError, match="seconds"):
        dam.run(seconds)
    assert dam.steps_done == 0


def test_same_bits_on_serial_and_threads():
    hashes = set()
    for backend in ("serial", "threads"):
        if not any(b.name == backend and b.available for b in pbf.backends()):
            pytest.skip(f"this build has no {backend}")
        with pbf.Solver(pbf.fill_box((0, 0, 0), (0.5, 0.5, 0.5), 0.05), backend=backend) as fluid:
            fluid.step(20)
            hashes.add(fluid.hash)
    assert len(hashes) == 1


def test_ways_to_step_give_the_same_bits(dam):
    start = dam.save()
    hashes = set()

    def one_by_one():
        for _ in range(12):
            dam.step()

    def begun():
        with dam.stepping(12):
            pass

    def frames():
        assert list(dam.frames(4, steps=3)) == [0, 1, 2, 3]

    for way in (lambda: dam.step(12), one_by_one, begun, frames, lambda: dam.run(steps=12),
                lambda: dam.run(seconds=0.1)):
        dam.load(start)
        way()
        assert dam.steps_done == 12
        hashes.add(dam.hash)
    assert len(hashes) == 1
