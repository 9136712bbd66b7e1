/* Exact geodesics on surfaces, from a geodesicd daemon. For browsers and Node.js 18 or later; needs nothing but fetch. See index.d.ts. */

const BACKOFF_MS = 100; // before the first retry; twice as long before each next one
const BACKOFF_MOST_MS = 10000;
const FLOATS = "application/octet-stream";
const BATCH_WAIT_S = 30; // of one request that waits for a batch
const TEXTS = ["obj", "off", "gltf"]; // of the formats of meshes

/* Any failure of a call. */
export class GeodesicError extends Error {
  get name() {
    return this.constructor.name;
  }
}

/* No answer came. */
export class ConnectionFailed extends GeodesicError {}

/* The daemon answers, but not to pages of this origin: see --cors-origin. */
export class OriginRefused extends ConnectionFailed {}

/* An answer that is a problem (RFC 9457). */
export class ProblemError extends GeodesicError {
  constructor(problem, response) {
    const detail = problem.detail ?? problem.title ?? `the answer has the status ${response.status}`;
    super(problem.pointer ? `${detail} (at ${problem.pointer})` : detail);
    this.problem = problem;
    this.status = response.status;
    this.code = problem.code ?? "";
    this.detail = detail;
    this.pointer = problem.pointer;
    this.requestId = response.headers.get("X-Request-Id") ?? "";
  }
}

/* The job that was awaited has been cancelled. */
export class JobCancelled extends GeodesicError {}

/* --- points ----------------------------------------------------------------------------------------------------------- */

const COMPACT = {
  v: (rest) => ({ vertex: Number(rest) }),
  e: (rest) => {
    const [edge, t] = rest.split(":");
    return { edge: edge.split("-").map(Number), t: Number(t) };
  },
  f: (rest) => {
    const [face, weights] = rest.split(":");
    return { face: Number(face), barycentric: weights.split(",").map(Number) };
  },
  p: (rest) => ({ xyz: rest.split(",").map(Number) }),
};
const COMPACT_FORM = /^(v:\d+|e:\d+-\d+:[\d.eE+-]+|f:\d+:[^,:]+,[^,:]+,[^,:]+|p:[^,:]+,[^,:]+,[^,:]+)$/;

/* What is known most exactly of a point that an answer held. */
function askable(point) {
  if (point.vertex !== undefined) return { vertex: point.vertex };
  if (point.edge !== undefined) return { edge: point.edge, t: point.t };
  if (point.barycentric !== undefined) return { face: point.face, barycentric: point.barycentric };
  return point;
}

export function toPoint(point) {
  if (typeof point === "number") return { vertex: point };
  if (Array.isArray(point)) return { xyz: point };
  if (typeof point === "object" && point !== null) return askable(point);
  if (typeof point === "string" && COMPACT_FORM.test(point)) return COMPACT[point[0]](point.slice(2));
  throw new TypeError(`${JSON.stringify(point)} is no point; write v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1,2,3`);
}

/* Three numbers are a place in space; any other list is one of points. */
export function toSet(sources) {
  if (Array.isArray(sources)) {
    const isPlace = sources.length === 3 && sources.some((x) => typeof x === "number" && !Number.isInteger(x));
    return { points: isPlace ? [{ xyz: sources }] : sources.map(toPoint) };
  }
  const isSet = typeof sources === "object" && ["points", "curves", "boundaries"].some((member) => member in sources);
  return isSet ? sources : { points: [toPoint(sources)] };
}

/* --- requests --------------------------------------------------------------------------------------------------------- */

function pause(ms) {
  return new Promise((resume) => setTimeout(resume, ms));
}

function waitBefore(attempt, response) {
  const told = response?.headers.get("Retry-After");
  const backoff = Math.min(BACKOFF_MS * 2 ** attempt, BACKOFF_MOST_MS) * (0.5 + Math.random());
  return pause(told && /^\d+$/.test(told) ? 1000 * Number(told) : backoff);
}

async function problemOf(response) {
  const text = await response.text();
  try {
    return new ProblemError(JSON.parse(text) ?? {}, response);
  } catch {
    return new ProblemError({}, response);
  }
}

function isBytes(body) {
  return typeof body === "string" || body instanceof ArrayBuffer || ArrayBuffer.isView(body) || body instanceof Blob;
}

function toQuery(query = {}) {
  const entries = Object.entries(query).filter(([, value]) => value !== undefined);
  return entries.length ? "?" + new URLSearchParams(entries.map(([name, value]) => [name, String(value)])) : "";
}

async function readFloats(response) {
  const view = new DataView(await response.arrayBuffer());
  return Float64Array.from({ length: view.byteLength / 8 }, (_, i) => view.getFloat64(8 * i, true));
}

/* The arrays container, version 1: server/doc/020 of the daemon. */
function readArrays(buffer) {
  const view = new DataView(buffer), arrays = {};
  if (new TextDecoder().decode(buffer.slice(0, 8)) !== "GDARRAYS" || view.getUint32(8, true) !== 1) throw new GeodesicError("no arrays container of version 1");
  for (let i = 0, at = 16; i < view.getUint32(12, true); i++, at += 64) {
    const name = new TextDecoder().decode(buffer.slice(at, at + 32)).replace(/\0+$/, "");
    const Type = { 1: Float64Array, 2: Float32Array, 3: Uint32Array }[view.getUint32(at + 32, true)];
    const bytes = Number(view.getBigUint64(at + 56, true));
    arrays[name] = new Type(buffer, Number(view.getBigUint64(at + 48, true)), bytes / Type.BYTES_PER_ELEMENT);
  }
  return arrays;
}

/* Typed arrays by name: Uint32Array of elements, the others of rows of three numbers. */
function writeArrays(arrays) {
  const names = Object.keys(arrays), padded = (size) => Math.ceil(size / 8) * 8;
  let offset = 16 + 64 * names.length;
  const bytes = new Uint8Array(offset + names.reduce((sum, name) => sum + padded(arrays[name].byteLength), 0));
  const view = new DataView(bytes.buffer);
  new TextEncoder().encodeInto("GDARRAYS", bytes);
  view.setUint32(8, 1, true);
  view.setUint32(12, names.length, true);
  names.forEach((name, i) => {
    const values = arrays[name], at = 16 + 64 * i, isIndex = values instanceof Uint32Array;
    new TextEncoder().encodeInto(name, bytes.subarray(at, at + 31));
    view.setUint32(at + 32, isIndex ? 3 : values instanceof Float32Array ? 2 : 1, true);
    view.setUint32(at + 36, isIndex ? 0 : 3, true);
    view.setBigUint64(at + 40, BigInt(values.length / (isIndex ? 1 : 3)), true);
    view.setBigUint64(at + 48, BigInt(offset), true);
    view.setBigUint64(at + 56, BigInt(values.byteLength), true);
    bytes.set(new Uint8Array(values.buffer, values.byteOffset, values.byteLength), offset);
    offset += padded(values.byteLength);
  });
  return bytes;
}

/* --- jobs ------------------------------------------------------------------------------------------------------------- */

/* The events of a stream: [name, data]. */
async function* readEvents(stream) {
  const decoder = new TextDecoder();
  let text = "", name = "";
  for await (const bytes of chunksOf(stream)) {
    const lines = (text + decoder.decode(bytes, { stream: true })).split("\n");
    text = lines.pop();
    for (const line of lines) {
      if (line.startsWith("event: ")) name = line.slice(7);
      if (line.startsWith("data: ")) yield [name, line.slice(6)];
    }
  }
}

async function* chunksOf(stream) {
  const reader = stream.getReader();
  try {
    for (let read = await reader.read(); !read.done; read = await reader.read()) yield read.value;
  } finally {
    reader.releaseLock();
  }
}

export class Job {
  constructor(client, answer) {
    this.client = client;
    this.id = answer.id;
    this.#hear(answer);
  }

  #hear({ state, progress }) {
    this.state = state;
    this.progress = progress;
  }

  get isOver() {
    return ["done", "failed", "cancelled"].includes(this.state);
  }

  async wait(onProgress) {
    while (!this.isOver) {
      const response = await this.client.call("GET", `/v1/jobs/${this.id}/events`);
      for await (const [, data] of readEvents(response.body)) {
        this.#hear(JSON.parse(data));
        onProgress?.(this.progress);
      }
    }
    return this;
  }

  async response() {
    if (this.state === "cancelled") throw new JobCancelled(`job ${this.id} has been cancelled`);
    return this.client.call("GET", `/v1/jobs/${this.id}/result`);
  }

  async cancel() {
    await this.client.call("DELETE", `/v1/jobs/${this.id}`);
  }
}

/* --- what the daemon holds -------------------------------------------------------------------------------------------- */

export class Resource {
  constructor(client, location) {
    this.client = client;
    this.location = location;
  }

  async query(name, body, { onProgress, signal, ...query } = {}) {
    return (await this.client.call("POST", `${this.location}/${name}`, { query, body, onProgress, signal })).json();
  }

  async queryArrays(name, body, { form = "f64", ...query } = {}) {
    const call = { query: { ...query, format: form }, body };
    return readArrays(await (await this.client.call("POST", `${this.location}/${name}`, call)).arrayBuffer());
  }

  async describe() {
    return (await this.client.call("GET", this.location)).json();
  }

  async delete() {
    await this.client.call("DELETE", this.location);
  }

  async exists() {
    try {
      await this.client.call("HEAD", this.location);
      return true;
    } catch (error) {
      if (error.status === 404) return false;
      throw error;
    }
  }
}

export class Surface extends Resource {
  constructor(client, kind, name) {
    super(client, `/v1/${kind}/${encodeURIComponent(name)}`);
    this.name = name;
  }
}

export class Field extends Resource {
  constructor(mesh, answer) {
    super(mesh.client, `${mesh.location}/fields/${answer.id}`);
    this.id = answer.id;
    this.max = answer.max;
    this.farthest = answer.farthest;
  }

  async values() {
    return readFloats(await this.client.call("GET", `${this.location}/values`, { headers: { Accept: FLOATS } }));
  }

  async file(format = "ply") {
    return (await this.client.call("GET", `${this.location}/values`, { query: { format } })).arrayBuffer();
  }

  async distances(points) {
    const { results } = await this.query("evaluate", { points: points.map(toPoint) }, { select: "distance" });
    return results.map((result) => result.distance);
  }

  async isolines(levels, tolerance) {
    return (await this.query("isolines", { levels, tolerance })).isolines;
  }

  async isolinesFile(levels, format = "obj", { tolerance, mesh } = {}) {
    const call = { query: { format, mesh }, body: { levels, tolerance } };
    return (await this.client.call("POST", `${this.location}/isolines`, call)).arrayBuffer();
  }
}

export class Mesh extends Surface {
  constructor(client, name) {
    super(client, "meshes", name);
  }

  #ends(from, to, via) {
    return { from: toPoint(from), to: toPoint(to), ...(via?.length ? { via: via.map(toPoint) } : {}) };
  }

  async distance(from, to, { via, signal } = {}) {
    return (await this.query("distance", this.#ends(from, to, via), { select: "distance", signal })).distance;
  }

  async path(from, to, { via, signal } = {}) {
    const { path } = await this.query("path", this.#ends(from, to, via), { select: "path", geometry: "xyz", signal });
    return path ?? null;
  }

  async pathFile(from, to, format = "obj", { via, mesh, signal } = {}) {
    const call = { query: { format, mesh }, body: this.#ends(from, to, via), signal };
    return (await this.client.call("POST", `${this.location}/path`, call)).arrayBuffer();
  }

  async picture(form = "png", query = {}) {
    return (await this.client.call("GET", `${this.location}/picture.${form}`, { query })).arrayBuffer();
  }

  async nearest(point) {
    return this.query("nearest", { point: toPoint(point) });
  }

  async #bulk(name, arrays) {
    const call = { query: { format: "f64" }, body: writeArrays(arrays), headers: { "Content-Type": FLOATS } };
    return readArrays(await (await this.client.call("POST", `${this.location}/${name}`, call)).arrayBuffer());
  }

  async pairs(from, to) {
    return (await this.#bulk("pairs", { from, to })).distances;
  }

  async nearestPoints(xyz) {
    return this.#bulk("nearest-points", { points: xyz });
  }

  async matrix(sources, targets, { maxDistance, onProgress } = {}) {
    const body = { sources: sources.map(toPoint), targets: targets.map(toPoint), max_distance: maxDistance };
    const call = { body, headers: { Accept: FLOATS }, onProgress };
    const values = await readFloats(await this.client.call("POST", `${this.location}/matrix`, call));
    return sources.map((_, row) => values.subarray(row * targets.length, (row + 1) * targets.length));
  }

  async field(sources, { maxDistance, onProgress } = {}) {
    return new Field(this, await this.query("fields", { set: toSet(sources), max_distance: maxDistance }, { onProgress }));
  }

  async content(format = "obj") {
    const response = await this.client.call("GET", `${this.location}/content`, { query: { format } });
    return TEXTS.includes(format) ? response.text() : response.arrayBuffer();
  }
}

export class Client {
  constructor(url = "http://127.0.0.1:8080", { key, retries = 5 } = {}) {
    this.url = String(url).replace(/\/$/, "");
    this.retries = retries;
    this.headers = key ? { Authorization: `Bearer ${key}` } : {};
  }

  /* To a page of another origin a dead daemon looks like one that refuses the origin, except without CORS. */
  async #refusesOrigin() {
    const origin = globalThis.location?.origin;
    if (!origin || origin === new URL(this.url, globalThis.location.href).origin) return false;
    try {
      return (await fetch(this.url + "/livez", { mode: "no-cors" })).type === "opaque";
    } catch {
      return false;
    }
  }

  /* On this machine, and not in a browser, which sets the header itself. */
  get #isNear() {
    return typeof process === "object" && /^(localhost|\[::1\]|127\.[\d.]+)$/.test(new URL(this.url).hostname);
  }

  async #fetch(target, init) {
    try {
      return await fetch(this.url + target, init);
    } catch (error) {
      if (init.signal?.aborted) throw error;
      if (await this.#refusesOrigin())
        throw new OriginRefused(
          `the daemon at ${this.url} refuses requests of pages from ${location.origin}; start it with --cors-origin ${location.origin}`,
          { cause: error },
        );
      throw new ConnectionFailed(`no answer from ${this.url}: ${error.cause?.message ?? error.message}`, { cause: error });
    }
  }

  async #request(method, target, init, repeatable) {
    for (let attempt = 0; ; attempt++) {
      let response;
      try {
        response = await this.#fetch(target, { ...init, method });
      } catch (error) {
        if (!(error instanceof ConnectionFailed) || error instanceof OriginRefused || !repeatable || attempt >= this.retries) throw error;
      }
      const isBusy = !response || response.status === 429 || response.status === 503;
      if (!isBusy || attempt >= this.retries) return response;
      await response?.body?.cancel();
      await waitBefore(attempt, response);
    }
  }

  async call(method, path, { query, body, headers = {}, onProgress, signal, repeatable = true } = {}) {
    if (onProgress) return (await (await this.submit(method, path, { query, body, headers, signal })).wait(onProgress)).response();
    const sent = { ...this.headers, ...headers };
    if (this.#isNear) sent["Accept-Encoding"] ??= "identity"; // packing takes longer than the way
    if (body !== undefined && !isBytes(body)) {
      body = JSON.stringify(body);
      sent["Content-Type"] ??= "application/json";
    }
    const response = await this.#request(method, path + toQuery(query), { body, headers: sent, signal }, repeatable);
    if (response.status >= 400) throw await problemOf(response);
    return response;
  }

  async submit(method, path, { headers, ...rest } = {}) {
    const response = await this.call(method, path, { ...rest, headers: { ...headers, Prefer: "respond-async" } });
    if (response.status !== 202) throw new GeodesicError(`${method} ${path} can't be a job`);
    return new Job(this, await response.json());
  }

  async job(id) {
    return new Job(this, await (await this.call("GET", `/v1/jobs/${id}`)).json());
  }

  async service() {
    return (await this.call("GET", "/v1")).json();
  }

  async *pages(path, member, query = {}) {
    for (let after; after !== null; ) {
      const page = await (await this.call("GET", path, { query: { ...query, after } })).json();
      yield* page[member];
      after = page.next;
    }
  }

  async createBatch(request) {
    return (await this.call("POST", "/v1/batches", { body: request, repeatable: false })).json();
  }

  async batch(id) {
    return (await this.call("GET", `/v1/batches/${id}`)).json();
  }

  async waitBatch(id, onProgress) {
    for (;;) {
      const query = { wait: onProgress ? 1 : BATCH_WAIT_S };
      const batch = await (await this.call("GET", `/v1/batches/${id}`, { query })).json();
      onProgress?.(batch.progress);
      if (batch.state !== "running") return batch;
    }
  }

  async *batchResults(id, { wait = false } = {}) {
    const path = `/v1/batches/${id}/results`;
    if (!wait) return yield* this.pages(path, "results");
    for (let cursor = 0; cursor !== null; ) {
      const page = await (await this.call("GET", path, { query: { cursor, wait: BATCH_WAIT_S } })).json();
      yield* page.results;
      cursor = page.next;
    }
  }

  async deleteBatch(id) {
    await this.call("DELETE", `/v1/batches/${id}`);
  }

  meshes({ prefix } = {}) {
    return this.pages("/v1/meshes", "meshes", { prefix });
  }

  mesh(name) {
    return new Mesh(this, name);
  }

  subdivision(name) {
    return new Surface(this, "subdivisions", name);
  }

  nurbs(name) {
    return new Surface(this, "nurbs", name);
  }

  async upload(name, content, { onProgress, signal, ...query } = {}) {
    const headers = isBytes(content) ? { "Content-Type": FLOATS } : {};
    const path = name === null ? "/v1/meshes" : `/v1/meshes/${encodeURIComponent(name)}`;
    const call = { query, body: content, headers, onProgress, signal };
    return this.mesh((await (await this.call(name === null ? "POST" : "PUT", path, call)).json()).name);
  }
}
