import { readPageData } from "./data";
import { startLive } from "./live";
import { assemble } from "./page";
import { makeTrack } from "./track";
import { View } from "./view";

const page = document.getElementById("page");
if (page) {
  const data = readPageData();
  if (data.live) startLive(page, data);
  else assemble(page, new View(data.runs.map(makeTrack)));
  document.documentElement.dataset.ready = "true";
}
