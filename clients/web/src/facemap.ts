// Stores for each pixel the face that it shows, the barycentric weights and the light. While a drag
// changes only values, the page computes frames from these data. Without a graphics card, this is
// much faster than drawing all triangles.

import {
  BufferGeometry,
  DataTexture,
  DoubleSide,
  FloatType,
  Mesh,
  MeshMatcapMaterial,
  NearestFilter,
  type PerspectiveCamera,
  Scene,
  type ShaderMaterial,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { FullScreenQuad } from "three/examples/jsm/postprocessing/Pass.js";
import type { Saved } from "./backdrop.ts";
import { pass } from "./passes.ts";
import { RAMP_COLOUR, RAMP_UNIFORMS, type Skin } from "./skin.ts";
import { studioLight } from "./studio.ts";

const ROW = 1024; /* texels per row of the texture of values, which has one texel per face */

const PLACE_PARS = `
flat varying int vFace;
varying vec2 vWeights;
#include <common>`;
const PLACE_VERTEX = `
#include <begin_vertex>
vFace = gl_VertexID / 3 + 1;
vWeights = vec2(gl_VertexID % 3 == 0, gl_VertexID % 3 == 1);`;
const PLACE = "gl_FragColor = vec4(float(vFace), vWeights, matcapColor.r);";

const RECOLOUR = `
uniform sampler2D colour;
uniform sampler2D depth;
uniform sampler2D places;
uniform sampler2D values;
uniform vec3 plain;
varying vec2 at;
${RAMP_UNIFORMS}
void main() {
  vec4 place = texelFetch(places, ivec2(gl_FragCoord.xy), 0);
  gl_FragDepth = texture2D(depth, at).r;
  gl_FragColor = texture2D(colour, at);
  if (place.x == 0.0) return;
  int face = int(place.x) - 1;
  vec3 corners = texelFetch(values, ivec2(face % ${ROW}, face / ${ROW}), 0).rgb;
  float vValue = dot(corners, vec3(place.yz, 1.0 - place.y - place.z));
  vec4 diffuseColor = vec4(plain, 1.0);
  ${RAMP_COLOUR}
  gl_FragColor = sRGBTransferOETF(vec4(diffuseColor.rgb * place.w, 1.0));
}`;

/** Returns a material whose colour has the face's number plus 1, two weights, and the light. */
function placeMaterial(flatShading: boolean): MeshMatcapMaterial {
  const made = new MeshMatcapMaterial({ matcap: studioLight(), side: DoubleSide, flatShading });
  made.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", PLACE_PARS)
      .replace("#include <begin_vertex>", PLACE_VERTEX);
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", PLACE_PARS)
      .replace("#include <dithering_fragment>", PLACE);
  };
  return made;
}

/** Returns the geometry without shared vertices: each vertex belongs to one corner of one face. */
function cornersOf({ geometry }: Mesh): BufferGeometry {
  const indexed = new BufferGeometry().setIndex(geometry.index);
  for (const name of ["position", "normal"])
    indexed.setAttribute(name, geometry.getAttribute(name));
  return indexed.toNonIndexed();
}

export class FaceMap {
  private readonly scene = new Scene();
  private readonly mesh: Mesh<BufferGeometry, MeshMatcapMaterial>;
  private readonly values: DataTexture;
  private readonly target = new WebGLRenderTarget(1, 1, {
    type: FloatType,
    magFilter: NearestFilter,
    minFilter: NearestFilter,
  });
  private readonly quad: FullScreenQuad;
  private isFresh = false;

  /** Borrows the skin. `saved` is the saved drawing, which has the pixels beside the surface. */
  constructor(
    private readonly skin: Skin,
    saved: Saved,
  ) {
    const { material } = skin.mesh;
    this.mesh = new Mesh(cornersOf(skin.mesh), placeMaterial(material.flatShading));
    this.scene.add(this.mesh);
    const rows = Math.ceil(skin.mesh.geometry.index!.count / 3 / ROW);
    this.values = new DataTexture(new Float32Array(4 * ROW * rows), ROW, rows);
    this.values.type = FloatType;
    this.quad = pass(RECOLOUR, {
      ...saved,
      ...skin.uniforms,
      places: { value: this.target.texture },
      values: { value: this.values },
      plain: { value: material.color },
    });
  }

  /** Invalidates the pixels, for example after the camera has moved. */
  invalidate(): void {
    this.isFresh = false;
  }

  /** Returns a pass that draws the saved drawing with the present values of the skin. */
  prepare(renderer: WebGLRenderer, camera: PerspectiveCamera): FullScreenQuad {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2());
    if (x !== this.target.width || y !== this.target.height) {
      this.target.setSize(x, y);
      this.isFresh = false;
    }
    if (!this.isFresh) this.capture(renderer, camera);
    this.readValues();
    return this.quad;
  }

  private capture(renderer: WebGLRenderer, camera: PerspectiveCamera): void {
    renderer.setRenderTarget(this.target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.scene, camera);
    this.isFresh = true;
  }

  private readValues(): void {
    const corners = this.skin.mesh.geometry.index!.array;
    const values = this.skin.mesh.geometry.getAttribute("value").array;
    const texels = this.values.image.data as Float32Array;
    for (let i = 0, at = 0; i < corners.length; i += 3, at += 4) {
      texels[at] = values[corners[i]!]!;
      texels[at + 1] = values[corners[i + 1]!]!;
      texels[at + 2] = values[corners[i + 2]!]!;
    }
    this.values.needsUpdate = true;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.values.dispose();
    this.target.dispose();
    (this.quad.material as ShaderMaterial).dispose();
    this.quad.dispose();
  }
}
