// What Swagger UI leaves out for those who do not see the page or have no mouse: names of fields, keys for what scrolls, links within buttons.

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

/** A parameter's field is called as the parameter is. */
function nameOf(field: Element): string | undefined {
  return field.closest("tr[data-param-name]")?.getAttribute("data-param-name") ?? undefined;
}

function mend(root: ParentNode): void {
  nameFields(root);
  for (const text of root.querySelectorAll("pre:not([tabindex])")) text.setAttribute("tabindex", "0");
  for (const link of root.querySelectorAll("button a[href]")) link.removeAttribute("href"); /* the button does what the link would */
}

/** Mends what is in the element, and what comes into it. */
export function keepMended(element: HTMLElement): void {
  mend(element);
  new MutationObserver(() => mend(element)).observe(element, { childList: true, subtree: true, attributes: true, attributeFilter: ["href"] });
}
