// Bundles scripts, styles and markup into one HTML file that needs nothing else: node build.mjs OUTPUT
import { readFile, writeFile } from "node:fs/promises";
import { build } from "esbuild";

const output = process.argv[2] ?? "report.html";
const from = (path) => new URL(path, import.meta.url).pathname;

async function bundle(entry, loader = {}) {
  const result = await build({
    entryPoints: [from(entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2020",
    charset: "ascii",
    legalComments: "inline",
    loader,
  });
  return result.outputFiles[0].text;
}

const script = (await bundle("src/main.ts")).replaceAll("</script", "<\\/script");
const style = await bundle("src/style.css");
const page = await readFile(from("src/page.html"), "utf8");
await writeFile(output, page.replace("/*STYLE*/", () => style).replace("/*SCRIPT*/", () => script));
