// The one-file page in a real browser: PBF_PAGE=out/web/dam_break.html node --test tests/web
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { dirname, resolve } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { Browser, pause } from "./browser.mjs";

const page = resolve(process.env.PBF_PAGE ?? "out/web/dam_break.html");
const number = (id) => `Number(document.getElementById("${id}").textContent)`;
const places = "Array.from(demo.solver.positions)";
let browser;

before(async () => {
  browser = await Browser.open(pathToFileURL(page).href);
  await browser.until(`globalThis.demo && demo.solver.info.step > 20 && ${number("step")} > 0`, 60);
});
after(() => browser?.close());

async function keepPicture(name) {
  const path = resolve(dirname(page), name);
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, await browser.picture());
}

// The part of the canvas that is blue.
const blueness = `(() => {
  const { gl } = demo.picture, w = gl.drawingBufferWidth, h = gl.drawingBufferHeight, bytes = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  let blue = 0;
  for (let i = 0; i < bytes.length; i += 4) if (bytes[i + 2] > bytes[i] + 40) ++blue;
  return blue / (w * h);
})()`;

test("the page counts its particles and says how long steps and frames take", async () => {
  const count = await browser.value(number("count"));
  assert.ok(count > 4000 && count <= 5000, `${count} particles`);
  assert.equal(await browser.value("demo.solver.count"), count);
  const step = await browser.value(number("step")), frame = await browser.value(number("frame"));
  console.log(`${count} particles: a step ${step} ms, a frame ${frame} ms, ${await browser.value("demo.solver.info.deviceName")}`);
  assert.ok(step > 0 && frame > 0);
});

test("water is drawn, falls and spreads", async () => {
  assert.ok((await browser.value(blueness)) > 0.05, "blue pixels");
  await browser.until("demo.solver.info.step > 100", 60);
  const { centerOfMass, positionMax } = await browser.value("demo.solver.stats");
  assert.ok(centerOfMass[0] > 0.36, `the centre of mass is at ${centerOfMass[0]}`);
  assert.ok(positionMax[0] > 1, `the front is at ${positionMax[0]}`);
  await keepPicture("falls.png");
});

test("a drag stirs", async () => {
  await browser.until("demo.solver.stats.kineticEnergy < 0.05", 120);
  const before = await browser.value(places), energy = await browser.value("demo.solver.stats.kineticEnergy");
  await browser.mouse("mousePressed", 300, 480);
  for (let k = 1; k <= 12; ++k) {
    await browser.mouse("mouseMoved", 300 + 30 * k, 480);
    await pause(40);
    if (k === 8) await keepPicture("stirred.png");
  }
  assert.ok(await browser.value("demo.ballPlace !== null"));
  const after = await browser.value(places), stirred = await browser.value("demo.solver.stats.kineticEnergy");
  await browser.mouse("mouseReleased", 660, 480);
  let moved = 0;
  for (let i = 0; i < before.length; i += 3) {
    if (Math.hypot(after[i] - before[i], after[i + 1] - before[i + 1], after[i + 2] - before[i + 2]) > 0.1) ++moved;
  }
  console.log(`${moved} of ${before.length / 3} particles moved by more than 0.1; energy ${energy} before, ${stirred} stirred`);
  assert.ok(moved > before.length / 30, `${moved} particles moved`);
  assert.ok(stirred > 2 * energy, `energy ${energy} before, ${stirred} stirred`);
  await browser.until("demo.ballPlace === null");
});

test("another size begins again", async () => {
  await browser.value(`document.getElementById("size").value = "2000"; document.getElementById("size").dispatchEvent(new Event("change"))`);
  const count = await browser.value("demo.solver.count");
  assert.ok(count > 1500 && count <= 2000, `${count} particles`);
  await browser.value(`document.getElementById("again").click()`);
  assert.ok((await browser.value("demo.solver.info.step")) < 20);
});

test("nothing has failed", async () => {
  assert.deepEqual(browser.errors, []);
  assert.equal(await browser.value(`document.getElementById("error").textContent`), "");
});
