// The theme, light or dark: the system's theme until the user chooses one.

import { button } from "./dom.ts";

const dark = matchMedia("(prefers-color-scheme: dark)");

const chosen = (): string | null => localStorage.getItem("theme");

export const isDark = (): boolean => (chosen() ?? (dark.matches ? "dark" : "light")) === "dark";

function apply(): void {
  document.documentElement.dataset.theme = isDark() ? "dark" : "light";
}

/** Returns the switch. Calls `onChange` now and after each change of the theme. */
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
