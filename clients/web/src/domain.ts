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

/**
 * Returns the shifts along an axis that bring each part of a line into the domain, in multiples of
 * the domain's length. `parts` are coordinates of the line's points, from 0 to 1 within the domain.
 */
function shifts({ closed }: Axis, parts: number[]): number[] {
  if (!closed) return [0];
  const [least, most] = [Math.floor(Math.min(...parts)), Math.floor(Math.max(...parts))];
  return Array.from({ length: most - least + 1 }, (_, i) => -least - i);
}

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
    const columns = shifts(u, points.map(([a]) => part(u, a)));
    const rows = shifts(v, points.map(([, b]) => part(v, b)));
    for (const i of columns)
      for (const k of rows) {
        const transform = `translate(${i * SIZE} ${-k * SIZE})`;
        inside.append(element("polyline", { points: text, class: style, transform }));
      }
  }
  svg.append(element("rect", { width: SIZE, height: SIZE, class: "border" }), inside);
  return svg;
}
