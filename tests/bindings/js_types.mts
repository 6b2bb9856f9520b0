// Compiled, not run: what pbf.d.ts lets programs write, and what it refuses.
import { PbfError, Solver, constants, load, version, type ColliderFields } from "pbf";

export async function used(): Promise<number> {
  await load(new Uint8Array(8));
  const fluid = await Solver.create({
    dimension: 2,
    precision: constants.FLOAT32,
    capacity: 100,
    log: (level, sentence) => console.log(level, sentence.length),
    params: { domainMax: [1, 1], gravity: new Float64Array([0, -1]), kernel: constants.KERNEL_POLY6_SPIKY },
  });
  const first: number = fluid.addParticles([0.5, 0.5], new Float32Array(2));
  const ball: ColliderFields = { shape: "sphere", position: [1, 0.5], radius: 0.1 };
  fluid.setColliders([ball]);
  fluid.moveColliders([{ ...ball, position: [0, 0] }], 1 / 60);
  fluid.setParams({ viscosity: 0.1, loads: 1 });
  const pushed: number = fluid.colliderLoads()[0]!.impulseSum[1]! + fluid.wallLoads()[constants.WALL_Y_MIN]!.penetration;
  fluid.setAccelerations(new Float32Array(2));
  fluid.setAccelerations(null);
  const speed: number = fluid.map("velocity", ({ components, stride }) => components[0]![stride] ?? 0);
  try {
    fluid.step();
  } catch (error) {
    if (error instanceof PbfError) console.log(error.status === constants.ERROR_CAPACITY, error.code.length);
  }
  fluid[Symbol.dispose]();
  const stage: string = fluid.timings.stages[0]!.name;
  const state: Uint8Array = fluid.save();
  fluid.load(state);
  return first + speed + pushed + fluid.positions.length + stage.length + version().length + fluid.stats.centerOfMass[0]! + fluid.colliders.length;
}

// @ts-expect-error a parameter that there is not
void Solver.create({ params: { gravitation: [0, 0] } });
// @ts-expect-error no such shape
export const torus: ColliderFields = { shape: "torus" };
// @ts-expect-error four dimensions
void Solver.create({ dimension: 4 });
