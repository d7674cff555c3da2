// The page over a bad line: everything is late, and the line is cut in the middle of strokes. Each
// stroke is one step, a cut stroke ends, nothing is doubled, and the page is back within two seconds.
// `node test/cuts.mjs BINARY CHROMIUM`; CUTS sets how many cuts there are.
import assert from "node:assert/strict";
import { join } from "node:path";
import { Chromium, Daemon, until, wait } from "./browser.mjs";
import { Line, diceOf } from "./line.mjs";

const [binary, program] = process.argv.slice(2);
const cuts = Number(process.env.CUTS ?? 6);
const dice = diceOf(777);

const daemon = await Daemon.start(binary, (home) => ["--session", join(home, "line.sculpt")]);
const chromium = await Chromium.start(program);
const late = diceOf(778);
let slow = 0;
const line = await Line.to(Number(new URL(daemon.links[0]).port), { late: () => slow + 20 + late() * 40 });
try {
  const page = await chromium.open(line.link(daemon.links[0]));
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

  // The expected dab is drawn before the daemon has answered, and goes when its clay is there.
  await page.run(`(() => {
    const { connection, expected } = sculptd;
    const seen = window.seen = { down: 0, batch: 0, disc: 0, taken: 0, points: "" };
    document.getElementById("clay").addEventListener("pointerdown", () => {
      [seen.down, seen.batch] = [performance.now(), connection.lastBatch + 1];
    }, true);
    new MutationObserver(() => {
      const disc = document.querySelector("#expected polygon");
      if (!disc || seen.disc) return;
      [seen.disc, seen.points] = [performance.now(), disc.getAttribute("points") ?? ""];
    }).observe(document.getElementById("expected"), { childList: true, subtree: true, attributes: true });
    const taken = expected.taken.bind(expected);
    expected.taken = (batch, now) => {
      if (seen.down && !seen.taken && batch >= seen.batch) seen.taken = now;
      taken(batch, now);
    };
  })()`);
  await page.pen("mouseMoved", 480, 320, 0);
  await wait(300);
  slow = 400;
  await page.pen("mousePressed", 480, 320, 0.6);
  await until("a dab is expected", () => page.run("seen.disc > 0"));
  await until("the daemon has answered", () => page.run("seen.taken > 0"));
  const seen = await page.run("seen");
  assert.ok(seen.disc < seen.taken, `drawn ${seen.disc - seen.down} ms, answered ${seen.taken - seen.down} ms after the pen`);
  slow = 0;
  const beforeIt = steps();
  assert.match(seen.points, /^[\d., ]+$/);
  await page.pen("mouseReleased", 480, 320, 0);
  await until("the clay has taken its place", () => page.run("sculptd.expected.count === 0 && !document.querySelector('#expected polygon')"));
  // The pen's lift is still on the way: a step that comes later would count as one of a cut stroke.
  await until("the stroke is a step", () => steps() > beforeIt);
  console.log(`expected dab after ${(seen.disc - seen.down).toFixed(0)} ms, the daemon's answer after ${(seen.taken - seen.down).toFixed(0)} ms`);

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
    assert.ok(steps() <= before + 1, `cut ${n} at point ${at}: ${steps() - before} steps of one stroke`);
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
