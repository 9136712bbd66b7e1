// Shows memory and cache of the daemon, from /v1 and /metrics, while its part of the panel is open.

import type { Service } from "../../js/types.d.ts";
import { type Api, received } from "./api.ts";
import { byId, make } from "./dom.ts";
import { bytes, number, whole } from "./units.ts";

const PERIOD = 2000; /* milliseconds between reads */

const CLASSES: [string, string][] = [
  ["meshes", "Meshes"],
  ["fields", "Fields"],
  ["landmarks", "Landmarks"],
  ["discretizations", "Discretizations"],
  ["flight", "Running work"],
  ["answers", "Answers being sent"],
  ["records", "Descriptions and records"],
  ["workspaces", "Workspaces"],
  ["jobs", "Answers of jobs"],
  ["spare", "Spare"],
];

/** Parses the Prometheus text format. Returns the values by name and labels. */
function parse(text: string): Map<string, number> {
  const lines = text.split("\n").filter((line) => line && !line.startsWith("#"));
  return new Map(
    lines.map((line) => [
      line.slice(0, line.lastIndexOf(" ")),
      Number(line.slice(line.lastIndexOf(" ") + 1)),
    ]),
  );
}

export class ServicePanel {
  private readonly node = byId<HTMLDetailsElement>("service");
  private readonly body = make("div");
  private service: Service | undefined;
  private timer = 0;

  constructor(private readonly api: Api) {
    this.node.append(this.body);
    this.node.addEventListener("toggle", () => void this.refresh());
  }

  private async refresh(): Promise<void> {
    clearTimeout(this.timer);
    if (!this.node.open) return;
    try {
      this.service ??= await this.api.get<Service>("/v1");
      const response = await this.api.send({ method: "GET", path: "/metrics" });
      this.show(this.service, parse(await received(response.text())));
    } catch (error) {
      this.body.replaceChildren(make("p", { class: "faint" }, (error as Error).message));
    }
    clearTimeout(this.timer); /* a second refresh may have started meanwhile */
    this.timer = setTimeout(() => void this.refresh(), PERIOD);
  }

  private show(service: Service, samples: Map<string, number>): void {
    const of = (name: string): number => samples.get(`geodesicd_${name}`) ?? 0;
    const held = CLASSES.map(([name, label]) => ({
      label,
      size: of(`memory_bytes{class="${name}"}`),
    })).filter(({ size }) => size > 0);
    if (!samples.has('geodesicd_memory_bytes{class="meshes"}')) {
      const text = "Only an access key with the role operator can read these numbers.";
      return this.body.replaceChildren(make("p", { class: "faint" }, text));
    }
    const total = held.reduce((sum, { size }) => sum + size, 0);
    const budget = service.limits.memory_budget_bytes;
    const meter = make("meter", {
      min: 0,
      max: budget,
      value: total,
      "aria-label": "Memory in use",
    });
    this.body.replaceChildren(
      make("p", {}, `${bytes(total)} of ${bytes(budget)} in use`),
      meter,
      list(held.map(({ label, size }) => [label, bytes(size)])),
      list(this.cacheFacts(of, service)),
    );
  }

  private cacheFacts(of: (name: string) => number, service: Service): [string, string][] {
    const [hits, misses] = [of("cache_hits_total"), of("cache_misses_total")];
    return [
      ["Fields in the cache", whole(of("cache_fields"))],
      [
        "Found in the cache",
        hits + misses
          ? `${number((100 * hits) / (hits + misses), 3)} % of ${whole(hits + misses)}`
          : "no questions yet",
      ],
      ["Evicted", whole(of("cache_evictions_total"))],
      ["Pairs searched", whole(of("searches_total"))],
      [
        "Workers busy",
        `${of("workers_busy")} of ${service.limits.workers}, ${of("queue_depth")} waiting`,
      ],
      ["Jobs", `${of('jobs{state="running"}')} running, ${of('jobs{state="queued"}')} queued`],
      ["Version", service.version],
    ];
  }
}

function list(rows: [string, string][]): HTMLElement {
  return make(
    "dl",
    {},
    ...rows.flatMap(([label, value]) => [make("dt", {}, label), make("dd", {}, value)]),
  );
}
