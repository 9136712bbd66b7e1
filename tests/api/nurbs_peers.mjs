// Evaluates NURBS surfaces by other programs: verb-nurbs (position and derivatives), three
// (position), rhino3dm (position).
//
//     node nurbs_peers.mjs NODE_MODULES < question > answer
//
// Question: {"surfaces": [surface in the canonical form, with weights, and "uv": [[u, v], ...]]}.
// The last line is the answer: a list of {name: {"file", "values"}} with the name of the program.
// `file` is the surface as the program returns it. `values` has rows of position and, for verb,
// derivatives by u, v, uu, uv, vv.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

globalThis.window = globalThis; // verb needs `window`
const modules = `${process.argv[2]}/`;
const require = createRequire(modules);
const load = (path) => import(pathToFileURL(modules + path));

const verb = require("verb-nurbs");
const { Vector3, Vector4 } = await load("three/build/three.module.js");
const { NURBSSurface } = await load("three/examples/jsm/curves/NURBSSurface.js");
const rhino = await require("rhino3dm")();

function byVerb(s) {
  const surface = verb.geom.NurbsSurface.byKnotsControlPointsWeights(s.degreeU, s.degreeV, s.knotsU, s.knotsV, s.controlPoints, s.weights);
  const held = surface.asNurbs();
  const values = s.uv.map(([u, v]) => {
    const d = surface.derivatives(u, v, 2);
    return [d[0][0], d[1][0], d[0][1], d[2][0], d[1][1], d[0][2]];
  });
  return { file: { degreeU: held.degreeU, degreeV: held.degreeV, knotsU: held.knotsU, knotsV: held.knotsV, controlPoints: held.controlPoints }, values };
}

// Evaluates by three, whose parameters are fractions of the domain.
function byThree(s) {
  const points = s.controlPoints.map((row, i) => row.map((p, j) => new Vector4(...p, s.weights[i][j])));
  const surface = new NURBSSurface(s.degreeU, s.degreeV, s.knotsU, s.knotsV, points);
  const part = (knots, degree, t) => (t - knots[degree]) / (knots[knots.length - 1 - degree] - knots[degree]);
  const values = s.uv.map(([u, v]) => {
    const x = new Vector3();
    surface.getPoint(part(s.knotsU, s.degreeU, u), part(s.knotsV, s.degreeV, v), x);
    return [x.toArray()];
  });
  const held = surface.controlPoints.map((row) => row.map((p) => p.toArray()));
  return { file: { degreeU: surface.degree1, degreeV: surface.degree2, knotsU: surface.knots1, knotsV: surface.knots2, controlPoints: held }, values };
}

function byRhino(s) {
  const [rows, columns] = [s.controlPoints.length, s.controlPoints[0].length];
  const surface = rhino.NurbsSurface.create(3, true, s.degreeU + 1, s.degreeV + 1, rows, columns);
  s.knotsU.slice(1, -1).forEach((t, i) => surface.knotsU().set(i, t));
  s.knotsV.slice(1, -1).forEach((t, i) => surface.knotsV().set(i, t));
  s.controlPoints.forEach((row, i) => row.forEach((p, j) => {
    const w = s.weights[i][j];
    surface.points().set(i, j, [...p.map((x) => w * x), w]);
  }));
  const held = s.controlPoints.map((row, i) => row.map((_, j) => surface.points().get(i, j)));
  return {
    file: { degreeU: surface.degree(0), degreeV: surface.degree(1), knotsU: surface.knotsU().toList(), knotsV: surface.knotsV().toList(), controlPoints: held },
    values: s.uv.map(([u, v]) => [surface.pointAt(u, v)]),
  };
}

const { surfaces } = JSON.parse(readFileSync(0, "utf8"));
const answer = surfaces.map((s) => ({ verb: byVerb(s), three: byThree(s), rhino: byRhino(s) }));
process.stdout.write(`\n${JSON.stringify(answer)}\n`);
