// The points that the user has set, in the groups of the mode.

import { compactOf, type Place } from "./place.ts";
import type { Scene } from "./scene.ts";
import type { Surface } from "./surface.ts";

/**
 * Start points lie on a ring of RING points about the middle of the picture. RADII, as fractions of
 * the picture, are tried in order until the point hits the surface.
 */
const RING = 6;
const RADII = [0.3, 0.22, 0.14, 0.07, 0];

/**
 * Returns the i-th point that a mode begins with, or null if the picture shows no surface there.
 */
export function startPlace(scene: Scene, i: number): Place | null {
  const { x, y } = scene.size;
  const angle = 2.4 + (2 * Math.PI * (i % RING)) / RING;
  for (const part of RADII) {
    const radius = part * Math.min(x, y) * (i < RING ? 1 : 0.5);
    const place = scene.pick({
      x: x / 2 + radius * Math.cos(angle),
      y: y / 2 + radius * Math.sin(angle),
    });
    if (place) return place;
  }
  return null;
}

export interface Group {
  /** The group's parameter of the address. */
  id: string;
  label: string;
  /** The label in the picture, before the number of the point if the group has several. */
  letter?: string;
  /** Number of points that the query needs. */
  least: number;
  /** Number of points at the start of the mode; `least` by default. */
  first?: number;
  most: number;
  colour: string;
  /** Whether plain clicks do not add points to the group. */
  isOptional?: boolean;
}

export interface Mark {
  group: Group;
  index: number;
  place: Place;
}

/** `live` is true while a point is dragged. */
export type OnChange = (live: boolean) => void;

export class Points {
  groups: Group[] = [];
  /** The index of the group to which the next click adds a point. */
  active = 0;
  private places: Place[][] = [];
  onChange: OnChange = () => {};
  /** Called when the look of the points changes. */
  onLook: () => void = () => {};

  /** Sets new groups, without points. */
  reset(groups: Group[]): void {
    this.groups = groups;
    this.places = groups.map(() => []);
    this.active = 0;
  }

  of(id: string): Place[] {
    return this.places[this.groups.findIndex((group) => group.id === id)] ?? [];
  }

  get all(): Mark[] {
    return this.groups.flatMap((group, g) =>
      this.places[g]!.map((place, index) => ({ group, index, place })),
    );
  }

  get complete(): boolean {
    return this.groups.every((group, g) => this.places[g]!.length >= group.least);
  }

  labelOf({ group, index }: Mark): string {
    return group.most === 1 ? group.label : `${group.letter ?? `${group.label} `}${index + 1}`;
  }

  private isFull(g: number): boolean {
    return this.places[g]!.length >= this.groups[g]!.most;
  }

  /** If the active group is full, activates the first group that is not full. */
  private advance(): void {
    if (!this.isFull(this.active)) return;
    const next = this.groups.findIndex((group, g) => !this.isFull(g) && !group.isOptional);
    if (next >= 0) this.active = next;
  }

  /** The index of the mode's optional group, or undefined. */
  get optional(): number | undefined {
    const g = this.groups.findIndex((group) => group.isOptional);
    return g < 0 ? undefined : g;
  }

  /**
   * Adds a point to a group, by default to the active group. If all groups are full, first removes
   * the points of the active group. If each group takes only one point, removes the points of all
   * groups instead.
   */
  add(place: Place, to?: number): Mark {
    if (to !== undefined) return this.append(place, to);
    this.advance();
    if (this.isFull(this.active)) this.restart();
    return this.append(place, this.active);
  }

  private append(place: Place, g: number): Mark {
    const places = this.places[g]!;
    places.push(place);
    const mark = { group: this.groups[g]!, index: places.length - 1, place };
    this.advance();
    this.onChange(false);
    return mark;
  }

  private restart(): void {
    if (
      this.groups.length > 1 &&
      this.groups.every((group) => group.most === 1 || group.isOptional)
    ) {
      this.places = this.groups.map(() => []);
      this.active = 0;
    } else {
      this.places[this.active] = [];
    }
  }

  move(mark: Mark, place: Place, live: boolean): void {
    mark.place = place;
    const places = this.of(mark.group.id);
    if (mark.index < places.length) places[mark.index] = place;
    this.onChange(live);
  }

  /** Replaces each place by another form of the same point. Does not call `onChange`. */
  async map(change: (place: Place) => Promise<Place>): Promise<void> {
    for (const places of this.places) {
      for (const [i, place] of places.entries()) {
        const changed = await change(place);
        if (places[i] === place) places[i] = changed;
      }
    }
  }

  remove(mark: Mark): void {
    this.of(mark.group.id).splice(mark.index, 1);
    this.onChange(false);
  }

  clear(): void {
    this.reset(this.groups);
    this.onChange(false);
  }

  /** Sets the points of a group from an address. Does not call `onChange`. */
  restore(id: string, text: string, surface: Surface): void {
    const g = this.groups.findIndex((group) => group.id === id);
    if (g < 0) return;
    const places = text.split(";").map((compact) => surface.parse(compact));
    this.places[g] = places.filter((place) => place !== null).slice(0, this.groups[g]!.most);
    this.advance();
  }

  /** Sets the points of a group. Does not call `onChange`. */
  set(id: string, places: Place[]): void {
    const g = this.groups.findIndex((group) => group.id === id);
    this.places[g] = places;
    this.advance();
  }

  text(id: string): string {
    return this.of(id).map(compactOf).join(";");
  }
}
