// The triangles of a surface on the screen: plain, with a ramp of values, or with a colour a vertex.

import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DataTexture,
  DoubleSide,
  LinearFilter,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  SRGBColorSpace,
} from "three";
import { type Rgb, rampBytes, toLinear } from "./colours.ts";
import { type Fine, interpolated } from "./fine.ts";

const RAMP_SIZE = 256;

/** Values beyond the ramp, and those that are not there, are of the plain colour. */
const RAMP_VERTEX = `
attribute float value;
varying float vValue;
#include <common>`;
const RAMP_FRAGMENT = `
uniform sampler2D ramp;
varying float vValue;
#include <common>`;
const RAMP_COLOUR = `
#include <color_fragment>
if (vValue >= 0.0) {
  float texel = (vValue * ${RAMP_SIZE - 1}.0 + 0.5) / ${RAMP_SIZE}.0;
  diffuseColor.rgb = texture2D(ramp, vec2(texel, 0.5)).rgb;
}`;

/** Colours are stored as screens take them, in the backdrop too. */
function encode(shader: { fragmentShader: string }): void {
  shader.fragmentShader = shader.fragmentShader.replace(
    "#include <colorspace_fragment>",
    "gl_FragColor = sRGBTransferOETF(gl_FragColor);",
  );
}

function rampTexture(name: string): DataTexture {
  const texture = new DataTexture(rampBytes(name, RAMP_SIZE), RAMP_SIZE, 1);
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

/** Shaded as the coarse mesh is. */
function finer(fine: Fine, coarse: BufferGeometry): BufferGeometry {
  const normals = interpolated(fine, coarse.getAttribute("normal").array, 3);
  const geometry = geometryOf(fine.positions, fine.faces);
  return geometry.setAttribute("normal", new BufferAttribute(Float32Array.from(normals), 3));
}

export class Skin {
  readonly mesh: Mesh<BufferGeometry, MeshLambertMaterial>;
  private edges: Mesh<BufferGeometry, MeshBasicMaterial> | undefined;
  private readonly ramp = { value: rampTexture("dusk") };

  /** The triangles as the file has them. */
  private readonly own: BufferGeometry;

  /** The arrays are borrowed. With `fine` the finer mesh is shown: values and labels are those of its vertices. */
  constructor(
    positions: Float32Array,
    faces: Uint32Array,
    private readonly fine: Fine | null = null,
  ) {
    this.own = geometryOf(positions, faces);
    this.own.computeVertexNormals();
    const shown = fine ? finer(fine, this.own) : this.own;
    const vertexCount = shown.getAttribute("position").count;
    shown.setAttribute("value", new BufferAttribute(new Float32Array(vertexCount).fill(-1), 1));
    this.mesh = new Mesh(shown, this.material());
  }

  private material(): MeshLambertMaterial {
    const material = new MeshLambertMaterial({
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    material.onBeforeCompile = (shader) => {
      shader.uniforms.ramp = this.ramp;
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", RAMP_VERTEX)
        .replace("#include <begin_vertex>", "#include <begin_vertex>\nvValue = value;");
      shader.fragmentShader = shader.fragmentShader
        .replace("#include <common>", RAMP_FRAGMENT)
        .replace("#include <color_fragment>", RAMP_COLOUR);
      encode(shader);
    };
    return material;
  }

  setColour(colour: string): void {
    this.mesh.material.color = new Color(colour);
  }

  setFlat(flat: boolean): void {
    this.mesh.material.flatShading = flat;
    this.mesh.material.needsUpdate = true;
  }

  /** The edges of the triangles, in thin lines. */
  showEdges(show: boolean): void {
    if (show && !this.edges) {
      const material = new MeshBasicMaterial({ wireframe: true, color: "#24323a", transparent: true, opacity: 0.35 });
      material.onBeforeCompile = encode;
      this.edges = new Mesh(this.own, material);
      this.mesh.add(this.edges);
    }
    if (this.edges) this.edges.visible = show;
  }

  setRamp(name: string): void {
    this.ramp.value.dispose();
    this.ramp.value = rampTexture(name);
  }

  /** A value for each vertex of the mesh, 0 to `max`; NaN: none. */
  showValues(values: Float64Array, max: number): void {
    this.showFineValues(this.fine ? interpolated(this.fine, values, 1) : values, max);
  }

  /** The same for each vertex of the finer mesh. */
  showFineValues(values: Float64Array, max: number): void {
    const attribute = this.mesh.geometry.getAttribute("value") as BufferAttribute;
    const array = attribute.array as Float32Array;
    for (let i = 0; i < array.length; i++) {
      const value = values[i]! / max;
      array[i] = Number.isFinite(value) ? Math.min(1, Math.max(0, value)) : -1;
    }
    attribute.needsUpdate = true;
  }

  /** The colour of the label of each vertex that is shown; null: the plain one. */
  showLabels(labels: (number | null)[], colours: Rgb[], plain: Rgb): void {
    const array = new Uint8ClampedArray(3 * labels.length);
    labels.forEach((label, i) => {
      const rgb = label === null ? plain : (colours[label] ?? plain);
      array.set(
        rgb.map((c) => Math.round(255 * toLinear(c))),
        3 * i,
      );
    });
    this.mesh.geometry.setAttribute("color", new BufferAttribute(array, 3, true));
    this.useVertexColours(true);
  }

  /** Plain again. */
  clear(): void {
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
    this.mesh.geometry.dispose();
    this.own.dispose();
    this.mesh.material.dispose();
    this.edges?.material.dispose();
    this.ramp.value.dispose();
  }
}
