// Survey, solutions, measuring and playing at three sizes, light and dark; drawings as lines.
import assert from "node:assert/strict";
import { inked, run, show } from "./browser.mjs";

const kSizes = [{ width: 1280, height: 900 }, { width: 820, height: 1100 }, { width: 390, height: 800, isMobile: true }];

const text = (page, selector) => page.$eval(selector, (node) => node.textContent);
const plan = (page) => page.$eval(".map-plan canvas", (canvas) => canvas.toDataURL());

/// What an action changes on the plan.
async function changesPlan(page, what, action) {
  const before = await plan(page);
  await action();
  await page.waitForFunction((old) => document.querySelector(".map-plan canvas").toDataURL() !== old, { timeout: 20_000 }, before)
    .catch(() => assert.fail(`${what} changes nothing on the plan`));
}

const press = (page, label, value) => page.$eval(`.choice[aria-label="${label}"] [data-value="${value}"]`, (node) => node.click());
const selectPose = (page, index) => page.$eval(".pose input", (slider, value) => {
  slider.value = value;
  slider.dispatchEvent(new Event("input"));
}, String(index));

async function looksRight(page, name) {
  await press(page, "Points", "image"); // a phone's screen loads the page again
  for (const selector of [".map-plan canvas", ".map-side canvas", ".sections-card canvas"]) {
    await show(page, selector);
    await page.waitForFunction((s) => document.querySelector(s).width > 200, {}, selector);
    let share = 0; // of the canvas; it is drawn with the next frames
    for (let tries = 0; tries < 100 && share <= 0.003; ++tries) {
      share = await page.$eval(selector, inked);
      if (share <= 0.003) await new Promise((resolve) => setTimeout(resolve, 100));
    }
    assert.ok(share > 0.003, `${selector} is blank: ${name}`);
  }
  const [content, window] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(content <= window, `the page is ${content} px wide on a screen of ${window}: ${name}`);
  await page.waitForFunction(() => {
    const canvas = document.querySelector(".map-plan canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let red = 0;
    for (let i = 0; i < data.length; i += 4) red += Math.abs(data[i] - 200) < 9 && Math.abs(data[i + 1] - 32) < 9 && Math.abs(data[i + 2] - 32) < 9 ? 1 : 0;
    return red > 60;
  }, { timeout: 20_000 }).catch(() => assert.fail(`the walls have not the colours of their file: ${name}`));
}

await run(async ({ page }) => {
  for (const viewport of kSizes) {
    for (const value of ["light", "dark"]) {
      await page.setViewport(viewport);
      await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value }]);
      await looksRight(page, `${viewport.width} px, ${value}`);
    }
  }
  await page.setViewport(kSizes[0]);
  await press(page, "Points", "image");
  await show(page, ".map-plan canvas");

  // The test's map is half a metre east of the odometry.
  assert.match(await text(page, ".from"), /refined trajectory/);
  const refined = await text(page, ".pose .figures");
  await changesPlan(page, "another solution", () => press(page, "Trajectory", "map"));
  assert.match(await text(page, ".from"), /in the map/);
  assert.match(refined, /Position2\.00, 0\.00/);
  assert.match(await text(page, ".pose .figures"), /Position2\.50, 0\.00/);
  await press(page, "Trajectory", "run");
  assert.match(await text(page, ".from"), /causal/);

  await changesPlan(page, "an ellipse", () => page.select(".ellipses select", "30"));
  for (const value of ["height", "distance", "uncertainty"]) await changesPlan(page, value, () => press(page, "Points", value));
  for (const name of ["Walls", "Stations", "Background"]) {
    await changesPlan(page, name, () => page.$$eval(".toggle", (labels, wanted) =>
      labels.find((label) => label.textContent === wanted).querySelector("input").click(), name));
  }
  await changesPlan(page, "a nearer look", () => page.click('.map-plan button[title="Nearer"]'));
  await press(page, "Elevation", "extended");
  await page.waitForFunction(() => document.querySelector(".map-side h3").textContent === "Extended elevation");

  // The way is a circle of 2 m and 0.2 rad/s that widens by 0.05 m/s and sinks as fast: after 5 s it is at
  // 2.25 m, 1 rad.
  await selectPose(page, 0);
  await page.click(".measure button");
  await selectPose(page, 75);
  const expected = [2.25 * Math.cos(1) - 2, 2.25 * Math.sin(1), -0.25];
  const flat = Math.hypot(expected[0], expected[1]);
  const measured = await text(page, ".measure .figures");
  assert.ok(measured.includes(`Distance${Math.hypot(flat, expected[2]).toFixed(2)} m`), measured);
  assert.ok(measured.includes(`${((Math.atan2(expected[0], expected[1]) * 180) / Math.PI + 360).toFixed(1)}°`), measured);
  assert.ok(measured.includes(`Slope−${((Math.atan2(0.25, flat) * 180) / Math.PI).toFixed(1)}°`), measured);

  // Slowly, so that a busy machine does not come to the end.
  await page.select(".playback select", "0.5");
  await page.click(".playback button");
  await page.waitForFunction(() => Number(document.querySelector(".pose input").value) > 76);
  await page.click(".playback button");
  const stopped = await text(page, ".pose .time");
  await new Promise((resolve) => setTimeout(resolve, 300));
  assert.equal(await text(page, ".pose .time"), stopped, "it goes on after a pause");

  // For paper: lines that are lines, and no canvas where a drawing is.
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  const drawn = await page.$$eval(".card.plot:not([hidden])", (cards) => cards.map((card) => ({
    id: card.id, curves: [...card.querySelectorAll("svg.printed g[clip-path] *")].length,
  })));
  assert.ok(drawn.length > 8);
  for (const { id, curves } of drawn) assert.ok(curves > 0, `${id} has no curves as lines`);
  assert.ok((await page.$$eval(".map-plan svg.printed path", (paths) => paths.length)) > 20);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.equal((await page.$$(".printed")).length, 0);
});
