// The package for browsers and node, by node's own test runner: PBF_JS=build/wasm/js node --test tests/bindings
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker } from "node:worker_threads";

const folder = resolve(process.env.PBF_JS ?? "build/wasm/js");
const { Solver, PbfError, constants, load, version } = await import(pathToFileURL(`${folder}/pbf.mjs`));

test("nothing is made before the module is loaded", async () => {
  assert.throws(() => new Solver(), { message: "the module is not loaded; await load() first, or Solver.create()" });
  await assert.rejects(load(new Uint8Array([1, 2, 3])), WebAssembly.CompileError);
  await load(readFileSync(`${folder}/pbf.wasm`));
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
  await assert.rejects(Solver.create({ threads: 2 }), { message: /^options has no threads; / });
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

test("the program of all languages prints what it prints in C", () => {
  const printed = execFileSync(process.execPath, [`${folder}/splash.mjs`], { encoding: "utf8" });
  assert.match(printed, /\n1\.0 s: front at 1\.99 m\n$/);
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
