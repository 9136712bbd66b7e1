// Settings of the display: units, colours, shading, edges, the upward axis.

import type { Bench } from "./bench.ts";
import { RAMP_NAMES } from "./colours.ts";
import { button, byId, store } from "./dom.ts";
import type { Scene } from "./scene.ts";
import { check, choice, range, Settings } from "./settings.ts";
import { SHADINGS, type Shading } from "./skin.ts";
import { isDark } from "./panel.ts";
import { UNITS, type Units } from "./units.ts";

const pairs = (values: readonly string[]): [string, string][] =>
  values.map((value) => [value, value]);
const percent = (value: number): string => `${Math.round(100 * value)} %`;

/** The colour of the surface where it shows no values, by theme. */
const SKIN = { light: "#d9d6d0", dark: "#b3b8bb" };

/** Returns the storage key of the unit that the user has chosen for a surface. */
const unitKey = (sha256: string): string => `unit:${sha256}`;

/** The part of the viewer that the display reads and calls. */
interface Viewer {
  readonly scene: Scene;
  readonly bench: Bench;
  readonly units: Units;
  undo: () => void;
  redo: () => void;
  reshow: () => void;
  showFacts: () => void;
  writeView: (isEdit: boolean) => void;
}

export class Display {
  private readonly settings = new Settings({
    unit: choice("Unit of the file", "units", pairs(UNITS)),
    shown: choice("Lengths are shown in", "units", [
      ["units", "the unit of the file"],
      ...pairs(UNITS.slice(1)),
    ]),
    ramp: choice("Colour map", RAMP_NAMES[0]!, pairs(RAMP_NAMES)),
    reverse: check("Reverse the colour map", false),
    low: range("Colours begin at", 0, 0, 1, 0.01, percent),
    high: range("Colours end at", 1, 0, 1, 0.01, percent),
    shading: choice("Shading", "creases", Object.entries(SHADINGS)),
    edges: check("Edges of the mesh", false),
    shadow: check("Ground shadow", true),
  });

  constructor(private readonly app: Viewer) {
    const { scene } = app;
    this.settings.onChange = (live) => this.change(live);
    byId("display").append(...this.settings.elements());
    byId("toolbar").append(
      button("Fit", () => this.fit(), {
        title: "Fit the whole surface (F)",
        "aria-keyshortcuts": "f",
      }),
      button("+", () => scene.zoom(1.25), { "aria-label": "Zoom in", title: "Zoom in (+)" }),
      button("−", () => scene.zoom(0.8), { "aria-label": "Zoom out", title: "Zoom out (−)" }),
      button("Up", () => this.turnUp(), { title: "Let y or z point up" }),
      button("↶", () => app.undo(), { "aria-label": "Undo", title: "Undo (Ctrl+Z)" }),
      button("↷", () => app.redo(), { "aria-label": "Redo", title: "Redo (Ctrl+Shift+Z)" }),
    );
  }

  fit(): void {
    this.app.scene.fit();
    this.app.writeView(false);
  }

  private turnUp(): void {
    const { scene } = this.app;
    scene.up = scene.up === "y" ? "z" : "y";
    this.fit();
  }

  toggleEdges(): void {
    this.settings.set("edges", !this.settings.on("edges"));
    this.apply();
    this.app.writeView(true);
  }

  private change(live: boolean): void {
    const { surface } = this.app.bench;
    if (surface)
      store.set(unitKey(surface.description.sha256), this.settings.text("unit"));
    this.apply();
    this.app.bench.legend.recolour(this.app.bench.colours);
    if (!live) this.app.reshow();
    this.app.writeView(!live);
  }

  /** Returns the settings for the address. */
  read(): Record<string, string> {
    return this.settings.read();
  }

  /**
   * Restores the settings of an address. Without an address, restores the unit that the user has
   * chosen for the surface.
   */
  restore(parameters: URLSearchParams | undefined): void {
    const { surface } = this.app.bench;
    if (parameters) this.settings.restore(parameters);
    const unit = surface && store.get(unitKey(surface.description.sha256));
    if (!parameters?.has("unit"))
      this.settings.set("unit", unit && UNITS.includes(unit) ? unit : "units");
    this.apply();
  }

  /** Applies settings and theme to the picture. */
  apply(): void {
    const { app, settings } = this;
    app.units.file = settings.text("unit");
    app.units.shown = settings.text("shown");
    const ramp = { name: settings.text("ramp"), isReversed: settings.on("reverse") };
    const [low, high] = [settings.number("low"), settings.number("high")];
    app.bench.colours = { ramp, low: Math.min(low, high - 0.01), high };
    const { skin } = app.scene;
    skin?.setColour(isDark() ? SKIN.dark : SKIN.light);
    skin?.setColours(app.bench.colours);
    skin?.setShading(settings.text("shading") as Shading);
    app.scene.showEdges(settings.on("edges"));
    app.scene.showShadow(settings.on("shadow"));
    app.showFacts();
    app.scene.setGround(getComputedStyle(document.body).backgroundColor);
  }
}
