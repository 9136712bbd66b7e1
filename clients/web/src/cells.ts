// Splits the faces that bisectors cross, so that each piece lies in one Voronoi cell.

import type { PathPoint } from "../../js/types.d.ts";
import { simplified } from "./simplified.ts";
import type { Vec3 } from "./vector.ts";

/** A convex part of a face, as barycentric coordinates of its corners. */
export interface Piece {
  face: number;
  corners: Vec3[];
}

/** A straight part of a bisector in one face, as barycentric coordinates of its ends. */
type Segment = [Vec3, Vec3];

const SLACK = 1e-6; /* barycentric coordinates that differ by less count as equal */
const WHOLE: Vec3[] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/** Returns the ends of the edge on which a point lies, or its vertex. */
const verticesOf = ({ vertex, edge }: PathPoint): number[] =>
  vertex === undefined ? (edge ?? []) : [vertex];

const keyOf = (vertices: Iterable<number>): string =>
  [...new Set(vertices)].sort((a, b) => a - b).join();

/** Returns the faces whose corners are all in `vertices`, by the key of their corners. */
function facesBetween(faces: Uint32Array, vertices: Set<number>): Map<string, number> {
  const found = new Map<string, number>();
  for (let i = 0; i < faces.length; i += 3) {
    const corners = faces.subarray(i, i + 3);
    if (vertices.has(corners[0]!) && vertices.has(corners[1]!) && vertices.has(corners[2]!))
      found.set(keyOf(corners), i / 3);
  }
  return found;
}

function weightsOf({ vertex, edge, t, barycentric }: PathPoint, corners: Uint32Array): Vec3 {
  if (vertex !== undefined) return [0, 1, 2].map((i) => Number(corners[i] === vertex)) as Vec3;
  if (!edge) return barycentric as Vec3;
  const weights: Vec3 = [0, 0, 0];
  weights[corners.indexOf(edge[0]!)] = 1 - t!;
  weights[corners.indexOf(edge[1]!)] = t!;
  return weights;
}

/** Returns the parts of a polyline between its points on edges and vertices. */
function partsOf(line: PathPoint[]): PathPoint[][] {
  const parts: PathPoint[][] = [];
  let first = 0;
  line.forEach((point, i) => {
    if (i === first || (i + 1 < line.length && verticesOf(point).length === 0)) return;
    parts.push(line.slice(first, i + 1));
    first = i;
  });
  return parts;
}

/** Returns the segments of polylines by face. Leaves out segments along edges. */
function segmentsOf(
  faces: Uint32Array,
  lines: PathPoint[][],
  tolerance: number,
): Map<number, Segment[]> {
  const between = facesBetween(faces, new Set(lines.flat().flatMap(verticesOf)));
  const segments = new Map<number, Segment[]>();
  for (const part of lines.flatMap(partsOf)) {
    const key = keyOf(part.flatMap(verticesOf));
    const face = part.find((point) => point.face !== undefined)?.face ?? between.get(key);
    if (face === undefined) continue;
    const corners = faces.subarray(3 * face, 3 * face + 3);
    const kept = simplified(part, ({ xyz }) => xyz as Vec3, tolerance);
    const weights = kept.map((point) => weightsOf(point, corners));
    const own = weights.slice(1).map((to, i): Segment => [weights[i]!, to]);
    segments.set(face, [...(segments.get(face) ?? []), ...own]);
  }
  return segments;
}

/** Returns the distance of `x` from the line through p and q, positive on the left. */
const side = (p: Vec3, q: Vec3, x: Vec3): number =>
  ((q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0])) /
  Math.hypot(q[0] - p[0], q[1] - p[1]);

/** Returns whether a part of the segment lies inside the convex polygon. */
function enters(corners: Vec3[], [p, q]: Segment): boolean {
  let [low, high] = [0, 1];
  corners.forEach((corner, i) => {
    const next = corners[(i + 1) % corners.length]!;
    const [before, after] = [side(corner, next, p), side(corner, next, q)];
    if (before < 0 && after < 0) high = -1;
    else if (before < 0) low = Math.max(low, before / (before - after));
    else if (after < 0) high = Math.min(high, before / (before - after));
  });
  return high - low > SLACK;
}

/**
 * Returns the part of a convex polygon on one side of a line. `sides` has the signed distance of
 * each corner from the line. The returned part lies where this distance is not negative.
 */
function half(corners: Vec3[], sides: number[]): Vec3[] {
  return corners.flatMap((corner, i) => {
    const next = (i + 1) % corners.length;
    const [here, there] = [sides[i]!, sides[next]!];
    const kept = here >= 0 ? [corner] : [];
    if (here * there >= 0) return kept;
    const t = here / (here - there);
    return [...kept, corner.map((x, axis) => x + t * (corners[next]![axis]! - x)) as Vec3];
  });
}

/** Splits a convex polygon by the line through a segment, if the segment enters the polygon. */
function split(corners: Vec3[], segment: Segment): Vec3[][] {
  const sides = corners.map((corner) => side(...segment, corner));
  const isCut = Math.max(...sides) > SLACK && Math.min(...sides) < -SLACK;
  if (!isCut || !enters(corners, segment)) return [corners];
  const others = sides.map((distance) => -distance);
  return [half(corners, sides), half(corners, others)];
}

/**
 * Returns the pieces of all faces that bisectors cross. A bisector enters a piece by at most
 * `tolerance`. A face whose corners have different labels is a piece, too: a bisector may lie on
 * its edges.
 */
export function piecesOf(
  faces: Uint32Array,
  labels: (number | null)[],
  bisectors: PathPoint[][],
  tolerance: number,
): Piece[] {
  const segments = segmentsOf(faces, bisectors, tolerance);
  const pieces: Piece[] = [];
  for (let face = 0; 3 * face < faces.length; face++) {
    const own = segments.get(face);
    const [a, b, c] = [0, 1, 2].map((i) => labels[faces[3 * face + i]!]);
    if (!own && a === b && b === c) continue;
    let parts = [WHOLE];
    for (const segment of own ?? []) parts = parts.flatMap((corners) => split(corners, segment));
    for (const corners of parts) pieces.push({ face, corners });
  }
  return pieces;
}

/** Returns the barycentric coordinates of a point inside a piece. */
export const middleOf = ({ corners }: Piece): Vec3 =>
  [0, 1, 2].map((i) => corners.reduce((sum, p) => sum + p[i]!, 0) / corners.length) as Vec3;
