// Strokes over a bad line: pieces are late and uneven, stall as after lost packets, and the line is
// cut at random. Every stroke that no cut met arrives whole, with the pressure and the tilt that the
// browser was given; no contact is lost or doubled; the session holds exactly what arrived and
// replays to the same clay.
// `node test/loss.mjs BINARY CHROMIUM`; SCULPTD_LONG=1 draws 10,000 strokes, STROKES another number.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { Chromium, Daemon, until, wait } from "./browser.mjs";
import { Line, diceOf } from "./line.mjs";

const [binary, program] = process.argv.slice(2);
const strokes = Number(process.env.STROKES ?? (process.env.SCULPTD_LONG ? 10_000 : 200));
const EACH_CUT = 50;
const POINTS = 6;
const seed = Number(process.env.SEED ?? 55);
const [dice, lateness] = [diceOf(seed), diceOf(seed + 1)];

/** 5 to 45 ms; one piece in 60 waits until its packet was sent again, 200 to 600 ms. */
const late = () => 5 + lateness() * 40 + (lateness() < 1 / 60 ? 200 + lateness() * 400 : 0);

/** What a record holds of a share: 16 bits. */
const u16 = (share) => Math.round(share * 65535);
/** The name of a point: its pressure and its tilt are in it. */
const nameOf = (pressure, tilt) => `${pressure} ${tilt.join(" ")}`;

/** Every point that is to arrive, by name: stroke and place in it. */
const injected = new Map();
/** Points of each stroke that arrived. */
const arrived = [];
/** What reached the daemon: records, contacts that begin and end, also those that a cut ends. */
const seen = { records: 0, downs: 0, lifts: 0, cutLifts: 0, last: -1, doubled: 0, unknown: 0 };
/** The pen as the daemon has it, by connection. */
const pens = new Map();

/** Connections that have said who joins. */
let joined = 0;

function deliver(message, isBinary, connection) {
  joined = Math.max(joined, connection);
  if (!isBinary || message[0] !== 1) return;
  for (let at = 5; at + 20 <= message.length; at += 20) {
    const bits = message[at + 18];
    const [was, down] = [pens.get(connection) ?? { down: false, near: false }, (bits & 2) !== 0];
    pens.set(connection, { down, near: (bits & 1) !== 0 });
    seen.records++;
    if (down && !was.down) seen.downs++;
    if (!down && was.down) seen.lifts++;
    if (!down) continue;
    const found = injected.get(nameOf(message.readUInt16LE(at + 12), [message.readInt8(at + 14), message.readInt8(at + 15)]));
    if (!found) { seen.unknown++; continue; }
    const order = found.stroke * POINTS + found.point;
    if (order <= seen.last) seen.doubled++;
    seen.last = order;
    arrived[found.stroke]++;
  }
}

const daemon = await Daemon.start(binary, (home) => ["--session", join(home, "loss.sculpt")]);
const chromium = await Chromium.start(program);
const line = await Line.to(Number(new URL(daemon.links[0]).port), { late, delivered: (m, b, c) => deliver(Buffer.from(m), b, c) });
try {
  const page = await chromium.open(line.link(daemon.links[0]), { width: 480, height: 480 });
  await page.complete();
  const begun = performance.now();
  const cutStrokes = new Set();
  let [cuts, last] = [0, 0];
  for (let n = 0; n < strokes; n++) {
    const [x, y, turn] = [210 + dice() * 50, 110 + dice() * 50, dice() * 6.28];
    const points = [];
    while (points.length < POINTS) {
      const i = points.length;
      const point = {
        x: x + Math.cos(turn) * i * 3, y: y + Math.sin(turn) * i * 3,
        force: u16(0.2 + 0.6 * dice()) / 65535, tilt: [Math.round(dice() * 120 - 60), Math.round(dice() * 120 - 60)],
      };
      const name = nameOf(u16(point.force), point.tilt);
      // A name that another point has is drawn again.
      if (injected.has(name)) continue;
      injected.set(name, { stroke: n, point: i });
      points.push(point);
    }
    arrived.push(0);
    const drawn = page.stroke(points);
    if (n % EACH_CUT === Math.floor(EACH_CUT / 2)) {
      await wait(dice() * 90);
      // What is on the way is lost with the line: its strokes are not whole.
      for (let k = last; k <= n; k++) if (arrived[k] < POINTS) cutStrokes.add(k);
      const before = joined;
      line.cut();
      [cuts, last] = [cuts + 1, n + 1];
      await drawn;
      await until("the page is back", () => joined > before
        && page.run("sculptd.connection.isOpen && document.getElementById('state').textContent.includes('·')"));
    } else {
      await drawn;
    }
  }
  const far = () => `${arrived.slice(-3)} of ${POINTS}, ${JSON.stringify(seen)}`;
  await until("the last stroke has arrived", () => arrived[strokes - 1] === POINTS).catch((e) => { throw new Error(`${e.message}: ${far()}`); });
  const seconds = (performance.now() - begun) / 1e3;
  // Each connection that a cut ended lifts a pen that was down, and takes one away that was near.
  const gone = [...pens.entries()].slice(0, -1).map(([, pen]) => pen);
  seen.cutLifts = gone.filter((pen) => pen.down).length;
  const leaves = gone.filter((pen) => pen.near || pen.down).length;

  const missing = arrived.map((n, k) => [n, k]).filter(([n, k]) => n < POINTS && !cutStrokes.has(k));
  assert.deepEqual(missing, [], "every stroke that no cut met is whole");
  assert.equal(seen.unknown, 0, "pressure and tilt are those that were injected");
  assert.equal(seen.doubled, 0, "nothing is doubled, and the order is kept");
  assert.equal(seen.downs, seen.lifts + seen.cutLifts, "each contact that began has ended");
  const { losses, samples } = await until("the daemon took all samples", () => {
    const now = daemon.ctl("status");
    return now.samples >= seen.records + leaves && now;
  });
  assert.equal(samples, seen.records + leaves, "the world took what arrived, once");
  assert.deepEqual(losses, { motion: 0, transition: 0 });
  await until("the clay is at rest", async () => {
    const { hash } = daemon.ctl("hash");
    await wait(500);
    return daemon.ctl("hash").hash === hash;
  });
  const steps = daemon.ctl("history").places.length - 1;
  // A stall delivers several strokes at once: those that end in one tick are one place there.
  assert.ok(steps > 0 && steps <= seen.downs, `${steps} places for ${seen.downs} contacts`);
  const { hash } = daemon.ctl("hash");
  const away = Math.round(await page.run("sculptd.connection.longestAway"));
  await chromium.stop();
  await daemon.stop();
  const replay = JSON.parse(execFileSync(binary, ["--json", "replay", join(daemon.home, "loss.sculpt")], { env: daemon.env, encoding: "utf8" }));
  assert.equal(replay.hash ?? replay.mesh_hash, hash, "the session replays to the same clay");
  console.log(`${strokes} strokes in ${seconds.toFixed(0)} s over a bad line, ${cuts} cuts met ${cutStrokes.size} of them: ${seen.downs} contacts in ${steps} places, `
    + `${samples} samples, losses ${JSON.stringify(losses)}, back within ${away} ms, replayed to ${hash}`);
} finally {
  line.close();
  if (chromium.process.exitCode === null) await chromium.stop();
  if (daemon.process.exitCode === null) await daemon.stop("SIGKILL");
  daemon.remove();
}
process.exit(0);
