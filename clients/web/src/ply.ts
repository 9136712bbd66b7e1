// Parses PLY files of the daemon: binary, little-endian, doubles, triangles in the order of the
// mesh's faces.

export interface Triangles {
  /** Three coordinates per vertex, in the file's unit. */
  positions: Float64Array;
  /** Three vertex indices per face. */
  faces: Uint32Array;
}

const FACE_BYTES = 13; /* a count of one byte, three indices of four */

function count(header: string, element: string): number {
  const match = new RegExp(`element ${element} (\\d+)`).exec(header);
  if (!match) throw new Error("The daemon sent a PLY file without vertices or faces.");
  return Number(match[1]);
}

function readFaces(view: DataView, at: number, faceCount: number): Uint32Array {
  const faces = new Uint32Array(3 * faceCount);
  for (let i = 0; i < faceCount; i++, at += FACE_BYTES) {
    faces[3 * i] = view.getUint32(at + 1, true);
    faces[3 * i + 1] = view.getUint32(at + 5, true);
    faces[3 * i + 2] = view.getUint32(at + 9, true);
  }
  return faces;
}

export function parsePly(bytes: ArrayBuffer): Triangles {
  const head = new TextDecoder("latin1").decode(
    new Uint8Array(bytes, 0, Math.min(1024, bytes.byteLength)),
  );
  const start = head.indexOf("end_header\n") + "end_header\n".length;
  const vertexBytes = 24 * count(head, "vertex");
  const positions = new Float64Array(bytes.slice(start, start + vertexBytes));
  return {
    positions,
    faces: readFaces(new DataView(bytes), start + vertexBytes, count(head, "face")),
  };
}
