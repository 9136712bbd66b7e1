// Saves the last drawing of the surface with its depth. While only lines and points change, a frame
// copies the saved drawing instead of drawing all triangles. So a drag of a path is equally fast on
// a thousand and on a million faces. A fine drawing has smooth edges and ambient occlusion.

import {
  type Camera,
  DepthTexture,
  NearestFilter,
  type PerspectiveCamera,
  type Scene,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { FullScreenQuad } from "three/examples/jsm/postprocessing/Pass.js";
import { pass } from "./passes.ts";

const SAMPLES = 4; /* samples of each pixel, for smooth edges */

const COPY = `
uniform sampler2D colour;
uniform sampler2D depth;
varying vec2 at;
void main() {
  gl_FragColor = texture2D(colour, at);
  gl_FragDepth = texture2D(depth, at).r;
}`;

/**
 * Computes ambient occlusion from depth (Mittring 2007; Bavoil and Sainz 2008). Samples lie on a
 * spiral around the pixel. The occlusion is the fraction of samples in front of the pixel's tangent
 * plane. Each pixel of a block of 4 x 4 rotates the spiral by a different angle.
 */
const OCCLUSION = `
#include <packing>
uniform sampler2D depth;
uniform vec2 clip;
uniform vec2 tangents;
uniform vec2 pixel;
varying vec2 at;
const float RADIUS = 0.12;
const int POINTS = 16;
vec3 seen(vec2 spot) {
  float z = -perspectiveDepthToViewZ(texture2D(depth, spot).r, clip.x, clip.y);
  return vec3((2.0 * spot - 1.0) * tangents * z, -z);
}
vec3 slope(vec3 here, vec2 step) {
  vec3 after = seen(at + step) - here;
  vec3 before = here - seen(at - step);
  return abs(after.z) < abs(before.z) ? after : before;
}
void main() {
  gl_FragColor = vec4(1.0);
  if (texture2D(depth, at).r == 1.0) return;
  vec3 here = seen(at);
  vec3 normal = normalize(cross(slope(here, vec2(pixel.x, 0.0)), slope(here, vec2(0.0, pixel.y))));
  vec2 cell = mod(floor(gl_FragCoord.xy), 4.0);
  float angle = 6.2831853 * mod(cell.x * 4.0 + cell.y * 7.0, 16.0) / 16.0;
  float hidden = 0.0;
  for (int i = 0; i < POINTS; i++) {
    float reach = RADIUS * (float(i) + 0.5) / float(POINTS);
    float turn = angle + 2.3999632 * float(i);
    vec2 spot = at + reach * vec2(cos(turn), sin(turn)) / (2.0 * tangents * -here.z);
    vec3 towards = seen(spot) - here;
    float size = length(towards) + 1e-5;
    hidden += max(0.0, dot(towards, normal) / size - 0.15) * (1.0 - smoothstep(RADIUS, 2.0 * RADIUS, size));
  }
  gl_FragColor = vec4(vec3(1.0 - min(0.7, 1.5 * hidden / float(POINTS))), 1.0);
}`;

/**
 * Multiplies each colour by a mean occlusion. The mean covers those pixels of a 4 x 4 block whose
 * depth is similar.
 */
const SHADE = `
#include <packing>
uniform sampler2D colour;
uniform sampler2D depth;
uniform sampler2D light;
uniform vec2 clip;
uniform vec2 pixel;
varying vec2 at;
float away(vec2 spot) {
  return -perspectiveDepthToViewZ(texture2D(depth, spot).r, clip.x, clip.y);
}
void main() {
  gl_FragColor = texture2D(colour, at);
  if (texture2D(depth, at).r == 1.0) return;
  float here = away(at);
  float sum = 1e-3;
  float weights = 1e-3;
  for (int i = 0; i < 16; i++) {
    vec2 spot = at + (vec2(float(i / 4), float(i - 4 * (i / 4))) - 1.5) * pixel;
    float weight = max(0.0, 1.0 - 30.0 * abs(away(spot) - here));
    sum += weight * texture2D(light, spot).r;
    weights += weight;
  }
  gl_FragColor.rgb *= sum / weights;
}`;

const flatTarget = (): WebGLRenderTarget =>
  new WebGLRenderTarget(1, 1, {
    magFilter: NearestFilter,
    minFilter: NearestFilter,
    depthBuffer: false,
  });

/** The textures of a saved drawing, as uniforms of a pass. */
export interface Saved {
  colour: { value: unknown };
  depth: { value: unknown };
}

class Picture {
  readonly target: WebGLRenderTarget;
  readonly uniforms: Saved;

  constructor(samples: number) {
    const depthTexture = new DepthTexture(1, 1);
    this.target = new WebGLRenderTarget(1, 1, {
      samples,
      magFilter: NearestFilter,
      minFilter: NearestFilter,
      depthTexture,
    });
    this.uniforms = { colour: { value: this.target.texture }, depth: { value: depthTexture } };
  }

  fit(size: Vector2): void {
    if (size.x !== this.target.width || size.y !== this.target.height)
      this.target.setSize(size.x, size.y);
  }
}

export class Backdrop {
  private readonly quick = new Picture(0);
  private readonly fine = new Picture(SAMPLES);
  private readonly light = flatTarget();
  private readonly shaded = flatTarget();
  readonly saved: Saved = { colour: { value: null }, depth: { value: null } };
  private readonly copy = pass(COPY, { ...this.saved });
  private readonly lens = {
    clip: { value: new Vector2() },
    tangents: { value: new Vector2() },
    pixel: { value: new Vector2() },
    light: { value: this.light.texture },
  };
  private readonly occlusion = pass(OCCLUSION, { ...this.fine.uniforms, ...this.lens });
  private readonly shade = pass(SHADE, { ...this.fine.uniforms, ...this.lens });
  private fresh: "none" | "quick" | "fine" = "none";

  /** Drops the saved drawing; the next frame draws the surface again. */
  invalidate(): void {
    this.fresh = "none";
  }

  get isFine(): boolean {
    return this.fresh === "fine";
  }

  /**
   * Draws the scene through the saved drawing. Renders the scene into the saved drawing first if
   * that is missing or not fine enough. `pass` draws colour and depth; the default copies them.
   */
  draw(
    renderer: WebGLRenderer,
    scene: Scene,
    camera: PerspectiveCamera,
    { wantsFine, pass = this.copy }: { wantsFine: boolean; pass?: FullScreenQuad },
  ): void {
    const target = renderer.getRenderTarget();
    if (wantsFine && this.fresh !== "fine") this.captureFine(renderer, scene, camera);
    else if (this.fresh === "none") this.capture(renderer, scene, camera, this.quick);
    const shown = this.isFine ? this.fine : this.quick;
    this.saved.colour.value = this.isFine ? this.shaded.texture : this.quick.target.texture;
    this.saved.depth.value = shown.target.depthTexture;
    renderer.setRenderTarget(target);
    pass.render(renderer);
  }

  private capture(renderer: WebGLRenderer, scene: Scene, camera: Camera, picture: Picture): void {
    picture.fit(renderer.getDrawingBufferSize(new Vector2()));
    renderer.setRenderTarget(picture.target);
    renderer.render(scene, camera);
    this.fresh = "quick";
  }

  private captureFine(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera): void {
    this.capture(renderer, scene, camera, this.fine);
    const { width, height } = this.fine.target;
    const upright = 1 / camera.projectionMatrix.elements[5]!;
    this.lens.clip.value.set(camera.near, camera.far);
    this.lens.tangents.value.set(upright * camera.aspect, upright);
    this.lens.pixel.value.set(1 / width, 1 / height);
    for (const target of [this.light, this.shaded]) target.setSize(width, height);
    renderer.setRenderTarget(this.light);
    this.occlusion.render(renderer);
    renderer.setRenderTarget(this.shaded);
    this.shade.render(renderer);
    this.fresh = "fine";
  }
}
