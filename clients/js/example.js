// Uploads a mesh and computes a shortest path: node example.js MESH.obj
import { readFile } from "node:fs/promises";
import { Client } from "geodesicd";

const client = new Client(process.env.GEODESICD_URL);
const mesh = await client.upload("example", await readFile(process.argv[2]));
const path = await mesh.path(0, [0.5, 0.5, 0.5]);
console.log(`${Number(path.length.toPrecision(12))} over ${path.points.length} points`);
