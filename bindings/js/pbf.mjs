// Position based fluids for pages and node: the C library pbf as one WebAssembly module. pbf.h says what each
// parameter and call does; names are those there in camelCase.
//
//   import { Solver } from "./pbf.mjs";
//   const fluid = await Solver.create({ capacity: 4000, params: { domainMax: [2, 1, 1] } });
//   fluid.addParticles([0.5, 0.5, 0.5, 0.6, 0.5, 0.5]);
//   fluid.step(10);
//   fluid.positions;                     // a Float32Array, three numbers a particle
//
// Beside it there are Shape, for solids of any form, and Batch, for many worlds of one kind.
//
// A call that fails throws a PbfError with the library's sentence, and leaves the solver as it was.
export { constants } from "./abi.g.mjs";
export { Batch } from "./batch.mjs";
export { PbfError, load, version } from "./module.mjs";
export { Shape } from "./shape.mjs";
export { Solver } from "./solver.mjs";
