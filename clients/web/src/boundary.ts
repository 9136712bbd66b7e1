// The boundary of a surface: the edges that have only one face.

import type { Place } from "./place.ts";
import type { Surface } from "./surface.ts";
import { add, dot, length, scale, subtract, type Vec3 } from "./vector.ts";

interface Side {
  face: number;
  /** The corner of the face where the edge begins, 0 to 2. */
  corner: number;
}

export function boundaryOf(surface: Surface): Side[] {
  const { faces } = surface.triangles;
  const sides = new Map<number, Side | null>();
  const vertexCount = surface.triangles.positions.length / 3;
  for (let i = 0; i < faces.length; i++) {
    const [a, b] = [faces[i]!, faces[i % 3 === 2 ? i - 2 : i + 1]!];
    const edge = Math.min(a, b) * vertexCount + Math.max(a, b);
    sides.set(edge, sides.has(edge) ? null : { face: Math.floor(i / 3), corner: i % 3 });
  }
  return [...sides.values()].filter((side) => side !== null);
}

/** Returns the boundary point nearest to a point in space, or null if there is no boundary. */
export function nearestOnBoundary(surface: Surface, boundary: Side[], to: Vec3): Place | null {
  let [best, least]: [Place | null, number] = [null, Infinity];
  for (const { face, corner } of boundary) {
    const [a, b] = [surface.corner(face, corner), surface.corner(face, (corner + 1) % 3)];
    const along = subtract(b, a);
    const t = Math.min(1, Math.max(0, dot(subtract(to, a), along) / dot(along, along)));
    const distance = length(subtract(add(a, scale(along, t)), to));
    if (distance >= least) continue;
    const weights: Vec3 = [0, 0, 0];
    weights[corner] = 1 - t;
    weights[(corner + 1) % 3] = t;
    [best, least] = [surface.place(face, weights), distance];
  }
  return best;
}
