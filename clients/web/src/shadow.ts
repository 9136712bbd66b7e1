// Draws a soft shadow of the surface on the ground. Computes its texture once for each surface and
// upward axis: the height of the surface above the ground, blurred.

import {
  DoubleSide,
  Mesh,
  MeshBasicMaterial,
  NoBlending,
  OrthographicCamera,
  PlaneGeometry,
  Scene,
  ShaderMaterial,
  Vector3,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { encode, pass } from "./passes.ts";

const SIZE = 256; /* pixels of the texture along each axis */
const REACH = 1.6; /* half the side of the ground, in normalised coordinates */
const DARKNESS = 0.42;
const PASSES = [1.2, 2.6, 4.5]; /* step of each blur, in pixels */

const BLUR = `
uniform sampler2D from;
uniform vec2 step;
varying vec2 at;
void main() {
  float sum = 0.0;
  float weights = 0.0;
  for (int i = -4; i <= 4; i++) {
    float weight = exp(-0.12 * float(i * i));
    sum += weight * texture2D(from, at + float(i) * step).a;
    weights += weight;
  }
  gl_FragColor = vec4(0.0, 0.0, 0.0, sum / weights);
}`;
/** Shaders of the shadow: opaque where the surface touches the ground, fainter with height. */
const HEIGHT_VERTEX =
  "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }";
const HEIGHT =
  "void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, (1.0 - gl_FragCoord.z) * (1.0 - gl_FragCoord.z)); }";

export class Shadow {
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;
  private readonly targets = [0, 1].map(() => new WebGLRenderTarget(SIZE, SIZE));
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera(-REACH, REACH, REACH, -REACH, 0, 2);
  private readonly uniforms = { from: { value: null as unknown }, step: { value: [0, 0] } };
  private readonly blur = pass(BLUR, this.uniforms);

  constructor() {
    this.scene.overrideMaterial = new ShaderMaterial({
      vertexShader: HEIGHT_VERTEX,
      fragmentShader: HEIGHT,
      side: DoubleSide,
      blending: NoBlending,
    });
    const material = new MeshBasicMaterial({
      map: this.targets[0]!.texture,
      transparent: true,
      opacity: DARKNESS,
      side: DoubleSide,
      depthWrite: false,
    });
    material.onBeforeCompile = encode;
    this.mesh = new Mesh(new PlaneGeometry(2 * REACH, 2 * REACH), material);
    this.mesh.renderOrder = -1;
    this.mesh.visible = false;
  }

  /**
   * Casts the shadow of a mesh in normalised coordinates. `low` is the mesh's lowest level along
   * `up`.
   */
  cast(renderer: WebGLRenderer, surface: Mesh, up: "y" | "z", low: number): void {
    const axis = up === "y" ? new Vector3(0, 1, 0) : new Vector3(0, 0, 1);
    this.camera.position.copy(axis).multiplyScalar(low);
    this.camera.up.set(up === "y" ? 0 : 1, 0, up === "y" ? 1 : 0);
    this.camera.lookAt(this.camera.position.clone().add(axis));
    this.mesh.position.copy(axis).multiplyScalar(low - 0.004);
    this.mesh.quaternion.copy(this.camera.quaternion);
    const caster = new Mesh(surface.geometry);
    this.scene.add(caster);
    renderer.setRenderTarget(this.targets[0]!);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.scene, this.camera);
    this.scene.remove(caster);
    for (const width of PASSES) {
      this.pass(renderer, 0, [width / SIZE, 0]);
      this.pass(renderer, 1, [0, width / SIZE]);
    }
    renderer.setRenderTarget(null);
    this.mesh.visible = true;
  }

  /** Blurs one target along `step` into the other. */
  private pass(renderer: WebGLRenderer, from: number, step: [number, number]): void {
    this.uniforms.from.value = this.targets[from]!.texture;
    this.uniforms.step.value = step;
    renderer.setRenderTarget(this.targets[1 - from]!);
    this.blur.render(renderer);
  }
}
