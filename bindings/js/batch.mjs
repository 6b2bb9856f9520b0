// Many worlds of one kind in one call.
import { constants } from "./abi.g.mjs";
import {
  PbfError, check, exports, filled, invalid, load, logs, made, numberOf, read, readNumber, textAt, withBytes, withRows, withStruct,
} from "./module.mjs";
import { withColliders } from "./shape.mjs";
import { Solver, WORLD } from "./solver.mjs";

// What is collected without destroy() is destroyed then.
const forgotten = new FinalizationRegistry(({ handle, user }) => {
  exports.pbf_batch_destroy(handle);
  logs.delete(user);
});

/**
 * Worlds alike in kind and capacity. Arrays are world after world; a mask is an array of truth values, one a world, and
 * undefined is all of them. Where a world fails the others go on, and the call throws what the first one met.
 */
export class Batch {
  #handle;
  #user;
  #dimension;
  #Array;
  #worlds;

  /** Loads the module where that has not been done. The options are those of a Solver, and worlds. */
  static async create(options) {
    await load(undefined, { threads: options.threads });
    return new Batch(options);
  }

  /** After load(). */
  constructor(options = {}) {
    this.#worlds = numberOf("options.worlds", "u32", options.worlds);
    const { handle, user, dimension, Array } = made(options, ["worlds"],
      (desc, params, at) => exports.pbf_batch_create(desc, params, this.#worlds, at));
    this.#handle = handle;
    this.#user = user;
    this.#dimension = dimension;
    this.#Array = Array;
    forgotten.register(this, { handle, user }, this);
  }

  #call(name, ...args) {
    if (!this.#handle) throw invalid("the batch is destroyed");
    check(exports[name](this.#handle, ...args));
  }

  /** Destroys it now, and its worlds. Nothing else can be called then; a second time does nothing. */
  destroy() {
    if (!this.#handle) return;
    forgotten.unregister(this);
    exports.pbf_batch_destroy(this.#handle);
    this.#handle = 0;
    logs.delete(this.#user);
  }

  [Symbol.dispose ?? Symbol.for("Symbol.dispose")]() {
    this.destroy();
  }

  get destroyed() {
    return !this.#handle;
  }

  /** How many worlds there are. */
  get length() {
    return this.#worlds;
  }

  get info() {
    return withStruct("pbf_batch_info", "info", {}, (at) => {
      this.#call("pbf_batch_get_info", at);
      return read("pbf_batch_info", at);
    });
  }

  /** World 0 and so on as a solver, between calls of the batch. */
  world(world) {
    return withBytes(4, (at) => {
      this.#call("pbf_batch_get_world", numberOf("world", "u32", world), at);
      return new Solver({ [WORLD]: { handle: readNumber("u32", at), user: 0, dimension: this.#dimension, Array: this.#Array, batch: this } });
    });
  }

  /** Of each world the error that it met in the last call that went through worlds, or null. */
  get failures() {
    const statuses = filled(Int32Array, this.#worlds, (at) => this.#call("pbf_batch_get_statuses", at));
    return Array.from(statuses, (status, world) => status && withBytes(4, (at) => {
      this.#call("pbf_batch_get_sentence", world, at);
      return new PbfError(status, textAt(exports.pbf_status_string(status)), textAt(readNumber("u32", at)));
    })).map((failure) => failure || null);
  }

  #withMask(mask, use) {
    if (mask === undefined || mask === null) return use(0);
    if (mask.length !== this.#worlds) throw invalid(`mask has ${mask.length} values, of ${this.#worlds} worlds`);
    return withRows("mask", Array.from(mask, (chosen) => (chosen ? 1 : 0)), 1, Uint8Array, use);
  }

  #each(where, has, each) {
    if (has !== this.#worlds * each) throw invalid(`${where} has ${has} rows, not as many for each of ${this.#worlds} worlds`);
  }

  step(steps = 1, mask) {
    this.#withMask(mask, (chosen) => this.#call("pbf_batch_step", chosen, numberOf("steps", "u32", steps)));
  }

  /** What reset goes back to: a state of save, or the present one of each. */
  setStart(state, mask) {
    this.#withMask(mask, (chosen) => withRows("state", state ?? [], 1, Uint8Array,
      (at, size) => this.#call("pbf_batch_set_start", chosen, state ? at : 0, BigInt(size))));
  }

  reset(mask) {
    this.#withMask(mask, (chosen) => this.#call("pbf_batch_reset", chosen));
  }

  /** Three numbers a world. */
  setGravity(gravity, mask) {
    this.#withMask(mask, (chosen) => withRows("gravity", gravity, 3, Float64Array, (at, rows) => {
      this.#each("gravity", rows, 1);
      this.#call("pbf_batch_set_gravity", chosen, at);
    }));
  }

  /** The same ones for all. */
  setColliders(colliders, mask) {
    this.#withMask(mask, (chosen) => withColliders("colliders", colliders, (count, at) => this.#call("pbf_batch_set_colliders", chosen, count, at)));
  }

  /** All that each world has, three numbers each, and four of an orientation; without these they keep theirs. */
  moveColliders(positions, duration, orientations, mask) {
    const time = numberOf("duration", "f64", duration);
    this.#withMask(mask, (chosen) => withRows("positions", positions, 3, Float64Array, (x, rows) => {
      const count = Math.floor(rows / this.#worlds);
      this.#each("positions", rows, count);
      withRows("orientations", orientations ?? [], 4, Float64Array, (turns, others) => {
        if (orientations) this.#each("orientations", others, count);
        this.#call("pbf_batch_move_colliders", chosen, count, x, orientations ? turns : 0, time);
      });
    }));
  }

  /** So many to each world; without velocities they are at rest. */
  addParticles(counts, positions, velocities) {
    const wanted = Array.from(counts).reduce((all, count, k) => all + numberOf(`counts[${k}]`, "u32", count), 0);
    withRows("counts", counts, 1, Uint32Array, (numbers, worlds) => {
      this.#each("counts", worlds, 1);
      withRows("positions", positions, this.#dimension, this.#Array, (x, rows) =>
        withRows("velocities", velocities ?? [], this.#dimension, this.#Array, (v, others) => {
          if (rows !== wanted || (velocities && others !== wanted)) {
            throw invalid(`there are ${rows} positions and ${velocities ? others : "no"} velocities; by counts there must be ${wanted}`);
          }
          this.#call("pbf_batch_add_particles", numbers, x, velocities ? v : 0);
        }));
    });
  }

  /** Particles of each world. */
  get counts() {
    return filled(Uint32Array, this.#worlds, (at) => this.#call("pbf_batch_get_counts", at));
  }

  /**
   * "position", "velocity", "density", "pressure" or "id" of each world: an array of shape (worlds, rows, components), as many
   * rows as the world has that has most; rows that a world lacks are 0.
   */
  read(field, mask) {
    const number = constants[`FIELD_${String(field).toUpperCase()}`];
    if (number === undefined) throw invalid(`field is ${String(field)}; it must be one of position, velocity, density, pressure, id`);
    const rows = Math.max(...this.counts), width = field === "position" || field === "velocity" ? this.#dimension : 1;
    const Type = field === "id" ? Uint32Array : this.#Array;
    return this.#withMask(mask, (chosen) => filled(Type, this.#worlds * rows * width, (data) => {
      new Type(exports.memory.buffer, data, this.#worlds * rows * width).fill(0); // of worlds that the mask leaves out
      withStruct("pbf_read_desc", "read", { field: number, count: rows, data }, (at) => this.#call("pbf_batch_read", chosen, at, 0n));
    }));
  }
}
