// The services that all modes share: the surface, its points, the picture, the panel, and the
// requests of the current query.

import { type Arrays, readArrays, writeArrays } from "../../js/index.js";
import type { ResultsAnswer } from "../../js/types.d.ts";
import type { Answer } from "./answer.ts";
import type { ColourMap } from "./colours.ts";
import { type Api, ask, Cancelled, received, type Request } from "./api.ts";
import { runJob } from "./jobs.ts";
import type { Legend } from "./legend.ts";
import { type Place, pointOf } from "./place.ts";
import type { Points } from "./points.ts";
import type { Scene } from "./scene.ts";
import type { Surface } from "./surface.ts";
import type { Units } from "./units.ts";

/* on surfaces with at least this number of faces, slow queries run as jobs, with progress and
 * Cancel */
const JOB_FACES = 20000;
/* largest number of places of a request, because the daemon reads at most 1 MiB */
const MOST_PLACES = 10000;
const SLOW = 300; /* milliseconds after which a newer query aborts a running one */

export class Bench {
  surface: Surface | undefined;
  colours: ColourMap = { ramp: { name: "viridis", isReversed: false }, low: 0, high: 1 };
  /** Duration of the last request, in milliseconds. */
  elapsed = 0;
  /** The last answer, unchanged. */
  last: unknown;
  /** The names of the daemon's meshes. */
  taken: ReadonlySet<string> = new Set();
  /** Called when a mode has created meshes. */
  onMeshes: () => Promise<void> = async () => {};
  /** Returns buttons for the next step after an error. Without `retry`, they repeat the query. */
  remedies: (error: unknown, retry?: () => unknown) => Node[] = () => [];
  /** Requests that the query depends on, such as an upload; shown before its own requests. */
  prelude: Request[] = [];
  private requests: Request[] = [];
  private running = new AbortController();
  private isJob = false;
  private begun = 0;

  constructor(
    readonly api: Api,
    readonly scene: Scene,
    readonly points: Points,
    readonly answer: Answer,
    readonly legend: Legend,
    readonly units: Units,
  ) {}

  /** Runs a query that a button has started, instead of the mode's query, and shows its errors. */
  async question(work: () => Promise<void>): Promise<boolean> {
    const signal = this.begin();
    let done = false;
    try {
      await work();
      done = true;
    } catch (error) {
      const cause: unknown = signal.aborted ? signal.reason : error;
      if (!isAbort(cause)) this.answer.warn(cause, ...this.remedies(cause, () => this.question(work)));
    }
    if (this.signal === signal) this.end();
    return done;
  }

  /** Runs work independent of the query, such as a download, and shows its errors. */
  async beside(work: () => Promise<void>): Promise<void> {
    try {
      await work();
    } catch (error) {
      if (!isAbort(error)) this.answer.warn(error, ...this.remedies(error));
    }
  }

  /** Begins a query, and aborts the previous query. Returns the signal that aborts the query. */
  begin(): AbortSignal {
    this.abort();
    this.running = new AbortController();
    this.last = undefined;
    this.requests = this.prelude.splice(0);
    this.isJob = false;
    this.begun = performance.now();
    return this.signal;
  }

  /** Ends a query and shows its requests. */
  end(): void {
    this.answer.hideProgress();
    this.answer.showRequests(this.requests);
  }

  /** The requests of the current query. */
  get made(): Request[] {
    return this.requests;
  }

  /** The signal that aborts the running query. */
  get signal(): AbortSignal {
    return this.running.signal;
  }

  /** Aborts the running query, and its job at the daemon. */
  abort(): void {
    this.running.abort();
  }

  /** Aborts the running query for the user, who is told so. Other aborts are silent. */
  cancel(): void {
    this.running.abort(new Cancelled("You have cancelled the question."));
  }

  /**
   * Called before a newer query. Aborts the running query if it is a job. If the user does not
   * drag, also aborts a query that has run for more than SLOW milliseconds.
   */
  makeWay(live: boolean): void {
    if (this.isJob || (!live && performance.now() - this.begun > SLOW)) this.abort();
  }

  get aborted(): boolean {
    return this.signal.aborted;
  }

  /** Forgets the answer and its requests. */
  forget(): void {
    this.abort();
    this.last = undefined;
    this.requests = [];
  }

  private request(query: string, more: Partial<Request>): Request {
    return { method: "POST", path: `${this.surface!.path}/${query}`, ...more };
  }

  /**
   * Sends a request of the query. Fails with status 412 if another client has replaced the surface.
   */
  private async ask(request: Request, send: Send): Promise<Response> {
    this.requests.push(request);
    const started = performance.now();
    const condition = { "If-Match": `"${this.surface!.description.etag}"` };
    const headers = { ...request.headers, ...condition };
    const response = await ask(await send({ ...request, headers }));
    this.elapsed = performance.now() - started;
    return response;
  }

  private direct(request: Request): Promise<Response> {
    const { signal } = this;
    return this.ask(request, (sent) => this.api.fetch(sent, signal));
  }

  private async parsed<T>(response: Promise<Response>): Promise<T> {
    const { signal } = this;
    const answer = (await received((await response).json(), signal)) as T;
    signal.throwIfAborted();
    this.last = answer;
    return answer;
  }

  /** Posts a query of the surface; `query` is the last part of its path. */
  async post<T>(path: string, json: unknown, query?: Record<string, string>): Promise<T> {
    return this.parsed(this.direct(this.request(path, { query, json })));
  }

  /**
   * Posts typed arrays and returns the arrays of the answer, in single precision if the lengths of
   * the surface fit.
   */
  async postArrays(path: string, arrays: Arrays): Promise<Arrays> {
    const file = { name: `${path}.arrays`, body: writeArrays(arrays) };
    const headers = { "Content-Type": "application/octet-stream" };
    const { radius } = this.surface!.frame;
    const query = { format: radius > 1e-30 && radius < 1e30 ? "f32" : "f64" };
    const { signal } = this;
    const response = await this.direct(this.request(path, { query, file, headers }));
    const answer = readArrays(await received(response.arrayBuffer(), signal));
    signal.throwIfAborted();
    return answer;
  }

  async get(path: string, query?: Record<string, string>, accept?: string): Promise<Response> {
    return this.direct(this.request(path, { method: "GET", query, accept }));
  }

  /**
   * Returns the exact distance of each place to a set, and the index of the nearest member of the
   * set. Only colours need these requests, so the page does not show them.
   */
  async nearest(set: object, places: Place[]): Promise<Nearest> {
    const found: Nearest = { values: new Float64Array(places.length), labels: [] };
    for (let at = 0; at < places.length; at += MOST_PLACES) {
      const request: Request = {
        method: "POST",
        path: `${this.surface!.path}/distance-to-set`,
        query: { select: "distance,nearest" },
        json: { set, points: places.slice(at, at + MOST_PLACES).map(pointOf) },
      };
      const { results } = await this.api.json<ResultsAnswer>(request, this.signal);
      found.values.set(results.map(({ distance }) => distance ?? NaN), at);
      for (const { nearest } of results) found.labels.push(nearest?.index ?? null);
    }
    return found;
  }

  /** Like `nearest`, for the samples of the surface. Returns null if it has no samples. */
  async nearestOfSamples(set: object): Promise<Nearest | null> {
    const { samples } = this.surface!;
    return samples && this.nearest(set, samples);
  }

  /**
   * Posts a slow query. If the surface has at least `faces` faces, the query runs as a job, except
   * during a drag.
   */
  async postLong<T>(
    path: string,
    json: unknown,
    { live = false, faces = JOB_FACES, parameters }: Long = {},
  ): Promise<T> {
    if (live || this.surface!.faceCount < faces) return this.post(path, json, parameters);
    this.isJob = true;
    const { signal } = this;
    const onProgress = (part: number): void =>
      this.answer.showProgress("Working", part, () => this.cancel());
    const request = this.request(path, { query: parameters, json });
    return this.parsed(
      this.ask(request, (sent) => runJob(this.api, sent, onProgress, signal)),
    );
  }
}

interface Nearest {
  /** NaN for a place that no path reaches. */
  values: Float64Array;
  labels: (number | null)[];
}

type Send = (request: Request) => Promise<Response>;

interface Long {
  /** Whether the query belongs to a drag. Such a query never runs as a job. */
  live?: boolean;
  faces?: number;
  parameters?: Record<string, string>;
}

export const isAbort = (error: unknown): boolean =>
  error instanceof DOMException && error.name === "AbortError";
