// Straightest geodesics from a point: a line that starts towards a second point, or a fan of lines.

import type { TraceAnswer, TraceRequest } from "../../../js/types.d.ts";
import { pointOf } from "../place.ts";
import { check, choice, range, Settings } from "../settings.ts";
import { subtract } from "../vector.ts";
import { endsOf, INK, Mode, pointsOf, XYZ } from "./mode.ts";

export class TraceMode extends Mode {
  readonly id = "trace";
  readonly title = "Straightest lines";
  readonly hint =
    "Click a start and a direction. The line goes straight on over edges and vertices.";
  readonly groups = [
    { id: "start", label: "Start", letter: "A", least: 1, most: 1, colour: INK.first },
    { id: "towards", label: "Direction", letter: "B", least: 1, most: 1, colour: INK.third },
  ];
  override settings = new Settings({
    length: range("Length", 2, 0.05, 20, 0.05, (value) => this.sizeText(value)),
    fan: range("Lines", 1, 1, 72, 1),
    rule: choice("At vertices", "bisect", [
      ["bisect", "halve the angle"],
      ["limit_normal", "stay in the normal's plane"],
    ]),
    slide: check("Slide along the boundary", false),
    cross: check("Stop where it meets itself", false),
  });

  private get request(): TraceRequest {
    const { points, surface } = this.bench;
    const [start, towards] = [points.of("start")[0]!, points.of("towards")[0]!];
    const fan = this.settings.number("fan");
    return {
      start: pointOf(start),
      ...(fan > 1 ? { fan } : { directions: [subtract(towards.xyz, start.xyz)] }),
      length: this.settings.number("length") * surface!.size,
      vertex_rule: this.settings.text("rule") as TraceRequest["vertex_rule"],
      ...(this.settings.on("slide") && { boundary_rule: "slide" }),
      ...(this.settings.on("cross") && { stop_at_self_intersection: true }),
    };
  }

  async ask(): Promise<void> {
    const { bench } = this;
    const paths = (await bench.post<TraceAnswer>("trace", this.request, XYZ)).paths!;
    const lines = paths.map(pointsOf);
    this.path = paths.length === 1 ? { length: paths[0]!.length, points: lines[0]! } : null;
    this.fan(lines);
    const total = paths.reduce((sum, path) => sum + path.length, 0);
    const crossed = paths.reduce((sum, path) => sum + (path.points?.length ?? 0), 0);
    bench.answer.show([
      this.main(paths.length > 1 ? "Length in all" : "Length", total),
      { label: paths.length > 1 ? "They end" : "It ends", value: endsOf(paths) },
      { label: "Points", value: String(crossed) },
      this.time,
    ]);
  }
}
