import type * as types from "./types.js";

export type { types };

/** Any failure of a call. The message is the daemon's sentence, which tells what to change. */
export class GeodesicError extends Error {}

/** No answer came: the daemon is not there, or hung up. */
export class ConnectionFailed extends GeodesicError {}

/** The daemon answers, but refuses requests of pages from this origin: start it with --cors-origin. */
export class OriginRefused extends ConnectionFailed {}

/** An answer that is a problem (RFC 9457). After retries this is also what a busy daemon (429, 503) comes to. */
export class ProblemError extends GeodesicError {
  readonly problem: types.Problem;
  readonly status: number;
  readonly code: string;
  readonly detail: string;
  /** JSON Pointer into the body that was sent */
  readonly pointer?: string;
  readonly requestId: string;
}

/** The job that was awaited has been cancelled. */
export class JobCancelled extends GeodesicError {}

/**
 * A point: the index of a vertex; three coordinates (the nearest point); "v:12", "e:3-9:0.25", "f:34:0.2,0.3,0.5" or "p:1,2,3"; an object as the contract has
 * it; or a point that an answer held.
 */
export type PointLike = number | string | readonly number[] | types.Point | types.PointAnswer;
export type SetLike = PointLike | readonly PointLike[] | types.Set;

/** What the daemon takes for a point. TypeError of what is none. */
export function toPoint(point: PointLike): types.Point;
/** What the daemon takes for a set. */
export function toSet(sources: SetLike): types.Set;

/** Told how far a job is, in [0,1]. What is given one is a job. */
export type OnProgress = (progress: number) => void;

export interface CallOptions {
  query?: Record<string, string | number | boolean | undefined>;
  /** a string or bytes as they are, else sent as JSON */
  body?: unknown;
  headers?: Record<string, string>;
  onProgress?: OnProgress;
  signal?: AbortSignal;
  /** false: it makes something new each time, as createBatch does, so it is not sent again when its connection fails */
  repeatable?: boolean;
}

export interface QueryOptions {
  /** members of the answer to return, with commas between them */
  select?: string;
  /** @deprecated the former name of `select` */
  fields?: string;
  geometry?: "full" | "xyz" | "none";
  timeout_ms?: number;
  onProgress?: OnProgress;
  signal?: AbortSignal;
}

/** A request that was accepted to be worked on (202). The daemon keeps its result for a while. */
export class Job {
  readonly id: string;
  readonly state: "queued" | "running" | "done" | "failed" | "cancelled";
  readonly progress: number;
  readonly isOver: boolean;
  /** Until it is over. */
  wait(onProgress?: OnProgress): Promise<this>;
  /** The answer as it would have come at once, of a job that is over; the error of its problem if it failed. */
  response(): Promise<Response>;
  /** Stops it, within milliseconds. A job that is over is forgotten. */
  cancel(): Promise<void>;
}

/** What lies at a path of the daemon. */
export class Resource {
  /** An answer as typed arrays by name, row after row: of `matrix`, `isolines`, `trace`, `voronoi` and others. */
  queryArrays(
    name: string,
    body: object,
    query?: { form?: "f64" | "f32"; [parameter: string]: unknown },
  ): Promise<Record<string, Float64Array | Float32Array | Uint32Array>>;
  readonly client: Client;
  readonly location: string;
  describe(): Promise<unknown>;
  exists(): Promise<boolean>;
  delete(): Promise<void>;
}

/** A surface that has a name; Queries are those that can be asked of it. */
export class Surface<Queries = Record<string, { body: unknown; answer: unknown }>> extends Resource {
  readonly name: string;
  query<Name extends keyof Queries & string>(
    name: Name,
    body: Queries[Name] extends { body: infer Body } ? Body : never,
    options?: QueryOptions,
  ): Promise<Queries[Name] extends { answer: infer Answer } ? Answer : never>;
}

export interface Path {
  length: number;
  /** the corners, from the first to the last */
  points: [number, number, number][];
}

/** The distances from a set to the whole surface, kept by the daemon. */
export class Field extends Resource {
  readonly id: string;
  readonly max: number | null;
  readonly farthest: types.PointAnswer | null;
  /** The distance at each vertex, NaN where there is none. */
  values(): Promise<Float64Array>;
  /** The mesh with the distance at each vertex, as a file: glb has it as colours, csv as rows. */
  file(format?: "ply" | "glb" | "csv"): Promise<ArrayBuffer>;
  /** The distance at each point, null where there is none. */
  distances(points: readonly PointLike[]): Promise<(number | null)[]>;
  isolines(levels: readonly number[], tolerance?: number): Promise<types.IsolinesAnswer["isolines"]>;
  /** The lines of all levels as a file. `mesh`: with their mesh, of obj and glb. */
  isolinesFile(
    levels: readonly number[],
    format?: "obj" | "glb" | "csv",
    options?: { tolerance?: number; mesh?: boolean },
  ): Promise<ArrayBuffer>;
}

export class Mesh extends Surface<types.MeshQueries> {
  describe(): Promise<types.Mesh>;
  /** The exact distance; null if no path joins the points. */
  distance(from: PointLike, to: PointLike, options?: { via?: readonly PointLike[]; signal?: AbortSignal }): Promise<number | null>;
  /** A shortest path; null if there is none. */
  path(from: PointLike, to: PointLike, options?: { via?: readonly PointLike[]; signal?: AbortSignal }): Promise<Path | null>;
  /** A shortest path as a file; svg: the faces that it runs through, laid flat. `mesh`: with its mesh, of obj and glb. */
  pathFile(
    from: PointLike,
    to: PointLike,
    format?: "obj" | "glb" | "csv" | "svg",
    options?: { via?: readonly PointLike[]; mesh?: boolean; signal?: AbortSignal },
  ): Promise<ArrayBuffer>;
  /** A rendered picture; the query as the contract has it, points in compact form: { source: "v:12", view: "iso" }. */
  picture(form?: "png" | "svg", query?: Record<string, string | number | boolean | undefined>): Promise<ArrayBuffer>;
  nearest(point: PointLike): Promise<types.PointAnswer>;
  /** The distance of each pair, NaN without a path. Vertices as Uint32Array, else rows of three coordinates; one point may stand for all pairs. */
  pairs(from: Uint32Array | Float64Array | Float32Array, to: Uint32Array | Float64Array | Float32Array): Promise<Float64Array>;
  /** The nearest points to rows of three coordinates: `faces`, `barycentric`, `xyz`, `snap_distances`. */
  nearestPoints(xyz: Float64Array | Float32Array | Uint32Array): Promise<Record<string, Float64Array | Uint32Array>>;
  /** A row per source, NaN where there is no distance. */
  matrix(
    sources: readonly PointLike[],
    targets: readonly PointLike[],
    options?: { maxDistance?: number; onProgress?: OnProgress },
  ): Promise<Float64Array[]>;
  /** The same request gives the same field again. */
  field(sources: SetLike, options?: { maxDistance?: number; onProgress?: OnProgress }): Promise<Field>;
  content(format?: "obj" | "off" | "gltf"): Promise<string>;
  content(format: "ply" | "stl" | "glb"): Promise<ArrayBuffer>;
}

export class Client {
  /** `retries`: how often a request is sent again that a busy daemon turned away, or whose connection failed. */
  constructor(url?: string | URL, options?: { key?: string; retries?: number });
  /** Any request; the error of its problem if it has one. */
  call(method: string, path: string, options?: CallOptions): Promise<Response>;
  /** Any query or upload as a job, which is not awaited. */
  submit(method: string, path: string, options?: Omit<CallOptions, "onProgress">): Promise<Job>;
  /** The job of that id, perhaps begun by another client. */
  job(id: string): Promise<Job>;
  /** The daemon's version, limits and capabilities. */
  service(): Promise<types.Service>;
  /**
   * Begins work of many sources, which outlives this client and the daemon. It is not sent again when its connection fails: after ConnectionFailed it may have
   * begun all the same, which GET /v1/batches tells.
   */
  createBatch(request: types.BatchRequest): Promise<types.Batch>;
  /** How far it is. */
  batch(id: string): Promise<types.Batch>;
  /** The batch, once it has ended. `onProgress` is called about once a second. */
  waitBatch(id: string, onProgress?: OnProgress): Promise<types.Batch>;
  /** The items that have an answer by now, in their order. `wait`: each item as soon as it is answered, until the batch has ended. */
  batchResults(id: string, options?: { wait?: boolean }): AsyncGenerator<types.BatchResults["results"][number]>;
  /** Cancels it; removes one that has ended. */
  deleteBatch(id: string): Promise<void>;
  /** All meshes, or those whose names begin with `prefix`. */
  meshes(options?: { prefix?: string }): AsyncGenerator<types.Mesh>;
  /** The mesh of that name; nothing is asked yet. */
  mesh(name: string): Mesh;
  subdivision(name: string): Surface<types.SubdivisionQueries>;
  nurbs(name: string): Surface<types.NurbsQueries>;
  /** Creates or replaces a mesh of a file's content or of arrays; `null`: its name is made of its content. */
  upload(
    name: string | null,
    content: string | ArrayBuffer | ArrayBufferView | Blob | { vertices: number[][]; faces: number[][] },
    options?: { format?: string; weld?: number; repair?: "none" | "split"; onProgress?: OnProgress; signal?: AbortSignal },
  ): Promise<Mesh>;
}
