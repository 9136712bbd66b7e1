// Creates elements in one expression. Content is set as text, so answers never become markup.

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

/** Returns the element with this id; throws if index.html does not have it. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const node = document.getElementById(id);
  if (!node) throw new Error(`The page has no element #${id}.`);
  return node as T;
}

let ids = 0;

/** Returns a new id, to connect a label with its control. */
export const freshId = (): string => `c${++ids}`;
