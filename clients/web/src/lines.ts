// Lines on the surface, some pixels wide. Parts behind the surface are drawn faintly.

import { Group } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import {
  GreaterDepth,
  NotEqualStencilFunc,
  ReplaceStencilOp,
  type ColorRepresentation,
} from "three";
import { encode } from "./passes.ts";
import { simplified } from "./simplified.ts";
import type { Vec3 } from "./vector.ts";

/**
 * Offset of lines towards the eye, in units of a 24-bit depth buffer. Without it, triangles that
 * approximate the surface would hide lines on the exact surface.
 */
const LIFT = 12000;
/* drawn lines leave out points that are at most this far from the rest of the line; this is less
 * than a pixel at any zoom */
const TOLERANCE = 1e-5;
const PREVIEW_LIFT = 4 * LIFT; /* a preview deviates more from the exact surface */

export interface LineStyle {
  colour: ColorRepresentation;
  width: number;
  /** Opacity of hidden parts, 0 to 1; 0.25 by default. */
  hidden?: number;
}

/** Returns six numbers per segment of the polylines: the coordinates of its two ends. */
function segmentsOf(polylines: Vec3[][]): Float32Array {
  const count = polylines.reduce((sum, line) => sum + Math.max(0, line.length - 1), 0);
  const ends = new Float32Array(6 * count);
  let at = 0;
  for (const line of polylines) {
    for (let i = 0; i + 1 < line.length; i++, at += 6) ends.set([...line[i]!, ...line[i + 1]!], at);
  }
  return ends;
}

/**
 * Returns a material for lines, or for the hidden parts of lines (`behind`). Segments overlap at
 * their round ends. The stencil blends each pixel of hidden parts once, so that many short segments
 * do not add up to an opaque line.
 */
function material(style: LineStyle, behind: boolean, lift: number): LineMaterial {
  const made = new LineMaterial({
    color: style.colour,
    linewidth: style.width,
    transparent: true,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetUnits: -lift,
  });
  made.onBeforeCompile = encode;
  if (behind) {
    made.depthFunc = GreaterDepth;
    made.opacity = style.hidden ?? 0.25;
    made.stencilWrite = true;
    made.stencilRef = 1;
    made.stencilFunc = NotEqualStencilFunc;
    made.stencilZPass = ReplaceStencilOp;
  }
  return made;
}

export class Lines {
  readonly group = new Group();
  /** Whether the lines lie on a preview. */
  isOverPreview = false;
  /**
   * Materials by style. They are reused, because three.js drops a program together with its last
   * material.
   */
  private readonly materials = new Map<string, LineMaterial>();
  private readonly sets = new Map<string, LineSegments2[]>();

  /** Shows polylines in normalised coordinates. Replaces the polylines with the same name. */
  set(name: string, polylines: Vec3[][], style: LineStyle): void {
    this.remove(name);
    const drawn = polylines.map((line) => simplified(line, (point) => point, TOLERANCE));
    const ends = segmentsOf(drawn);
    if (ends.length === 0) return;
    const geometry = new LineSegmentsGeometry().setPositions(ends);
    const objects = [false, true]
      .filter((behind) => !behind || style.hidden !== 0)
      .map((behind) => new LineSegments2(geometry, this.material(style, behind)));
    for (const object of objects) object.renderOrder = style.width;
    this.sets.set(name, objects);
    this.group.add(...objects);
  }

  private material(style: LineStyle, behind: boolean): LineMaterial {
    const lift = this.isOverPreview ? PREVIEW_LIFT : LIFT;
    const key = JSON.stringify([style, behind, lift]);
    if (!this.materials.has(key)) this.materials.set(key, material(style, behind, lift));
    return this.materials.get(key)!;
  }

  remove(name: string): void {
    for (const object of this.sets.get(name) ?? []) {
      object.geometry.dispose();
      this.group.remove(object);
    }
    this.sets.delete(name);
  }

  get isEmpty(): boolean {
    return this.sets.size === 0;
  }

  clear(): void {
    for (const name of [...this.sets.keys()]) this.remove(name);
  }
}
