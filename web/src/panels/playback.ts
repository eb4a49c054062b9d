// Plays the dive: the selected pose goes on with time, and with it the picture and all views.

import { button, element } from "../base/dom";
import type { View } from "../model/view";

const kRates = [0.5, 1, 2, 5, 10, 30];

export function playback(view: View): HTMLElement {
  let isOn = false;
  let last_ms = 0;
  const rate = element("select");
  rate.setAttribute("aria-label", "Speed");
  for (const value of kRates) rate.append(new Option(`${value} ×`, String(value), value === 1, value === 1));
  const node = element("div", "playback");
  const play = button("▶ Play", "Play the dive from the selected pose", () => set(!isOn));
  const set = (on: boolean) => {
    isOn = on;
    play.textContent = on ? "❚❚ Pause" : "▶ Play";
    play.setAttribute("aria-pressed", String(on));
    if (!on) return;
    const { t_s } = view.active.value;
    if (view.time.value >= t_s[t_s.length - 1]) view.time.set(t_s[0]);
    last_ms = performance.now();
    requestAnimationFrame(step);
  };
  const step = (now_ms: number) => {
    if (!isOn) return;
    const { t_s } = view.active.value;
    const end = t_s[t_s.length - 1];
    const next = view.time.value + Number(rate.value) * Math.max(0, now_ms - last_ms) / 1e3;
    last_ms = now_ms;
    view.time.set(Math.min(next, end));
    if (next >= end) set(false);
    else requestAnimationFrame(step);
  };
  node.append(play, rate);
  return node;
}
