// Threads in a real browser, with the headers that they want and without: PBF_JS=build/wasm-small/js node --test tests/web
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { writeFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { basename, dirname, extname, resolve } from "node:path";
import { after, before, test } from "node:test";
import { Browser } from "./browser.mjs";

const folder = resolve(process.env.PBF_JS ?? "build/wasm-small/js");
const onePage = resolve(process.env.PBF_PAGE ?? "out/web/dam_break.html");
const kinds = { ".mjs": "text/javascript", ".wasm": "application/wasm", ".html": "text/html" };
const isolation = { "cross-origin-opener-policy": "same-origin", "cross-origin-embedder-policy": "require-corp" };

// What threads are there, and the hashes of a dam that has fallen for a while, with solvers made and destroyed again and again.
const fallen = `async (load, Solver, wanted, times) => {
  const { threads, why } = await load(undefined, { threads: wanted });
  const positions = [], hashes = [], had = [];
  for (let n = 0; n < 6000; ++n) positions.push(...[n % 20, Math.floor(n / 20) % 20, Math.floor(n / 400)].map((k) => 0.05 * (k + 0.5)));
  for (let k = 0; k < times; ++k) {
    const solver = new Solver({ capacity: 6000, threads: wanted, params: { domainMax: [2, 1, 0.75], viscosity: 0.01 } });
    solver.addParticles(positions);
    solver.step(15);
    hashes.push(solver.hash);
    had.push(solver.info.threads);
    solver.destroy();
  }
  return { threads, why, hashes: [...new Set(hashes)], had: [...new Set(had)] };
}`;
const page = `<!DOCTYPE html><title>threads</title><script type="module">
  import { Solver, load } from "./pbf.mjs";
  globalThis.run = (wanted, times) => (${fallen})(load, Solver, wanted, times);
</script>`;
const worker = `import { Solver, load } from "./pbf.mjs"; (${fallen})(load, Solver, 2, 3).then(postMessage);`;

let browser, server, hash;

function open(path) {
  return browser.send("Page.navigate", { url: `http://127.0.0.1:${server.address().port}${path}/page.html` })
    .then(() => browser.until(`location.pathname === "${path}/page.html" && globalThis.run`));
}

before(async () => {
  server = createServer(async ({ url }, response) => {
    const name = basename(url.split("?")[0]);
    const made = { "page.html": page, "worker.mjs": worker }[name];
    const body = made ?? (await readFile(resolve(folder, name)).catch(() => null));
    const policy = url.startsWith("/own/") ? { "content-security-policy": "worker-src 'self'" } : {};
    const headers = url.startsWith("/plain/") ? {} : { ...isolation, ...policy };
    response.writeHead(body === null ? 404 : 200, { "content-type": kinds[extname(name)] ?? "text/plain", ...headers });
    response.end(body);
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  browser = await Browser.open("about:blank");
});
after(async () => {
  await browser?.close();
  server.close();
});

test("without the headers there is one thread", async () => {
  await open("/plain");
  const { threads, why, hashes, had } = await browser.value("run(2, 1)");
  assert.deepEqual([threads, had], [1, [1]]);
  assert.match(why, /^the page is not isolated: its server must send Cross-Origin-Opener-Policy and /);
  [hash] = hashes;
});

test("with them a page's own thread steps with others, and has the same bits", async () => {
  await open("/isolated");
  assert.deepEqual(await browser.value("run(3, 20)"), { threads: 3, hashes: [hash], had: [3] });
});

test("so does a worker of the page", async () => {
  assert.deepEqual(await browser.value(`new Promise((done, failed) => {
    const worker = new Worker("./worker.mjs", { type: "module" });
    worker.onmessage = ({ data }) => done(data);
    worker.onerror = (error) => failed(new Error(error.message));
  })`), { threads: 2, hashes: [hash], had: [2] });
});

test("where the page's policy forbids its workers there is one thread", async () => {
  await open("/own");
  const { threads, why, hashes } = await browser.value("run(2, 1)");
  assert.deepEqual([threads, hashes], [1, [hash]]);
  assert.match(why, /^no worker can be had: /);
});

test("the page in one file has threads where serve.py serves it", async () => {
  const serve = spawn("python3", ["-B", resolve(import.meta.dirname ?? "tests/web", "../../examples/web/serve.py"), dirname(onePage), "0"]);
  try {
    const address = (await new Promise((done) => serve.stdout.once("data", done))).toString().trim();
    await browser.send("Page.navigate", { url: address + basename(onePage) });
    await browser.until("globalThis.demo && demo.solver.info.step > 60", 90);
    const threads = await browser.value(`Number(document.getElementById("threads").textContent)`);
    const step = await browser.value(`document.getElementById("step").textContent`);
    console.log(`${threads} threads, a step ${step} ms`);
    assert.equal(threads, await browser.value("Math.min(navigator.hardwareConcurrency, 16)"));
    assert.equal(await browser.value(`document.getElementById("why").textContent`), "");
    assert.ok(await browser.value("demo.solver.positions.buffer instanceof SharedArrayBuffer"));
    writeFileSync(resolve(dirname(onePage), "threads.png"), await browser.picture());
    assert.equal(await browser.value(`document.getElementById("error").textContent`), "");
  } finally {
    serve.kill();
  }
});

test("nothing has failed", () => {
  assert.deepEqual(browser.errors.filter((one) => !/Content Security Policy/.test(one)), []);
});
