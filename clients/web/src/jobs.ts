// Runs slow requests as jobs of the daemon, with progress and cancellation.

import type { Job } from "../../js/types.d.ts";
import { type Api, ApiError, received, type Request } from "./api.ts";

export type OnProgress = (part: number, state: Job["state"]) => void;

const MOST_BREAKS = 5; /* streams in a row that may end without an event */
const PAUSE = 500; /* milliseconds before the page opens a stream again */

/** Yields the data of the server-sent events of a stream. */
async function* events(response: Response, signal?: AbortSignal): AsyncGenerator<Job> {
  const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  const next = (): ReturnType<typeof reader.read> => received(reader.read(), signal);
  for (let read = await next(); !read.done; read = await next()) {
    const parts = (text + read.value).split("\n\n");
    text = parts.pop()!;
    for (const part of parts) {
      const data = part.split("\n").find((line) => line.startsWith("data: "));
      if (data) yield JSON.parse(data.slice(6)) as Job;
    }
  }
}

const hasEnded = (job: Job): boolean => job.state !== "queued" && job.state !== "running";

/** Follows a job until it has ended. Opens the stream again if it ends or breaks earlier. */
async function follow(
  api: Api,
  path: string,
  onProgress: OnProgress,
  signal?: AbortSignal,
): Promise<Job> {
  const request = { method: "GET", path: `${path}/events`, accept: "text/event-stream" } as const;
  for (let breaks = 0; ; breaks++) {
    try {
      for await (const job of events(await api.send(request, signal), signal)) {
        breaks = 0;
        onProgress(job.progress, job.state);
        if (hasEnded(job)) return job;
      }
    } catch (error) {
      if (signal?.aborted || error instanceof ApiError || breaks >= MOST_BREAKS) throw error;
    }
    await new Promise((resume) => setTimeout(resume, PAUSE));
  }
}

/**
 * Waits for a job and returns the response of its request. Aborting the signal also cancels the job
 * at the daemon.
 */
export async function followJob(
  api: Api,
  path: string,
  accept: string | undefined,
  onProgress: OnProgress,
  signal?: AbortSignal,
): Promise<Response> {
  try {
    const job = await follow(api, path, onProgress, signal);
    if (job.state === "cancelled") throw new Error("The work was cancelled.");
    return await api.fetch({ method: "GET", path: `${path}/result`, accept }, signal);
  } catch (error) {
    if (signal?.aborted) await api.fetch({ method: "DELETE", path }).catch(() => {});
    throw error;
  }
}

/** Sends a request as a job and returns the response of the request. */
export async function runJob(
  api: Api,
  request: Request,
  onProgress: OnProgress,
  signal?: AbortSignal,
): Promise<Response> {
  const accepted = await api.fetch(request, signal, { Prefer: "respond-async" });
  if (accepted.status !== 202) return accepted;
  return followJob(api, accepted.headers.get("Location")!, request.accept, onProgress, signal);
}
