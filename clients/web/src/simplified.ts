// Leaves out points of a polyline (Douglas and Peucker 1973).

import { cross, length, subtract, unit, type Vec3 } from "./vector.ts";

/** Returns the point between two others that is farthest from their line, and its distance. */
function farthestOf(points: Vec3[], first: number, last: number): [number, number] {
  const along = unit(subtract(points[last]!, points[first]!));
  const isLoop = length(along) === 0;
  let [farthest, most] = [first, -1];
  for (let i = first + 1; i < last; i++) {
    const offset = subtract(points[i]!, points[first]!);
    const distance = length(isLoop ? offset : cross(along, offset));
    if (distance > most) [farthest, most] = [i, distance];
  }
  return [farthest, most];
}

/** Leaves out points that are at most `tolerance` away from the polyline of the others. */
export function simplified<T>(line: T[], xyzOf: (point: T) => Vec3, tolerance: number): T[] {
  if (line.length < 3) return line;
  const points = line.map(xyzOf);
  const isKept = points.map((_, i) => i === 0 || i + 1 === points.length);
  const parts: [number, number][] = [[0, points.length - 1]];
  for (let part = parts.pop(); part; part = parts.pop()) {
    const [first, last] = part;
    const [farthest, distance] = farthestOf(points, first, last);
    if (distance <= tolerance) continue;
    isKept[farthest] = true;
    parts.push([first, farthest], [farthest, last]);
  }
  return line.filter((_, i) => isKept[i]);
}
