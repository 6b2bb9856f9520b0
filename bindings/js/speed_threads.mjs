// PBF_JS=build/wasm-small/js node bindings/js/speed_threads.mjs [ROUNDS]: milliseconds that a step takes of dam breaks of 4,000,
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

const answer = (worker) => new Promise((done, failed) => worker.once("message", done).once("error", failed));

async function measure(counts, steps, rounds) {
  const kinds = await Promise.all([1, 2].map(async (threads) => {
    const worker = new Worker(fileURLToPath(import.meta.url), { workerData: { threads, counts } });
    const loaded = await answer(worker);
    if (loaded.threads !== threads) throw new Error(loaded.why);
    return { worker, threads, times: [] };
  }));
  for (let round = 0; round < rounds; ++round) {
    for (const kind of kinds) {
      kind.worker.postMessage(steps);
      const { time, hash } = await answer(kind.worker);
      kind.times.push(time);
      kind.hash = hash;
    }
  }
  await Promise.all(kinds.map(({ worker }) => worker.terminate()));
  return kinds;
}

async function main() {
  const rounds = Number(process.argv[2] ?? 31);
  for (const [counts, steps] of [[[20, 20, 10], 10], [[32, 32, 30], 2], [[50, 50, 40], 1]]) {
    const kinds = await measure(counts, steps, rounds), middle = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];
    const ratio = middle(kinds[0].times.map((time, k) => time / kinds[1].times[k]));
    for (const { threads, times, hash } of kinds) {
      const median = middle([...times]);
      console.log(`${counts.reduce((a, b) => a * b)} particles, ${threads} thread(s): ${median.toFixed(1)} ms a step, least ${Math.min(...times).toFixed(1)}; hash ${hash}`);
    }
    console.log(`  median of the pairs' ratios: ${ratio.toFixed(2)}`);
  }
}

await (isMainThread ? main() : serve(workerData));
