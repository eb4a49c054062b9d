// What two million points of walls cost on a page: node many_points.mjs PAGE [POINTS]. The page of any run is taken, and
// a tube of points laid around its way. Figures, not a bar: time to the first view, and pictures a second while the
// view in space is turned; and the processor's time of page and drawing, which a busy machine does not change.
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { processorSeconds, run, show } from "./browser.mjs";

const kData = /(<script id="lodeline-data" type="application\/json">)(.*?)(<\/script>)/s;
const count = Number(process.argv[3] ?? 2_000_000);

function tube(states) {
  const along = ["p_x [m]", "p_y [m]", "p_z [m]"].map((name) => states.numbers[name].map((v) => v ?? 0));
  const low = along.map((values) => Math.min(...values) - 2.5);
  const step = along.map((values, k) => (Math.max(...values) + 2.5 - low[k]) / 65535);
  const steps = new Uint16Array(3 * count), rgb = new Uint8Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const pose = Math.floor((i / count) * along[0].length), angle = i * 2.399963;
    const off = [1.8 * Math.cos(angle), 1.8 * Math.sin(angle), 1.2 * Math.sin(angle)];
    for (let k = 0; k < 3; ++k) {
      steps[3 * i + k] = Math.round((along[k][pose] + off[k] + 0.2 * Math.sin(0.37 * i * (k + 1)) - low[k]) / step[k]);
      rgb[3 * i + k] = 128 + 90 * Math.sin(angle + k);
    }
  }
  const encoded = (array) => Buffer.from(array.buffer).toString("base64");
  return { total: count, low_m: low, step_m: step, xyz: encoded(steps), rgb: encoded(rgb) };
}

const page = readFileSync(process.argv[2], "utf8");
const data = JSON.parse(kData.exec(page)[2]);
data.runs[0].walls = tube(data.runs[0].states);
const folder = mkdtempSync(join(tmpdir(), "lodeline-points-"));
process.argv[2] = join(folder, "page.html");
writeFileSync(process.argv[2], page.replace(kData, (_, before, __, after) => before + JSON.stringify(data) + after));

await run(async ({ browser, page }) => {
  // A picture begins with the clearing of its colours.
  await page.evaluateOnNewDocument(() => {
    window.pictures = 0;
    const clear = WebGL2RenderingContext.prototype.clear;
    WebGL2RenderingContext.prototype.clear = function (mask) {
      if (mask & this.COLOR_BUFFER_BIT) ++window.pictures;
      clear.call(this, mask);
    };
  });
  const worked = () => {
    const { renderer, "gpu-process": drawing } = processorSeconds(browser);
    return renderer + drawing;
  };
  const box = await (async () => {
    const began = performance.now(), before = worked();
    await page.reload();
    await page.waitForSelector("html[data-ready]");
    await show(page, ".space canvas");
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))));
    const canvas = await page.$(".space canvas");
    console.log(`first view after ${((performance.now() - began) / 1e3).toFixed(2)} s, ${(worked() - before).toFixed(2)} s of work`);
    return canvas.boundingBox();
  })();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  const turnFor = async (milliseconds) => {
    const before = await page.evaluate(() => window.pictures), began = performance.now(), busy = worked();
    for (let i = 0; performance.now() - began < milliseconds; ++i) await page.mouse.move(x + 150 * Math.sin(i / 20), y + 20 * Math.sin(i / 9));
    const pictures = (await page.evaluate(() => window.pictures)) - before;
    return `${((1e3 * pictures) / (performance.now() - began)).toFixed(1)} pictures a second (${((worked() - busy) / pictures).toFixed(3)} s of work each)`;
  };
  const first = await turnFor(2000), then = await turnFor(5000);
  await page.mouse.up();
  console.log(`turned at ${first} at first, then at ${then}`);
});
rmSync(folder, { recursive: true });
