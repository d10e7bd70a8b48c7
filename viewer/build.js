// Bundles src/main.js into the Python package, with the licences of what is bundled.

import { readFileSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(here, "..", "src", "punchform", "report", "viewer"));

const { outputFiles, metafile } = await build({
  absWorkingDir: here,
  entryPoints: ["src/main.js"],
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome111", "firefox113", "safari16.4"],
  charset: "ascii",
  legalComments: "none",
  metafile: true,
  write: false,
});
const packages = new Set(
  Object.keys(metafile.inputs).filter((path) => path.startsWith("node_modules/")).map((path) => path.split("/")[1]),
);
const licences = [...packages].sort().map((name) => {
  const { version } = JSON.parse(readFileSync(join(here, "node_modules", name, "package.json"), "utf-8"));
  return `${name} ${version}\n\n${readFileSync(join(here, "node_modules", name, "LICENSE"), "utf-8").trim()}\n`;
});
const told = `viewer.js holds parts of these works.\n\n${licences.join("\n")}`;
writeFileSync(join(out, "LICENSES.txt"), told);

// A page goes to people who never see the package, so the licences stand in the program itself. The page names no
// address: hints in messages of libraries lose theirs.
const program = outputFiles[0].text.replaceAll(/https?:\/\/(?!www\.w3\.org\/)/g, "");
const text = `/*!\n${told}*/\n${program}`;
writeFileSync(join(out, "viewer.js"), text);
console.log(`viewer.js: ${text.length} bytes; bundled: ${[...packages].join(", ")}`);
