// A point of a surface as the page knows it: in a face of the mesh that is shown.

import type { Point, PointAnswer } from "../../js/types.d.ts";
import type { Vec3 } from "./vector.ts";

export interface Place {
  face: number;
  barycentric: Vec3;
  /** In the file's unit. */
  xyz: Vec3;
}

/** Six digits are finer than any screen; the last weight makes the sum 1. */
export function rounded(barycentric: Vec3): Vec3 {
  const [a, b] = [Number(barycentric[0].toFixed(6)), Number(barycentric[1].toFixed(6))];
  return [a, b, Math.max(0, Number((1 - a - b).toFixed(6)))];
}

export const pointOf = (place: Place): Point => ({ face: place.face, barycentric: place.barycentric });

/** As in the query string of the API: `f:34:0.2,0.3,0.5`. */
export const compactOf = (place: Place): string => `f:${place.face}:${place.barycentric.join(",")}`;

export function placeOf(answer: PointAnswer): Place {
  return { face: answer.face!, barycentric: answer.barycentric as Vec3, xyz: answer.xyz as Vec3 };
}

/** The face and weights of a compact point of that form, or null. */
export function parseCompact(text: string): { face: number; barycentric: Vec3 } | null {
  const match = /^f:(\d+):([^,]+),([^,]+),([^,]+)$/.exec(text.trim());
  if (!match) return null;
  const barycentric: Vec3 = [Number(match[2]), Number(match[3]), Number(match[4])];
  return barycentric.every(Number.isFinite) ? { face: Number(match[1]), barycentric } : null;
}
