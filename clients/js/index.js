/* Exact geodesics on surfaces, from a geodesicd daemon. For browsers and Node.js 18 or later; needs
 * only fetch. index.d.ts documents the exports. */

const BACKOFF_MS = 100; // pause before the first retry; the pause doubles with each further retry
const BACKOFF_MOST_MS = 10000;
const RETRY_AFTER_MOST_MS = 120000; // a refusal with a longer Retry-After is thrown at once
const FLOATS = "application/octet-stream";
const BATCH_WAIT_S = 30; // the longest wait of one request for a batch
const PREVIEW_WAIT_MS = 500; // pause between two requests for a preview
const SPLIT_MOST = 64; // largest number of meshes that one request creates
const TEXTS = ["obj", "off", "gltf"]; // the mesh formats that are text

export class GeodesicError extends Error {
  get name() {
    return this.constructor.name;
  }
}

export class ConnectionFailed extends GeodesicError {}

export class OriginRefused extends ConnectionFailed {}

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

export class JobCancelled extends GeodesicError {}

/* --- points ----------------------------------------------------------------------------------- */

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

/* Converts a point of an answer to the most exact form that a request can have. Returns other
 * objects unchanged. */
function askable(point) {
  if (point.vertex !== undefined) return { vertex: point.vertex };
  if (point.edge !== undefined) return { edge: point.edge, t: point.t };
  if (point.barycentric !== undefined) return { face: point.face, barycentric: point.barycentric };
  return point;
}

export function toPoint(point) {
  if (typeof point === "number") return { vertex: point };
  if (Array.isArray(point)) return { xyz: point };
  if (ArrayBuffer.isView(point)) return { xyz: [...point] };
  if (point?.isVector3) return { xyz: [point.x, point.y, point.z] }; // a Vector3 of three.js
  if (typeof point === "object" && point !== null) return askable(point);
  if (typeof point === "string" && COMPACT_FORM.test(point)) return COMPACT[point[0]](point.slice(2));
  throw new TypeError(`${JSON.stringify(point)} is not a point; write v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1,2,3`);
}

/* Converts points to a list. An array of floating-point type has rows of three coordinates; any
 * other list has one point in each item. */
export function toPoints(points) {
  if (!(points instanceof Float64Array || points instanceof Float32Array)) return Array.from(points, toPoint);
  return Array.from({ length: points.length / 3 }, (_, i) => ({ xyz: [...points.subarray(3 * i, 3 * i + 3)] }));
}

/* Converts sources to a set. Three numbers that are not all integers are a point in space; any
 * other list is a list of points. */
export function toSet(sources) {
  if (ArrayBuffer.isView(sources)) return { points: toPoints(sources) };
  if (Array.isArray(sources)) {
    const isPlace = sources.length === 3 && sources.some((x) => typeof x === "number" && !Number.isInteger(x));
    return { points: isPlace ? [{ xyz: sources }] : sources.map(toPoint) };
  }
  const isSet = typeof sources === "object" && ["points", "curves", "boundaries"].some((member) => member in sources);
  return isSet ? sources : { points: [toPoint(sources)] };
}

/* --- drags ------------------------------------------------------------------------------------ */

export function newest(ask, show, fail = console.error) {
  let next;
  let isRunning = false;
  const control = new AbortController();
  const run = async () => {
    for (isRunning = true; next; ) {
      const [input] = next;
      next = undefined;
      try {
        const answer = await ask(input, control.signal);
        if (!control.signal.aborted) show(answer, input);
      } catch (error) {
        if (!control.signal.aborted) fail(error);
      }
    }
    isRunning = false;
  };
  const put = (input) => {
    next = [input];
    if (!isRunning && !control.signal.aborted) run();
  };
  put.stop = () => {
    next = undefined;
    control.abort();
  };
  return put;
}

/* --- requests --------------------------------------------------------------------------------- */

async function pause(ms, signal) {
  signal?.throwIfAborted();
  let timer, end;
  await new Promise((resume) => {
    timer = setTimeout(resume, ms);
    end = resume;
    signal?.addEventListener("abort", end);
  });
  clearTimeout(timer);
  signal?.removeEventListener("abort", end);
  signal?.throwIfAborted();
}

/* Returns the milliseconds of Retry-After; undefined without this header. */
function retryAfter(response) {
  const told = response?.headers.get("Retry-After");
  return told && /^\d+$/.test(told) ? 1000 * Number(told) : undefined;
}

function waitBefore(attempt, response, signal) {
  const backoff = Math.min(BACKOFF_MS * 2 ** attempt, BACKOFF_MOST_MS) * (0.5 + Math.random());
  return pause(retryAfter(response) ?? backoff, signal);
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

/* For JSON.stringify, which would write null for a number that is not finite. */
function onlyFinite(name, value) {
  if (typeof value === "number" && !Number.isFinite(value)) throw new TypeError(`${name}: ${value} is not a finite number`);
  return value;
}

function toQuery(query = {}) {
  const entries = Object.entries(query).filter(([, value]) => value !== undefined);
  return entries.length ? "?" + new URLSearchParams(entries.map(([name, value]) => [name, String(value)])) : "";
}

async function readFloats(response) {
  // The answer is little-endian, like typed arrays in all JavaScript engines.
  return new Float64Array(await response.arrayBuffer());
}

/* Reads the arrays container, version 1 (server/doc/020), as typed arrays by name. */
export function readArrays(buffer) {
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

/* Converts indices to a Uint32Array, and rows of three coordinates to a Float64Array. */
function toBulk(values) {
  if (values instanceof Uint32Array || values instanceof Float64Array || values instanceof Float32Array) return values;
  const list = Array.from(values);
  if (list.some((value) => typeof value === "object")) return Float64Array.from(list.flatMap((row) => (row.isVector3 ? [row.x, row.y, row.z] : [...row])));
  const wrong = list.find((value) => !(Number.isInteger(value) && value >= 0 && value < 2 ** 32));
  if (wrong !== undefined) throw new TypeError(`${wrong} is not the index of a vertex; give indices, or rows of three coordinates`);
  return Uint32Array.from(list);
}

/* Writes typed arrays by name as a container. A Uint32Array has one index per row, other arrays
 * have three numbers per row. */
export function writeArrays(arrays) {
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

/* --- meshes as arrays ------------------------------------------------------------------------- */

/* Returns a binary PLY file. `vertices` has rows of three coordinates, `faces` rows of three
 * indices. */
function writePly(vertices, faces) {
  const [count, triangles] = [vertices.length / 3, faces.length / 3], type = vertices instanceof Float32Array ? "float" : "double";
  const head = new TextEncoder().encode(
    `ply\nformat binary_little_endian 1.0\nelement vertex ${count}\nproperty ${type} x\nproperty ${type} y\nproperty ${type} z\n` +
      `element face ${triangles}\nproperty list uchar uint vertex_indices\nend_header\n`,
  );
  const start = head.length + vertices.byteLength, bytes = new Uint8Array(start + 13 * triangles), view = new DataView(bytes.buffer);
  bytes.set(head);
  bytes.set(new Uint8Array(vertices.buffer, vertices.byteOffset, vertices.byteLength), head.length);
  for (let i = 0; i < triangles; i++) {
    view.setUint8(start + 13 * i, 3);
    for (let k = 0; k < 3; k++) view.setUint32(start + 13 * i + 1 + 4 * k, faces[3 * i + k], true);
  }
  return bytes;
}

/* Returns the body of an upload: PLY if `faces` is a flat list of triangles, JSON if it is a
 * list of rows. */
function toMeshBody({ vertices, faces }) {
  const isFlat = (list) => ArrayBuffer.isView(list) || typeof list[0] === "number";
  const typed = (list, Type) => (ArrayBuffer.isView(list) ? list : Type.from(isFlat(list) ? list : list.flatMap((row) => [...row])));
  if (isFlat(faces)) return writePly(typed(vertices, Float64Array), typed(faces, Uint32Array));
  const rows = (list) => Array.from({ length: list.length / 3 }, (_, i) => [...list.slice(3 * i, 3 * i + 3)]);
  return { vertices: isFlat(vertices) ? rows(vertices) : vertices, faces };
}

/* Reads binary PLY only in the form that the daemon writes. */
function readPly(buffer) {
  const mark = "end_header\n", text = new TextDecoder("latin1").decode(buffer.slice(0, 1000)), head = text.slice(0, text.indexOf(mark) + mark.length);
  const [count, triangles] = ["vertex", "face"].map((name) => Number(head.match(`element ${name} (\\d+)`)[1]));
  const vertices = new Float64Array(buffer.slice(head.length, head.length + 24 * count));
  const view = new DataView(buffer, head.length + vertices.byteLength), faces = new Uint32Array(3 * triangles);
  for (let i = 0; i < faces.length; i++) faces[i] = view.getUint32(13 * Math.floor(i / 3) + 1 + 4 * (i % 3), true);
  return { vertices, faces };
}

/* Merges vertices that round to the same point of a grid. Its step is a millionth of the largest
 * coordinate. three.js repeats vertices where normals or texture coordinates differ. */
export function fromGeometry(geometry) {
  const position = geometry.getAttribute("position"), places = new Map(), vertices = [];
  const rows = Array.from({ length: position.count }, (_, i) => [position.getX(i), position.getY(i), position.getZ(i)]);
  const step = 1e-6 * rows.reduce((size, xyz) => Math.max(size, ...xyz.map(Math.abs)), 0);
  const index = Uint32Array.from(rows, (xyz) => {
    const key = xyz.map((x) => Math.round(x / step)).join();
    if (!places.has(key)) places.set(key, vertices.push(xyz) - 1);
    return places.get(key);
  });
  const corners = geometry.index ? Array.from(geometry.index.array, (i) => index[i]) : index;
  const faces = [];
  for (let i = 0; i + 2 < corners.length; i += 3) {
    const [a, b, c] = [corners[i], corners[i + 1], corners[i + 2]];
    // Drops triangles without area, which merging leaves at the poles of spheres, for example.
    if (a !== b && b !== c && c !== a) faces.push(a, b, c);
  }
  return { vertices: Float64Array.from(vertices.flat()), faces: Uint32Array.from(faces), index };
}

/* --- jobs ------------------------------------------------------------------------------------- */

/* Yields the data of the server-sent events of a stream, until it ends or breaks. */
async function* readEvents(stream, signal) {
  const reader = stream.getReader(), decoder = new TextDecoder();
  const read = () =>
    reader.read().catch((error) => {
      if (signal?.aborted) throw error;
      return { done: true };
    });
  let text = "";
  try {
    for (let part = await read(); !part.done; part = await read()) {
      const lines = (text + decoder.decode(part.value, { stream: true })).split("\n");
      text = lines.pop();
      for (const line of lines) if (line.startsWith("data: ")) yield line.slice(6);
    }
  } finally {
    reader.cancel().catch(() => {}); // closes the connection if the caller does not read to the end
  }
}

export class Job {
  constructor(client, answer) {
    this.client = client;
    this.id = answer.id;
    this.#hear(answer);
  }

  #hear({ state, progress }, onProgress) {
    this.state = state;
    this.progress = progress;
    onProgress?.(progress);
  }

  get isOver() {
    return ["done", "failed", "cancelled"].includes(this.state);
  }

  async wait(onProgress, { signal } = {}) {
    onProgress?.(this.progress);
    while (!this.isOver) {
      const { body } = await this.client.call("GET", `/v1/jobs/${this.id}/events`, { signal });
      for await (const data of readEvents(body, signal)) this.#hear(JSON.parse(data), onProgress);
      // The stream may have ended before the job. This request paces the loop.
      if (!this.isOver) this.#hear(await this.client.job(this.id, { wait: 1, signal }), onProgress);
    }
    return this;
  }

  async response({ signal } = {}) {
    if (this.state === "cancelled") throw new JobCancelled(`job ${this.id} has been cancelled`);
    return this.client.call("GET", `/v1/jobs/${this.id}/result`, { signal });
  }

  async cancel({ signal } = {}) {
    await this.client.call("DELETE", `/v1/jobs/${this.id}`, { signal });
  }
}

/* --- resources ----------------------------------------------------------------------------- */

export class Resource {
  constructor(client, location) {
    this.client = client;
    this.location = location;
  }

  /* Sends a request to a path below this resource. `read` names the method of Response that reads
   * the answer. */
  async get(rest, read, call, method = "GET") {
    return (await this.client.call(method, this.location + rest, call))[read]();
  }

  async query(name, body, { onProgress, signal, ...query } = {}) {
    return this.get(`/${name}`, "json", { query, body, onProgress, signal }, "POST");
  }

  async queryArrays(name, body, { form = "f64", onProgress, signal, ...query } = {}) {
    const call = { query: { ...query, format: form }, body, onProgress, signal };
    return readArrays(await this.get(`/${name}`, "arrayBuffer", call, "POST"));
  }

  async describe({ signal } = {}) {
    return this.get("", "json", { signal });
  }

  async delete({ signal } = {}) {
    await this.client.call("DELETE", this.location, { signal });
  }

  async exists({ signal } = {}) {
    try {
      await this.client.call("HEAD", this.location, { signal });
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

  async figure(layers, { form = "png", onProgress, signal, ...scene } = {}) {
    return this.get("/picture", "arrayBuffer", { query: { format: form }, body: { layers, ...scene }, onProgress, signal }, "POST");
  }
}

export class Field extends Resource {
  constructor(mesh, answer) {
    super(mesh.client, `${mesh.location}/fields/${answer.id}`);
    this.id = answer.id;
    this.max = answer.max;
    this.farthest = answer.farthest;
  }

  async values({ signal } = {}) {
    return readFloats(await this.client.call("GET", `${this.location}/values`, { headers: { Accept: FLOATS }, signal }));
  }

  async file(format = "ply", { signal } = {}) {
    return this.get("/values", "arrayBuffer", { query: { format }, signal });
  }

  async distances(points, { signal } = {}) {
    const { results } = await this.query("evaluate", { points: toPoints(points) }, { select: "distance", signal });
    return results.map((result) => result.distance);
  }

  async isolines(levels, { tolerance, ...options } = {}) {
    return (await this.query("isolines", { ...toLevels(levels), tolerance }, options)).isolines;
  }

  async isolineArrays(levels, { tolerance, ...options } = {}) {
    return this.queryArrays("isolines", { ...toLevels(levels), tolerance }, options);
  }

  async isolinesFile(levels, format = "obj", { tolerance, mesh, signal } = {}) {
    return this.get("/isolines", "arrayBuffer", { query: { format, mesh }, body: { ...toLevels(levels), tolerance }, signal }, "POST");
  }
}

/* Converts a number of levels, or a list of levels, to a member of a request. */
function toLevels(levels) {
  return typeof levels === "number" ? { count: levels } : { levels: [...levels] };
}

export class Mesh extends Surface {
  constructor(client, name) {
    super(client, "meshes", name);
  }

  #ends(from, to, via) {
    return { from: toPoint(from), to: toPoint(to), ...(via?.length ? { via: toPoints(via) } : {}) };
  }

  async distance(from, to, { via, signal } = {}) {
    return (await this.query("distance", this.#ends(from, to, via), { select: "distance", signal })).distance;
  }

  async path(from, to, { via, signal } = {}) {
    const { path } = await this.query("path", this.#ends(from, to, via), { select: "path", geometry: "xyz", signal });
    return path ?? null;
  }

  async pathFile(from, to, format = "obj", { via, mesh, signal } = {}) {
    return this.get("/path", "arrayBuffer", { query: { format, mesh }, body: this.#ends(from, to, via), signal }, "POST");
  }

  async picture(form = "png", { signal, ...query } = {}) {
    return this.get(`/picture.${form}`, "arrayBuffer", { query, signal });
  }

  async nearest(point, { signal } = {}) {
    return this.query("nearest", { point: toPoint(point) }, { signal });
  }

  async #bulk(name, arrays, { signal } = {}) {
    const typed = Object.fromEntries(Object.entries(arrays).map(([key, values]) => [key, toBulk(values)]));
    const call = { query: { format: "f64" }, body: writeArrays(typed), headers: { "Content-Type": FLOATS }, signal };
    return readArrays(await this.get(`/${name}`, "arrayBuffer", call, "POST"));
  }

  async pairs(from, to, options) {
    return (await this.#bulk("pairs", { from, to }, options)).distances;
  }

  async nearestPoints(xyz, options) {
    return this.#bulk("nearest-points", { points: xyz }, options);
  }

  async matrix(sources, targets, { maxDistance, onProgress, signal } = {}) {
    const body = { sources: toPoints(sources), targets: toPoints(targets), max_distance: maxDistance };
    const call = { body, headers: { Accept: FLOATS }, onProgress, signal };
    const values = await readFloats(await this.client.call("POST", `${this.location}/matrix`, call)), columns = body.targets.length;
    return body.sources.map((_, row) => values.subarray(row * columns, (row + 1) * columns));
  }

  async field(sources, { maxDistance, onProgress, signal } = {}) {
    return new Field(this, await this.query("fields", { set: toSet(sources), max_distance: maxDistance }, { onProgress, signal }));
  }

  async derive(name, operations, { onProgress, signal } = {}) {
    return this.client.mesh((await this.query("derive", { mesh: name, operations }, { onProgress, signal })).name);
  }

  async split(name, operations = [{ operation: "components", keep: SPLIT_MOST + 1 }], { onProgress, signal } = {}) {
    const { meshes } = await this.query("derive", { mesh: name, split: true, operations }, { onProgress, signal });
    return meshes.map((mesh) => this.client.mesh(mesh.name));
  }

  async origins({ signal } = {}) {
    return (await this.get("/origins", "json", { signal })).origins;
  }

  async preview({ faces, format, onProgress, signal } = {}) {
    const call = { query: { faces, format: format ?? "glb" }, signal };
    for (;;) {
      const response = await this.client.call("GET", `${this.location}/preview`, call);
      if (response.status !== 202) return response.arrayBuffer();
      onProgress?.((await response.json()).progress);
      await pause(PREVIEW_WAIT_MS, signal);
    }
  }

  async content(format = "obj", { signal } = {}) {
    return this.get("/content", TEXTS.includes(format) ? "text" : "arrayBuffer", { query: { format }, signal });
  }

  async arrays(options) {
    return readPly(await this.content("ply", options));
  }
}

export class Client {
  constructor(url = "http://127.0.0.1:8080", { key, retries = 5 } = {}) {
    this.url = String(url).replace(/\/$/, "");
    if (!/^(https?:\/\/|\/|$)/.test(this.url)) throw new TypeError(`${url} is not an address of a daemon; write http://HOST:PORT or https://HOST:PORT`);
    this.retries = retries;
    this.headers = key ? { Authorization: `Bearer ${key}` } : {};
  }

  /* Returns whether the daemon runs but refuses the page's origin. If it runs, a request without
   * CORS succeeds. */
  async #refusesOrigin() {
    const origin = globalThis.location?.origin;
    if (!origin || origin === new URL(this.url, globalThis.location.href).origin) return false;
    try {
      return (await fetch(this.url + "/livez", { mode: "no-cors" })).type === "opaque";
    } catch {
      return false;
    }
  }

  /* True if the daemon is on this machine and this is not a browser. Browsers set Accept-Encoding
   * themselves. */
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
      const pauseMs = response && (retryAfter(response) ?? (repeatable ? 0 : Infinity));
      const isBusy = !response || ([429, 503].includes(response.status) && pauseMs <= RETRY_AFTER_MOST_MS);
      if (!isBusy || attempt >= this.retries) return response;
      await response?.body?.cancel();
      await waitBefore(attempt, response, init.signal);
    }
  }

  async call(method, path, { query, body, headers = {}, onProgress, signal, repeatable = true } = {}) {
    if (onProgress) return this.#runJob(await this.submit(method, path, { query, body, headers, signal }), onProgress, signal);
    const sent = { ...this.headers, ...headers };
    // On one machine, compressing takes longer than sending the uncompressed bytes.
    if (this.#isNear) sent["Accept-Encoding"] ??= "identity";
    if (body !== undefined && !isBytes(body)) {
      body = JSON.stringify(body, onlyFinite);
      sent["Content-Type"] ??= "application/json";
    }
    const response = await this.#request(method, path + toQuery(query), { body, headers: sent, signal }, repeatable);
    this.#guardBody(response, signal);
    if (response.status >= 400) throw await problemOf(response);
    return response;
  }

  /* Cancels the job if the caller aborts the wait, or if `onProgress` throws an error. */
  async #runJob(job, onProgress, signal) {
    try {
      return await (await job.wait(onProgress, { signal })).response({ signal });
    } catch (error) {
      if (!(error instanceof GeodesicError)) job.cancel().catch(() => {});
      throw error;
    }
  }

  /* Makes the methods that read the body throw this library's errors: if the connection fails
   * within the body, and if the body is not JSON. */
  #guardBody(response, signal) {
    for (const name of ["json", "text", "arrayBuffer"]) {
      const read = response[name].bind(response);
      response[name] = async () => {
        try {
          return await read();
        } catch (error) {
          if (signal?.aborted) throw error;
          if (error instanceof SyntaxError) throw new GeodesicError(`the answer of ${this.url} is not JSON: ${error.message}`, { cause: error });
          throw new ConnectionFailed(`the answer of ${this.url} was cut off: ${error.message}`, { cause: error });
        }
      };
    }
  }

  async submit(method, path, { headers, ...rest } = {}) {
    const response = await this.call(method, path, { ...rest, headers: { ...headers, Prefer: "respond-async" } });
    if (response.status !== 202) throw new GeodesicError(`${method} ${path} can't be a job`);
    return new Job(this, await response.json());
  }

  async #read(path, call) {
    return (await this.call("GET", path, call)).json();
  }

  async job(id, { wait = 0, signal } = {}) {
    return new Job(this, await this.#read(`/v1/jobs/${id}`, { query: { wait }, signal }));
  }

  async service({ signal } = {}) {
    return this.#read("/v1", { signal });
  }

  async *pages(path, member, query = {}, { signal } = {}) {
    for (let after; after !== null; ) {
      const page = await this.#read(path, { query: { ...query, after }, signal });
      yield* page[member];
      after = page.next;
    }
  }

  async createBatch(request, { signal } = {}) {
    return (await this.call("POST", "/v1/batches", { body: request, repeatable: false, signal })).json();
  }

  async batch(id, { signal } = {}) {
    return this.#read(`/v1/batches/${id}`, { signal });
  }

  async waitBatch(id, onProgress, { signal } = {}) {
    for (;;) {
      const batch = await this.#read(`/v1/batches/${id}`, { query: { wait: onProgress ? 1 : BATCH_WAIT_S }, signal });
      onProgress?.(batch.progress);
      if (batch.state !== "running") return batch;
    }
  }

  async *batchResults(id, { wait = false, signal } = {}) {
    const path = `/v1/batches/${id}/results`;
    if (!wait) return yield* this.pages(path, "results", {}, { signal });
    for (let cursor = 0; cursor !== null; ) {
      const page = await this.#read(path, { query: { cursor, wait: BATCH_WAIT_S }, signal });
      yield* page.results;
      cursor = page.next;
    }
  }

  async deleteBatch(id, { signal } = {}) {
    await this.call("DELETE", `/v1/batches/${id}`, { signal });
  }

  meshes({ prefix, signal } = {}) {
    return this.pages("/v1/meshes", "meshes", { prefix }, { signal });
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
    if (content?.isBufferGeometry) content = fromGeometry(content);
    if (content?.vertices && content.faces) content = toMeshBody(content);
    if (typeof content !== "string" && !(content instanceof Object))
      throw new TypeError("the content is not a mesh; give the content of a file, { vertices, faces }, or a geometry of three.js");
    const headers = isBytes(content) ? { "Content-Type": FLOATS } : {};
    const path = name === null ? "/v1/meshes" : `/v1/meshes/${encodeURIComponent(name)}`;
    const call = { query, body: content, headers, onProgress, signal };
    return this.mesh((await (await this.call(name === null ? "POST" : "PUT", path, call)).json()).name);
  }
}
