// PBF_JS=build/wasm-small/js node bindings/js/speed_threads.mjs: milliseconds that a step takes of dam breaks of 4,000,
// 30,720 and 100,000 particles with one and two threads. The modules take turns, for other programs run beside.
import { resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { Worker, isMainThread, parentPort, workerData } from "node:worker_threads";

const spacing = 0.05, tank = ([x, y, z]) => [2 * x * spacing, 1.5 * y * spacing, z * spacing];

function solverOf(Solver, counts, threads) {
  const positions = [];
  for (let z = 0; z < counts[2]; ++z)
    for (let y = 0; y < counts[1]; ++y)
      for (let x = 0; x < counts[0]; ++x) for (const k of [x, y, z]) positions.push(spacing * (k + 0.5));
  const solver = new Solver({ capacity: positions.length / 3, threads, params: { spacing, smoothingRadius: 0.25 / 3, domainMax: tank(counts) } });
  solver.addParticles(positions);
  solver.step(10);
  return solver;
}

// In a worker: a module of its own, that steps when it is told.
async function serve({ threads, counts }) {
  const { Solver, load } = await import(pathToFileURL(`${resolve(process.env.PBF_JS ?? "build/wasm-small/js")}/pbf.mjs`));
  const loaded = await load(undefined, { threads }), solver = solverOf(Solver, counts, threads);
  parentPort.on("message", (steps) => {
    const begin = performance.now();
    solver.step(steps);
    parentPort.postMessage({ time: (performance.now() - begin) / steps, hash: solver.hash });
  });
  parentPort.postMessage(loaded);
}

const answer = (worker) => new Promise((done, failed) => worker.once("message", done).removeAllListeners("error").once("error", failed));

async function measure(counts, rounds) {
  const kinds = await Promise.all([1, 2].map(async (threads) => {
    const worker = new Worker(fileURLToPath(import.meta.url), { workerData: { threads, counts } });
    const loaded = await answer(worker);
    if (loaded.threads !== threads) throw new Error(loaded.why);
    return { worker, threads, times: [] };
  }));
  for (let round = 0; round < rounds; ++round) {
    for (const kind of kinds) {
      kind.worker.postMessage(1);
      const { time, hash } = await answer(kind.worker);
      kind.times.push(time);
      kind.hash = hash;
    }
  }
  await Promise.all(kinds.map(({ worker }) => worker.terminate()));
  return kinds;
}

const middle = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

async function main() {
  for (const [counts, rounds] of [[[20, 20, 10], 400], [[32, 32, 30], 60], [[50, 50, 40], 20]]) {
    const kinds = await measure(counts, rounds);
    for (const { threads, times, hash } of kinds) {
      console.log(`${counts.reduce((a, b) => a * b)} particles, ${threads} thread(s): median ${middle(times).toFixed(1)} ms a step, ` +
        `least ${Math.min(...times).toFixed(1)}; hash ${hash}`);
    }
    console.log(`  median of the pairs' ratios: ${middle(kinds[0].times.map((time, k) => time / kinds[1].times[k])).toFixed(2)}`);
  }
}

await (isMainThread ? main() : serve(workerData));
