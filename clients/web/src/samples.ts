// Sample surfaces. The page computes them by formulas and uploads them as files.

import type { Kind } from "./surface.ts";

export interface Sample {
  /** The name of the resource. */
  name: string;
  title: string;
  kind: Kind;
  /** The axis that points up. */
  up: "y" | "z";
  file: () => { name: string; text: string };
}

type Place = (u: number, v: number) => [number, number, number];

const digits = (x: number): string => String(Number(x.toFixed(6)));

const vertexLine = (p: number[]): string => `v ${p.map(digits).join(" ")}`;
const faceLine = (corners: number[]): string => `f ${corners.map((i) => i + 1).join(" ")}`;

/**
 * Returns an OBJ file of columns x rows cells over the unit square, each cut into two triangles. If
 * `closed`, joins opposite sides of the square.
 */
function grid(place: Place, columns: number, rows: number, closed: boolean): string {
  const [across, up] = closed ? [columns, rows] : [columns + 1, rows + 1];
  const lines: string[] = [];
  for (let j = 0; j < up; j++)
    for (let i = 0; i < across; i++) lines.push(vertexLine(place(i / columns, j / rows)));
  const at = (i: number, j: number): number => (j % up) * across + (i % across);
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < columns; i++) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      lines.push(
        ...((i + j) % 2
          ? [
              [a, b, c],
              [a, c, d],
            ]
          : [
              [a, b, d],
              [b, c, d],
            ]
        ).map(faceLine),
      );
    }
  }
  return `${lines.join("\n")}\n`;
}

const torus: Place = (u, v) => {
  const [a, b] = [2 * Math.PI * u, 2 * Math.PI * v];
  const radius = 2 + 0.8 * Math.cos(b);
  return [radius * Math.cos(a), radius * Math.sin(a), 0.8 * Math.sin(b)];
};

const HILLS = [
  [0.3, 0.35, 0.18, 1.5],
  [0.68, 0.62, 0.14, 2.1],
  [0.25, 0.78, 0.12, 1.1],
  [0.75, 0.22, 0.16, 0.9],
  [0.5, 0.48, 0.09, -0.9],
] as const;

const terrain: Place = (u, v) => {
  const hills = HILLS.reduce(
    (sum, [x, y, width, height]) =>
      sum + height * Math.exp(-((u - x) ** 2 + (v - y) ** 2) / (2 * width ** 2)),
    0,
  );
  const ripples =
    0.16 * Math.sin(19 * u + 5 * v) * Math.cos(17 * v - 3 * u) +
    0.05 * Math.sin(47 * u) * Math.sin(43 * v);
  return [10 * (u - 0.5), 10 * (v - 0.5), hills + ripples];
};

/** Returns an icosahedron subdivided n times, with its vertices on the unit sphere. */
function icosphere(times: number): string {
  const g = (1 + Math.sqrt(5)) / 2;
  const vertices = [
    [-1, g, 0],
    [1, g, 0],
    [-1, -g, 0],
    [1, -g, 0],
    [0, -1, g],
    [0, 1, g],
    [0, -1, -g],
    [0, 1, -g],
    [g, 0, -1],
    [g, 0, 1],
    [-g, 0, -1],
    [-g, 0, 1],
  ];
  let faces = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
  ];
  for (let i = 0; i < times; i++) faces = cut(vertices, faces);
  const onSphere = vertices.map((p) => p.map((x) => x / Math.hypot(...p)));
  return `${[...onSphere.map(vertexLine), ...faces.map(faceLine)].join("\n")}\n`;
}

/** Splits each triangle into four. Appends the midpoints of the edges to the vertices. */
function cut(vertices: number[][], faces: number[][]): number[][] {
  const middles = new Map<string, number>();
  const middle = (a: number, b: number): number => {
    const edge = a < b ? `${a}-${b}` : `${b}-${a}`;
    if (!middles.has(edge)) {
      const between = vertices[a]!.map((x, axis) => x + vertices[b]![axis]!);
      const size = Math.hypot(...between);
      middles.set(edge, vertices.push(between.map((x) => x / size)) - 1);
    }
    return middles.get(edge)!;
  };
  return faces.flatMap((face) => {
    const [a, b, c] = face as [number, number, number];
    const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    return [
      [a, ab, ca],
      [b, bc, ab],
      [c, ca, bc],
      [ab, bc, ca],
    ];
  });
}

/** Returns the boundary of a union of unit cells as quads that share vertices. */
function blocks(cells: [number, number, number][]): string {
  const isFull = new Set(cells.map(String));
  const corners = new Map<string, number>();
  const [vertices, faces]: [string[], string[]] = [[], []];
  const corner = (p: number[]): number => {
    if (!corners.has(String(p))) corners.set(String(p), vertices.push(vertexLine(p)) - 1);
    return corners.get(String(p))!;
  };
  for (const cell of cells) {
    for (const [axis, side] of [
      [0, 0],
      [0, 1],
      [1, 0],
      [1, 1],
      [2, 0],
      [2, 1],
    ] as const) {
      const neighbour = cell.map((x, i) => (i === axis ? x + 2 * side - 1 : x));
      if (isFull.has(String(neighbour))) continue;
      const [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
      const turn = [
        [0, 0],
        [1, 0],
        [1, 1],
        [0, 1],
      ].map(([s, t]) =>
        cell.map((x, i) => x + (i === axis ? side : i === b ? s! : i === c ? t! : 0)),
      );
      faces.push(faceLine((side ? turn : turn.reverse()).map(corner)));
    }
  }
  return `${[...vertices, ...faces].join("\n")}\n`;
}

/** The cells of a control mesh with a handle: eight cells in a ring, one on top. */
const RING: [number, number, number][] = [
  [0, 0, 0],
  [1, 0, 0],
  [2, 0, 0],
  [2, 1, 0],
  [2, 2, 0],
  [1, 2, 0],
  [0, 2, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/** Returns a cubic NURBS patch of 6 x 6 control points, with a dent and a hill. */
function patch(): string {
  const knots = [0, 0, 0, 0, 1, 2, 3, 3, 3, 3];
  const heights = [
    [0, 0.3, 0.2, 0, -0.2, 0],
    [0.2, 1.2, 1.4, -0.4, -0.8, 0.1],
    [0.1, 1.6, 2.6, 0.2, -1.2, 0.3],
    [-0.2, 0.3, 0.6, -0.9, 0.4, 0.4],
    [0, -0.6, -1.2, 0.3, 1.6, 0.2],
    [0.1, 0, -0.2, 0.2, 0.4, 0],
  ];
  const controlPoints = heights.map((row, i) => row.map((z, j) => [i, j, z]));
  return JSON.stringify({ degreeU: 3, degreeV: 3, knotsU: knots, knotsV: knots, controlPoints });
}

const vase = JSON.stringify({
  parametric: {
    revolution: {
      degree: 3,
      knots: [0, 0, 0, 0, 1, 2, 3, 3, 3, 3],
      control_points: [
        [1, 0],
        [2.1, 0.6],
        [1.9, 2],
        [0.5, 2.9],
        [0.7, 3.7],
        [1.2, 4.2],
      ],
    },
  },
});

const obj = (name: string, text: () => string) => (): { name: string; text: string } => ({
  name: `${name}.obj`,
  text: text(),
});

export const SAMPLES: Sample[] = [
  {
    name: "torus",
    title: "Torus",
    kind: "meshes",
    up: "z",
    file: obj("torus", () => grid(torus, 120, 60, true)),
  },
  {
    name: "terrain",
    title: "Terrain",
    kind: "meshes",
    up: "z",
    file: obj("terrain", () => grid(terrain, 160, 160, false)),
  },
  {
    name: "icosphere",
    title: "Icosphere",
    kind: "meshes",
    up: "y",
    file: obj("icosphere", () => icosphere(4)),
  },
  {
    name: "cage",
    title: "Control cage",
    kind: "subdivisions",
    up: "z",
    file: obj("cage", () => blocks(RING)),
  },
  {
    name: "cube",
    title: "Cube cage",
    kind: "subdivisions",
    up: "y",
    file: obj("cube", () => blocks([[0, 0, 0]])),
  },
  {
    name: "patch",
    title: "NURBS patch",
    kind: "nurbs",
    up: "z",
    file: () => ({ name: "patch.json", text: patch() }),
  },
  {
    name: "vase",
    title: "Vase (revolution)",
    kind: "nurbs",
    up: "z",
    file: () => ({ name: "vase.json", text: vase }),
  },
];
