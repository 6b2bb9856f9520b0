// The module with threads under node: PBF_JS=build/wasm-small/js node --test tests/bindings/js_threads.test.mjs
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { before, test } from "node:test";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { Worker } from "node:worker_threads";

const folder = resolve(process.env.PBF_JS ?? "build/wasm-small/js");
const script = pathToFileURL(`${folder}/pbf.mjs`).href;
const { Batch, Solver, load } = await import(script);

// A dam of 6,000 particles, which several threads share, after some steps: its hash.
const dam = `async (Solver, threads) => {
  const positions = [];
  for (let n = 0; n < 6000; ++n) positions.push(...[n % 20, Math.floor(n / 20) % 20, Math.floor(n / 400)].map((k) => 0.05 * (k + 0.5)));
  const solver = new Solver({ capacity: 6000, threads, params: { domainMax: [2, 1, 0.75], viscosity: 0.01 } });
  solver.addParticles(positions);
  solver.setColliders([{ shape: "box", halfExtents: [0.1, 0.1, 0.3], position: [1.2, 0.1, 0.4], angularVelocity: [0, 3, 0] }]);
  solver.step(15);
  const { hash, info: { threads: had } } = solver;
  solver.destroy();
  return { hash, had };
}`;
const runDam = eval(dam);

// What a module's code gives in a worker, where the package is loaded anew: \`pbf\` is the package.
function elsewhere(code, prepare = "") {
  return new Promise((done, failed) => {
    const text = `const { parentPort } = require("node:worker_threads");
      (async () => { ${prepare}; const pbf = await import("${script}"); const dam = ${dam}; ${code} })()
        .then((value) => parentPort.postMessage({ value }), (error) => parentPort.postMessage({ error: String(error.stack) }));`;
    const worker = new Worker(text, { eval: true });
    worker.on("error", failed);
    worker.on("message", ({ value, error }) => {
      if (error) failed(new Error(error));
      else worker.terminate().then(() => done(value));
    });
  });
}

let one; // the dam's hash by the module without threads

before(async () => {
  const { loaded, ...given } = await elsewhere(`const loaded = await pbf.load(); return { loaded, ...(await dam(pbf.Solver)) };`);
  assert.deepEqual(loaded, { threads: 1 });
  assert.equal(given.had, 1);
  one = given.hash;
  assert.deepEqual(await load(undefined, { threads: 4 }), { threads: 4 });
});

test("1, 2 and 4 threads have the bits of one", async () => {
  for (const threads of [1, 2, 4]) {
    assert.deepEqual(await runDam(Solver, threads), { hash: one, had: threads });
  }
});

test("solvers that are made and destroyed again and again leave no thread and no memory behind", async () => {
  const tasks = () => (existsSync("/proc/self/task") ? readdirSync("/proc/self/task").length : 0);
  await runDam(Solver, 4);
  const before = tasks();
  const one = async () => {
    const solver = new Solver({ capacity: 3000, threads: 4, params: { domainMax: [2, 1, 0.5] } });
    solver.addParticles([0.5, 0.5, 0.25, 0.6, 0.5, 0.25]);
    solver.step(2);
    assert.equal(solver.info.threads, 4);
    const { buffer } = solver.positions;
    solver.destroy();
    return buffer.byteLength;
  };
  const bytes = await one();
  for (let k = 0; k < 200; ++k) assert.equal(await one(), bytes);
  assert.equal(tasks(), before);
});

test("more threads than there are become fewer", async () => {
  assert.deepEqual(await runDam(Solver, 9), { hash: one, had: 4 });
});

test("a solver that does not say has as many as pay", () => {
  const solver = new Solver({ capacity: 100 });
  solver.addParticles([0.5, 0.5, 0.5]);
  solver.step();
  assert.ok(solver.info.threads <= 4);
  solver.destroy();
});

test("memory grows in other threads, and arrays see it", async () => {
  const worlds = 6, batch = new Batch({ worlds, threads: 4, capacity: 12000, params: { domainMax: [4, 2, 1] } });
  assert.equal(batch.info.threads, 4);
  const positions = [];
  for (let n = 0; n < 9000; ++n) positions.push(...[n % 30, Math.floor(n / 30) % 20, Math.floor(n / 600)].map((k) => 0.05 * (k + 0.5)));
  batch.addParticles(Array(worlds).fill(9000), Array(worlds).fill(positions).flat());
  const before = batch.world(0).positions.buffer.byteLength;
  batch.step(3);
  const { hash } = batch.world(0), first = batch.world(0).positions.slice();
  assert.ok(batch.world(0).positions.buffer.byteLength > before, "memory has grown");
  for (let k = 1; k < worlds; ++k) {
    assert.equal(batch.world(k).hash, hash);
    assert.deepEqual(batch.world(k).positions.slice(), first);
  }
  batch.destroy();
});

test("a worker has threads of its own", async () => {
  const code = `const loaded = await pbf.load(undefined, { threads: 2 }); return { ...loaded, ...(await dam(pbf.Solver, 2)) };`;
  assert.deepEqual(await elsewhere(code), { threads: 2, hash: one, had: 2 });
});

test("Solver.create loads what its threads want", async () => {
  const code = `const solver = await pbf.Solver.create({ threads: 3 }); const { threads } = solver.info; return threads;`;
  assert.equal(await elsewhere(code), 3);
});

test("a thread that may not wait looks again and again, as a page's", async () => {
  const prepare = `Atomics.wait = () => { throw new TypeError("may not") }`;
  const code = `const { threads } = await pbf.load(undefined, { threads: 3 }); const all = [];
    for (let k = 0; k < 5; ++k) all.push(await dam(pbf.Solver, 3));
    const batch = new pbf.Batch({ worlds: 6, threads: 3, capacity: 10 });
    batch.addParticles(Array(6).fill(1), Array(18).fill(0.5));
    for (let k = 0; k < 10; ++k) batch.step();
    batch.destroy();
    return { threads, hashes: all.map(({ hash }) => hash), had: all.map(({ had }) => had) };`;
  assert.deepEqual(await elsewhere(code, prepare), { threads: 3, hashes: Array(5).fill(one), had: Array(5).fill(3) });
});

test("the program of the documents prints its threads, and ends", () => {
  const printed = execFileSync(process.execPath, [`${folder}/threaded.mjs`], { encoding: "utf8", timeout: 60000 });
  assert.match(printed, /^(\d+ threads|one thread: there is one processor)\n[\d.]+ ms a step\n$/);
});

// ---- Threads that can't be had

const fallsBack = `const { threads, why } = await pbf.load(undefined, { threads: 3 }); return { threads, why, ...(await dam(pbf.Solver, 3)) };`;

async function hasOne(prepare, why, code = fallsBack) {
  const given = await elsewhere(code, prepare);
  assert.match(given.why, why);
  assert.deepEqual({ ...given, why: "" }, { threads: 1, why: "", hash: one, had: 1 });
}

test("without shared memory there is one thread", async () => {
  await hasOne("delete globalThis.SharedArrayBuffer", /^the page is not isolated: /);
  await hasOne("globalThis.crossOriginIsolated = false", /^the page is not isolated: /);
});

test("where the module with threads is not there, there is one", async () => {
  const code = fallsBack.replace("threads: 3", `threads: 3, threadsSource: "${script}.missing"`);
  await hasOne("", /ENOENT/, code);
});

// Workers as a page has them, over those of node.
const ofPages = `const { Worker: Nodes } = require("node:worker_threads"), { resolveObjectURL } = require("node:buffer");
  globalThis.made = 0;
  globalThis.Worker = class {
    constructor(url) {
      this.number = globalThis.made++;
      this.began = resolveObjectURL(url).text().then((text) => {
        this.own = new Nodes(text, { eval: true });
        this.own.on("message", (data) => { this.own.unref(); this.onmessage({ data }); });
      });
    }
    postMessage(data) { this.began.then(() => this.own.postMessage(data)); }
    terminate() { this.own?.terminate(); }
  };`;

test("workers of a page do alike", async () => {
  assert.deepEqual(await elsewhere(fallsBack, ofPages), { threads: 3, hash: one, had: 3, why: undefined });
});

test("where one worker fails there are the others", async () => {
  const prepare = `${ofPages} globalThis.Worker = class extends globalThis.Worker {
    postMessage(data) { if (this.number) super.postMessage(data); else this.onerror({ message: "refused" }); } }`;
  assert.deepEqual(await elsewhere(fallsBack, prepare), { threads: 2, hash: one, had: 2, why: undefined });
});

test("where no worker can be had there is one thread", async () => {
  await hasOne(`globalThis.Worker = class { constructor() { throw new Error("refused") } }`, /^no worker can be had: refused$/);
});

test("a worker that does not begin is not waited for", async () => {
  const prepare = `const real = setTimeout; globalThis.setTimeout = (call, time) => real(call, time / 50);
    globalThis.Worker = class { postMessage() {} terminate() {} }`;
  await hasOne(prepare, /^no worker can be had: it has not begun in 10 s$/);
});

test("what load is asked is looked at", async () => {
  await assert.rejects(elsewhere(`await pbf.load(undefined, { threads: 1.5 });`), /options.threads is 1.5; it must be a whole number/);
  await assert.rejects(elsewhere(`await pbf.load(undefined, { thread: 2 });`), /options has no thread; it has threads, threadsSource/);
});
