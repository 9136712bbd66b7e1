// Messages about work: an error with buttons for the next step, or progress with Cancel. The lines
// over the picture say what the page waits for.

import { button, make } from "./dom.ts";

export const messageOf = (error: unknown): string =>
  error instanceof Error ? error.message : String(error);

export class Notice {
  private readonly error = make("p", { role: "alert", class: "error" });
  private readonly remedy = make("div", { class: "row remedy" });
  private readonly label = make("span");
  private readonly bar = make("progress", { max: 1, "aria-label": "Progress" });
  private cancel = (): void => {};
  private readonly progress = make(
    "div",
    { class: "progress", hidden: true },
    this.label,
    this.bar,
    button("Cancel", () => this.cancel()),
  );
  readonly node = make("div", { class: "notice" }, this.error, this.remedy, this.progress);

  /** Shows a message and buttons for the next step. An empty text removes the message. */
  warn(text: string, ...remedy: Node[]): void {
    this.error.textContent = text;
    this.remedy.replaceChildren(...remedy);
  }

  /**
   * Shows a progress bar and a Cancel button until `hideProgress`. `part` is null while progress is
   * unknown.
   */
  showProgress(label: string, part: number | null, cancel: () => void): void {
    this.cancel = cancel;
    this.label.textContent = part === null ? label : `${label}, ${Math.floor(part * 100)} %`;
    if (part === null) this.bar.removeAttribute("value");
    else this.bar.value = part;
    this.progress.hidden = false;
  }

  get showsProgress(): boolean {
    return !this.progress.hidden;
  }

  hideProgress(): void {
    this.progress.hidden = true;
  }
}

export class Waits {
  private readonly lines = new Map<string, HTMLElement>();

  constructor(private readonly node: HTMLElement) {}

  /**
   * Shows a line about a subject. An empty text removes the line. `cancel` is the action of its
   * button, and is the same for all lines about this subject.
   */
  say(subject: string, text: string, cancel?: () => void): void {
    const line = this.lines.get(subject) ?? this.add(subject, cancel);
    if (line.firstChild!.textContent !== text) line.firstChild!.textContent = text;
    if (text) return;
    line.remove();
    this.lines.delete(subject);
  }

  private add(subject: string, cancel?: () => void): HTMLElement {
    const line = make("p", {}, make("span"), ...(cancel ? [button("Cancel", cancel)] : []));
    this.lines.set(subject, line);
    this.node.append(line);
    return line;
  }
}
