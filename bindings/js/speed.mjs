// PBF_JS=build/wasm/js node bindings/js/speed.mjs: milliseconds a step takes of 30,000 particles in 2D (the scene of
// bench/scenes/report-30k.json, its wall at rest), and of as many in a 3D dam break, by instruction set.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { Solver, constants, load } = await import(pathToFileURL(`${resolve(process.env.PBF_JS ?? "build/wasm/js")}/pbf.mjs`));

function lattice(counts, first, spacing) {
  const positions = [];
  for (let z = 0; z < (counts[2] ?? 1); ++z)
    for (let y = 0; y < counts[1]; ++y)
      for (let x = 0; x < counts[0]; ++x) positions.push(...[x, y, z].slice(0, counts.length).map((k) => first + spacing * k));
  return positions;
}

const scenes = {
  "report-30k, 2D": {
    dimension: 2,
    positions: lattice([500, 60], 0.25, 0.575),
    params: {
      kernel: constants.KERNEL_POLY6_SPIKY, smoothingRadius: 1.1, spacing: 0.575, particleVolume: 0.5138132684248845,
      timeStep: 0.05, iterations: 5, collide: constants.COLLIDE_AFTER_PREDICTION | constants.COLLIDE_AFTER_SOLVE,
      gravity: [0, -3], overRelaxation: 0.8203125, cfm: 17.179038485712607, scorrK: 0.003235295319316347, scorrDq: 0.3,
      scorrN: 4, cohesion: 1, minDiagonal: 0, wallDensity: 0, solver: constants.SOLVER_JACOBI, domainMin: [0.25, 0.25],
      domainMax: [368.39, 204.55],
    },
  },
  "dam break, 3D": {
    dimension: 3,
    positions: lattice([32, 32, 30], 0.025, 0.05),
    params: { spacing: 0.05, smoothingRadius: 0.25 / 3, domainMax: [3.2, 2.4, 1.5] },
  },
};

const sets = ["scalar", "simd128"];

function solverOf({ dimension, positions, params }, isa) {
  const solver = new Solver({ dimension, capacity: positions.length / dimension, isa, params });
  solver.addParticles(positions);
  solver.step(20);
  return solver;
}

// The least time of each stage of a step, of five steps at a time; the sets take turns, for other programs run beside.
function measure(solvers) {
  const least = solvers.map(() => ({}));
  for (let round = 0; round < 14; ++round) {
    solvers.forEach((solver, k) => {
      solver.setTiming(true);
      solver.step(5);
      for (const { name, milliseconds } of solver.timings.stages)
        least[k][name] = Math.min(least[k][name] ?? Infinity, milliseconds / 5);
    });
  }
  return least;
}

await load();
const sum = (times) => Object.values(times).reduce((a, b) => a + b, 0);
for (const [name, scene] of Object.entries(scenes)) {
  const solvers = sets.map((isa) => solverOf(scene, isa));
  measure(solvers).forEach((times, k) => {
    const { neighbors, lambda, move } = times;
    console.log(`${name}, ${solvers[k].count} particles, ${sets[k]}: ${sum(times).toFixed(1)} ms a step, neighbours ` +
      `${neighbors.toFixed(1)}, lambda and move ${(lambda + move).toFixed(1)}; hash ${solvers[k].hash}`);
  });
  solvers.forEach((solver) => solver.destroy());
}
