// Refines a coarse mesh for its colours, because a distance is not linear in a large face. The new
// vertices lie in the faces of the mesh. The daemon computes the exact distance at each vertex.

import { type Place, rounded } from "./place.ts";
import type { Triangles } from "./ply.ts";
import type { Vec3 } from "./vector.ts";

const COARSE = 3000; /* number of faces; meshes with more faces are not refined */
const FACES = 16000; /* largest number of faces of the refined mesh */
const MOST_PARTS = 32; /* largest number of parts of an edge */

export interface Fine {
  /** In normalised coordinates (Frame in prepare.ts). */
  positions: Float32Array;
  faces: Uint32Array;
  /** The three vertices of the mesh that each refined vertex interpolates; then their weights. */
  corners: Uint32Array;
  weights: Float32Array;
  places: Place[];
}

/**
 * Returns barycentric weights of a triangle's grid points, row by row. Each edge has `parts` parts.
 */
export function gridWeights(parts: number): Vec3[] {
  const weights: Vec3[] = [];
  for (let i = 0; i <= parts; i++)
    for (let j = 0; j <= parts - i; j++)
      weights.push(rounded([1 - (i + j) / parts, j / parts, i / parts]));
  return weights;
}

/** Returns the triangles between the points of gridWeights, as indices. */
export function gridFaces(parts: number): number[] {
  const faces: number[] = [];
  for (let i = 0, row = 0; i < parts; row += parts + 1 - i, i++) {
    const above = row + parts + 1 - i;
    for (let j = 0; j < parts - i; j++) {
      faces.push(row + j, row + j + 1, above + j);
      if (j + 1 < parts - i) faces.push(row + j + 1, above + j + 1, above + j);
    }
  }
  return faces;
}

/** The properties of a surface that `refined` reads. */
interface Coarse {
  readonly drawnFaces: number;
  readonly positions: Float32Array;
  readonly triangles: Triangles;
  place(face: number, weights: Vec3): Place;
}

/** Returns the refined mesh, or null if the mesh is fine enough. */
export function refined(surface: Coarse): Fine | null {
  const { drawnFaces: faceCount, positions } = surface;
  if (faceCount > COARSE) return null;
  const parts = Math.min(MOST_PARTS, Math.floor(Math.sqrt(FACES / faceCount)));
  const [grid, triangles] = [gridWeights(parts), gridFaces(parts)];
  const fine: Fine = {
    positions: new Float32Array(3 * grid.length * faceCount),
    faces: new Uint32Array(triangles.length * faceCount),
    corners: new Uint32Array(3 * grid.length * faceCount),
    weights: new Float32Array(3 * grid.length * faceCount),
    places: [],
  };
  for (let face = 0; face < faceCount; face++) {
    const corners = surface.triangles.faces.subarray(3 * face, 3 * face + 3);
    const first = face * grid.length;
    fine.faces.set(
      triangles.map((i) => first + i),
      face * triangles.length,
    );
    grid.forEach((weights, i) => {
      fine.corners.set(corners, 3 * (first + i));
      fine.weights.set(weights, 3 * (first + i));
      fine.places.push(surface.place(face, weights));
    });
  }
  fine.positions.set(interpolated(fine, positions, 3));
  return fine;
}

/** Interpolates `size` numbers per vertex of the mesh at the refined vertices. */
export function interpolated(fine: Fine, values: ArrayLike<number>, size: number): Float64Array {
  const { corners, weights } = fine;
  const count = corners.length / 3;
  const result = new Float64Array(size * count);
  for (let i = 0; i < 3 * count; i++) {
    for (let k = 0; k < size; k++)
      result[size * Math.floor(i / 3) + k]! += weights[i]! * values[size * corners[i]! + k]!;
  }
  return result;
}
