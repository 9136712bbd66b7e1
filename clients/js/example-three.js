// Draws a shortest path that follows the mouse. Bundle this file, or map "three" and "geodesicd" in
// an import map.
import * as THREE from "three";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { Client, newest } from "geodesicd";

const mesh = new Client("http://127.0.0.1:8080").mesh("demo");
const geometry = new STLLoader().parse(await mesh.content("stl"));
const surface = new THREE.Mesh(geometry, new THREE.MeshNormalMaterial());
const line = new THREE.Line(undefined, new THREE.LineBasicMaterial({ depthTest: false }));
const scene = new THREE.Scene().add(surface, line);
const camera = new THREE.PerspectiveCamera(40, innerWidth / innerHeight).translateZ(3);
const renderer = new THREE.WebGLRenderer({ canvas: document.querySelector("canvas") });
renderer.setSize(innerWidth, innerHeight);
renderer.setAnimationLoop(() => renderer.render(scene, camera));
const show = (path) => line.geometry.setFromPoints(path.points.map((p) => new THREE.Vector3(...p)));
const follow = newest((point, signal) => mesh.path("v:0", point.toArray(), { signal }), show);
const caster = new THREE.Raycaster();
addEventListener("pointermove", ({ clientX: x, clientY: y }) => {
  caster.setFromCamera({ x: (2 * x) / innerWidth - 1, y: 1 - (2 * y) / innerHeight }, camera);
  const [hit] = caster.intersectObject(surface);
  if (hit) follow(hit.point);
});
