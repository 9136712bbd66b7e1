// Computes normals for shading. A vertex on a sharp edge gets one normal for each smooth fan of its
// faces, so that machined parts look sharp and scans look smooth.

import { unit, type Vec3 } from "./vector.ts";

/* an edge is sharp if the normals of its faces differ by a larger angle */
const ANGLE = (50 * Math.PI) / 180;
const CREASE = Math.cos(ANGLE);
const HALF_CREASE = Math.cos(ANGLE / 2);

const MOST_SHARP = 20000; /* a surface with more sharp vertices is rough, and is shaded smoothly */

/** Triangles with a normal at each vertex. */
export interface Shaded {
  positions: Float32Array;
  normals: Float32Array;
  faces: Uint32Array;
  /**
   * The vertices of the mesh are followed by copies. For each copy, this array has the vertex of
   * the mesh.
   */
  copied: Uint32Array;
}

interface FaceNormals {
  /** Unit normals; zero for a face without area. */
  normals: Float32Array;
  /** Twice the area of each face. */
  areas: Float32Array;
}

function faceNormals(positions: Float32Array, faces: Uint32Array): FaceNormals {
  const normals = new Float32Array(faces.length);
  const areas = new Float32Array(faces.length / 3);
  for (let i = 0; i < faces.length; i += 3) {
    const a = 3 * faces[i]!;
    const b = 3 * faces[i + 1]!;
    const c = 3 * faces[i + 2]!;
    const ux = positions[b]! - positions[a]!;
    const uy = positions[b + 1]! - positions[a + 1]!;
    const uz = positions[b + 2]! - positions[a + 2]!;
    const vx = positions[c]! - positions[a]!;
    const vy = positions[c + 1]! - positions[a + 1]!;
    const vz = positions[c + 2]! - positions[a + 2]!;
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    const size = Math.sqrt(nx * nx + ny * ny + nz * nz);
    areas[i / 3] = size;
    if (size === 0) continue;
    normals[i] = nx / size;
    normals[i + 1] = ny / size;
    normals[i + 2] = nz / size;
  }
  return { normals, areas };
}

/** Returns a unit normal for each vertex: the area-weighted mean of its faces' normals. */
function vertexNormals(faces: Uint32Array, face: FaceNormals, vertexCount: number): Float32Array {
  const sums = new Float32Array(3 * vertexCount);
  for (let i = 0; i < faces.length; i++) {
    const f = i - (i % 3);
    const at = 3 * faces[i]!;
    const area = face.areas[f / 3]!;
    sums[at]! += area * face.normals[f]!;
    sums[at + 1]! += area * face.normals[f + 1]!;
    sums[at + 2]! += area * face.normals[f + 2]!;
  }
  for (let at = 0; at < sums.length; at += 3) {
    const x = sums[at]!;
    const y = sums[at + 1]!;
    const z = sums[at + 2]!;
    const size = Math.sqrt(x * x + y * y + z * z) || 1;
    sums[at] = x / size;
    sums[at + 1] = y / size;
    sums[at + 2] = z / size;
  }
  return sums;
}

/**
 * Returns the corners (indices into `faces`) of each vertex that has a face whose normal differs
 * much from the vertex normal.
 */
function sharpCorners(
  faces: Uint32Array,
  face: FaceNormals,
  normals: Float32Array,
): Map<number, number[]> {
  const corners = new Map<number, number[]>();
  for (let i = 0; i < faces.length; i++) {
    const f = i - (i % 3);
    const at = 3 * faces[i]!;
    if (face.areas[f / 3] === 0) continue;
    const dot =
      normals[at]! * face.normals[f]! +
      normals[at + 1]! * face.normals[f + 1]! +
      normals[at + 2]! * face.normals[f + 2]!;
    if (dot < HALF_CREASE) corners.set(faces[i]!, []);
  }
  if (corners.size > MOST_SHARP) return new Map();
  if (corners.size > 0) for (let i = 0; i < faces.length; i++) corners.get(faces[i]!)?.push(i);
  return corners;
}

/** Returns whether two faces share an edge at the vertex, and this edge is not sharp. */
function areJoined(faces: Uint32Array, { normals }: FaceNormals, a: number, b: number): boolean {
  const f = a - (a % 3);
  const g = b - (b % 3);
  const dot =
    normals[f]! * normals[g]! +
    normals[f + 1]! * normals[g + 1]! +
    normals[f + 2]! * normals[g + 2]!;
  if (dot < CREASE) return false;
  for (let i = f; i < f + 3; i++) {
    for (let j = g; j < g + 3; j++) if (faces[i] === faces[j] && faces[i] !== faces[a]) return true;
  }
  return false;
}

/** Groups the corners of a vertex into fans whose inner edges are not sharp. */
function fansOf(faces: Uint32Array, face: FaceNormals, corners: number[]): number[][] {
  let left = corners;
  const fans: number[][] = [];
  while (left.length > 0) {
    const fan = [left[0]!];
    left = left.slice(1);
    for (const member of fan) {
      const others = left.filter((other) => areJoined(faces, face, member, other));
      if (others.length === 0) continue;
      fan.push(...others);
      left = left.filter((other) => !others.includes(other));
    }
    fans.push(fan);
  }
  return fans;
}

function fanNormal({ normals, areas }: FaceNormals, fan: number[]): Vec3 {
  const sum: Vec3 = [0, 0, 0];
  for (const corner of fan) {
    const f = corner - (corner % 3);
    for (let axis = 0; axis < 3; axis++) sum[axis]! += areas[f / 3]! * normals[f + axis]!;
  }
  return unit(sum);
}

/** Returns new arrays; borrows its arguments. Takes O(faces) time if valences are bounded. */
export function shaded(positions: Float32Array, faces: Uint32Array): Shaded {
  const vertexCount = positions.length / 3;
  const face = faceNormals(positions, faces);
  const normals = vertexNormals(faces, face, vertexCount);
  const drawn = faces.slice();
  const [copied, copiedNormals]: [number[], number[]] = [[], []];
  for (const [vertex, corners] of sharpCorners(faces, face, normals)) {
    const [first, ...others] = fansOf(faces, face, corners);
    normals.set(fanNormal(face, first!), 3 * vertex);
    for (const fan of others) {
      const copy = vertexCount + copied.push(vertex) - 1;
      copiedNormals.push(...fanNormal(face, fan));
      for (const corner of fan) drawn[corner] = copy;
    }
  }
  const copies = Uint32Array.from(copied);
  return {
    positions: extended(positions, copies),
    normals: joined(normals, copiedNormals),
    faces: drawn,
    copied: copies,
  };
}

function joined(first: Float32Array, second: ArrayLike<number>): Float32Array {
  const both = new Float32Array(first.length + second.length);
  both.set(first);
  both.set(second, first.length);
  return both;
}

function extended(positions: Float32Array, copied: Uint32Array): Float32Array {
  const copies = new Float32Array(3 * copied.length);
  copied.forEach((vertex, i) => copies.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
  return joined(positions, copies);
}
