// One run: everything is drawn, a click selects a pose and shows its picture, nothing complains.
import assert from "node:assert/strict";
import { inked, run, show } from "./browser.mjs";

const kPlots = ["status", "heading", "depth", "heading-sigma", "position-sigma", "yaw-error", "velocity",
  "gyroscope-bias", "accelerometer-bias", "tracks", "reprojection", "timings", "magnetometer-offset", "field"];

const text = (page, selector) => page.$eval(selector, (node) => node.textContent);

async function selectsOnClick(page, selector, [x, y]) {
  await show(page, selector);
  const before = await text(page, ".pose .time");
  const box = await (await page.$(selector)).boundingBox();
  await page.mouse.click(box.x + x * box.width, box.y + y * box.height);
  await page.waitForFunction((old) => document.querySelector(".pose .time").textContent !== old, {}, before);
}

await run(async ({ page }) => {
  assert.match(await text(page, "h1"), /dive/);
  assert.match(await text(page, ".tiles"), /Completion98\.0 %196 of 200 images; 4 frames by inertial readings alone/);
  assert.match(await text(page, ".findings"), /a name with <\/script> in it/);
  assert.match(await text(page, "#evaluation"), /0\.100 m/);
  assert.match(await text(page, "#configuration pre"), /keyframes: 7/);

  // The ledger by outcome, with moments that select a pose; residuals of the tags.
  assert.match(await text(page, "#map .ledger .note"), /5 pairs of images were compared and 2 accepted as loops\./);
  const ledger = await page.$$eval("#map .ledger tbody tr", (rows) => rows.map((row) => row.textContent));
  assert.equal(ledger.length, 3);
  assert.ok(ledger.some((row) => /accepted2–0:10\.0, 0:11\.0/.test(row)), ledger.join("; "));
  assert.ok(ledger.some((row) => /candidate2… matches, … needed0:06\.0, 0:07\.0/.test(row)), ledger.join("; "));
  assert.ok(ledger.some((row) => /refused1tag 7 hangs 3\.20 m away0:08\.0/.test(row)), ledger.join("; "));
  await page.click("#map .ledger .time-link");
  const control = await page.$$eval("#map .control tbody tr", (rows) => rows.map((row) => row.textContent));
  assert.match(control[0], /tag 7, oldtag13\.28120:08\.0blunder/);
  assert.match(control[1], /tag 3tag10\.0231\.30:03\.0used/);
  await page.waitForFunction(() => ["0:06.0", "0:10.0"].includes(document.querySelector(".pose .time").textContent));

  // Way in the map and loops can be taken away.
  const plan = await page.$("canvas.map");
  const whole = await plan.evaluate((canvas) => canvas.toDataURL());
  const pictures = [];
  for (const name of ["Other solutions", "Loops and control points"]) {
    await page.$$eval(".toggle", (labels, name) => labels.find((l) => l.textContent === name).querySelector("input").click(), name);
    await page.waitForFunction((old) => document.querySelector("canvas.map").toDataURL() !== old, {}, pictures[0] ?? whole);
    pictures.unshift(await plan.evaluate((canvas) => canvas.toDataURL()));
  }

  await page.$eval(".pose input", (slider) => { slider.value = "0"; slider.dispatchEvent(new Event("input")); });

  for (const plot of kPlots) {
    await show(page, `#plot-${plot}`);
    await page.waitForSelector(`#plot-${plot} canvas`);
    assert.ok((await page.$eval(`#plot-${plot} canvas`, inked)) > 0.003, `${plot} is blank`);
  }
  for (const map of await page.$$("canvas.map")) {
    await map.scrollIntoView();
    assert.ok((await map.evaluate(inked)) > 0.01, "a map is blank");
  }

  const first = await page.$eval(".picture img", (image) => image.src);
  await selectsOnClick(page, "#plot-heading .u-over", [0.9, 0.5]);
  assert.notEqual(await page.$eval(".picture img", (image) => image.src), first, "the picture is another one");
  assert.match(await text(page, ".pose .figures"), /Position.*Heading.*Depth.*Error/);

  // The start lies where the marker was drawn first; a click there goes back to it.
  await page.$eval(".pose input", (slider) => { slider.value = "150"; slider.dispatchEvent(new Event("input")); });
  assert.equal(await text(page, ".pose .time"), "0:10.0");

  for (const colour of ["heading", "depth", "error"]) await page.click(`.choice button[data-value=${colour}]`);
  assert.match(await text(page, ".colour-bar"), /0\.10+ m/);
  await page.click(".space-card .tools button:nth-child(2)");
});
