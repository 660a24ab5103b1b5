// Makes dist/ of src/: one file of code with three.js and uPlot in it, one of style, and the shell.
//
//   npm ci && npm run build
//
// The same sources give the same bytes everywhere; `npm run check` says whether dist/ is that.
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync, mkdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const read = (name) => readFileSync(join(here, name), "utf8");

/** What others wrote stands in the page with its licence, as the licence asks. */
function licences() {
  const texts = ["three", "uplot"].map((name) => {
    const { version } = JSON.parse(read(`node_modules/${name}/package.json`));
    const text = read(`node_modules/${name}/LICENSE`).replaceAll("\r", "").trim();
    return `${name} ${version}\n\n${text}`;
  });
  return `/*\n${texts.join("\n\n").replaceAll("*/", "* /")}\n*/\n`;
}

const { outputFiles } = await build({
  absWorkingDir: here,
  entryPoints: ["src/main.js"],
  outdir: "dist",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  write: false,
});
const text = (end) => outputFiles.find(({ path }) => path.endsWith(end)).text;
const code = licences() + text(".js");
const boot = read("src/boot.js");
// The browser runs these two scripts of the page and no other.
const hash = (script) => `'sha256-${createHash("sha256").update(script).digest("base64")}'`;
const files = {
  "page.js": code,
  "page.html": read("src/index.html")
    .replace("@STYLE@", () => text(".css").trim())
    .replace("@HASHES@", () => `${hash(boot)} ${hash(code)}`)
    .replace("@BOOT@", () => boot),
};

if (process.argv.includes("--check")) {
  const stale = Object.keys(files).filter((name) => files[name] !== read(`dist/${name}`));
  if (stale.length) {
    console.error(`dist/${stale.join(", dist/")} is not what src/ gives: run npm run build`);
    process.exit(1);
  }
} else {
  mkdirSync(join(here, "dist"), { recursive: true });
  for (const [name, content] of Object.entries(files)) {
    writeFileSync(join(here, "dist", name), content);
    console.log(`${name}  ${content.length} characters`);
  }
}
