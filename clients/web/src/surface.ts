// A surface that is shown: a resource of the daemon and the triangles that stand for it on the screen.

import type { Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { Bvh } from "./bvh.ts";
import { type Fine, refined } from "./fine.ts";
import { parseCompact, parseXyz, type Place, rounded } from "./place.ts";
import type { Triangles } from "./ply.ts";
import type { Vec3 } from "./vector.ts";

export type Kind = "meshes" | "subdivisions" | "nurbs";

/** What is shown lies in the cube [-1, 1], so that single precision is enough at any scale and far from the origin. */
class Frame {
  constructor(
    readonly centre: Vec3,
    readonly radius: number,
  ) {}

  static of(positions: Float64Array, faces: Uint32Array): Frame {
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
    return new Frame(centre, Math.hypot(...low.map((x, axis) => high[axis]! - x)) / 2 || 1);
  }

  toView(p: Vec3): Vec3 {
    const { centre, radius } = this;
    return [(p[0] - centre[0]) / radius, (p[1] - centre[1]) / radius, (p[2] - centre[2]) / radius];
  }
}

function viewed(positions: Float64Array, frame: Frame): Float32Array {
  const view = new Float32Array(positions.length);
  for (let i = 0; i < positions.length; i++) view[i] = (positions[i]! - frame.centre[i % 3]!) / frame.radius;
  return view;
}

export class Surface {
  readonly frame: Frame;
  /** In the frame. */
  readonly positions: Float32Array;
  /** What colours are shown on, where the mesh itself is too coarse for them. */
  readonly fine: Fine | null;
  private tree: Bvh | undefined;

  constructor(
    readonly kind: Kind,
    /** The resource's. */
    readonly name: string,
    readonly description: Mesh | Subdivision | Nurbs,
    /** The mesh that is shown. */
    readonly mesh: Mesh,
    readonly triangles: Triangles,
  ) {
    this.frame = Frame.of(triangles.positions, triangles.faces);
    this.positions = viewed(triangles.positions, this.frame);
    this.fine = refined(this);
  }

  /** Positions in the file's unit as they lie in the frame. */
  view(positions: Float64Array): Float32Array {
    return viewed(positions, this.frame);
  }

  get path(): string {
    return `/v1/${this.kind}/${encodeURIComponent(this.name)}`;
  }

  get meshPath(): string {
    return `/v1/meshes/${encodeURIComponent(this.mesh.name)}`;
  }

  get faceCount(): number {
    return this.triangles.faces.length / 3;
  }

  /** Half the diagonal of its box, in the file's unit. */
  get size(): number {
    return this.frame.radius;
  }

  /** Made when the first ray needs it. */
  get bvh(): Bvh {
    this.tree ??= new Bvh(this.positions, this.triangles.faces);
    return this.tree;
  }

  corner(face: number, which: number): Vec3 {
    const at = 3 * this.triangles.faces[3 * face + which]!;
    const p = this.triangles.positions;
    return [p[at]!, p[at + 1]!, p[at + 2]!];
  }

  place(face: number, weights: Vec3): Place {
    const barycentric = rounded(weights);
    const corners = [this.corner(face, 0), this.corner(face, 1), this.corner(face, 2)];
    const along = (axis: number): number => corners.reduce((sum, p, i) => sum + barycentric[i]! * p[axis]!, 0);
    return { face, barycentric, xyz: [along(0), along(1), along(2)], isFree: this.isRenumbered };
  }

  /**
   * Whether the daemon knows faces otherwise than its files tell them: a repair leaves gaps in its numbers, and it counts
   * the corners of a face that it has turned over as they were uploaded.
   */
  get isRenumbered(): boolean {
    const { duplicate_faces: doubles, degenerate_faces: flat, edges_flipped: flipped } = this.mesh.repair;
    return doubles + flat + flipped + this.mesh.orientation.flipped_faces > 0;
  }

  /** The place of a compact point on this surface, or null. */
  parse(text: string): Place | null {
    const xyz = this.isRenumbered ? parseXyz(text) : null;
    if (xyz) return { face: 0, barycentric: [1, 0, 0], xyz, isFree: true };
    const point = parseCompact(text);
    return point && point.face < this.faceCount ? this.place(point.face, point.barycentric) : null;
  }

  /** Where a ray of the frame meets the surface first. */
  cast(origin: Vec3, direction: Vec3): Place | null {
    const hit = this.bvh.cast(origin, direction);
    return hit && this.place(hit.face, hit.barycentric);
  }
}
