// The list of paths that the user keeps, with names, colours and lengths. The list exists until the
// page closes.

import type { App } from "./app.ts";
import { hexOf, memberColour } from "./colours.ts";
import { button, byId, copying, make } from "./dom.ts";
import { save } from "./files.ts";
import type { Line } from "./modes/mode.ts";

interface KeptPath extends Line {
  id: number;
  name: string;
  colour: string;
}

const WIDTH = 3;

/** Returns a text as a quoted field of a CSV row. */
const quoted = (text: string): string => `"${text.replaceAll('"', '""')}"`;

export class Kept {
  /** The list of each surface, by the surface's path. */
  private readonly lists = new Map<string, KeptPath[]>();
  private readonly body = make("ul");
  private readonly csv = button("Download CSV", () => this.saveCsv());
  private readonly keepButton = button("Keep path", () => this.keep(), {
    "aria-keyshortcuts": "k",
  });
  private readonly linkButton = copying("Copy link", () => this.app.link(), {
    "aria-keyshortcuts": "l",
    title: "A link to this view (L)",
  });
  private count = 0;
  private shownFor = "";

  constructor(private readonly app: App) {
    byId("kept").append(this.body, make("div", { class: "row" }, this.csv));
    byId("actions").append(
      this.linkButton,
      this.keepButton,
    );
    app.watchers.push(() => this.watch());
    this.show();
  }

  copyLink(): void {
    this.linkButton.click();
  }

  private get paths(): KeptPath[] {
    return this.lists.get(this.app.bench.surface?.path ?? "") ?? [];
  }

  keep(): void {
    const { surface } = this.app.bench;
    const line = this.app.mode.path;
    if (!surface || !line) return;
    const id = ++this.count;
    const path = { ...line, id, name: `Path ${id}`, colour: hexOf(memberColour(id, 0.62)) };
    this.lists.set(surface.path, [...this.paths, path]);
    byId<HTMLDetailsElement>("kept").open = true;
    this.show();
  }

  /** Shows the list of the open surface, with lengths in the current unit. */
  private watch(): void {
    this.keepButton.hidden = !this.app.mode.path;
    const key = `${this.app.bench.surface?.path} ${this.app.units.name}`;
    if (key === this.shownFor || this.body.contains(document.activeElement)) return;
    this.shownFor = key;
    this.show();
  }

  private show(): void {
    const { paths } = this;
    byId("kept").hidden = paths.length === 0;
    this.body.replaceChildren(...paths.map((path) => this.row(path)));
    this.draw();
  }

  private draw(): void {
    const { scene } = this.app;
    scene.keptLines.clear();
    for (const { id, colour, points } of this.paths)
      scene.keptLines.set(String(id), [scene.toView(points)], { colour, width: WIDTH });
    scene.draw();
  }

  private row(path: KeptPath): HTMLElement {
    const colour = make("input", {
      type: "color",
      value: path.colour,
      "aria-label": `Colour of ${path.name}`,
    });
    colour.addEventListener("input", () => {
      path.colour = colour.value;
      this.draw();
    });
    const name = make("input", {
      type: "text",
      value: path.name,
      "aria-label": "Name of the path",
    });
    name.addEventListener("input", () => (path.name = name.value));
    const length = make(
      "span",
      { class: "length", title: String(path.length) },
      this.app.units.length(path.length),
    );
    const remove = button("×", () => this.remove(path), {
      "aria-label": `Delete ${path.name}`,
      title: "Delete",
    });
    return make("li", { class: "kept" }, colour, name, length, remove);
  }

  private remove(path: KeptPath): void {
    const left = this.paths.filter((one) => one !== path);
    this.lists.set(this.app.bench.surface!.path, left);
    this.show();
  }

  private saveCsv(): void {
    const { bench, units } = this.app;
    const rows = this.paths.map(({ name, length, points }) => {
      const ends = [points[0]!, points.at(-1)!].flat();
      return [quoted(name), length, units.file, ...ends].join(",");
    });
    const head = "name,length,unit,from_x,from_y,from_z,to_x,to_y,to_z";
    save(new Blob([`${[head, ...rows].join("\n")}\n`]), `${bench.surface!.name}-paths.csv`);
  }
}
