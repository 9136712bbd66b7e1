// Edits the mesh: simplifies it, fills its holes, smooths it, or keeps its largest component. The
// result is a new mesh on the daemon. A slider splits the picture: the original on the left, the
// result on the right.

import type { EditOperation, Mesh } from "../../js/types.d.ts";
import type { App } from "./app.ts";
import { ask, received } from "./api.ts";
import { isAbort } from "./bench.ts";
import { button, byId, make } from "./dom.ts";
import { runJob } from "./jobs.ts";
import { loadSurface } from "./load.ts";
import { messageOf, Notice } from "./notice.ts";
import type { Surface } from "./surface.ts";
import { choice, only, range, Settings } from "./settings.ts";
import { whole } from "./units.ts";
import { freeName } from "./uploads.ts";

export class Derive {
  private readonly settings = new Settings({
    edit: choice("Edit", "simplify", [
      ["simplify", "simplify"],
      ["fill", "fill holes"],
      ["smooth", "smooth"],
      ["components", "keep the largest component"],
    ]),
    part: only(
      "edit",
      ["simplify"],
      range(
        "Faces to keep",
        20,
        1,
        100,
        1,
        (percent) => `${percent} %, ${whole(this.faces(percent))}`,
      ),
    ),
    edges: only("edit", ["fill"], range("Longest hole, in edges", 1000, 3, 2000, 1, whole)),
    rounds: only("edit", ["smooth"], range("Rounds", 5, 1, 100, 1)),
  });
  private readonly start = button("Make a new mesh", () => void this.run());
  private readonly result = make("div");
  private readonly notice = new Notice();
  private shownFor = "";

  constructor(private readonly app: App) {
    byId("derive").append(
      make("div", {}),
      this.start,
      this.notice.node,
      this.result,
    );
    app.watchers.push(() => this.watch());
  }

  private faces(percent: number): number {
    return Math.max(4, Math.round((percent / 100) * (this.app.bench.surface?.faceCount ?? 0)));
  }

  /** Shows the controls of the open surface. */
  private watch(): void {
    const { surface } = this.app.bench;
    byId("derive").hidden = surface?.kind !== "meshes";
    if (!surface || surface.path === this.shownFor) return;
    this.shownFor = surface.path;
    byId("derive")
      .querySelector("div")!
      .replaceChildren(...this.settings.elements());
    this.result.replaceChildren();
    this.notice.warn("");
  }

  private get operation(): EditOperation {
    const { settings } = this;
    switch (settings.text("edit")) {
      case "simplify":
        return { operation: "simplify", faces: this.faces(settings.number("part")) };
      case "fill":
        return { operation: "fill", max_edges: settings.number("edges") };
      case "smooth":
        return { operation: "smooth", iterations: settings.number("rounds") };
      default:
        return { operation: "components", keep: 1 };
    }
  }

  private async run(): Promise<void> {
    const { api, bench } = this.app;
    const { notice } = this;
    const surface = bench.surface!;
    const running = new AbortController();
    const json = { operations: [this.operation], mesh: freeName(surface.name, 2, bench.taken) };
    const request = { method: "POST", path: `${surface.path}/derive`, json } as const;
    const onPart = (part: number): void =>
      notice.showProgress("Editing", part, () => running.abort());
    notice.warn("");
    this.start.disabled = true; /* until the new name is listed: a second edit would get it too */
    try {
      const response = await ask(await runJob(api, request, onPart, running.signal));
      await this.compare(surface, (await received(response.json(), running.signal)) as Mesh);
    } catch (error) {
      if (!isAbort(error)) notice.warn(messageOf(error));
    }
    notice.hideProgress();
    await bench.onMeshes();
    this.start.disabled = false;
  }

  /** Compares the result with the original, unless another surface has been opened. */
  private async compare(original: Surface, mesh: Mesh): Promise<void> {
    const { app } = this;
    const derived = await loadSurface(app.api, "meshes", mesh.name, { onPart: () => {} });
    if (app.bench.surface !== original) return;
    app.scene.compare(derived);
    const slider = make("input", {
      type: "range",
      min: 0,
      max: 1,
      step: 0.01,
      value: 0.5,
      "aria-label": "Before and after",
    });
    slider.addEventListener("input", () => app.scene.split(Number(slider.value)));
    const distance = mesh.derived_from?.largest_distance;
    const off = distance == null ? "" : `, at most ${app.units.length(distance, 3)} off`;
    this.result.replaceChildren(
      make(
        "p",
        { class: "faint" },
        `${mesh.name}: ${whole(mesh.faces)} faces${off}. Left: before. Right: after.`,
      ),
      slider,
      make(
        "div",
        { class: "row" },
        button(`Open ${mesh.name}`, () => void app.open("meshes", mesh.name)),
        button("Close", () => this.close()),
      ),
    );
    this.result.scrollIntoView({ block: "nearest" });
  }

  private close(): void {
    this.app.scene.compare(undefined);
    this.result.replaceChildren();
  }
}
