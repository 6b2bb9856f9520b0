// A headless Chromium by its own protocol over two pipes: what a test of a page needs of it, and no package.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export class Browser {
  #waiting = new Map();
  #last = 0;
  #session;
  errors = []; // exceptions and errors of the page's console

  static async open(url, { width = 1000, height = 640, command = process.env.CHROMIUM ?? "chromium" } = {}) {
    const browser = new Browser();
    browser.folder = mkdtempSync(join(tmpdir(), "pbf-chromium-"));
    browser.process = spawn(command, [
      "--headless=new", "--no-sandbox", "--no-first-run", "--disable-extensions", "--remote-debugging-pipe",
      "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
      `--user-data-dir=${browser.folder}`, `--window-size=${width},${height}`,
    ], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    browser.#listen();
    const { targetId } = await browser.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await browser.send("Target.attachToTarget", { targetId, flatten: true });
    browser.#session = sessionId;
    await browser.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    await browser.send("Runtime.enable");
    await browser.send("Page.enable");
    await browser.send("Page.navigate", { url });
    return browser;
  }

  #listen() {
    let rest = "";
    this.process.stdio[4].setEncoding("utf8").on("data", (text) => {
      const messages = (rest + text).split("\0");
      rest = messages.pop();
      messages.forEach((one) => this.#take(JSON.parse(one)));
    });
    this.process.on("exit", () => this.#waiting.forEach(({ reject }) => reject(new Error("the browser has ended"))));
    this.process.on("error", (error) => this.#waiting.forEach(({ reject }) => reject(error)));
  }

  #take({ id, result, error, method, params }) {
    if (method === "Runtime.exceptionThrown") this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && params.type === "error") this.errors.push(params.args.map((one) => one.description ?? one.value).join(" "));
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    if (error) waiting?.reject(new Error(error.message));
    else waiting?.resolve(result);
  }

  send(method, params = {}) {
    const id = ++this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject });
      this.process.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId: this.#session })}\0`);
    });
  }

  /** The value of an expression in the page. */
  async value(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Looks until the expression is true. */
  async until(expression, seconds = 30) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end; await pause(100)) {
      if (await this.value(expression)) return;
    }
    throw new Error(`not in ${seconds} s: ${expression}; the page says: ${this.errors.join("; ")}`);
  }

  mouse(type, x, y) {
    return this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
  }

  /** A PNG. */
  async picture() {
    return Buffer.from((await this.send("Page.captureScreenshot")).data, "base64");
  }

  async close() {
    const ended = new Promise((resolve) => this.process.on("exit", resolve));
    this.send("Browser.close").catch(() => {});
    await Promise.race([ended, pause(5000)]);
    this.process.kill("SIGKILL");
    rmSync(this.folder, { recursive: true, force: true, maxRetries: 5 });
  }
}

export const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
