// Which group of points takes the next click, where there are several.

import { make } from "../dom.ts";
import type { Points } from "../points.ts";

/** A choice with a label for each group, in their order. */
export function activeChoice(points: Points, labels: string[]): HTMLElement {
  const inputs = labels.map((_, g) =>
    make("input", {
      type: "radio",
      name: "active",
      value: g,
      checked: g === points.active,
      change: () => (points.active = g),
    }),
  );
  const rows = labels.map((label, g) => make("label", { class: "check" }, inputs[g]!, label));
  return make("fieldset", {}, make("legend", { class: "unseen" }, "What clicks set"), ...rows);
}
