// A surface of the daemon, and the triangles that the page draws for it.

import type { Mesh, Nurbs, Subdivision } from "../../js/types.d.ts";
import { Bvh } from "./bvh.ts";
import type { Shaded } from "./creases.ts";
import { type Fine, interpolated, refined } from "./fine.ts";
import { parseCompact, parseXyz, type Place, rounded } from "./place.ts";
import type { Triangles } from "./ply.ts";
import { type Frame, type Prepared, toFrame } from "./prepare.ts";
import { add, scale, subtract, type Vec3 } from "./vector.ts";

export type Kind = "meshes" | "subdivisions" | "nurbs";

export const surfacePath = (kind: Kind, name: string): string =>
  `/v1/${kind}/${encodeURIComponent(name)}`;

export class Surface {
  readonly frame: Frame;
  readonly triangles: Triangles;
  /** The positions in normalised coordinates. */
  readonly positions: Float32Array;
  readonly shaded: Shaded;
  /** The refined mesh that is drawn instead of a coarse mesh, or null. */
  readonly fine: Fine | null;
  readonly bvh: Bvh;
  private used: Uint32Array | undefined;

  /**
   * `deviation` is the largest distance of a preview from the original mesh, or undefined if the
   * triangles are not a preview.
   */
  constructor(
    readonly kind: Kind,
    readonly name: string,
    readonly description: Mesh | Subdivision | Nurbs,
    prepared: Prepared,
    readonly deviation?: number,
  ) {
    this.frame = prepared.frame;
    this.triangles = prepared.triangles;
    this.positions = prepared.positions;
    this.shaded = prepared.shaded;
    this.bvh = new Bvh(this.positions, this.triangles.faces, prepared.tree);
    this.fine = refined(this);
  }

  get isPreview(): boolean {
    return this.deviation !== undefined;
  }

  /** Converts positions from the file's unit to normalised coordinates. */
  view(positions: Float64Array): Float32Array {
    return toFrame(positions, this.frame);
  }

  viewOf(xyz: Vec3): Vec3 {
    return scale(subtract(xyz, this.frame.centre), 1 / this.frame.radius);
  }

  get path(): string {
    return surfacePath(this.kind, this.name);
  }

  /** Number of faces of the drawn mesh. */
  get drawnFaces(): number {
    return this.triangles.faces.length / 3;
  }

  /**
   * Number of faces of the daemon's mesh. For smooth surfaces, the number of faces of the drawn
   * mesh.
   */
  get faceCount(): number {
    return this.kind === "meshes" ? (this.description as Mesh).faces : this.drawnFaces;
  }

  /** The vertices that have faces. */
  get usedVertices(): Uint32Array {
    if (this.used) return this.used;
    const isUsed = new Uint8Array(this.triangles.positions.length / 3);
    for (const vertex of this.triangles.faces) isUsed[vertex] = 1;
    return (this.used = Uint32Array.from(isUsed.keys()).filter((vertex) => isUsed[vertex]));
  }

  /** Half the diagonal of the surface's box, in the file's unit. */
  get size(): number {
    return this.frame.radius;
  }

  corner(face: number, which: number): Vec3 {
    const at = 3 * this.triangles.faces[3 * face + which]!;
    const p = this.triangles.positions;
    return [p[at]!, p[at + 1]!, p[at + 2]!];
  }

  place(face: number, weights: Vec3): Place {
    const barycentric = rounded(weights);
    const corners = [this.corner(face, 0), this.corner(face, 1), this.corner(face, 2)];
    const along = (axis: number): number =>
      corners.reduce((sum, p, i) => sum + barycentric[i]! * p[axis]!, 0);
    return { face, barycentric, xyz: [along(0), along(1), along(2)], isFree: this.isRenumbered };
  }

  /**
   * Whether face numbers or corner orders of the drawn mesh differ from those of the daemon's mesh.
   * The daemon numbers the faces of the upload, including faces that a repair has removed. A face
   * that a repair has turned over keeps the corner order of the upload.
   */
  get isRenumbered(): boolean {
    if (this.kind !== "meshes" || this.isPreview) return true;
    const mesh = this.description as Mesh;
    const {
      duplicate_faces: doubles,
      degenerate_faces: flat,
      edges_flipped: flipped,
    } = mesh.repair;
    return doubles + flat + flipped + mesh.orientation.flipped_faces > 0;
  }

  /** Parses a compact point (`f:`, `p:`, `v:`) on this surface; returns null if it is invalid. */
  parse(text: string): Place | null {
    const xyz = parseXyz(text);
    if (xyz) return { face: 0, barycentric: [1, 0, 0], xyz, isFree: true };
    if (this.isPreview) return null;
    const point = parseCompact(text) ?? this.atVertex(text);
    return point && point.face < this.drawnFaces ? this.place(point.face, point.barycentric) : null;
  }

  /** Parses a vertex (`v:12`) as a face and weights; returns null if it is invalid. */
  private atVertex(text: string): { face: number; barycentric: Vec3 } | null {
    const vertex = /^v:(\d+)$/.exec(text.trim())?.[1];
    const corner = vertex && !this.isRenumbered ? this.triangles.faces.indexOf(Number(vertex)) : -1;
    if (corner < 0) return null;
    const barycentric: Vec3 = [0, 0, 0];
    barycentric[corner % 3] = 1;
    return { face: Math.floor(corner / 3), barycentric };
  }

  /**
   * Returns the first hit of a ray, which is in normalised coordinates, or null if there is no hit.
   */
  cast(origin: Vec3, direction: Vec3): Place | null {
    const hit = this.bvh.cast(origin, direction);
    if (!hit) return null;
    const place = this.place(hit.face, hit.barycentric);
    const { centre, radius } = this.frame;
    return this.isPreview
      ? { ...place, ray: { origin: add(scale(origin, radius), centre), direction } }
      : place;
  }

  /**
   * The places at which colours need exact values, or null if the values at the mesh's vertices are
   * enough.
   */
  get samples(): Place[] | null {
    if (this.fine) return this.fine.places;
    if (!this.isPreview) return null;
    const p = this.triangles.positions;
    return Array.from({ length: p.length / 3 }, (_, i) => ({
      face: 0,
      barycentric: [1, 0, 0],
      xyz: [p[3 * i]!, p[3 * i + 1]!, p[3 * i + 2]!],
      isFree: true,
    }));
  }

  /** Converts values at the vertices of the mesh to values at the drawn vertices. */
  spread(values: Float64Array): Float64Array {
    if (this.fine) return interpolated(this.fine, values, 1);
    const { copied } = this.shaded;
    if (copied.length === 0) return values;
    const all = new Float64Array(values.length + copied.length);
    all.set(values);
    copied.forEach((vertex, i) => (all[values.length + i] = values[vertex]!));
    return all;
  }

  /** Converts values at `samples` to values at the drawn vertices. */
  spreadSamples<T>(values: ArrayLike<T>): ArrayLike<T> {
    const { copied } = this.shaded;
    if (this.fine || copied.length === 0) return values;
    return [...Array.from(values), ...Array.from(copied, (vertex) => values[vertex]!)];
  }
}
