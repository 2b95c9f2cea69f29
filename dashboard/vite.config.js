// Builds the page into the service's package. A stamp of the sources goes beside it: a test compares it with them.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join, relative, sep } from "node:path";
import { defineConfig } from "vite";

const ROOT = import.meta.dirname;
const OUT = join(ROOT, "../service/dashboard");
const SOURCES = ["index.html", "package-lock.json", "public", "src", "vite.config.js"];

function files(path) {
  return statSync(path).isDirectory() ? readdirSync(path).flatMap((name) => files(join(path, name))) : [path];
}

/** SHA-256 over name and content of every source, in the order of their names. */
function stamp() {
  const names = SOURCES.flatMap((name) => files(join(ROOT, name))).map((path) => relative(ROOT, path).split(sep).join("/"));
  const digest = createHash("sha256");
  for (const name of names.sort()) digest.update(`${name}\0`).update(readFileSync(join(ROOT, name))).update("\0");
  return digest.digest("hex");
}

export default defineConfig({
  root: ROOT,
  oxc: { jsx: { runtime: "automatic", importSource: "preact" } },
  build: {
    outDir: OUT,
    emptyOutDir: true,
    target: "es2022",
    modulePreload: { polyfill: false },
    assetsInlineLimit: 0,
  },
  plugins: [{ name: "stamp", closeBundle: () => writeFileSync(join(OUT, "built-from.txt"), `${stamp()}\n`) }],
  server: { proxy: { "/api": process.env.RUNDOWN ?? "http://127.0.0.1:8080" } },
});
