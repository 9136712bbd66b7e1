// A set of points: Voronoi cells with exact boundaries, distances to the set, and sampling of
// points that cover the surface evenly.

import type {
  Field,
  PathPoint,
  Point,
  PointAnswer,
  SamplingAnswer,
  Vector,
  VoronoiAnswer,
} from "../../../js/types.d.ts";
import { middleOf, type Piece, piecesOf } from "../cells.ts";
import { hexOf, memberColour, type Rgb } from "../colours.ts";
import type { FileOffer } from "../files.ts";
import { type Place, placeOf, pointOf } from "../place.ts";
import { check, choice, range, Settings } from "../settings.ts";
import { whole } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import {
  distanceAt,
  fieldFiles,
  hasExactIsolines,
  isolinesOf,
  LIVE_FACES,
  valuesOf,
} from "./field.ts";
import { actionRow, INK, Mode } from "./mode.ts";

/* borders of cells deviate by at most the surface's size / PRECISION, less than a pixel */
const PRECISION = 4000;
const PLAIN: Rgb = [0.75, 0.77, 0.78];

const xyzOf = (point: PathPoint | Vector): Vec3 =>
  (Array.isArray(point) ? point : point.xyz) as Vec3;

interface LabelledPiece extends Piece {
  /** The index of the nearest point, or null if no path reaches the piece. */
  label: number | null;
}

export class SetMode extends Mode {
  readonly id = "set";
  readonly title = "Set and Voronoi";
  readonly hint = "Click points. Each part of the surface has the colour of the nearest point.";
  readonly groups = [
    { id: "points", label: "Point", least: 1, first: 6, most: 200, colour: INK.first },
  ];
  override settings = new Settings({
    colour: choice("Colours show", "cells", [
      ["cells", "the nearest point"],
      ["distance", "the distance to it"],
    ]),
    bisectors: check("Lines between cells", true),
    isolines: range("Lines of equal distance", 0, 0, 60, 1),
    count: range("Points to spread", 8, 2, 60, 1),
  });
  private field: Field | undefined;

  override get followsDrag(): boolean {
    return this.bench.surface!.faceCount <= LIVE_FACES;
  }

  override extras(): Node[] {
    return [actionRow("Spread points evenly", () => void this.spread())];
  }

  /** Adds points by farthest-point sampling, from the first point of the set. */
  private async spread(): Promise<void> {
    const { bench, settings } = this;
    const [start] = bench.points.of("points");
    const done = await bench.question(async () => {
      const body = { count: settings.number("count"), ...(start && { start: pointOf(start) }) };
      const answer = await bench.postLong<SamplingAnswer>("farthest-points", body);
      bench.points.set(
        "points",
        answer.points!.map((point) => placeOf(point as PointAnswer, bench.surface!.isRenumbered)),
      );
    });
    if (done) bench.points.onChange(false);
  }

  private get set(): { points: Point[] } {
    return { points: this.bench.points.of("points").map(pointOf) };
  }

  async ask(live: boolean): Promise<void> {
    const { bench, settings } = this;
    const places = bench.points.of("points");
    const showsDistance = settings.text("colour") === "distance";
    const count = settings.number("isolines");
    const isQuick = live && !hasExactIsolines(bench, false);
    const parameters: Record<string, string> = isQuick
      ? { select: "labels" }
      : { geometry: live ? "xyz" : "full" };
    const voronoi = await bench.postLong<VoronoiAnswer>(
      "voronoi",
      { set: this.set },
      { live, parameters },
    );
    const needsField = showsDistance || count > 0;
    this.field = needsField
      ? await bench.postLong<Field>("fields", { set: this.set }, { live })
      : undefined;
    const { field } = this;
    const hasValues = field && !bench.surface!.isPreview;
    const values = hasValues ? await valuesOf(bench, field.id!) : undefined;
    const isExact = field && count > 0 && hasExactIsolines(bench, live);
    const isolines = isExact ? await isolinesOf(bench, field.id!, count) : [];
    const fine = live ? null : await bench.nearestOfSamples(this.set);
    const pieces = live || showsDistance ? [] : await this.pieces(voronoi);
    if (bench.aborted) return;
    bench.last = voronoi; /* the answer that the page offers as a file */
    this.showCells(voronoi, fine?.labels ?? voronoi.labels!, fine !== null, places);
    const colours = pieces.map(({ label }) => (label === null ? PLAIN : memberColour(label)));
    if (pieces.length > 0) bench.scene.skin!.showPieces(pieces, colours);
    this.isolines(isolines);
    bench.scene.skin!.setIsolines(isExact ? 0 : count);
    if (field && showsDistance) this.showDistance(field, values, fine?.values);
    bench.scene.redraw();
  }

  /** Returns the pieces of the faces that bisectors cross, with the nearest point of each. */
  private async pieces(voronoi: VoronoiAnswer): Promise<LabelledPiece[]> {
    const surface = this.bench.surface!;
    if (surface.isRenumbered) return [];
    const lines = voronoi.bisectors!.map(({ points }) => points as PathPoint[]);
    const tolerance = surface.size / PRECISION;
    const pieces = piecesOf(surface.triangles.faces, voronoi.labels!, lines, tolerance);
    const middles = pieces.map((piece) => surface.place(piece.face, middleOf(piece)));
    const { labels } = await this.bench.nearest(this.set, middles);
    return pieces.map((piece, i) => ({ ...piece, label: labels[i]! }));
  }

  private showCells(
    voronoi: VoronoiAnswer,
    labels: (number | null)[],
    areSamples: boolean,
    places: Place[],
  ): void {
    const { scene, legend, units, answer, surface } = this.bench;
    const colours = places.map((_, i) => memberColour(i));
    scene.skin!.clear();
    const areShown = areSamples || !surface!.fine;
    if (this.settings.text("colour") === "cells" && areShown)
      scene.skin!.showLabels(surface!.spreadSamples(labels), colours, PLAIN);
    legend.showMembers(
      places.map((_, i) => ({ label: `Point ${i + 1}`, colour: hexOf(colours[i]!) })),
    );
    const bisectors = voronoi.bisectors ?? [];
    const lines = this.settings.on("bisectors")
      ? bisectors.map(({ points }) => points!.map(xyzOf))
      : [];
    this.lines("bisectors", lines, INK.isoline, 2.5, 0.15);
    const total = bisectors.reduce((sum, bisector) => sum + bisector.length, 0);
    answer.show([
      { label: "Points", value: whole(places.length), main: true },
      { label: "Lines between cells", value: whole(bisectors.length) },
      { label: "Their length", value: units.length(total) },
      this.time,
    ]);
  }

  private showDistance(
    field: Field,
    values: Float64Array | undefined,
    fine: Float64Array | undefined,
  ): void {
    const { scene, legend, colours, units, surface } = this.bench;
    if (fine) scene.skin!.showValues(surface!.spreadSamples(fine), field.max!);
    else if (values) scene.skin!.showValues(surface!.spread(values), field.max!);
    const title = `Distance to the nearest point, ${units.name}`;
    legend.showRamp({ title, max: field.max!, format: (value) => units.bare(value, 3) }, colours);
  }

  override async valueAt(place: Place, signal: AbortSignal): Promise<number | null> {
    return this.field ? distanceAt(this.bench, this.field.id!, place, signal) : null;
  }

  override files(): FileOffer[] {
    const field = this.field
      ? fieldFiles(this.bench, this.field.id!, this.settings.number("isolines"))
      : [];
    return [...super.files(), ...field];
  }

  override clear(): void {
    this.field = undefined;
    super.clear();
  }
}
