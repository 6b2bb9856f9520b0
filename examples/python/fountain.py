"""A fountain in a pool, a sea that holds its level, and an overflow: what comes and goes in each step.

    python examples/python/fountain.py      writes fountain.png
"""
# code: fountain
import pbf

fluid = pbf.Solver(capacity=9000, domain_max=(2, 1, 1))  # particles 0.05 apart
fluid.add_box((0, 0, 0), (2, 0.3, 1))
fluid.emitters = [pbf.DiscEmitter((1, 0.5, 0.5), velocity=(0, 3, 0), radius=0.1)]
fluid.reservoirs = [pbf.Reservoir((0.2, 0.5, 0.5), half_extents=(0.2, 0.5, 0.5), depth=0.3)]
fluid.drains = [pbf.BoxVolume((1.95, 0.6, 0.5), half_extents=(0.05, 0.25, 0.5))]
jet = pbf.BoxVolume((1, 0.75, 0.5), half_extents=(0.15, 0.25, 0.15))
for half_second in fluid.frames(4, steps=60):
    level = fluid.levels([(1.5, 0, 0.5)])[0]
    print(f"{fluid.time:.1f} s: level {level:.2f}, {len(fluid.find_in(jet))} in the jet, "
          f"{fluid.in_out.emitted} came, {fluid.in_out.drained} went")
fluid.save_picture("fountain.png")
# end
