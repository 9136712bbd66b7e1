// The points that a mode begins with if the user has set none.

import type { Place } from "./place.ts";
import type { Scene } from "./scene.ts";

/**
 * Start points lie on a ring of RING points about the middle of the picture. RADII, as fractions of
 * the picture, are tried in order until the point hits the surface.
 */
const RING = 6;
const RADII = [0.3, 0.22, 0.14, 0.07, 0];

export function spot(scene: Scene, i: number): Place | null {
  const { x, y } = scene.size;
  const angle = 2.4 + (2 * Math.PI * (i % RING)) / RING;
  for (const part of RADII) {
    const radius = part * Math.min(x, y) * (i < RING ? 1 : 0.5);
    const place = scene.pick({
      x: x / 2 + radius * Math.cos(angle),
      y: y / 2 + radius * Math.sin(angle),
    });
    if (place) return place;
  }
  return null;
}
