// Uploads files of the user, one after the other. If the daemon already has the name, the user
// decides what to do.

import { type Api, ApiError, ask, pathOf, type Request } from "./api.ts";
import type { Answer } from "./answer.ts";
import { isAbort } from "./bench.ts";
import { button } from "./dom.ts";
import { followJob } from "./jobs.ts";
import type { Kind } from "./surface.ts";

export interface UserFile {
  kind: Kind;
  /** The name of the file. */
  name: string;
  body: Blob;
  query: Record<string, string>;
}

/** A resource that an upload has created, and the request that created it. */
export interface Made {
  kind: Kind;
  name: string;
  request: Request;
}

type Choice = "replace" | "keep-both" | "keep";

/** Returns the file's name without its extension and without characters that the API rejects. */
export function nameOf(file: string): string {
  const stem = file.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9._-]/g, "-");
  return (/^[A-Za-z0-9_-]/.test(stem) ? stem : `mesh${stem}`).slice(0, 100);
}

/** Returns the first unused name of NAME-2, NAME-3, … */
export function freeName(name: string, taken: readonly string[]): string {
  for (let i = 2; ; i++) if (!taken.includes(`${name}-${i}`)) return `${name}-${i}`;
}

/** Sends a request by XMLHttpRequest, because fetch does not report the progress of uploads. */
function send(
  api: Api,
  request: Request,
  onPart: (part: number) => void,
  signal: AbortSignal,
): Promise<Response> {
  return new Promise((resolve, reject) => {
    const sent = new XMLHttpRequest();
    sent.open(request.method, pathOf(request));
    sent.setRequestHeader("Prefer", "respond-async");
    for (const [name, value] of Object.entries(request.headers ?? {}))
      sent.setRequestHeader(name, value);
    if (api.key) sent.setRequestHeader("Authorization", `Bearer ${api.key}`);
    sent.upload.onprogress = (event) => onPart(event.loaded / event.total);
    sent.onload = () => resolve(responseOf(sent));
    sent.onerror = () =>
      reject(new Error("The connection broke during the upload. Send the file again."));
    sent.onabort = () => reject(new DOMException("The upload was cancelled.", "AbortError"));
    signal.addEventListener("abort", () => sent.abort());
    sent.send(request.file!.body);
  });
}

function responseOf(sent: XMLHttpRequest): Response {
  const location = sent.getResponseHeader("Location");
  return new Response(sent.responseText, {
    status: sent.status,
    headers: location ? { Location: location } : {},
  });
}

export class Uploads {
  private running: AbortController | undefined;
  private readonly queue: UserFile[] = [];
  private isBusy = false;
  /** Whether the upload waits for the user's choice. */
  private isWaiting = false;

  /** `taken` returns the daemon's names of a kind. `onMade` is called after the last file. */
  constructor(
    private readonly api: Api,
    private readonly answer: Answer,
    private readonly taken: (kind: Kind) => readonly string[],
    private readonly onMade: (made: Made[]) => Promise<void>,
  ) {}

  get busy(): boolean {
    return this.isBusy && !this.isWaiting;
  }

  cancel(): void {
    this.queue.length = 0;
    this.running?.abort();
  }

  /** Uploads files. Resolves when the daemon has stored or rejected all files. */
  async add(files: UserFile[]): Promise<void> {
    this.queue.push(...files);
    if (this.isBusy) return;
    this.isBusy = true;
    const all: Made[] = [];
    for (let file = this.queue.shift(); file; file = this.queue.shift()) {
      const made = await this.upload(file, nameOf(file.name), { "If-None-Match": "*" });
      if (made) all.push(made);
    }
    if (all.length > 0) await this.onMade(all);
    this.isBusy = false;
  }

  private async upload(
    file: UserFile,
    name: string,
    headers: Record<string, string>,
  ): Promise<Made | null> {
    const { kind, query } = file;
    const path = `/v1/${kind}/${encodeURIComponent(name)}`;
    const request: Request = {
      method: "PUT",
      path,
      query,
      file: { name: file.name, body: file.body },
      headers,
    };
    try {
      await this.put(request, file.name);
      return { kind, name, request };
    } catch (error) {
      if (error instanceof ApiError && error.status === 412)
        return await this.resolveConflict(file, name);
      if (!isAbort(error)) this.refuse(error, file);
      return null;
    } finally {
      this.answer.hideProgress();
    }
  }

  private async put(request: Request, label: string): Promise<void> {
    const running = (this.running = new AbortController());
    const show = (step: string) => (part: number) =>
      this.answer.showProgress(`${step} ${label}`, part, () => this.cancel());
    const sent = await send(this.api, request, show("Sending"), running.signal);
    const location = sent.headers.get("Location");
    const response =
      sent.status === 202
        ? await followJob(this.api, location!, undefined, show("Reading"), running.signal)
        : sent;
    await ask(response);
  }

  private async resolveConflict(file: UserFile, name: string): Promise<Made | null> {
    const free = freeName(name, this.taken(file.kind));
    this.answer.hideProgress();
    this.isWaiting = true;
    const choice = await new Promise<Choice>((resolve) =>
      this.answer.warn(
        new Error(`The daemon has a surface named ${name} already. Others may use it.`),
        button(`Keep both: upload as ${free}`, () => resolve("keep-both"), { class: "main" }),
        button(`Replace ${name}`, () => resolve("replace")),
        button("Do not upload", () => resolve("keep")),
      ),
    );
    this.isWaiting = false;
    this.answer.warn("");
    if (choice === "keep") return null;
    return choice === "replace"
      ? this.upload(file, name, {})
      : this.upload(file, free, { "If-None-Match": "*" });
  }

  /** Shows the error and a button for the next step: a repair, or the same upload again. */
  private refuse(error: unknown, file: UserFile): void {
    const isMendable =
      error instanceof ApiError && !!error.problem.detail?.includes("repair=split");
    const mended = { ...file, query: { ...file.query, repair: "split" } };
    const again = isMendable && file.query.repair !== "split" ? mended : file;
    const label = again === file ? "Upload again" : "Mend and upload";
    this.answer.warn(
      error,
      button(label, () => void this.add([again])),
    );
  }
}
