// Elements made in one expression. Text is set as text, so nothing that the daemon answers can become markup.

type Content = Node | string;
type Attributes = Record<string, string | number | boolean | ((event: never) => void)>;

function apply(node: HTMLElement, name: string, value: Attributes[string]): void {
  if (typeof value === "function") node.addEventListener(name, value as EventListener);
  else if (value === true) node.setAttribute(name, "");
  else if (value !== false) node.setAttribute(name, String(value));
}

/** An element with attributes (functions are listeners) and contents. */
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

export function button(label: string, onClick: () => void, attributes: Attributes = {}): HTMLButtonElement {
  return make("button", { type: "button", click: onClick, ...attributes }, label);
}

/** The element of the page with this id, which index.html promises. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const node = document.getElementById(id);
  if (!node) throw new Error(`The page has no element #${id}.`);
  return node as T;
}

let ids = 0;

/** A new id, for a label and what it labels. */
export const freshId = (): string => `c${++ids}`;
