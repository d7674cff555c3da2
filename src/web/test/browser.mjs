// A daemon and a Chromium, for tests: both are ended with the test. With SCULPTD_PAGE=dist the page
// comes from that folder and not from the program, so that a changed page is tried without a build.
import { spawn, execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import WebSocket from "ws";
import { Line } from "./line.mjs";

export const wait = (ms) => new Promise((done) => setTimeout(done, ms));

/** Waits until it is so, at most two minutes. */
export async function until(what, so) {
  const end = Date.now() + 120_000;
  for (;;) {
    const answer = await so();
    if (answer) return answer;
    if (Date.now() > end) throw new Error(`never: ${what}`);
    await wait(20);
  }
}

const running = [];
process.on("exit", () => running.forEach((p) => p.kill("SIGKILL")));

/** `sculptd run --headless --web` in a home of its own. */
export class Daemon {
  static async start(binary, args = []) {
    const daemon = new Daemon();
    daemon.binary = binary;
    daemon.home = mkdtempSync(join(tmpdir(), "sculptd-web-"));
    daemon.env = { ...process.env, HOME: daemon.home, XDG_RUNTIME_DIR: daemon.home, XDG_DATA_HOME: daemon.home, XDG_STATE_HOME: daemon.home };
    daemon.log = "";
    const more = typeof args === "function" ? args(daemon.home) : args;
    daemon.process = spawn(binary, ["run", "--headless", "--web", "127.0.0.1:0", ...more], { env: daemon.env });
    running.push(daemon.process);
    daemon.process.stderr.on("data", (d) => (daemon.log += d));
    daemon.links = await until("it prints its links", () => {
      if (daemon.process.exitCode !== null) throw new Error(`the daemon ended: ${daemon.log}`);
      const found = [...daemon.log.matchAll(/(http:\S+#\w+)/g)].map((m) => m[1]);
      return found.length >= 3 ? found : null;
    });
    await until("it answers", () => {
      try { return daemon.ctl("status"); } catch { return null; }
    });
    const folder = process.env.SCULPTD_PAGE;
    if (folder) {
      daemon.line = await Line.to(Number(new URL(daemon.links[0]).port), { folder });
      daemon.links = daemon.links.map((link) => daemon.line.link(link));
    }
    return daemon;
  }

  ctl(method, params) {
    const args = ["--json", "ctl", method, ...(params ? [JSON.stringify(params)] : [])];
    return JSON.parse(execFileSync(this.binary, args, { env: this.env, encoding: "utf8" }));
  }

  async stop(signal = "SIGTERM") {
    const gone = new Promise((done) => this.process.once("exit", done));
    this.line?.close();
    this.process.kill(signal);
    await gone;
  }

  remove() { rmSync(this.home, { recursive: true, force: true }); }
}

/** Headless Chromium, driven through its protocol. */
export class Chromium {
  static async start(program) {
    const chromium = new Chromium();
    chromium.folder = mkdtempSync(join(tmpdir(), "sculptd-chromium-"));
    const flags = ["--headless=new", "--no-sandbox", "--remote-debugging-port=0", `--user-data-dir=${chromium.folder}`,
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run", "--disable-extensions",
      "--disable-background-timer-throttling", "--disable-renderer-backgrounding", "about:blank"];
    chromium.process = spawn(program, flags, { stdio: ["ignore", "ignore", "pipe"] });
    running.push(chromium.process);
    let log = "";
    chromium.process.stderr.on("data", (d) => (log += d));
    const at = await until("Chromium listens", () => log.match(/ws:\S+/)?.[0]);
    chromium.socket = new WebSocket(at, { perMessageDeflate: false });
    await new Promise((done, fail) => chromium.socket.once("open", done).once("error", fail));
    [chromium.next, chromium.waiting, chromium.events] = [0, new Map(), new Map()];
    chromium.socket.on("message", (text) => {
      const message = JSON.parse(text);
      if (message.method) return chromium.events.get(message.method)?.(message.params, message.sessionId);
      const waiting = chromium.waiting.get(message.id);
      chromium.waiting.delete(message.id);
      if (message.error) waiting?.fail(new Error(message.error.message));
      else waiting?.done(message.result);
    });
    return chromium;
  }

  send(method, params = {}, sessionId) {
    const id = ++this.next;
    this.socket.send(JSON.stringify({ id, method, params, sessionId }));
    return new Promise((done, fail) => this.waiting.set(id, { done, fail }));
  }

  async open(url, { width = 1000, height = 700, scale = 1, touch = false, light = false } = {}) {
    const { targetId } = await this.send("Target.createTarget", { url: "about:blank" });
    const { sessionId } = await this.send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page(this, sessionId, targetId);
    await page.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: scale, mobile: touch });
    if (touch) await page.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 5 });
    const features = [{ name: "prefers-color-scheme", value: light ? "light" : "dark" }];
    await page.send("Emulation.setEmulatedMedia", { features });
    await page.send("Page.enable");
    await page.send("Page.navigate", { url });
    return page;
  }

  async stop() {
    const gone = new Promise((done) => this.process.once("exit", done));
    await this.send("Browser.close").catch(() => {});
    await gone;
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/** One page of a browser. */
export class Page {
  constructor(browser, session, target) { Object.assign(this, { browser, session, target }); }

  send(method, params) { return this.browser.send(method, params, this.session); }

  async run(code) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", { expression: code, returnByValue: true, awaitPromise: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }

  /** Waits until the page shows all of the clay. */
  complete() { return until("the page is complete", () => this.run("document.body?.dataset.complete ?? ''")); }

  pen(type, x, y, force = 0.5, tilt = [0, 0]) {
    const down = type !== "mouseReleased" && force > 0;
    return this.send("Input.dispatchMouseEvent", {
      type, x, y, button: type === "mouseMoved" && !down ? "none" : "left", buttons: down ? 1 : 0,
      pointerType: "pen", force, tiltX: tilt[0], tiltY: tilt[1],
    });
  }

  async stroke(points) {
    const [first] = points;
    const last = points[points.length - 1];
    // The protocol keeps their order.
    await Promise.all([
      this.pen("mouseMoved", first.x, first.y, 0),
      this.pen("mousePressed", first.x, first.y, first.force, first.tilt),
      ...points.slice(1).map((p) => this.pen("mouseMoved", p.x, p.y, p.force, p.tilt)),
      this.pen("mouseReleased", last.x, last.y, 0),
    ]);
  }

  /** The records of the pen that the page sends from now on: `{ down, pressure, tilt }`. */
  async penRecords() {
    const all = [];
    this.browser.events.set("Network.webSocketFrameSent", ({ response }, session) => {
      if (session !== this.session || response.opcode !== 2) return;
      const bytes = Buffer.from(response.payloadData, "base64");
      if (bytes[0] !== 1) return;
      for (let at = 5; at + 20 <= bytes.length; at += 20) {
        all.push({
          down: (bytes[at + 18] & 2) !== 0,
          pressure: bytes.readUInt16LE(at + 12) / 65535,
          tilt: [bytes.readInt8(at + 14), bytes.readInt8(at + 15)],
        });
      }
    });
    await this.send("Network.enable");
    return all;
  }

  async picture() {
    const { data } = await this.send("Page.captureScreenshot", { format: "png" });
    return Buffer.from(data, "base64");
  }

  close() { return this.browser.send("Target.closeTarget", { targetId: this.target }); }
}
