// A mode: its groups of points, its query, and the display of the answer.

import type { Path } from "../../../js/types.d.ts";
import type { Bench } from "../bench.ts";
import type { Fact } from "../answer.ts";
import { hexOf, memberColour } from "../colours.ts";
import { button, make } from "../dom.ts";
import { type FileOffer, lineFiles } from "../files.ts";
import type { Place } from "../place.ts";
import type { Group, Points } from "../points.ts";
import { Settings } from "../settings.ts";
import type { Kind } from "../surface.ts";
import { milliseconds, number } from "../units.ts";
import type { Vec3 } from "../vector.ts";

export const INK = {
  path: "#e4572e",
  first: "#0b7a75",
  second: "#b5179e",
  third: "#a85f00",
  isoline: "#10202a",
  cage: "#5b6b75",
};

/** The groups of modes that need a start and an end. */
export const ENDS: Group[] = [
  { id: "from", label: "Start", letter: "A", least: 1, most: 1, colour: INK.first },
  { id: "to", label: "End", letter: "B", least: 1, most: 1, colour: INK.second },
];

/** Returns a row with a button, which is shown below the settings of a mode. */
export const actionRow = (label: string, act: () => void, kind = ""): HTMLElement =>
  make("div", { class: "row extra" }, button(label, act, { class: kind }));

/**
 * Returns a control that chooses the group to which the next click adds a point. `groups` has the
 * indices and labels of the groups.
 */
export function activeChoice(points: Points, groups: [number, string][]): HTMLElement {
  const rows = groups.map(([g, label]) => {
    const input = make("input", {
      type: "radio",
      name: "active",
      value: g,
      checked: g === points.active,
      change: () => (points.active = g),
    });
    return make("label", { class: "check" }, input, label);
  });
  return make("fieldset", {}, make("legend", { class: "unseen" }, "Clicks set"), ...rows);
}

/** A path that the user can keep. */
export interface Line {
  length: number;
  points: Vec3[];
}

export abstract class Mode {
  /** The value of `mode` in the address. */
  abstract readonly id: string;
  abstract readonly title: string;
  /** A sentence that says what the user can do next. */
  abstract readonly hint: string;
  abstract readonly groups: Group[];
  readonly kind: Kind = "meshes";
  settings = new Settings({});
  /** The path of the answer, if it has exactly one. */
  path: Line | null = null;
  private readonly shown = new Map<string, Vec3[][]>();

  constructor(protected readonly bench: Bench) {}

  /**
   * Sends the query and shows the answer. Each group has at least `least` points. `live` is true
   * while a point is dragged.
   */
  abstract ask(live: boolean): Promise<void>;

  /** Whether the mode sends queries while a point is dragged. */
  get followsDrag(): boolean {
    return true;
  }

  /** Whether points are visible and can be moved now. */
  get showsPoints(): boolean {
    return true;
  }

  /** Returns controls that the mode has besides its settings. */
  extras(): Node[] {
    return [];
  }

  /** Called when the mode begins, and when another surface is shown. */
  enter(): void {}

  /** Returns the value that the colour at a place represents, or null if there is none. */
  valueAt(_place: Place, _signal: AbortSignal): Promise<number | null> {
    return Promise.resolve(null);
  }

  /** Returns the files of the current answer. */
  files(): FileOffer[] {
    return lineFiles(
      this.bench,
      [...this.shown.values()].flat().filter((line) => line.length > 1),
    );
  }

  /** Removes everything that the mode shows. */
  clear(): void {
    this.path = null;
    this.clearLines();
    this.bench.scene.fixedLines.clear();
    this.bench.scene.props.clear();
    this.bench.scene.skin?.clear();
    this.bench.scene.skin?.setIsolines(0);
    this.bench.legend.hide();
    this.bench.scene.redraw();
  }

  protected clearLines(): void {
    this.shown.clear();
    this.bench.scene.lines.clear();
  }

  /** Shows polylines of the answer under a name. The files of the answer include them. */
  protected lines(
    name: string,
    polylines: Vec3[][],
    colour: string,
    width: number,
    hidden?: number,
  ): void {
    this.shown.set(name, polylines);
    this.decorate(name, polylines, colour, width, hidden);
  }

  /** Shows polylines that are not part of the answer. */
  protected decorate(
    name: string,
    polylines: Vec3[][],
    colour: string,
    width: number,
    hidden?: number,
  ): void {
    const view = polylines.map((line) => this.bench.scene.toView(line));
    this.bench.scene.lines.set(name, view, { colour, width, hidden });
    this.bench.scene.draw();
  }

  /** Shows exact isolines. They have many points and stay until the next answer. */
  protected isolines(polylines: Vec3[][]): void {
    const { scene } = this.bench;
    const view = polylines.map((line) => scene.toView(line));
    scene.fixedLines.set("isolines", view, { colour: INK.isoline, width: 1.2, hidden: 0 });
    scene.redraw();
  }

  /** Shows one path in the colour of answers, or several in different colours. */
  protected fan(paths: Vec3[][]): void {
    this.clearLines();
    if (paths.length === 1) return this.lines("line", paths, INK.path, 4);
    paths.forEach((path, i) => this.lines(`line${i}`, [path], hexOf(memberColour(i, 0.6)), 2.5));
  }

  /** Returns a length as the main number of the answer. The title has all its digits. */
  protected main(label: string, length: number): Fact {
    const value = this.bench.units.length(length, 10);
    return { label, value, main: true, title: String(length) };
  }

  /** Returns the text of a length that is given in multiples of the surface's size. */
  protected sizeText(value: number): string {
    const { surface, units } = this.bench;
    return surface ? units.length(value * surface.size, 4) : number(value);
  }

  protected get time(): Fact {
    return {
      label: "Time",
      value: milliseconds(this.bench.elapsed),
      title: "From the request to the answer, measured by the page",
    };
  }
}

/** Returns the points of a path that was requested with `geometry=xyz`. */
export const pointsOf = (path: Pick<Path, "points"> | null | undefined): Vec3[] =>
  (path?.points ?? []) as Vec3[];

const END_REASONS: Record<string, string> = {
  length: "at the chosen length",
  boundary: "at the boundary",
  self_intersection: "where it meets itself",
  singular: "at a singular point, such as an extraordinary vertex",
  step_limit: "after too many steps",
};

/** Returns the text that tells the user where geodesics end. */
export const endsOf = (paths: { end_reason: string }[]): string =>
  [...new Set(paths.map(({ end_reason: reason }) => END_REASONS[reason] ?? reason))].join(", or ");

/** The answer for points that no path joins. */
export const NO_PATH: Fact = {
  label: "Distance",
  value: "no path: the points lie on different components",
  main: true,
};

export const XYZ = { geometry: "xyz" };
