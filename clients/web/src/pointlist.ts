// Shows points as text. The user can edit them, in all forms of the API, and remove them.

import type { PointAnswer } from "../../js/types.d.ts";
import type { App } from "./app.ts";
import { button, byId, make } from "./dom.ts";
import { compactOf, parseXyz, placeOf } from "./place.ts";
import type { Mark } from "./points.ts";

export class PointList {
  private readonly body = make("div");

  constructor(private readonly app: App) {
    const { points } = app;
    const hint =
      "A point is v:12 (a vertex), e:3-9:0.25 (on an edge), f:34:0.2,0.3,0.5 (in a face) or p:1,2,3 " +
      "(the nearest point of the surface).";
    byId("points").append(
      make("p", { class: "faint" }, hint),
      this.body,
      button("Remove all points", () => points.clear()),
    );
    app.watchers.push(() => this.show());
    byId("points").addEventListener("toggle", () => this.show());
  }

  /** Shows the points. Leaves the rows unchanged while the user types in one of them. */
  private show(): void {
    if (!byId<HTMLDetailsElement>("points").open) return;
    const focus = document.activeElement;
    if (focus instanceof HTMLInputElement && this.body.contains(focus)) return;
    const removed = this.removes.indexOf(focus as HTMLButtonElement);
    this.body.replaceChildren(...this.app.points.groups.flatMap((_, g) => this.rows(g)));
    if (removed >= 0) (this.removes[removed] ?? this.removes.at(-1))?.focus();
  }

  /** The buttons that remove a point. */
  private get removes(): HTMLButtonElement[] {
    return [...this.body.querySelectorAll("button")];
  }

  private rows(g: number): HTMLElement[] {
    const { points } = this.app;
    const group = points.groups[g]!;
    const marks = points.all.filter((mark) => mark.group === group);
    const rows = marks.map((mark) =>
      this.row(
        points.labelOf(mark),
        compactOf(mark.place),
        (text) => this.move(mark, text),
        () => points.remove(mark),
      ),
    );
    if (marks.length < group.most)
      rows.push(this.row(`${group.label}, new`, "", (text) => this.add(g, text)));
    return rows;
  }

  private row(
    label: string,
    value: string,
    take: (text: string) => Promise<void>,
    remove?: () => void,
  ): HTMLElement {
    const input = make("input", {
      type: "text",
      value,
      "aria-label": label,
      spellcheck: "false",
      autocomplete: "off",
      placeholder: "v:12",
    });
    input.addEventListener("change", () => {
      input.blur();
      const text = input.value.trim();
      if (text) void take(text).then(() => this.show());
    });
    const more = remove ? [button("Remove", remove, { "aria-label": `Remove ${label}` })] : [];
    return make("div", { class: "point" }, make("span", {}, label), input, ...more);
  }

  /** Converts a compact point to a place. On smooth surfaces, only points in space are valid. */
  private async place(text: string): Promise<Mark["place"] | null> {
    const { api, answer, bench } = this.app;
    const surface = bench.surface!;
    const xyz = parseXyz(text);
    try {
      if (surface.kind === "meshes")
        return placeOf(
          await api.get<PointAnswer>(`${surface.path}/nearest`, { point: text }),
          surface.isRenumbered,
        );
      if (!xyz) throw new Error("On a smooth surface, type a point of space: p:1,2,3.");
      return { face: 0, barycentric: [1, 0, 0], xyz, isFree: true };
    } catch (error) {
      answer.warn(error);
      return null;
    }
  }

  private async move(mark: Mark, text: string): Promise<void> {
    const place = await this.place(text);
    if (place) this.app.points.move(mark, place, false);
  }

  private async add(g: number, text: string): Promise<void> {
    const place = await this.place(text);
    this.app.points.active = g;
    if (place) this.app.points.add(place);
  }
}
