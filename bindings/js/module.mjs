// The WebAssembly module: its loading, its memory, and structs of C in it. For the other files of this package.
import { constants, structs } from "./abi.g.mjs";

/** What the library has refused: `status` is a PBF_ERROR number, `code` its name, `message` the sentence. */
export class PbfError extends Error {
  constructor(status, code, message) {
    super(message);
    this.name = "PbfError";
    this.status = status;
    this.code = code;
  }
}

export function invalid(message) {
  return new PbfError(constants.ERROR_INVALID_ARGUMENT, "PBF_ERROR_INVALID_ARGUMENT", message);
}

// ---- The module ----

export let exports; // of the instance: the library's functions
export const logs = new Map(); // by the number that the library gets as log_user

const text = new TextDecoder();

export function textAt(pointer, most = Infinity) {
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

const env = { emscripten_notify_memory_growth() {}, __call_sighandler() {}, exit: host.proc_exit }; // there are no signals
const seconds = () => performance.now() / 1e3;
const imports = { pbf: { log, seconds }, wasi_snapshot_preview1: host, env };

// Of what is given, or of a file of the package.
async function compiled(source, file) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (typeof Response !== "undefined" && source instanceof Response) return WebAssembly.compile(await source.arrayBuffer());
  const url = source === undefined ? file() : new URL(source, globalThis.location?.href ?? import.meta.url);
  if (url.protocol === "file:") return WebAssembly.compile(await (await import("node:fs/promises")).readFile(url));
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} can't be read: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

// Bundlers look for the first as it stands here. The other one they are not to miss where a package is without.
const files = {
  one: () => new URL("./pbf.wasm", import.meta.url),
  threads: (name = "./pbf-threads.wasm") => new URL(name, import.meta.url),
};

// What an exception of the engine's, as where the stack is full, has left halfway in the module: its stack, locks and heap
// are then not to be gone on with.
let left;
const endings = ["free", "pbf_destroy", "pbf_batch_destroy", "pbf_release_shape", "pbf_unmap"]; // need not be called then

function guarded(name, call) {
  return (...args) => {
    if (left && endings.includes(name)) return 0;
    if (left) throw new PbfError(constants.ERROR_STATE, "PBF_ERROR_STATE", `a call was left halfway (${left}); only another page or worker can go on`);
    try {
      return call(...args);
    } catch (error) {
      left = error;
      throw error;
    }
  };
}

function guardedAll(all) {
  return Object.fromEntries(Object.entries(all).map(([name, one]) => [name, typeof one === "function" ? guarded(name, one) : one]));
}

async function loadOne(source) {
  const instance = await WebAssembly.instantiate(await compiled(source, files.one), imports);
  exports = guardedAll(instance.exports);
  exports._initialize?.();
}

// What is said in a worker comes when this thread has time for it.
function logLater({ user, level, sentence }) {
  logs.get(user)?.(level, sentence);
}

async function loadThreads(threads, source) {
  const { begin } = await import("./threads.mjs"); // a page without does not load it
  const begun = await begin(threads, () => compiled(source, files.threads), imports, logLater);
  exports = guardedAll(begun.exports);
  return begun.threads;
}

async function loadAny(source, { threads = 1, threadsSource, ...others }) {
  for (const name of Object.keys(others)) throw invalid(`options has no ${name}; it has threads, threadsSource`);
  if (numberOf("options.threads", "u32", threads) === 1) {
    await loadOne(source);
    return { threads: 1 };
  }
  try {
    return { threads: await loadThreads(threads, threadsSource) };
  } catch (error) {
    await loadOne(source);
    return { threads: 1, why: error.message };
  }
}

let loading;

/**
 * Loads the module once: from pbf.wasm beside this file, or from a URL, a Response, bytes or a compiled module. Where
 * `threads` is another number than 1 (0: one for each processor) it takes pbf-threads.wasm, or `threadsSource`, if the page
 * may have threads. Gives how many threads there are, and where there is one in spite of that, why.
 * Solver.create does it where it has not been done.
 */
export function load(source, options = {}) {
  loading ??= loadAny(source, options).catch((error) => {
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

export function check(status) {
  const error = thrown;
  thrown = undefined;
  if (status !== 0) {
    throw new PbfError(status, textAt(exports.pbf_status_string(status)), textAt(exports.pbf_last_error()));
  }
  if (error !== undefined) throw error;
}

// ---- Memory of the module ----

// Calls with so many bytes of it, which are given back.
export function withBytes(size, use) {
  const pointer = size < 2 ** 32 ? exports.malloc(Math.max(size, 1)) >>> 0 : 0; // of more it would get the remainder
  if (!pointer) {
    throw new PbfError(constants.ERROR_OUT_OF_MEMORY, "PBF_ERROR_OUT_OF_MEMORY", `${size} bytes are not to be had`);
  }
  try {
    return use(pointer);
  } finally {
    exports.free(pointer);
  }
}

export const view = () => new DataView(exports.memory.buffer);

const bytesOf = { u32: 4, i32: 4, u64: 8, i64: 8, f64: 8, pointer: 4, text: 1 };

export function readNumber(what, at) {
  switch (what) {
    case "f64": return view().getFloat64(at, true);
    case "u64": return Number(view().getBigUint64(at, true));
    case "i64": return Number(view().getBigInt64(at, true));
    case "i32": return view().getInt32(at, true);
    default: return view().getUint32(at, true);
  }
}

export function writeNumber(what, at, value) {
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

export function read(name, at) {
  const values = {};
  for (const [field, place] of Object.entries(structs[name].fields)) {
    if (field !== "structSize" && field !== "reserved") values[field] = readField(place, at);
  }
  return values;
}

export function numberOf(where, what, value) {
  const number = typeof value === "boolean" ? Number(value) : value;
  if (typeof number !== "number") throw invalid(`${where} is ${String(value)}; it must be a number`);
  if (what === "f64" || (Number.isInteger(number) && number >= (what === "i32" ? -(2 ** 31) : 0) && number < 2 ** 32)) return number;
  throw invalid(`${where} is ${number}; it must be a whole number of 32 bits`);
}

// What is given of a struct, over what it holds.
export function write(name, where, at, values) {
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

// Calls with a struct that has its size, and what is given of it.
export function withStruct(name, where, values, use) {
  const { size } = structs[name];
  return withBytes(size, (at) => {
    new Uint8Array(exports.memory.buffer, at, size).fill(0);
    writeNumber("u32", at, size);
    write(name, where, at, values);
    return use(at);
  });
}

// Calls with an array of structs, each begun by the function `init`, and how many they are. `kindOf`, where structs have a
// shape, gives the number that one stands for, and fields that come with it.
export function withStructs(name, where, list, init, kindOf, use) {
  if (!Array.isArray(list)) throw invalid(`${where} is ${String(list)}; it must be an array of objects`);
  const { size } = structs[name];
  return withBytes(size * list.length, (at) => {
    list.forEach((fields, k) => {
      const place = `${where}[${k}]`, to = at + k * size;
      if (typeof fields !== "object" || fields === null) throw invalid(`${place} is ${String(fields)}; it must be an object`);
      if (!kindOf) {
        check(exports[init](to, size));
        return write(name, place, to, fields);
      }
      const { shape, ...values } = fields, [number, more] = kindOf(`${place}.shape`, shape);
      check(exports[init](to, size, number));
      write(name, place, to, { ...values, ...more });
    });
    return use(list.length, list.length ? at : 0);
  });
}

// Shapes that are named, for withStructs.
export function named(names) {
  return (where, shape) => {
    const number = names.indexOf(shape);
    if (number < 0) throw invalid(`${where} is ${String(shape)}; it must be one of ${names.join(", ")}`);
    return [number, {}];
  };
}

// Calls with numbers in the module's memory, and how many rows they are.
export function withRows(where, values, components, Type, use) {
  if (typeof values?.length !== "number") throw invalid(`${where} is ${String(values)}; it must be an array of numbers`);
  if (values.length % components) throw invalid(`${where} has ${values.length} numbers, no multiple of ${components}`);
  const given = values.buffer === exports.memory.buffer ? values.slice() : values; // a view, which ends where memory grows
  return withBytes(given.length * Type.BYTES_PER_ELEMENT, (at) => {
    if (Type === Uint32Array && !(given instanceof Type)) // which takes what is no whole number for another one
      for (let k = 0; k < given.length; ++k) numberOf(`${where}[${k}]`, "u32", given[k]);
    new Type(exports.memory.buffer, at, given.length).set(given);
    return use(at, given.length / components);
  });
}

// Calls with room for so many numbers, and gives them as an array of their own.
export function filled(Type, length, use) {
  return withBytes(length * Type.BYTES_PER_ELEMENT, (at) => {
    use(at);
    return new Type(exports.memory.buffer, at, length).slice();
  });
}

export function withText(value, use) {
  if (value === undefined || value === null) return use(0);
  const bytes = new TextEncoder().encode(`${value}\0`);
  return withBytes(bytes.length, (pointer) => {
    new Uint8Array(exports.memory.buffer, pointer).set(bytes);
    return use(pointer);
  });
}

const descOptions = ["dimension", "precision", "capacity", "strict", "threads", "isa", "log", "params"];
let lastLog = 0;

// Calls with a pbf_desc and a pbf_params of these options, and a place for what they make; gives what that is. `others` are
// options that are not of a solver.
export function made(options, others, create) {
  if (!exports) throw invalid("the module is not loaded; await load() first, or Solver.create()");
  const known = [...descOptions, ...others];
  for (const name of Object.keys(options)) {
    if (!known.includes(name)) throw invalid(`options has no ${name}; it has ${known.join(", ")}`);
  }
  if (options.log && typeof options.log !== "function") throw invalid(`options.log is ${String(options.log)}; it must be a function`);
  const user = options.log ? ++lastLog : 0;
  if (user) logs.set(user, options.log);
  try {
    return { user, ...withDesc(options, user, create) };
  } catch (error) {
    logs.delete(user);
    throw error;
  }
}

function withDesc(options, user, create) {
  const { pbf_desc: desc, pbf_params: params } = structs, { dimension, precision, capacity, strict, threads } = options;
  return withText(options.isa, (isa) => withBytes(desc.size + params.size + 8, (at) => {
    const paramsAt = at + 8 * Math.ceil(desc.size / 8), place = paramsAt + params.size;
    check(exports.pbf_desc_init(at, desc.size));
    check(exports.pbf_params_init(paramsAt, params.size));
    write("pbf_desc", "options", at, { dimension, precision, capacity, strict, threads });
    writeNumber("u32", at + desc.fields.isa[1], isa);
    if (user) {
      writeNumber("u32", at + desc.fields.log[1], exports.pbf_js_log_function());
      writeNumber("u32", at + desc.fields.logUser[1], user);
    }
    write("pbf_params", "params", paramsAt, options.params ?? {});
    check(create(at, paramsAt, place));
    const numbers = readNumber("u32", at + desc.fields.precision[1]) === 8 ? Float64Array : Float32Array;
    return { handle: view().getUint32(place, true), dimension: readNumber("u32", at + desc.fields.dimension[1]), Array: numbers };
  }));
}
