// Small controls of the panel: the theme, the access key, the button that folds the panel.

import type { Api } from "./api.ts";
import { button, byId, make, store } from "./dom.ts";

/** Whether the system's theme is dark. The page has this theme until the user chooses a theme. */
const dark = matchMedia("(prefers-color-scheme: dark)");

const chosen = (): string | null => store.get("theme");

export const isDark = (): boolean => (chosen() ?? (dark.matches ? "dark" : "light")) === "dark";

function apply(): void {
  document.documentElement.dataset.theme = isDark() ? "dark" : "light";
}

/** Returns the switch. Calls `onChange` now and after each change of the theme. */
export function themeSwitch(onChange: () => void): HTMLButtonElement {
  const node = button("", () => {
    store.set("theme", isDark() ? "light" : "dark");
    show();
  });
  const show = (): void => {
    apply();
    node.textContent = isDark() ? "Light" : "Dark";
    onChange();
  };
  dark.addEventListener("change", show);
  show();
  return node;
}

/** Shows the access key, for a daemon with keys. */
export function buildAccess(api: Api, onChange: () => void): void {
  const input = make("input", {
    type: "password",
    id: "key",
    autocomplete: "off",
    pattern: "\\s*[!-~]*\\s*",
    title: "A key contains only ASCII letters, digits and punctuation, without spaces.",
    value: api.key,
  });
  const submit = (event: SubmitEvent): void => {
    event.preventDefault();
    api.key = input.value.trim();
    onChange();
  };
  const row = make("div", { class: "row" }, input, make("button", { type: "submit" }, "Use it"));
  const label = make(
    "label",
    { for: "key" },
    "Sent with each request; forgotten when this tab closes",
  );
  byId("access").append(make("form", { submit }, label, row));
}

/** Makes the button that folds the panel on phones. */
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
