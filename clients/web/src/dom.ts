// Creates elements in one expression. Content is set as text, so answers never become markup.

/** Whether the page shows the picture alone, in a frame of another page. */
export const isEmbedded = new URLSearchParams(globalThis.location?.search).has("embed");

type Content = Node | string;
type Attributes = Record<string, string | number | boolean | ((event: never) => void)>;

function apply(node: HTMLElement, name: string, value: Attributes[string]): void {
  if (typeof value === "function") node.addEventListener(name, value as EventListener);
  else if (value === true) node.setAttribute(name, "");
  else if (value !== false) node.setAttribute(name, String(value));
}

/** Creates an element with attributes (functions become event listeners) and contents. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...contents: Content[]
): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) apply(node, name, value);
  node.append(...contents);
  return node;
}

export function button(
  label: string,
  onClick: () => void,
  attributes: Attributes = {},
): HTMLButtonElement {
  return make("button", { type: "button", click: onClick, ...attributes }, label);
}

/** A page loaded over plain HTTP from another machine has no `navigator.clipboard`. */
async function copy(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = make("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

/** Returns a button that copies a text and says so. */
export function copying(
  label: string,
  text: () => string,
  attributes: Attributes = {},
): HTMLButtonElement {
  const node = button(
    label,
    async () => {
      await copy(text());
      node.textContent = "Copied";
      setTimeout(() => (node.textContent = label), 2000);
    },
    attributes,
  );
  return node;
}

/** Returns the element with this id; throws if index.html does not have it. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const node = document.getElementById(id);
  if (!node) throw new Error(`The page has no element #${id}.`);
  return node as T;
}

let ids = 0;

/** Returns a new id, to connect a label with its control. */
export const freshId = (): string => `c${++ids}`;

/**
 * Values that survive a reload of the page. Browsers block storage in some frames; the page then
 * works without it.
 */
export const store = {
  get: (name: string): string | null => {
    try {
      return localStorage.getItem(name);
    } catch {
      return null;
    }
  },
  set: (name: string, value: string): void => {
    try {
      localStorage.setItem(name, value);
    } catch {
      /* blocked or full */
    }
  },
};
