// A compass card with the present heading and a wedge of its uncertainty.

import { bearing, rotate, type Quat, type Vec3 } from "../base/geometry";
import { readPageData } from "../model/data";
import { element } from "../base/dom";
import { number } from "../base/format";

const kSvg = "http://www.w3.org/2000/svg";
const kDegrees = 180 / Math.PI;
const kRadius = 46;

function shape(tag: string, attributes: Record<string, string>, text = ""): SVGElement {
  const node = document.createElementNS(kSvg, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.textContent = text;
  return node;
}

function at(degrees: number, radius: number): string {
  return `${(radius * Math.sin(degrees / kDegrees)).toFixed(2)} ${(-radius * Math.cos(degrees / kDegrees)).toFixed(2)}`;
}

/// Never thinner than what an eye can see.
function wedge(heading: number, sigma: number): string {
  const half = Math.min(175, Math.max(1, sigma));
  return `M 0 0 L ${at(heading - half, kRadius)} A ${kRadius} ${kRadius} 0 ${half > 90 ? 1 : 0} 1 ${at(heading + half, kRadius)} Z`;
}

export function headingDial(): {
  node: HTMLElement;
  show: (state: { numbers?: Record<string, number | null>; run: { heading_reference: string } }) => void;
} {
  const axis = (readPageData().camera_axis_B ?? [1, 0, 0]) as Vec3;
  const svg = shape("svg", { viewBox: "-60 -60 120 120", role: "img", "aria-label": "Heading" });
  const spread = shape("path", { class: "spread", d: "" });
  const needle = shape("path", { class: "needle", d: "" });
  svg.append(shape("circle", { r: String(kRadius), class: "card-edge" }));
  for (let d = 0; d < 360; d += 10) {
    const inner = kRadius - (d % 30 === 0 ? 6 : 3);
    svg.append(shape("path", { class: "mark-line", d: `M ${at(d, inner)} L ${at(d, kRadius)}` }));
  }
  svg.append(spread, needle);
  const north = shape("text", { x: "0", y: "-50", class: "north" }, "0");
  svg.append(north);
  const text = element("strong", "", "–");
  const note = element("span", "note");
  const node = element("div", "dial");
  node.append(svg, element("div", "dial-text", text, note));
  return {
    node,
    show: ({ numbers, run }) => {
      const q = ["q_w", "q_x", "q_y", "q_z"].map((name) => numbers?.[name] ?? null);
      const heading = q.some((v) => v === null) ? null : bearing(rotate(q as Quat, axis));
      north.textContent = run.heading_reference.includes("north") ? "N" : "0";
      note.textContent = `from ${run.heading_reference}`;
      if (heading === null) return;
      const sigma = (numbers?.["sigma_heading [rad]"] ?? 0) * kDegrees;
      spread.setAttribute("d", wedge(heading, sigma));
      needle.setAttribute("d", `M 0 0 L ${at(heading, kRadius - 2)}`);
      text.textContent = `${heading.toFixed(1)}° ± ${number(sigma, 2)}°`;
    },
  };
}
