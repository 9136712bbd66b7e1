// Prepares a mesh of the daemon for drawing and picking. Runs in a worker, so that the page stays
// responsive while a large mesh loads.

import { Bvh, type Tree } from "./bvh.ts";
import { type Shaded, shaded } from "./creases.ts";
import { parsePly, type Triangles } from "./ply.ts";
import type { Vec3 } from "./vector.ts";

/** Maps the surface's box into [-1, 1]³ (normalised coordinates), for use in single precision. */
export interface Frame {
  centre: Vec3;
  /** Half the diagonal of the box, in the unit of the file. */
  radius: number;
}

export interface Prepared {
  triangles: Triangles;
  frame: Frame;
  /** The positions in normalised coordinates. */
  positions: Float32Array;
  shaded: Shaded;
  tree: Tree;
}

function frameOf({ positions, faces }: Triangles): Frame {
  const [low, high]: [Vec3, Vec3] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  for (const vertex of faces) {
    for (let axis = 0; axis < 3; axis++) {
      const x = positions[3 * vertex + axis]!;
      if (x < low[axis]!) low[axis] = x;
      if (x > high[axis]!) high[axis] = x;
    }
  }
  const centre = low.map((x, axis) => (x + high[axis]!) / 2) as Vec3;
  return { centre, radius: Math.hypot(...low.map((x, axis) => high[axis]! - x)) / 2 || 1 };
}

export function toFrame(positions: Float64Array, { centre, radius }: Frame): Float32Array {
  const view = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i++) view[i] = (positions[i]! - centre[i % 3]!) / radius;
  return view;
}

/** Prepares a binary PLY file of the daemon, or triangles. */
export function prepare(source: ArrayBuffer | Triangles): Prepared {
  const triangles = source instanceof ArrayBuffer ? parsePly(source) : source;
  const frame = frameOf(triangles);
  const positions = toFrame(triangles.positions, frame);
  const { tree } = new Bvh(positions, triangles.faces);
  return { triangles, frame, positions, shaded: shaded(positions, triangles.faces), tree };
}

/** Returns the buffers of the result, to transfer them from the worker to the page. */
export const buffersOf = ({ triangles, positions, shaded: drawn, tree }: Prepared): ArrayBuffer[] =>
  [
    triangles.positions,
    triangles.faces,
    positions,
    drawn.positions,
    drawn.normals,
    drawn.faces,
    drawn.copied,
    tree.order,
    tree.boxes,
  ].map((array) => array.buffer as ArrayBuffer);
