"""Emitters, drains and reservoirs."""
import pytest

import pbf


def test_a_stream(make):
    fluid = make(capacity=2000, gravity=(0, 0, 0), domain_max=(1, 2, 1))
    tap = pbf.DiscEmitter((0.5, 1.5, 0.5), velocity=(0, -2, 0), rate=0.01, radius=0.1, jitter=0.1,
                          seed=7, lifetime=3)
    fluid.emitters = tap
    fluid.drains = [pbf.BoxVolume((0.5, 0.5, 0.5), half_extents=(1, 0.5, 1))]
    assert fluid.emitters == [tap] and fluid.drains[0].half_extents == (1, 0.5, 1)
    fluid.run(seconds=1)
    counts = fluid.in_out
    assert counts.emitted == pytest.approx(0.01 / 0.05**3, abs=1)
    assert counts.emitted - counts.drained == fluid.count and counts.drained > 0
    tap.rate = 0
    fluid.emitters = [tap, pbf.RectangleEmitter((0.2, 1, 0.2), half_width=0.1, half_height=0.1)]
    assert fluid.in_out.emitters == 2
    fluid.emitters, fluid.drains = [], []
    assert fluid.emitters == [] and fluid.drains == []


def test_a_reservoir(make):
    fluid = make(capacity=2000, gravity=(0, 0, 0))
    pool = pbf.Reservoir((0.5, 0.5, 0.5), half_extents=(0.5, 0.5, 0.5), depth=0.2, pressure=1)
    fluid.reservoirs = pool
    assert fluid.reservoirs == [pool]
    fluid.step(1)
    assert fluid.count == 20 * 4 * 20 == fluid.reservoirs[0].added == fluid.in_out.emitted
    pool.depth = 0.1
    fluid.reservoirs = [pool]
    fluid.step(1)
    assert fluid.count == 20 * 2 * 20 and fluid.reservoirs[0].removed == 20 * 2 * 20
    with pytest.raises(pbf.InvalidArgumentError, match=r"reservoirs\[0\]\.depth is 2"):
        fluid.reservoirs = pbf.Reservoir((0.5, 0.5, 0.5), half_extents=(0.5, 0.5, 0.5), depth=2)
    with pytest.raises(pbf.InvalidArgumentError, match="it must be a Reservoir"):
        fluid.reservoirs = [pbf.Sphere()]
    fluid.reservoirs = []
    assert fluid.reservoirs == []


def test_a_scene_with_reservoirs():
    scene = pbf.load_scene("validation/reservoir-level")
    fluid = scene.solver(backend="serial")
    fluid.step(2)
    assert fluid.reservoirs[0].depth == scene.reservoirs[0].depth and fluid.reservoirs[0].added > 0


def test_refusals(make):
    fluid = make(capacity=100)
    with pytest.raises(pbf.InvalidArgumentError, match="inside the domain"):
        fluid.emitters = pbf.DiscEmitter((3, 3, 3), radius=0.1)
    with pytest.raises(pbf.InvalidArgumentError, match=r"emitters\[0\]"):
        fluid.emitters = [pbf.Sphere()]
    assert fluid.emitters == [] and fluid.in_out.emitted == 0
