// A NURBS surface: shortest paths between points and curves, and their images in the domain.

import type {
  DomainCurve,
  FootAnswer,
  GeodesicAnswer,
  Nurbs,
  Place as Uv,
} from "../../../js/types.d.ts";
import { domainDrawing } from "../domain.ts";
import { make } from "../dom.ts";
import type { Place } from "../place.ts";
import { check, choice, only, range, Settings } from "../settings.ts";
import type { Kind } from "../surface.ts";
import { number } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import { evaluated } from "../grids.ts";
import { ENDS, INK, Mode } from "./mode.ts";

const NET = 12; /* cells of the net of parameter lines along each axis */
const STEPS = 48; /* segments of a parameter line */
const SAMPLES = 200; /* points on a path */
const MOST_TURNS = 3; /* winding number that a slider reaches */

const WARNINGS: Record<string, string> = {
  not_converged: "the tolerance was not met",
  boundary_contact: "it follows the border for a while",
  curve_corner: "it ends in a corner or at an end of a curve",
  through_pole: "it goes through a pole",
  not_minimal: "no minimum was found, this is a critical path",
  family: "other paths of a family are as short",
};

const percent = (value: number): string => `${number(100 * value, 3)} %`;

export class NurbsMode extends Mode {
  readonly id = "nurbs";
  readonly title = "NURBS";
  override readonly kind: Kind = "nurbs";
  readonly hint =
    "A smooth parametric surface. Click two points, or choose a path to a curve or between curves.";
  readonly groups = ENDS;
  override settings = new Settings({
    what: choice("The shortest path", "points", [
      ["points", "from point to point"],
      ["point-curve", "from the start to curve B"],
      ["curves", "from curve A to curve B"],
    ]),
    a: only("what", ["curves"], range("Curve A: v is", 0.15, 0, 1, 0.01, percent)),
    b: only("what", ["curves", "point-curve"], range("Curve B: v is", 0.85, 0, 1, 0.01, percent)),
    way: choice("Of all paths", "shortest", [
      ["shortest", "the shortest"],
      ["turns", "the shortest with these turns"],
    ]),
    turnsU: only("way", ["turns"], range("Turns in u", 0, -MOST_TURNS, MOST_TURNS, 1)),
    turnsV: only("way", ["turns"], range("Turns in v", 0, -MOST_TURNS, MOST_TURNS, 1)),
    minima: only("way", ["shortest"], check("Longer local minima, too", false)),
    net: check("Net of parameter lines", true),
  });
  private net: Vec3[][] = [];

  private get nurbs(): Nurbs {
    return this.bench.surface!.description as Nurbs;
  }

  override get showsPoints(): boolean {
    return this.settings.text("what") !== "curves";
  }

  override enter(): void {
    this.net = [];
    const surface = this.bench.surface!;
    if (this.nurbs.trimming_loops) return; /* lines would enter parts that are cut away */
    const lines = [0, 1].flatMap((axis) =>
      Array.from({ length: NET + 1 }, (_, i) => this.line(axis as 0 | 1, i / NET)),
    );
    const show = (net: Vec3[][]): void => {
      if (this.bench.surface !== surface) return;
      this.net = net;
      this.showNet();
    };
    void this.evaluate(lines).then(show, () => {}); /* the query reports errors */
  }

  /** Returns points of a parameter line in the domain. On axis 0, u is constant. */
  private line(axis: 0 | 1, part: number): Uv[] {
    const { u, v } = this.nurbs.domain;
    const at = ([low, high]: [number, number], t: number): number => low + t * (high - low);
    return Array.from({ length: STEPS + 1 }, (_, i) =>
      axis === 0
        ? [at(u.range, part), at(v.range, i / STEPS)]
        : [at(u.range, i / STEPS), at(v.range, part)],
    );
  }

  /** Maps polylines from the domain to the surface. */
  private async evaluate(lines: Uv[][]): Promise<Vec3[][]> {
    if (lines.length === 0) return [];
    const points = await evaluated(this.bench.api, this.bench.surface!.path, lines.flat());
    return lines.map((line) => points.splice(0, line.length));
  }

  private showNet(): void {
    this.decorate("net", this.settings.on("net") ? this.net : [], INK.cage, 1, 0);
  }

  private async locate(place: Place): Promise<Uv> {
    return (await this.bench.post<FootAnswer>("nearest", { xyz: place.xyz })).uv!;
  }

  private curve(name: "a" | "b"): { curve: DomainCurve; line: Uv[] } {
    const line = this.line(1, this.settings.number(name));
    return { curve: { iso: "v", value: line[0]![1] }, line };
  }

  async ask(): Promise<void> {
    const { bench, settings } = this;
    const options = { samples: SAMPLES, ...this.choice() };
    const what = settings.text("what");
    const curves =
      what === "points"
        ? []
        : what === "curves"
          ? [this.curve("a"), this.curve("b")]
          : [this.curve("b")];
    const found = await this.search(what, options);
    const drawn = await this.evaluate(curves.map(({ line }) => line));
    if (bench.aborted) return;
    drawn.forEach((line, i) =>
      this.lines(`curve${i}`, [line], i + 2 === drawn.length ? INK.first : INK.second, 3.5),
    );
    this.show(
      found,
      curves.map(({ line }) => line),
    );
  }

  /** Returns the members of a request that choose among the paths of all classes. */
  private choice(): object {
    const { settings, nurbs } = this;
    if (settings.text("way") === "shortest")
      return settings.on("minima") ? { all_minima: true } : {};
    const { u, v } = nurbs.domain;
    const turns = (axis: { closed: boolean }, name: string): number =>
      axis.closed ? settings.number(name) : 0;
    return { turns: [turns(u, "turnsU"), turns(v, "turnsV")] };
  }

  private async search(what: string, options: object): Promise<GeodesicAnswer> {
    const { bench } = this;
    const [from, to] = [bench.points.of("from")[0]!, bench.points.of("to")[0]!];
    bench.scene.lines.remove("curve0");
    bench.scene.lines.remove("curve1");
    if (what === "curves")
      return bench.post("curve-distance", {
        a: this.curve("a").curve,
        b: this.curve("b").curve,
        ...options,
      });
    const start = await this.locate(from);
    if (what === "point-curve")
      return bench.post("point-curve-distance", {
        point: start,
        curve: this.curve("b").curve,
        ...options,
      });
    return bench.post("path", { from: start, to: await this.locate(to), ...options });
  }

  private show(found: GeodesicAnswer, curves: Uv[][]): void {
    const { answer, units } = this.bench;
    const { u, v } = this.nurbs.domain;
    const places = (minimum: GeodesicAnswer): { uv: Uv; xyz: Vec3 }[] =>
      (minimum.points ?? []) as { uv: Uv; xyz: Vec3 }[];
    const longer = (found.minima ?? []).slice(1);
    this.lines(
      "longer",
      longer.map((minimum) => places(minimum).map(({ xyz }) => xyz)),
      INK.third,
      2,
      0.3,
    );
    const points = places(found).map(({ xyz }) => xyz);
    this.lines("path", [points], INK.path, 4);
    this.path = { length: found.length!, points };
    this.showNet();
    const drawing = domainDrawing(this.nurbs, [
      ...curves.map((points, i) => ({ points, style: i + 2 === curves.length ? "a" : "b" })),
      { points: found.control_points ?? [], style: "polygon" },
      ...longer.map((minimum) => ({
        points: places(minimum).map(({ uv }) => uv),
        style: "longer",
      })),
      { points: places(found).map(({ uv }) => uv), style: "path" },
    ]);
    answer.show(
      [
        this.main("Length", found.length!),
        { label: "Error, estimated", value: units.length(found.error_estimate!, 2) },
        { label: "A local minimum", value: found.is_minimum ? "proved" : "not proved" },
        ...(u.closed || v.closed
          ? [{ label: "Turns in u, v", value: found.turns!.join(", ") }]
          : []),
        ...(found.minima
          ? [
              {
                label: "Longer minima",
                value:
                  longer
                    .map(({ length, turns }) => `${units.length(length!, 6)} (turns ${turns})`)
                    .join(", ") || "none",
              },
            ]
          : []),
        ...(found.warnings?.length
          ? [
              {
                label: "Note",
                value: found.warnings.map((warning) => WARNINGS[warning]).join("; "),
              },
            ]
          : []),
        this.time,
      ],
      make(
        "figure",
        {},
        drawing,
        make(
          "figcaption",
          { class: "faint" },
          "The domain: the path, and its control polygon dashed",
        ),
      ),
    );
  }
}
