// node module.mjs PACKAGE MODULE PINNED VARIANT...: the small scenes in the module of WebAssembly, with 1, 2 and 4 threads.
import { readFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, file, pinned, ...variants] = process.argv.slice(2);
const module = await import(pathToFileURL(resolve(folder, "module.mjs")));
const { threads, why } = await module.load(undefined, { threads: 4, threadsSource: readFileSync(file) });
if (threads !== 4) throw new Error(`there are ${threads} threads: ${why}`);

const hashes = new Set(readFileSync(pinned, "utf8").split("\n"));
const failures = [];
let lines = 0;
for (const variant of variants) {
  const [dimension, bits] = variant.split("d-f").map(Number);
  for (const count of [1, 2, 4]) {
    module.logs.set(0, (level, text) => {
      const line = text.trim();
      ++lines;
      if (!hashes.has(line)) failures.push(`with ${count} threads other bits than pinned: ${line}`);
    });
    module.exports.run_scenes(dimension, bits / 8, count);
  }
}
failures.forEach((line) => console.error(line));
console.log(`${lines} hashes, ${failures.length} other than pinned`);
if (failures.length || !lines) process.exitCode = 1;
