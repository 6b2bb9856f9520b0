// The package for browsers and node, by node's own test runner: PBF_JS=build/wasm/js node --test tests/bindings
// PBF_THREADS=4 has it load the module with threads.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker } from "node:worker_threads";

const folder = resolve(process.env.PBF_JS ?? "build/wasm/js");
const threads = Number(process.env.PBF_THREADS ?? 1);
const { Batch, PbfError, Shape, Solver, constants, load, version } = await import(pathToFileURL(`${folder}/pbf.mjs`));

test("nothing is made before the module is loaded", async () => {
  assert.throws(() => new Solver(), { message: "the module is not loaded; await load() first, or Solver.create()" });
  await assert.rejects(load(new Uint8Array([1, 2, 3])), WebAssembly.CompileError);
  assert.deepEqual(await load(readFileSync(`${folder}/pbf.wasm`), { threads }), { threads });
  const header = readFileSync(new URL("../../include/pbf/pbf.h", import.meta.url), "utf8");
  const parts = ["MAJOR", "MINOR", "PATCH"].map((part) => header.match(new RegExp(`PBF_VERSION_${part} (\\d+)`))[1]);
  assert.equal(version(), parts.join("."));
});

function block(counts, spacing) {
  const positions = [];
  const at = counts.map(() => 0);
  for (let n = counts.reduce((a, b) => a * b); n > 0; --n) {
    positions.push(...at.map((k) => (k + 0.5) * spacing));
    for (let axis = 0; axis < counts.length && ++at[axis] === counts[axis]; ++axis) at[axis] = 0;
  }
  return positions;
}

const tank = { spacing: 0.1, smoothingRadius: 0.2, domainMax: [2, 1, 1] };

async function fluid(options = {}) {
  const solver = await Solver.create({ capacity: 1000, params: tank, ...options });
  solver.addParticles(block([6, 6, 6], 0.1));
  return solver;
}

// The tank of tests/same_bits/scenes.c: every build has its hash.
test("a pinned scene has its hash", async () => {
  const pinned = readFileSync(new URL("../same_bits/pinned.txt", import.meta.url), "utf8");
  let state = 1n;
  const drawn = () => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number(state >> 11n) / 2 ** 53;
  };
  const positions = [];
  for (let y = 0; y < 24; ++y)
    for (let x = 0; x < 16; ++x)
      for (const cell of [x, y]) positions.push(0.05 * (cell + 0.5 + 0.1 * (drawn() - 0.5)));
  const solver = await Solver.create({
    dimension: 2,
    capacity: 16 * 24,
    params: { spacing: 0.05, domainMax: [1.6, 1.6, 0.4], solver: constants.SOLVER_JACOBI, wallDensity: 0 },
  });
  solver.addParticles(positions);
  solver.step(20);
  assert.match(pinned, new RegExp(`^2d-f32 jacobi wendland +${solver.hash}$`, "m"));
  solver.destroy();
});

test("a block falls", async () => {
  const solver = await fluid();
  const before = solver.stats.centerOfMass;
  solver.step(20);
  const { centerOfMass, count } = solver.stats;
  assert.equal(count, 216);
  assert.ok(centerOfMass[0] > before[0], "it spreads");
  assert.equal(solver.info.step, 20);
  assert.ok(Math.abs(solver.info.time - 20 * solver.params.timeStep) < 1e-12);
  solver.destroy();
});

test("fields are read, set, and mapped without a copy", async () => {
  const solver = await fluid();
  solver.step(3);
  const positions = solver.positions.slice(), ids = solver.ids.slice();
  assert.ok(positions instanceof Float32Array);
  assert.equal(positions.length, 3 * 216);
  assert.equal(solver.velocities.length, 3 * 216);
  assert.equal(solver.densities.length, 216);
  assert.equal(solver.pressures.length, 216);
  solver.map("position", ({ components, stride, count, ids: mapped }) => {
    assert.equal(count, 216);
    const rows = new Map(Array.from(ids, (id, row) => [id, row]));
    for (let i = 0; i < count; ++i)
      for (let c = 0; c < 3; ++c) assert.equal(components[c][i * stride], positions[3 * rows.get(mapped[i]) + c]);
    assert.throws(() => solver.step(), { code: "PBF_ERROR_STATE" });
  });
  solver.setPositions([1.5, 0.5, 0.25], 7);
  assert.deepEqual(Array.from(solver.positions.slice(21, 24)), [1.5, 0.5, 0.25]);
  solver.setVelocities([0.5, 0, 0]);
  assert.equal(solver.velocities[0], 0.5);
  solver.destroy();
});

test("particles come and go", async () => {
  const solver = await fluid();
  assert.equal(solver.addParticles([1.5, 0.5, 0.5], [0, 1, 0]), 216);
  assert.deepEqual(Array.from(solver.findInBox([1.4, 0, 0], [1.6, 1, 1])), [216]);
  assert.equal(solver.removeInBox([1.4, 0, 0], [1.6, 1, 1]), 1);
  solver.removeParticles([0, 5]);
  assert.equal(solver.count, 214);
  solver.destroy();
});

test("what changes of parameters is set, the rest stays", async () => {
  const solver = await fluid();
  const before = solver.params;
  solver.setParams({ gravity: [0, -1], viscosity: 0.1, iterations: 7, shearStressCorrection: 0 });
  assert.deepEqual(solver.params, {
    ...before, gravity: [0, -1, 0], viscosity: 0.1, iterations: 7, shearStressCorrection: 0,
  });
  solver.destroy();
});

test("errors are the library's sentences, and the solver stays as it was", async () => {
  const solver = await fluid();
  const { hash } = solver;
  const throws = (call, code, message) =>
    assert.throws(call, (error) => error instanceof PbfError && error.code === code && message.test(error.message));
  throws(() => solver.addParticles(new Float32Array(30000)), "PBF_ERROR_CAPACITY", /^count is 10000; .*capacity is 1000$/);
  throws(() => solver.setParams({ gravity: [NaN] }), "PBF_ERROR_INVALID_ARGUMENT", /gravity\[0\] is NaN/);
  throws(() => solver.setParams({ gravitation: 1 }), "PBF_ERROR_INVALID_ARGUMENT", /^params has no gravitation; it has kernel, /);
  throws(() => solver.setParams({ iterations: 1.5 }), "PBF_ERROR_INVALID_ARGUMENT", /^params.iterations is 1.5; /);
  throws(() => solver.setParams({ iterations: -1 }), "PBF_ERROR_INVALID_ARGUMENT", /^params.iterations is -1; /);
  throws(() => solver.setParams({ gravity: [1, 2, 3, 4] }), "PBF_ERROR_INVALID_ARGUMENT", /^params.gravity has 4 numbers; /);
  throws(() => solver.addParticles([1, 1, 1, 2, 2, 2], [0, 0, 0]), "PBF_ERROR_INVALID_ARGUMENT", /^velocities has 1 rows, positions 2$/);
  throws(() => solver.addParticles([1, 2]), "PBF_ERROR_INVALID_ARGUMENT", /^positions has 2 numbers, no multiple of 3$/);
  throws(() => solver.setColliders([{ shape: "torus" }]), "PBF_ERROR_INVALID_ARGUMENT", /^colliders\[0\].shape is torus; /);
  throws(() => solver.setParams({ gravity: 3 }), "PBF_ERROR_INVALID_ARGUMENT", /^params.gravity is 3; it must be an array/);
  throws(() => solver.step(-1), "PBF_ERROR_INVALID_ARGUMENT", /^steps is -1; it must be a whole number of 32 bits$/);
  throws(() => solver.step("2"), "PBF_ERROR_INVALID_ARGUMENT", /^steps is 2; it must be a number$/);
  throws(() => solver.setPositions([1, 1, 1], -1), "PBF_ERROR_INVALID_ARGUMENT", /^first is -1; /);
  throws(() => solver.map("colour", () => {}), "PBF_ERROR_INVALID_ARGUMENT", /^field is colour; /);
  assert.equal(solver.hash, hash);
  await assert.rejects(Solver.create({ dimension: 4 }), { code: "PBF_ERROR_INVALID_ARGUMENT", message: /dimension is 4/ });
  await assert.rejects(Solver.create({ thread: 2 }), { message: /^options has no thread; it has dimension, .* threads, / });
  await assert.rejects(Solver.create({ log: 3 }), { message: "options.log is 3; it must be a function" });
  await assert.rejects(Solver.create({ isa: "avx2" }), { code: "PBF_ERROR_UNAVAILABLE" });
  solver.destroy();
});

test("colliders are set, moved and read", async () => {
  const solver = await fluid();
  const ball = { shape: "sphere", position: [1.5, 0.5, 0.5], radius: 0.2 };
  solver.setColliders([ball, { shape: "plane", axis: [0, 1, 0] }]);
  solver.moveColliders([{ ...ball, position: [1, 0.5, 0.5] }, { shape: "plane" }], 4 * solver.params.timeStep);
  solver.step(2);
  const [moved, plane] = solver.colliders;
  assert.equal(moved.shape, "sphere");
  assert.ok(Math.abs(moved.position[0] - 1.25) < 1e-12);
  assert.equal(plane.shape, "plane");
  solver.setColliders([]);
  assert.deepEqual(solver.colliders, []);
  solver.destroy();
});

// What walls and colliders have had is the momentum that gravity gave and the fluid has not.
test("loads are the momentum that is gone", async () => {
  const solver = await Solver.create({ capacity: 2, params: { loads: 1 } });
  assert.deepEqual(solver.colliderLoads(), []);
  solver.addParticles([0.5, 0.06, 0.5, 0.56, 0.06, 0.5]);
  solver.setColliders([{ shape: "sphere", position: [0.9, 0.9, 0.9], radius: 0.05 }]);
  solver.step(16);
  const [far] = solver.colliderLoads(), walls = solver.wallLoads();
  assert.equal(walls.length, 6);
  const { smoothingRadius, timeStep, gravity } = solver.params, v = solver.velocities;
  const volume = (smoothingRadius / 2) ** 3, floor = walls[constants.WALL_Y_MIN];
  const gone = volume * (2 * gravity[1] * 16 * timeStep - v[1] - v[4]);
  assert.ok(gone < -0.5 * volume);
  assert.ok(Math.abs(floor.impulseSum[1] / gone - 1) < 1e-5);
  assert.ok(Math.abs(floor.timeSum - 16 * timeStep) < 1e-12);
  assert.equal(far.contacts, 0);
  assert.deepEqual(far.impulseSum, [0, 0, 0]);
  solver.setParams({ loads: 0 });
  assert.throws(() => solver.wallLoads(), { code: "PBF_ERROR_STATE", message: /loads/ });
  solver.destroy();
});

test("accelerations hold up", async () => {
  const solver = await Solver.create({ capacity: 2 });
  solver.addParticles([0.5, 0.5, 0.5, 0.7, 0.5, 0.5]);
  solver.setAccelerations([0, 9.81, 0], 1);
  solver.step(12);
  assert.ok(Math.abs(solver.velocities[1] + 0.981) < 1e-4);
  assert.ok(Math.abs(solver.velocities[4]) < 1e-6);
  solver.setAccelerations(null);
  solver.step(12);
  assert.ok(Math.abs(solver.velocities[4] + 0.981) < 1e-4);
  solver.destroy();
});

test("a state is saved and loaded", async () => {
  const solver = await fluid(), other = await Solver.create({ capacity: 1000 });
  solver.step(5);
  other.load(solver.save());
  solver.step(5);
  other.step(5);
  assert.equal(other.hash, solver.hash);
  assert.throws(() => other.load(new Uint8Array(40)), { code: "PBF_ERROR_DATA" });
  solver.destroy();
  other.destroy();
});

test("a log hears of long steps, and what it throws reaches the caller", async () => {
  const heard = [];
  const solver = await fluid({ log: (level, sentence) => heard.push([level, sentence]) });
  solver.setParams({ timeStep: 0.5 });
  solver.step();
  assert.ok(heard.some(([level, sentence]) => level === constants.LOG_WARNING && /time_step/.test(sentence)), String(heard));
  solver.destroy();
  const other = await fluid({ log: () => { throw new RangeError("of the log"); } });
  other.setParams({ timeStep: 0.5 });
  assert.throws(() => other.step(), { name: "RangeError", message: "of the log" });
  other.step();
  other.destroy();
});

test("memory is given back", async () => {
  const once = async () => {
    const solver = await Solver.create({ capacity: 20000, params: { ...tank, domainMax: [4, 4, 4] } });
    solver.addParticles(many);
    solver.positions;
    solver.destroy();
  };
  const many = block([25, 25, 30], 0.1);
  for (let k = 0; k < 3; ++k) await once();
  const sized = await fluid();
  const bytes = sized.positions.buffer.byteLength;
  sized.destroy();
  for (let k = 0; k < 400; ++k) await once();
  const after = await fluid();
  assert.equal(after.positions.buffer.byteLength, bytes);
  after.destroy();
});

test("memory grows, and arrays read afterwards are of the new memory", async () => {
  const solver = await fluid();
  const first = solver.positions[0];
  const others = [];
  for (let k = 0; k < 4; ++k) {
    others.push(await Solver.create({ capacity: 200000, params: { ...tank, domainMax: [20, 20, 20] } }));
    others[k].addParticles(block([50, 50, 40], 0.1));
  }
  assert.equal(solver.positions[0], first);
  const large = await Solver.create({ capacity: 200000, params: { ...tank, domainMax: [20, 20, 20] } });
  large.addParticles(others[0].positions); // for which memory grows, and the view ends
  assert.equal(large.positions[2], others[0].positions[2]);
  others.push(large);
  others.forEach((other) => other.destroy());
  solver.step();
  assert.equal(solver.count, 216);
  solver.destroy();
});

test("what is destroyed says so", async () => {
  const solver = await fluid();
  solver[Symbol.dispose ?? Symbol.for("Symbol.dispose")]();
  solver.destroy();
  assert.throws(() => solver.step(), { code: "PBF_ERROR_INVALID_ARGUMENT", message: "the solver is destroyed" });
  assert.throws(() => solver.positions, { message: "the solver is destroyed" });
});

test("both instruction sets that there are have the same bits", async () => {
  const hashes = new Set();
  for (const isa of ["scalar", "simd128"]) {
    let solver;
    try {
      solver = await fluid({ isa });
    } catch (error) {
      assert.equal(error.code, "PBF_ERROR_UNAVAILABLE"); // built without it
      continue;
    }
    solver.step(10);
    assert.match(solver.info.deviceName, new RegExp(isa));
    hashes.add(solver.hash);
    solver.destroy();
  }
  assert.equal(hashes.size, 1);
});

test("the programs of all languages print what they print in the others", () => {
  const printed = execFileSync(process.execPath, [`${folder}/splash.mjs`], { encoding: "utf8" });
  assert.match(printed, /\n1\.0 s: front at 1\.99 m\n$/);
  const poured = execFileSync(process.execPath, [`${folder}/pour.mjs`], { encoding: "utf8" });
  const page = readFileSync(new URL("../../docs/bindings.md", import.meta.url), "utf8");
  assert.equal(poured, `${page.match(/`(\d+ came, .*)`/)[1]}\n`);
});

test("a worker has a module of its own, and the same bits", async () => {
  const solver = await fluid();
  solver.step(10);
  const source = `
    import { parentPort } from "node:worker_threads";
    const { Solver } = await import(${JSON.stringify(pathToFileURL(`${folder}/pbf.mjs`).href)});
    const solver = await Solver.create({ capacity: 1000, params: ${JSON.stringify(tank)} });
    solver.addParticles(${JSON.stringify(block([6, 6, 6], 0.1))});
    solver.step(10);
    const positions = solver.positions.slice();
    parentPort.postMessage({ hash: solver.hash, positions }, [positions.buffer]);`;
  const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(source)}`));
  const { hash, positions } = await new Promise((done, failed) => worker.once("message", done).once("error", failed));
  await worker.terminate();
  assert.equal(hash, solver.hash);
  assert.deepEqual(positions, solver.positions.slice());
  solver.destroy();
});

// Where the stack is full a call ends wherever it is; with it in a worker, since nothing goes on in that module.
test("what the engine leaves halfway is not gone on with", { skip: threads !== 1 }, async () => {
  const source = `
    import { parentPort } from "node:worker_threads";
    import { Solver } from ${JSON.stringify(pathToFileURL(`${folder}/pbf.mjs`).href)};
    const solver = await Solver.create({ capacity: 10 }), other = await Solver.create({ capacity: 10 });
    solver.addParticles([0.5, 0.5, 0.5]);
    const deeper = () => { solver.step(); deeper(); };
    const told = [];
    for (let k = 0; k < 100 && !told.includes("PBF_ERROR_STATE"); ++k) {
      try { deeper(); } catch (error) { told.push(error.code ?? error.constructor.name); }
      try { other.count; } catch (error) { told.push(error.code); }
    }
    solver.destroy();
    other.destroy();
    parentPort.postMessage(told);`;
  const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(source)}`), { resourceLimits: { stackSizeMb: 1 } });
  const told = await new Promise((done, failed) => worker.once("message", done).once("error", failed));
  await worker.terminate();
  assert.deepEqual([...new Set(told)], ["RangeError", "PBF_ERROR_STATE"]);
});

// ---- Shapes, queries, emitters, phases, loads and batches, against what geometry and mechanics say they must be

const D = 0.05; // the spacing by default

const near = (got, wanted, bound) => assert.ok(Math.abs(got - wanted) <= bound, `${got} is not ${wanted}`);
const refused = (call, message, code = "PBF_ERROR_INVALID_ARGUMENT") =>
  assert.throws(call, (error) => {
    assert.ok(error instanceof PbfError, String(error));
    assert.equal(error.code, code);
    assert.match(error.message, message);
    return true;
  });

test("whole numbers and corners are no others", async () => {
  const solver = await lattice();
  for (const ids of [[1.5], [-1], [2 ** 32], ["1"], [undefined], [, 1]]) refused(() => solver.removeParticles(ids), /^ids\[0\] is /);
  refused(() => solver.setParticlePhases([0.5]), /^phases\[0\] is 0.5/);
  refused(() => solver.findInBox([0], [1, 1, 1]), /^lower has 1 numbers; it must have 3$/);
  refused(() => solver.removeInBox([0, 0, 0], [1, 1]), /^upper has 2 numbers; it must have 3$/);
  solver.removeParticles([1]);
  solver.removeParticles(new Uint32Array([2]));
  assert.equal(solver.count, 998);
  solver.destroy();
});

/** A lattice of 10 by 10 by 10 particles, at rest, in a corner of the tank. */
async function lattice() {
  const solver = await Solver.create({ capacity: 1000 });
  solver.addParticles(block([10, 10, 10], D));
  return solver;
}

/** Half extents 0.2, 0.1 and 0.3, by its corners. */
function brick() {
  const signs = [-1, 1], points = signs.flatMap((x) => signs.flatMap((y) => signs.flatMap((z) => [0.2 * x, 0.1 * y, 0.3 * z])));
  return Shape.fromPoints({ dimension: 3, points, cell: 0.025 });
}

test("shapes are as far as their faces", async () => {
  await load();
  const shape = brick();
  near(shape.info.volume, 0.2 * 0.1 * 0.3 * 8, 1e-3);
  const { distance, normal } = shape.distance([0.24, 0, 0]);
  near(distance, 0.04, 1e-3);
  near(normal[0], 1, 1e-3);
  near(shape.distance([0, 0.06, 0]).distance, -0.04, 1e-3);
  const vertices = [0, 0, 1, 0, 1, 1, 0, 1];
  const mesh = Shape.fromMesh({ dimension: 2, vertices, faces: [0, 1, 1, 2, 2, 3, 3, 0], cell: 0.05 });
  near(mesh.info.volume, 1, 5e-3);
  near(mesh.distance([1.08, 0.5]).distance, 0.08, 1e-3);
  const shell = Shape.fromMesh({ dimension: 2, vertices: [0, 0, 1, 0], faces: [0, 1], cell: 0.05, thickness: 0.2 });
  near(shell.distance([0.5, 0.18]).distance, 0.08, 1e-3);
  const hill = Shape.fromHeights({ count: [3], heights: [0.5, 0.5, 0.5], spacing: 0.5, base: -0.5, cell: 0.05 });
  near(hill.distance([0.5, 0.58]).distance, 0.08, 1e-3);
  const values = Float32Array.from({ length: 441 }, (_, i) => 0.05 * Math.hypot((i % 21) - 10, Math.floor(i / 21) - 10) - 0.3);
  const disc = Shape.fromGrid({ nodes: [21, 21], origin: [-0.5, -0.5], cell: 0.05, values });
  near(disc.distance([0.4, 0]).distance, 0.1, 2e-3);
  for (const one of [shape, mesh, shell, hill, disc]) one.destroy();
});

test("shapes come back from bytes", async () => {
  await load();
  const shape = brick(), again = Shape.load(shape.save()), { nodes, origin, hash } = shape.info;
  assert.equal(again.info.hash, hash);
  assert.equal(again.dimension, 3);
  assert.equal(again.values.length, nodes[0] * nodes[1] * nodes[2]);
  near(again.values[0], Math.hypot(origin[0] + 0.2, origin[1] + 0.1, origin[2] + 0.3), 1e-3);
  refused(() => Shape.load(new Uint8Array(100)), /does not begin as one/, "PBF_ERROR_DATA");
  refused(() => Shape.load("cup.pbfshape"), /must be a Uint8Array/);
});

test("shapes live while something has them", async () => {
  const solver = await lattice(), shape = brick();
  solver.setColliders([{ shape, position: [0.7, 0.9, 0.7] }, { shape: "plane", axis: [0, 1, 0] }]);
  assert.equal(shape.info.references, 2);
  shape.destroy();
  shape.destroy();
  refused(() => shape.info, /^the shape is destroyed$/);
  refused(() => solver.setColliders([{ shape, position: [0, 0, 0] }]), /^the shape is destroyed$/);
  solver.step();
  const back = solver.colliders;
  near(back[0].position[1], 0.9, 1e-12);
  assert.equal(back[1].shape, "plane");
  solver.setColliders(back);
  solver.destroy();
  assert.equal(back[0].shape.info.references, 1);
  back[0].shape.destroy();
});

test("what is no shape is refused", async () => {
  await load();
  refused(() => new Shape(), /fromPoints/);
  refused(() => Shape.fromPoints({ dimension: 3, points: [0, 0, 0, 1, 0, 0, 0, 1, 0], cell: 0.1 }), /point_count is 3/);
  refused(() => Shape.fromPoints({ dimension: 3, points: new Float64Array(8), cell: 0.1 }), /^hull\.points has 8 numbers/);
  refused(() => Shape.fromPoints({ dimension: 4, points: [], cell: 0.1 }), /^hull\.dimension is 4/);
  refused(() => Shape.fromPoints({ dimension: 3, cell: 0.1 }), /^hull\.points is undefined/);
  refused(() => Shape.fromPoints({ dimension: 3, points: [], sell: 0.1 }), /^hull has no sell; it has dimension, points, cell$/);
  refused(() => Shape.fromGrid({ nodes: [3, 3], origin: [0, 0], cell: 0.1, values: new Float32Array(8) }), /^grid\.values has 8 numbers, of 9/);
  refused(() => Shape.fromHeights({ count: [2, 2], heights: [1, 1, 1], spacing: 1, base: -1, cell: 0.1 }), /^heights\.heights has 3/);
  refused(() => Shape.fromMesh({ dimension: 2, vertices: [0, 0, 1, 0, 1, 1], faces: [0, 1, 1, 7], cell: 0.1 }), /faces\[1\]\[1\] is 7/);
  refused(() => Shape.fromMesh({ dimension: 2, vertices: [0, 0, 1, 0], faces: [0, -1], cell: 0.1 }), /^mesh\.faces\[1\] is -1/);
  const shape = brick();
  refused(() => shape.distance([1, 2]), /^point has 2 numbers/);
  const flat = await Solver.create({ dimension: 2, capacity: 1 });
  refused(() => flat.setColliders([{ shape }]), /3D/);
  shape.destroy();
  flat.destroy();
});

test("queries know water at rest", async () => {
  const solver = await lattice();
  const at = solver.sample([0.25, 0.25, 0.25, 0.9, 0.9, 0.9], ["wet", "densities", "velocities", "pressures"]);
  near(at.densities[0], 1, 0.01);
  assert.deepEqual([at.densities[1], at.velocities.length, at.pressures.length, ...at.wet], [0, 6, 2, 1, 0]);
  const along = solver.sampleOnGrid({ counts: [1, 1, 3], origin: [0.25, 0.25, 0.25], step: [0, 0, 0.3] });
  near(along.densities[0], 1, 0.01);
  assert.ok(along.densities[1] < 0.5 && along.densities[2] === 0); // above the surface
  const levels = solver.levels([0.25, 0, 0.25, 0.9, 0, 0.9]);
  near(levels[0], 0.5, 0.01);
  assert.ok(Number.isNaN(levels[1]));
  const { distances, normals } = solver.castRays([0.25, 0.9, 0.25, 0.9, 0.9, 0.9], [0, -1, 0, 0, -1, 0]);
  near(distances[0], 0.4, 0.01);
  near(normals[1], 1, 0.01);
  assert.equal(distances[1], Infinity);
  // The z of block is the fastest.
  const corner = { shape: "box", position: [D, D, D], halfExtents: [D, D, D] };
  assert.deepEqual(Array.from(solver.findIn(corner)), [0, 1, 10, 11, 100, 101, 110, 111]);
  const [half, dry, pill] = solver.measure([
    { shape: "box", position: [0.25, 0.5, 0.25], halfExtents: [0.1, 0.1, 0.1] },
    { shape: "sphere", position: [0.8, 0.8, 0.8], radius: 0.1 },
    { shape: "capsule", position: [0.25, 0.25, 0.25], axis: [1, 0, 0], halfLength: 0.1, radius: 0.05 },
  ]);
  near(half.volume, 0.008, 1e-12);
  near(half.fraction, 0.5, 0.05);
  assert.equal(dry.fraction, 0);
  near(pill.fraction, 1, 1e-9);
  solver.endQueries();
  solver.destroy();
});

test("queries want arrays that fit", async () => {
  const solver = await lattice();
  refused(() => solver.sample([1, 2, 3, 4]), /^points has 4 numbers, no multiple of 3$/);
  refused(() => solver.sample([1, 2, 3], ["colours"]), /^fields has colours; /);
  refused(() => solver.sampleOnGrid({ counts: [2 ** 15, 2 ** 15, 1] }), /not to be had/, "PBF_ERROR_OUT_OF_MEMORY");
  refused(() => solver.sampleOnGrid({ counts: [2 ** 31, 2 ** 31, 4] }, ["wet"]), /not to be had/, "PBF_ERROR_OUT_OF_MEMORY");
  refused(() => solver.castRays([1, 2, 3], []), /^directions has 0 rows, origins 1$/);
  refused(() => solver.measure([{ shape: "cone" }]), /^volumes\[0\]\.shape is cone; it must be one of box, sphere, capsule$/);
  refused(() => solver.measure(3), /^volumes is 3; it must be an array of objects$/);
  refused(() => solver.levels("water"), /no multiple/);
  solver.destroy();
});

test("as much comes as the rate says", async () => {
  const solver = await Solver.create({ capacity: 1000, params: { timeStep: 1 / 128, gravity: [0, 0, 0] } });
  const tap = { shape: "disc", position: [0.5, 0.9, 0.5], velocity: [0, -1, 0], radius: 0.15, rate: 0.0371 };
  solver.setEmitters([tap]);
  solver.setDrains([{ shape: "box", position: [0.5, 0.1, 0.5], halfExtents: [0.5, 0.1, 0.5] }]);
  solver.step(256);
  const after = solver.inOut;
  near(after.emitted, (0.0371 * 2) / D ** 3, 1);
  assert.ok(after.drained > 0);
  assert.equal(after.emitted - after.drained, solver.count);
  solver.setEmitters(solver.emitters);
  solver.setDrains(solver.drains);
  assert.equal(solver.emitters[0].radius, 0.15);
  assert.equal(solver.drains[0].halfExtents[1], 0.1);
  solver.setReservoirs([{ position: [0.5, 0.5, 0.5], halfExtents: [0.5, 0.5, 0.5], depth: 0.1 }]);
  solver.step(1);
  assert.ok(solver.reservoirs[0].added > 0);
  solver.setReservoirs(solver.reservoirs);
  solver.setReservoirs([]);
  assert.equal(solver.reservoirs.length, 0);
  refused(() => solver.setEmitters([{ ...tap, rate: 100 }]), /^emitters\[0\]\.rate is 100/);
  refused(() => solver.setEmitters([{ shape: "cone" }]), /one of rectangle, disc$/);
  solver.destroy();
});

// Without drag it falls along a parabola.
test("spray flies, and what can't be is refused", async () => {
  const solver = await lattice();
  const x = [0.7, 0.9, 0.7, 0.8, 0.9, 0.7], v = [0.5, 0, 0, 0, 0.25, 0];
  refused(() => solver.addDiffuse(x, v, [1, 2]), /pbf_set_diffuse/, "PBF_ERROR_STATE");
  assert.equal(solver.diffuse, null);
  solver.setDiffuse({ capacity: 7 });
  assert.equal(solver.diffuse.capacity, 7);
  assert.equal(solver.diffuse.energyMax, solver.defaultDiffuse.energyMax);
  solver.addDiffuse(x, v, [1, 2]);
  solver.addDiffuse([0.8, 0.8, 0.8], null, [0.01]);
  solver.shiftDiffuse([0, -0.25, 0]);
  solver.step(8);
  assert.deepEqual([solver.diffuseInfo.count, solver.diffuseInfo.spray, solver.diffuseInfo.expired], [2, 2, 1]);
  const { positions, velocities, ages, lives, kinds, ids } = solver.diffuseParticles;
  const { timeStep, gravity } = solver.params, time = 8 * timeStep;
  near(positions[0], 0.7 + 0.5 * time, 1e-6);
  near(positions[1], 0.65 + (gravity[1] / 2) * time ** 2, 1e-6);
  near(positions[4], 0.65 + 0.25 * time + (gravity[1] / 2) * time ** 2, 1e-6);
  near(velocities[4], 0.25 + gravity[1] * time, 1e-6);
  near(lives[1], 2 - time, 1e-6);
  near(ages[1], time, 1e-6);
  assert.deepEqual([...kinds, ...ids], [constants.DIFFUSE_SPRAY, constants.DIFFUSE_SPRAY, 0n, 1n]);
  refused(() => solver.addDiffuse(x, v, [1]), /^positions has 2 rows, lives 1 numbers$/);
  refused(() => solver.addDiffuse(x, [0, 0, 0], [1, 2]), /^velocities has 1 rows/);
  refused(() => solver.addDiffuse(x, null, [1, 0]), /lives\[1\]/);
  refused(() => solver.shiftDiffuse([0, 0]), /way has 2 numbers/);
  refused(() => solver.setDiffuse({ capacity: 0 }), /capacity is 0/);
  refused(() => solver.setDiffuse({ foam: 3 }), /^diffuse has no foam/);
  refused(() => solver.setDiffuse(7), /it must be an object or null/);
  assert.equal(solver.diffuseInfo.count, 2);
  solver.setDiffuse(null);
  assert.deepEqual([solver.diffuseInfo.capacity, solver.diffuseParticles.ids.length], [0, 0]);
  solver.destroy();
});

// Oil that begins below water: it rises, and the floor has the weight of both, beside what the full tank's ceiling pushes back.
test("oil floats, and the floor bears both", async () => {
  const solver = await Solver.create({ dimension: 2, capacity: 200, params: { domainMax: [0.5, 1], loads: 1 } });
  solver.addParticles(Array.from({ length: 200 }, (_, i) => [D * ((i % 10) + 0.5), D * (Math.floor(i / 10) + 0.5)]).flat());
  solver.setPhases([{}, { restDensity: 0.5 }]);
  solver.setParticlePhases(new Array(100).fill(1));
  assert.equal(solver.phases[1].restDensity, 0.5);
  const { timeStep, gravity } = solver.params;
  solver.step(Math.floor(10 / timeStep));
  solver.wallLoads();
  solver.step(Math.floor(1 / timeStep));
  const x = solver.positions.slice(), sums = [0, 0];
  solver.particlePhases.forEach((phase, i) => (sums[phase] += x[2 * i + 1] / 100));
  assert.ok(sums[1] > sums[0] + 0.3, String(sums));
  const loads = solver.wallLoads();
  const impulse = loads[constants.WALL_Y_MIN].impulseSum[1] + loads[constants.WALL_Y_MAX].impulseSum[1];
  near(impulse / loads[0].timeSum / (D * D * (100 + 0.5 * 100) * gravity[1]), 1, 0.005);
  refused(() => solver.setParticlePhases([2]), /^phases\[0\] is 2/);
  refused(() => solver.setParticlePhases([-1]), /^phases\[0\] is -1/);
  refused(() => solver.setPhases([{ restDensity: -1 }, {}]), /^phases\[0\]\.rest_density is -1/);
  solver.destroy();
});

test("worlds fall as they would alone", async () => {
  const batch = await Batch.create({ worlds: 3, capacity: 10 }), alone = await Solver.create({ capacity: 10 });
  assert.deepEqual([batch.length, batch.info.worlds], [3, 3]);
  batch.addParticles([1, 0, 2], new Array(9).fill(0.5), new Array(9).fill(0));
  assert.deepEqual(Array.from(batch.counts), [1, 0, 2]);
  batch.setStart();
  batch.setGravity([0, -1, 0, 0, -2, 0, 3, 0, 0]);
  batch.step(12, [true, false, true]);
  const v = batch.read("velocity"), t = 12 * alone.params.timeStep;
  assert.equal(v.length, 3 * 2 * 3);
  near(v[1], -t, 1e-6);
  assert.deepEqual(Array.from(v.slice(3, 12)), new Array(9).fill(0)); // rows that worlds have not
  near(v[12], 3 * t, 1e-6);
  assert.deepEqual(Array.from(batch.read("id", [false, false, true])), [0, 0, 0, 0, 0, 1]);

  alone.addParticles([0.5, 0.5, 0.5]);
  alone.setParams({ gravity: [0, -1, 0] });
  alone.step(12);
  const world = batch.world(0);
  assert.equal(world.hash, alone.hash);
  batch.reset([true, false, false]);
  assert.deepEqual(Array.from(world.positions), [0.5, 0.5, 0.5]);
  near(world.params.gravity[1], -9.81, 1e-12);
  batch.setColliders([{ shape: "sphere", position: [0.2, 0.2, 0.2], radius: 0.1 }]);
  batch.moveColliders([0.2, 0.3, 0.2, 0.2, 0.3, 0.2, 0.2, 0.3, 0.2], 0.1);
  batch.step(12);
  near(batch.world(1).colliders[0].position[1], 0.3, 1e-9);
  batch.destroy();
  refused(() => world.step(), /^the solver is destroyed$/);
  refused(() => batch.step(), /^the batch is destroyed$/);
  world.destroy();
  alone.destroy();
});

test("a world that fails says so", async () => {
  const batch = await Batch.create({ worlds: 2, capacity: 2 });
  batch.addParticles([0, 1], [0.5, 0.5, 0.5]);
  batch.world(1).map("position", () => {
    refused(() => batch.step(), /^world 1: /, "PBF_ERROR_STATE");
    const [first, second] = batch.failures;
    assert.equal(first, null);
    assert.match(second.message, /map/);
  });
  refused(() => batch.step(1, [true]), /^mask has 1/);
  refused(() => batch.addParticles([1, 1], [0.5, 0.5, 0.5]), /^there are 1 positions/);
  refused(() => batch.setGravity([0, 0, 0]), /^gravity has 1/);
  refused(() => batch.moveColliders([0, 0, 0, 0, 0, 0], 1, [0, 0, 0, 1]), /^orientations has 1/);
  refused(() => batch.read("colour"), /^field is colour/);
  refused(() => batch.world(2), /^world is 2/, "PBF_ERROR_NOT_FOUND");
  assert.throws(() => new Batch({ capacity: 2 }), { message: /^options\.worlds is undefined/ });
  batch.destroy();
  const logged = await Batch.create({ worlds: 2, capacity: 1, params: { timeStep: 0.5 }, log: () => { throw new RangeError("of the log"); } });
  logged.addParticles([1, 1], new Array(6).fill(0.5));
  assert.throws(() => logged.step(), { name: "RangeError", message: "of the log" });
  logged.step();
  logged.destroy();
});

test("memory of shapes, worlds and answers is given back", async () => {
  const once = async () => {
    const solver = await lattice(), batch = await Batch.create({ worlds: 4, capacity: 1000 });
    const shape = brick();
    solver.setColliders([{ shape, position: [0.7, 0.9, 0.7] }]);
    solver.sample(new Float64Array(3000));
    batch.addParticles([1, 1, 1, 1], new Array(12).fill(0.5));
    batch.read("position");
    const world = batch.world(2);
    world.positions;
    batch.destroy();
    world.destroy();
    solver.destroy();
    shape.destroy();
  };
  const bytes = async () => {
    const solver = await lattice(), { byteLength } = solver.positions.buffer;
    solver.destroy();
    return byteLength;
  };
  for (let k = 0; k < 3; ++k) await once();
  const before = await bytes();
  for (let k = 0; k < 200; ++k) await once();
  assert.equal(await bytes(), before);
});
