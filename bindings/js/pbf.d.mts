import type {
  Collider, ColliderLoad, Diffuse, DiffuseInfo, Emitter, Flow, InOut, Info, Params, Phase, Plan, Reservoir, ShapeInfo, Stats, Timings, Volume,
} from "./abi.g.mjs";

export { constants } from "./abi.g.mjs";
export type {
  Collider, ColliderLoad, Diffuse, DiffuseInfo, Emitter, Flow, InOut, Info, Params, Phase, Plan, Reservoir, ShapeInfo, Stats, Timings, Volume,
} from "./abi.g.mjs";

declare global {
  interface SymbolConstructor {
    readonly dispose: unique symbol; // of TypeScript 5.2 and later
  }
}

type Numbers = ArrayLike<number>;
/** Some of the fields; arrays may be of any kind, and shorter in 2D. */
type Settable<Struct> = { [Field in keyof Struct]?: Struct[Field] extends number[] ? Iterable<number> | Numbers : Struct[Field] };

export type ParamChanges = Settable<Params>;
type Shaped<Struct extends { shape: unknown }> = Pick<Struct, "shape"> & Settable<Omit<Struct, "shape">>;
export type ColliderFields = Shaped<Collider>;
export type VolumeFields = Shaped<Volume>;
export type EmitterFields = Shaped<Emitter>;
export type PhaseFields = Settable<Phase>;
/** `added` and `removed` are told, and not looked at where it is set. */
export type ReservoirFields = Settable<Reservoir>;

export type DiffuseFields = Settable<Diffuse>;

/** Spray, foam and bubbles, the oldest first: copies. */
export interface DiffuseParticles {
  positions: Reals;
  velocities: Reals;
  ages: Reals;
  /** Times that are left to them. */
  lives: Reals;
  /** constants.DIFFUSE_SPRAY, DIFFUSE_FOAM, DIFFUSE_BUBBLE. */
  kinds: Uint32Array;
  ids: BigUint64Array;
}

export interface Options {
  /** 2 or 3, the default. */
  dimension?: 2 | 3;
  /** constants.FLOAT32, the default, or constants.FLOAT64. */
  precision?: 4 | 8;
  /** Particles at most. */
  capacity?: number;
  strict?: boolean;
  /** Threads that its steps may have, of those that are loaded; 0, the default: as many of these as pay. */
  threads?: number;
  /** "scalar" or "simd128", the default. */
  isa?: string;
  /** Sentences of the library's: level is constants.LOG_INFO or LOG_WARNING. */
  log?: (level: number, sentence: string) => void;
  /** What differs from the defaults. */
  params?: ParamChanges;
}

export type Reals = Float32Array | Float64Array;

/** A field in the solver's own memory: read only, and gone after the call. */
export interface Mapped {
  /** Component c of particle i is components[c][i * stride]. */
  components: (Reals | Uint32Array)[];
  stride: number;
  count: number;
  /** Which particle is where. */
  ids: Uint32Array;
}

/** What the library has refused. */
export declare class PbfError extends Error {
  constructor(status: number, code: string, message: string);
  readonly status: number;
  /** "PBF_ERROR_CAPACITY" and so on. */
  readonly code: string;
}

export type Source = string | URL | Response | ArrayBuffer | ArrayBufferView | WebAssembly.Module;

export interface Loaded {
  /** That solvers can have. */
  threads: number;
  /** Where threads were asked for and there is one: the reason. */
  why?: string;
}

/**
 * Loads the module once: from pbf.wasm beside pbf.mjs, or from elsewhere. With `threads` (1; 0: one for each processor, 16 at
 * most) it takes pbf-threads.wasm, or `threadsSource`, and starts workers, if the page may have them; otherwise the one without.
 */
export declare function load(source?: Source, options?: { threads?: number; threadsSource?: Source }): Promise<Loaded>;

/** "0.2.0". After load(). */
export declare function version(): string;

/** A solid that colliders have: { shape: rock, position: […] }. It lives while this object or a solver has it. After load(). */
export declare class Shape {
  private constructor();
  /** Signed distances, negative inside, at origin + cell (i, j, k), the first index the fastest. */
  static fromGrid(grid: { nodes: Numbers; origin: Numbers; cell: number; values: Numbers }): Shape;
  /** What a closed surface of triangles encloses, in 2D a closed line of segments; with a thickness a shell. */
  static fromMesh(mesh: { dimension: 2 | 3; vertices: Numbers; faces: Numbers; cell: number; thickness?: number }): Shape;
  /** A terrain down to `base`; count has the numbers of heights along x and, in 3D, z. */
  static fromHeights(heights: { count: Numbers; heights: Numbers; spacing: number; base: number; cell: number }): Shape;
  /** Their convex hull. */
  static fromPoints(hull: { dimension: 2 | 3; points: Numbers; cell: number }): Shape;
  /** Of bytes that save() or pbf-bake wrote. */
  static load(saved: Uint8Array): Shape;
  /** As bytes, for a file. */
  save(): Uint8Array;
  /** The distances at its nodes, as fromGrid takes them. */
  readonly values: Float32Array;
  /** Gives its reference back now; solvers that have the shape keep it. */
  destroy(): void;
  [Symbol.dispose](): void;
  readonly dimension: number;
  readonly info: ShapeInfo;
  /** Of a point in the shape's own space, and the direction in which it grows. */
  distance(point: Numbers): { distance: number; normal: number[] };
}

/** What is asked for at points: of the field "wet" 1 or 0. */
export type SampledField = "densities" | "velocities" | "pressures" | "wet";
export type Sampled<Field extends SampledField> = { [Name in Field]: Name extends "wet" ? Uint8Array : Float64Array };

/** A fluid. Arrays that it gives are views of the module's memory: slice() keeps them. */
export declare class Solver {
  /** Loads the module where that has not been done, with options.threads threads (1), and makes a solver. */
  static create(options?: Options): Promise<Solver>;
  /** After load(). */
  constructor(options?: Options);
  destroy(): void;
  [Symbol.dispose](): void;

  step(steps?: number): void;
  readonly params: Params;
  setParams(changes: ParamChanges): void;
  readonly stepLimit: number;

  readonly dimension: number;
  readonly count: number;
  /** Gives the id of the first one. Without velocities they are at rest. */
  addParticles(positions: Numbers, velocities?: Numbers): number;
  removeParticles(ids: Numbers): void;
  /** Gives how many they were. */
  removeInBox(lower: Iterable<number>, upper: Iterable<number>): number;
  findInBox(lower: Iterable<number>, upper: Iterable<number>): Uint32Array;
  readonly positions: Reals;
  readonly velocities: Reals;
  readonly densities: Reals;
  readonly pressures: Reals;
  readonly ids: Uint32Array;
  setPositions(values: Numbers, first?: number): void;
  setVelocities(values: Numbers, first?: number): void;
  /** Beside gravity, in each step from now on; null takes all away. */
  setAccelerations(values: Numbers | null, first?: number): void;
  /** Without a copy, for the time of the call. */
  map<Result>(field: "position" | "velocity" | "id" | "pressure", use: (mapped: Mapped) => Result): Result;

  setColliders(colliders: ColliderFields[]): void;
  /** To these poses and sizes, in this time from now. */
  moveColliders(targets: ColliderFields[], duration: number): void;
  readonly colliders: Collider[];
  /** What the fluid does to each; begins their sums anew. Wants params.loads. */
  colliderLoads(): ColliderLoad[];
  /** The same of the domain's walls, by constants.WALL_X_MIN and so on. */
  wallLoads(): ColliderLoad[];

  /** The ids of the particles there, ascending. */
  findIn(volume: VolumeFields): Uint32Array;
  /** How much of each volume is below the surface, and how that flows. */
  measure(volumes: VolumeFields[]): Flow[];
  /** At points, dimension numbers each; densities are over that at rest. */
  sample<Field extends SampledField = "densities" | "velocities">(points: Numbers, fields?: Iterable<Field>): Sampled<Field>;
  /** The same at the points origin + (i, j, k) step; the last index is the fastest. */
  sampleOnGrid<Field extends SampledField = "densities" | "velocities">(
    grid: { counts: Numbers; origin: Numbers; step: Numbers }, fields?: Iterable<Field>): Sampled<Field>;
  /** Where rays meet the surface, Infinity where they do not within `length`. */
  castRays(origins: Numbers, directions: Numbers, length?: number): { distances: Float64Array; normals: Float64Array };
  /** How high the water stands at points, against gravity; NaN where there is none. */
  levels(points: Numbers): Float64Array;
  /** Gives back the memory that queries keep. */
  endQueries(): void;

  /** Replaces all emitters; emitter i goes on where the one before it was. */
  setEmitters(emitters: EmitterFields[]): void;
  readonly emitters: Emitter[];
  /** What is in one of these volumes when a step begins is removed. */
  setDrains(drains: VolumeFields[]): void;
  readonly drains: Volume[];
  /** Replaces all open boundaries of given level or pressure. */
  setReservoirs(reservoirs: ReservoirFields[]): void;
  readonly reservoirs: Reservoir[];
  /** What came and went, in particles. */
  readonly inOut: InOut;

  /** What suits the solver's dimension, smoothingRadius, spacing and gravity. */
  readonly defaultDiffuse: Diffuse;
  /** Has steps make and move spray, foam and bubbles: what differs from defaultDiffuse. null ends them. */
  setDiffuse(changes: DiffuseFields | null): void;
  /** What they are made by; null: there are none. */
  readonly diffuse: Diffuse | null;
  readonly diffuseInfo: DiffuseInfo;
  readonly diffuseParticles: DiffuseParticles;
  /** Adds your own, as many as `lives` has numbers; without velocities they are at rest. */
  addDiffuse(positions: Numbers, velocities: Numbers | null, lives: Numbers): void;
  /** Moves all of them, as where the world's origin is moved. */
  shiftDiffuse(way: Numbers): void;

  /** Replaces all phases; with none all particles are alike again. */
  setPhases(phases: PhaseFields[]): void;
  readonly phases: Phase[];
  /** Which phase particles are of, from the row `first` on. */
  setParticlePhases(phases: Numbers, first?: number): void;
  readonly particlePhases: Uint32Array;

  readonly stats: Stats;
  readonly info: Info;
  readonly plan: Plan;
  setTiming(enabled: boolean): void;
  readonly timings: Timings;

  /** Bytes that load takes. */
  save(): Uint8Array;
  load(state: Uint8Array): void;
  /** 16 hexadecimal digits, the same on every machine. */
  readonly hash: string;
}

type Mask = ArrayLike<boolean | number>;

/**
 * Many worlds of one kind. Arrays are world after world; a mask is a truth value a world, and undefined all of them. Where a
 * world fails the others go on, and the call throws what the first one met.
 */
export declare class Batch {
  /** Loads the module where that has not been done, with options.threads threads (1). */
  static create(options: Options & { worlds: number }): Promise<Batch>;
  /** After load(). */
  constructor(options: Options & { worlds: number });
  destroy(): void;
  [Symbol.dispose](): void;
  readonly destroyed: boolean;
  /** How many worlds there are. */
  readonly length: number;
  readonly info: { worlds: number; threads: number; deviceType: number };
  /** World 0 and so on, between calls of the batch. */
  world(world: number): Solver;
  /** Of each world what it met in the last call that went through worlds, or null. */
  readonly failures: (PbfError | null)[];

  step(steps?: number, mask?: Mask): void;
  /** What reset goes back to: a state of save, or the present one of each. */
  setStart(state?: Uint8Array | null, mask?: Mask): void;
  reset(mask?: Mask): void;
  /** Three numbers a world. */
  setGravity(gravity: Numbers, mask?: Mask): void;
  /** The same ones for all. */
  setColliders(colliders: ColliderFields[], mask?: Mask): void;
  /** All that each world has, three numbers each, and four of an orientation; without these they keep theirs. */
  moveColliders(positions: Numbers, duration: number, orientations?: Numbers | null, mask?: Mask): void;
  /** So many to each world; without velocities they are at rest. */
  addParticles(counts: Numbers, positions: Numbers, velocities?: Numbers): void;
  readonly counts: Uint32Array;
  /** An array of shape (worlds, rows, components); rows that a world lacks are 0. */
  read(field: "position" | "velocity" | "density" | "pressure" | "id", mask?: Mask): Reals | Uint32Array;
}
