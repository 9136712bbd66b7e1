// Draws the domain of a NURBS surface with the ends of the path and the path's control polygon.

import type { Nurbs, Place } from "../../js/types.d.ts";

const SPACE = "http://www.w3.org/2000/svg";
const SIZE = 200;
const MARGIN = 12;

function part(tag: string, attributes: Record<string, string | number>): SVGElement {
  const node = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, String(value));
  return node;
}

/** Draws lines of the domain. `style` is a class of the style sheet. */
export function domainDrawing(
  surface: Nurbs,
  lines: { points: Place[]; style: string }[],
): SVGSVGElement {
  const { u, v } = surface.domain;
  const x = ([at]: Place): number =>
    MARGIN + ((at - u.range[0]) / (u.range[1] - u.range[0])) * SIZE;
  const y = ([, at]: Place): number =>
    MARGIN + (1 - (at - v.range[0]) / (v.range[1] - v.range[0])) * SIZE;
  const whole = SIZE + 2 * MARGIN;
  const svg = part("svg", {
    viewBox: `0 0 ${whole} ${whole}`,
    class: "domain",
    role: "img",
    "aria-label": "The domain, u to the right, v upwards",
  }) as SVGSVGElement;
  svg.append(part("rect", { x: MARGIN, y: MARGIN, width: SIZE, height: SIZE, class: "border" }));
  for (const { points, style } of lines) {
    svg.append(
      part("polyline", {
        points: points.map((p) => `${x(p).toFixed(1)},${y(p).toFixed(1)}`).join(" "),
        class: style,
      }),
    );
  }
  return svg;
}
