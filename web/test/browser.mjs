// A page in headless Chromium that remembers every complaint.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import puppeteer from "puppeteer-core";

async function open(file) {
  const started_ms = performance.now();
  const browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    // WebGL without a graphics card; the sandbox refuses to work for root, who runs CI.
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
    protocolTimeout: 300_000,
  });
  const page = await browser.newPage();
  page.setDefaultTimeout(120_000);
  const complaints = [];
  page.on("console", (message) => {
    if (["error", "warn"].includes(message.type())) complaints.push(message.text());
  });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("requestfailed", (request) => {
    // The page itself closes its stream of events at the end.
    if (request.failure()?.errorText !== "net::ERR_ABORTED") complaints.push(`${request.url()} failed`);
  });
  await page.setViewport({ width: 1280, height: 900 });
  await page.goto(file.startsWith("http") ? file : `file://${file}`);
  await page.waitForSelector("html[data-ready]");
  return { browser, page, started_ms, complaints: () => complaints.filter((text) => !isDriverTalk(text)) };
}

/// Chromium says that drawing without a graphics card is slow; that is not the page's fault.
function isDriverTalk(text) {
  return /GPU stall|swiftshader|GL Driver Message|Automatic fallback to software WebGL/i.test(text);
}

/// Brings an element into sight and waits until the plot in it is drawn.
export async function show(page, selector) {
  await page.waitForSelector(selector);
  await page.$eval(selector, (node) => node.scrollIntoView({ behavior: "instant", block: "center" }));
}

/// Processor time of the browser's processes so far, s, by their kind: "renderer", "gpu-process", ….
export function processorSeconds(browser) {
  const kTicksPerSecond = 100;
  const processes = readdirSync("/proc").filter((name) => /^\d+$/.test(name)).flatMap((id) => {
    try {
      const stat = readFileSync(`/proc/${id}/stat`, "utf8");
      const fields = stat.slice(stat.lastIndexOf(")") + 2).split(" ");
      const kind = /--type=([\w-]+)/.exec(readFileSync(`/proc/${id}/cmdline`, "utf8"))?.[1] ?? "browser";
      return [{ id, parent: fields[1], kind, seconds: (Number(fields[11]) + Number(fields[12])) / kTicksPerSecond }];
    } catch {
      return []; // gone meanwhile
    }
  });
  const sums = {};
  const add = (process) => {
    sums[process.kind] = (sums[process.kind] ?? 0) + process.seconds;
    processes.filter(({ parent }) => parent === process.id).forEach(add);
  };
  processes.filter(({ id }) => id === String(browser.process().pid)).forEach(add);
  return sums;
}

/// Share of a canvas that is not blank.
export const inked = (canvas) => {
  const copy = document.createElement("canvas");
  copy.width = canvas.width;
  copy.height = canvas.height;
  const context = copy.getContext("2d");
  context.drawImage(canvas, 0, 0);
  const { data } = context.getImageData(0, 0, copy.width, copy.height);
  let count = 0;
  for (let i = 3; i < data.length; i += 4) count += data[i] > 0 ? 1 : 0;
  return count / (data.length / 4);
};

/// Opens the page that the command line names, tries `test` on it, and tells by the exit code.
export async function run(test) {
  const opened = await open(process.argv[2]);
  try {
    await test(opened);
    assert.deepEqual(opened.complaints(), []);
  } catch (error) {
    console.error(error);
    process.exitCode = 1;
  } finally {
    await opened.browser.close();
  }
}
