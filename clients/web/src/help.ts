// Keys, and the dialog that tells them.

import type { App } from "./app.ts";
import type { Display } from "./display.ts";
import { button, byId, make } from "./dom.ts";

const KEYS: [string, string][] = [
  ["1 to 9", "what to ask for"],
  ["A", "set a point in the middle of the picture"],
  ["Tab", "go from point to point; arrow keys move a point, with Shift farther; Delete removes it"],
  ["Arrow keys", "turn the surface, when the picture has the focus; + and − zoom"],
  ["F", "fit the surface into the picture"],
  ["E", "show the edges of the mesh"],
  ["C", "copy the request as curl"],
  ["Esc", "cancel what is under way"],
  ["?", "this list"],
];

const HELP =
  "Click the surface to set points, drag them to move them. Drag the picture to turn it, with the right button or two " +
  "fingers to shift it, and use the wheel or pinch to zoom. The address of the page tells all that is shown: copy it to " +
  "show it to others.";

const isTyping = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement &&
  target.matches("input:not([type=radio], [type=checkbox], [type=range]), select, textarea");

export class Help {
  private readonly dialog = byId<HTMLDialogElement>("help");

  constructor(
    private readonly app: App,
    private readonly display: Display,
  ) {
    const rows = KEYS.flatMap(([key, what]) => [make("dt", {}, make("kbd", {}, key)), make("dd", {}, what)]);
    this.dialog.append(
      make("h2", { id: "help-title" }, "How to use it"),
      make("p", {}, HELP),
      make("dl", {}, ...rows),
      button("Close", () => this.dialog.close()),
    );
    addEventListener("keydown", (event) => this.key(event));
  }

  open(): void {
    this.dialog.showModal();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || isTyping(event.target) || this.dialog.open) return;
    const action = this.actionOf(event.key);
    if (!action) return;
    action();
    event.preventDefault();
  }

  private actionOf(key: string): (() => void) | undefined {
    const { app } = this;
    const mode = /^[1-9]$/.test(key) ? app.modes[Number(key) - 1] : undefined;
    if (mode) return () => void app.choose(mode);
    const actions: Record<string, () => void> = {
      a: () => app.addAt({ x: app.scene.size.x / 2, y: app.scene.size.y / 2 }),
      f: () => app.scene.fit(),
      e: () => this.display.toggleEdges(),
      c: () => void app.answer.copy(),
      Escape: () => app.cancel(),
      "?": () => this.open(),
    };
    return actions[key.length === 1 ? key.toLowerCase() : key];
  }
}
