// The map of wall thickness on the page: it follows the clay, its legend says what the daemon
// measures, it changes nothing, and a viewer's page cannot ask for it.
// `node test/walls.mjs BINARY CHROMIUM`
import assert from "node:assert/strict";
import { Chromium, Daemon, until, wait } from "./browser.mjs";

const [binary, program] = process.argv.slice(2);
const daemon = await Daemon.start(binary);
const chromium = await Chromium.start(program);
const [sculptor, viewer] = daemon.links;
const legend = (page) => page.run("document.getElementById('legend').hidden ? '' : document.getElementById('legend').textContent");
const scale = (page) => page.run("sculptd.scale()");
try {
  const page = await chromium.open(sculptor, { width: 640, height: 560 });
  await page.complete();
  const { hash } = daemon.ctl("hash");
  assert.equal(await legend(page), "", "no map at first");
  await page.run("document.getElementById('walls').click()");
  const measured = () => until("every wall is measured", async () => ((await scale(page))?.measured === 1));
  await measured();
  assert.match(await legend(page), /^\s*Thickness\s+[\d.,]+ mm[\d., m]+mm\s*$/);
  const shown = await scale(page);
  const asked = daemon.ctl("thickness", { limit: 1, rays: 1 });
  assert.ok(Math.abs(shown.low - asked.min) < 0.02 * asked.max, `${JSON.stringify(shown)}, the daemon: ${asked.min} to ${asked.max}`);
  await until("the walls are on the card", () => page.run("sculptd.figures().walls === sculptd.figures().pages"));
  assert.equal(daemon.ctl("hash").hash, hash, "looking changes nothing");

  // It follows a stroke.
  await page.stroke(Array.from({ length: 20 }, (_, i) => ({ x: 300 + i * 2, y: 200 + i, force: 0.9 })));
  await until("the stroke is there", () => daemon.ctl("hash").hash !== hash);
  await until("the scale follows", async () => {
    const now = await scale(page);
    return now && (now.high !== shown.high || now.low !== shown.low);
  });
  await measured();

  // A viewer cannot ask; the window of the host alone shows the map to all.
  const watching = await chromium.open(viewer, { width: 390, height: 844 });
  await watching.complete();
  assert.ok(await watching.run("document.getElementById('walls').hidden"));
  await watching.run("sculptd.connection.ask({ do: 'walls', on: true })");
  await until("it is refused", () => watching.run("!document.getElementById('note').hidden"));
  await wait(300);
  assert.equal(await legend(watching), "");

  await page.run("document.getElementById('walls').click()");
  await until("the map is gone", async () => (await legend(page)) === "");
  console.log(`walls: ${shown.low.toFixed(2)} to ${shown.high.toFixed(2)} mm on the legend, ${asked.min.toFixed(2)} to ${asked.max.toFixed(2)} by the method`);
} finally {
  await chromium.stop();
  if (daemon.process.exitCode === null) await daemon.stop();
  daemon.remove();
}
