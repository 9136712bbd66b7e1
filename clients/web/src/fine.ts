// A coarse mesh cut finer for its colours: between far vertices a distance is not linear. The finer vertices lie in the
// faces of the mesh, and the daemon is asked for the exact distance at each.

import { type Place, rounded } from "./place.ts";
import type { Triangles } from "./ply.ts";
import type { Vec3 } from "./vector.ts";

const COARSE = 3000; /* faces; more are fine enough */
const FACES = 16000; /* that a coarse mesh is cut into, about */
const MOST_PARTS = 32; /* of an edge */

export interface Fine {
  /** In the frame. */
  positions: Float32Array;
  faces: Uint32Array;
  /** Of the mesh: three for each finer vertex, and their weights. */
  corners: Uint32Array;
  weights: Float32Array;
  places: Place[];
}

/** Weights of the grid points of a triangle whose edges are cut into `parts`, row by row. */
function gridWeights(parts: number): Vec3[] {
  const weights: Vec3[] = [];
  for (let i = 0; i <= parts; i++)
    for (let j = 0; j <= parts - i; j++) weights.push(rounded([1 - (i + j) / parts, j / parts, i / parts]));
  return weights;
}

/** The grid's triangles by the numbers of its points. */
function gridFaces(parts: number): number[] {
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

/** The part of a surface that refined reads. */
interface Coarse {
  readonly faceCount: number;
  readonly positions: Float32Array;
  readonly triangles: Triangles;
  place(face: number, weights: Vec3): Place;
}

/** The finer mesh; null for one that is fine enough. */
export function refined(surface: Coarse): Fine | null {
  const { faceCount, positions } = surface;
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

/** What is `size` numbers a vertex of the mesh, at each of the finer vertices, linear between. */
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
