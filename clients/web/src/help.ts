// The keys of the page, and the dialog that lists them.

import type { App } from "./app.ts";
import { button, byId, make } from "./dom.ts";
import type { Kept } from "./kept.ts";

const KEYS: [string, string][] = [
  ["1 to 9", "choose a question"],
  ["A", "set a point in the middle of the picture"],
  ["Shift+click", "add a point on the way of a path"],
  ["Tab", "go from point to point; arrow keys move a point, with Shift farther; Delete removes it"],
  ["Arrow keys", "turn the surface, when the picture has the focus; with Shift: shift it; + and −: zoom"],
  ["F", "fit the surface into the picture"],
  ["E", "show or hide the edges of the mesh"],
  ["K", "keep the path"],
  ["C", "copy the request as curl"],
  ["L", "copy a link to this view"],
  ["Ctrl+Z", "undo; Ctrl+Shift+Z or Ctrl+Y: redo"],
  ["Esc", "cancel the running question, load or upload"],
  ["?", "this list"],
];

const HELP =
  "Click the surface to set points, drag them to move them. Drag the picture to turn it, with the right button or two " +
  "fingers to shift it. The wheel or a pinch zooms to the cursor. The address holds surface, points, question, unit, " +
  "colours, edges and camera: copy it to show this view to others. Kept paths stay in this window only.";

const isTyping = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement &&
  target.matches("input:not([type=radio], [type=checkbox], [type=range]), select, textarea");

export class Help {
  private readonly dialog = byId<HTMLDialogElement>("help");

  constructor(
    private readonly app: App,
    private readonly kept: Kept,
  ) {
    const rows = KEYS.flatMap(([key, what]) => [
      make("dt", {}, make("kbd", {}, key)),
      make("dd", {}, what),
    ]);
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
    if (event.altKey || isTyping(event.target) || this.dialog.open) return;
    const action =
      event.ctrlKey || event.metaKey ? this.historyOf(event) : this.actionOf(event.key);
    if (!action) return;
    action();
    event.preventDefault();
  }

  private historyOf({ key, shiftKey }: KeyboardEvent): (() => void) | undefined {
    const letter = key.toLowerCase();
    if (letter === "y" || (letter === "z" && shiftKey)) return () => this.app.redo();
    return letter === "z" ? () => this.app.undo() : undefined;
  }

  private actionOf(key: string): (() => void) | undefined {
    const { app } = this;
    const mode = /^[1-9]$/.test(key) ? app.modes[Number(key) - 1] : undefined;
    if (mode) return () => void app.choose(mode);
    const actions: Record<string, () => void> = {
      a: () => app.addAt({ x: app.scene.size.x / 2, y: app.scene.size.y / 2 }),
      f: () => app.display.fit(),
      e: () => app.display.toggleEdges(),
      k: () => this.kept.keep(),
      l: () => this.kept.copyLink(),
      c: () => app.answer.copy(),
      Escape: () => app.cancel(),
      "?": () => this.open(),
    };
    return actions[key.length === 1 ? key.toLowerCase() : key];
  }
}
