// The control that chooses the mode.

import type { App } from "./app.ts";
import { byId, make } from "./dom.ts";

export class ModePicker {
  private shown = "";
  private readonly inputs: HTMLInputElement[];

  constructor(private readonly app: App) {
    this.inputs = app.modes.map((mode) =>
      make("input", {
        type: "radio",
        name: "mode",
        value: mode.id,
        change: () => void app.choose(mode),
      }),
    );
    const labels = app.modes.map((mode, i) =>
      make("label", { class: "chip" }, this.inputs[i]!, make("span", {}, mode.title)),
    );
    byId("modes").append(
      make(
        "fieldset",
        { class: "row" },
        make("legend", { class: "unseen" }, "What to ask for"),
        ...labels,
      ),
    );
    app.watchers.push(() => this.show());
  }

  private show(): void {
    const { id } = this.app.mode;
    for (const input of this.inputs) input.checked = input.value === id;
    if (id === this.shown) return;
    this.shown = id;
    this.inputs
      .find((input) => input.checked)
      ?.parentElement!.scrollIntoView({ block: "nearest", inline: "center" });
  }
}
