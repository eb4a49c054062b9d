// What it takes to open the page of a long dive. A figure for `make bench`, not a bar: a busy machine must not fail
// the test that the page opens. Counted is the processor's time, of the page's own thread and of each process that
// draws for it.
import assert from "node:assert/strict";
import { processorSeconds, run } from "./browser.mjs";

await run(async ({ browser, page, started_ms }) => {
  const wall_s = (performance.now() - started_ms) / 1e3;
  const client = await page.createCDPSession();
  await client.send("Performance.enable", { timeDomain: "threadTicks" });
  const before = processorSeconds(browser);
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  const after = processorSeconds(browser);
  const { metrics } = await client.send("Performance.getMetrics");
  const work_s = metrics.find(({ name }) => name === "TaskDuration").value;
  const renderer_s = after.renderer - before.renderer;
  const drawing_s = after["gpu-process"] - before["gpu-process"];
  console.log(`opened after ${wall_s.toFixed(2)} s with the browser's start; ${work_s.toFixed(2)} s of work by the page, ` +
    `${renderer_s.toFixed(2)} s by its process, ${drawing_s.toFixed(2)} s of drawing`);
  assert.ok(work_s > 0, "the page did no work");
});
