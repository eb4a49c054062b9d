// A run that goes on: what the server tells is shown as it comes.
import assert from "node:assert/strict";
import { run } from "./browser.mjs";

await run(async ({ page }) => {
  const text = (selector) => page.$eval(selector, (node) => node.textContent);
  await page.waitForFunction(() => document.querySelector(".status-word").textContent === "inertial");
  assert.equal(await text("h1"), "dive");
  assert.match(await text(".now"), /frame 12.*1\.50 ×/);
  // The camera looks along the body's x axis, which points to the world's x axis, east.
  assert.match(await text(".dial"), /90\.0° ± 2\.0°from true north/);
  await page.waitForFunction(() => document.querySelector(".pose .time").textContent === "0:12.0");
  assert.match(await text(".pose .figures"), /Position12\.00, 0\.00, −0\.50 m/);
  // Odometry and map apart, after a loop.
  assert.match(await text(".now"), /By odometry12\.00, 0\.00, −0\.50 m/);
  assert.match(await text(".now"), /In the map12\.00, 3\.00, −0\.50 m/);
  assert.match(await text(".toggles"), /In the map/);
  assert.match(await page.$eval(".picture img", (image) => image.src), /^data:image\/jpeg;base64,AAAA/);
  // One with each of the states 0 to 12.
  assert.match(await text(".now"), /Map points shown13/);
  await page.waitForSelector(".ended");
  // A pose before north was found has turned with those after.
  await page.$eval(".pose input", (slider) => {
    slider.value = "2";
    slider.dispatchEvent(new Event("input"));
  });
  await page.waitForFunction(() => document.querySelector(".pose .time").textContent === "0:02.0");
  assert.match(await text(".pose .figures"), /Position2\.00, 0\.00, −0\.50 m/);
  assert.match(await text(".pose .figures"), /Heading90\.0/);
});
