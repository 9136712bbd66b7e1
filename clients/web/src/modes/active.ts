// The control that chooses the group to which the next click adds a point.

import { make } from "../dom.ts";
import type { Points } from "../points.ts";

/** Returns a control that chooses among groups, given by their indices and labels. */
export function activeChoice(points: Points, groups: [number, string][]): HTMLElement {
  const rows = groups.map(([g, label]) => {
    const input = make("input", {
      type: "radio",
      name: "active",
      value: g,
      checked: g === points.active,
      change: () => (points.active = g),
    });
    return make("label", { class: "check" }, input, label);
  });
  return make("fieldset", {}, make("legend", { class: "unseen" }, "Clicks set"), ...rows);
}
