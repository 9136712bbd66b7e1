// What every mode works with: the surface, its points, the picture, the panel, and calls that belong to the present
// question.

import type { ResultsAnswer } from "../../js/types.d.ts";
import type { Answer } from "./answer.ts";
import { type Api, errorOf, type Request } from "./api.ts";
import { runJob } from "./jobs.ts";
import type { Legend } from "./legend.ts";
import { pointOf } from "./place.ts";
import type { Points } from "./points.ts";
import type { Scene } from "./scene.ts";
import type { Surface } from "./surface.ts";
import type { Units } from "./units.ts";

/** From so many faces on what takes long is a job, with progress and a way to cancel. */
const JOB_FACES = 20000;
const SLOW = 300; /* milliseconds after which a question is dropped for a newer one */

export interface Display {
  ramp: string;
}

export class Bench {
  surface: Surface | undefined;
  /** How long the last answer took, in milliseconds. */
  elapsed = 0;
  /** The last answer, as it came. */
  last: unknown;
  /** The names of the daemon's meshes. */
  taken: ReadonlySet<string> = new Set();
  /** Called when a mode has made meshes. */
  onMeshes: () => void = () => {};
  /** What came before the next question and belongs to it: an upload, a discretization. */
  prelude: Request[] = [];
  private requests: Request[] = [];
  private running: AbortController | undefined;
  private isJob = false;
  private begun = 0;

  constructor(
    readonly api: Api,
    readonly scene: Scene,
    readonly points: Points,
    readonly answer: Answer,
    readonly legend: Legend,
    readonly units: Units,
    readonly display: Display,
  ) {}

  /** What is asked beside the mode's own question, at the press of a button; its problems are shown. */
  async question(work: () => Promise<void>): Promise<boolean> {
    this.abort();
    this.begin();
    let done = false;
    try {
      await work();
      done = true;
    } catch (error) {
      if (!isAbort(error)) this.answer.fail(error);
    }
    this.end();
    return done;
  }

  /** Begins a question. */
  begin(): void {
    this.running = new AbortController();
    this.requests = this.prelude.splice(0);
    this.isJob = false;
    this.begun = performance.now();
  }

  /** Ends it: the requests that it made are shown. */
  end(): void {
    this.answer.hideProgress();
    this.answer.showRequests(this.requests);
  }

  /** The requests of the question. */
  get made(): Request[] {
    return this.requests;
  }

  /** Drops the question under way; its work at the daemon, too, if it is a job. */
  abort(): void {
    this.running?.abort();
  }

  /** Makes way for something newer: a job is not waited for, nor what takes long while nothing is dragged. */
  makeWay(live: boolean): void {
    if (this.isJob || (!live && performance.now() - this.begun > SLOW)) this.abort();
  }

  get aborted(): boolean {
    return this.running?.signal.aborted ?? false;
  }

  private async timed(request: Request, send: () => Promise<Response>): Promise<Response> {
    this.requests.push(request);
    const started = performance.now();
    const response = await send();
    if (!response.ok) throw await errorOf(response);
    this.elapsed = performance.now() - started;
    return response;
  }

  private async parsed<T>(response: Response): Promise<T> {
    const answer = (await response.json()) as T;
    this.running?.signal.throwIfAborted();
    this.last = answer;
    return answer;
  }

  /** A question of the surface: `query` is what stands behind its name. */
  async post<T>(query: string, json: unknown, parameters?: Record<string, string>): Promise<T> {
    const request: Request = { method: "POST", path: `${this.surface!.path}/${query}`, query: parameters, json };
    return this.parsed(await this.timed(request, () => this.api.fetch(request, this.running?.signal)));
  }

  async get(path: string, parameters?: Record<string, string>, accept?: string): Promise<Response> {
    const request: Request = { method: "GET", path: `${this.surface!.path}/${path}`, query: parameters, accept };
    return this.timed(request, () => this.api.fetch(request, this.running?.signal));
  }

  /**
   * The exact distances to a set, and the nearest member, at the vertices of the finer mesh of a coarse one. Only the
   * picture needs them: they are not among the requests that are shown.
   */
  async fineDistances(set: object): Promise<{ values: Float64Array; labels: (number | null)[] } | null> {
    const { fine } = this.surface!;
    if (!fine) return null;
    const request: Request = {
      method: "POST",
      path: `${this.surface!.path}/distance-to-set`,
      query: { select: "distance,nearest" },
      json: { set, points: fine.places.map(pointOf) },
    };
    const { results } = await this.api.json<ResultsAnswer>(request, this.running?.signal);
    return {
      values: Float64Array.from(results, ({ distance }) => distance ?? NaN),
      labels: results.map(({ nearest }) => nearest?.index ?? null),
    };
  }

  /** A question that may take long; from so many faces on a job. */
  async postLong<T>(query: string, json: unknown, parameters?: Record<string, string>, faces = JOB_FACES): Promise<T> {
    if (this.surface!.faceCount < faces) return this.post(query, json, parameters);
    const request: Request = { method: "POST", path: `${this.surface!.path}/${query}`, query: parameters, json };
    this.isJob = true;
    const running = this.running!;
    const onProgress = (part: number): void => this.answer.showProgress("Working", part, () => running.abort());
    return this.parsed(await this.timed(request, () => runJob(this.api, request, onProgress, running.signal)));
  }
}

export const isAbort = (error: unknown): boolean => error instanceof DOMException && error.name === "AbortError";
