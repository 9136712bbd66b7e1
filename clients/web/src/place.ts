// A point of a surface as the page knows it: in a face of the mesh that is shown.

import type { Point, PointAnswer } from "../../js/types.d.ts";
import type { Vec3 } from "./vector.ts";

export interface Place {
  face: number;
  barycentric: Vec3;
  /** In the file's unit. */
  xyz: Vec3;
  /**
   * The daemon knows the faces of this surface otherwise than its file tells them, so the point is told by its
   * coordinates.
   */
  isFree?: boolean;
}

/** Six digits are finer than any screen; the last weight makes the sum 1. */
export function rounded(barycentric: Vec3): Vec3 {
  const [a, b] = [Number(barycentric[0].toFixed(6)), Number(barycentric[1].toFixed(6))];
  return [a, b, Math.max(0, Number((1 - a - b).toFixed(6)))];
}

export const pointOf = ({ face, barycentric, xyz, isFree }: Place): Point => (isFree ? { xyz } : { face, barycentric });

/** As in the query string of the API: `f:34:0.2,0.3,0.5`. */
export const compactOf = ({ face, barycentric, xyz, isFree }: Place): string =>
  isFree ? `p:${xyz.join(",")}` : `f:${face}:${barycentric.join(",")}`;

/** What the daemon says of a point. */
export function placeOf(answer: PointAnswer, isFree: boolean): Place {
  return { face: answer.face!, barycentric: answer.barycentric as Vec3, xyz: answer.xyz as Vec3, isFree };
}

/** The coordinates of a compact point of space, or null. */
export function parseXyz(text: string): Vec3 | null {
  const numbers = /^p:(.*)$/.exec(text.trim())?.[1]?.split(",").map(Number) ?? [];
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vec3) : null;
}

/** The face and weights of a compact point of that form, or null. */
export function parseCompact(text: string): { face: number; barycentric: Vec3 } | null {
  const match = /^f:(\d+):([^,]+),([^,]+),([^,]+)$/.exec(text.trim());
  if (!match) return null;
  const barycentric: Vec3 = [Number(match[2]), Number(match[3]), Number(match[4])];
  return barycentric.every(Number.isFinite) ? { face: Number(match[1]), barycentric } : null;
}
