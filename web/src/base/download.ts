// Everything that is shown can be taken home.

import { themed } from "./colours";

export function save(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export function fileName(...parts: string[]): string {
  return parts.map((part) => part.replace(/[^\w.-]+/g, "_")).join("_");
}

export type CsvColumn = { name: string; values: (number | string | null)[] };

export function csvText(columns: CsvColumn[]): string {
  const rows = Math.max(0, ...columns.map((c) => c.values.length));
  const lines = [columns.map((c) => c.name).join(",")];
  for (let i = 0; i < rows; ++i) lines.push(columns.map((c) => c.values[i] ?? "").join(","));
  return lines.join("\n") + "\n";
}

export function saveCsv(name: string, columns: CsvColumn[]): void {
  save(`${name}.csv`, new Blob([csvText(columns)], { type: "text/csv" }));
}

/// A drawing on the page's background, with a line of text above it.
export function savePng(name: string, drawing: HTMLCanvasElement, title: string): void {
  const ratio = drawing.width / Math.max(1, drawing.clientWidth || drawing.width);
  const bar = Math.round(28 * ratio);
  const canvas = document.createElement("canvas");
  canvas.width = drawing.width;
  canvas.height = drawing.height + bar;
  const context = canvas.getContext("2d");
  if (!context) return;
  context.fillStyle = themed("surface");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = themed("ink");
  context.font = `600 ${Math.round(13 * ratio)}px system-ui, sans-serif`;
  context.textBaseline = "middle";
  context.fillText(title, Math.round(12 * ratio), bar / 2);
  context.drawImage(drawing, 0, bar);
  canvas.toBlob((blob) => blob && save(`${name}.png`, blob));
}
