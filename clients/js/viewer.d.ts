/** The answer that the frame shows. */
export interface ViewerAnswer {
  /** The length of the path; null if the answer is not a single path. */
  length: number | null;
  /** The parameters of the viewer's address: surface, mode, points, camera. */
  state: Record<string, string>;
}

/**
 * `<geodesic-viewer server="…" mesh="bunny" from="v:12" to="v:900">`. Attributes: `server` (the
 * origin of the daemon), `mesh`, `subdivision` or `nurbs`, `mode`, points by group (`from`, `to`,
 * `via`, …), `unit`, `ramp`, `edges`, `up`, `camera`. Fires `answer` with a `ViewerAnswer`,
 * and `error` with a message for the user if a surface or a query is refused.
 */
export class GeodesicViewer extends HTMLElement {
  readonly server: string;
  /** The fragment of the viewer's address. */
  readonly fragment: string;
  addEventListener(type: "answer", listener: (event: CustomEvent<ViewerAnswer>) => void): void;
  addEventListener(
    type: "error",
    listener: (event: CustomEvent<{ message: string }>) => void,
  ): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "geodesic-viewer": GeodesicViewer;
  }
}
