// Passes over the whole frame, and the encoding of colours. Frames are composed in render targets,
// for which three.js would write linear colours, so all shaders here write sRGB colours.

import {
  AlwaysDepth,
  NoBlending,
  ShaderMaterial,
  Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { FullScreenQuad } from "three/examples/jsm/postprocessing/Pass.js";

const VERTEX = `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

/** Returns a pass over the whole frame that writes colour, and depth if the shader sets it. */
export function pass(fragmentShader: string, uniforms: ShaderMaterial["uniforms"]): FullScreenQuad {
  const material = new ShaderMaterial({
    uniforms,
    vertexShader: VERTEX,
    fragmentShader,
    blending: NoBlending,
  });
  material.depthFunc = AlwaysDepth;
  return new FullScreenQuad(material);
}

interface Program {
  fragmentShader: string;
}

/** Makes a material write sRGB colours. */
export function encode(shader: Program): void {
  shader.fragmentShader = shader.fragmentShader.replace(
    "#include <colorspace_fragment>",
    "gl_FragColor = sRGBTransferOETF(gl_FragColor);",
  );
}

const COPY = `
uniform sampler2D colour;
varying vec2 at;
void main() {
  gl_FragColor = texture2D(colour, at);
}`;

/**
 * Composes a frame off the screen with several samples per pixel, then shows it. So lines have
 * smooth edges although the canvas has one sample per pixel.
 */
export class Screen {
  private readonly frame = new WebGLRenderTarget(1, 1, { samples: 4, stencilBuffer: true });
  private readonly copy = pass(COPY, { colour: { value: this.frame.texture } });

  /** Returns the target for composing the frame, in the size of the canvas. */
  target(renderer: WebGLRenderer): WebGLRenderTarget {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2());
    if (x !== this.frame.width || y !== this.frame.height) this.frame.setSize(x, y);
    return this.frame;
  }

  show(renderer: WebGLRenderer): void {
    renderer.setRenderTarget(null);
    this.copy.render(renderer);
  }
}
