// Makes materials write sRGB colours. Frames are composed in render targets, for which three.js
// would write linear colours.

interface Program {
  fragmentShader: string;
}

export function encode(shader: Program): void {
  shader.fragmentShader = shader.fragmentShader.replace(
    "#include <colorspace_fragment>",
    "gl_FragColor = sRGBTransferOETF(gl_FragColor);",
  );
}
