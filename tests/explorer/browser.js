"use strict";
// A browser without a window, spoken to over a pipe (the Chrome DevTools Protocol), without any package.
const { spawn } = require("node:child_process");
const { mkdtempSync, rmSync } = require("node:fs");
const { tmpdir } = require("node:os");
const { join } = require("node:path");

class Browser {
  constructor() {
    this.profile = mkdtempSync(join(tmpdir(), "browser-"));
    const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe", `--user-data-dir=${this.profile}`, "about:blank"];
    this.process = spawn("chromium", flags, { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
    this.left = "";
    this.next = 1;
    this.asked = new Map();
    /** What the page wrote, and what it asked for besides itself. */
    this.console = [];
    this.everRequested = [];
    this.process.stdio[4].on("data", (data) => this.read(String(data)));
  }
  read(text) {
    const parts = (this.left + text).split("\0");
    this.left = parts.pop();
    for (const part of parts) {
      const { id, result, error, method, params } = JSON.parse(part);
      if (id) {
        const [resolve, reject] = this.asked.get(id);
        this.asked.delete(id);
        if (error) reject(new Error(error.message));
        else resolve(result);
      }
      if (method === "Runtime.consoleAPICalled") this.console.push(params.args.map((a) => a.value ?? a.description).join(" "));
      if (method === "Runtime.exceptionThrown") this.console.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === "Log.entryAdded") this.console.push(params.entry.text);
      if (method === "Network.requestWillBeSent") this.everRequested.push(params.request.url);
    }
  }
  send(method, params = {}) {
    const id = this.next++;
    this.process.stdio[3].write(JSON.stringify({ id, method, params, sessionId: this.session }) + "\0");
    return new Promise((resolve, reject) => this.asked.set(id, [resolve, reject]));
  }
  /** A browser with a page to open things in. */
  static async start() {
    const browser = new Browser();
    const { targetInfos } = await browser.send("Target.getTargets");
    const { targetId } = targetInfos.find(({ type }) => type === "page");
    browser.session = (await browser.send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
    for (const part of ["Runtime", "Log", "Network", "Page"]) await browser.send(`${part}.enable`);
    return browser;
  }
  async open(url, isReady = "document.documentElement?.dataset.ready === 'yes'") {
    await this.send("Page.navigate", { url: "about:blank" });
    await this.send("Page.navigate", { url });
    await this.until(isReady);
  }
  /** The value of an expression in the page, awaited. */
  async value(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(`${expression}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`);
    return result.value;
  }
  async until(expression, seconds = 30) {
    for (let i = 0; i < 20 * seconds; i++) {
      // A page that is being replaced has no answer.
      const left = (error) => /navigated|context/.test(error.message) || Promise.reject(error);
      if ((await this.value(expression).catch(left)) === true) return;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    throw new Error(`never: ${expression}; ${this.console.join("; ")}`);
  }
  async size(width, height, isDark = false) {
    await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
    await this.send("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: isDark ? "dark" : "light" }] });
  }
  async press(key) {
    const text = key.length === 1 ? { text: key } : {};
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, code: key, ...text });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, code: key });
  }
  mouse(type, x, y) {
    return this.send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: type === "mouseReleased" ? 0 : 1, clickCount: 1 });
  }
  async picture() {
    const { data } = await this.send("Page.captureScreenshot", { format: "png" });
    return Buffer.from(data, "base64");
  }
  async close() {
    this.process.kill();
    await new Promise((resolve) => this.process.on("exit", resolve));
    rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
module.exports = { Browser };
