// The shortest path between two points.

import type { PathAnswer } from "../../../js/types.d.ts";
import { pointOf } from "../place.ts";
import { ENDS, INK, Mode, pointsOf, XYZ } from "./mode.ts";

const JOB_FACES = 300000; /* a search is quick on what is smaller */

export class PairMode extends Mode {
  readonly id = "pair";
  readonly title = "Shortest path";
  readonly hint = "Click two points. Drag them, and the exact shortest path follows.";
  readonly groups = ENDS;

  async ask(live: boolean): Promise<void> {
    const { points, units, answer } = this.bench;
    const [from, to] = [points.of("from")[0]!, points.of("to")[0]!];
    const body = { from: pointOf(from), to: pointOf(to) };
    const found = await (live
      ? this.bench.post<PathAnswer>("path", body, XYZ)
      : this.bench.postLong<PathAnswer>("path", body, XYZ, JOB_FACES));
    const line = pointsOf(found.path);
    this.lines("path", [line], INK.path, 4);
    if (found.distance === null)
      return answer.show([{ label: "Distance", value: "no path: the points lie on different components", main: true }]);
    const straight = Math.hypot(...from.xyz.map((x, axis) => x - to.xyz[axis]!));
    answer.show([
      { label: "Distance", value: units.length(found.distance!, 10), main: true, title: String(found.distance) },
      { label: "Straight through space", value: units.length(straight) },
      { label: "Edges crossed", value: String(Math.max(0, line.length - 2)) },
      this.time,
    ]);
  }
}
