// Control meshes of subdivision surfaces. The daemon does not return control meshes. Therefore the
// page knows only the control meshes of samples, and those of files that the page has uploaded
// since it was opened. The description of a surface has the SHA-256 of its file, by which the page
// finds the control mesh.

import { SAMPLES } from "./samples.ts";
import type { Vec3 } from "./vector.ts";

const known = new Map<string, string>();

/**
 * Returns null on a page loaded over plain HTTP from another machine, because such a page has no
 * crypto.subtle.
 */
async function sha256(text: string): Promise<string | null> {
  if (!globalThis.crypto?.subtle) return null;
  const digest = await crypto.subtle.digest("SHA-256", new TextEncoder().encode(text));
  return [...new Uint8Array(digest)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

export async function rememberCage(text: string): Promise<void> {
  const hash = await sha256(text);
  if (hash) known.set(hash, text);
}

interface Polygons {
  vertices: number[][];
  faces: number[][];
}

function parseObj(text: string): Polygons {
  const rows = text.split("\n").map((line) => line.trim().split(/\s+/));
  const vertices = rows.filter(([word]) => word === "v").map((row) => row.slice(1, 4).map(Number));
  const index = (corner: string): number =>
    Number.parseInt(corner) > 0
      ? Number.parseInt(corner) - 1
      : vertices.length + Number.parseInt(corner);
  return {
    vertices,
    faces: rows.filter(([word]) => word === "f").map((row) => row.slice(1).map(index)),
  };
}

/** Parses a mesh in the daemon's JSON form, or in JSON with the array names of OpenUSD. */
function parseJson(text: string): Polygons {
  const file = JSON.parse(text) as Partial<Polygons> & {
    points?: number[][];
    faceVertexCounts?: number[];
    faceVertexIndices?: number[];
  };
  if (file.vertices && file.faces) return file as Polygons;
  let at = 0;
  const faces = (file.faceVertexCounts ?? []).map((count) =>
    (file.faceVertexIndices ?? []).slice(at, (at += count)),
  );
  return { vertices: file.points ?? [], faces };
}

/**
 * Returns the edges of the control mesh whose file has this SHA-256, in the file's unit. Returns an
 * empty list if the page does not know this control mesh.
 */
export async function cageEdges(hash: string): Promise<Vec3[][]> {
  if (known.size === 0)
    for (const sample of SAMPLES)
      if (sample.kind === "subdivisions") await rememberCage(sample.file().text);
  const text = known.get(hash);
  if (!text) return [];
  const { vertices, faces } = text.trimStart().startsWith("{") ? parseJson(text) : parseObj(text);
  const edges = new Map<string, Vec3[]>();
  for (const face of faces) {
    face.forEach((a, i) => {
      const b = face[(i + 1) % face.length]!;
      edges.set(a < b ? `${a}-${b}` : `${b}-${a}`, [vertices[a] as Vec3, vertices[b] as Vec3]);
    });
  }
  return [...edges.values()].filter((ends) => ends.every((p) => p?.length === 3));
}
