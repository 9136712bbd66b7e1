// Lines on the surface, some pixels wide; where the surface hides them they shine through faintly.

import { Group } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { GreaterDepth, type ColorRepresentation } from "three";
import type { Vec3 } from "./vector.ts";

/**
 * How far lines are lifted towards the eye, in steps of a depth of 24 bits: over the triangles that stand for a smooth
 * surface, too.
 */
const LIFT = 12000;

export interface LineStyle {
  colour: ColorRepresentation;
  width: number;
  /** How much of it shows through the surface: 0 to 1, 0.25 unless it is said. */
  hidden?: number;
}

/** Pairs of ends, as the geometry wants them. */
function segmentsOf(polylines: Vec3[][]): Float32Array {
  const count = polylines.reduce((sum, line) => sum + Math.max(0, line.length - 1), 0);
  const ends = new Float32Array(6 * count);
  let at = 0;
  for (const line of polylines) {
    for (let i = 0; i + 1 < line.length; i++, at += 6) ends.set([...line[i]!, ...line[i + 1]!], at);
  }
  return ends;
}

function material(style: LineStyle, behind: boolean): LineMaterial {
  const made = new LineMaterial({
    color: style.colour,
    linewidth: style.width,
    transparent: true,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetUnits: -LIFT,
  });
  if (behind) {
    made.depthFunc = GreaterDepth;
    made.opacity = style.hidden ?? 0.25;
  }
  return made;
}

export class Lines {
  readonly group = new Group();
  /**
   * Kept: with its last material a program of the graphics card would go, and be compiled again for the next answer.
   */
  private readonly materials = new Map<string, LineMaterial>();
  private readonly sets = new Map<string, LineSegments2[]>();

  /** Shows polylines of the frame under a name, in the place of what had that name. */
  set(name: string, polylines: Vec3[][], style: LineStyle): void {
    this.remove(name);
    const ends = segmentsOf(polylines);
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
    const key = JSON.stringify([style, behind]);
    if (!this.materials.has(key)) this.materials.set(key, material(style, behind));
    return this.materials.get(key)!;
  }

  remove(name: string): void {
    for (const object of this.sets.get(name) ?? []) {
      object.geometry.dispose();
      this.group.remove(object);
    }
    this.sets.delete(name);
  }

  clear(): void {
    for (const name of [...this.sets.keys()]) this.remove(name);
  }
}
