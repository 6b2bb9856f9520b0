import type { Collider, ColliderLoad, Info, Params, Plan, Stats, Timings } from "./abi.g.mjs";

export { constants } from "./abi.g.mjs";
export type { Collider, ColliderLoad, Info, Params, Plan, Stats, Timings } from "./abi.g.mjs";

declare global {
  interface SymbolConstructor {
    readonly dispose: unique symbol; // of TypeScript 5.2 and later
  }
}

type Numbers = ArrayLike<number>;
/** Some of the fields; arrays may be of any kind, and shorter in 2D. */
type Settable<Struct> = { [Field in keyof Struct]?: Struct[Field] extends number[] ? Iterable<number> | Numbers : Struct[Field] };

export type ParamChanges = Settable<Params>;
export type ColliderFields = Pick<Collider, "shape"> & Settable<Omit<Collider, "shape">>;

export interface Options {
  /** 2 or 3, the default. */
  dimension?: 2 | 3;
  /** constants.FLOAT32, the default, or constants.FLOAT64. */
  precision?: 4 | 8;
  /** Particles at most. */
  capacity?: number;
  strict?: boolean;
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

/** Loads the module once: from pbf.wasm beside pbf.mjs, or from elsewhere. */
export declare function load(
  source?: string | URL | Response | ArrayBuffer | ArrayBufferView | WebAssembly.Module,
): Promise<void>;

/** "0.2.0". After load(). */
export declare function version(): string;

/** A fluid. Arrays that it gives are views of the module's memory: slice() keeps them. */
export declare class Solver {
  /** Loads the module where that has not been done, and makes a solver. */
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
