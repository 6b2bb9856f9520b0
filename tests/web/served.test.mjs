// The package as a server gives it to a browser: PBF_JS=build/wasm-small/js node --test tests/web
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { basename, extname, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { Browser } from "./browser.mjs";

const folder = resolve(process.env.PBF_JS ?? "build/wasm-small/js");
const kinds = { ".mjs": "text/javascript", ".wasm": "application/wasm", ".html": "text/html" };

// Hashes a block that has fallen for a while.
const fallen = `
  const positions = [];
  for (let n = 0; n < 1000; ++n) positions.push(...[n % 10, Math.floor(n / 10) % 10, Math.floor(n / 100)].map((k) => 0.05 * (k + 0.5)));
  const solver = await Solver.create({ capacity: 1000, params: { domainMax: [2, 1, 0.5], viscosity: 0.01 } });
  solver.addParticles(positions);
  solver.setColliders([{ shape: "box", halfExtents: [0.1, 0.1, 0.3], position: [0.8, 0.1, 0.25], angularVelocity: [0, 3, 0] }]);
  solver.step(60);
  const hash = solver.hash;
  solver.destroy();`;

const page = `<!DOCTYPE html><title>served</title><script type="module">
  import { Solver } from "./pbf.mjs";
  ${fallen}
  globalThis.pageHash = hash;
</script>`;
const worker = `import { Solver } from "./pbf.mjs"; ${fallen} postMessage(hash);`;

let browser, server;

before(async () => {
  server = createServer(async ({ url }, response) => {
    const name = basename(url.split("?")[0]);
    const made = { "page.html": page, "worker.mjs": worker }[name];
    const body = made ?? (await readFile(resolve(folder, name)).catch(() => null));
    response.writeHead(body === null ? 404 : 200, { "content-type": kinds[extname(name)] ?? "text/plain" });
    response.end(body);
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  browser = await Browser.open(`http://127.0.0.1:${server.address().port}/page.html`);
});
after(async () => {
  await browser?.close();
  server.close();
});

test("a page and a worker in it have the bits of node", async () => {
  const { Solver } = await import(pathToFileURL(`${folder}/pbf.mjs`));
  const hash = await new (async () => {}).constructor("Solver", `${fallen} return hash;`)(Solver);
  assert.match(hash, /^[0-9a-f]{16}$/);
  await browser.until("globalThis.pageHash");
  assert.equal(await browser.value("pageHash"), hash);
  assert.equal(await browser.value(`new Promise((done, failed) => {
    const worker = new Worker("./worker.mjs", { type: "module" });
    worker.onmessage = ({ data }) => done(data);
    worker.onerror = (error) => failed(new Error(error.message));
  })`), hash);
});

test("what is not there is said", async () => {
  const said = await browser.value(`import("./module.mjs?again").then(({ load }) => load("nothing.wasm")).catch((error) => error.message)`);
  assert.match(said, /\/nothing\.wasm can't be read: 404 Not Found$/);
  assert.deepEqual(browser.errors, []);
});
