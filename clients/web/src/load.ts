// Loads surfaces from the daemon: their description, and the triangles to draw. A worker prepares
// the triangles (prepare.ts).

import type { Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { type Api, ask, NoAnswer, received, type Request } from "./api.ts";
import { cellsOf, limitGrid, NURBS_CELLS, nurbsGrid } from "./grids.ts";
import type { Triangles } from "./ply.ts";
import type { Prepared } from "./prepare.ts";
import { type Kind, Surface, surfacePath } from "./surface.ts";

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
let worker: Worker | null = startWorker();
let count = 0;

function startWorker(): Worker {
  const made = new Worker("/worker.js", { type: "module" });
  made.onmessage = receive;
  made.onerror = dropWorker;
  return made;
}

/** Drops a worker that did not load or that threw an error. The next mesh starts a new one. */
function dropWorker(): void {
  worker?.terminate();
  worker = null;
  for (const { reject } of waiting.values())
    reject(new NoAnswer("The page could not load the script that prepares meshes. Try again."));
  waiting.clear();
}

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
  (worker ??= startWorker()).postMessage({ id, source }, buffers as ArrayBuffer[]);
  return new Promise((resolve, reject) => waiting.set(id, { resolve, reject }));
}

const PREVIEWED_FACES = 300000; /* meshes with more faces are drawn as a preview */
const PREVIEW_FACES = 100000;

/** A load of a surface, which the signal aborts. */
export interface Load {
  signal?: AbortSignal;
  /** Receives the progress of a step, 0 to 1. */
  onPart: (part: number) => void;
}

/** `headers` are conditions on the version of the mesh. */
async function contentOf(
  api: Api,
  name: string,
  load: Load,
  headers?: Record<string, string>,
): Promise<ArrayBuffer> {
  const request: Request = {
    method: "GET",
    path: `${surfacePath("meshes", name)}/content`,
    query: { format: "ply" },
    headers,
  };
  return received(contents(await api.send(request, load.signal), load), load.signal);
}

/** Reads a response. Reports progress if the length of the response is known. */
async function contents(response: Response, { onPart }: Load): Promise<ArrayBuffer> {
  const total = Number(response.headers.get("Content-Length"));
  if (!total || response.headers.has("Content-Encoding")) return response.arrayBuffer();
  const bytes = new Uint8Array(total);
  const reader = response.body!.getReader();
  let at = 0;
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    bytes.set(read.value, at);
    at += read.value.length;
    onPart(at / total);
  }
  return bytes.buffer;
}

interface Preview {
  file: ArrayBuffer;
  /** Largest distance from the original, in the unit of the file. */
  deviation: number;
}

/**
 * Returns the simplified mesh that the page draws instead of a large mesh. Waits until the daemon
 * has built it. Returns null if the daemon does not build previews.
 */
async function previewOf(api: Api, name: string, load: Load): Promise<Preview | null> {
  const query = { faces: String(PREVIEW_FACES), format: "ply" };
  const request: Request = { method: "GET", path: `${surfacePath("meshes", name)}/preview`, query };
  for (;;) {
    const response = await api.fetch(request, load.signal);
    if (response.status === 404) return null;
    await ask(response);
    if (response.status !== 202) {
      const deviation = Number(response.headers.get("Geodesic-Largest-Distance"));
      return { file: await received(contents(response, load), load.signal), deviation };
    }
    load.onPart(((await received(response.json(), load.signal)) as { progress: number }).progress);
    await new Promise((resume) =>
      setTimeout(resume, 1000 * Number(response.headers.get("Retry-After") ?? 1)),
    );
  }
}

/**
 * Returns a mesh of a smooth surface that no grid covers: a limit surface whose control mesh has
 * polygons, or a trimmed NURBS surface. The daemon stores a mesh of the surface under a random
 * name; the page reads this mesh and deletes it.
 */
async function meshContent(
  api: Api,
  [kind, name]: [Kind, string],
  options: { level: number } | { resolution: [number, number] },
  load: Load,
): Promise<ArrayBuffer> {
  const path = surfacePath(kind, name);
  const mesh = `${name.slice(0, 100)}-${Math.random().toString(36).slice(2)}`;
  await api.send({ method: "POST", path: `${path}/tessellate`, json: { mesh, ...options } });
  try {
    return await contentOf(api, mesh, load);
  } finally {
    await api.send({ method: "DELETE", path: surfacePath("meshes", mesh) });
  }
}

/** Returns the triangles or the file to draw, and the deviation of a preview. */
async function drawnOf(
  api: Api,
  description: Mesh | Subdivision | Nurbs,
  { kind, load }: { kind: Kind; load: Load },
): Promise<{ file: ArrayBuffer | Triangles; deviation?: number }> {
  const { name } = description;
  const path = surfacePath(kind, name);
  if (kind === "nurbs") {
    const surface = description as Nurbs;
    const resolution: [number, number] = [NURBS_CELLS, NURBS_CELLS];
    if (surface.trimming_loops)
      return { file: await meshContent(api, [kind, name], { resolution }, load) };
    return { file: await nurbsGrid(api, path, surface) };
  }
  if (kind === "subdivisions") {
    const surface = description as Subdivision;
    const hasPolygons = surface.least_level > 0;
    const level = Math.max(surface.least_level, Math.log2(cellsOf(surface)));
    if (hasPolygons) return { file: await meshContent(api, [kind, name], { level }, load) };
    return { file: await limitGrid(api, path, surface) };
  }
  const isLarge = (description as Mesh).faces > PREVIEWED_FACES;
  const preview = isLarge ? await previewOf(api, name, load) : null;
  const condition = { "If-Match": `"${description.etag}"` };
  return preview ?? { file: await contentOf(api, name, load, condition) };
}

export async function loadSurface(
  api: Api,
  kind: Kind,
  name: string,
  load: Load,
): Promise<Surface> {
  const path = surfacePath(kind, name);
  const description = await api.get<Mesh | Subdivision | Nurbs>(path, undefined, load.signal);
  const { file, deviation } = await drawnOf(api, description, { kind, load });
  return new Surface(kind, name, description, await prepared(file), deviation);
}

/** Returns the names of all surfaces of a kind. */
export async function namesOf(api: Api, kind: Kind): Promise<string[]> {
  const names: string[] = [];
  for (let after: string | null = ""; after !== null;) {
    const page: Record<string, unknown> = await api.get(`/v1/${kind}`, {
      limit: "1000",
      ...(after && { after }),
    });
    names.push(...(page[kind] as { name: string }[]).map((surface) => surface.name));
    after = page.next as string | null;
  }
  return names;
}
