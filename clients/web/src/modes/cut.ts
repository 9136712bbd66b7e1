// Cuts the surface along a curve: shows a preview of the pieces, then the pieces, moved apart.

import type { Curve, CurveOperationAnswer, CutAnswer, CutPiece } from "../../../js/types.d.ts";
import { boundaryOf, nearestOnBoundary } from "../boundary.ts";
import { hexOf, memberColour } from "../colours.ts";
import { button, make } from "../dom.ts";
import { save } from "../files.ts";
import { Pieces } from "../pieces.ts";
import { type Place, pointOf } from "../place.ts";
import { check, range, Settings } from "../settings.ts";
import { type Surface, surfacePath } from "../surface.ts";
import { whole } from "../units.ts";
import { freeName } from "../uploads.ts";
import { actionRow, INK, Mode, pointsOf, XYZ } from "./mode.ts";

const FORMATS = ["obj", "ply", "stl"];

export class CutMode extends Mode {
  readonly id = "cut";
  readonly title = "Cut";
  readonly hint =
    "Click the points of a closed curve, or of an open one that ends at the boundary. Then cut along it.";
  readonly groups = [
    { id: "points", label: "Point", least: 2, first: 5, most: 60, colour: INK.second },
  ];
  private readonly pieces = new Pieces(this.bench);
  private names: string[] = [];
  override settings = new Settings({
    closed: check("Closed", true),
    apart: range("Pull apart", 0.35, 0, 1.5, 0.01),
  });
  private boundary: { of: Surface; sides: ReturnType<typeof boundaryOf> } | undefined;

  override get showsPoints(): boolean {
    return !this.pieces.areShown;
  }

  override extras(): Node[] {
    return [actionRow("Cut", () => void this.cut(), "main")];
  }

  private get curve(): Curve {
    const places = this.bench.points.of("points");
    if (this.settings.on("closed")) return { points: places.map(pointOf), closed: true };
    const ends = [places[0]!, ...places.slice(1, -1), places.at(-1)!];
    return {
      points: ends.map((place, i) =>
        pointOf(i % (ends.length - 1) === 0 ? this.onBoundary(place) : place),
      ),
    };
  }

  private onBoundary(place: Place): Place {
    const surface = this.bench.surface!;
    if (this.boundary?.of !== surface) this.boundary = { of: surface, sides: boundaryOf(surface) };
    return nearestOnBoundary(surface, this.boundary.sides, place.xyz) ?? place;
  }

  async ask(live: boolean): Promise<void> {
    const { bench } = this;
    this.pieces.pull(this.settings.number("apart"));
    if (this.pieces.isOf(JSON.stringify(this.curve))) return;
    this.pieces.clear();
    const { path } = await bench.post<CurveOperationAnswer>(
      "curve",
      { curve: this.curve, operation: "length" },
      XYZ,
    );
    this.lines("curve", [pointsOf(path)], INK.path, 4);
    if (live) return;
    const preview = await bench.post<CutAnswer>(
      "cut",
      { curve: this.curve, select_only: true },
      { select: "separates,pieces" },
    );
    this.names = this.freeNames(preview.pieces!.length);
    this.showAnswer(preview, path!.length);
  }

  /** Returns unused names for `count` pieces. */
  private freeNames(count: number): string[] {
    const { surface, taken } = this.bench;
    const all = new Set(taken);
    return Array.from({ length: count }, () => {
      const name = freeName(surface!.name, 1, all);
      all.add(name);
      return name;
    });
  }

  private showAnswer(preview: CutAnswer, length: number): void {
    const { answer, units } = this.bench;
    const pieces = preview.pieces!;
    answer.show(
      [
        {
          label: preview.separates ? "Pieces" : "Pieces, not separated",
          value: whole(pieces.length),
          main: true,
        },
        { label: "Length of the cut", value: units.length(length) },
        ...pieces
          .slice(0, 8)
          .map((piece, i) => ({ label: `Area of piece ${i + 1}`, value: units.area(piece.area!) })),
        this.time,
      ],
      make("p", { class: "faint" }, `"Cut" stores: ${this.names.join(", ")}.`),
    );
  }

  private async cut(): Promise<void> {
    const { bench } = this;
    if (!bench.points.complete) return;
    const curve = this.curve;
    await bench.question(async () => {
      const made = await bench.postLong<CutAnswer>(
        "cut",
        { curve, names: this.names },
        { parameters: { select: "separates,pieces" } },
      );
      await this.pieces.show(
        made.pieces!.map((piece) => piece.name!),
        JSON.stringify(curve),
      );
      this.pieces.pull(this.settings.number("apart"));
      bench.answer.show(
        [{ label: "Pieces", value: whole(made.pieces!.length), main: true }, this.time],
        make("ul", {}, ...made.pieces!.map((piece, i) => this.row(piece, i))),
      );
    });
    void bench.onMeshes();
    bench.points.onLook();
  }

  private row(piece: CutPiece, i: number): HTMLElement {
    const { bench } = this;
    const swatch = make("span", { class: "swatch" });
    swatch.style.background = hexOf(memberColour(i));
    const name = piece.name!;
    const path = `${surfacePath("meshes", name)}/content`;
    const files = FORMATS.map((format) =>
      button(
        format.toUpperCase(),
        () =>
          void bench.beside(async () => {
            const bytes = await bench.api.bytes({ method: "GET", path, query: { format } });
            save(new Blob([bytes]), `${name}.${format}`);
          }),
        { "aria-label": `Download ${name} as ${format.toUpperCase()}` },
      ),
    );
    const about = `${name}: ${whole(piece.faces!)} faces, ${bench.units.area(piece.area!)}`;
    return make(
      "li",
      { class: "piece" },
      make("p", {}, swatch, about),
      make("div", { class: "row" }, ...files),
    );
  }

  override clear(): void {
    this.pieces.clear();
    super.clear();
  }
}
