// The answer in the panel: facts, errors, progress, and the requests that were sent.

import type { Request } from "./api.ts";
import { curlOf } from "./curl.ts";
import { byId, copying, make } from "./dom.ts";
import { messageOf, Notice } from "./notice.ts";

export interface Fact {
  label: string;
  value: string;
  /** Whether this is the main number of the answer. */
  main?: boolean;
  title?: string;
}

export class Answer {
  private readonly body = byId("answer");
  /** Content that is less important than the buttons for the answer. */
  private readonly more = byId("more");
  /** Errors and progress of the query. */
  private readonly notice = new Notice();
  private readonly request = byId("request");
  /** Shows the main number over the picture. */
  private readonly readout = byId("readout");
  private requests: Request[] = [];
  /** The labels of the facts that are shown, and the elements of their values. */
  private labels = "";
  private values: HTMLElement[] = [];
  private readonly copyButton = copying("Copy as curl", () => this.curl(), {
    "aria-keyshortcuts": "c",
  });
  private readonly code = make("code");

  /** `hasKey` returns whether requests send an access key. */
  constructor(private readonly hasKey: () => boolean) {
    byId("notice").append(this.notice.node);
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
    const labels = JSON.stringify(facts.map(({ label, main }) => [label, main]));
    if (labels !== this.labels) this.build(facts);
    this.labels = labels;
    facts.forEach(({ value, title = "" }, i) => {
      const node = this.values[i]!;
      if (node.textContent !== value) node.textContent = value;
      if (node.title !== title) node.title = title;
    });
    this.more.replaceChildren(...more);
    const main = facts.find((fact) => fact.main);
    this.readout.textContent = main ? `${main.label}: ${main.value}` : "";
  }

  /**
   * Makes the list of facts. While the user drags, only the values change, because this costs less
   * than a new list.
   */
  private build(facts: Fact[]): void {
    const kind = ({ main }: Fact): { class?: string } => (main ? { class: "main" } : {});
    this.values = facts.map((fact) => make("dd", kind(fact)));
    const rows = facts.flatMap((fact, i) => [make("dt", kind(fact), fact.label), this.values[i]!]);
    this.body.replaceChildren(make("dl", {}, ...rows));
  }

  /**
   * Shows an error and the buttons `remedy` beside the answer, which stays valid. An empty text
   * removes the error.
   */
  warn(error: unknown, ...remedy: Node[]): void {
    this.notice.warn(messageOf(error), ...remedy);
  }

  clear(): void {
    this.warn("");
    this.hideProgress();
    this.body.replaceChildren();
    this.labels = "";
    this.more.replaceChildren();
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

  /** Copies the requests, as the button does. */
  copy(): void {
    if (this.requests.length > 0) this.copyButton.click();
  }

  showProgress(label: string, part: number | null, cancel: () => void): void {
    this.notice.showProgress(label, part, cancel);
    this.body.ariaBusy = "true";
  }

  get showsProgress(): boolean {
    return this.notice.showsProgress;
  }

  hideProgress(): void {
    this.notice.hideProgress();
    this.body.ariaBusy = "false";
  }
}
