// The points that the user has set, in the groups that a mode takes.

import { compactOf, type Place } from "./place.ts";
import type { Surface } from "./surface.ts";

export interface Group {
  /** In the URL. */
  id: string;
  label: string;
  /** As many must be there before anything is asked. */
  least: number;
  /** As many are there at first; `least` if it is left out. */
  first?: number;
  most: number;
  colour: string;
}

export interface Mark {
  group: Group;
  index: number;
  place: Place;
}

/** What has changed: a mark that is being dragged changes `live`. */
export type OnChange = (live: boolean) => void;

export class Points {
  groups: Group[] = [];
  /** The one that takes the next click. */
  active = 0;
  private places: Place[][] = [];
  onChange: OnChange = () => {};
  /** Called when they are to be shown, or hidden, or not any more. */
  onLook: () => void = () => {};

  /** Other groups, without points. */
  reset(groups: Group[]): void {
    this.groups = groups;
    this.places = groups.map(() => []);
    this.active = 0;
  }

  of(id: string): Place[] {
    return this.places[this.groups.findIndex((group) => group.id === id)] ?? [];
  }

  get all(): Mark[] {
    return this.groups.flatMap((group, g) => this.places[g]!.map((place, index) => ({ group, index, place })));
  }

  get complete(): boolean {
    return this.groups.every((group, g) => this.places[g]!.length >= group.least);
  }

  labelOf({ group, index }: Mark): string {
    return group.most === 1 ? group.label : `${group.label} ${index + 1}`;
  }

  private isFull(g: number): boolean {
    return this.places[g]!.length >= this.groups[g]!.most;
  }

  /** The next group that still takes a point gets the next one. */
  private advance(): void {
    if (!this.isFull(this.active)) return;
    const next = this.groups.findIndex((_, g) => !this.isFull(g));
    if (next >= 0) this.active = next;
  }

  /**
   * A click on the surface. Where every group is full and none has more than one point, all begin anew; else the active
   * one does.
   */
  add(place: Place): Mark {
    this.advance();
    if (this.isFull(this.active)) this.restart();
    const places = this.places[this.active]!;
    places.push(place);
    const mark = { group: this.groups[this.active]!, index: places.length - 1, place };
    this.advance();
    this.onChange(false);
    return mark;
  }

  private restart(): void {
    if (this.groups.length > 1 && this.groups.every((group) => group.most === 1)) {
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

  remove(mark: Mark): void {
    this.of(mark.group.id).splice(mark.index, 1);
    this.onChange(false);
  }

  clear(): void {
    this.reset(this.groups);
    this.onChange(false);
  }

  /** Points of a group, as they are in a URL, without a word to anybody. */
  restore(id: string, text: string, surface: Surface): void {
    const g = this.groups.findIndex((group) => group.id === id);
    if (g < 0) return;
    const places = text.split(";").map((compact) => surface.parse(compact));
    this.places[g] = places.filter((place) => place !== null).slice(0, this.groups[g]!.most);
    this.advance();
  }

  set(id: string, places: Place[]): void {
    const g = this.groups.findIndex((group) => group.id === id);
    this.places[g] = places;
    this.advance();
  }

  text(id: string): string {
    return this.of(id).map(compactOf).join(";");
  }
}
