// The answer in the panel: facts, errors, progress, and the requests that were sent.

import type { Request } from "./api.ts";
import { curlOf } from "./curl.ts";
import { button, byId, make } from "./dom.ts";

export interface Fact {
  label: string;
  value: string;
  /** Whether this is the main number of the answer. */
  main?: boolean;
  title?: string;
}

export class Answer {
  private readonly body = byId("answer");
  private readonly error = byId("error");
  private readonly remedy = byId("remedy");
  private readonly progress = byId("progress");
  private readonly request = byId("request");
  /** Shows the main number over the picture. */
  private readonly readout = byId("readout");
  private requests: Request[] = [];
  private readonly copyButton = button("Copy as curl", () => void this.copy(), {
    "aria-keyshortcuts": "c",
  });
  private readonly code = make("code");

  /** `hasKey` returns whether requests send an access key. */
  constructor(private readonly hasKey: () => boolean) {
    const details = make(
      "details",
      {},
      make("summary", {}, "The request"),
      make("pre", { tabindex: 0, "aria-label": "The request as curl" }, this.code),
    );
    byId("actions").prepend(this.copyButton);
    this.request.append(details);
    this.showRequests([]);
  }

  show(facts: Fact[], ...more: Node[]): void {
    this.warn("");
    const rows = facts.flatMap(({ label, value, main, title = "" }) => [
      make("dt", main ? { class: "main" } : {}, label),
      make("dd", { ...(main && { class: "main" }), title }, value),
    ]);
    this.body.replaceChildren(make("dl", {}, ...rows), ...more);
    const main = facts.find((fact) => fact.main);
    this.readout.textContent = main ? `${main.label}: ${main.value}` : "";
  }

  /**
   * Shows an error and the buttons `remedy` beside the answer, which stays valid. An empty text
   * removes the error.
   */
  warn(error: unknown, ...remedy: Node[]): void {
    this.error.textContent = error instanceof Error ? error.message : String(error);
    this.remedy.replaceChildren(...remedy);
  }

  /** Shows an error instead of the answer. */
  fail(error: unknown, ...remedy: Node[]): void {
    this.clear();
    this.warn(error, ...remedy);
  }

  clear(): void {
    this.warn("");
    this.body.replaceChildren();
    this.readout.textContent = "";
    this.showRequests([]);
  }

  /** Shows the requests of the answer. */
  showRequests(requests: Request[]): void {
    this.requests = requests;
    this.request.hidden = this.copyButton.hidden = requests.length === 0;
    this.code.textContent = this.curl();
  }

  curl(): string {
    return this.requests
      .map((request) => curlOf(request, location.origin, this.hasKey()))
      .join("\n");
  }

  async copy(): Promise<void> {
    if (this.requests.length === 0) return;
    try {
      await navigator.clipboard.writeText(this.curl());
      this.copyButton.textContent = "Copied";
    } catch {
      this.request.querySelector("details")!.open =
        true; /* the user can copy it by hand if the page may not write to the clipboard */
      this.copyButton.textContent = "Copy it from below";
    }
    setTimeout(() => (this.copyButton.textContent = "Copy as curl"), 2000);
  }

  /**
   * Shows a progress bar and a Cancel button until `hideProgress`. `part` is null while progress is
   * unknown.
   */
  showProgress(label: string, part: number | null, cancel: () => void): void {
    if (this.progress.hidden) {
      const bar = make("progress", { max: 1, "aria-label": "Progress" });
      this.progress.replaceChildren(make("span"), bar, button("Cancel", cancel));
      this.progress.hidden = false;
    }
    this.progress.querySelector("span")!.textContent =
      part === null ? label : `${label}, ${Math.floor(part * 100)} %`;
    if (part === null) this.progress.querySelector("progress")!.removeAttribute("value");
    else this.progress.querySelector("progress")!.value = part;
  }

  get showsProgress(): boolean {
    return !this.progress.hidden;
  }

  hideProgress(): void {
    this.progress.hidden = true;
  }
}
