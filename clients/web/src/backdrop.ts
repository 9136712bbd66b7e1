// The surface as it was drawn last, with its depth. While only lines and points change, a frame copies it instead of
// drawing every triangle again: a path is dragged over a million faces as smoothly as over a thousand.

import {
  BufferAttribute,
  BufferGeometry,
  type Camera,
  DepthTexture,
  Mesh,
  NoBlending,
  NearestFilter,
  OrthographicCamera,
  Scene,
  ShaderMaterial,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";

const VERTEX = `
varying vec2 at;
void main() {
  at = position.xy * 0.5 + 0.5;
  gl_Position = vec4(position, 1.0);
}`;
const FRAGMENT = `
uniform sampler2D colour;
uniform sampler2D depth;
varying vec2 at;
void main() {
  gl_FragColor = texture2D(colour, at);
  gl_FragDepth = texture2D(depth, at).r;
}`;

/** One triangle that covers the picture. */
function cover(): BufferGeometry {
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  return new BufferGeometry().setAttribute("position", new BufferAttribute(corners, 3));
}

export class Backdrop {
  private readonly target: WebGLRenderTarget;
  private readonly copy = new Scene();
  private readonly camera = new OrthographicCamera();
  private isFresh = false;

  /** `samples` a pixel, for smooth edges. */
  constructor(samples: number) {
    const depthTexture = new DepthTexture(1, 1);
    this.target = new WebGLRenderTarget(1, 1, {
      samples,
      magFilter: NearestFilter,
      minFilter: NearestFilter,
      depthTexture,
    });
    const uniforms = { colour: { value: this.target.texture }, depth: { value: this.target.depthTexture } };
    const material = new ShaderMaterial({
      uniforms,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      blending: NoBlending,
    });
    const quad = new Mesh(cover(), material);
    quad.frustumCulled = false;
    this.copy.add(quad);
  }

  /** What was drawn is no more what is there. */
  spoil(): void {
    this.isFresh = false;
  }

  /** Puts the scene on the screen, with its depth; from the copy, if there is a fresh one. */
  draw(renderer: WebGLRenderer, scene: Scene, camera: Camera): void {
    if (!this.isFresh) this.capture(renderer, scene, camera);
    renderer.setRenderTarget(null);
    renderer.render(this.copy, this.camera);
  }

  private capture(renderer: WebGLRenderer, scene: Scene, camera: Camera): void {
    const size = renderer.getDrawingBufferSize(new Vector2());
    if (size.x !== this.target.width || size.y !== this.target.height) this.target.setSize(size.x, size.y);
    renderer.setRenderTarget(this.target);
    renderer.render(scene, camera);
    this.isFresh = true;
  }
}
