// Figures of the page, for the guide: `node test/measure.mjs BINARY CHROMIUM [WHAT...]`, where WHAT is
// `pixel` (a touch of the pen to the picture that shows it), `arrival` (a million vertices over a line
// of 100 Mbit/s), `dabs` (bytes a dab), `many` (the daemon's tick with twenty pages) and `memory`
// (five million vertices).
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import WebSocket from "ws";
import { Chromium, Daemon, until, wait } from "./browser.mjs";
import { Line } from "./line.mjs";

const [binary, program, ...wanted] = process.argv.slice(2);
const is = (what) => wanted.length === 0 || wanted.includes(what);
const at = (sorted, share) => sorted[Math.min(sorted.length - 1, Math.floor(sorted.length * share))];
const told = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  return `median ${at(sorted, 0.5).toFixed(1)}, p95 ${at(sorted, 0.95).toFixed(1)}, p99 ${at(sorted, 0.99).toFixed(1)}`;
};

/** Notes in the page when a pen came down, and when the first picture with newer clay was complete. */
const WATCH = `(() => {
  const gl = document.getElementById("clay").getContext("webgl2");
  const [draw, put] = [gl.drawElements, gl.bufferSubData];
  let [touched, changed, asked] = [0, false, false];
  window.delays = [];
  window.expectations = [];
  let expects = false;
  new MutationObserver(() => {
    if (expects && touched > 0) window.expectations.push(performance.now() - touched);
    expects = false;
  }).observe(document.getElementById("expected"), { childList: true, subtree: true, attributes: true });
  document.getElementById("clay").addEventListener("pointerdown", (e) => { touched = e.timeStamp; changed = false; expects = true; }, true);
  gl.bufferSubData = (...all) => { changed = touched > 0; put.apply(gl, all); };
  gl.drawElements = (...all) => {
    draw.apply(gl, all);
    if (!changed || asked || gl.getParameter(gl.FRAMEBUFFER_BINDING)) return;
    asked = true;
    queueMicrotask(() => {
      gl.finish();
      window.delays.push(performance.now() - touched);
      [touched, changed, asked] = [0, false, false];
    });
  };
})()`;

/** A ball of so many vertices, as a file. */
function ball(path, vertices) {
  const rows = Math.round(Math.sqrt(vertices / 2));
  const around = rows * 2;
  const count = around * (rows - 1) + 2;
  const faces = around * (rows - 1) * 2;
  const head = `ply\nformat binary_little_endian 1.0\nelement vertex ${count}\nproperty float x\nproperty float y\nproperty float z\nelement face ${faces}\nproperty list uchar int vertex_indices\nend_header\n`;
  const body = Buffer.alloc(count * 12 + faces * 13);
  let at = 0;
  const point = (x, y, z) => { for (const v of [x, y, z]) at = body.writeFloatLE(v, at); };
  point(0, 1, 0);
  for (let row = 1; row < rows; row++) {
    const down = (row * Math.PI) / rows;
    for (let n = 0; n < around; n++) {
      const turn = (n * 2 * Math.PI) / around;
      // Uneven, so that nothing is folded away.
      const r = 1 + 0.02 * Math.sin(9 * turn) * Math.sin(7 * down);
      point(r * Math.sin(down) * Math.cos(turn), r * Math.cos(down), -r * Math.sin(down) * Math.sin(turn));
    }
  }
  point(0, -1, 0);
  const face = (a, b, c) => { at = body.writeUInt8(3, at); for (const v of [a, b, c]) at = body.writeInt32LE(v, at); };
  const of = (row, n) => 1 + (row - 1) * around + (n % around);
  for (let n = 0; n < around; n++) face(0, of(1, n), of(1, n + 1));
  for (let row = 1; row < rows - 1; row++) {
    for (let n = 0; n < around; n++) {
      face(of(row, n), of(row + 1, n), of(row, n + 1));
      face(of(row, n + 1), of(row + 1, n), of(row + 1, n + 1));
    }
  }
  for (let n = 0; n < around; n++) face(count - 1, of(rows - 1, n + 1), of(rows - 1, n));
  writeFileSync(path, Buffer.concat([Buffer.from(head), body]));
  return path;
}
const withBall = (vertices) => (home) => ["--mesh", ball(join(home, "ball.ply"), vertices)];

async function pixel() {
  // Small, because a software renderer draws it.
  const daemon = await Daemon.start(binary, withBall(10e3));
  const chromium = await Chromium.start(program);
  const page = await chromium.open(daemon.links[0], { width: 480, height: 480 });
  await page.complete();
  await page.run(WATCH);
  for (let n = 0; n < 200; n++) {
    const [x, y] = [220 + (n % 10) * 4, 130 + (n % 7) * 5];
    await page.pen("mouseMoved", x, y, 0);
    await page.pen("mousePressed", x, y, 0.7);
    await page.pen("mouseMoved", x + 4, y + 2, 0.7);
    await wait(150 + (n % 13));
    await page.pen("mouseReleased", x + 4, y + 2, 0);
    await wait(30);
  }
  const delays = await page.run("window.delays");
  console.log(`touch to picture, ms, ${delays.length} touches: ${told(delays)}`);
  console.log(`touch to expected dab, ms: ${told(await page.run("window.expectations"))}`);
  await chromium.stop();
  await daemon.stop();
  daemon.remove();
}

async function arrival() {
  const daemon = await Daemon.start(binary, withBall(1e6));
  const link = new URL(daemon.links[1]);
  const line = await Line.to(Number(link.port), { bits: 100e6 });
  // Without a picture: what the line carries. Pages in front come first.
  const key = link.hash.slice(1);
  const begun = performance.now();
  const socket = new WebSocket(`ws://127.0.0.1:${line.port}/join`, { perMessageDeflate: false });
  let [bytes, pages, half] = [0, 0, 0];
  await new Promise((done) => {
    let total = Infinity;
    socket.on("open", () => socket.send(JSON.stringify({ key, name: "" })));
    socket.on("message", (data, binary) => {
      if (!binary) {
        const message = JSON.parse(data);
        if (message.is === "objects") total = message.objects.reduce((sum, o) => sum + o.pages, 0);
        if (message.is === "complete") done();
        return;
      }
      [bytes, pages] = [bytes + data.length, pages + 1];
      if (pages === Math.ceil(total / 2)) half = performance.now() - begun;
      if (pages % 16 === 0 || pages >= total) {
        const answer = Buffer.alloc(5);
        answer[0] = 2;
        answer.writeUInt32LE(data.readUInt32LE(4), 1);
        socket.send(answer);
      }
    });
  });
  const whole = performance.now() - begun;
  console.log(`1 M vertices at 100 Mbit/s: ${(bytes / 1e6).toFixed(1)} MB, the half in front after ${(half / 1e3).toFixed(2)} s, all after ${(whole / 1e3).toFixed(2)} s`);
  socket.terminate();
  const chromium = await Chromium.start(program);
  const from = performance.now();
  const page = await chromium.open(`http://127.0.0.1:${line.port}/${link.hash}`, { width: 640, height: 480 });
  await until("half is shown", () => page.run(`(window.sculptd?.figures().triangles ?? 0) > ${1e6}`).catch(() => false));
  const first = performance.now() - from;
  await page.complete();
  console.log(`in Chromium with a software renderer: half after ${(first / 1e3).toFixed(2)} s, all after ${((performance.now() - from) / 1e3).toFixed(2)} s`);
  await chromium.stop();
  line.close();
  await daemon.stop();
  daemon.remove();
}

/** A page without pictures: it confirms what it gets, or nothing at all if it is slow. */
function reader(link, slow) {
  const url = new URL(link);
  const socket = new WebSocket(`ws://${url.host}/join`, { perMessageDeflate: false });
  const counted = { bytes: 0, complete: 0, socket };
  socket.on("open", () => socket.send(JSON.stringify({ key: url.hash.slice(1), name: "" })));
  socket.on("message", (data, binary) => {
    counted.bytes += data.length;
    if (!binary) { if (JSON.parse(data).is === "complete") counted.complete++; return; }
    last = data.readUInt32LE(4);
  });
  // As a page does once a frame: an answer to each message would be too many.
  let [last, said] = [0, 0];
  const timer = setInterval(() => {
    if (slow || last === said || socket.readyState !== WebSocket.OPEN) return;
    const answer = Buffer.alloc(5);
    answer[0] = 2;
    answer.writeUInt32LE((said = last), 1);
    socket.send(answer);
  }, 16);
  socket.on("close", (code) => { clearInterval(timer); counted.closed = code; });
  return counted;
}

/** Bytes that a page is sent for a dab. */
async function dabs() {
  for (const vertices of [160e3, 1e6]) {
    const daemon = await Daemon.start(binary, withBall(vertices));
    const page = reader(daemon.links[1], false);
    await until("it is complete", () => page.complete > 0);
    const [before, bytes] = [daemon.ctl("status"), page.bytes];
    for (let n = 0; n < 20; n++) {
      const points = Array.from({ length: 30 }, (_, i) =>
        [0.5 + 0.1 * Math.cos(n + i * 0.1), 0.5 + 0.1 * Math.sin(n + i * 0.1), 0.5, i * 20]);
      daemon.ctl("stroke", { points, space: "view" });
    }
    await wait(2000);
    const after = daemon.ctl("status");
    const [laid, moved, sent] = [after.dabs - before.dabs, after.vertices_moved - before.vertices_moved, page.bytes - bytes];
    console.log(`${vertices / 1e3} k vertices: ${(sent / laid / 1e3).toFixed(1)} kB a dab that moves ${(moved / laid).toFixed(0)} vertices, ${laid} dabs`);
    if (page.closed) throw new Error(`the page was sent away: ${page.closed}`);
    page.socket.terminate();
    await daemon.stop();
    daemon.remove();
  }
}

/** Strokes on a ball for ten seconds, with so many pages; the distribution of the ticks. */
async function ticks(count) {
  const daemon = await Daemon.start(binary, withBall(160e3));
  const pages = Array.from({ length: count }, (_, n) => reader(daemon.links[1], n === 0));
  await until("the pages are complete", () => pages.slice(1).every((p) => p.complete > 0));
  const end = Date.now() + 10_000;
  for (let n = 0; Date.now() < end; n++) {
    const points = Array.from({ length: 30 }, (_, i) =>
      [0.5 + 0.1 * Math.cos(n + i * 0.1), 0.5 + 0.1 * Math.sin(n + i * 0.1), 0.5, i * 20]);
    daemon.ctl("stroke", { points, space: "view" });
  }
  const { tick_ms, dabs } = daemon.ctl("status");
  const bytes = pages.slice(1).reduce((sum, p) => sum + p.bytes, 0) / Math.max(1, count - 1);
  if (pages.some((p) => p.closed)) throw new Error("a page was sent away");
  const slow = count ? `; ${(bytes / 1e6).toFixed(1)} MB a page, ${(pages[0].bytes / 1e6).toFixed(1)} MB to the slow one` : "";
  console.log(`${count} pages: ${dabs} dabs, tick ms median ${tick_ms.p50.toFixed(3)}, p99 ${tick_ms.p99.toFixed(3)}${slow}`);
  pages.forEach((p) => p.socket.terminate());
  await daemon.stop();
  daemon.remove();
  return tick_ms.p99;
}

async function many() {
  const ratios = [];
  for (let n = 0; n < 3; n++) {
    const alone = await ticks(0);
    ratios.push((await ticks(20)) / alone);
  }
  console.log(`tick p99 with 20 pages, times alone: ${ratios.map((r) => r.toFixed(2)).join(", ")}`);
}

/** Resident bytes of a process and those that it started. */
function resident(pid) {
  const parents = new Map();
  for (const entry of readdirSync("/proc")) {
    if (!/^\d+$/.test(entry)) continue;
    try {
      const stat = readFileSync(`/proc/${entry}/stat`, "latin1");
      parents.set(Number(entry), Number(stat.slice(stat.lastIndexOf(")") + 2).split(" ")[1]));
    } catch { /* it has ended */ }
  }
  const mine = (p) => p === pid || (parents.has(p) && p > 1 && mine(parents.get(p)));
  return [...parents.keys()].filter(mine).map((p) => {
    try {
      const status = readFileSync(`/proc/${p}/status`, "latin1");
      const kind = readFileSync(`/proc/${p}/cmdline`, "latin1").match(/--type=([a-z-]+)/)?.[1] ?? "browser";
      return [kind, Number(status.match(/RssAnon:\s+(\d+)/)?.[1] ?? 0) / 1024];
    } catch { return ["gone", 0]; }
  });
}

async function memory() {
  const daemon = await Daemon.start(binary, withBall(5e6));
  const chromium = await Chromium.start(program);
  const empty = await chromium.open(daemon.links[1].replace(/#.*/, ""), { width: 640, height: 480 });
  await wait(2000);
  const before = resident(chromium.process.pid);
  await empty.close();
  const page = await chromium.open(daemon.links[1], { width: 640, height: 480 });
  const begun = performance.now();
  await page.complete();
  const sum = (all) => all.reduce((s, [, mb]) => s + mb, 0);
  const after = resident(chromium.process.pid);
  console.log(`5 M vertices complete after ${((performance.now() - begun) / 1e3).toFixed(1)} s: ${sum(after).toFixed(0)} MB in the browser's processes, ${sum(before).toFixed(0)} MB without clay; ${after.map(([k, mb]) => `${k} ${mb.toFixed(0)}`).join(", ")}`);
  await chromium.stop();
  await daemon.stop();
  daemon.remove();
}

if (is("pixel")) await pixel();
if (is("arrival")) await arrival();
if (is("dabs")) await dabs();
if (is("many")) await many();
if (is("memory")) await memory();
process.exit(0);
