// Colour maps for values, and colours for the members of a set. The hues of members differ as much
// as possible. Maps that are not from d3, and the colours of members, are computed in OKLab
// (Ottosson 2020), where equal steps look equal.

import { interpolateTurbo, interpolateViridis } from "d3-scale-chromatic";

export type Rgb = [number, number, number];

/**
 * Colours at equal steps of the maps that are not from d3. coolwarm: Moreland, "Diverging Color
 * Maps for Scientific Visualization", 2009.
 */
const ANCHORS: Record<string, string[]> = {
  coolwarm: ["#3b4cc0", "#7b9ff9", "#c0d4f5", "#dddddd", "#f2cbb7", "#ee8468", "#b40426"],
  dusk: ["#1b1464", "#24569c", "#1e8e9b", "#54bf83", "#b9e06c", "#fdf5a6"],
  ember: ["#1f0c3a", "#6a1a5e", "#b93556", "#ec6d43", "#f8b44c", "#fdf3c0"],
  slate: ["#1f2933", "#4c5b68", "#8496a3", "#bccad2", "#f2f6f8"],
};

/** Functions that return the colour of each map at a value from 0 to 1. */
const RAMPS: Record<string, (part: number) => Rgb> = {
  viridis: (part) => parse(interpolateViridis(part)),
  turbo: (part) => parse(interpolateTurbo(part)),
  ...Object.fromEntries(Object.entries(ANCHORS).map(([name, anchors]) => [name, between(anchors)])),
};

export const RAMP_NAMES = Object.keys(RAMPS);

export interface Ramp {
  name: string;
  isReversed: boolean;
}

/** A colour map for the values from `low` to `high`, as fractions of the largest value. */
export interface ColourMap {
  ramp: Ramp;
  low: number;
  high: number;
}

/** Parses #rrggbb and rgb(r, g, b). */
function parse(text: string): Rgb {
  const numbers = text.startsWith("#")
    ? [1, 3, 5].map((at) => Number.parseInt(text.slice(at, at + 2), 16))
    : text.match(/\d+/g)!.map(Number);
  return numbers.map((x) => x / 255) as Rgb;
}

function between(colours: string[]): (part: number) => Rgb {
  const anchors = colours.map((colour) => toLab(parse(colour)));
  return (part) => {
    const at = part * (anchors.length - 1);
    const low = Math.min(Math.floor(at), anchors.length - 2);
    return fromLab(mix(anchors[low]!, anchors[low + 1]!, at - low));
  };
}

export function toLinear(c: number): number {
  return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
}

function fromLinear(c: number): number {
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
}

function toLab(rgb: Rgb): Rgb {
  const [r, g, b] = rgb.map(toLinear) as Rgb;
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function fromLab([lightness, a, b]: Rgb): Rgb {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear: Rgb = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((c) => Math.min(1, Math.max(0, fromLinear(Math.max(0, c))))) as Rgb;
}

const mix = (a: Rgb, b: Rgb, t: number): Rgb => a.map((x, i) => x + t * (b[i]! - x)) as Rgb;

/** Returns `size` colours of a ramp, four bytes each: red, green, blue, 255. */
export function rampBytes({ name, isReversed }: Ramp, size: number): Uint8Array<ArrayBuffer> {
  const ramp = RAMPS[name] ?? RAMPS.viridis!;
  const bytes = new Uint8Array(4 * size);
  for (let i = 0; i < size; i++) {
    const rgb = ramp((isReversed ? size - 1 - i : i) / (size - 1));
    bytes.set([...rgb.map((c) => Math.round(c * 255)), 255], 4 * i);
  }
  return bytes;
}

const GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5));

/** Returns the colour of member i of a set. All members have different hues. */
export function memberColour(i: number, lightness = 0.72): Rgb {
  const hue = 0.6 + i * GOLDEN_ANGLE;
  const light = lightness - 0.06 * (Math.floor(i / 8) % 3);
  return fromLab([light, 0.12 * Math.cos(hue), 0.12 * Math.sin(hue)]);
}

export const hexOf = (rgb: Rgb): string =>
  `#${rgb
    .map((c) =>
      Math.round(c * 255)
        .toString(16)
        .padStart(2, "0"),
    )
    .join("")}`;
