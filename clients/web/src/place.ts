// A place: a point of a surface, given by a face of the drawn mesh and barycentric coordinates.

import type { Arrays } from "../../js/index.js";
import type { Point, PointAnswer } from "../../js/types.d.ts";
import { type Api, ApiError } from "./api.ts";
import type { Vec3 } from "./vector.ts";

export interface Place {
  face: number;
  barycentric: Vec3;
  /** The coordinates in the file's unit. */
  xyz: Vec3;
  /**
   * True if face numbers of the daemon differ from those of the drawn mesh. Requests then contain
   * the point's coordinates instead of its face.
   */
  isFree?: boolean;
  /** The ray that hit the preview here. The daemon computes where it hits the original mesh. */
  ray?: { origin: Vec3; direction: Vec3 };
}

/** Rounds weights to six digits, finer than a pixel. The last weight makes the sum 1. */
export function rounded(barycentric: Vec3): Vec3 {
  const [a, b] = [Number(barycentric[0].toFixed(6)), Number(barycentric[1].toFixed(6))];
  return [a, b, Math.max(0, Number((1 - a - b).toFixed(6)))];
}

export function pointOf({ face, barycentric, xyz, isFree, ray }: Place): Point {
  if (ray) return { ray };
  return isFree ? { xyz } : { face, barycentric };
}

/** Returns a point as arrays of the API, whose names begin with `name`. */
export function arraysOf(name: string, { face, barycentric, xyz, isFree }: Place): Arrays {
  if (isFree) return { [name]: Float64Array.from(xyz) };
  return {
    [`${name}_face`]: Uint32Array.of(face),
    [`${name}_barycentric`]: Float64Array.from(barycentric),
  };
}

/** Returns the compact form of the API: `f:34:0.2,0.3,0.5`. */
export const compactOf = ({ face, barycentric, xyz, isFree }: Place): string =>
  isFree ? `p:${xyz.join(",")}` : `f:${face}:${barycentric.join(",")}`;

/** Converts a point of an answer to a place. */
export function placeOf(answer: PointAnswer, isFree: boolean): Place {
  return {
    face: answer.face!,
    barycentric: answer.barycentric as Vec3,
    xyz: answer.xyz as Vec3,
    isFree,
  };
}

/** Parses a compact point in space (`p:1,2,3`); returns null for any other text. */
export function parseXyz(text: string): Vec3 | null {
  const numbers = /^p:(.*)$/.exec(text.trim())?.[1]?.split(",").map(Number) ?? [];
  return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vec3) : null;
}

const WEIGHT_ERROR = 1e-5; /* the sum of weights in an address may differ from 1 by this */

/** Parses a compact point in a face (`f:…`); returns null for any other text. */
export function parseCompact(text: string): { face: number; barycentric: Vec3 } | null {
  const match = /^f:(\d+):([^,]+),([^,]+),([^,]+)$/.exec(text.trim());
  if (!match) return null;
  const barycentric: Vec3 = [Number(match[2]), Number(match[3]), Number(match[4])];
  const [a, b, c] = barycentric;
  const isInside = Math.min(a, b, c) >= 0 && Math.abs(a + b + c - 1) <= WEIGHT_ERROR;
  return isInside ? { face: Number(match[1]), barycentric } : null;
}

/** Moves a place that was picked on a preview to the original mesh. */
export async function snapped(
  api: Api,
  path: string,
  place: Place,
  signal: AbortSignal,
): Promise<Place> {
  if (!place.ray) return place;
  const nearest = (point: Point): Promise<PointAnswer> =>
    api.json<PointAnswer>({ method: "POST", path: `${path}/nearest`, json: { point } }, signal);
  try {
    return placeOf(await nearest({ ray: place.ray }), true);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    return placeOf(
      await nearest({ xyz: place.xyz }),
      true,
    ); /* near the outline, the ray misses the original */
  }
}
