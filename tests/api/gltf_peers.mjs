// Reads GLB files by the Khronos validator and by three.js. Arguments: the folder of the packages,
// then the files. Prints one line of JSON for each file.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const [folder, ...files] = process.argv.slice(2);
const require = createRequire(`${folder}/package.json`);
const validator = require("gltf-validator");
const three = `${folder}/node_modules/three`;
globalThis.self = globalThis;
const { GLTFLoader } = await import(pathToFileURL(`${three}/examples/jsm/loaders/GLTFLoader.js`));

function describe(object) {
  const { position, color, _distance: distance } = object.geometry.attributes;
  return {
    type: object.type,
    places: Array.from(position.array),
    translation: object.parent.isScene || object.parent.isGroup ? sum(object) : [0, 0, 0],
    index: object.geometry.index ? Array.from(object.geometry.index.array) : null,
    colours: color ? color.count : 0,
    distances: distance ? Array.from(distance.array) : null,
  };
}

function describeTrack({ name, times, values }) {
  return { name, times: Array.from(times), values: Array.from(values) };
}

function sum(object) {
  const total = [0, 0, 0];
  for (let at = object; at; at = at.parent) at.position.toArray().forEach((value, axis) => (total[axis] += value));
  return total;
}

for (const file of files) {
  const bytes = new Uint8Array(readFileSync(file));
  const report = await validator.validateBytes(bytes);
  const scene = await new Promise((resolve, reject) => new GLTFLoader().parse(bytes.buffer, "", resolve, reject));
  const objects = [];
  scene.scene.traverse((object) => object.geometry && objects.push(describe(object)));
  const { numErrors, numWarnings, messages } = report.issues;
  const tracks = scene.animations.flatMap((animation) => animation.tracks.map(describeTrack));
  console.log(JSON.stringify({ errors: numErrors, warnings: numWarnings, messages: messages.slice(0, 5), objects, tracks }));
}
