// How things look: units, colours, edges, which way is up.

import type { App } from "./app.ts";
import { RAMP_NAMES } from "./colours.ts";
import { button, byId } from "./dom.ts";
import { check, choice, Settings } from "./settings.ts";
import { isDark } from "./theme.ts";
import { UNITS } from "./units.ts";

const pairs = (values: string[]): [string, string][] => values.map((value) => [value, value]);

export class Display {
  private readonly settings = new Settings({
    file: choice("The file's unit", "units", pairs(UNITS)),
    shown: choice("Lengths are shown in", "units", [["units", "the file's unit"], ...pairs(UNITS.slice(1))]),
    ramp: choice("Colours of values", "dusk", pairs(RAMP_NAMES)),
    flat: check("Flat faces", false),
    edges: check("Edges of the mesh", false),
  });

  constructor(private readonly app: App) {
    const { scene } = app;
    this.settings.onChange = () => this.apply(true);
    byId("display").append(...this.settings.elements());
    byId("toolbar").append(
      button("Fit", () => scene.fit(), { title: "The whole surface (F)", "aria-keyshortcuts": "f" }),
      button("+", () => scene.zoom(1.25), { "aria-label": "Zoom in", title: "Nearer (+)" }),
      button("−", () => scene.zoom(0.8), { "aria-label": "Zoom out", title: "Farther (−)" }),
      button("Up", () => this.turnUp(), { title: "Let y or z point up" }),
    );
  }

  private turnUp(): void {
    const { scene } = this.app;
    scene.up = scene.up === "y" ? "z" : "y";
    scene.fit();
    this.app.writeState();
  }

  toggleEdges(): void {
    this.settings.set("edges", !this.settings.on("edges"));
    this.apply(false);
  }

  /** Puts the settings and the theme on what is shown; `again`: answers are shown again, too. */
  apply(again: boolean): void {
    const { app, settings } = this;
    app.units.file = settings.text("file");
    app.units.shown = settings.text("shown");
    app.bench.display.ramp = settings.text("ramp");
    const { skin } = app.scene;
    skin?.setColour(isDark() ? "#a9b4bb" : "#d5dadd");
    skin?.setRamp(settings.text("ramp"));
    skin?.setFlat(settings.on("flat") || app.bench.surface?.fine != null); /* a coarse mesh looks as it is */
    app.scene.showEdges(settings.on("edges"));
    app.showFacts();
    app.scene.setGround(getComputedStyle(document.body).backgroundColor);
    if (again) app.changed(false);
  }
}
