// The page's side of prepare.ts: sends meshes to the worker and waits for the results.

import type { Prepared } from "./prepare.ts";
import type { Triangles } from "./ply.ts";

interface Reply {
  id: number;
  prepared?: Prepared;
  error?: string;
}

const waiting = new Map<
  number,
  { resolve: (prepared: Prepared) => void; reject: (error: Error) => void }
>();
/** The worker. It starts with the page, so that it is ready when the first mesh arrives. */
const worker = new Worker("/worker.js", { type: "module" });
worker.onmessage = receive;
let count = 0;

function receive({ data: { id, prepared, error } }: MessageEvent<Reply>): void {
  const { resolve, reject } = waiting.get(id)!;
  waiting.delete(id);
  if (prepared) resolve(prepared);
  else reject(new Error(error));
}

/** Prepares a mesh in the worker. Transfers the buffers of `source` to the worker. */
export function prepared(source: ArrayBuffer | Triangles): Promise<Prepared> {
  const buffers =
    source instanceof ArrayBuffer ? [source] : [source.positions.buffer, source.faces.buffer];
  const id = count++;
  worker.postMessage({ id, source }, buffers as ArrayBuffer[]);
  return new Promise((resolve, reject) => waiting.set(id, { resolve, reject }));
}
