// The shortest path between two points, through further points if the user has set some.

import type { PathAnswer } from "../../../js/types.d.ts";
import { daemonFile, type FileOffer } from "../files.ts";
import { pointOf } from "../place.ts";
import type { Group } from "../points.ts";
import { activeChoice, ENDS, INK, Mode, NO_PATH, pointsOf, XYZ } from "./mode.ts";

const JOB_FACES = 300000; /* on meshes with at least this number of faces, paths run as jobs */

const VIA: Group = {
  id: "via",
  label: "Via",
  least: 0,
  most: 20,
  colour: INK.third,
  isOptional: true,
};

export class PairMode extends Mode {
  readonly id = "pair";
  readonly title = "Shortest path";
  readonly hint =
    "Click two points and drag them. Shift+click, or the choice below, adds points on the way.";
  readonly groups = [...ENDS, VIA];

  override extras(): Node[] {
    return [
      activeChoice(this.bench.points, [
        [0, "Clicks set A and B"],
        [2, "Clicks add points on the way"],
      ]),
    ];
  }

  private get request(): object {
    const { points } = this.bench;
    const via = points.of("via").map(pointOf);
    const [from, to] = [points.of("from")[0]!, points.of("to")[0]!];
    return { from: pointOf(from), to: pointOf(to), ...(via.length > 0 && { via }) };
  }

  async ask(live: boolean): Promise<void> {
    const { points, units, answer } = this.bench;
    const [from, to] = [points.of("from")[0]!, points.of("to")[0]!];
    const long = { live, faces: JOB_FACES, parameters: XYZ };
    const found = await this.bench.postLong<PathAnswer>("path", this.request, long);
    const line = pointsOf(found.path);
    this.lines("path", [line], INK.path, 4);
    this.path = found.path ? { length: found.distance!, points: line } : null;
    if (found.distance === null) return answer.show([NO_PATH]);
    const straight = Math.hypot(...from.xyz.map((x, axis) => x - to.xyz[axis]!));
    answer.show([
      this.main("Distance", found.distance!),
      { label: "Straight through space", value: units.length(straight) },
      { label: "Edges crossed", value: String(Math.max(0, line.length - 2)) },
      this.time,
    ]);
  }

  /** Adds an SVG file, in which the daemon unfolds the faces of the path into the plane. */
  override files(): FileOffer[] {
    const path = `${this.bench.surface!.path}/path`;
    const request = { method: "POST", path, query: { format: "svg" }, json: this.request } as const;
    const others = super.files().filter(({ ending }) => ending !== "svg");
    return [...others, daemonFile(this.bench, "SVG, unfolded", "svg", request)];
  }
}
