// Light and dark: what the system likes, until the user says otherwise.

import { button } from "./dom.ts";

const dark = matchMedia("(prefers-color-scheme: dark)");

const chosen = (): string | null => localStorage.getItem("theme");

export const isDark = (): boolean => (chosen() ?? (dark.matches ? "dark" : "light")) === "dark";

function apply(): void {
  document.documentElement.dataset.theme = isDark() ? "dark" : "light";
}

/** The switch; `onChange` is called now and whenever it changes. */
export function themeSwitch(onChange: () => void): HTMLButtonElement {
  const node = button("", () => {
    localStorage.setItem("theme", isDark() ? "light" : "dark");
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
