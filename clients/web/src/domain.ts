// Draws the domain of a NURBS surface with the ends of the path and the path's control polygon.

import type { Nurbs, Place } from "../../js/types.d.ts";

type Axis = Nurbs["domain"]["u"];

const SPACE = "http://www.w3.org/2000/svg";
const SIZE = 200;
const MARGIN = 12;

function element(tag: string, attributes: Record<string, string | number>): SVGElement {
  const node = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}

/** Returns the shifts at which lines repeat along an axis, in multiples of the domain's length. */
const repeats = ({ closed }: Axis): number[] => (closed ? [-1, 0, 1] : [0]);

/**
 * Draws lines of the domain. `style` is a class of the style sheet. Lines may leave the domain of a
 * periodic surface; they enter it again on the other side.
 */
export function domainDrawing(
  { domain: { u, v } }: Nurbs,
  lines: { points: Place[]; style: string }[],
): SVGSVGElement {
  const part = ({ range: [low, high] }: Axis, at: number): number => (at - low) / (high - low);
  const x = (at: number): number => part(u, at) * SIZE;
  const y = (at: number): number => (1 - part(v, at)) * SIZE;
  const svg = element("svg", {
    viewBox: `${-MARGIN} ${-MARGIN} ${SIZE + 2 * MARGIN} ${SIZE + 2 * MARGIN}`,
    class: "domain",
    role: "img",
    "aria-label": "The domain, u to the right, v upwards",
  }) as SVGSVGElement;
  /* an inner svg hides lines outside its box */
  const inside = element("svg", { width: SIZE, height: SIZE });
  for (const { points, style } of lines) {
    const text = points.map(([a, b]) => `${x(a).toFixed(1)},${y(b).toFixed(1)}`).join(" ");
    for (const i of repeats(u))
      for (const k of repeats(v)) {
        const transform = `translate(${i * SIZE} ${-k * SIZE})`;
        inside.append(element("polyline", { points: text, class: style, transform }));
      }
  }
  svg.append(element("rect", { width: SIZE, height: SIZE, class: "border" }), inside);
  return svg;
}
