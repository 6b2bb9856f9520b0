// A tap pours water over a stone; after three seconds: how much has come and gone, how high it stands, what it weighs.
/* code: pour */
import { Shape, Solver, constants } from "./pbf.mjs";

const fluid = await Solver.create({ capacity: 3000, params: { loads: 1 } }); // loads: what the water does to solids

const points = [0.2, 0, 0, -0.2, 0, 0, 0, 0.2, 0, 0, -0.2, 0, 0, 0, 0.2, 0, 0, -0.2];
const stone = Shape.fromPoints({ dimension: 3, points, cell: 0.025 });
fluid.setColliders([{ shape: stone, position: [0.5, 0.1, 0.5] }]);
fluid.setEmitters([{ shape: "disc", position: [0.5, 0.9, 0.5], velocity: [0, -1, 0], radius: 0.15 }]);
fluid.setDrains([{ shape: "box", position: [0.95, 0.5, 0.5], halfExtents: [0.05, 0.3, 0.5] }]); // an overflow at 0.2
const { timeStep } = fluid.params;
fluid.step(Math.floor(2.5 / timeStep));
fluid.wallLoads(); // begins the sums anew
fluid.step(Math.floor(0.5 / timeStep));

const { emitted, drained } = fluid.inOut;
const [level] = fluid.levels([0.1, 0, 0.1]);
const floor = fluid.wallLoads()[constants.WALL_Y_MIN];
const weight = (-1000 * floor.impulseSum[1]) / floor.timeSum; // water has 1000 kg/m³
const { densities } = fluid.sample([0.1, 0.1, 0.1], ["densities"]);
console.log(`${emitted} came, ${drained} went, ${level.toFixed(2)} m high, ${weight.toFixed(0)} N on the floor, density ${densities[0].toFixed(1)}`);
/* end */
