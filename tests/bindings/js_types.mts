// Compiled, not run: what pbf.d.ts lets programs write, and what it refuses.
import { Batch, PbfError, Shape, Solver, constants, load, version, type ColliderFields } from "pbf";

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

export async function asked(): Promise<number> {
  const fluid = await Solver.create({ dimension: 2 });
  const rock = Shape.fromPoints({ dimension: 2, points: [0, 0, 1, 0, 0, 1], cell: 0.1 });
  fluid.setColliders([{ shape: rock, position: [0.5, 0.5], scale: 0.1 }, { shape: "plane" }]);
  const [first] = fluid.colliders;
  const { wet, densities }: { wet: Uint8Array; densities: Float64Array } = fluid.sample([0.5, 0.5], ["wet", "densities"]);
  const { velocities } = fluid.sampleOnGrid({ counts: [2, 2], origin: [0, 0], step: [1, 1] });
  const level: number = fluid.levels([0.5, 0.5])[0]! + fluid.castRays([0, 1], [0, -1]).distances[0]!;
  const filled: number = fluid.measure([{ shape: "sphere", radius: 0.1 }])[0]!.fraction + fluid.findIn({ shape: "box" }).length;
  fluid.setEmitters([{ shape: "disc", velocity: [0, -1], rate: 0.1 }]);
  fluid.setDrains(fluid.drains);
  fluid.setReservoirs([{ position: [0.5, 0.5], halfExtents: [0.5, 0.5], depth: 0.1 }]);
  fluid.setReservoirs(fluid.reservoirs);
  fluid.setDiffuse({ ...fluid.defaultDiffuse, capacity: 10 });
  fluid.addDiffuse([0.5, 0.5], null, [1]);
  fluid.shiftDiffuse([0, 0.1]);
  const { kinds, ids } = fluid.diffuseParticles;
  const drops: number = kinds[0]! + Number(ids[0]!) + fluid.diffuseInfo.spray + (fluid.diffuse?.buoyancy ?? 0);
  fluid.setDiffuse(null);
  fluid.setPhases([{}, { restDensity: 0.9 }]);
  fluid.setParticlePhases(new Uint32Array(1));
  const batch = new Batch({ worlds: 2, capacity: 10 });
  batch.addParticles([1, 1], new Float32Array(6));
  batch.step(3, [true, false]);
  batch.reset();
  const failure: string | undefined = batch.failures[0]?.message;
  return first!.position[0]! + wet[0]! + densities[0]! + velocities[0]! + level + filled + fluid.inOut.emitted + (failure?.length ?? 0)
    + drops + batch.world(1).count + batch.read("position")[0]! + rock.distance([0, 0]).distance + rock.info.volume;
}

// @ts-expect-error a field that was not asked for
export const unasked = (fluid: Solver) => fluid.sample([0, 0], ["wet"]).densities;
// @ts-expect-error no such opening
export const slot = (fluid: Solver) => fluid.setEmitters([{ shape: "slot" }]);
// @ts-expect-error only its functions make one
export const empty = () => new Shape();
// @ts-expect-error a parameter that there is not
void Solver.create({ params: { gravitation: [0, 0] } });
// @ts-expect-error no such shape
export const torus: ColliderFields = { shape: "torus" };
// @ts-expect-error threads are a number
void Solver.create({ threads: "all" });
// @ts-expect-error four dimensions
void Solver.create({ dimension: 4 });
