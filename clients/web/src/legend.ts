// The legend: a colour map with numbers, or the members of a set by name.

import { type ColourMap, rampBytes } from "./colours.ts";
import { byId, make } from "./dom.ts";

const STOPS = 24;
const TICKS = 4;

interface Scale {
  title: string;
  max: number;
  format: (value: number) => string;
}

/** Returns the numbers of a colour map at equal steps, in ascending order. */
export function ticksOf(colours: ColourMap, { max, format }: Scale): string[] {
  const { low, high } = colours;
  return Array.from({ length: TICKS + 1 }, (_, i) =>
    format(max * (low + ((high - low) * i) / TICKS)),
  );
}

/** Returns CSS colours of a ramp at equal steps. */
export function stopsOf({ ramp }: ColourMap): string[] {
  const bytes = rampBytes(ramp, STOPS);
  return Array.from(
    { length: STOPS },
    (_, i) => `rgb(${bytes.subarray(4 * i, 4 * i + 3).join(" ")})`,
  );
}

export class Legend {
  private readonly node = byId("legend");
  private readonly needle = make("div", { class: "needle", hidden: true });
  private readonly reading = make("output");
  /** The scale that the legend shows; undefined if it shows none. */
  scale: Scale | undefined;
  private colours: ColourMap | undefined;
  private ticks: HTMLElement[] = [];

  showRamp(scale: Scale, colours: ColourMap): void {
    if (this.scale?.title !== scale.title || this.colours !== colours) this.build(scale, colours);
    [this.scale, this.colours] = [scale, colours];
    ticksOf(colours, scale).forEach((tick, i) => (this.ticks[i]!.textContent = tick));
  }

  /**
   * Makes the scale. While the user drags, only the numbers change, because this costs less than a
   * new scale.
   */
  private build(scale: Scale, colours: ColourMap): void {
    const bar = make("div", { class: "ramp" }, this.needle);
    bar.style.background = `linear-gradient(to right, ${stopsOf(colours).join(", ")})`;
    this.ticks = Array.from({ length: TICKS + 1 }, () => make("span"));
    const title = make("div", { class: "title" }, make("strong", {}, scale.title), this.reading);
    this.show(title, bar, make("div", { class: "ticks" }, ...this.ticks));
  }

  /** Changes the colours of the current scale. */
  recolour(colours: ColourMap): void {
    if (this.scale) this.showRamp(this.scale, colours);
  }

  /** Marks a value on the scale; null removes the mark. */
  point(value: number | null): void {
    if (!this.scale || !this.colours) return;
    this.needle.hidden = value === null;
    this.reading.value = value === null ? "" : this.scale.format(value);
    if (value === null) return;
    const { low, high } = this.colours;
    const part = (value / this.scale.max - low) / (high - low);
    this.needle.style.left = `${100 * Math.min(1, Math.max(0, part))}%`;
  }

  showMembers(members: { label: string; colour: string }[]): void {
    this.scale = undefined;
    const items = members.map(({ label, colour }) => {
      const swatch = make("span", { class: "swatch" });
      swatch.style.background = colour;
      return make("li", {}, swatch, label);
    });
    this.show(make("ul", {}, ...items));
  }

  private show(...contents: HTMLElement[]): void {
    this.node.replaceChildren(...contents);
    this.node.hidden = false;
  }

  hide(): void {
    this.scale = undefined;
    this.node.hidden = true;
  }
}
