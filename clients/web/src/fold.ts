// The button that folds the panel on phones.

import { button, byId } from "./dom.ts";

export function buildFold(): void {
  const node = button("", () => toggle(!document.body.classList.contains("folded")), {
    id: "fold-button",
    "aria-controls": "panel",
  });
  const toggle = (isFolded: boolean): void => {
    document.body.classList.toggle("folded", isFolded);
    node.textContent = isFolded ? "▲" : "▼";
    node.setAttribute("aria-expanded", String(!isFolded));
    node.setAttribute("aria-label", isFolded ? "Show the controls" : "Hide the controls");
  };
  byId("panel").prepend(node);
  toggle(false);
}
