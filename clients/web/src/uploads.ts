// Uploads files of the user, one after the other. If the daemon already has a surface of this name,
// the user chooses the next step.

import { type Api, ApiError, ask, pathOf, type Request } from "./api.ts";
import { isAbort } from "./bench.ts";
import { button, byId } from "./dom.ts";
import { followJob } from "./jobs.ts";
import { messageOf, Notice } from "./notice.ts";
import { type Kind, surfacePath } from "./surface.ts";

export interface UserFile {
  kind: Kind;
  /** The name of the file. */
  name: string;
  body: Blob;
  query: Record<string, string>;
}

/** A resource that an upload has created, and the request of the upload. */
export interface Made {
  kind: Kind;
  name: string;
  request: Request;
}

const LARGE = 8 << 20; /* size in bytes; a larger file is uploaded as a job */
/* largest number of characters of a name before a suffix; the API permits 128 characters in all */
const LONGEST_STEM = 100;

type Choice = "replace" | "keep-both" | "keep";

const isGzip = ({ name }: UserFile): boolean => /\.gz$/i.test(name);

/** Returns the text of a file. Returns "" if the browser cannot read or decompress the file. */
export async function textOf(file: UserFile): Promise<string> {
  try {
    if (!isGzip(file)) return await file.body.text();
    const text = file.body.stream().pipeThrough(new DecompressionStream("gzip"));
    return await new Response(text).text();
  } catch {
    return "";
  }
}

/** Returns the file's name without its extensions and without characters that the API rejects. */
export function nameOf(file: string): string {
  const stem = file.replace(/(\.[^.]*)?(\.gz)?$/i, "").replace(/[^A-Za-z0-9._-]/g, "-");
  return (/^[A-Za-z0-9_-]/.test(stem) ? stem : `mesh${stem}`).slice(0, LONGEST_STEM);
}

/**
 * Returns the first unused name of NAME-FIRST and the following numbers. Shortens a name that would
 * become too long.
 */
export function freeName(name: string, first: number, taken: ReadonlySet<string>): string {
  const stem = name.slice(0, LONGEST_STEM);
  for (let i = first; ; i++) if (!taken.has(`${stem}-${i}`)) return `${stem}-${i}`;
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
    const body = request.file!.body as Blob;
    const isLarge = body.size > LARGE;
    if (isLarge) sent.setRequestHeader("Prefer", "respond-async"); /* a job reports progress */
    for (const [name, value] of Object.entries(request.headers ?? {}))
      sent.setRequestHeader(name, value);
    if (api.key) sent.setRequestHeader("Authorization", `Bearer ${api.key}`);
    sent.upload.onprogress = (event) => onPart(event.loaded / event.total);
    sent.onload = () => resolve(responseOf(sent));
    sent.onerror = () => void causeOf(body).then(reject);
    sent.onabort = () => reject(new DOMException("The upload was cancelled.", "AbortError"));
    signal.addEventListener("abort", () => sent.abort());
    sent.send(body);
  });
}

/**
 * Returns the error of an upload that broke. Browsers do not read a file that has changed since the
 * user chose it.
 */
async function causeOf(body: Blob): Promise<Error> {
  try {
    await body.slice(0, 1).arrayBuffer();
    return new Error("The connection broke during the upload. Send the file again.");
  } catch {
    return new Error("The browser cannot read the file. If you have changed the file, choose it again.");
  }
}

function responseOf(sent: XMLHttpRequest): Response {
  const headers = new Headers();
  for (const name of ["Location", "Retry-After"]) {
    const value = sent.getResponseHeader(name);
    if (value) headers.set(name, value);
  }
  return new Response(sent.responseText, { status: sent.status, headers });
}

export class Uploads {
  private running: AbortController | undefined;
  private readonly queue: UserFile[] = [];
  private isBusy = false;
  /** Whether the upload waits for the user's choice. */
  private isWaiting = false;
  /** Progress of the running upload. */
  private readonly progress = new Notice();

  /** `taken` returns the daemon's names of a kind. `onMade` is called after the last file. */
  constructor(
    private readonly api: Api,
    private readonly taken: (kind: Kind) => readonly string[],
    private readonly onMade: (made: Made[]) => Promise<void>,
  ) {
    byId("uploads").append(this.progress.node);
    addEventListener("beforeunload", (event) => {
      if (this.busy) event.preventDefault(); /* the browser asks the user whether to leave */
    });
  }

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
    this.isBusy = false;
    if (all.length > 0) await this.onMade(all);
  }

  private async upload(
    file: UserFile,
    name: string,
    headers: Record<string, string>,
  ): Promise<Made | null> {
    const { kind, query } = file;
    const request: Request = {
      method: "PUT",
      path: surfacePath(kind, name),
      query,
      file: { name: file.name, body: file.body },
      headers: { ...headers, ...(isGzip(file) && { "Content-Encoding": "gzip" }) },
    };
    try {
      await this.put(request, file.name);
      return { kind, name, request };
    } catch (error) {
      this.progress.hideProgress();
      if (error instanceof ApiError && error.status === 412)
        return await this.resolveConflict(file, name);
      if (!isAbort(error)) this.refuse(error, file);
      return null;
    } finally {
      this.progress.hideProgress();
    }
  }

  private async put(request: Request, label: string): Promise<void> {
    const running = (this.running = new AbortController());
    const show = (step: string) => (part: number | null) =>
      this.progress.showProgress(`${step} ${label}`, part, () => this.cancel());
    show("Sending")(null); /* the browser reports no progress of small files */
    const { signal } = running;
    const sent = await this.api.persist(
      () => send(this.api, request, show("Sending"), signal),
      signal,
    );
    const location = sent.headers.get("Location");
    const response =
      sent.status === 202
        ? await followJob(this.api, location!, undefined, show("Reading"), signal)
        : sent;
    await ask(response);
  }

  private async resolveConflict(file: UserFile, name: string): Promise<Made | null> {
    const free = freeName(name, 2, new Set(this.taken(file.kind)));
    this.isWaiting = true;
    const choice = await choiceOf<Choice>(
      `The daemon has a surface named ${name} already. Others may use it.`,
      [
        [`Keep both: upload as ${free}`, "keep-both"],
        [`Replace ${name}`, "replace"],
        ["Do not upload", "keep"],
      ],
    );
    this.isWaiting = false;
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
    void choiceOf(`File ${file.name}: ${messageOf(error)}`, [
      [label, true],
      ["Dismiss", false],
    ]).then((isAgain) => {
      if (isAgain) void this.add([again]);
    });
  }
}

/** Shows a message until the user presses one of the buttons, given by label and value. */
function choiceOf<T>(text: string, choices: [string, T][]): Promise<T> {
  const notice = new Notice();
  byId("uploads").append(notice.node);
  return new Promise((resolve) => {
    const buttons = choices.map(([label, value], i) =>
      button(
        label,
        () => {
          notice.node.remove();
          resolve(value);
        },
        i === 0 ? { class: "main" } : {},
      ),
    );
    notice.warn(text, ...buttons);
  });
}
