// Pictures of the page to look at: phone, tablet and desktop, light and dark, each role, and a
// language with long words. `node test/pictures.mjs BINARY CHROMIUM FOLDER`
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { Chromium, Daemon, until, wait } from "./browser.mjs";

const [binary, program, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const SIZES = {
  phone: { width: 390, height: 844, scale: 2, touch: true },
  small: { width: 360, height: 640, scale: 2, touch: true },
  sideways: { width: 844, height: 390, scale: 2, touch: true },
  tablet: { width: 1024, height: 768, scale: 1, touch: true },
  desktop: { width: 1440, height: 900 },
};
const daemon = await Daemon.start(binary);
const chromium = await Chromium.start(program);
const [sculptor, viewer, device] = daemon.links;
const keep = async (page, name) => writeFileSync(join(folder, `${name}.png`), await page.picture());
const shows = (page) => page.run("!document.getElementById('legend')?.hidden");
for (const [name, size] of Object.entries(SIZES)) {
  for (const light of [false, true]) {
    const page = await chromium.open(sculptor, { ...size, light });
    await page.complete();
    await wait(300);
    await keep(page, `${name}-${light ? "light" : "dark"}`);
    if (light) {
      await page.run("document.getElementById('walls').click()");
      for (let n = 0; n < 60 && !(await shows(page)); n++) await wait(100);
      await wait(1500);
      await page.run("document.getElementById('take').open = true");
      await keep(page, `${name}-thickness`);
    }
    await page.close();
  }
}
for (const [name, link] of [["viewer", viewer], ["device", device]]) {
  const page = await chromium.open(link, SIZES.phone);
  await page.complete();
  await wait(300);
  await keep(page, name);
  await page.close();
}
for (const language of ["de", "el", "ja"]) {
  const page = await chromium.open("about:blank", SIZES.phone);
  await page.send("Emulation.setUserAgentOverride", { userAgent: "Mozilla/5.0 Chrome", acceptLanguage: language });
  await page.send("Page.navigate", { url: sculptor });
  await page.complete();
  await page.pen("mouseMoved", 190, 300, 0);
  await wait(300);
  await keep(page, `phone-${language}`);
  await page.close();
}
const page = await chromium.open(sculptor.replace(/#.*/, ""), SIZES.phone);
await until("it says that a key is missing", () => page.run("document.body?.classList.contains('ended')"));
await keep(page, "no-key");
await chromium.stop();
await daemon.stop();
daemon.remove();
process.exit(0);
