// A geodesic Hermite spline through clicked points, with an object that moves along it.

import type { SplineAnswer, SplineRequest } from "../../../js/types.d.ts";
import { type Frame, Glider } from "../glider.ts";
import { pointOf } from "../place.ts";
import { check, choice, range, Settings } from "../settings.ts";
import { degrees, whole } from "../units.ts";
import type { Vec3 } from "../vector.ts";
import { INK, Mode, pointsOf, XYZ } from "./mode.ts";

const SAMPLES = 32; /* points per segment */

export class SplineMode extends Mode {
  readonly id = "spline";
  readonly title = "Hermite spline";
  readonly hint = "Click points, drag them: a smooth curve on the surface goes through them.";
  readonly groups = [
    { id: "points", label: "Point", least: 2, first: 5, most: 60, colour: INK.third },
  ];
  private readonly glider = new Glider(this.bench.scene);
  override settings = new Settings({
    closed: check("Closed", false),
    alpha: range("Alpha (0 uniform, 0.5 centripetal, 1 chordal)", 0.5, 0, 1, 0.05),
    tension: range("Tension (1: a geodesic polyline)", 0, 0, 1, 0.05),
    rule: choice("Tangents", "symmetric", [
      ["symmetric", "symmetric"],
      ["paper", "paper: chords moved in parallel"],
    ]),
    move: check(
      "An object moves along it",
      !matchMedia("(prefers-reduced-motion: reduce)").matches,
    ),
    control: check("Control polygons", false),
  });

  private get request(): SplineRequest {
    const { settings } = this;
    return {
      points: this.bench.points.of("points").map(pointOf),
      closed: settings.on("closed"),
      alpha: settings.number("alpha"),
      tension: settings.number("tension"),
      tangent_rule: settings.text("rule") as SplineRequest["tangent_rule"],
      samples: SAMPLES,
      speed: "constant",
      frames: settings.on("move"),
    };
  }

  async ask(): Promise<void> {
    const { bench } = this;
    const found = await bench.post<SplineAnswer>("spline", this.request, XYZ);
    this.lines("curve", [pointsOf(found.path)], INK.path, 4);
    this.path = { length: found.path!.length, points: pointsOf(found.path) };
    this.showControl(found);
    if (found.frames) this.glider.follow(found.frames as Frame[]);
    else this.glider.stop();
    const jump = Math.max(0, ...found.joints!.map((joint) => joint.angle_jump));
    const clipped = found.segments!.filter((segment) => segment.clipped).length;
    bench.answer.show([
      this.main("Length", found.path!.length),
      {
        label: "Segments",
        value:
          whole(found.segments!.length) + (clipped ? `, ${clipped} clipped at the boundary` : ""),
      },
      { label: "Largest angle at a joint", value: degrees(jump) },
      { label: "Points of the path", value: whole(found.path!.points!.length) },
      this.time,
    ]);
  }

  /** Shows the control polygons, which are straight lines through space. */
  private showControl(found: SplineAnswer): void {
    const polygons = found.segments!.map((segment) =>
      segment.control_points.map((point) => point.xyz as Vec3),
    );
    this.decorate("control", this.settings.on("control") ? polygons : [], INK.first, 1.5, 0.6);
  }

  override clear(): void {
    this.glider.stop();
    super.clear();
  }
}
