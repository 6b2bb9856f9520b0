// A dam break: 4,000 particles fall and spread, the front is printed ten times a second.
/* code: splash */
import { Solver } from "./pbf.mjs";

const fluid = await Solver.create({
  capacity: 4000,
  params: { domainMax: [2, 1, 1] }, // particles 0.05 apart
});
const positions = [];
for (let z = 0; z < 20; ++z)
  for (let y = 0; y < 20; ++y)
    for (let x = 0; x < 10; ++x) positions.push(0.025 + 0.05 * x, 0.025 + 0.05 * y, 0.025 + 0.05 * z);
fluid.addParticles(positions);

const steps = Math.round(0.1 / fluid.params.timeStep);
for (let frame = 1; frame <= 10; ++frame) {
  fluid.step(steps);
  console.log(`${(0.1 * frame).toFixed(1)} s: front at ${fluid.stats.positionMax[0].toFixed(2)} m`);
}
/* end */
