// Modules of the viewer that need no page, checked by mathematical laws and simpler computations.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { runGroups } from "./groups.mjs";

const SOURCES = path.join(path.dirname(fileURLToPath(import.meta.url)), "../../clients/web/src");

/** Loads a module of the viewer, compiled by the esbuild that compiles the pages. */
async function load(settings, name) {
  const { buildSync } = createRequire(path.join(settings.pages, "package.json"))("esbuild");
  const [{ text }] = buildSync({
    entryPoints: [path.join(SOURCES, `${name}.ts`)],
    bundle: true,
    format: "esm",
    nodePaths: [path.join(settings.pages, "node_modules")],
    write: false,
  }).outputFiles;
  return import(`data:text/javascript;base64,${Buffer.from(text).toString("base64")}`);
}

/** Returns a generator of reproducible numbers from 0 to 1. */
function randoms(seed) {
  return () => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return seed / 2 ** 32;
  };
}

function soup(count, random) {
  const positions = Float32Array.from({ length: 9 * count }, (_, i) => (i % 9 < 3 ? 2 * random() - 1 : NaN));
  for (let i = 0; i < positions.length; i++)
    if (Number.isNaN(positions[i])) positions[i] = positions[i - (i % 9) + (i % 3)] + 0.6 * (random() - 0.5);
  return { positions, faces: Uint32Array.from({ length: 3 * count }, (_, i) => i) };
}

async function rays({ settings }) {
  const { Bvh } = await load(settings, "bvh");
  const random = randoms(1);
  const point = (size) => [0, 0, 0].map(() => size * (2 * random() - 1));
  let hits = 0;
  for (const count of [1, 5, 6, 7, 13, 100, 1000]) {
    const { positions, faces } = soup(count, random);
    const tree = new Bvh(positions, faces);
    const single = Array.from({ length: count }, (_, i) => new Bvh(positions, faces.subarray(3 * i, 3 * i + 3)));
    for (let i = 0; i < 200; i++) {
      const origin = point(3);
      const direction = point(0.8).map((x, axis) => x - origin[axis]);
      if (i % 4 === 0) direction[i % 3] = 0;
      const all = single.map((one) => one.cast(origin, direction)?.distance ?? Infinity);
      const hit = tree.cast(origin, direction);
      assert.equal(hit?.distance ?? Infinity, Math.min(...all));
      if (hit) assert.equal(hit.distance, all[hit.face]);
      hits += hit ? 1 : 0;
    }
  }
  assert.ok(hits > 200, `${hits} hits`);
}

async function files({ settings }) {
  const { parsePly } = await load(settings, "ply");
  for (const comment of ["", "x", "xy", "xyz"]) {
    const header =
      `ply\nformat binary_little_endian 1.0\ncomment ${comment}\nelement vertex 3\n` +
      "property double x\nproperty double y\nproperty double z\n" +
      "element face 2\nproperty list uchar uint vertex_indices\nend_header\n";
    const bytes = Buffer.concat([
      Buffer.from(header),
      Buffer.from(Float64Array.from([0, 1, 2, 3, 4, 1e300, -1e-300, 7, 8]).buffer),
      Buffer.from([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0]),
    ]);
    const { positions, faces } = parsePly(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
    assert.deepEqual([...positions], [0, 1, 2, 3, 4, 1e300, -1e-300, 7, 8]);
    assert.deepEqual([...faces], [0, 1, 2, 2, 1, 0]);
  }
}

/** Returns the words into which a shell splits a command line. */
const words = (command) =>
  execFileSync("sh", ["-c", `printf '%s\\n' ${command}`])
    .toString()
    .trimEnd()
    .split("\n");

async function commands({ settings }) {
  const { curlOf } = await load(settings, "curl");
  const json = { label: `it's "so" $HOME \`id\` & \\ more`, xyz: [1, -2.5, 1e-9] };
  const request = { method: "POST", path: "/v1/meshes/a/path", query: { geometry: "xyz" }, json };
  assert.deepEqual(words(curlOf(request, "http://h:1", false)), [
    "curl",
    "--json",
    JSON.stringify(json),
    "http://h:1/v1/meshes/a/path?geometry=xyz",
  ]);
  const upload = { method: "PUT", path: "/v1/meshes/a", file: { name: "my 'file'; rm.obj", body: null } };
  assert.deepEqual(words(curlOf(upload, "http://h:1", false)), [
    "curl",
    "-T",
    "my 'file'; rm.obj",
    "http://h:1/v1/meshes/a",
  ]);
  assert.deepEqual(words(curlOf({ method: "DELETE", path: "/v1/meshes/a" }, "http://h:1", false)), [
    "curl",
    "-X",
    "DELETE",
    "http://h:1/v1/meshes/a",
  ]);
  assert.match(curlOf({ method: "GET", path: "/v1" }, "http://h:1", true), /"Authorization: Bearer \$KEY"/);
}

async function newest({ settings }) {
  const { Latest } = await load(settings, "latest");
  const done = [];
  const latest = new Latest(async (input) => {
    await new Promise((resolve) => setTimeout(resolve, 5));
    done.push(input);
  });
  for (let i = 0; i < 9; i++) latest.put(i);
  assert.ok(latest.busy);
  while (latest.busy) await new Promise((resolve) => setTimeout(resolve, 1));
  assert.deepEqual(done, [0, 8]);
}

async function places({ settings }) {
  const { compactOf, parseCompact, parseXyz, pointOf, rounded } = await load(settings, "place");
  const random = randoms(2);
  for (let i = 0; i < 1000; i++) {
    const [a, b] = [random(), random()].sort();
    const barycentric = rounded([a, b - a, 1 - b]);
    assert.ok(Math.abs(barycentric[0] + barycentric[1] + barycentric[2] - 1) < 1e-12);
    assert.deepEqual(parseCompact(compactOf({ face: i, barycentric })), { face: i, barycentric });
  }
  const free = { face: 3, barycentric: [1, 0, 0], xyz: [0.1, -2, 3e-7], isFree: true };
  assert.deepEqual(pointOf(free), { xyz: free.xyz });
  assert.deepEqual(parseXyz(compactOf(free)), free.xyz);
  for (const text of ["", "f:1", "f:x:1,0,0", "f:1:a,b,c", "v:1"]) assert.equal(parseCompact(text), null);
  for (const text of ["", "p:", "p:1,2", "p:1,2,x", "f:1:1,0,0"]) assert.equal(parseXyz(text), null);
}

async function numbers({ settings }) {
  const { Units, bytes, number } = await load(settings, "units");
  assert.deepEqual(
    [0, 1234567, -0.5, 1 / 3, 1e-5, 2.5e9].map((value) => number(value, 4)),
    ["0", "1\u202f235\u202f000", "−0.5", "0.3333", "1.000e−5", "2.500e9"],
  );
  assert.deepEqual([bytes(999), bytes(1536), bytes(2 ** 32)], ["999 B", "1.5 KiB", "4 GiB"]);
  const units = new Units();
  assert.equal(units.length(2), "2 units");
  [units.file, units.shown] = ["in", "mm"];
  assert.equal(units.length(2), "50.8 mm");
  assert.equal(units.area(1), "645.16 mm²");
  units.shown = "units";
  assert.equal(units.length(2), "2 in");
}

const CUBE = {
  positions: Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1]),
  faces: Uint32Array.from([
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 3, 0, 4, 3, 4, 7,
  ]),
};

/** A cube gets one normal for each side at each vertex; a flat sheet keeps its vertices. */
async function creases({ settings }) {
  const { shaded } = await load(settings, "creases");
  const cube = shaded(CUBE.positions, CUBE.faces);
  assert.equal(cube.copied.length, 16);
  assert.equal(cube.positions.length, 3 * 24);
  for (let i = 0; i < cube.faces.length; i++) {
    const [vertex, normal] = [cube.faces[i], cube.normals.subarray(3 * cube.faces[i], 3 * cube.faces[i] + 3)];
    const own = vertex < 8 ? vertex : cube.copied[vertex - 8];
    assert.equal(own, CUBE.faces[i]);
    assert.deepEqual([...normal].map(Math.abs).sort(), [0, 0, 1]);
  }
  const sheet = shaded(CUBE.positions.subarray(0, 12), Uint32Array.from([0, 1, 2, 0, 2, 3]));
  assert.equal(sheet.copied.length, 0);
  assert.deepEqual([...sheet.normals], [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]);
}

/**
 * Returns twice the area of a polygon that is given in barycentric coordinates. The whole face has
 * the value 1.
 */
const areaOf = (corners) =>
  corners.reduce((sum, [x, y], i) => {
    const [u, v] = corners[(i + 1) % corners.length];
    return sum + x * v - y * u;
  }, 0);

/**
 * Returns the distance of a point from the border of a convex polygon. The distance is negative
 * outside.
 */
const depthOf = ([x, y], corners) =>
  Math.min(
    ...corners.map(([a, b], i) => {
      const [c, d] = corners[(i + 1) % corners.length];
      return ((c - a) * (y - b) - (d - b) * (x - a)) / (Math.hypot(c - a, d - b) || 1);
    }),
  );

/** Pieces of a face cover it, and no bisector enters a piece. */
async function cells({ settings }) {
  const { middleOf, piecesOf } = await load(settings, "cells");
  const faces = Uint32Array.of(0, 1, 2, 0, 2, 3);
  const inside = (x, y) => ({ face: 0, barycentric: [x, y, 1 - x - y], xyz: [x, y, 0] });
  const on = (edge, t, xyz) => ({ edge, t, xyz });
  const chord = [on([0, 1], 0.25, [0.75, 0.25, 0]), on([0, 2], 0.25, [0.75, 0, 0])];
  const corner = piecesOf(faces, [0, 1, 1, 1], [chord], 0);
  assert.deepEqual(corner.map(({ face }) => face), [0, 0, 1]);
  const small = corner.find((piece) => middleOf(piece)[0] > 0.75);
  assert.ok(Math.abs(areaOf(small.corners) - 1 / 16) < 1e-12);
  assert.deepEqual(piecesOf(faces, [0, 0, 0, 0], [], 0), []);
  const bent = [chord[0], inside(0.74, 0.1), chord[1]];
  assert.equal(piecesOf(faces, [0, 1, 1, 1], [bent], 0.1).length, 3);
  const random = randoms(3);
  for (let i = 0; i < 50; i++) {
    const [x, y, size] = [0.2 + 0.2 * random(), 0.2 + 0.2 * random(), 0.05 + 0.1 * random()];
    const ring = Array.from({ length: 20 }, (_, j) => {
      const radius = size * (0.7 + 0.3 * random());
      return inside(x + radius * Math.cos(0.1 * Math.PI * j), y + radius * Math.sin(0.1 * Math.PI * j));
    });
    const pieces = piecesOf(faces, [0, 0, 0, 0], [[...ring, ring[0]]], 0);
    const area = pieces.reduce((sum, piece) => sum + areaOf(piece.corners), 0);
    assert.ok(Math.abs(area - 1) < 1e-9, `the pieces have the area ${area}`);
    for (const { corners } of pieces)
      for (const [j, { barycentric: a }] of ring.entries()) {
        const b = ring[(j + 1) % ring.length].barycentric;
        const depth = depthOf(a.map((w, axis) => (w + b[axis]) / 2), corners);
        assert.ok(depth < 1e-5, `a segment enters a piece by ${depth}`);
      }
  }
}

/** A simplified polyline stays within the tolerance, and a straight one keeps only its ends. */
async function simplification({ settings }) {
  const { simplified } = await load(settings, "simplified");
  const own = (point) => point;
  const straight = Array.from({ length: 9 }, (_, i) => [i, 2 * i, 0]);
  assert.deepEqual(simplified(straight, own, 1e-12), [straight[0], straight[8]]);
  for (const short of [[], [[1, 2, 3]], straight.slice(0, 2)]) assert.deepEqual(simplified(short, own, 1), short);
  const circle = Array.from({ length: 1001 }, (_, i) => [Math.cos((Math.PI * i) / 500), Math.sin((Math.PI * i) / 500), 0]);
  circle[1000] = circle[0];
  const kept = simplified(circle, own, 0.01);
  assert.ok(kept.length > 20 && kept.length < 60, `${kept.length} points`);
  for (let i = 0; i + 1 < kept.length; i++) {
    const middle = [0, 1].map((axis) => (kept[i][axis] + kept[i + 1][axis]) / 2);
    assert.ok(1 - Math.hypot(...middle) <= 0.01);
  }
  const long = Array.from({ length: 50000 }, (_, i) => [i, 1.0001 ** i, 0]);
  assert.ok(simplified(long, own, 0).length > 10000);
}

/** Reads back the lines of a file in each format. */
async function lineFiles({ settings }) {
  const { objOf, csvOf, glbOf } = await load(settings, "files");
  const lines = [
    [[1e6 + 0.25, 2, 3], [1e6 + 0.5, 2, 3], [1e6 + 0.5, 2.5, 3]],
    [[1e6, -1, 0.1], [1e6 + 1, -1, 0.1]],
  ];
  const obj = objOf(lines).trim().split("\n").map((row) => row.split(" "));
  const vertices = obj.filter(([word]) => word === "v").map((row) => row.slice(1).map(Number));
  assert.deepEqual(obj.filter(([word]) => word === "l").map((row) => row.slice(1).map((i) => vertices[i - 1])), lines);
  const rows = csvOf(lines).trim().split("\n").slice(1).map((row) => row.split(",").map(Number));
  assert.deepEqual(rows.map(([line, point]) => lines[line][point]), rows.map((row) => row.slice(2)));
  const bytes = glbOf(lines);
  const view = new DataView(bytes.buffer);
  assert.deepEqual([view.getUint32(0, true), view.getUint32(8, true)], [0x46546c67, bytes.length]);
  const size = view.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + size)));
  const floats = new Float32Array(bytes.slice(28 + size).buffer);
  const [centre] = json.nodes.map(({ translation }) => translation);
  assert.equal(json.accessors[0].count, 6);
  const first = [0, 1, 2].map((axis) => floats[axis] + centre[axis]);
  assert.ok(first.every((x, axis) => Math.abs(x - lines[0][0][axis]) < 1e-6), `${first}`);
}

async function names({ settings }) {
  const { freeName, nameOf } = await load(settings, "uploads");
  assert.equal(nameOf("my part (v2).obj"), "my-part--v2-");
  assert.equal(nameOf(".obj"), "mesh");
  assert.deepEqual(["a.b.obj.gz", "a.GZ", "a", ".gz"].map(nameOf), ["a.b", "a", "a", "mesh"]);
  assert.equal(freeName("spot", 2, new Set(["spot", "spot-2", "spot-4"])), "spot-3");
}

async function maps({ settings }) {
  const { RAMP_NAMES, rampBytes } = await load(settings, "colours");
  for (const name of ["viridis", "turbo", "coolwarm"]) assert.ok(RAMP_NAMES.includes(name), name);
  const ends = (isReversed) => {
    const bytes = rampBytes({ name: "viridis", isReversed }, 256);
    return [[...bytes.subarray(0, 3)], [...bytes.subarray(-4, -1)]];
  };
  assert.deepEqual(ends(false), [[68, 1, 84], [253, 231, 37]]);
  assert.deepEqual(ends(true), ends(false).reverse());
}

/** After a crash of the browser, its group runs again, once. A failed test never runs again. */
async function crashes() {
  const crash = (browser) => {
    browser.isRunning = false;
    throw new Error("closed");
  };
  const verdicts = async (...groups) => {
    const said = [];
    const open = () => ({ isRunning: true, assertQuiet: () => {}, closePages: () => {}, close: () => {} });
    const failed = await runGroups(groups, { open, empty: () => {}, say: (line) => said.push(line.match(/^(not ok|ok|#)/)[0]) });
    return [failed, ...said];
  };
  const pass = ["pass", () => {}];
  const fail = ["fail", () => assert.fail()];
  let left = 1;
  const once = ["once", (browser) => left-- > 0 && crash(browser)];
  assert.deepEqual(await verdicts([pass, once], [pass]), [0, "ok", "#", "ok", "ok", "ok"]);
  assert.deepEqual(await verdicts([pass, fail, pass]), [1, "ok", "not ok", "ok"]);
  assert.deepEqual(await verdicts([["always", crash]]), [1, "#", "not ok"]);
}

export const tests = {
  "sharp edges split normals": creases,
  "lines as files": lineFiles,
  "faces are split at bisectors": cells,
  "polylines without points that no pixel shows": simplification,
  "names of uploads": names,
  "colour maps": maps,
  "rays hit the triangles that a test of all finds": rays,
  "binary PLY": files,
  "a shell parses command lines as intended": commands,
  "a task gets the newest input": newest,
  "places and their compact form": places,
  "numbers for people": numbers,
  "a browser that crashes": crashes,
};
