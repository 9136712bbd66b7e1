// Computes the triangles that the page draws for a smooth surface: grids of points that the daemon
// evaluates. The daemon stores nothing for this.

import type {
  EvaluateAnswer,
  LimitEvaluateAnswer,
  LimitPlace,
  Nurbs,
  Subdivision,
} from "../../js/types.d.ts";
import type { Api } from "./api.ts";
import { gridFaces, gridWeights } from "./fine.ts";
import type { Triangles } from "./ply.ts";
import type { Vec3 } from "./vector.ts";

export const NURBS_CELLS = 128; /* number of cells of the grid over the domain, along each axis */
const DRAWN_FACES = 80000; /* largest number of triangles of a limit surface */
const MOST_LEVELS = 5;
/* largest number of points of a request, because the daemon reads at most 1 MiB */
const MOST_PLACES = 20000;
const WELD = 1e7; /* points closer than the largest coordinate / WELD become one vertex */

/** Evaluates a NURBS surface at parameters. */
export async function evaluated(api: Api, path: string, uv: [number, number][]): Promise<Vec3[]> {
  const request = {
    method: "POST",
    path: `${path}/evaluate`,
    query: { select: "points,xyz" },
    json: { uv },
  } as const;
  return (await api.json<EvaluateAnswer>(request)).points!.map((point) => point.xyz as Vec3);
}

/** Returns points of the unit square in rows of `cells` + 1, and the triangles between them. */
function square(cells: number): { points: [number, number][]; faces: number[] } {
  const side = Array.from({ length: cells + 1 }, (_, i) => i / cells);
  const points = side.flatMap((u) => side.map((v): [number, number] => [u, v]));
  const faces: number[] = [];
  for (let i = 0; i < cells; i++) {
    for (let j = 0; j < cells; j++) {
      const [a, b] = [i * (cells + 1) + j, (i + 1) * (cells + 1) + j];
      faces.push(a, b, b + 1, a, b + 1, a + 1);
    }
  }
  return { points, faces };
}

/** Like `square`, for the unit triangle. */
const triangle = (cells: number): { points: [number, number][]; faces: number[] } => ({
  points: gridWeights(cells).map(([, u, v]): [number, number] => [u, v]),
  faces: gridFaces(cells),
});

/** Returns the triangles of a NURBS surface over its domain. */
export async function nurbsGrid(api: Api, path: string, { domain }: Nurbs): Promise<Triangles> {
  const { points, faces } = square(NURBS_CELLS);
  const at = ([low, high]: [number, number], part: number): number => low + part * (high - low);
  const uv = points.map(([u, v]): [number, number] => [
    at(domain.u.range, u),
    at(domain.v.range, v),
  ]);
  const places = await evaluated(api, path, uv);
  return { positions: Float64Array.from(places.flat()), faces: Uint32Array.from(faces) };
}

/** Returns the number of cells along an edge of the control mesh. */
export function cellsOf({ scheme, faces, usual_level: usual }: Subdivision): number {
  const least = scheme === "loop" ? faces : 2 * faces;
  const finest = Math.floor(Math.log2(DRAWN_FACES / least) / 2);
  return 2 ** Math.max(0, Math.min(usual, MOST_LEVELS, finest));
}

/**
 * Returns the triangles of a limit surface whose control mesh has only quads, or only triangles for
 * Loop.
 */
export async function limitGrid(api: Api, path: string, surface: Subdivision): Promise<Triangles> {
  const cells = cellsOf(surface);
  const grid = surface.scheme === "loop" ? triangle(cells) : square(cells);
  const places: LimitPlace[] = [];
  const faces: number[] = [];
  for (let face = 0; face < surface.faces; face++) {
    const first = places.length;
    for (const uv of grid.points) places.push({ face, uv });
    for (const corner of grid.faces) faces.push(first + corner);
  }
  return welded(await limitPoints(api, path, places), faces);
}

async function limitPoints(api: Api, path: string, places: LimitPlace[]): Promise<Vec3[]> {
  const points: Vec3[] = [];
  for (let at = 0; at < places.length; at += MOST_PLACES) {
    const json = { points: places.slice(at, at + MOST_PLACES) };
    const request = { method: "POST", path: `${path}/evaluate`, json } as const;
    const query = { select: "points,xyz" };
    const answer = await api.json<LimitEvaluateAnswer>({ ...request, query });
    for (const { xyz } of answer.points!) points.push(xyz as Vec3);
  }
  return points;
}

/** Merges points of several grids that coincide, so that shading has no seams. */
function welded(points: Vec3[], faces: number[]): Triangles {
  const size = points.reduce((most, p) => Math.max(most, ...p.map(Math.abs)), 0) || 1;
  const vertices = new Map<string, number>();
  const positions: number[] = [];
  const vertexOf = points.map((p) => {
    const key = p.map((x) => Math.round((x / size) * WELD)).join();
    if (!vertices.has(key)) {
      vertices.set(key, vertices.size);
      positions.push(...p);
    }
    return vertices.get(key)!;
  });
  return {
    positions: Float64Array.from(positions),
    faces: Uint32Array.from(faces, (corner) => vertexOf[corner]!),
  };
}
