// Composes a frame off the screen with several samples per pixel, then shows it. So lines have
// smooth edges although the canvas has one sample per pixel.

import { NoBlending, ShaderMaterial, Vector2, type WebGLRenderer, WebGLRenderTarget } from "three";
import { FullScreenQuad } from "three/examples/jsm/postprocessing/Pass.js";

const VERTEX = `
varying vec2 at;
void main() {
  at = uv;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;
const FRAGMENT = `
uniform sampler2D colour;
varying vec2 at;
void main() {
  gl_FragColor = texture2D(colour, at);
}`;

export class Screen {
  private readonly frame = new WebGLRenderTarget(1, 1, { samples: 4, stencilBuffer: true });
  private readonly quad = new FullScreenQuad(
    new ShaderMaterial({
      uniforms: { colour: { value: this.frame.texture } },
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      blending: NoBlending,
      depthTest: false,
      depthWrite: false,
    }),
  );

  /** Returns the target for composing the frame, in the size of the canvas. */
  target(renderer: WebGLRenderer): WebGLRenderTarget {
    const { x, y } = renderer.getDrawingBufferSize(new Vector2());
    if (x !== this.frame.width || y !== this.frame.height) this.frame.setSize(x, y);
    return this.frame;
  }

  show(renderer: WebGLRenderer): void {
    renderer.setRenderTarget(null);
    this.quad.render(renderer);
  }
}
