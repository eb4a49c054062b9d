// Several runs: figures side by side, and each can be looked at.
import assert from "node:assert/strict";
import { inked, run, show } from "./browser.mjs";

await run(async ({ page }) => {
  const heads = await page.$$eval("#comparison th button", (nodes) => nodes.map((node) => node.textContent));
  assert.deepEqual(heads, ["first", "second"]);
  assert.equal(await page.$eval("h1", (node) => node.textContent), "first");
  for (const plot of ["heading", "heading-difference", "depth", "position-difference", "heading-sigma"]) {
    await show(page, `#plot-compare-${plot}`);
    await page.waitForSelector(`#plot-compare-${plot} canvas`);
    assert.ok((await page.$eval(`#plot-compare-${plot} canvas`, inked)) > 0.003, `${plot} is blank`);
  }
  assert.ok(await page.$eval("#plot-compare-position-error", (node) => node.hidden).catch(() => true), "there is no reference");
  await page.click("#comparison th:nth-child(3) button");
  assert.equal(await page.$eval("h1", (node) => node.textContent), "second");
  assert.match(await page.$eval("footer", (node) => node.textContent), /all 120 states/);
  assert.equal(await page.$eval(".run-select select", (node) => node.value), "1");
});
