// Formats lengths in the unit that the user chooses, bytes, counts and times.

/** Length of each unit in metres. Files do not name their unit, so the user chooses it. */
const METRES: Record<string, number> = {
  mm: 0.001,
  cm: 0.01,
  m: 1,
  km: 1000,
  in: 0.0254,
  ft: 0.3048,
};

export const UNITS = ["units", ...Object.keys(METRES)];

export class Units {
  /** The unit of the file. */
  file = "units";
  /** The unit that the user wants to see. */
  shown = "units";

  private get factor(): number {
    return METRES[this.file] && METRES[this.shown] ? METRES[this.file]! / METRES[this.shown]! : 1;
  }

  /** The unit that the page shows. Without the file's unit, lengths cannot be converted. */
  get name(): string {
    return METRES[this.file] ? (METRES[this.shown] ? this.shown : this.file) : "units";
  }

  length(value: number, digits = 6): string {
    return `${this.bare(value, digits)} ${this.name}`;
  }

  /** Returns the number without the unit. */
  bare(value: number, digits = 6): string {
    return number(value * this.factor, digits);
  }

  area(value: number): string {
    return `${number(value * this.factor ** 2, 5)} ${this.name}²`;
  }
}

/** Formats to `digits` significant digits. Uses a power of ten if the plain form would be long. */
export function number(value: number, digits = 6): string {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e9))
    return value
      .toExponential(digits - 1)
      .replace("e-", "e−")
      .replace("e+", "e");
  return value
    .toLocaleString("en", { maximumSignificantDigits: digits })
    .replace("-", "−")
    .replaceAll(",", "\u202f");
}

export const whole = (value: number): string =>
  value.toLocaleString("en").replaceAll(",", "\u202f");

export function bytes(count: number): string {
  const names = ["B", "KiB", "MiB", "GiB", "TiB"];
  let unit = 0;
  for (; count >= 1024 && unit < names.length - 1; unit++) count /= 1024;
  return `${number(count, 3)} ${names[unit]}`;
}

export function milliseconds(ms: number): string {
  return ms >= 1000 ? `${number(ms / 1000, 3)} s` : `${number(ms, ms < 10 ? 2 : 3)} ms`;
}

/** Formats an angle. Shows rounding errors as zero. */
export function degrees(radians: number): string {
  const angle = (radians * 180) / Math.PI;
  return `${number(Math.abs(angle) < 1e-9 ? 0 : angle, 5)}°`;
}
