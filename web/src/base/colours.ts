// Colours that people with any kind of colour vision can tell apart.

/// Okabe & Ito 2008, for things of different kinds.
export const kKinds = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
/// The way in the map, and loops.
export const kMapColour = "#d55e00";
export const kLoopColour = "#cc79a7";
/// x, y, z.
export const kAxes = ["#d55e00", "#009e73", "#0072b2"];

/// Viridis (van der Walt & Smith, matplotlib), every sixteenth, for values.
const kViridis = [
  "#440154", "#481a6c", "#472f7d", "#414487", "#39568c", "#31688e", "#2a788e", "#23888e", "#1f988b",
  "#22a884", "#35b779", "#54c568", "#7ad151", "#a5db36", "#d2e21b", "#fde725",
];

const dark = window.matchMedia("(prefers-color-scheme: dark)");

export function isDark(): boolean {
  return dark.matches && !isPrinting();
}

export function isPrinting(): boolean {
  return document.documentElement.classList.contains("printing");
}

/// The colours of paper, in any theme.
export function setPrinting(isOn: boolean): void {
  document.documentElement.classList.toggle("printing", isOn);
}

export function whenThemeChanges(action: () => void): void {
  dark.addEventListener("change", action);
}

/// A colour of the style sheet.
export function themed(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function channels(hex: string): [number, number, number] {
  const value = parseInt(hex.slice(1), 16);
  return [value >> 16, (value >> 8) & 255, value & 255];
}

/// Red, green and blue, 0 to 255, of a share between 0 and 1. The end that would vanish against the
/// background is left out.
export function sequential(share: number): [number, number, number] {
  const clamped = Math.min(1, Math.max(0, share));
  const place = (isDark() ? 0.22 + 0.78 * clamped : 0.93 * clamped) * (kViridis.length - 1);
  const low = Math.min(Math.floor(place), kViridis.length - 2);
  const a = channels(kViridis[low]);
  const b = channels(kViridis[low + 1]);
  return a.map((v, k) => v + (b[k] - v) * (place - low)) as [number, number, number];
}

export function css(rgb: [number, number, number]): string {
  return `rgb(${rgb.map((v) => Math.round(v)).join(",")})`;
}

/// For a bar from the lowest to the highest value.
export function gradient(): string {
  const stops = Array.from({ length: 12 }, (_, i) => css(sequential(i / 11)));
  return `linear-gradient(to right, ${stops.join(",")})`;
}
