// Studio light as a matcap: a texture of a lit sphere, which shaders read at the normal. This needs
// one texture read per pixel; lights would be slower without a graphics card.

import { DataTexture, LinearFilter, SRGBColorSpace } from "three";
import { dot, unit, type Vec3 } from "./vector.ts";

const SIZE = 256;
const KEY = unit([-0.55, 0.75, 0.65]); /* a large soft lamp, left above the camera */
const FILL = unit([0.8, 0.1, 0.5]);
const HALF = unit([KEY[0], KEY[1], KEY[2] + 1]); /* halfway between key lamp and camera */

let texture: DataTexture | undefined;

/** Returns the brightness, in sRGB, of a surface with a normal that faces the camera. */
function brightness(normal: Vec3): number {
  const key = Math.max(0, (dot(normal, KEY) + 0.4) / 1.4);
  const fill = Math.max(0, (dot(normal, FILL) + 0.5) / 1.5);
  const rim = (1 - normal[2]) ** 3 * Math.max(0, 0.3 + 0.7 * normal[1]);
  const gloss = Math.max(0, dot(normal, HALF)) ** 40;
  return 0.44 + 0.52 * key ** 1.2 + 0.14 * fill + 0.14 * rim + 0.06 * gloss;
}

/** Returns the texture, which all surfaces share. */
export function studioLight(): DataTexture {
  if (texture) return texture;
  const bytes = new Uint8Array(4 * SIZE * SIZE);
  for (let i = 0; i < SIZE * SIZE; i++) {
    const [x, y] = [i % SIZE, Math.floor(i / SIZE)].map((at) => (2 * (at + 0.5)) / SIZE - 1) as [
      number,
      number,
    ];
    const radius = Math.hypot(x, y);
    const limit = radius > 0.999 ? 0.999 / radius : 1;
    const normal: Vec3 = [x * limit, y * limit, Math.sqrt(1 - Math.min(0.998, radius * radius))];
    const grey = Math.round(255 * Math.min(1, brightness(normal)));
    bytes.set([grey, grey, grey, 255], 4 * i);
  }
  texture = new DataTexture(bytes, SIZE, SIZE);
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}
