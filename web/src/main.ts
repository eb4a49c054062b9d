import { setPrinting } from "./base/colours";
import { kDrawAll } from "./base/dom";
import { readPageData } from "./model/data";
import { startLive } from "./live";
import { assemble } from "./page";
import { makeTracks } from "./model/track";
import { View } from "./model/view";

// Paper is light; this has to come before all that draws for it.
window.addEventListener("beforeprint", () => setPrinting(true));

const page = document.getElementById("page");
if (page) {
  const data = readPageData();
  if (data.live) startLive(page, data);
  else assemble(page, new View(data.runs.map(makeTracks), data.background ?? null));
  window.addEventListener("afterprint", () => setPrinting(false));
  // For `lodeline report --pdf`: all is drawn before the browser prints.
  if (window.location.hash === "#print") window.dispatchEvent(new Event(kDrawAll));
  document.documentElement.dataset.ready = "true";
}
