// Finds the first triangle that a ray hits, with a bounding volume hierarchy. Triangles are sorted
// along a Morton curve. The tree is a complete binary tree; each leaf has a run of triangles.

import type { Vec3 } from "./vector.ts";

export interface Hit {
  face: number;
  /** Weights of the face's three corners. */
  barycentric: Vec3;
  /** The distance in multiples of the length of the ray's direction. */
  distance: number;
}

const RUN = 6; /* number of triangles of a leaf */
const CELLS = 1023; /* number of cells of the Morton grid along each axis */

/** Inserts two zero bits between neighbouring bits of n, which has ten bits. */
function spread(n: number): number {
  n = (n | (n << 16)) & 0x030000ff;
  n = (n | (n << 8)) & 0x0300f00f;
  n = (n | (n << 4)) & 0x030c30c3;
  return (n | (n << 2)) & 0x09249249;
}

/** Returns the order that sorts 30-bit codes, by a radix sort of three passes. */
function sortedByCode(codes: Uint32Array): Uint32Array {
  let from = Uint32Array.from(codes.keys());
  let to = new Uint32Array(codes.length);
  for (let shift = 0; shift < 30; shift += 10) {
    const starts = new Uint32Array(1025);
    for (const code of codes) starts[((code >>> shift) & 1023) + 1]!++;
    for (let i = 0; i < 1024; i++) starts[i + 1]! += starts[i]!;
    for (const index of from) to[starts[(codes[index]! >>> shift) & 1023]!++] = index;
    [from, to] = [to, from];
  }
  return from;
}

/** The arrays of a tree. They can be transferred between threads. */
export interface Tree {
  /** The faces along the Morton curve. */
  order: Uint32Array;
  /** Six numbers per node: the lower and the upper corner of its box. */
  boxes: Float32Array;
}

export class Bvh {
  private readonly order: Uint32Array;
  /**
   * Number of leaves, a power of two. Node i has the children 2i + 1 and 2i + 2; the leaves come
   * last.
   */
  private readonly leaves: number;
  private readonly boxes: Float32Array;

  /**
   * Borrows `positions` and `faces` for the life of this object. `tree` is an existing tree of the
   * same mesh. By default the constructor builds a tree.
   */
  constructor(
    private readonly positions: Float32Array,
    private readonly faces: Uint32Array,
    tree?: Tree,
  ) {
    const count = faces.length / 3;
    this.leaves = 2 ** Math.max(0, Math.ceil(Math.log2(count / RUN)));
    this.order = tree?.order ?? sortedByCode(this.codes(count));
    this.boxes = tree?.boxes ?? new Float32Array(6 * (2 * this.leaves - 1));
    if (tree) return;
    for (let leaf = 0; leaf < this.leaves; leaf++) this.boundLeaf(leaf);
    for (let node = this.leaves - 2; node >= 0; node--) this.boundNode(node);
  }

  get tree(): Tree {
    return { order: this.order, boxes: this.boxes };
  }

  /** Returns the Morton codes of the faces. Positions lie in [-1, 1]. */
  private codes(count: number): Uint32Array {
    const { positions, faces } = this;
    const codes = new Uint32Array(count);
    const cell = (a: number, b: number, c: number): number =>
      Math.max(
        0,
        Math.min(
          CELLS,
          Math.floor(((positions[a]! + positions[b]! + positions[c]!) / 6 + 0.5) * CELLS),
        ),
      );
    for (let i = 0; i < count; i++) {
      const [a, b, c] = [3 * faces[3 * i]!, 3 * faces[3 * i + 1]!, 3 * faces[3 * i + 2]!];
      const [x, y, z] = [cell(a, b, c), cell(a + 1, b + 1, c + 1), cell(a + 2, b + 2, c + 2)];
      codes[i] = (spread(x) << 2) | (spread(y) << 1) | spread(z);
    }
    return codes;
  }

  private firstOf(leaf: number): number {
    return Math.floor((leaf * this.order.length) / this.leaves);
  }

  private boundLeaf(leaf: number): void {
    const { boxes, positions, faces, order } = this;
    const at = 6 * (this.leaves - 1 + leaf);
    boxes.fill(Infinity, at, at + 3).fill(-Infinity, at + 3, at + 6);
    const end = 3 * this.firstOf(leaf + 1);
    for (let i = 3 * this.firstOf(leaf); i < end; i++) {
      const corner = 3 * faces[3 * order[Math.floor(i / 3)]! + (i % 3)]!;
      for (let axis = 0; axis < 3; axis++) {
        const x = positions[corner + axis]!;
        if (x < boxes[at + axis]!) boxes[at + axis] = x;
        if (x > boxes[at + 3 + axis]!) boxes[at + 3 + axis] = x;
      }
    }
  }

  private boundNode(node: number): void {
    const { boxes } = this;
    const [at, left, right] = [6 * node, 6 * (2 * node + 1), 6 * (2 * node + 2)];
    for (let axis = 0; axis < 3; axis++) {
      boxes[at + axis] = Math.min(boxes[left + axis]!, boxes[right + axis]!);
      boxes[at + 3 + axis] = Math.max(boxes[left + 3 + axis]!, boxes[right + 3 + axis]!);
    }
  }

  /**
   * Returns the ray parameter at which the ray enters a node's box, or Infinity if the ray misses
   * the box.
   */
  private entry(node: number, origin: Vec3, inverse: Vec3): number {
    let [near, far] = [0, Infinity];
    for (let axis = 0; axis < 3; axis++) {
      const a = (this.boxes[6 * node + axis]! - origin[axis]!) * inverse[axis]!;
      const b = (this.boxes[6 * node + 3 + axis]! - origin[axis]!) * inverse[axis]!;
      near = Math.max(near, Math.min(a, b));
      far = Math.min(far, Math.max(a, b));
    }
    return near <= far ? near : Infinity;
  }

  /** Returns the first hit, from either side of the faces, or null if there is no hit. */
  cast(origin: Vec3, direction: Vec3): Hit | null {
    const inverse: Vec3 = [1 / direction[0], 1 / direction[1], 1 / direction[2]];
    let best: Hit | null = null;
    const stack = [0];
    while (stack.length > 0) {
      const node = stack.pop()!;
      if (this.entry(node, origin, inverse) >= (best?.distance ?? Infinity)) continue;
      if (node >= this.leaves - 1)
        best = this.castLeaf(node - this.leaves + 1, origin, direction, best);
      else stack.push(...this.nearLast(node, origin, inverse));
    }
    return best;
  }

  private nearLast(node: number, origin: Vec3, inverse: Vec3): [number, number] {
    const [left, right] = [2 * node + 1, 2 * node + 2];
    return this.entry(left, origin, inverse) < this.entry(right, origin, inverse)
      ? [right, left]
      : [left, right];
  }

  private castLeaf(leaf: number, origin: Vec3, direction: Vec3, best: Hit | null): Hit | null {
    const end = this.firstOf(leaf + 1);
    for (let i = this.firstOf(leaf); i < end; i++) {
      const hit = this.castFace(this.order[i]!, origin, direction);
      if (hit && hit.distance < (best?.distance ?? Infinity)) best = hit;
    }
    return best;
  }

  /** Intersects the ray with a face (Möller and Trumbore 1997), without culling. */
  private castFace(face: number, origin: Vec3, direction: Vec3): Hit | null {
    const { positions: p, faces } = this;
    const [a, b, c] = [3 * faces[3 * face]!, 3 * faces[3 * face + 1]!, 3 * faces[3 * face + 2]!];
    const [ax, ay, az] = [p[a]!, p[a + 1]!, p[a + 2]!];
    const [ux, uy, uz] = [p[b]! - ax, p[b + 1]! - ay, p[b + 2]! - az];
    const [vx, vy, vz] = [p[c]! - ax, p[c + 1]! - ay, p[c + 2]! - az];
    const [dx, dy, dz] = direction;
    const [hx, hy, hz] = [dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx];
    const determinant = ux * hx + uy * hy + uz * hz;
    if (determinant === 0) return null;
    const [sx, sy, sz] = [origin[0] - ax, origin[1] - ay, origin[2] - az];
    const u = (sx * hx + sy * hy + sz * hz) / determinant;
    if (!(u >= 0 && u <= 1)) return null;
    const [qx, qy, qz] = [sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux];
    const v = (dx * qx + dy * qy + dz * qz) / determinant;
    const distance = (vx * qx + vy * qy + vz * qz) / determinant;
    return v >= 0 && u + v <= 1 && distance > 0
      ? { face, barycentric: [1 - u - v, u, v], distance }
      : null;
  }
}
