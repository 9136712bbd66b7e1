// What colours mean: a ramp with numbers, or members by name.

import { rampBytes } from "./colours.ts";
import { byId, make } from "./dom.ts";

const STOPS = 12;
const TICKS = 4;

function gradient(ramp: string): string {
  const bytes = rampBytes(ramp, STOPS);
  const stops = Array.from({ length: STOPS }, (_, i) => `rgb(${bytes.subarray(4 * i, 4 * i + 3).join(" ")})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

export class Legend {
  private readonly node = byId("legend");

  showRamp(title: string, ramp: string, max: number, format: (value: number) => string): void {
    const bar = make("div", { class: "ramp" });
    bar.style.background = gradient(ramp);
    const ticks = Array.from({ length: TICKS + 1 }, (_, i) => make("span", {}, format((max * i) / TICKS)));
    this.show(make("strong", {}, title), bar, make("div", { class: "ticks" }, ...ticks));
  }

  showMembers(members: { label: string; colour: string }[]): void {
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
    this.node.hidden = true;
  }
}
