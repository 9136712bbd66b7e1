// Draws the triangles of a surface in studio light, with a colour map of values, isolines, or a
// colour per vertex.

import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DoubleSide,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  MeshMatcapMaterial,
  type Plane,
  SRGBColorSpace,
} from "three";
import type { Piece } from "./cells.ts";
import { type ColourMap, type Rgb, rampBytes, toLinear } from "./colours.ts";
import type { Shaded } from "./creases.ts";
import { encode } from "./passes.ts";
import { type Fine, interpolated } from "./fine.ts";
import { studioLight } from "./studio.ts";
import type { Vec3 } from "./vector.ts";

const RAMP_SIZE = 256;

export const SHADINGS = { creases: "smooth, sharp at creases", flat: "flat faces" };
export type Shading = keyof typeof SHADINGS;

/**
 * Shaders that colour by value. Values lie in [0, 1]; a negative value means the plain colour.
 * Isolines have the same width on the screen everywhere.
 */
const RAMP_VERTEX = `
attribute float value;
varying float vValue;
#include <common>`;
export const RAMP_UNIFORMS = `
uniform sampler2D ramp;
uniform vec2 ends;
uniform float isolines;`;
const RAMP_FRAGMENT = `
${RAMP_UNIFORMS}
varying float vValue;
#include <common>`;
export const RAMP_COLOUR = `
if (vValue >= 0.0) {
  float part = clamp((vValue - ends.x) / (ends.y - ends.x), 0.0, 1.0);
  float texel = (part * ${RAMP_SIZE - 1}.0 + 0.5) / ${RAMP_SIZE}.0;
  diffuseColor.rgb = texture2D(ramp, vec2(texel, 0.5)).rgb;
  float level = vValue * (isolines + 1.0);
  float pixels = abs(level - round(level)) / max(fwidth(level), 1e-6);
  if (round(level) > 0.5 && round(level) < isolines + 0.5)
    diffuseColor.rgb *= mix(0.12, 1.0, smoothstep(0.4, 1.1, pixels));
}`;

/** Shader of edges. Edges fade if they are only some pixels long. */
const EDGE_FRAGMENT = `
uniform float edgePixels;
#include <common>`;
const EDGE_COLOUR = `
#include <color_fragment>
diffuseColor.a *= smoothstep(1.5, 9.0, edgePixels * gl_FragCoord.w);`;

function rampTexture({ ramp }: ColourMap): DataTexture {
  const texture = new DataTexture(rampBytes(ramp, RAMP_SIZE), RAMP_SIZE, 1);
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function geometryOf(positions: Float32Array, faces: Uint32Array): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  return geometry.setIndex(new BufferAttribute(faces, 1));
}

function drawn(shaded: Shaded, fine: Fine | null): BufferGeometry {
  if (!fine) {
    const geometry = geometryOf(shaded.positions, shaded.faces);
    return geometry.setAttribute("normal", new BufferAttribute(shaded.normals, 3));
  }
  const normals = Float32Array.from(interpolated(fine, shaded.normals, 3));
  return geometryOf(fine.positions, fine.faces).setAttribute(
    "normal",
    new BufferAttribute(normals, 3),
  );
}

/** Returns linear bytes of a colour. */
const bytesOf = (rgb: Rgb): number[] => rgb.map((c) => Math.round(255 * toLinear(c)));

/** Returns the triangles of pieces of faces, with normals interpolated in the faces. */
function pieceGeometry(shaded: Shaded, pieces: Piece[], colours: Rgb[]): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  const bytes: number[] = [];
  const indices: number[] = [];
  const push = (to: number[], from: Float32Array, face: number, weights: Vec3): void => {
    for (let axis = 0; axis < 3; axis++) {
      const at = (i: number): number => from[3 * shaded.faces[3 * face + i]! + axis]!;
      to.push(weights[0] * at(0) + weights[1] * at(1) + weights[2] * at(2));
    }
  };
  pieces.forEach(({ face, corners }, i) => {
    const first = positions.length / 3;
    for (const weights of corners) {
      push(positions, shaded.positions, face, weights);
      push(normals, shaded.normals, face, weights);
      bytes.push(...bytesOf(colours[i]!));
    }
    for (let j = 2; j < corners.length; j++) indices.push(first, first + j - 1, first + j);
  });
  const geometry = geometryOf(Float32Array.from(positions), Uint32Array.from(indices));
  geometry.setAttribute("normal", new BufferAttribute(Float32Array.from(normals), 3));
  return geometry.setAttribute("color", new BufferAttribute(Uint8Array.from(bytes), 3, true));
}

/** Returns the mean length of the first edges of a sample of the faces. */
function meanEdge({ positions, faces }: { positions: Float32Array; faces: Uint32Array }): number {
  const step = 3 * Math.max(1, Math.floor(faces.length / 3000));
  let [sum, count] = [0, 0];
  for (let i = 0; i < faces.length; i += step, count++) {
    const [a, b] = [3 * faces[i]!, 3 * faces[i + 1]!];
    sum += Math.hypot(...[0, 1, 2].map((axis) => positions[a + axis]! - positions[b + axis]!));
  }
  return sum / count;
}

export class Skin {
  readonly mesh: Mesh<BufferGeometry, MeshMatcapMaterial>;
  private edges: Mesh<BufferGeometry, MeshBasicMaterial> | undefined;
  /** Pieces of faces, drawn over the faces. */
  private pieces: Mesh<BufferGeometry, MeshMatcapMaterial> | undefined;
  /** Uniforms: the colour map, the values at its ends, and the number of isolines. */
  readonly uniforms = {
    ramp: { value: null as DataTexture | null },
    ends: { value: [0, 1] },
    isolines: { value: 0 },
  };
  private isFlat: boolean;

  /**
   * Borrows the arrays. `own` has the triangles of the mesh. If `fine`, a refined mesh, is given,
   * it is drawn instead.
   */
  constructor(
    private readonly own: { positions: Float32Array; faces: Uint32Array },
    private readonly shaded: Shaded,
    private readonly fine: Fine | null = null,
  ) {
    this.isFlat = fine !== null;
    const geometry = drawn(shaded, fine);
    const vertexCount = geometry.getAttribute("position").count;
    geometry.setAttribute("value", new BufferAttribute(new Float32Array(vertexCount).fill(-1), 1));
    this.mesh = new Mesh(geometry, this.rampMaterial());
  }

  /** Returns a material in studio light, `offset` behind lines and edges. */
  private material(offset: number): MeshMatcapMaterial {
    const material = new MeshMatcapMaterial({
      matcap: studioLight(),
      side: DoubleSide,
      flatShading: this.isFlat,
      polygonOffset: true,
      polygonOffsetFactor: offset,
      polygonOffsetUnits: offset,
    });
    material.onBeforeCompile = encode;
    return material;
  }

  private rampMaterial(): MeshMatcapMaterial {
    const material = this.material(1);
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms);
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", RAMP_VERTEX)
        .replace("#include <begin_vertex>", "#include <begin_vertex>\nvValue = value;");
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", RAMP_FRAGMENT)
        .replace("#include <color_fragment>", `#include <color_fragment>${RAMP_COLOUR}`);
      encode(shader);
    };
    return material;
  }

  setColour(colour: string): void {
    this.mesh.material.color.set(colour);
  }

  private get materials(): MeshMatcapMaterial[] {
    return this.pieces ? [this.mesh.material, this.pieces.material] : [this.mesh.material];
  }

  /** Hides the parts of the surface behind the planes. */
  set clippingPlanes(planes: Plane[] | null) {
    for (const material of this.materials) material.clippingPlanes = planes;
  }

  /** Sets the shading. A refined mesh always has flat shading. */
  setShading(shading: Shading): void {
    const isFlat = shading === "flat" || this.fine !== null;
    if (isFlat === this.isFlat) return;
    this.isFlat = isFlat;
    for (const material of this.materials) {
      material.flatShading = isFlat;
      material.needsUpdate = true;
    }
  }

  /** Whether only values colour the surface, without edges or colours per vertex. */
  get showsValuesAlone(): boolean {
    return !this.edges?.visible && !this.mesh.material.vertexColors && this.mesh.visible;
  }

  /** Shows or hides the edges of the triangles. */
  showEdges(show: boolean): void {
    if (show && !this.edges) this.edges = this.makeEdges();
    if (this.edges) this.edges.visible = show;
  }

  private makeEdges(): Mesh<BufferGeometry, MeshBasicMaterial> {
    const material = new MeshBasicMaterial({
      wireframe: true,
      color: "#10181c",
      transparent: true,
      opacity: 0.45,
    });
    const edgePixels = { value: 0 };
    const length = meanEdge(this.own);
    material.onBeforeCompile = (shader) => {
      shader.uniforms.edgePixels = edgePixels;
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", EDGE_FRAGMENT)
        .replace("#include <color_fragment>", EDGE_COLOUR);
      encode(shader);
    };
    const edges = new Mesh(geometryOf(this.own.positions, this.own.faces), material);
    edges.onBeforeRender = (renderer, _scene, camera) => {
      edgePixels.value =
        (length * camera.projectionMatrix.elements[5]! * renderer.domElement.height) / 2;
    };
    this.mesh.add(edges);
    return edges;
  }

  setColours(colours: ColourMap): void {
    this.uniforms.ramp.value?.dispose();
    this.uniforms.ramp.value = rampTexture(colours);
    this.uniforms.ends.value = [colours.low, colours.high];
  }

  /** Sets the number of isolines, at equal steps between 0 and the largest value. */
  setIsolines(count: number): void {
    this.uniforms.isolines.value = count;
  }

  /** Shows a value, 0 to `max`, at each drawn vertex. NaN shows the plain colour. */
  showValues(values: ArrayLike<number>, max: number): void {
    const attribute = this.mesh.geometry.getAttribute("value") as BufferAttribute;
    const array = attribute.array as Float32Array;
    for (let i = 0; i < array.length; i++) {
      const value = values[i]! / max;
      array[i] = Number.isFinite(value) ? Math.min(1, Math.max(0, value)) : -1;
    }
    attribute.needsUpdate = true;
  }

  /** Colours each drawn vertex by its label. The label null shows the plain colour. */
  showLabels(labels: ArrayLike<number | null>, colours: Rgb[], plain: Rgb): void {
    const [plainBytes, colourBytes] = [bytesOf(plain), colours.map(bytesOf)];
    const array = new Uint8ClampedArray(3 * labels.length);
    for (let i = 0; i < labels.length; i++) {
      const label = labels[i]!;
      array.set((label === null ? undefined : colourBytes[label]) ?? plainBytes, 3 * i);
    }
    this.mesh.geometry.setAttribute("color", new BufferAttribute(array, 3, true));
    this.useVertexColours(true);
  }

  /** Draws pieces of faces over the faces, each in its colour. */
  showPieces(pieces: Piece[], colours: Rgb[]): void {
    this.pieces ??= this.makePieces();
    this.pieces.geometry.dispose();
    this.pieces.geometry = pieceGeometry(this.shaded, pieces, colours);
    this.pieces.visible = true;
  }

  private makePieces(): Mesh<BufferGeometry, MeshMatcapMaterial> {
    const material = this.material(0.5);
    material.color = this.mesh.material.color;
    material.clippingPlanes = this.mesh.material.clippingPlanes;
    material.vertexColors = true;
    const pieces = new Mesh(new BufferGeometry(), material);
    this.mesh.add(pieces);
    return pieces;
  }

  /** Removes values, labels and pieces. */
  clear(): void {
    if (this.pieces) this.pieces.visible = false;
    const attribute = this.mesh.geometry.getAttribute("value") as BufferAttribute;
    (attribute.array as Float32Array).fill(-1);
    attribute.needsUpdate = true;
    this.useVertexColours(false);
  }

  private useVertexColours(use: boolean): void {
    const { material } = this.mesh;
    if (material.vertexColors === use) return;
    material.vertexColors = use;
    material.needsUpdate = true;
  }

  dispose(): void {
    this.pieces?.geometry.dispose();
    this.pieces?.material.dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.edges?.geometry.dispose();
    this.edges?.material.dispose();
    this.uniforms.ramp.value?.dispose();
  }
}
