// Settings. One table declares them; controls and parameters of the address follow from it.

import { freshId, make } from "./dom.ts";
import { number } from "./units.ts";

/** A setting that is shown only while another setting has one of these values. */
interface Conditional {
  while?: { name: string; values: string[] };
}

interface Range extends Conditional {
  kind: "range";
  label: string;
  value: number;
  min: number;
  max: number;
  step: number;
  format?: (value: number) => string;
}

interface Check extends Conditional {
  kind: "check";
  label: string;
  value: boolean;
}

interface Choice extends Conditional {
  kind: "choice";
  label: string;
  value: string;
  /** Pairs of value and label. */
  options: [string, string][];
}

export type Setting = Range | Check | Choice;

export const range = (
  label: string,
  value: number,
  min: number,
  max: number,
  step: number,
  format?: Range["format"],
): Range => ({
  kind: "range",
  label,
  value,
  min,
  max,
  step,
  format,
});
export const check = (label: string, value: boolean): Check => ({ kind: "check", label, value });
export const choice = (label: string, value: string, options: [string, string][]): Choice => ({
  kind: "choice",
  label,
  value,
  options,
});

/** Returns a setting that is shown only while the setting `name` has one of these values. */
export const only = <S extends Setting>(name: string, values: string[], setting: S): S => ({
  ...setting,
  while: { name, values },
});

export class Settings {
  /** `live` is true while the user moves a slider. */
  onChange: (live: boolean) => void = () => {};
  private readonly values = new Map<string, Setting["value"]>();
  private conditions: (() => void)[] = [];
  private readonly shows = new Map<string, () => void>();

  constructor(private readonly table: Record<string, Setting>) {
    for (const [name, setting] of Object.entries(table)) this.values.set(name, setting.value);
  }

  number(name: string): number {
    return this.values.get(name) as number;
  }

  on(name: string): boolean {
    return this.values.get(name) as boolean;
  }

  text(name: string): string {
    return this.values.get(name) as string;
  }

  set(name: string, value: Setting["value"]): void {
    this.values.set(name, value);
    this.shows.get(name)?.();
    this.showConditions();
  }

  /** Returns the controls, in the order of the table. */
  elements(): HTMLElement[] {
    this.conditions = [];
    const elements = Object.entries(this.table).map(([name, setting]) => {
      const node = this.element(name, setting);
      const condition = setting.while;
      if (condition)
        this.conditions.push(
          () => (node.hidden = !condition.values.includes(String(this.values.get(condition.name)))),
        );
      return node;
    });
    this.showConditions();
    return elements;
  }

  private element(name: string, setting: Setting): HTMLElement {
    if (setting.kind === "range") return this.rangeElement(name, setting);
    return setting.kind === "check"
      ? this.checkElement(name, setting)
      : this.choiceElement(name, setting);
  }

  private showConditions(): void {
    for (const show of this.conditions) show();
  }

  private changed(name: string, value: Setting["value"], live: boolean): void {
    this.set(name, value);
    this.onChange(live);
  }

  private rangeElement(
    name: string,
    { label, min, max, step, format = number }: Range,
  ): HTMLElement {
    const id = freshId();
    const output = make("output", { for: id });
    const take = (live: boolean) => () => this.changed(name, Number(input.value), live);
    const input = make("input", {
      id,
      type: "range",
      min,
      max,
      step,
      input: take(true),
      change: take(false),
    });
    this.showWith(name, () => {
      input.value = String(this.number(name));
      output.value = format(this.number(name));
      input.setAttribute("aria-valuetext", output.value);
    });
    return make("div", { class: "range" }, make("label", { for: id }, label), output, input);
  }

  private checkElement(name: string, { label }: Check): HTMLElement {
    const input = make("input", {
      type: "checkbox",
      change: () => this.changed(name, input.checked, false),
    });
    this.showWith(name, () => (input.checked = this.on(name)));
    return make("label", { class: "check" }, input, label);
  }

  private choiceElement(name: string, { label, options }: Choice): HTMLElement {
    const id = freshId();
    const items = options.map(([value, text]) => make("option", { value }, text));
    const select = make(
      "select",
      { id, change: () => this.changed(name, select.value, false) },
      ...items,
    );
    this.showWith(name, () => (select.value = this.text(name)));
    return make("div", { class: "field" }, make("label", { for: id }, label), select);
  }

  private showWith(name: string, show: () => void): void {
    this.shows.set(name, show);
    show();
  }

  /** Returns the values that differ from the defaults of the table, for the address. */
  read(): Record<string, string> {
    const entries = Object.entries(this.table).filter(
      ([name, setting]) => this.values.get(name) !== setting.value,
    );
    return Object.fromEntries(entries.map(([name]) => [name, String(this.values.get(name))]));
  }

  /**
   * Restores values from an address. Numbers snap to a step of their slider. Missing and invalid
   * values become the defaults.
   */
  restore(parameters: URLSearchParams): void {
    for (const [name, setting] of Object.entries(this.table)) {
      const text = parameters.get(name);
      this.set(name, text === null ? setting.value : valueOf(setting, text));
    }
  }
}

function valueOf(setting: Setting, text: string): Setting["value"] {
  if (setting.kind === "check") return text === "true";
  if (setting.kind === "choice")
    return setting.options.some(([value]) => value === text) ? text : setting.value;
  const value = Number(text);
  if (!Number.isFinite(value)) return setting.value;
  const { min, max, step } = setting;
  const steps = Math.round((Math.min(max, Math.max(min, value)) - min) / step);
  return Number((min + steps * step).toFixed(9));
}
