// Sends requests to the daemon and turns its error answers into exceptions.

import type { Problem } from "../../js/types.d.ts";

export interface Request {
  method: "GET" | "PUT" | "POST" | "DELETE";
  path: string;
  query?: Record<string, string>;
  /** Sent as JSON. */
  json?: unknown;
  /** Sent unchanged. The page shows `name` instead of the content. */
  file?: { name: string; body: Blob | Uint8Array<ArrayBuffer> };
  accept?: string;
  headers?: Record<string, string>;
}

/** An error answer of the API. The message is for people; `problem` is as the API sent it. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Partial<Problem>,
    url: string,
  ) {
    super(sentence(problem, status, url));
  }
}

/** The daemon does not answer: it has stopped, or the network is down. */
export class NoAnswer extends Error {}

/** The user has cancelled the work. */
export class Cancelled extends Error {}

const MOST_REPEATS = 4; /* of one request that the daemon refuses because it is busy */
const LONGEST_PAUSE = 20; /* seconds; a refusal with a longer Retry-After is an error at once */

/** Messages for statuses whose cause is not in the request, with the next step. */
const SENTENCES: Record<number, string> = {
  401: "The daemon needs an access key. Enter a valid one under Access key.",
  403: "This access key may not do that. Ask the operator for a key with the role write.",
  404: "The daemon does not have this surface. Choose another one, or upload it again.",
  412: "Another client has replaced this surface since the page loaded it.",
  429: "The daemon limits how often this key may ask. Wait a few seconds, then try again.",
  503: "The daemon is busy. Wait a few seconds, then try again.",
  504: "The work took longer than the daemon permits. Try again, or use fewer points.",
};
/** The message if the daemon has removed a field or a job, or was started again. */
const LOST = "The daemon no longer has this result. Start the same work again.";

function sentence(problem: Partial<Problem>, status: number, url: string): string {
  if ([404, 410].includes(status) && /\/(fields|jobs)\//.test(url)) return LOST;
  if (SENTENCES[status]) return SENTENCES[status];
  if (!problem.detail) return `The daemon answered with status ${status}.`;
  return problem.reason ? `${problem.detail} (${problem.reason})` : problem.detail;
}

/**
 * Returns a response or its body. Throws NoAnswer if the connection breaks, also in the middle of
 * the body.
 */
export async function received<T>(coming: Promise<T>, signal?: AbortSignal): Promise<T> {
  try {
    return await coming;
  } catch (error) {
    if (signal?.aborted) throw error;
    throw new NoAnswer(
      `The daemon at ${location.host} does not answer. Start it again, then try again.`,
      { cause: error },
    );
  }
}

/** Returns a successful response; throws ApiError otherwise. */
export async function ask(response: Response): Promise<Response> {
  if (response.ok) return response;
  const problem = (await response.json().catch(() => ({}))) as Partial<Problem>;
  throw new ApiError(response.status, problem, response.url);
}

export function pathOf(request: Request): string {
  const query = new URLSearchParams(request.query).toString();
  return query ? `${request.path}?${query}` : request.path;
}

export class Api {
  /** The access key, which the page forgets when the tab closes. */
  private own = "";
  /** The waits for a busy daemon. Each function ends one of them. */
  private readonly pauses = new Set<() => void>();
  /** Called when the page begins to wait for a busy daemon (seconds), and at the end (null). */
  onPause: (seconds: number | null) => void = () => {};

  constructor() {
    try {
      this.own = sessionStorage.getItem("key") ?? "";
    } catch {
      /* the browser blocks storage in this frame */
    }
  }

  get key(): string {
    return this.own;
  }

  set key(key: string) {
    this.own = key;
    try {
      sessionStorage.setItem("key", key);
    } catch {
      /* the key is forgotten when the page closes */
    }
  }

  private headers(request: Request, more: Record<string, string>): Headers {
    const headers = new Headers({ ...request.headers, ...more });
    if (request.json !== undefined) headers.set("Content-Type", "application/json");
    if (request.accept) headers.set("Accept", request.accept);
    if (this.key) headers.set("Authorization", `Bearer ${this.key}`);
    return headers;
  }

  /** Returns the response, whatever its status. Throws NoAnswer if the connection breaks. */
  async fetch(
    request: Request,
    signal?: AbortSignal,
    headers: Record<string, string> = {},
  ): Promise<Response> {
    const body = request.json !== undefined ? JSON.stringify(request.json) : request.file?.body;
    const options = {
      method: request.method,
      headers: this.headers(request, headers),
      body,
      signal,
    };
    return this.persist(() => received(fetch(pathOf(request), options), signal), signal);
  }

  /**
   * Sends a request, and again after a refusal with Retry-After because the daemon is busy. With
   * this header, the daemon says that a repetition does no harm, whatever the method.
   */
  async persist(send: () => Promise<Response>, signal?: AbortSignal): Promise<Response> {
    for (let repeats = 0; ; repeats++) {
      const response = await send();
      const seconds = Number(response.headers.get("Retry-After") ?? NaN);
      const isBusy = [429, 503].includes(response.status) && seconds <= LONGEST_PAUSE;
      if (!isBusy || repeats === MOST_REPEATS || !(await this.pause(seconds, signal)))
        return response;
    }
  }

  /** Waits. Returns false if the user ends the wait; throws if the signal is aborted. */
  private async pause(seconds: number, signal?: AbortSignal): Promise<boolean> {
    signal?.throwIfAborted();
    let end = (): void => {};
    const isOver = new Promise<boolean>((resolve) => {
      setTimeout(() => resolve(true), 1000 * seconds);
      end = () => resolve(false);
    });
    signal?.addEventListener("abort", end);
    this.pauses.add(end);
    this.onPause(seconds);
    const result = await isOver;
    signal?.removeEventListener("abort", end);
    this.pauses.delete(end);
    if (this.pauses.size === 0) this.onPause(null);
    signal?.throwIfAborted();
    return result;
  }

  /** Ends all waits for a busy daemon. Their requests fail with the daemon's refusal. */
  endPauses(): void {
    for (const end of this.pauses) end();
  }

  /** Returns a successful response; throws ApiError or NoAnswer otherwise. */
  async send(request: Request, signal?: AbortSignal): Promise<Response> {
    return ask(await this.fetch(request, signal));
  }

  async json<T>(request: Request, signal?: AbortSignal): Promise<T> {
    return received((await this.send(request, signal)).json() as Promise<T>, signal);
  }

  async get<T>(path: string, query?: Record<string, string>, signal?: AbortSignal): Promise<T> {
    return this.json<T>({ method: "GET", path, query }, signal);
  }

  async bytes(request: Request, signal?: AbortSignal): Promise<ArrayBuffer> {
    return received((await this.send(request, signal)).arrayBuffer(), signal);
  }
}
