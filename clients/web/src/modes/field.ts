// The distance from one point to everywhere: colours, lines of equal distance, the farthest point.

import type { Field, IsolinesAnswer } from "../../../js/types.d.ts";
import { type Place, placeOf, pointOf } from "../place.ts";
import { check, range, Settings } from "../settings.ts";
import type { Vec3 } from "../vector.ts";
import { INK, Mode, XYZ } from "./mode.ts";

const LIVE_FACES = 30000; /* up to which a field follows the mouse */

/** A vertex' distance each, NaN where there is none. */
export async function valuesOf(mode: Pick<FieldCaller, "get">, id: string): Promise<Float64Array> {
  return new Float64Array(await (await mode.get(`fields/${id}/values`, undefined, "application/octet-stream")).arrayBuffer());
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
    const count = settings.number("isolines");
    const isolines = count > 0 ? await isolinesOf(bench, field.id!, count) : [];
    const fine = live ? null : await bench.fineDistances(set);
    if (bench.aborted) return;
    this.show(field, values, polylinesOf(isolines));
    if (fine) bench.scene.skin!.showFineValues(fine.values, field.max!);
    if (settings.on("farthest") && field.farthest) await this.showWay(source, placeOf(field.farthest, bench.surface!.isRenumbered));
    else bench.scene.lines.remove("way");
  }

  private show(field: Field, values: Float64Array, isolines: Vec3[][]): void {
    const { scene, units, display, legend, answer } = this.bench;
    const max = field.max ?? values.reduce((most, value) => (value > most ? value : most), 0);
    scene.skin!.showValues(values, max);
    scene.redraw();
    this.lines("isolines", isolines, INK.isoline, 1.2, 0);
    legend.showRamp(`Distance, ${units.name}`, display.ramp, max, (value) => units.bare(value, 3));
    const spacing = max / (this.settings.number("isolines") + 1);
    answer.show([
      { label: "Farthest", value: units.length(max, 9), main: true, title: String(max) },
      { label: "Between two lines", value: isolines.length ? units.length(spacing) : "no lines" },
      { label: "Wedges", value: field.wedges!.toLocaleString("en") },
      { label: "Computed in", value: `${field.build_ms!.toPrecision(3)} ms`, title: "When it was computed; it is kept since then" },
      this.time,
    ]);
  }

  private async showWay(from: Place, to: Place): Promise<void> {
    const found = await this.bench.post<{ path: { points: Vec3[] } | null }>("path", { from: pointOf(from), to: pointOf(to) }, XYZ);
    this.lines("way", found.path ? [found.path.points] : [], INK.path, 4);
  }
}
