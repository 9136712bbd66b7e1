// Two curves through clicked points, and the distance between them.

import type {
  Curve,
  CurveDistanceAnswer,
  CurveOperationAnswer,
  CurvePlaces,
} from "../../../js/types.d.ts";
import type { Fact } from "../answer.ts";
import { type Place, pointOf } from "../place.ts";
import { check, choice, Settings } from "../settings.ts";
import { degrees } from "../units.ts";
import { activeChoice, INK, Mode, NO_PATH, pointsOf, XYZ } from "./mode.ts";

export class CurvesMode extends Mode {
  readonly id = "curves";
  readonly title = "Curve to curve";
  readonly hint =
    "Click the points of curve A, then those of curve B. Shortest paths join them in turn.";
  readonly groups = [
    { id: "a", label: "A", letter: "A", least: 2, most: 50, colour: INK.first },
    { id: "b", label: "B", letter: "B", least: 2, most: 50, colour: INK.second },
  ];
  override settings = new Settings({
    measure: choice("Distance", "min", [
      ["min", "least distance"],
      ["hausdorff", "Hausdorff distance"],
    ]),
    closed_a: check("A is closed", false),
    closed_b: check("B is closed", false),
  });

  override extras(): Node[] {
    return [
      activeChoice(this.bench.points, [
        [0, "Clicks set points of A"],
        [1, "Clicks set points of B"],
      ]),
    ];
  }

  private curve(places: Place[], closed: boolean): Curve {
    return { points: places.map(pointOf), ...(closed && { closed }) };
  }

  async ask(live: boolean): Promise<void> {
    const { bench, settings } = this;
    const a = this.curve(bench.points.of("a"), settings.on("closed_a"));
    const b = this.curve(bench.points.of("b"), settings.on("closed_b"));
    const body = { a, b, measure: settings.text("measure") };
    const lengths = [await this.draw("a", a, INK.first), await this.draw("b", b, INK.second)];
    const found = await bench.postLong<CurveDistanceAnswer>("curve-distance", body, {
      live,
      parameters: XYZ,
    });
    this.lines("path", [pointsOf(found.path)], INK.path, 4);
    this.path = found.path ? { length: found.distance!, points: pointsOf(found.path) } : null;
    this.showAnswer(found, lengths);
  }

  /** Shows a curve and returns its length. */
  private async draw(name: string, curve: Curve, colour: string): Promise<number> {
    const { path } = await this.bench.post<CurveOperationAnswer>(
      "curve",
      { curve, operation: "length" },
      XYZ,
    );
    this.lines(name, [pointsOf(path)], colour, 3.5);
    return path!.length;
  }

  private showAnswer(found: CurveDistanceAnswer, [a, b]: number[]): void {
    const { answer, units } = this.bench;
    const value = (distance?: number | null): string =>
      distance == null ? NO_PATH.value : units.length(distance, 9);
    const facts = [found.distance == null ? NO_PATH : this.main("Distance", found.distance)];
    if (found.farthest)
      facts.push(
        { label: "From A to B", value: value(found.a_to_b) },
        { label: "From B to A", value: value(found.b_to_a) },
      );
    facts.push(
      ...angles(found.closest),
      { label: "Length of A", value: units.length(a!) },
      { label: "Length of B", value: units.length(b!) },
      this.time,
    );
    answer.show(facts);
  }
}

/** Returns the angles between the shortest path and the curves: 90° except at ends and corners. */
function angles(places: CurvePlaces | undefined): Fact[] {
  if (!places) return [];
  const text = (angle: number | null): string =>
    angle === null ? "none: they meet" : degrees(angle);
  return [
    { label: "Angle with A", value: text(places.a.angle) },
    { label: "Angle with B", value: text(places.b.angle) },
  ];
}
