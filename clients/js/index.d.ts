import type * as types from "./types.js";

export type { types };

/** A failed call. The message says what is wrong and what to change. */
export class GeodesicError extends Error {}

/** The daemon did not answer: it does not run at this address, or it closed the connection. */
export class ConnectionFailed extends GeodesicError {}

/**
 * The daemon runs, but refuses requests of pages from this origin. Start it with --cors-origin.
 */
export class OriginRefused extends ConnectionFailed {}

/**
 * An error that the daemon reports (RFC 9457). The error is also thrown if the daemon is still busy
 * (429, 503) after all retries.
 */
export class ProblemError extends GeodesicError {
  readonly problem: types.Problem;
  readonly status: number;
  readonly code: string;
  readonly detail: string;
  /** JSON Pointer to the offending part of the request's body */
  readonly pointer?: string;
  readonly requestId: string;
}

/** The awaited job was cancelled. */
export class JobCancelled extends GeodesicError {}

/**
 * A point: the index of a vertex; three coordinates (the nearest surface point); a compact form
 * ("v:12", "e:3-9:0.25", "f:34:0.2,0.3,0.5", "p:1,2,3"); an object of the contract; or a point of
 * an answer.
 */
export type PointLike = number | string | readonly number[] | Floats | Vector3Like | types.Point | types.PointAnswer;
/** Points: a list, an array of vertex indices, or an array of rows of three coordinates. */
export type PointsLike = readonly PointLike[] | Integers | Floats;
/** Points that are sent in binary form: integers are vertices; floats are rows of coordinates. */
export type BulkPoints = Integers | Floats | readonly number[] | readonly (readonly number[] | Vector3Like)[];
export type SetLike = PointLike | PointsLike | types.Set;
export type Floats = Float64Array | Float32Array;
export type Integers = Uint32Array | Uint16Array | Uint8Array | Int32Array;
/** A Vector3 of three.js. */
export interface Vector3Like {
  readonly isVector3: true;
  x: number;
  y: number;
  z: number;
}
/** A BufferGeometry of three.js. */
export interface GeometryLike {
  readonly isBufferGeometry: true;
  readonly index: { readonly array: ArrayLike<number> } | null;
  getAttribute(name: string): unknown;
}
/** A mesh: `vertices` has rows of three coordinates, `faces` rows of three vertex indices. */
export interface MeshArrays<Vertices = Float64Array, Faces = Uint32Array> {
  vertices: Vertices;
  faces: Faces;
}

/** Converts a point to the form of the contract. Throws TypeError for any other value. */
export function toPoint(point: PointLike): types.Point;
export function toPoints(points: PointsLike): types.Point[];
/** Converts a set to the form of the contract. */
export function toSet(sources: SetLike): types.Set;
/**
 * Converts a geometry of three.js to the mesh that `upload` sends. It merges vertices that have the
 * same coordinates. Vertex i of the geometry is vertex `index[i]` of the mesh, as in
 * `field.values()`.
 */
export function fromGeometry(geometry: GeometryLike): MeshArrays & { index: Uint32Array };

/** Typed arrays by name. */
export type Arrays = Record<string, Float64Array | Float32Array | Uint32Array>;

/** Reads an arrays container, the binary form of answers (`format=f64`, `format=f32`). */
export function readArrays(buffer: ArrayBuffer): Arrays;

/**
 * Writes an arrays container, the binary form of requests. A Uint32Array has one index for each
 * row, other arrays have three numbers.
 */
export function writeArrays(arrays: Arrays): Uint8Array<ArrayBuffer>;

/**
 * Returns a function that takes the inputs of a drag, such as the position of the mouse. The
 * function runs one request at a time and drops inputs that a newer input has replaced. `stop`
 * aborts the request and ignores further inputs.
 */
export function newest<Input, Answer>(
  ask: (input: Input, signal: AbortSignal) => Promise<Answer>,
  show: (answer: Answer, input: Input) => void,
  fail?: (error: unknown) => void,
): { (input: Input): void; stop(): void };

/** Receives the progress of a job, in [0,1]. A call with this option runs as a job. */
export type OnProgress = (progress: number) => void;

/** An option of every call. The signal aborts the request and the pauses between its retries. */
export interface Abortable {
  signal?: AbortSignal;
}

export interface CallOptions extends Abortable {
  query?: Record<string, string | number | boolean | undefined>;
  /** Strings and bytes are sent unchanged, other values as JSON. */
  body?: unknown;
  headers?: Record<string, string>;
  /** The request runs as a job. The client cancels the job if `signal` is aborted. */
  onProgress?: OnProgress;
  /**
   * false if each request creates something new, as createBatch does, so the client does not repeat
   * the request if its connection fails, or after a refusal without Retry-After
   */
  repeatable?: boolean;
}

export interface QueryOptions extends Abortable {
  /** members of the answer to return, with commas between them */
  select?: string;
  /** @deprecated the former name of `select` */
  fields?: string;
  geometry?: "full" | "xyz" | "none";
  timeout_ms?: number;
  onProgress?: OnProgress;
}

/** A request that the daemon runs as a job (202). The daemon keeps the result for some time. */
export class Job {
  readonly id: string;
  readonly state: "queued" | "running" | "done" | "failed" | "cancelled";
  readonly progress: number;
  readonly isOver: boolean;
  /** Waits until the job has ended. */
  wait(onProgress?: OnProgress, options?: Abortable): Promise<this>;
  /**
   * Returns the answer of a job that has ended, as if the request had not been a job. Throws a
   * ProblemError if the job failed.
   */
  response(options?: Abortable): Promise<Response>;
  /** Stops the job within milliseconds. Deletes a job that has ended. */
  cancel(options?: Abortable): Promise<void>;
}

/** A resource at a path of the daemon. */
export class Resource {
  /**
   * Sends a query whose answer consists of arrays (`matrix`, `isolines`, `trace`, `voronoi`, …).
   * Returns typed arrays by name, each stored by rows.
   */
  queryArrays(
    name: string,
    body: object,
    options?: QueryOptions & { form?: "f64" | "f32"; [parameter: string]: unknown },
  ): Promise<Record<string, Float64Array | Float32Array | Uint32Array>>;
  readonly client: Client;
  readonly location: string;
  describe(options?: Abortable): Promise<unknown>;
  exists(options?: Abortable): Promise<boolean>;
  delete(options?: Abortable): Promise<void>;
}

/** A named surface; `Queries` lists its queries. */
export class Surface<Queries = Record<string, { body: unknown; answer: unknown }>> extends Resource {
  readonly name: string;
  query<Name extends keyof Queries & string>(
    name: Name,
    body: Queries[Name] extends { body: infer Body } ? Body : never,
    options?: QueryOptions,
  ): Promise<Queries[Name] extends { answer: infer Answer } ? Answer : never>;
  /**
   * Draws a figure of the surface as a PNG, SVG or GLB file. The options have the other members of
   * the contract's request: { camera: { view: "top" } }.
   */
  figure(
    layers: object[],
    options?: QueryOptions & { form?: "png" | "svg" | "glb"; [member: string]: unknown },
  ): Promise<ArrayBuffer>;
}

export interface Path {
  length: number;
  /** the corners of the path, in order */
  points: [number, number, number][];
}

/** The distances from a set to the whole surface. The daemon stores them. */
export class Field extends Resource {
  readonly id: string;
  readonly max: number | null;
  readonly farthest: types.PointAnswer | null;
  describe(options?: Abortable): Promise<types.Field>;
  /** Returns the distance at each vertex, or NaN if no path reaches the vertex. */
  values(options?: Abortable): Promise<Float64Array>;
  /** Returns a file of the mesh with the distances: as values (ply), colours (glb), rows (csv). */
  file(format?: "ply" | "glb" | "csv", options?: Abortable): Promise<ArrayBuffer>;
  /** Returns the distance at each point, or null if no path reaches the point. */
  distances(points: PointsLike, options?: Abortable): Promise<(number | null)[]>;
  /**
   * Returns the lines of each level. `levels` is a list of levels, or a number of equally spaced
   * levels.
   */
  isolines(levels: number | ArrayLike<number>, options?: QueryOptions & { tolerance?: number }): Promise<types.IsolinesAnswer["isolines"]>;
  /**
   * Like `isolines`, but returns arrays. Line i consists of the rows of `points` from `first[i]` to
   * `first[i + 1]`.
   */
  isolineArrays(
    levels: number | ArrayLike<number>,
    options?: QueryOptions & { tolerance?: number; form?: "f64" | "f32" },
  ): Promise<{ points: Floats; first: Uint32Array; level: Floats; length: Floats }>;
  /**
   * Returns the lines of all levels as a file. If `mesh` is true, the file includes the mesh (obj
   * and glb).
   */
  isolinesFile(
    levels: number | ArrayLike<number>,
    format?: "obj" | "glb" | "csv",
    options?: Abortable & { tolerance?: number; mesh?: boolean },
  ): Promise<ArrayBuffer>;
}

export class Mesh extends Surface<types.MeshQueries> {
  describe(options?: Abortable): Promise<types.Mesh>;
  /** Returns the exact distance, or null if no path joins the points. */
  distance(from: PointLike, to: PointLike, options?: Abortable & { via?: PointsLike }): Promise<number | null>;
  /** Returns a shortest path, or null if no path joins the points. */
  path(from: PointLike, to: PointLike, options?: Abortable & { via?: PointsLike }): Promise<Path | null>;
  /**
   * Returns a shortest path as a file. The format svg has the faces that the path crosses, unfolded
   * into the plane. If `mesh` is true, the file includes the mesh (obj and glb).
   */
  pathFile(
    from: PointLike,
    to: PointLike,
    format?: "obj" | "glb" | "csv" | "svg",
    options?: Abortable & { via?: PointsLike; mesh?: boolean },
  ): Promise<ArrayBuffer>;
  /**
   * Returns a rendered picture. `query` has the parameters of the contract, with points in compact
   * form: { source: "v:12", view: "iso" }.
   */
  picture(form?: "png" | "svg", query?: Record<string, string | number | boolean | AbortSignal | undefined>): Promise<ArrayBuffer>;
  nearest(point: PointLike, options?: Abortable): Promise<types.PointAnswer>;
  /**
   * Returns the distance of each pair, or NaN if no path joins the points of the pair. An array
   * with one point uses this point for all pairs.
   */
  pairs(from: BulkPoints, to: BulkPoints, options?: Abortable): Promise<Float64Array>;
  /**
   * Returns the surface points that are nearest to rows of three coordinates. The arrays are
   * `faces`, `barycentric`, `xyz` and `snap_distances`.
   */
  nearestPoints(xyz: BulkPoints, options?: Abortable): Promise<Record<string, Float64Array | Uint32Array>>;
  /** Returns a row of distances for each source. A distance is NaN if no path joins the points. */
  matrix(
    sources: PointsLike,
    targets: PointsLike,
    options?: Abortable & { maxDistance?: number; onProgress?: OnProgress },
  ): Promise<Float64Array[]>;
  /** Computes a field. Equal requests return the same field. */
  field(sources: SetLike, options?: Abortable & { maxDistance?: number; onProgress?: OnProgress }): Promise<Field>;
  /** Creates a mesh by applying operations in order: [{ operation: "simplify", faces: 10000 }]. */
  derive(name: string, operations: readonly types.EditOperation[], options?: Abortable & { onProgress?: OnProgress }): Promise<Mesh>;
  /**
   * Applies the operations, if there are any. Then stores each component of the result as a
   * separate mesh with the name name-1, name-2 and so on, by decreasing area.
   */
  split(name: string, operations?: readonly types.EditOperation[], options?: Abortable & { onProgress?: OnProgress }): Promise<Mesh[]>;
  /** Returns the original point of each vertex of a derived mesh: face, barycentric coordinates. */
  origins(options?: Abortable): Promise<[number, number, number, number][]>;
  /** Returns a simplified mesh for display as a file. Waits until the daemon has built the file. */
  preview(options?: Abortable & { faces?: number; format?: "glb" | "ply"; onProgress?: OnProgress }): Promise<ArrayBuffer>;
  content(format?: "obj" | "off" | "gltf", options?: Abortable): Promise<string>;
  content(format: "ply" | "stl" | "glb", options?: Abortable): Promise<ArrayBuffer>;
  /** Returns the mesh as typed arrays, for example for a BufferGeometry of three.js. */
  arrays(options?: Abortable): Promise<MeshArrays>;
}

export class Client {
  /**
   * `retries` is the number of times that the client repeats a request if the daemon is busy or the
   * connection fails.
   */
  constructor(url?: string | URL, options?: { key?: string; retries?: number });
  /** Sends any request. Throws a ProblemError if the daemon reports an error. */
  call(method: string, path: string, options?: CallOptions): Promise<Response>;
  /** Starts any query or upload as a job. Does not wait for the job. */
  submit(method: string, path: string, options?: Omit<CallOptions, "onProgress">): Promise<Job>;
  /** Reads the job with this id. Returns when the job has ended, or after `wait` (0) seconds. */
  job(id: string, options?: Abortable & { wait?: number }): Promise<Job>;
  /** Reads the daemon's version, limits and capabilities. */
  service(options?: Abortable): Promise<types.Service>;
  /**
   * Starts a batch, which is a query for many sources. It continues without this client and across
   * restarts of the daemon. The client does not repeat the request if the connection fails: after
   * ConnectionFailed the batch may exist; GET /v1/batches lists all batches.
   */
  createBatch(request: types.BatchRequest, options?: Abortable): Promise<types.Batch>;
  /** Reads the state of a batch. */
  batch(id: string, options?: Abortable): Promise<types.Batch>;
  /** Waits until the batch has ended. Calls `onProgress` about once a second. */
  waitBatch(id: string, onProgress?: OnProgress, options?: Abortable): Promise<types.Batch>;
  /**
   * Yields the items that have an answer now, in the order of the request. If `wait` is true,
   * yields each item as soon as it has an answer, until the batch has ended.
   */
  batchResults(id: string, options?: Abortable & { wait?: boolean }): AsyncGenerator<types.BatchResults["results"][number]>;
  /** Cancels a running batch, or removes a batch that has ended. */
  deleteBatch(id: string, options?: Abortable): Promise<void>;
  /** Yields all meshes, or the meshes whose names begin with `prefix`. */
  meshes(options?: Abortable & { prefix?: string }): AsyncGenerator<types.Mesh>;
  /** Returns the mesh with this name. Sends no request. */
  mesh(name: string): Mesh;
  subdivision(name: string): Surface<types.SubdivisionQueries>;
  nurbs(name: string): Surface<types.NurbsQueries>;
  /**
   * Creates or replaces a mesh from the content of a file or from arrays. If `name` is null, the
   * daemon derives the name from the content. The options `components`, `fill`, `smooth`,
   * `subdivide` and `simplify` edit the mesh before the daemon stores it.
   */
  upload(
    name: string | null,
    content: string | ArrayBuffer | ArrayBufferView | Blob | MeshArrays<number[] | number[][] | Floats, number[] | number[][] | Integers> | GeometryLike,
    options?: Abortable & {
      format?: string;
      weld?: number;
      repair?: "none" | "split";
      components?: number;
      fill?: number;
      smooth?: number;
      subdivide?: number;
      simplify?: number;
      description?: string;
      onProgress?: OnProgress;
    },
  ): Promise<Mesh>;
}
