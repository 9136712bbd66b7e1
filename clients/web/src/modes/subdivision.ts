// A subdivision surface (Catmull-Clark, Loop): shortest paths and geodesics on the limit surface,
// shown with the control mesh.

import type {
  LimitFootAnswer,
  LimitPairAnswer,
  LimitPlace,
  LimitTraceAnswer,
  LimitTraceRequest,
} from "../../../js/types.d.ts";
import { cageEdges } from "../cages.ts";
import type { Place } from "../place.ts";
import { check, choice, only, range, Settings } from "../settings.ts";
import type { Kind } from "../surface.ts";
import { subtract, type Vec3 } from "../vector.ts";
import { ENDS, endsOf, INK, Mode, NO_PATH, pointsOf, XYZ } from "./mode.ts";

export class SubdivisionMode extends Mode {
  readonly id = "limit";
  readonly title = "Catmull-Clark";
  override readonly kind: Kind = "subdivisions";
  readonly hint = "The limit surface of a control mesh. Click two points of it.";
  readonly groups = ENDS;
  override settings = new Settings({
    what: choice("Ask for", "path", [
      ["path", "the shortest path"],
      ["trace", "the geodesic from start towards end"],
      ["fan", "geodesics in all directions"],
    ]),
    fan: only("what", ["fan"], range("How many", 16, 2, 72, 1)),
    length: only(
      "what",
      ["trace", "fan"],
      range("Length", 1.5, 0.05, 10, 0.05, (value) => this.sizeText(value)),
    ),
    smooth: only(
      "what",
      ["trace", "fan"],
      check("On the surface itself (else on its discretization)", true),
    ),
    cage: check("Control mesh", true),
  });
  private edges: Vec3[][] = [];

  override enter(): void {
    this.edges = [];
    const surface = this.bench.surface!;
    void cageEdges(surface.description.sha256).then((edges) => {
      if (this.bench.surface !== surface) return;
      this.edges = edges;
      this.showCage();
    });
  }

  private showCage(): void {
    this.decorate("cage", this.settings.on("cage") ? this.edges : [], INK.cage, 1.5, 0.35);
  }

  /** Returns the place of the limit surface that is nearest to a point of the drawn mesh. */
  private async locate(place: Place): Promise<LimitPlace> {
    const { face, corner, uv } = await this.bench.post<LimitFootAnswer>("nearest", {
      xyz: place.xyz,
    });
    return { face: face!, uv: uv!, ...(corner && { corner }) };
  }

  async ask(): Promise<void> {
    const { points } = this.bench;
    const [from, to] = [points.of("from")[0]!, points.of("to")[0]!];
    const start = await this.locate(from);
    if (this.settings.text("what") === "path") await this.askPath(start, await this.locate(to));
    else await this.askTrace(start, subtract(to.xyz, from.xyz));
  }

  private async askPath(from: LimitPlace, to: LimitPlace): Promise<void> {
    const { bench } = this;
    const found = await bench.post<LimitPairAnswer>("path", { from, to }, XYZ);
    const points = pointsOf(found.path);
    this.show([points]);
    this.path = found.path ? { length: found.distance!, points } : null;
    if (found.distance == null) return bench.answer.show([NO_PATH]);
    bench.answer.show([
      this.main("Distance on the limit surface", found.distance),
      { label: "Error, estimated", value: bench.units.length(found.error_estimate!, 2) },
      {
        label: "A geodesic of the surface",
        value: found.relaxed ? "yes" : "no, a path of the discretization",
      },
      {
        label: `Exact on level ${found.level}`,
        value: bench.units.length(found.mesh_distance!, 10),
      },
      this.time,
    ]);
  }

  private async askTrace(start: LimitPlace, towards: Vec3): Promise<void> {
    const { bench, settings } = this;
    const body: LimitTraceRequest = {
      start,
      ...(settings.text("what") === "fan"
        ? { fan: settings.number("fan") }
        : { directions: [towards] }),
      length: settings.number("length") * bench.surface!.size,
      smooth: settings.on("smooth"),
    };
    const { paths } = await bench.post<LimitTraceAnswer>("trace", body, XYZ);
    const lines = paths!.map(pointsOf);
    this.show(lines);
    const total = paths!.reduce((sum, path) => sum + path.length, 0);
    this.path = lines.length === 1 ? { length: total, points: lines[0]! } : null;
    bench.answer.show([
      this.main(paths!.length > 1 ? "Length in all" : "Length", total),
      { label: paths!.length > 1 ? "They end" : "It ends", value: endsOf(paths!) },
      this.time,
    ]);
  }

  private show(paths: Vec3[][]): void {
    this.fan(paths);
    this.showCage();
  }
}
