// Printed without scrolling first, every plot is drawn; on a phone the errors can be read.
import assert from "node:assert/strict";
import { inked, run, show } from "./browser.mjs";

await run(async ({ page }) => {
  await page.pdf({ format: "A4" });
  const cards = await page.$$(".card.plot:not([hidden])");
  assert.ok(cards.length > 8);
  for (const card of cards) {
    const id = await card.evaluate((node) => node.id);
    const canvas = await card.$("canvas");
    assert.ok(canvas, `${id} has no drawing`);
    assert.ok((await canvas.evaluate(inked)) > 0.003, `${id} is blank`);
  }
  await page.emulateMediaType("print");
  for (const selector of [".tools", ".toolbar .group", ".pose input[type=range]"]) {
    assert.equal(await page.$eval(selector, (node) => getComputedStyle(node).display), "none", `${selector} is printed`);
  }
  await page.emulateMediaType("screen");

  await page.setViewport({ width: 390, height: 800, isMobile: true });
  await show(page, "#evaluation table");
  for (const row of await page.$$("#evaluation tbody tr")) {
    const cell = await row.$("td:nth-child(2)");
    const right = await cell.evaluate((node) => node.getBoundingClientRect().right);
    const width = await cell.evaluate((node) => node.closest(".scroll").getBoundingClientRect().right);
    assert.ok(right <= width, `RMSE of "${await row.evaluate((node) => node.textContent)}" is cut off`);
  }
});
