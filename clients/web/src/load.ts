// Surfaces from the daemon: their description, and the mesh that is shown for them.

import type { DiscretizeRequest, Mesh, Nurbs, Subdivision, TessellateRequest } from "../../js/types.d.ts";
import { type Api, ApiError, type Request } from "./api.ts";
import { parsePly } from "./ply.ts";
import { type Kind, Surface } from "./surface.ts";

const SHOWN_FACES = 80000; /* of a smooth surface's discretization, about */

const pathOf = (kind: Kind, name: string): string => `/v1/${kind}/${encodeURIComponent(name)}`;

async function contentOf(api: Api, mesh: Mesh): Promise<ArrayBuffer> {
  return api.bytes({ method: "GET", path: `${pathOf("meshes", mesh.name)}/content`, query: { format: "ply" } });
}

/** The level at which the limit surface is shown: the usual one, unless that is too fine for a picture. */
function levelOf(surface: Subdivision): number {
  const finest = Math.floor(Math.log2(SHOWN_FACES / (2 * surface.faces)) / 2);
  return Math.max(surface.least_level, Math.min(surface.usual_level, 5, finest));
}

type Making = Request & { json: DiscretizeRequest | TessellateRequest };

/** Makes the mesh that stands for a smooth surface. Who may not write sees the one that somebody made before. */
async function discretized(api: Api, request: Making): Promise<Mesh> {
  try {
    return await api.json<Mesh>(request);
  } catch (error) {
    if (!(error instanceof ApiError && error.status === 403)) throw error;
    return api.get<Mesh>(pathOf("meshes", request.json.mesh));
  }
}

/** The request that makes the mesh which is shown for a smooth surface; null for a mesh. */
function discretization(kind: Kind, description: Mesh | Subdivision | Nurbs): Making | null {
  const path = pathOf(kind, description.name);
  if (kind === "subdivisions") {
    const json = { mesh: `${description.name}-limit`, level: levelOf(description as Subdivision) };
    return { method: "POST", path: `${path}/tessellate`, json };
  }
  if (kind === "meshes") return null;
  return {
    method: "POST",
    path: `${path}/tessellate`,
    json: { mesh: `${description.name}-mesh`, resolution: [128, 128] },
  };
}

/** `onMade` is told the request that made a mesh for the surface. */
export async function loadSurface(
  api: Api,
  kind: Kind,
  name: string,
  onMade: (request: Request) => void,
): Promise<Surface> {
  const description = await api.get<Mesh | Subdivision | Nurbs>(pathOf(kind, name));
  const making = discretization(kind, description);
  const mesh = making ? await discretized(api, making) : (description as Mesh);
  if (making) onMade(making);
  return new Surface(kind, name, description, mesh, parsePly(await contentOf(api, mesh)));
}

/** The names of all surfaces of a kind. */
export async function namesOf(api: Api, kind: Kind): Promise<string[]> {
  const names: string[] = [];
  for (let after: string | null = ""; after !== null;) {
    const page: Record<string, unknown> = await api.get(`/v1/${kind}`, { limit: "1000", ...(after && { after }) });
    names.push(...(page[kind] as { name: string }[]).map((surface) => surface.name));
    after = page.next as string | null;
  }
  return names;
}
