"""Emitters and drains."""
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


def test_refusals(make):
    fluid = make(capacity=100)
    with pytest.raises(pbf.InvalidArgumentError, match="inside the domain"):
        fluid.emitters = pbf.DiscEmitter((3, 3, 3), radius=0.1)
    with pytest.raises(pbf.InvalidArgumentError, match=r"emitters\[0\]"):
        fluid.emitters = [pbf.Sphere()]
    assert fluid.emitters == [] and fluid.in_out.emitted == 0
