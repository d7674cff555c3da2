// Builds the page into dist/, which is checked in: `cargo build` needs no Node. `npm run build -- FOLDER`
// builds it there instead.
import { copyFileSync, mkdirSync, readdirSync } from "node:fs";
import { build } from "esbuild";

const out = process.argv[2] ?? "dist";
mkdirSync(out, { recursive: true });
await build({
  entryPoints: ["src/main.ts"],
  outfile: `${out}/app.js`,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
});
for (const file of readdirSync("static")) copyFileSync(`static/${file}`, `${out}/${file}`);
