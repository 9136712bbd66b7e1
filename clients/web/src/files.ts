// Writes answers as files. The page writes lines from the exact points of the answer; the daemon
// writes fields, isolines and unfolded paths.

import type { Request } from "./api.ts";
import type { Bench } from "./bench.ts";
import { make } from "./dom.ts";
import type { Vec3 } from "./vector.ts";

export interface FileOffer {
  /** The text of the button. */
  label: string;
  /** The extension of the file's name. */
  ending: string;
  make: () => Promise<Blob>;
}

const text = (...parts: string[]): Blob => new Blob(parts, { type: "text/plain" });

/** Returns lines as a Wavefront OBJ file. */
export function objOf(lines: Vec3[][]): string {
  let count = 0;
  const elements = lines.map((line) => `l ${line.map(() => ++count).join(" ")}`);
  return `${[...lines.flat().map((p) => `v ${p.join(" ")}`), ...elements].join("\n")}\n`;
}

export function csvOf(lines: Vec3[][]): string {
  const rows = lines.flatMap((line, i) => line.map((p, k) => `${i},${k},${p.join(",")}`));
  return `${["line,point,x,y,z", ...rows].join("\n")}\n`;
}

/**
 * Returns lines as binary glTF 2.0. Coordinates are floats relative to the centre of the lines,
 * which is the node's translation.
 */
export function glbOf(lines: Vec3[][]): Uint8Array<ArrayBuffer> {
  const all = lines.flat();
  const ends = (pick: (...x: number[]) => number): Vec3 =>
    [0, 1, 2].map((axis) => all.reduce((x, p) => pick(x, p[axis]!), all[0]![axis]!)) as Vec3;
  const [low, high] = [ends(Math.min), ends(Math.max)];
  const centre = low.map((x, axis) => (x + high[axis]!) / 2) as Vec3;
  const pairs = lines.flatMap((line) => line.slice(1).flatMap((p, i) => [line[i]!, p]));
  const floats = Float32Array.from(pairs.flatMap((p) => p.map((x, axis) => x - centre[axis]!)));
  const about = (p: Vec3): number[] => p.map((x, axis) => Math.fround(x - centre[axis]!));
  const json = JSON.stringify({
    asset: { version: "2.0", generator: "geodesicd" },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, translation: centre }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, mode: 1 }] }],
    accessors: [
      {
        bufferView: 0,
        componentType: 5126,
        count: pairs.length,
        type: "VEC3",
        min: about(low),
        max: about(high),
      },
    ],
    bufferViews: [{ buffer: 0, byteLength: floats.byteLength, target: 34962 }],
    buffers: [{ byteLength: floats.byteLength }],
  });
  return glb(json, floats);
}

/**
 * Returns a glTF container: a header, the JSON padded with blanks to a multiple of 4 bytes, and the
 * binary chunk.
 */
function glb(json: string, floats: Float32Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
  const encoded = new TextEncoder().encode(json);
  const padded = Math.ceil(encoded.length / 4) * 4;
  const bytes = new Uint8Array(28 + padded + floats.byteLength);
  const view = new DataView(bytes.buffer);
  const header = [0x46546c67, 2, bytes.length, padded, 0x4e4f534a];
  header.forEach((word, i) => view.setUint32(4 * i, word, true));
  bytes.fill(0x20, 20, 20 + padded).set(encoded, 20);
  view.setUint32(20 + padded, floats.byteLength, true);
  view.setUint32(24 + padded, 0x004e4942, true);
  bytes.set(new Uint8Array(floats.buffer), 28 + padded);
  return bytes;
}

/** Returns an SVG file of the lines as the camera sees them, in pixels of the picture. */
function svgOf({ scene }: Bench, lines: Vec3[][]): string {
  const { x: width, y: height } = scene.size;
  const pixel = (p: Vec3): string => {
    const { x, y } = scene.project(p);
    return `${x.toFixed(2)},${y.toFixed(2)}`;
  };
  const polylines = lines.map((line) => `<polyline points="${line.map(pixel).join(" ")}"/>`);
  return (
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" fill="none" ` +
    `stroke="#e4572e" stroke-width="3" stroke-linejoin="round">\n${polylines.join("\n")}\n</svg>\n`
  );
}

/**
 * Returns the files that the page offers: the polylines, which are in the file's unit, and the
 * answer.
 */
export function lineFiles(bench: Bench, lines: Vec3[][]): FileOffer[] {
  const answer = {
    label: "JSON",
    ending: "json",
    make: async () => text(JSON.stringify(bench.last)),
  };
  if (lines.length === 0) return [answer];
  return [
    { label: "OBJ", ending: "obj", make: async () => text(objOf(lines)) },
    { label: "CSV", ending: "csv", make: async () => text(csvOf(lines)) },
    { label: "GLB", ending: "glb", make: async () => new Blob([glbOf(lines)]) },
    answer,
    { label: "SVG", ending: "svg", make: async () => text(svgOf(bench, lines)) },
  ];
}

/** Returns a file that the page offers and the daemon writes. */
export const daemonFile = (
  bench: Bench,
  label: string,
  ending: string,
  request: Request,
): FileOffer => ({
  label,
  ending,
  make: async () => new Blob([await bench.api.bytes(request)]),
});

/** Starts the browser's download of a file. */
export function save(file: Blob, name: string): void {
  const url = URL.createObjectURL(file);
  make("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
