// The page in a real browser: it shows the clay, its pen sculpts, and what it sent is what the
// session holds. `node test/sculpt.mjs BINARY CHROMIUM [FOLDER FOR PICTURES]`; STROKES sets how
// many strokes are drawn.
import assert from "node:assert/strict";
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { Chromium, Daemon, until, wait } from "./browser.mjs";

const [binary, program, pictures] = process.argv.slice(2);
const strokes = Number(process.env.STROKES ?? 40);
const keep = (name, bytes) => {
  if (!pictures) return;
  mkdirSync(pictures, { recursive: true });
  writeFileSync(join(pictures, name), bytes);
};
let seed = 12345;
const dice = () => ((seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32);

const daemon = await Daemon.start(binary, (home) => ["--session", join(home, "web.sculpt")]);
const chromium = await Chromium.start(program);
const [sculptor, viewer] = daemon.links;
try {
  const page = await chromium.open(sculptor);
  await page.complete();
  const shown = await page.run("sculptd.figures()");
  const before = daemon.ctl("status");
  daemon.hash = daemon.ctl("hash").hash;
  assert.equal(shown.triangles, before.triangles, "all triangles are on the page");
  keep("desktop.png", await page.picture());

  const small = { width: 700, height: 500, deviceScaleFactor: 1, mobile: false };
  await page.send("Emulation.setDeviceMetricsOverride", small);
  // Each stroke: what the browser injected, and what came of it.
  const session = join(daemon.home, "web.sculpt");
  const sent = await page.penRecords();
  const injected = [];
  for (let n = 0; n < strokes; n++) {
    const [x, y, turn] = [320 + dice() * 60, 170 + dice() * 60, dice() * 6.28];
    const path = Array.from({ length: 12 }, (_, i) => ({
      x: x + Math.cos(turn) * i * 2, y: y + Math.sin(turn) * i * 2,
      force: 0.2 + 0.6 * dice(), tilt: [Math.round(dice() * 80 - 40), Math.round(dice() * 80 - 40)],
    }));
    await page.stroke(path);
    injected.push(...path);
  }
  const after = await until("all strokes are steps", () => {
    const now = daemon.ctl("status");
    return now.dabs > before.dabs && daemon.ctl("people") && now;
  });
  await wait(500);
  await page.complete();
  keep("sculpted.png", await page.picture());
  // What the page sent is what the browser injected: no contact is lost, and each has its pressure and tilt.
  const contacts = sent.filter((r) => r.down);
  const lifts = sent.filter((r, i) => !r.down && sent[i - 1]?.down).length;
  assert.equal(lifts, strokes, "each stroke ends");
  assert.equal(contacts.length, injected.length, "each point is sent");
  let [worst, tilts] = [0, 0];
  contacts.forEach((r, i) => {
    worst = Math.max(worst, Math.abs(r.pressure - injected[i].force));
    tilts += r.tilt.some((v, k) => v !== injected[i].tilt[k]) ? 1 : 0;
  });
  assert.ok(worst < 1e-4, `pressure differs by ${worst}`);
  assert.equal(tilts, 0, "tilts differ");
  assert.equal(after.losses.transition, 0);

  // A viewer sees, and does not sculpt.
  const watching = await chromium.open(viewer, { width: 390, height: 844, scale: 2, touch: true });
  await watching.complete();
  const hash = daemon.ctl("hash").hash;
  await watching.stroke([{ x: 190, y: 400, force: 0.9 }, { x: 230, y: 420, force: 0.9 }, { x: 260, y: 440, force: 0.9 }]);
  await wait(300);
  assert.equal(daemon.ctl("hash").hash, hash, "a viewer changes nothing");
  keep("phone.png", await watching.picture());

  // A guest takes the work home.
  const saved = join(daemon.home, "taken");
  mkdirSync(saved);
  await chromium.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: saved });
  for (const format of ["glb", "stl"]) {
    await watching.run(`document.getElementById("take").open = true; document.getElementById("${format}").click()`);
    const file = join(saved, `sculpture.${format}`);
    await until(`${format} is saved`, () => existsSync(file));
    const facts = JSON.parse(execFileSync(binary, ["--json", "measure", file], { env: daemon.env, encoding: "utf8" }));
    assert.equal(facts.triangles ?? facts[0]?.triangles ?? facts.faces, before.triangles, JSON.stringify(facts));
  }

  const guests = daemon.ctl("guests.list");
  assert.deepEqual(guests.guests.map((g) => g.role), ["sculptor", "viewer"]);

  // The guest undoes stroke by stroke: after as many steps as strokes nothing is left of them.
  const press = async (id, times) => {
    for (let n = 0; n < times; n++) await page.run(`document.getElementById("${id}").click()`);
  };
  // Of very many strokes the last hundred are taken back.
  const undone = Math.min(strokes, 100);
  const first = daemon.hash;
  await press("undo", undone - 1);
  await wait(500);
  const nearly = daemon.ctl("hash").hash;
  assert.notEqual(nearly, first, "one stroke is left");
  await press("undo", 1);
  if (undone === strokes) await until("everything is undone", () => daemon.ctl("hash").hash === first);
  else await until("a hundred strokes are undone", () => daemon.ctl("hash").hash !== nearly);
  await press("redo", undone);
  await until("everything is done again", () => daemon.ctl("hash").hash === hash);

  // A revoked link disconnects its guest.
  const key = guests.links.find((l) => l.role === "viewer").key;
  assert.equal(daemon.ctl("guests.revoke", { key }).guests, 1);
  await until("the viewer is told", () => watching.run("document.body?.classList.contains('ended')"));
  const again = await chromium.open(viewer);
  await until("its link is refused", () => again.run("document.body?.classList.contains('ended')"));
  keep("revoked.png", await again.picture());

  await daemon.stop();
  const replay = JSON.parse(execFileSync(binary, ["--json", "replay", session], { env: daemon.env, encoding: "utf8" }));
  assert.equal(replay.hash ?? replay.mesh_hash, hash, "the session replays to the same clay");
  console.log(`${strokes} strokes of ${injected.length} points, ${after.dabs} dabs: replayed to ${hash}; pressure within ${worst.toExponential(1)}`);
} finally {
  await chromium.stop();
  if (daemon.process.exitCode === null) await daemon.stop("SIGKILL");
  daemon.remove();
}
