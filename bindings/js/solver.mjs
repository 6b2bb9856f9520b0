// A fluid.
import { constants, structs } from "./abi.g.mjs";
import {
  PbfError, check, exports, filled, invalid, load, logs, made, named, numberOf, read, readNumber, view, withBytes, withRows, withStruct,
  withStructs, write, writeNumber,
} from "./module.mjs";
import { colliderFrom, withColliders } from "./shape.mjs";

/** Of the options of a solver that is a world of a batch, for batch.mjs. */
export const WORLD = Symbol("world");

function end({ handle, user, kept }) {
  if (handle) exports.pbf_destroy(handle);
  logs.delete(user);
  for (const { pointer } of kept.values()) exports.free(pointer);
  kept.clear();
}

// What is collected without destroy() is destroyed then.
const forgotten = new FinalizationRegistry(end);

const volumeKinds = ["box", "sphere", "capsule"], volumeOf = named(volumeKinds);
const openings = ["rectangle", "disc"], openingOf = named(openings);
const sampled = ["densities", "velocities", "pressures", "wet"];

const withVolumes = (where, volumes, use) => withStructs("pbf_volume", where, volumes, "pbf_volume_init", volumeOf, use);

/** A fluid. */
export class Solver {
  #handle = 0;
  #user = 0;
  #dimension;
  #Array; // Float32Array or Float64Array
  #batch; // that it is a world of
  #kept = new Map(); // memory of the module that fields are read into, by the function that does

  /** Loads the module where that has not been done, and makes a solver. */
  static async create(options = {}) {
    await load(undefined, { threads: options.threads });
    return new Solver(options);
  }

  /** After load(). */
  constructor(options = {}) {
    const { [WORLD]: world } = options;
    const { handle, user, dimension, Array } = world ?? made(options, [], (desc, params, at) => exports.pbf_create(desc, params, at));
    this.#handle = handle;
    this.#user = user;
    this.#dimension = dimension;
    this.#Array = Array;
    this.#batch = world?.batch;
    forgotten.register(this, { handle: world ? 0 : handle, user, kept: this.#kept }, this);
  }

  #call(name, ...args) {
    if (!this.#handle || this.#batch?.destroyed) throw invalid("the solver is destroyed");
    check(exports[name](this.#handle, ...args));
  }

  /** Destroys it now. Nothing else can be called then; a second time does nothing. A world of a batch stays in that. */
  destroy() {
    if (!this.#handle) return;
    forgotten.unregister(this);
    end({ handle: this.#batch ? 0 : this.#handle, user: this.#user, kept: this.#kept });
    this.#handle = 0;
  }

  [Symbol.dispose ?? Symbol.for("Symbol.dispose")]() {
    this.destroy();
  }

  // ---- Steps and parameters

  step(steps = 1) {
    this.#call("pbf_step", numberOf("steps", "u32", steps));
  }

  get params() {
    return this.#struct("pbf_get_params", "pbf_params");
  }

  /** What changes; the others stay. */
  setParams(changes) {
    const { size } = structs.pbf_params;
    withBytes(size, (at) => {
      writeNumber("u32", at, size);
      this.#call("pbf_get_params", at);
      write("pbf_params", "params", at, changes);
      this.#call("pbf_set_params", at);
    });
  }

  #struct(call, name, ...args) {
    return withStruct(name, "", {}, (at) => {
      this.#call(call, ...args, at);
      return read(name, at);
    });
  }

  get stats() {
    return this.#struct("pbf_get_stats", "pbf_stats");
  }

  get info() {
    return this.#struct("pbf_get_info", "pbf_info");
  }

  get plan() {
    const plan = this.#struct("pbf_get_plan", "pbf_plan");
    plan.stages.length = plan.stageCount;
    plan.arrays.length = plan.arrayCount;
    return plan;
  }

  setTiming(enabled) {
    this.#call("pbf_set_timing", enabled ? 1 : 0);
  }

  get timings() {
    const timings = this.#struct("pbf_get_timings", "pbf_timings");
    timings.stages.length = timings.stageCount;
    return timings;
  }

  get stepLimit() {
    return this.#number("f64", "pbf_get_step_limit");
  }

  #number(what, name, ...args) {
    return withBytes(8, (at) => {
      this.#call(name, ...args, at);
      return readNumber(what, at);
    });
  }

  // ---- Particles

  get dimension() {
    return this.#dimension;
  }

  get count() {
    return this.#number("u32", "pbf_get_count");
  }

  #withRows(where, values, components, use, Type = this.#Array) {
    return withRows(where, values, components, Type, use);
  }

  /** Gives the id of the first one. Without velocities they are at rest. */
  addParticles(positions, velocities) {
    return this.#withRows("positions", positions, this.#dimension, (x, rows) => {
      if (!velocities) return this.#number("u32", "pbf_add_particles", rows, x, 0);
      return this.#withRows("velocities", velocities, this.#dimension, (v, others) => {
        if (others !== rows) throw invalid(`velocities has ${others} rows, positions ${rows}`);
        return this.#number("u32", "pbf_add_particles", rows, x, v);
      });
    });
  }

  removeParticles(ids) {
    this.#withRows("ids", ids, 1, (at, rows) => this.#call("pbf_remove_particles", rows, at), Uint32Array);
  }

  #withBox(lower, upper, use) {
    for (const [where, corner] of Object.entries({ lower, upper })) {
      if (corner?.length === this.#dimension || corner?.length === 3) continue;
      throw invalid(`${where} has ${corner?.length ?? 0} numbers; it must have ${this.#dimension}`);
    }
    const corners = [...lower, 0].slice(0, 3).concat([...upper, 0].slice(0, 3));
    return this.#withRows("corners", corners, 1, (at) => use(at, at + 24), Float64Array);
  }

  /** Gives how many they were. */
  removeInBox(lower, upper) {
    return this.#withBox(lower, upper, (low, high) => this.#number("u32", "pbf_remove_in_box", low, high));
  }

  /** Gives their ids: a Uint32Array. */
  findInBox(lower, upper) {
    const room = this.count;
    return this.#withBox(lower, upper, (low, high) => withBytes(4 * room, (ids) => {
      const found = this.#number("u32", "pbf_find_in_box", low, high, room, ids);
      return new Uint32Array(exports.memory.buffer, ids, found).slice();
    }));
  }

  // Reads into memory of the module that stays; the array is a view of it.
  #rows(name, components, Type = this.#Array) {
    const rows = this.count, size = rows * components * Type.BYTES_PER_ELEMENT;
    let kept = this.#kept.get(name);
    if (!kept || kept.size < size) {
      if (kept) exports.free(kept.pointer);
      this.#kept.delete(name);
      kept = { pointer: exports.malloc(Math.max(size, 16)) >>> 0, size };
      if (!kept.pointer) {
        throw new PbfError(constants.ERROR_OUT_OF_MEMORY, "PBF_ERROR_OUT_OF_MEMORY", `${size} bytes are not to be had`);
      }
      this.#kept.set(name, kept);
    }
    this.#call(name, 0, rows, kept.pointer);
    return new Type(exports.memory.buffer, kept.pointer, rows * components);
  }

  /**
   * In the order of adding, dimension numbers a particle. Like the next four a view of the module's memory: it holds
   * until the same is read again, the solver is destroyed, or any call makes the memory grow. slice() keeps it.
   */
  get positions() {
    return this.#rows("pbf_get_positions", this.#dimension);
  }

  get velocities() {
    return this.#rows("pbf_get_velocities", this.#dimension);
  }

  get densities() {
    return this.#rows("pbf_get_densities", 1);
  }

  get pressures() {
    return this.#rows("pbf_get_pressures", 1);
  }

  get ids() {
    return this.#rows("pbf_get_ids", 1, Uint32Array);
  }

  /** Of the rows from `first` on. */
  setPositions(values, first = 0) {
    this.#withRows("positions", values, this.#dimension, (at, rows) => this.#call("pbf_set_positions", numberOf("first", "u32", first), rows, at));
  }

  setVelocities(values, first = 0) {
    this.#withRows("velocities", values, this.#dimension, (at, rows) => this.#call("pbf_set_velocities", numberOf("first", "u32", first), rows, at));
  }

  /** Beside gravity, in each step from now on; null takes all away. */
  setAccelerations(values, first = 0) {
    if (values === null) return this.#call("pbf_set_accelerations", 0, 0, 0);
    this.#withRows("accelerations", values, this.#dimension, (at, rows) => this.#call("pbf_set_accelerations", numberOf("first", "u32", first), rows, at));
  }

  /**
   * Calls with the solver's own arrays of a field, without a copy: an array for each component, in the solver's order,
   * and the ids in it. They are read only and gone afterwards; meanwhile calls that change particles throw.
   */
  map(field, use) {
    const number = constants[`FIELD_${String(field).toUpperCase()}`];
    if (number === undefined) throw invalid(`field is ${String(field)}; it must be one of position, velocity, id, pressure`);
    const { size } = structs.pbf_view;
    return withBytes(size, (at) => {
      writeNumber("u32", at, size);
      this.#call("pbf_map", number, at);
      try {
        return use(this.#mapped(read("pbf_view", at)));
      } finally {
        this.#call("pbf_unmap", number);
      }
    });
  }

  #mapped(mapped) {
    const Type = mapped.elementType === constants.TYPE_UINT32 ? Uint32Array : this.#Array;
    const { buffer } = exports.memory, step = mapped.particleStride / Type.BYTES_PER_ELEMENT;
    const components = Array.from({ length: mapped.components }, (_, k) =>
      new Type(buffer, mapped.data + k * mapped.componentStride, mapped.count ? (mapped.count - 1) * step + 1 : 0));
    return { components, stride: step, count: mapped.count, ids: new Uint32Array(buffer, mapped.ids, mapped.count) };
  }

  // ---- Colliders

  /**
   * { shape: "sphere", position: […], radius: … } and so on, as pbf_collider has them; { shape: rock, position: […] } is of a
   * Shape.
   */
  setColliders(colliders) {
    withColliders("colliders", colliders, (count, at) => this.#call("pbf_set_colliders", count, at));
  }

  /** To these poses and sizes, in this time from now. */
  moveColliders(targets, duration) {
    const time = numberOf("duration", "f64", duration);
    withColliders("targets", targets, (count, at) => this.#call("pbf_move_colliders", count, at, time));
  }

  get colliders() {
    return this.#list(this.#number("u32", "pbf_get_collider_count"), "pbf_get_collider", "pbf_collider")
      .map((values) => colliderFrom(values, this.#dimension));
  }

  #list(count, call, name) {
    return Array.from({ length: count }, (_, index) => this.#struct(call, name, index));
  }

  #loads(name, count) {
    const { size } = structs.pbf_collider_load;
    return withBytes(size * count, (at) => {
      for (let k = 0; k < count; ++k) writeNumber("u32", at + k * size, size);
      this.#call(name, count, at);
      return Array.from({ length: count }, (_, k) => read("pbf_collider_load", at + k * size));
    });
  }

  /** What the fluid does to each collider; begins their sums anew. Wants params.loads. */
  colliderLoads() {
    return this.#loads("pbf_get_collider_loads", this.#number("u32", "pbf_get_collider_count"));
  }

  /** The same of the domain's walls, by constants.WALL_X_MIN and so on. */
  wallLoads() {
    return this.#loads("pbf_get_wall_loads", 2 * this.#dimension);
  }

  // ---- Questions by place: points have dimension numbers each, answers are arrays of their own

  /** The ids of the particles there, ascending: a Uint32Array. */
  findIn(volume) {
    const room = this.count;
    return withVolumes("volumes", [volume], (_, at) => withBytes(4 * room, (ids) => {
      const found = this.#number("u32", "pbf_find_in_volume", at, room, ids);
      return new Uint32Array(exports.memory.buffer, ids, found).slice();
    }));
  }

  /** How much of each volume is below the surface, and how that flows. */
  measure(volumes) {
    const { size } = structs.pbf_volume_flow;
    return withVolumes("volumes", volumes, (count, at) => withBytes(size * count, (flows) => {
      for (let k = 0; k < count; ++k) writeNumber("u32", flows + k * size, size);
      this.#call("pbf_measure_volumes", count, at, flows);
      return Array.from({ length: count }, (_, k) => read("pbf_volume_flow", flows + k * size));
    }));
  }

  // Calls with a pbf_samples for so many points, and gives the arrays of these fields.
  #sampled(count, points, fields, use) {
    const arrays = [...fields].map((field) => {
      const Type = field === "wet" ? Uint8Array : Float64Array;
      if (!sampled.includes(field)) throw invalid(`fields has ${String(field)}; each must be one of ${sampled.join(", ")}`);
      return [field, Type, field === "velocities" ? count * this.#dimension : count];
    });
    return this.#withArrays(arrays, (places) => withStruct("pbf_samples", "points", { count, points, ...places }, use));
  }

  // Calls with places for arrays, each [name, Type, length], by their names, and gives the arrays that are there then.
  #withArrays(arrays, use) {
    const starts = [0];
    for (const [, Type, length] of arrays) starts.push(starts.at(-1) + 8 * Math.ceil((length * Type.BYTES_PER_ELEMENT) / 8));
    return withBytes(starts.at(-1), (at) => {
      use(Object.fromEntries(arrays.map(([name], k) => [name, at + starts[k]])));
      return Object.fromEntries(arrays.map(([name, Type, length], k) => [name, new Type(exports.memory.buffer, at + starts[k], length).slice()]));
    });
  }

  /** Arrays of "densities" (over that at rest), "velocities", "pressures" and "wet" (1 or 0) at points. */
  sample(points, fields = ["densities", "velocities"]) {
    return this.#withRows("points", points, this.#dimension,
      (x, rows) => this.#sampled(rows, x, fields, (at) => this.#call("pbf_sample", at)), Float64Array);
  }

  /** The same at the points origin + (i, j, k) step of { counts, origin, step }; the last index is the fastest. */
  sampleOnGrid(grid, fields = ["densities", "velocities"]) {
    return withStruct("pbf_sample_grid", "grid", grid, (place) => {
      const count = read("pbf_sample_grid", place).counts.slice(0, this.#dimension).reduce((a, b) => a * b);
      return this.#sampled(count, 0, fields, (at) => this.#call("pbf_sample_on_grid", place, at));
    });
  }

  /** Where rays meet the surface: { distances, normals }, Infinity where they do not within `length`. */
  castRays(origins, directions, length = Infinity) {
    const components = this.#dimension, longest = numberOf("length", "f64", length);
    return this.#withRows("origins", origins, components, (x, rows) => this.#withRows("directions", directions, components, (to, others) => {
      if (others !== rows) throw invalid(`directions has ${others} rows, origins ${rows}`);
      let distances;
      const normals = filled(Float64Array, rows * components, (n) => {
        distances = filled(Float64Array, rows, (d) => this.#call("pbf_cast_rays", rows, x, to, longest, d, n));
      });
      return { distances, normals };
    }, Float64Array), Float64Array);
  }

  /** How high the water stands at points, against gravity; NaN where there is none. */
  levels(points) {
    return this.#withRows("points", points, this.#dimension,
      (x, rows) => filled(Float64Array, rows, (at) => this.#call("pbf_get_levels", rows, x, at)), Float64Array);
  }

  /** Gives back the memory that queries keep. */
  endQueries() {
    this.#call("pbf_end_queries");
  }

  // ---- What comes and goes in each step

  /** Replaces all: { shape: "disc", position: […], velocity: […], radius: … } and so on, as pbf_emitter has them. */
  setEmitters(emitters) {
    withStructs("pbf_emitter", "emitters", emitters, "pbf_emitter_init", openingOf, (count, at) => this.#call("pbf_set_emitters", count, at));
  }

  get emitters() {
    return this.#list(this.inOut.emitters, "pbf_get_emitter", "pbf_emitter").map((values) => ({ ...values, shape: openings[values.shape] }));
  }

  /** What is in one of these volumes when a step begins is removed. */
  setDrains(drains) {
    withVolumes("drains", drains, (count, at) => this.#call("pbf_set_drains", count, at));
  }

  get drains() {
    return this.#list(this.inOut.drains, "pbf_get_drain", "pbf_volume").map((values) => ({ ...values, shape: volumeKinds[values.shape] }));
  }

  /** Open boundaries of given level or pressure: { position: […], halfExtents: […], depth: … } and so on. */
  setReservoirs(reservoirs) {
    withStructs("pbf_reservoir", "reservoirs", reservoirs, "pbf_reservoir_init", null, (count, at) => this.#call("pbf_set_reservoirs", count, at));
  }

  get reservoirs() {
    return this.#list(this.#number("u32", "pbf_get_reservoir_count"), "pbf_get_reservoir", "pbf_reservoir");
  }

  /** What came and went, in particles. */
  get inOut() {
    return this.#struct("pbf_get_in_out", "pbf_in_out");
  }

  // ---- Spray, foam and bubbles, for looks

  #withDiffuse(changes, use) {
    const { size } = structs.pbf_diffuse_desc;
    return withBytes(size, (at) => {
      this.#call("pbf_diffuse_init", at, size);
      write("pbf_diffuse_desc", "diffuse", at, changes);
      return use(at);
    });
  }

  /** What suits the solver's dimension, smoothingRadius, spacing and gravity. */
  get defaultDiffuse() {
    return this.#withDiffuse({}, (at) => read("pbf_diffuse_desc", at));
  }

  /** Has steps make and move them: what differs from defaultDiffuse, { capacity: 30000 } say. null ends them. */
  setDiffuse(changes) {
    if (changes === null) return this.#call("pbf_set_diffuse", 0);
    if (typeof changes !== "object") throw invalid(`diffuse is ${String(changes)}; it must be an object or null`);
    this.#withDiffuse(changes, (at) => this.#call("pbf_set_diffuse", at));
  }

  /** What they are made by; null: there are none. */
  get diffuse() {
    return this.diffuseInfo.capacity ? this.#struct("pbf_get_diffuse", "pbf_diffuse_desc") : null;
  }

  /** How many there are, by kind, and what became of others. */
  get diffuseInfo() {
    return this.#struct("pbf_get_diffuse_info", "pbf_diffuse_info");
  }

  /** All of them, the oldest first, in arrays of their own: { positions, velocities, ages, lives, kinds, ids }. */
  get diffuseParticles() {
    const { count } = this.diffuseInfo, Reals = this.#Array, vectors = count * this.#dimension;
    const arrays = [
      ["positions", Reals, vectors], ["velocities", Reals, vectors], ["ages", Reals, count], ["lives", Reals, count],
      ["kinds", Uint32Array, count], ["ids", BigUint64Array, count],
    ];
    return this.#withArrays(arrays, (places) => withStruct("pbf_diffuse_read", "diffuse", { count, ...places }, (at) => this.#call("pbf_read_diffuse", at)));
  }

  /** Adds your own, as many as `lives` has numbers, the times that they have; without velocities they are at rest. */
  addDiffuse(positions, velocities, lives) {
    const components = this.#dimension;
    this.#withRows("lives", lives, 1, (times, rows) => this.#withRows("positions", positions, components, (x, others) => {
      if (others !== rows) throw invalid(`positions has ${others} rows, lives ${rows} numbers`);
      if (!velocities) return this.#call("pbf_add_diffuse", rows, x, 0, times);
      this.#withRows("velocities", velocities, components, (v, those) => {
        if (those !== rows) throw invalid(`velocities has ${those} rows, lives ${rows} numbers`);
        this.#call("pbf_add_diffuse", rows, x, v, times);
      });
    }));
  }

  /** Moves all of them, as where the world's origin is moved. */
  shiftDiffuse(way) {
    this.#withRows("way", way, this.#dimension, (at, rows) => {
      if (rows !== 1) throw invalid(`way has ${way.length} numbers; it must have ${this.#dimension}`);
      this.#call("pbf_shift_diffuse", at);
    }, Float64Array);
  }

  // ---- Several fluids

  /** Replaces all phases, { restDensity: 0.9 } and so on; with none all particles are alike again. */
  setPhases(phases) {
    withStructs("pbf_phase", "phases", phases, "pbf_phase_init", null, (count, at) => this.#call("pbf_set_phases", count, at));
  }

  get phases() {
    return this.#list(this.#number("u32", "pbf_get_phase_count"), "pbf_get_phase", "pbf_phase");
  }

  /** Which phase particles are of, from the row `first` on. */
  setParticlePhases(phases, first = 0) {
    for (const [k, phase] of Array.from(phases).entries()) numberOf(`phases[${k}]`, "u32", phase);
    this.#withRows("phases", phases, 1, (at, rows) => this.#call("pbf_set_particle_phases", numberOf("first", "u32", first), rows, at), Uint32Array);
  }

  /** A view, as positions are. */
  get particlePhases() {
    return this.#rows("pbf_get_particle_phases", 1, Uint32Array);
  }

  // ---- State

  /** Bytes that load takes. */
  save() {
    return withBytes(8, (size) => {
      this.#call("pbf_save", 0, size);
      const bytes = readNumber("u64", size);
      return withBytes(bytes, (at) => {
        this.#call("pbf_save", at, size);
        return new Uint8Array(exports.memory.buffer, at, readNumber("u64", size)).slice();
      });
    });
  }

  load(state) {
    withBytes(state.length, (at) => {
      new Uint8Array(exports.memory.buffer, at).set(state);
      this.#call("pbf_load", at, BigInt(state.length));
    });
  }

  /** Of positions, velocities and ids: 16 hexadecimal digits, the same on every machine. */
  get hash() {
    return withBytes(8, (at) => {
      this.#call("pbf_hash", at);
      return view().getBigUint64(at, true).toString(16).padStart(16, "0");
    });
  }
}
