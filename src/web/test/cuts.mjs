// The page over a bad line: everything is late, and the line is cut in the middle of strokes. Each
// stroke is one step, a cut stroke ends, nothing is doubled, and the page is back within two seconds.
// `node test/cuts.mjs BINARY CHROMIUM`; CUTS sets how many cuts there are.
import assert from "node:assert/strict";
import { createServer, connect } from "node:net";
import { join } from "node:path";
import { Chromium, Daemon, until, wait } from "./browser.mjs";

const [binary, program] = process.argv.slice(2);
const cuts = Number(process.env.CUTS ?? 6);
let seed = 777;
const dice = () => ((seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32);

/** A line that delivers each piece 20 to 60 ms late, in order, and can be cut. */
class Line {
  static async to(port) {
    const line = new Line();
    line.pairs = new Set();
    line.server = createServer({ allowHalfOpen: true }, (near) => {
      const far = connect({ port, host: "127.0.0.1", allowHalfOpen: true });
      const pair = { near, far };
      line.pairs.add(pair);
      const pass = (from, to, change = (data) => data) => {
        let before = Promise.resolve();
        from.on("data", (data) => {
          const late = wait(20 + dice() * 40);
          before = before.then(() => late).then(() => to.writable && to.write(change(data)));
        });
        from.on("error", () => to.destroy());
        from.on("end", () => { before = before.then(() => to.end()); });
        from.on("close", () => line.pairs.delete(pair));
      };
      // The daemon answers to its own name only.
      const rename = (data) => {
        const text = data.toString("latin1");
        if (!text.startsWith("GET ")) return data;
        return Buffer.from(text.replaceAll(`127.0.0.1:${line.port}`, `127.0.0.1:${port}`), "latin1");
      };
      pass(near, far, rename);
      pass(far, near);
    });
    await new Promise((done) => line.server.listen(0, "127.0.0.1", done));
    line.port = line.server.address().port;
    return line;
  }

  cut() { for (const { near, far } of this.pairs) { near.destroy(); far.destroy(); } }
  close() { this.cut(); this.server.close(); }
}

const daemon = await Daemon.start(binary, (home) => ["--session", join(home, "line.sculpt")]);
const chromium = await Chromium.start(program);
const link = new URL(daemon.links[0]);
const line = await Line.to(Number(link.port));
try {
  const page = await chromium.open(`http://127.0.0.1:${line.port}/${link.hash}`);
  await page.complete();
  const steps = () => daemon.ctl("history").places.length;
  const path = (n) => Array.from({ length: n }, (_, i) => ({
    x: 460 + dice() * 60 + i * 3, y: 300 + dice() * 40 + i * 2, force: 0.3 + 0.5 * dice(),
  }));
  const whole = async () => {
    const before = steps();
    await page.stroke(path(10));
    await until("the stroke is a step", () => steps() > before);
    await wait(250);
    assert.equal(steps(), before + 1, "one stroke, one step");
  };
  await whole();
  for (let n = 0; n < cuts; n++) {
    const before = steps();
    const points = path(20);
    await page.pen("mouseMoved", points[0].x, points[0].y, 0);
    await page.pen("mousePressed", points[0].x, points[0].y, 0.5);
    const at = 3 + Math.floor(dice() * 14);
    for (const [i, p] of points.entries()) {
      if (i === at) { await wait(dice() * 80); line.cut(); }
      await page.pen("mouseMoved", p.x, p.y, p.force);
    }
    await page.pen("mouseReleased", points[19].x, points[19].y, 0);
    await until("the page is back", () => page.run("sculptd.connection.isOpen"));
    await until("its pen is lifted", () => !daemon.ctl("people").people.some((p) => p.pens.some((pen) => pen.down)));
    await wait(300);
    assert.ok(steps() <= before + 1, "a cut stroke is one step at most");
    await until("the page joined again", () => daemon.ctl("guests.list").guests.length === 1);
    await whole();
    await page.complete();
  }
  const { losses } = daemon.ctl("status");
  const slowest = Math.round(await page.run("sculptd.connection.longestAway"));
  assert.ok(slowest < 2000, `back after ${slowest} ms`);
  const guests = daemon.ctl("guests.list").guests;
  assert.deepEqual(guests.map((g) => g.person), [128], "the same guest after every cut");
  console.log(`${cuts} cuts: back within ${slowest} ms, losses ${JSON.stringify(losses)}`);
} finally {
  line.close();
  await chromium.stop();
  await daemon.stop();
  daemon.remove();
}
