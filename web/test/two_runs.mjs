// Several runs: figures side by side, and each can be looked at.
import assert from "node:assert/strict";
import { run } from "./browser.mjs";

await run(async ({ page }) => {
  const heads = await page.$$eval("#comparison th button", (nodes) => nodes.map((node) => node.textContent));
  assert.deepEqual(heads, ["first", "second"]);
  assert.equal(await page.$eval("h1", (node) => node.textContent), "first");
  await page.click("#comparison th:nth-child(3) button");
  assert.equal(await page.$eval("h1", (node) => node.textContent), "second");
  assert.match(await page.$eval("footer", (node) => node.textContent), /all 120 states/);
  assert.equal(await page.$eval(".run-select select", (node) => node.value), "1");
});
