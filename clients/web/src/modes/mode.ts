// What a mode is: which points it takes, what it asks, and how it shows the answer.

import type { Path } from "../../../js/types.d.ts";
import type { Bench } from "../bench.ts";
import type { Fact } from "../answer.ts";
import { button, make } from "../dom.ts";
import type { Group } from "../points.ts";
import { Settings } from "../settings.ts";
import type { Kind } from "../surface.ts";
import { milliseconds } from "../units.ts";
import type { Vec3 } from "../vector.ts";

export const INK = {
  path: "#e4572e",
  first: "#0b7a75",
  second: "#b5179e",
  third: "#c77700",
  isoline: "#10202a",
  cage: "#5b6b75",
};

/** Of modes between two points. */
export const ENDS: Group[] = [
  { id: "from", label: "Start", least: 1, most: 1, colour: INK.first },
  { id: "to", label: "End", least: 1, most: 1, colour: INK.second },
];

/** What a mode does on demand: a button below its settings. */
export const doing = (label: string, act: () => void, kind = ""): HTMLElement =>
  make("div", { class: "row extra" }, button(label, act, { class: kind }));

export abstract class Mode {
  /** In the URL. */
  abstract readonly id: string;
  abstract readonly title: string;
  /** What to do, in a sentence. */
  abstract readonly hint: string;
  abstract readonly groups: Group[];
  readonly kind: Kind = "meshes";
  settings = new Settings({});

  constructor(protected readonly bench: Bench) {}

  /**
   * Asks about the points that are there (as many as the groups want at least) and shows the answer. While something is
   * dragged it is `live`.
   */
  abstract ask(live: boolean): Promise<void>;

  /** Whether it may ask while something is dragged. */
  get followsDrag(): boolean {
    return true;
  }

  /** Whether points can be seen and moved now. */
  get showsPoints(): boolean {
    return true;
  }

  /** Controls of its own beside the settings. */
  extras(): Node[] {
    return [];
  }

  /** Called when a surface is there or has changed. */
  enter(): void {}

  /** Takes away what it shows. */
  clear(): void {
    this.bench.scene.lines.clear();
    this.bench.scene.fixedLines.clear();
    this.bench.scene.props.clear();
    this.bench.scene.skin?.clear();
    this.bench.legend.hide();
    this.bench.scene.redraw();
  }

  protected lines(name: string, polylines: Vec3[][], colour: string, width: number, hidden?: number): void {
    const view = polylines.map((line) => this.bench.scene.toView(line));
    this.bench.scene.lines.set(name, view, { colour, width, hidden });
    this.bench.scene.draw();
  }

  /** Lines of equal distance: many points, which stay until the next answer. */
  protected isolines(polylines: Vec3[][]): void {
    const { scene } = this.bench;
    const view = polylines.map((line) => scene.toView(line));
    scene.fixedLines.set("isolines", view, { colour: INK.isoline, width: 1.2, hidden: 0 });
    scene.redraw();
  }

  protected get time(): Fact {
    return {
      label: "Time",
      value: milliseconds(this.bench.elapsed),
      title: "From the request to the answer, as the page measures it",
    };
  }
}

/** The points of a path that was asked for with `geometry=xyz`. */
export const pointsOf = (path: Pick<Path, "points"> | null | undefined): Vec3[] => (path?.points ?? []) as Vec3[];

export const XYZ = { geometry: "xyz" };
