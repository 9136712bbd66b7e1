// Requests to the daemon, and its problems as exceptions. Everything that the page knows comes through here.

import type { Problem } from "../../js/types.d.ts";

export interface Request {
  method: "GET" | "PUT" | "POST" | "DELETE";
  path: string;
  query?: Record<string, string>;
  /** Sent as JSON. */
  json?: unknown;
  /** Sent as it is; `name` stands for it where the request is shown. */
  file?: { name: string; body: Blob };
  accept?: string;
}

/** What the API refused, in its own words. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    readonly problem: Partial<Problem>,
  ) {
    super(sentence(problem, status));
  }
}

function sentence(problem: Partial<Problem>, status: number): string {
  if (!problem.detail) return `The daemon answered ${status}.`;
  return problem.reason ? `${problem.detail} (${problem.reason})` : problem.detail;
}

export async function errorOf(response: Response): Promise<ApiError> {
  const problem = (await response.json().catch(() => ({}))) as Partial<Problem>;
  return new ApiError(response.status, problem);
}

export function pathOf(request: Request): string {
  const query = new URLSearchParams(request.query).toString();
  return query ? `${request.path}?${query}` : request.path;
}

export class Api {
  /** The access key, kept for this tab only. */
  get key(): string {
    return sessionStorage.getItem("key") ?? "";
  }

  set key(key: string) {
    if (key) sessionStorage.setItem("key", key);
    else sessionStorage.removeItem("key");
  }

  private headers(request: Request, more: Record<string, string>): Headers {
    const headers = new Headers(more);
    if (request.json !== undefined) headers.set("Content-Type", "application/json");
    if (request.accept) headers.set("Accept", request.accept);
    if (this.key) headers.set("Authorization", `Bearer ${this.key}`);
    return headers;
  }

  /** The response, right or wrong; a connection that breaks is an error with a sentence. */
  async fetch(request: Request, signal?: AbortSignal, headers: Record<string, string> = {}): Promise<Response> {
    const body = request.json !== undefined ? JSON.stringify(request.json) : request.file?.body;
    const options = { method: request.method, headers: this.headers(request, headers), body, signal };
    try {
      return await fetch(pathOf(request), options);
    } catch (error) {
      if (signal?.aborted) throw error;
      throw new Error("The daemon does not answer. Is it still running?", { cause: error });
    }
  }

  /** The response; problems are thrown. */
  async send(request: Request, signal?: AbortSignal): Promise<Response> {
    const response = await this.fetch(request, signal);
    if (!response.ok) throw await errorOf(response);
    return response;
  }

  async json<T>(request: Request, signal?: AbortSignal): Promise<T> {
    return (await this.send(request, signal)).json() as Promise<T>;
  }

  async get<T>(path: string, query?: Record<string, string>): Promise<T> {
    return this.json<T>({ method: "GET", path, query });
  }

  async bytes(request: Request, signal?: AbortSignal): Promise<ArrayBuffer> {
    return (await this.send(request, signal)).arrayBuffer();
  }
}
