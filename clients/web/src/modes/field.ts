// The distance from one point to everywhere: colours, lines of equal distance, the farthest point.

import type { Field, IsolinesAnswer } from "../../../js/types.d.ts";
import { type Place, placeOf, pointOf } from "../place.ts";
import { check, range, Settings } from "../settings.ts";
import { milliseconds, whole } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import { INK, Mode, XYZ } from "./mode.ts";

const LIVE_FACES = 30000; /* up to which a field follows the mouse */

/** A vertex' distance each, NaN where there is none. */
export async function valuesOf(mode: Pick<FieldCaller, "get">, id: string): Promise<Float64Array> {
  return new Float64Array(
    await (await mode.get(`fields/${id}/values`, undefined, "application/octet-stream")).arrayBuffer(),
  );
}

interface FieldCaller {
  get: (path: string, parameters?: Record<string, string>, accept?: string) => Promise<Response>;
}

export async function isolinesOf(mode: FieldCaller, id: string, count: number): Promise<IsolinesAnswer["isolines"]> {
  const response = await mode.get(`fields/${id}/isolines`, { count: String(count), ...XYZ });
  return ((await response.json()) as IsolinesAnswer).isolines;
}

export const polylinesOf = (isolines: IsolinesAnswer["isolines"]): Vec3[][] =>
  isolines.flatMap((isoline) => isoline.lines.map((line) => (line.points ?? []) as Vec3[]));

export class FieldMode extends Mode {
  readonly id = "field";
  readonly title = "Distance field";
  readonly hint = "The distance from one point to all of the surface. Click to put it elsewhere, or drag it.";
  readonly groups = [{ id: "source", label: "Source", least: 1, most: 1, colour: INK.first }];
  override settings = new Settings({
    isolines: range("Lines of equal distance", 20, 0, 60, 1),
    farthest: check("The farthest point, and the way to it", false),
  });

  override get followsDrag(): boolean {
    return this.bench.surface!.faceCount <= LIVE_FACES;
  }

  async ask(live: boolean): Promise<void> {
    const { bench, settings } = this;
    const source = bench.points.of("source")[0]!;
    const set = { points: [pointOf(source)] };
    const field = await bench.postLong<Field>("fields", { set });
    const values = await valuesOf(bench, field.id!);
    if (bench.aborted) return;
    this.show(field, values);
    const fine = live ? null : await bench.fineDistances(set);
    if (fine) this.showFine(field, fine.values);
    await this.showIsolines(field);
    if (settings.on("farthest") && field.farthest)
      await this.showWay(source, placeOf(field.farthest, bench.surface!.isRenumbered));
    else bench.scene.lines.remove("way");
  }

  private show(field: Field, values: Float64Array): void {
    const { scene, units, display, legend, answer } = this.bench;
    const max = field.max ?? values.reduce((most, value) => (value > most ? value : most), 0);
    scene.skin!.showValues(values, max);
    scene.redraw();
    legend.showRamp(`Distance, ${units.name}`, display.ramp, max, (value) => units.bare(value, 3));
    const count = this.settings.number("isolines");
    answer.show([
      { label: "Farthest", value: units.length(max, 9), main: true, title: String(max) },
      { label: "Between two lines", value: count > 0 ? units.length(max / (count + 1)) : "no lines" },
      { label: "Wedges", value: whole(field.wedges!) },
      {
        label: "Computed in",
        value: milliseconds(field.build_ms!),
        title: "When it was computed; it is kept since then",
      },
      this.time,
    ]);
  }

  private showFine(field: Field, values: Float64Array): void {
    const { scene } = this.bench;
    scene.skin!.showFineValues(values, field.max!);
    scene.redraw();
  }

  /** On large meshes there are many of their points; colours are seen before. */
  private async showIsolines(field: Field): Promise<void> {
    const count = this.settings.number("isolines");
    const isolines = count > 0 ? await isolinesOf(this.bench, field.id!, count) : [];
    if (!this.bench.aborted) this.isolines(polylinesOf(isolines));
  }

  private async showWay(from: Place, to: Place): Promise<void> {
    const found = await this.bench.post<{ path: { points: Vec3[] } | null }>(
      "path",
      { from: pointOf(from), to: pointOf(to) },
      XYZ,
    );
    this.lines("way", found.path ? [found.path.points] : [], INK.path, 4);
  }
}
