// The page without a pointer, for screen readers and for eyes that need contrast.
// `node test/controls.mjs BINARY CHROMIUM`
import assert from "node:assert/strict";
import { Chromium, Daemon, until, wait } from "./browser.mjs";

const [binary, program] = process.argv.slice(2);

/** Least contrast of the texts that are shown (WCAG 2.2, 1.4.3), over both ends of the ground. */
const CONTRAST = `(() => {
  const parse = (text) => {
    const found = text.match(/[\\d.]+/g).map(Number);
    return found.length > 3 ? found : [...found, 1];
  };
  const over = ([r, g, b, a], [x, y, z]) => [r * a + x * (1 - a), g * a + y * (1 - a), b * a + z * (1 - a), 1];
  const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const style = getComputedStyle(document.documentElement);
  const hex = (name) => style.getPropertyValue(name).trim().match(/[0-9a-f]{2}/gi).map((v) => parseInt(v, 16));
  const all = [];
  for (const e of document.querySelectorAll("button, summary, select, input, span, p, li")) {
    const box = e.getBoundingClientRect();
    const text = e.value ?? e.textContent;
    if (!box.width || !text || e.querySelector("button, select, input") || ["range", "color"].includes(e.type)) continue;
    for (const ground of [hex("--ground"), hex("--ground-low")]) {
      const layers = [];
      for (let up = e; up; up = up.parentElement) layers.push(parse(getComputedStyle(up).backgroundColor));
      const below = layers.reverse().reduce((under, layer) => over(layer, under), ground);
      const [a, b] = [light(over(parse(getComputedStyle(e).color), below)), light(below)];
      all.push([(Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05), e.id || e.textContent]);
    }
  }
  return all.sort((a, b) => a[0] - b[0]);
})()`;

const daemon = await Daemon.start(binary);
const chromium = await Chromium.start(program);
try {
  for (const light of [false, true]) {
    for (const [width, height] of [[390, 844], [1280, 800]]) {
      const page = await chromium.open(daemon.links[0], { width, height, light });
      await page.complete();
      const [[least, where]] = await page.run(CONTRAST);
      console.log(`${width} x ${height}, ${light ? "light" : "dark"}: contrast at least ${least.toFixed(1)} (${where})`);
      assert.ok(least >= 4.5, `${where}: ${least}`);
      const cut = await page.run(`[...document.querySelectorAll("button, summary, span, #state")]
        .filter((e) => e.offsetParent && (e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0 || e.getBoundingClientRect().right > innerWidth + 1))
        .map((e) => e.id || e.textContent)`);
      assert.deepEqual(cut, [], "no text is cut");
      await page.close();
    }
  }

  const page = await chromium.open(daemon.links[0]);
  await page.complete();
  const key = async (name, modifiers = 0) => {
    const code = { Tab: 9, " ": 32, Enter: 13, ArrowRight: 39, ArrowLeft: 37, ArrowUp: 38, ArrowDown: 40 }[name] ?? name.toUpperCase().charCodeAt(0);
    const text = name === " " ? " " : name === "Enter" ? "\r" : name.length === 1 ? name : undefined;
    await page.send("Input.dispatchKeyEvent", { type: "keyDown", key: name, windowsVirtualKeyCode: code, modifiers, text: modifiers ? undefined : text });
    await page.send("Input.dispatchKeyEvent", { type: "keyUp", key: name, windowsVirtualKeyCode: code, modifiers });
  };
  const focused = () => page.run("document.activeElement?.id ?? ''");
  const reached = [];
  for (let n = 0; n < 30; n++) {
    await key("Tab");
    const now = await focused();
    if (reached.includes(now)) break;
    reached.push(now);
  }
  const wanted = ["clay", "name", "home", "walls", "follow", "takeHome", "kind", "radius", "strength", "colour", "negative", "mirror", "undo", "redo"];
  assert.deepEqual(wanted.filter((id) => !reached.includes(id)), [], `reached by Tab: ${reached}`);

  const at = async (id) => { for (let n = 0; n < 30 && (await focused()) !== id; n++) await key("Tab"); };
  const yaw = () => page.run("sculptd.camera().yaw");
  await at("clay");
  const before = await yaw();
  await key("ArrowRight");
  assert.notEqual(await yaw(), before, "an arrow key turns the view");
  await at("negative");
  await key(" ");
  await until("the brush carves", () => page.run("document.getElementById('negative').getAttribute('aria-pressed') === 'true'"));
  await at("radius");
  const radius = await page.run("document.getElementById('radius').value");
  await key("ArrowRight");
  assert.notEqual(await page.run("document.getElementById('radius').value"), radius);
  await at("kind");
  const kind = await page.run("document.getElementById('kind').value");
  await key("ArrowDown");
  await until("another brush", async () => (await page.run("document.getElementById('kind').value")) !== kind);
  await at("takeHome");
  await key("Enter");
  await until("the formats are offered", () => page.run("document.getElementById('take').open"));
  await key("Tab");
  assert.equal(await focused(), "glb");
  await at("undo");
  await key("Enter");
  await until("the answer is read aloud", () => page.run("!document.getElementById('note').hidden && document.getElementById('note').getAttribute('role') === 'alert'"));

  // Everything that takes the focus has a name.
  await page.send("Accessibility.enable");
  const { nodes } = await page.send("Accessibility.getFullAXTree");
  const focusable = nodes.filter((n) => !n.ignored && n.properties?.some((p) => p.name === "focusable" && p.value.value) && n.role.value !== "RootWebArea");
  const nameless = focusable.filter((n) => !n.name?.value).map((n) => n.role.value);
  assert.deepEqual(nameless, [], "every control has a name");
  await wait(50);
  console.log(`by keyboard: ${reached.join(", ")}; ${focusable.length} controls with names`);
} finally {
  await chromium.stop();
  await daemon.stop();
  daemon.remove();
}
