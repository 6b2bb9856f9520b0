// Written by tools/bindings.py from bindings/abi.json; do not edit. Fields are those of the C headers, which say what each is.
import type { Shape } from "./pbf.mjs";

export interface Params {
  kernel: number;
  smoothingRadius: number;
  spacing: number;
  particleVolume: number;
  timeStep: number;
  iterations: number;
  collide: number;
  gravity: number[];
  attraction: number;
  attractionCenter: number[];
  overRelaxation: number;
  cfm: number;
  cohesion: number;
  minDiagonal: number;
  wallDensity: number;
  scorrK: number;
  scorrDq: number;
  scorrN: number;
  solver: number;
  vorticity: number;
  viscosity: number;
  domainMin: number[];
  domainMax: number[];
  wallVelocity: number[];
  wallAmplitude: number[];
  wallFrequency: number[];
  wallPhase: number[];
  searchCellWidth: number;
  sleepSpeed: number;
  sleepTime: number;
  tolerance: number;
  pressureGrid: number;
  prestabilization: number;
  dampingCompensation: number;
  angularMomentumCorrection: number;
  drag: number;
  dragVelocity: number[];
  maxDepenetrationSpeed: number;
  maxSubsteps: number;
  loads: number;
  shearStressCorrection: number;
  wallFriction: number;
  wallStaticFriction: number;
  wallNoSlip: number;
  surfaceTension: number;
  periodic: number;
  wallAdhesion: number;
}

export interface Collider {
  shape: "plane" | "sphere" | "capsule" | "box" | Shape;
  inverted: number;
  path: number;
  position: number[];
  orientation: number[];
  velocity: number[];
  angularVelocity: number[];
  axis: number[];
  halfExtents: number[];
  radius: number;
  halfLength: number;
  halfExtentsRate: number[];
  radiusRate: number;
  halfLengthRate: number;
  duration: number;
  scale: number;
  scaleRate: number;
  friction: number;
  staticFriction: number;
  noSlip: number;
  adhesion: number;
  lastVelocity: number[];
  lastAngularVelocity: number[];
}

export interface ColliderLoad {
  contacts: number;
  impulse: number[];
  angularImpulse: number[];
  impulseSum: number[];
  angularImpulseSum: number[];
  timeSum: number;
  penetration: number;
  wettedArea: number;
}

export interface Stats {
  count: number;
  iterations: number;
  neighborsMax: number;
  neighborsMean: number;
  centerOfMass: number[];
  positionMin: number[];
  positionMax: number[];
  momentum: number[];
  kineticEnergy: number;
  speedMax: number;
  densityErrorMean: number;
  densityErrorMax: number;
  densityMean: number;
  asleep: number;
  squeezed: number;
  stepLimit: number;
  limitedBy: number;
  substeps: number;
}

export interface Info {
  dimension: number;
  precision: number;
  capacity: number;
  threads: number;
  device: number;
  deviceType: number;
  fellBack: number;
  step: number;
  time: number;
  backend: string;
  deviceName: string;
  buildId: string;
  path: string;
  fallbackReason: string;
}

export interface PlanStage {
  name: string;
  runsPerStep: number;
  launchesPerStep: number;
}

export interface PlanArray {
  name: string;
  bytesPerParticle: number;
  bytes: number;
}

export interface Plan {
  stageCount: number;
  arrayCount: number;
  variant: string;
  bytesPerParticle: number;
  bytes: number;
  stages: PlanStage[];
  arrays: PlanArray[];
}

export interface StageTime {
  name: string;
  milliseconds: number;
  runs: number;
}

export interface Timings {
  stageCount: number;
  stages: StageTime[];
}

export interface Volume {
  shape: "box" | "sphere" | "capsule";
  position: number[];
  orientation: number[];
  halfExtents: number[];
  axis: number[];
  radius: number;
  halfLength: number;
}

export interface Flow {
  volume: number;
  fraction: number;
  centre: number[];
  velocity: number[];
}

export interface Emitter {
  shape: "rectangle" | "disc";
  recycle: number;
  seed: number;
  position: number[];
  velocity: number[];
  across: number[];
  halfWidth: number;
  halfHeight: number;
  radius: number;
  rate: number;
  jitter: number;
  lifetime: number;
  phase: number;
}

export interface InOut {
  emitters: number;
  drains: number;
  emitted: number;
  refused: number;
  recycled: number;
  drained: number;
  expired: number;
}

export interface Reservoir {
  phase: number;
  position: number[];
  orientation: number[];
  halfExtents: number[];
  depth: number;
  pressure: number;
  added: number;
  removed: number;
}

export interface Diffuse {
  capacity: number;
  seed: number;
  interval: number;
  foamNeighbors: number;
  bubbleNeighbors: number;
  trappedAirMin: number;
  trappedAirMax: number;
  waveCrestMin: number;
  waveCrestMax: number;
  energyMin: number;
  energyMax: number;
  trappedAirRate: number;
  waveCrestRate: number;
  lifetimeMin: number;
  lifetimeMax: number;
  buoyancy: number;
  bubbleDrag: number;
  sprayDrag: number;
  scatter: number;
}

export interface DiffuseInfo {
  capacity: number;
  count: number;
  spray: number;
  foam: number;
  bubbles: number;
  time: number;
  generated: number;
  expired: number;
  recycled: number;
}

export interface Phase {
  user: number;
  restDensity: number;
  viscosity: number;
}

export interface ShapeInfo {
  dimension: number;
  nodes: number[];
  references: number;
  origin: number[];
  cell: number;
  lower: number[];
  upper: number[];
  volume: number;
  area: number;
  bytes: number;
  hash: number;
}

export declare const constants: {
  readonly VERSION_MAJOR: 0;
  readonly VERSION_MINOR: 2;
  readonly VERSION_PATCH: 0;
  readonly API_VERSION: 2;
  readonly NAME_SIZE: 32;
  readonly MAX_CAPACITY: 1073741823;
  readonly MAX_COLLIDERS: 4096;
  readonly MAX_SNAPSHOTS: 16;
  readonly MAX_STAGES: 24;
  readonly MAX_ARRAYS: 40;
  readonly MAX_WORLDS: 65536;
  readonly MAX_DIFFUSE: 4194303;
  readonly MAX_EMITTERS: 64;
  readonly MAX_DRAINS: 64;
  readonly MAX_RESERVOIRS: 64;
  readonly MAX_PHASES: 8;
  readonly OK: 0;
  readonly ERROR_INVALID_ARGUMENT: -1;
  readonly ERROR_STRUCT_SIZE: -2;
  readonly ERROR_OUT_OF_MEMORY: -3;
  readonly ERROR_CAPACITY: -4;
  readonly ERROR_NOT_FOUND: -5;
  readonly ERROR_UNAVAILABLE: -6;
  readonly ERROR_UNSUPPORTED: -7;
  readonly ERROR_BUSY: -8;
  readonly ERROR_STATE: -9;
  readonly ERROR_DEVICE: -10;
  readonly ERROR_PLUGIN: -11;
  readonly ERROR_DATA: -12;
  readonly ERROR_CANCELLED: -13;
  readonly DEVICE_CPU: 1;
  readonly DEVICE_CUDA: 2;
  readonly TYPE_FLOAT32: 4;
  readonly TYPE_FLOAT64: 8;
  readonly TYPE_UINT32: 12;
  readonly FIELD_POSITION: 1;
  readonly FIELD_VELOCITY: 2;
  readonly FIELD_ID: 3;
  readonly FIELD_DENSITY: 4;
  readonly FIELD_PRESSURE: 5;
  readonly FLOAT32: 4;
  readonly FLOAT64: 8;
  readonly DETERMINISM_ACROSS_MACHINES: 0;
  readonly DETERMINISM_PER_MACHINE: 1;
  readonly LOG_INFO: 1;
  readonly LOG_WARNING: 2;
  readonly KERNEL_WENDLAND_C2: 0;
  readonly KERNEL_POLY6_SPIKY: 1;
  readonly SOLVER_JACOBI: 0;
  readonly SOLVER_CHEBYSHEV: 1;
  readonly COLLIDE_AFTER_PREDICTION: 1;
  readonly COLLIDE_IN_ITERATION: 2;
  readonly COLLIDE_AFTER_SOLVE: 4;
  readonly PERIODIC_X: 1;
  readonly PERIODIC_Y: 2;
  readonly PERIODIC_Z: 4;
  readonly WALL_X_MIN: 0;
  readonly WALL_X_MAX: 1;
  readonly WALL_Y_MIN: 2;
  readonly WALL_Y_MAX: 3;
  readonly WALL_Z_MIN: 4;
  readonly WALL_Z_MAX: 5;
  readonly COLLIDER_PLANE: 0;
  readonly COLLIDER_SPHERE: 1;
  readonly COLLIDER_CAPSULE: 2;
  readonly COLLIDER_BOX: 3;
  readonly COLLIDER_SHAPE: 4;
  readonly PATH_AUTO: 0;
  readonly PATH_STRAIGHT: 1;
  readonly PATH_SCREW: 2;
  readonly W_CONSTANT: 0;
  readonly W_SPEED: 1;
  readonly W_DENSITY: 2;
  readonly W_PRESSURE: 3;
  readonly ORDER_ADDED: 0;
  readonly ORDER_STORED: 1;
  readonly LIMIT_NONE: 0;
  readonly LIMIT_GRAVITY: 1;
  readonly LIMIT_ATTRACTION: 2;
  readonly LIMIT_PARTICLES: 3;
  readonly LIMIT_WALLS: 4;
  readonly LIMIT_COLLIDERS: 5;
  readonly LIMIT_TENSION: 6;
  readonly DIFFUSE_SPRAY: 0;
  readonly DIFFUSE_FOAM: 1;
  readonly DIFFUSE_BUBBLE: 2;
  readonly VOLUME_BOX: 0;
  readonly VOLUME_SPHERE: 1;
  readonly VOLUME_CAPSULE: 2;
  readonly EMITTER_RECTANGLE: 0;
  readonly EMITTER_DISC: 1;
};
