// Files on their way to the daemon: how far the bytes have come, then how far the daemon is with them.

import type { Job, Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { type Api, ApiError, pathOf, type Request } from "./api.ts";
import { followJob } from "./jobs.ts";
import type { Kind } from "./surface.ts";

export type Description = Mesh | Subdivision | Nurbs;

/** How far: 0 to 1 of the bytes, then of the work. */
type OnUpload = (what: "Sending" | "Reading", part: number) => void;

/** A name that the API takes: the file's, without its ending and other characters. */
function nameOf(file: string): string {
  const stem = file.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9._-]/g, "-");
  return (/^[A-Za-z0-9_-]/.test(stem) ? stem : `mesh${stem}`).slice(0, 100);
}

/** By XMLHttpRequest, because fetch does not tell how far an upload has come. */
function put(api: Api, request: Request, onPart: (part: number) => void, signal: AbortSignal): Promise<XMLHttpRequest> {
  return new Promise((resolve, reject) => {
    const sent = new XMLHttpRequest();
    sent.open(request.method, pathOf(request));
    sent.responseType = "json";
    sent.setRequestHeader("Prefer", "respond-async");
    if (api.key) sent.setRequestHeader("Authorization", `Bearer ${api.key}`);
    sent.upload.onprogress = (event) => onPart(event.loaded / event.total);
    sent.onload = () => resolve(sent);
    sent.onerror = () => reject(new Error("The connection broke while the file was sent."));
    sent.onabort = () => reject(new DOMException("The upload was cancelled.", "AbortError"));
    signal.addEventListener("abort", () => sent.abort());
    sent.send(request.file!.body);
  });
}

/** Uploads a file under a name; the resource's description. */
export async function upload(
  api: Api,
  kind: Kind,
  file: { name: string; body: Blob },
  query: Record<string, string>,
  onUpload: OnUpload,
  signal: AbortSignal,
): Promise<Description> {
  const path = `/v1/${kind}/${encodeURIComponent(nameOf(file.name))}`;
  const sent = await put(api, { method: "PUT", path, query, file }, (part) => onUpload("Sending", part), signal);
  if (sent.status >= 300) throw new ApiError(sent.status, sent.response ?? {});
  if (sent.status !== 202) return sent.response as Description;
  const onProgress = (part: number, _state: Job["state"]): void => onUpload("Reading", part);
  const response = await followJob(api, sent.getResponseHeader("Location")!, undefined, onProgress, signal);
  if (!response.ok) throw new ApiError(response.status, await response.json());
  return (await response.json()) as Description;
}
