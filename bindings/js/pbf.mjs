// Position based fluids for pages and node: the C library pbf as one WebAssembly module. pbf.h says what each
// parameter and call does; names are those there in camelCase.
//
//   import { Solver } from "./pbf.mjs";
//   const fluid = await Solver.create({ capacity: 4000, params: { domainMax: [2, 1, 1] } });
//   fluid.addParticles([0.5, 0.5, 0.5, 0.6, 0.5, 0.5]);
//   fluid.step(10);
//   fluid.positions;                     // a Float32Array, three numbers a particle
//
// A call that fails throws a PbfError with the library's sentence, and leaves the solver as it was.
import { constants, structs } from "./abi.g.mjs";

export { constants };

/** What the library has refused: `status` is a PBF_ERROR number, `code` its name, `message` the sentence. */
export class PbfError extends Error {
  constructor(status, code, message) {
    super(message);
    this.name = "PbfError";
    this.status = status;
    this.code = code;
  }
}

function invalid(message) {
  return new PbfError(constants.ERROR_INVALID_ARGUMENT, "PBF_ERROR_INVALID_ARGUMENT", message);
}

// ---- The module ----

let exports; // of the instance: the library's functions
const logs = new Map(); // by the number that the library gets as log_user
let lastLog = 0;

const text = new TextDecoder();

function textAt(pointer, most = Infinity) {
  const bytes = new Uint8Array(exports.memory.buffer, pointer);
  let length = 0;
  while (length < most && bytes[length]) ++length;
  return text.decode(bytes.slice(0, length)); // a copy: shared memory is not decoded
}

// A page's log that throws must not do so through the library: the error goes on after the call.
let thrown;
function log(user, level, message) {
  try {
    logs.get(user)?.(level, textAt(message));
  } catch (error) {
    thrown ??= error;
  }
}

// What the C library asks of its host. There are no files, no variables and no arguments.
const EBADF = 8;
const host = {
  clock_time_get(clock, precision, time) {
    const now = clock === 0 ? Date.now() : performance.now();
    new DataView(exports.memory.buffer).setBigUint64(time, BigInt(Math.round(now * 1e6)), true);
    return 0;
  },
  environ_sizes_get(count, size) {
    const view = new DataView(exports.memory.buffer);
    view.setUint32(count, 0, true);
    view.setUint32(size, 0, true);
    return 0;
  },
  environ_get: () => 0,
  fd_write: () => EBADF,
  fd_read: () => EBADF,
  fd_close: () => EBADF,
  fd_seek: () => EBADF,
  proc_exit(status) {
    throw new Error(`pbf has ended with ${status}`);
  },
};

const imports = { pbf: { log }, wasi_snapshot_preview1: host, env: { emscripten_notify_memory_growth() {} } };

async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (typeof Response !== "undefined" && source instanceof Response) return WebAssembly.compile(await source.arrayBuffer());
  // Bundlers look for the first of these as it stands here.
  const url = source === undefined ? new URL("./pbf.wasm", import.meta.url) : new URL(source, globalThis.location?.href ?? import.meta.url);
  if (url.protocol === "file:") return WebAssembly.compile(await (await import("node:fs/promises")).readFile(url));
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} can't be read: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

let loading;

/**
 * Loads the module once: from pbf.wasm beside this file, or from a URL, a Response, bytes or a compiled module.
 * Solver.create does it where it has not been done.
 */
export function load(source) {
  loading ??= compiled(source)
    .then(async (module) => {
      const instance = await WebAssembly.instantiate(module, imports);
      exports = instance.exports;
      exports._initialize?.();
    })
    .catch((error) => {
      loading = undefined; // another source may do
      throw error;
    });
  return loading;
}

/** "0.2.0". After load(). */
export function version() {
  if (!exports) throw invalid("the module is not loaded; await load() first");
  const number = exports.pbf_version();
  return `${Math.trunc(number / 1e6)}.${Math.trunc(number / 1e3) % 1000}.${number % 1000}`;
}

function check(status) {
  const error = thrown;
  thrown = undefined;
  if (status !== 0) {
    throw new PbfError(status, textAt(exports.pbf_status_string(status)), textAt(exports.pbf_last_error()));
  }
  if (error !== undefined) throw error;
}

// ---- Memory of the module ----

// Calls with so many bytes of it, which are given back.
function withBytes(size, use) {
  const pointer = exports.malloc(Math.max(size, 1)) >>> 0;
  if (!pointer) {
    throw new PbfError(constants.ERROR_OUT_OF_MEMORY, "PBF_ERROR_OUT_OF_MEMORY", `${size} bytes are not to be had`);
  }
  try {
    return use(pointer);
  } finally {
    exports.free(pointer);
  }
}

const view = () => new DataView(exports.memory.buffer);

const bytesOf = { u32: 4, i32: 4, u64: 8, i64: 8, f64: 8, pointer: 4, text: 1 };

function readNumber(what, at) {
  switch (what) {
    case "f64": return view().getFloat64(at, true);
    case "u64": return Number(view().getBigUint64(at, true));
    case "i64": return Number(view().getBigInt64(at, true));
    case "i32": return view().getInt32(at, true);
    default: return view().getUint32(at, true);
  }
}

function writeNumber(what, at, value) {
  switch (what) {
    case "f64": return view().setFloat64(at, value, true);
    case "u64": return view().setBigUint64(at, BigInt(value), true);
    case "i64": return view().setBigInt64(at, BigInt(value), true);
    case "i32": return view().setInt32(at, value, true);
    default: return view().setUint32(at, value, true);
  }
}

function readField([what, offset, count], at) {
  if (what === "text") return textAt(at + offset, count);
  const one = (k) => {
    const size = structs[what]?.size ?? bytesOf[what];
    return structs[what] ? read(what, at + offset + k * size) : readNumber(what, at + offset + k * size);
  };
  return count ? Array.from({ length: count }, (_, k) => one(k)) : one(0);
}

function read(name, at) {
  const values = {};
  for (const [field, place] of Object.entries(structs[name].fields)) {
    if (field !== "structSize" && field !== "reserved") values[field] = readField(place, at);
  }
  return values;
}

function numberOf(where, what, value) {
  const number = typeof value === "boolean" ? Number(value) : value;
  if (typeof number !== "number") throw invalid(`${where} is ${String(value)}; it must be a number`);
  if (what === "f64" || (Number.isInteger(number) && number >= (what === "i32" ? -(2 ** 31) : 0) && number < 2 ** 32)) return number;
  throw invalid(`${where} is ${number}; it must be a whole number of 32 bits`);
}

// What is given of a struct, over what it holds.
function write(name, where, at, values) {
  const { fields } = structs[name];
  for (const [field, value] of Object.entries(values)) {
    const place = fields[field];
    if (value === undefined) continue;
    if (!place || field === "structSize" || field === "reserved") {
      const known = Object.keys(fields).filter((one) => one !== "structSize" && one !== "reserved");
      throw invalid(`${where} has no ${field}; it has ${known.join(", ")}`);
    }
    const [what, offset, count] = place;
    if (!count) {
      writeNumber(what, at + offset, numberOf(`${where}.${field}`, what, value));
      continue;
    }
    if (typeof value !== "object" || value === null) throw invalid(`${where}.${field} is ${String(value)}; it must be an array of numbers`);
    const given = Array.from(value);
    if (given.length > count || !given.length) {
      throw invalid(`${where}.${field} has ${given.length} numbers; it takes up to ${count}`);
    }
    given.forEach((one, k) => {
      const number = numberOf(`${where}.${field}[${k}]`, what, one);
      writeNumber(what, at + offset + k * bytesOf[what], number);
    });
  }
}

// ---- Solvers ----

// What is collected without destroy() is destroyed then.
const forgotten = new FinalizationRegistry(({ handle, user }) => {
  exports.pbf_destroy(handle);
  logs.delete(user);
});

const shapes = ["plane", "sphere", "capsule", "box"];
const descOptions = ["dimension", "precision", "capacity", "strict", "isa", "log", "params"];

function shapeOf(where, shape) {
  const number = shapes.indexOf(shape);
  if (number < 0) throw invalid(`${where}.shape is ${String(shape)}; it must be one of ${shapes.join(", ")}`);
  return number;
}

function withText(value, use) {
  if (value === undefined || value === null) return use(0);
  const bytes = new TextEncoder().encode(`${value}\0`);
  return withBytes(bytes.length, (pointer) => {
    new Uint8Array(exports.memory.buffer, pointer).set(bytes);
    return use(pointer);
  });
}

function writeDesc(at, options, isa, user) {
  for (const name of Object.keys(options)) {
    if (!descOptions.includes(name)) throw invalid(`options has no ${name}; it has ${descOptions.join(", ")}`);
  }
  const { dimension, precision, capacity, strict } = options;
  write("pbf_desc", "options", at, { dimension, precision, capacity, strict });
  const { fields } = structs.pbf_desc;
  writeNumber("u32", at + fields.isa[1], isa);
  if (!user) return;
  writeNumber("u32", at + fields.log[1], exports.pbf_js_log_function());
  writeNumber("u32", at + fields.logUser[1], user);
}

/** A fluid. */
export class Solver {
  #handle = 0;
  #user = 0;
  #dimension;
  #Array; // Float32Array or Float64Array
  #kept = new Map(); // memory of the module that fields are read into, by their name

  /** Loads the module where that has not been done, and makes a solver. */
  static async create(options = {}) {
    await load();
    return new Solver(options);
  }

  /** After load(). */
  constructor(options = {}) {
    if (!exports) throw invalid("the module is not loaded; await load() first, or Solver.create()");
    if (options.log && typeof options.log !== "function") throw invalid(`options.log is ${String(options.log)}; it must be a function`);
    if (options.log) logs.set((this.#user = ++lastLog), options.log);
    try {
      this.#create(options);
    } catch (error) {
      logs.delete(this.#user);
      throw error;
    }
    forgotten.register(this, { handle: this.#handle, user: this.#user }, this);
  }

  #create(options) {
    const { pbf_desc: desc, pbf_params: params } = structs;
    withText(options.isa, (isa) => withBytes(desc.size + params.size + 8, (at) => {
      const paramsAt = at + 8 * Math.ceil(desc.size / 8), made = paramsAt + params.size;
      check(exports.pbf_desc_init(at, desc.size));
      check(exports.pbf_params_init(paramsAt, params.size));
      writeDesc(at, options, isa, this.#user);
      write("pbf_params", "params", paramsAt, options.params ?? {});
      this.#dimension = readNumber("u32", at + desc.fields.dimension[1]);
      this.#Array = readNumber("u32", at + desc.fields.precision[1]) === 8 ? Float64Array : Float32Array;
      check(exports.pbf_create(at, paramsAt, made));
      this.#handle = view().getUint32(made, true);
    }));
  }

  #call(name, ...args) {
    if (!this.#handle) throw invalid("the solver is destroyed");
    check(exports[name](this.#handle, ...args));
  }

  /** Destroys it now. Nothing else can be called then; a second time does nothing. */
  destroy() {
    if (!this.#handle) return;
    forgotten.unregister(this);
    exports.pbf_destroy(this.#handle);
    this.#handle = 0;
    logs.delete(this.#user);
    for (const { pointer } of this.#kept.values()) exports.free(pointer);
    this.#kept.clear();
  }

  [Symbol.dispose ?? Symbol.for("Symbol.dispose")]() {
    this.destroy();
  }

  // ---- Steps and parameters

  step(steps = 1) {
    this.#call("pbf_step", numberOf("steps", "u32", steps));
  }

  get params() {
    return this.#struct("pbf_params");
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

  #struct(name) {
    const { size } = structs[name];
    return withBytes(size, (at) => {
      new Uint8Array(exports.memory.buffer, at, size).fill(0);
      writeNumber("u32", at, size);
      this.#call(name.replace("pbf_", "pbf_get_"), at);
      return read(name, at);
    });
  }

  get stats() {
    return this.#struct("pbf_stats");
  }

  get info() {
    return this.#struct("pbf_info");
  }

  get plan() {
    const plan = this.#struct("pbf_plan");
    plan.stages.length = plan.stageCount;
    plan.arrays.length = plan.arrayCount;
    return plan;
  }

  setTiming(enabled) {
    this.#call("pbf_set_timing", enabled ? 1 : 0);
  }

  get timings() {
    const timings = this.#struct("pbf_timings");
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

  // Calls with the numbers in the module's memory, and how many rows they are.
  #withRows(where, values, components, use, Type = this.#Array) {
    if (typeof values?.length !== "number") throw invalid(`${where} is ${String(values)}; it must be an array of numbers`);
    if (values.length % components) throw invalid(`${where} has ${values.length} numbers, no multiple of ${components}`);
    return withBytes(values.length * Type.BYTES_PER_ELEMENT, (at) => {
      new Type(exports.memory.buffer, at, values.length).set(values);
      return use(at, values.length / components);
    });
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
    const corners = [...lower, 0, 0, 0].slice(0, 3).concat([...upper, 0, 0, 0].slice(0, 3));
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
    this.#call(`pbf_get_${name}`, 0, rows, kept.pointer);
    return new Type(exports.memory.buffer, kept.pointer, rows * components);
  }

  /**
   * In the order of adding, dimension numbers a particle. Like the next four a view of the module's memory: it holds
   * until the same is read again, the solver is destroyed, or any call makes the memory grow. slice() keeps it.
   */
  get positions() {
    return this.#rows("positions", this.#dimension);
  }

  get velocities() {
    return this.#rows("velocities", this.#dimension);
  }

  get densities() {
    return this.#rows("densities", 1);
  }

  get pressures() {
    return this.#rows("pressures", 1);
  }

  get ids() {
    return this.#rows("ids", 1, Uint32Array);
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

  #withColliders(where, colliders, use) {
    const { size } = structs.pbf_collider;
    return withBytes(size * colliders.length, (at) => {
      colliders.forEach(({ shape, ...values }, k) => {
        const place = at + k * size;
        check(exports.pbf_collider_init(place, size, shapeOf(`${where}[${k}]`, shape)));
        write("pbf_collider", `${where}[${k}]`, place, values);
      });
      return use(colliders.length, colliders.length ? at : 0);
    });
  }

  /** { shape: "sphere", position: […], radius: … } and so on, as pbf_collider has them. */
  setColliders(colliders) {
    this.#withColliders("colliders", colliders, (count, at) => this.#call("pbf_set_colliders", count, at));
  }

  /** To these poses and sizes, in this time from now. */
  moveColliders(targets, duration) {
    this.#withColliders("targets", targets, (count, at) => this.#call("pbf_move_colliders", count, at, duration));
  }

  get colliders() {
    const { size } = structs.pbf_collider;
    return Array.from({ length: this.#number("u32", "pbf_get_collider_count") }, (_, index) => withBytes(size, (at) => {
      writeNumber("u32", at, size);
      this.#call("pbf_get_collider", index, at);
      const values = read("pbf_collider", at);
      return { ...values, shape: shapes[values.shape] };
    }));
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
