// The worker's side of prepare.ts. The page sends one message for each mesh.

import { buffersOf, prepare } from "./prepare.ts";
import type { Triangles } from "./ply.ts";

/** The part of a worker's global scope that this file uses. The page's types do not declare it. */
interface Scope {
  onmessage: (event: MessageEvent<{ id: number; source: ArrayBuffer | Triangles }>) => void;
  postMessage: (message: unknown, buffers: ArrayBuffer[]) => void;
}

const scope = globalThis as unknown as Scope;

scope.onmessage = ({ data: { id, source } }) => {
  try {
    const prepared = prepare(source);
    scope.postMessage({ id, prepared }, buffersOf(prepared));
  } catch (error) {
    scope.postMessage({ id, error: (error as Error).message }, []);
  }
};
