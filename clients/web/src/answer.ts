// The part of the panel that tells what came back: facts, an error's sentence, progress, and the requests that were
// made.

import type { Request } from "./api.ts";
import { curlOf } from "./curl.ts";
import { button, byId, make } from "./dom.ts";

export interface Fact {
  label: string;
  value: string;
  /** The one that was asked for. */
  main?: boolean;
  title?: string;
}

export class Answer {
  private readonly body = byId("answer");
  private readonly error = byId("error");
  private readonly progress = byId("progress");
  private readonly request = byId("request");
  /** On phones the number that was asked for stands in the picture, too. */
  private readonly readout = byId("readout");
  private requests: Request[] = [];
  private readonly copyButton = button("Copy as curl", () => void this.copy(), { "aria-keyshortcuts": "c" });
  private readonly code = make("code");

  /** `hasKey`: requests need the access key. */
  constructor(private readonly hasKey: () => boolean) {
    const details = make(
      "details",
      {},
      make("summary", {}, "The request"),
      make("pre", { tabindex: 0, "aria-label": "The request as curl" }, this.code),
    );
    this.request.append(this.copyButton, details);
    this.request.hidden = true;
  }

  show(facts: Fact[], ...more: Node[]): void {
    this.error.textContent = "";
    const rows = facts.flatMap(({ label, value, main, title = "" }) => [
      make("dt", main ? { class: "main" } : {}, label),
      make("dd", { ...(main && { class: "main" }), title }, value),
    ]);
    this.body.replaceChildren(make("dl", {}, ...rows), ...more);
    this.readout.textContent = facts.find(({ main }) => main)?.value ?? "";
  }

  /** Shows an error, and what mends it: a button for instance. */
  fail(error: unknown, ...remedy: Node[]): void {
    this.error.textContent = error instanceof Error ? error.message : String(error);
    this.body.replaceChildren(...remedy);
    this.readout.textContent = "";
  }

  clear(): void {
    this.error.textContent = "";
    this.body.replaceChildren();
    this.readout.textContent = "";
    this.showRequests([]);
  }

  /** What made the answer that is shown. */
  showRequests(requests: Request[]): void {
    this.requests = requests;
    this.request.hidden = requests.length === 0;
    this.code.textContent = this.curl();
  }

  curl(): string {
    return this.requests.map((request) => curlOf(request, location.origin, this.hasKey())).join("\n");
  }

  async copy(): Promise<void> {
    if (this.requests.length === 0) return;
    try {
      await navigator.clipboard.writeText(this.curl());
      this.copyButton.textContent = "Copied";
    } catch {
      this.request.querySelector("details")!.open =
        true; /* where a page may not write to the clipboard it can be read */
      this.copyButton.textContent = "Copy it from below";
    }
    setTimeout(() => (this.copyButton.textContent = "Copy as curl"), 2000);
  }

  /** A bar with a way to cancel, until `hideProgress`; `part` is null while nobody knows how far it is. */
  showProgress(label: string, part: number | null, cancel: () => void): void {
    if (this.progress.hidden) {
      const bar = make("progress", { max: 1, "aria-label": "Progress" });
      this.progress.replaceChildren(make("span"), bar, button("Cancel", cancel));
      this.progress.hidden = false;
    }
    this.progress.querySelector("span")!.textContent = part === null ? label : `${label}, ${Math.floor(part * 100)} %`;
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
