// Repairs the accessibility of Swagger UI: names fields, makes scrolling texts reachable by
// keyboard, and removes links inside buttons.

const NAMES: [selector: string, name: string][] = [
  ["#servers", "Server"],
  ["textarea.body-param__text", "Request body"],
  [".body-param-content-type select, .content-type", "Media type"],
  [".examples-select-element", "Example"],
  [".parameters select", "Value"],
  ["input[type=file]", "File to send"],
];

function nameFields(root: ParentNode): void {
  for (const [selector, name] of NAMES) {
    for (const field of root.querySelectorAll(`:is(${selector}):not([aria-label])`)) field.setAttribute("aria-label", nameOf(field) ?? name);
  }
}

/** Returns the name of the parameter that a field belongs to, if it belongs to one. */
function nameOf(field: Element): string | undefined {
  return field.closest("tr[data-param-name]")?.getAttribute("data-param-name") ?? undefined;
}

function mend(root: ParentNode): void {
  nameFields(root);
  for (const text of root.querySelectorAll("pre:not([tabindex])")) text.setAttribute("tabindex", "0");
  // The button around the link has the same effect.
  for (const link of root.querySelectorAll("button a[href]")) link.removeAttribute("href");
}

/** Repairs the content of the element, now and after each change. */
export function keepMended(element: HTMLElement): void {
  mend(element);
  new MutationObserver(() => mend(element)).observe(element, { childList: true, subtree: true, attributes: true, attributeFilter: ["href"] });
}
