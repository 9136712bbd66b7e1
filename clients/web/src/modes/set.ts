// Many points, each with what is nearest to it: Voronoi cells, exact lines between them, distances to the set; and
// points that cover the surface evenly.

import type { Field, Point, PointAnswer, SamplingAnswer, VoronoiAnswer } from "../../../js/types.d.ts";
import { hexOf, memberColour, type Rgb } from "../colours.ts";
import { type Place, placeOf, pointOf } from "../place.ts";
import { check, choice, range, Settings } from "../settings.ts";
import { whole } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import { isolinesOf, polylinesOf, valuesOf } from "./field.ts";
import { doing, INK, Mode, XYZ } from "./mode.ts";

const LIVE_FACES = 30000;
const PLAIN: Rgb = [0.75, 0.77, 0.78];

export class SetMode extends Mode {
  readonly id = "set";
  readonly title = "Set and Voronoi";
  readonly hint =
    "Click points. Each part of the surface has the colour of the nearest one; the lines between are exact.";
  readonly groups = [{ id: "points", label: "Point", least: 1, first: 6, most: 200, colour: INK.first }];
  override settings = new Settings({
    colour: choice("Colours show", "cells", [
      ["cells", "which point is nearest"],
      ["distance", "how far it is"],
    ]),
    bisectors: check("Lines between cells", true),
    isolines: range("Lines of equal distance", 0, 0, 60, 1),
    count: range("How many points to spread", 8, 2, 60, 1),
  });

  override get followsDrag(): boolean {
    return this.bench.surface!.faceCount <= LIVE_FACES;
  }

  override extras(): Node[] {
    return [doing("Spread points evenly", () => void this.spread())];
  }

  /** Farthest-point sampling from the first point that is there. */
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

  async ask(): Promise<void> {
    const { bench, settings } = this;
    const places = bench.points.of("points");
    const voronoi = await bench.postLong<VoronoiAnswer>("voronoi", { set: this.set }, XYZ);
    const needsField = settings.text("colour") === "distance" || settings.number("isolines") > 0;
    const field = needsField ? await bench.postLong<Field>("fields", { set: this.set }) : undefined;
    const values = field && (await valuesOf(bench, field.id!));
    const count = settings.number("isolines");
    const isolines = field && count > 0 ? polylinesOf(await isolinesOf(bench, field.id!, count)) : [];
    const fine = await bench.fineDistances(this.set);
    if (bench.aborted) return;
    this.showCells(voronoi, fine?.labels ?? voronoi.labels!, places, isolines);
    if (field && settings.text("colour") === "distance") this.showDistance(field, values!, fine?.values);
    bench.scene.redraw();
  }

  private showCells(voronoi: VoronoiAnswer, labels: (number | null)[], places: Place[], isolines: Vec3[][]): void {
    const { scene, legend, units, answer } = this.bench;
    const colours = places.map((_, i) => memberColour(i));
    scene.skin!.clear();
    if (this.settings.text("colour") === "cells") scene.skin!.showLabels(labels, colours, PLAIN);
    legend.showMembers(places.map((_, i) => ({ label: `Point ${i + 1}`, colour: hexOf(colours[i]!) })));
    const bisectors = voronoi.bisectors!;
    const lines = this.settings.on("bisectors") ? bisectors.map((bisector) => bisector.points as Vec3[]) : [];
    this.lines("bisectors", lines, INK.isoline, 2.5, 0.15);
    this.isolines(isolines);
    const total = bisectors.reduce((sum, bisector) => sum + bisector.length, 0);
    answer.show([
      { label: "Points", value: whole(places.length), main: true },
      { label: "Lines between cells", value: whole(bisectors.length) },
      { label: "Their length", value: units.length(total) },
      this.time,
    ]);
  }

  private showDistance(field: Field, values: Float64Array, fine: Float64Array | undefined): void {
    const { scene, legend, display, units } = this.bench;
    if (fine) scene.skin!.showFineValues(fine, field.max!);
    else scene.skin!.showValues(values, field.max!);
    legend.showRamp(`Distance to the nearest point, ${units.name}`, display.ramp, field.max!, (value) =>
      units.bare(value, 3),
    );
  }
}
