// Numbers as people read them.

/// `digits` significant digits, without exponents where a reader can do without.
export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -4 || size > 6) return value.toExponential(digits - 1).replace("-", "−");
  return value.toFixed(Math.max(0, digits - 1 - size)).replace("-", "−");
}

/// Minutes and seconds, with hours where there are some.
export function clock(seconds: number, decimals = 0): string {
  const unit = 10 ** -decimals;
  const rounded = Math.round(seconds / unit) * unit;
  const h = Math.floor(rounded / 3600);
  const m = Math.floor((rounded % 3600) / 60);
  const s = (rounded % 60).toFixed(decimals).padStart(decimals > 0 ? 3 + decimals : 2, "0");
  return h > 0 ? `${h}:${String(m).padStart(2, "0")}:${s}` : `${m}:${s}`;
}

export function duration(seconds: number): string {
  if (seconds < 120) return `${number(seconds)} s`;
  return `${clock(seconds)} ${seconds < 3600 ? "min" : "h"}`;
}

/// The greatest of 1, 2, 5, 10, 20, … that is not above `size`.
export function niceStep(size: number): number {
  const power = 10 ** Math.floor(Math.log10(size));
  const factor = size / power;
  return power * (factor >= 5 ? 5 : factor >= 2 ? 2 : 1);
}

/// As people write the names that `--align` takes.
export function alignmentName(type: string): string {
  return { se3: "SE(3)", sim3: "Sim(3)" }[type] ?? type;
}
