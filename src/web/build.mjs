// Builds the page into dist/, which is checked in: `cargo build` needs no Node.
import { copyFileSync, mkdirSync, readdirSync } from "node:fs";
import { build } from "esbuild";

mkdirSync("dist", { recursive: true });
await build({
  entryPoints: ["src/main.ts"],
  outfile: "dist/app.js",
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
});
for (const file of readdirSync("static")) copyFileSync(`static/${file}`, `dist/${file}`);
