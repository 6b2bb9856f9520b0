// The module with threads: pbf-threads.wasm in shared memory, and workers that run its threads.

// What a worker does: its text goes there alone. It gives itself to the module and does not come back: what it is to do
// it hears of in shared memory, not by messages.
const work = `
const run = ({ module, memory, place, origin }, post) => {
  const log = (user, level, message) => {
    memory.grow(0); // another thread may have, which is seen here by that
    const bytes = new Uint8Array(memory.buffer, message);
    post({ user, level, sentence: new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0))) });
  };
  const seconds = () => (performance.timeOrigin - origin + performance.now()) / 1e3;
  const imports = { env: { memory }, pbf: { log, seconds } };
  for (const { module: from, name, kind } of WebAssembly.Module.imports(module)) {
    if (kind === "function") (imports[from] ??= {})[name] ??= () => { throw new Error(name + " is called in a worker"); };
  }
  const { exports } = new WebAssembly.Instance(module, imports);
  exports.__stack_pointer.value = place;
  exports.pbf_wasm_begin_thread(place);
  const number = exports.pbf_wasm_give();
  post("given");
  exports.pbf_wasm_work(number);
};
if (typeof require === "function") {
  const { parentPort } = require("node:worker_threads");
  parentPort.once("message", (data) => run(data, (message) => parentPort.postMessage(message)));
} else onmessage = ({ data }) => run(data, postMessage);`;

const MOST = 64; // threads: what the module has room for
const MOST_OF_ALL = 16; // where one is asked for for each processor

async function processors() {
  const told = globalThis.navigator?.hardwareConcurrency ?? (await import("node:os")).availableParallelism();
  return Math.min(told, MOST_OF_ALL);
}

/** Whether this thread may wait for others: a page's own may not. */
function mayWait() {
  try {
    return Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 1) === "not-equal";
  } catch {
    return false;
  }
}

// As large as the module allows, where the system has the addresses. Its first size is what the module wants.
function sharedMemory() {
  for (let maximum = 65536; ; maximum /= 2) {
    try {
      return new WebAssembly.Memory({ initial: 64, maximum, shared: true });
    } catch (error) {
      if (maximum <= 4096) throw error;
    }
  }
}

// A worker, with the same methods in a page and under node.
async function newWorker(take, fail) {
  if (typeof Worker === "undefined") {
    const threads = await import("node:worker_threads");
    const worker = new threads.Worker(work, { eval: true, execArgv: [] });
    worker.on("message", take).on("error", fail);
    return worker;
  }
  const url = URL.createObjectURL(new Blob([work], { type: "text/javascript" }));
  const worker = new Worker(url);
  worker.onmessage = ({ data }) => {
    URL.revokeObjectURL(url);
    take(data);
  };
  worker.onerror = (event) => fail(new Error(event.message || "the page's policy does not allow it"));
  return worker;
}

const SECONDS = 10; // in which workers have to come

// Ends when the worker has given itself, with it, or fails. `made` gets it at once.
function given(data, log, made) {
  return new Promise((resolve, reject) => {
    const late = setTimeout(() => reject(new Error(`it has not begun in ${SECONDS} s`)), 1000 * SECONDS);
    const fail = (error) => {
      clearTimeout(late);
      reject(error);
    };
    const begins = newWorker((message) => {
      if (message !== "given") return log(message);
      clearTimeout(late);
      resolve(begins.then(release));
    }, fail);
    begins.then((worker) => {
      made.push(worker);
      worker.postMessage(data);
    }).catch(fail);
  });
}

// Node may end, and what fails from now on is told as elsewhere.
function release(worker) {
  worker.unref?.();
  worker.removeAllListeners?.("error");
  worker.onerror = null;
}

/**
 * The module's functions, and how many threads they have: with those workers that come, of as many as are wanted (0: one for
 * each processor). Fails where there is none. `compile` gives the module, `log` takes what is said in workers.
 */
export async function begin(wanted, compile, imports, log) {
  if (typeof SharedArrayBuffer === "undefined" || globalThis.crossOriginIsolated === false) {
    throw new Error("the page is not isolated: its server must send Cross-Origin-Opener-Policy and Cross-Origin-Embedder-Policy");
  }
  const threads = Math.min(wanted || (await processors()), MOST);
  if (threads < 2) throw new Error("there is one processor");
  const memory = sharedMemory(), module = await compile();
  const { exports } = await WebAssembly.instantiate(module, { ...imports, env: { ...imports.env, memory } });
  exports._initialize();
  if (mayWait()) exports.pbf_wasm_let_wait();
  const made = [], workers = Array.from({ length: threads - 1 }, () => {
    const data = { module, memory, place: exports.pbf_wasm_room() >>> 0, origin: performance.timeOrigin };
    return data.place ? given(data, log, made) : Promise.reject(new Error("there is no memory for its stack"));
  });
  const ends = await Promise.allSettled(workers);
  const there = ends.filter(({ status }) => status === "fulfilled");
  if (!there.length) {
    for (const worker of made) worker.terminate();
    throw new Error(`no worker can be had: ${ends[0].reason.message}`);
  }
  return { exports: { ...exports, memory: current(memory, exports.pbf_wasm_pages) }, threads: 1 + there.length };
}

// Memory that another thread has made grow: an engine may show it here only at its next pause, or when this thread does so, too.
function current(memory, pages) {
  return {
    get buffer() {
      if (memory.buffer.byteLength !== 65536 * pages()) memory.grow(0);
      return memory.buffer;
    },
  };
}
