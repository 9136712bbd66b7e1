// Loads surfaces from the daemon: their description, and the triangles to draw.

import type { DiscretizeRequest, Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { type Api, ask, type Request } from "./api.ts";
import { cellsOf, limitGrid, nurbsGrid } from "./grids.ts";
import type { Triangles } from "./ply.ts";
import { prepared } from "./preparer.ts";
import { type Kind, Surface } from "./surface.ts";

const pathOf = (kind: Kind, name: string): string => `/v1/${kind}/${encodeURIComponent(name)}`;

const PREVIEWED_FACES = 300000; /* larger meshes are drawn as a preview */
const PREVIEW_FACES = 100000;

/** Receives the progress of a step, 0 to 1. */
export type OnLoad = (part: number) => void;

async function contentOf(api: Api, name: string, onLoad: OnLoad): Promise<ArrayBuffer> {
  const request: Request = {
    method: "GET",
    path: `${pathOf("meshes", name)}/content`,
    query: { format: "ply" },
  };
  return received(await api.send(request), onLoad);
}

/** Reads a response. Reports progress if the length of the response is known. */
async function received(response: Response, onLoad: OnLoad): Promise<ArrayBuffer> {
  const total = Number(response.headers.get("Content-Length"));
  if (!total || response.headers.has("Content-Encoding")) return response.arrayBuffer();
  const bytes = new Uint8Array(total);
  const reader = response.body!.getReader();
  let at = 0;
  for (let read = await reader.read(); !read.done; read = await reader.read()) {
    bytes.set(read.value, at);
    at += read.value.length;
    onLoad(at / total);
  }
  return bytes.buffer;
}

interface Preview {
  file: ArrayBuffer;
  /** Largest distance from the original, in the unit of the file. */
  deviation: number;
}

/**
 * Returns the simplified mesh that the page draws for a large one. Waits until the daemon has built
 * it. Returns null if the daemon does not build previews.
 */
async function previewOf(api: Api, name: string, onLoad: OnLoad): Promise<Preview | null> {
  const query = { faces: String(PREVIEW_FACES), format: "ply" };
  const request: Request = { method: "GET", path: `${pathOf("meshes", name)}/preview`, query };
  for (;;) {
    const response = await api.fetch(request);
    if (response.status === 404) return null;
    await ask(response);
    if (response.status !== 202) {
      const deviation = Number(response.headers.get("Geodesic-Largest-Distance"));
      return { file: await received(response, onLoad), deviation };
    }
    onLoad(((await response.json()) as { progress: number }).progress);
    await new Promise((resume) =>
      setTimeout(resume, 1000 * Number(response.headers.get("Retry-After") ?? 1)),
    );
  }
}

/**
 * Returns a mesh of a limit surface whose control mesh has polygons. The daemon does not return the
 * corners of such control meshes. So the daemon stores a mesh of the surface under a random name;
 * the page reads this mesh and deletes it.
 */
async function limitContent(api: Api, surface: Subdivision, onLoad: OnLoad): Promise<ArrayBuffer> {
  const mesh = `${surface.name}-${Math.random().toString(36).slice(2)}`;
  const level = Math.max(surface.least_level, Math.log2(cellsOf(surface)));
  const path = `${pathOf("subdivisions", surface.name)}/tessellate`;
  const json: DiscretizeRequest = { mesh, level };
  await api.send({ method: "POST", path, json });
  try {
    return await contentOf(api, mesh, onLoad);
  } finally {
    await api.send({ method: "DELETE", path: pathOf("meshes", mesh) });
  }
}

/** Returns the triangles or the file to draw, and the deviation of a preview. */
async function drawnOf(
  api: Api,
  description: Mesh | Subdivision | Nurbs,
  { kind, onLoad }: { kind: Kind; onLoad: OnLoad },
): Promise<{ file: ArrayBuffer | Triangles; deviation?: number }> {
  const path = pathOf(kind, description.name);
  if (kind === "nurbs") return { file: await nurbsGrid(api, path, description as Nurbs) };
  if (kind === "subdivisions") {
    const surface = description as Subdivision;
    const hasPolygons = surface.least_level > 0;
    if (hasPolygons) return { file: await limitContent(api, surface, onLoad) };
    return { file: await limitGrid(api, path, surface) };
  }
  const isLarge = (description as Mesh).faces > PREVIEWED_FACES;
  const preview = isLarge ? await previewOf(api, description.name, onLoad) : null;
  return preview ?? { file: await contentOf(api, description.name, onLoad) };
}

export async function loadSurface(
  api: Api,
  kind: Kind,
  name: string,
  onLoad: OnLoad,
): Promise<Surface> {
  const description = await api.get<Mesh | Subdivision | Nurbs>(pathOf(kind, name));
  const { file, deviation } = await drawnOf(api, description, { kind, onLoad });
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
