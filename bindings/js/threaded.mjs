// A larger dam break, with a thread for each processor where the page may have them.
/* code: threaded */
import { Solver, load } from "./pbf.mjs";

const { threads, why } = await load(undefined, { threads: 0 }); // before the first solver
console.log(why ? `one thread: ${why}` : `${threads} threads`);

const fluid = new Solver({ capacity: 30000, params: { domainMax: [3.2, 2.4, 1.25] } });
const positions = [];
for (let z = 0; z < 25; ++z)
  for (let y = 0; y < 40; ++y)
    for (let x = 0; x < 30; ++x) positions.push(0.025 + 0.05 * x, 0.025 + 0.05 * y, 0.025 + 0.05 * z);
fluid.addParticles(positions);
const begin = performance.now();
fluid.step(20);
console.log(`${((performance.now() - begin) / 20).toFixed(1)} ms a step`);
/* end */
