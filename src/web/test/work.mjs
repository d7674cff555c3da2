// The page of a visitor's work, in a real Chromium: it shows the work, a drag turns it, the button
// deletes it. Arguments: the page's address, the work's file, the browser, a folder for pictures.
import { existsSync, mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { Chromium, until } from "./browser.mjs";

const [url, work, program, pictures] = process.argv.slice(2);
const check = (what, so) => { if (!so) throw new Error(`not so: ${what}`); };
const chromium = await Chromium.start(program);
const dialogs = [];
let accept = false;
chromium.events.set("Page.javascriptDialogOpening", ({ message }, session) => {
  dialogs.push(message);
  chromium.send("Page.handleJavaScriptDialog", { accept }, session);
});
const look = async (name, size) => {
  const page = await chromium.open(url, size);
  // Shares of the canvas that are lit: the colour of clay is red before blue.
  const lit = () => page.run(`(() => {
    const from = document.querySelector("canvas");
    if (!from || !from.width) return 0;
    const to = document.createElement("canvas");
    [to.width, to.height] = [64, 64];
    const flat = to.getContext("2d");
    return new Promise((done) => requestAnimationFrame(() => {
      flat.drawImage(from, 0, 0, 64, 64);
      const data = flat.getImageData(0, 0, 64, 64).data;
      let clay = 0;
      for (let i = 0; i < data.length; i += 4) clay += data[i] > data[i + 2] + 20 ? 1 : 0;
      done(clay / 4096);
    }));
  })()`);
  const share = await until(`${name}: the work is drawn`, lit);
  check(`${name}: the work fills some of the picture, ${share}`, share > 0.1 && share < 0.95);
  const [wide, all] = await page.run("[document.documentElement.scrollWidth, innerWidth]");
  check(`${name}: nothing is wider than the screen`, wide <= all);
  if (pictures) {
    mkdirSync(pictures, { recursive: true });
    writeFileSync(join(pictures, `work-${name}.png`), await page.picture());
  }
  return page;
};
for (const [name, size] of [
  ["phone", { width: 390, height: 844, scale: 2, touch: true }],
  ["desktop", { width: 1280, height: 800, light: true }],
]) {
  await (await look(name, size)).close();
}
const page = await look("turned", { width: 800, height: 600 });
const errors = await page.run("performance.getEntriesByType('resource').filter((e) => e.responseStatus >= 400).length");
check("every file of the page is there", errors === 0);
await page.stroke([{ x: 400, y: 200, force: 0.5 }, { x: 460, y: 240, force: 0.5 }]);
// A touch stops the slow turn, so that two pictures agree.
const still = async () => (await page.picture()).equals(await page.picture());
await until("a touch stops the turn", still);
const before = await page.picture();
await page.stroke([{ x: 400, y: 200, force: 0.5 }, { x: 500, y: 260, force: 0.5 }]);
check("a drag turns the work", !(await page.picture()).equals(before));
await page.run("document.querySelector('button').click()");
check("it asks before it deletes", dialogs.length === 1 && existsSync(work));
accept = true;
await page.run("document.querySelector('button').click()");
await until("it is deleted", () => !existsSync(work));
await until("the page says so", () => page.run("!document.querySelector('canvas')"));
await chromium.stop();
console.log("the page of a visitor's work: done");
