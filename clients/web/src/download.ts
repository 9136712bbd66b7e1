// Saves files to the user's disk. The page fetches files of the daemon, because a link could not
// send the access key.

import type { App } from "./app.ts";
import { button, byId, make } from "./dom.ts";
import { type FileOffer, save } from "./files.ts";

const SCALE = 2; /* pixels of the saved picture for each pixel of the screen, in each direction */

export class Downloads {
  private readonly node = byId<HTMLDetailsElement>("download");
  private readonly row = make("div", { class: "row" });
  private shown = "";

  constructor(private readonly app: App) {
    this.node.append(this.row);
    this.node.addEventListener("toggle", () => this.show());
    app.watchers.push(() => this.show());
  }

  private get offers(): FileOffer[] {
    const { scene, bench, points, mode } = this.app;
    const picture: FileOffer = { label: "PNG", ending: "png", make: () => scene.snapshot(SCALE) };
    return bench.last !== undefined && points.complete ? [...mode.files(), picture] : [picture];
  }

  /** Shows a button for each file. Drags call this often, so it reuses the buttons if it can. */
  private show(): void {
    this.node.hidden = !this.app.bench.surface;
    if (this.node.hidden || !this.node.open) return;
    const labels = this.offers.map(({ label }) => label);
    if (labels.join() === this.shown) return;
    this.shown = labels.join();
    const buttons = labels.map((label, i) =>
      button(label, () => void this.save(this.offers[i]!), { "aria-label": `Download ${label}` }),
    );
    this.row.replaceChildren(...buttons);
  }

  private async save({ make: makeFile, ending }: FileOffer): Promise<void> {
    const { app } = this;
    const name = `${app.bench.surface!.name}-${app.mode.id}.${ending}`;
    await app.bench.beside(async () => save(await makeFile(), name));
  }
}
