// The distances from one point to the whole surface: colours, isolines, the farthest point, the cut
// locus.

import type { CutLocusAnswer, Field, IsolinesAnswer, ResultsAnswer } from "../../../js/types.d.ts";
import type { Fact } from "../answer.ts";
import { received } from "../api.ts";
import type { Bench } from "../bench.ts";
import { daemonFile, type FileOffer } from "../files.ts";
import { arraysOf, type Place, placeOf, pointOf } from "../place.ts";
import { check, only, range, Settings } from "../settings.ts";
import { milliseconds, whole } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import { INK, Mode, pointsOf, XYZ } from "./mode.ts";

const degrees = (angle: number): string => `${angle}°`;
// the page requests the field during a drag if the surface has at most this number of faces
export const LIVE_FACES = 300000;
/* isolines are exact polylines if the surface has at most this number of faces */
const EXACT_FACES = 20000;

/** Returns the distance at each vertex, or NaN if no path reaches the vertex. */
export async function valuesOf(bench: Bench, id: string): Promise<Float64Array> {
  const response = await bench.get(`fields/${id}/values`, undefined, "application/octet-stream");
  return new Float64Array(await received(response.arrayBuffer(), bench.signal));
}

export async function isolinesOf(bench: Bench, id: string, count: number): Promise<Vec3[][]> {
  const response = await bench.get(`fields/${id}/isolines`, { count: String(count), ...XYZ });
  const { isolines } = (await received(response.json(), bench.signal)) as IsolinesAnswer;
  return isolines.flatMap((isoline) => isoline.lines.map((line) => (line.points ?? []) as Vec3[]));
}

/** Returns the exact distance of a place in a field, or null if no path reaches the place. */
export async function distanceAt(
  bench: Bench,
  id: string,
  place: Place,
  signal: AbortSignal,
): Promise<number | null> {
  const path = `${bench.surface!.path}/fields/${id}/evaluate`;
  const json = { points: [pointOf(place)] };
  const request = { method: "POST", path, query: { select: "distance" }, json } as const;
  return (await bench.api.json<ResultsAnswer>(request, signal)).results[0]!.distance ?? null;
}

/**
 * Returns whether isolines are exact polylines. Otherwise the graphics card draws the isolines from
 * values.
 */
export const hasExactIsolines = (bench: Bench, live: boolean): boolean =>
  !live && bench.surface!.faceCount <= EXACT_FACES;

/** Returns files of a field: the mesh with its distances, the distances, the exact isolines. */
export function fieldFiles(bench: Bench, id: string, isolines: number): FileOffer[] {
  const path = `${bench.surface!.path}/fields/${id}`;
  const values = ["ply", "glb", "csv", "npy"].map((format) => {
    const request = { method: "GET", path: `${path}/values`, query: { format } } as const;
    return daemonFile(bench, `Field ${format.toUpperCase()}`, format, request);
  });
  if (isolines === 0) return values;
  const lines = ["obj", "csv", "glb", "json"].map((format) => {
    const query = { count: String(isolines), format };
    const request = { method: "GET", path: `${path}/isolines`, query } as const;
    return daemonFile(bench, `Lines ${format.toUpperCase()}`, `isolines.${format}`, request);
  });
  return [...values, ...lines];
}

export class FieldMode extends Mode {
  readonly id = "field";
  readonly title = "Distance field";
  readonly hint = "The distance from one point to everywhere. Click another point, or drag it.";
  readonly groups = [
    { id: "source", label: "Source", letter: "A", least: 1, most: 1, colour: INK.first },
  ];
  override settings = new Settings({
    isolines: range("Lines of equal distance", 20, 0, 60, 1),
    farthest: check("The farthest point, and a path to it", false),
    locus: check("Cut locus, where shortest paths meet", false),
    angle: only("locus", ["true"], range("Paths meet at least at", 30, 1, 180, 1, degrees)),
  });
  private field: Field | undefined;

  override get followsDrag(): boolean {
    return this.bench.surface!.faceCount <= LIVE_FACES;
  }

  async ask(live: boolean): Promise<void> {
    const { bench } = this;
    const source = bench.points.of("source")[0]!;
    if (live) return this.follow(source);
    const set = { points: [pointOf(source)] };
    const field = await bench.postLong<Field>("fields", { set });
    const { time } = this;
    const values = bench.surface!.isPreview ? null : await valuesOf(bench, field.id!);
    if (bench.aborted) return;
    this.field = field;
    this.clearLines();
    this.paint(values, field.max!);
    bench.answer.show([
      this.main("Farthest", field.max!),
      this.spacing(field.max!),
      { label: "Wedges", value: whole(field.wedges!) },
      {
        label: "Computed in",
        value: milliseconds(field.build_ms!),
        title: "By the daemon, which keeps the field",
      },
      time,
    ]);
    await this.refine(field, set, source);
  }

  /**
   * Shows the distances at the vertices during a drag. The daemon computes them without storing a
   * field.
   */
  private async follow(source: Place): Promise<void> {
    const { bench } = this;
    const surface = bench.surface!;
    const vertices = surface.usedVertices;
    const arrays = { ...arraysOf("from", source), to: vertices };
    const { distances } = await bench.postArrays("pairs", arrays);
    const values = new Float64Array(surface.triangles.positions.length / 3).fill(NaN);
    let max = 0;
    distances!.forEach((distance, i) => {
      values[vertices[i]!] = distance;
      if (distance > max) max = distance;
    });
    this.clearLines();
    this.paint(values, max);
    const farthest = this.main("Farthest vertex", max);
    bench.answer.show([farthest, this.spacing(max), { ...this.time, label: "Update" }]);
  }

  /** Colours the surface by the values of its vertices. */
  private paint(values: Float64Array | null, max: number): void {
    const { units, colours, legend, scene, surface } = this.bench;
    const format = (value: number): string => units.bare(value, 3);
    legend.showRamp({ title: `Distance, ${units.name}`, max, format }, colours);
    if (values) scene.skin!.showValues(surface!.spread(values), max);
    this.showFastIsolines();
    scene.recolour();
  }

  private spacing(max: number): Fact {
    const count = this.settings.number("isolines");
    const value = count > 0 ? this.bench.units.length(max / (count + 1)) : "no lines";
    return { label: "Between two lines", value };
  }

  /** Adds the parts of the answer that a drag leaves out. */
  private async refine(field: Field, set: object, source: Place): Promise<void> {
    const { bench, settings } = this;
    const fine = await bench.nearestOfSamples(set);
    if (fine) bench.scene.skin!.showValues(bench.surface!.spreadSamples(fine.values), field.max!);
    bench.scene.recolour();
    await this.showIsolines(field);
    if (settings.on("farthest") && field.farthest)
      await this.showWay(source, placeOf(field.farthest, bench.surface!.isRenumbered));
    if (settings.on("locus")) await this.showLocus(set);
  }

  /** The smallest angle, in radians, at which paths meet in the shown cut locus. */
  private get angle(): number {
    return (this.settings.number("angle") * Math.PI) / 180;
  }

  private async showLocus(set: object): Promise<void> {
    const body = { set, min_angle: this.angle };
    const { lines } = await this.bench.postLong<CutLocusAnswer>("cut-locus", body, {
      parameters: XYZ,
    });
    if (this.bench.aborted) return;
    const points = lines.map((line) => line.points as Vec3[]);
    this.lines("locus", points, INK.second, 2.5, 0.15);
  }

  private showFastIsolines(): void {
    const { scene } = this.bench;
    if (!scene.fixedLines.isEmpty) {
      scene.fixedLines.clear();
      scene.redraw();
    }
    scene.skin!.setIsolines(this.settings.number("isolines"));
  }

  private async showIsolines(field: Field): Promise<void> {
    const { bench } = this;
    const count = this.settings.number("isolines");
    if (count === 0 || !hasExactIsolines(bench, false)) return;
    const lines = await isolinesOf(bench, field.id!, count);
    if (bench.aborted) return;
    bench.scene.skin!.setIsolines(0);
    this.isolines(lines);
  }

  private async showWay(from: Place, to: Place): Promise<void> {
    const found = await this.bench.post<{ path: { points: Vec3[] } | null }>(
      "path",
      { from: pointOf(from), to: pointOf(to) },
      XYZ,
    );
    this.lines("way", found.path ? [pointsOf(found.path)] : [], INK.path, 4);
  }

  override async valueAt(place: Place, signal: AbortSignal): Promise<number | null> {
    return this.field ? distanceAt(this.bench, this.field.id!, place, signal) : null;
  }

  override files(): FileOffer[] {
    const { bench, field, settings } = this;
    if (!field) return [];
    const files = fieldFiles(bench, field.id!, settings.number("isolines"));
    if (!settings.on("locus")) return files;
    const path = `${bench.surface!.path}/fields/${field.id}/cut-locus`;
    const locus = ["obj", "csv", "glb"].map((format) => {
      const query = { format, min_angle: String(this.angle) };
      const label = `Cut locus ${format.toUpperCase()}`;
      return daemonFile(bench, label, `cut-locus.${format}`, { method: "GET", path, query });
    });
    return [...files, ...locus];
  }

  override clear(): void {
    this.field = undefined;
    super.clear();
  }
}
