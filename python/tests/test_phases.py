"""Several fluids in one solver."""
import numpy as np
import pytest

import pbf


def test_oil_and_water(make):
    fluid = make(pbf.fill_box((0, 0, 0), (0.4, 0.4, 0.4), 0.05), domain_max=(0.4, 1, 0.4))
    assert fluid.phases == [] and not fluid.particle_phases.any()
    oil = (fluid.positions[:, 1] < 0.2) & (fluid.positions[:, 0] < 0.2)
    fluid.phases = [pbf.Phase(), pbf.Phase(rest_density=0.5, viscosity=0.5, user=7)]
    fluid.particle_phases = oil.astype(int)
    assert fluid.phases[1] == pbf.Phase(0.5, 0.5, 7)
    assert (fluid.particle_phases == oil).all()
    fluid.run(seconds=2)
    heights = fluid.positions[:, 1]
    assert heights[oil].mean() > heights[~oil].mean() + 0.05
    fluid.set_particle_phases(np.zeros(len(fluid), dtype=np.uint32))
    fluid.phases = []
    assert fluid.phases == []


def test_refusals(make):
    fluid = make(capacity=100)
    with pytest.raises(pbf.InvalidArgumentError, match=r"phases\[0\]"):
        fluid.phases = [1]
    with pytest.raises(pbf.InvalidArgumentError, match="rest_density"):
        fluid.phases = [pbf.Phase(rest_density=0)]
    assert fluid.phases == []
