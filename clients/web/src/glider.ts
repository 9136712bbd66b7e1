// An object that moves along a curve. It points along the tangent and stands on the surface.

import {
  ConeGeometry,
  Group,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  BoxGeometry,
  Vector3,
} from "three";
import { encode } from "./passes.ts";
import type { Scene } from "./scene.ts";
import type { Vec3 } from "./vector.ts";

export interface Frame {
  xyz: Vec3;
  tangent: Vec3;
  normal: Vec3;
  binormal: Vec3;
}

const SIZE = 0.075; /* size in normalised coordinates (Frame in prepare.ts) */
const ROUND = 8; /* duration of a move along the whole curve, in seconds */

function paint(color: string): MeshLambertMaterial {
  const material = new MeshLambertMaterial({ color });
  material.onBeforeCompile = encode;
  return material;
}

function shape(): Group {
  const body = new Mesh(
    new ConeGeometry(SIZE * 0.3, SIZE * 2, 20).rotateZ(-Math.PI / 2),
    paint("#c98a00"),
  );
  const fin = new Mesh(
    new BoxGeometry(SIZE * 0.6, SIZE * 0.08, SIZE * 0.9).translate(-SIZE * 0.5, 0, SIZE * 0.4),
    paint("#7a1fa2"),
  );
  const wings = new Mesh(
    new BoxGeometry(SIZE * 0.5, SIZE * 1.8, SIZE * 0.08).translate(-SIZE * 0.3, 0, 0),
    paint("#7a1fa2"),
  );
  return new Group().add(body, fin, wings);
}

export class Glider {
  private readonly object = shape();
  private frames: Frame[] = [];
  private isRunning = false;
  private part = 0;
  private before = 0;

  constructor(private readonly scene: Scene) {
    this.object.matrixAutoUpdate = false;
  }

  /** Moves along frames at equal times. On a new curve, continues at the same fraction. */
  follow(frames: Frame[]): void {
    this.frames = frames;
    this.scene.props.add(this.object);
    if (this.isRunning) return;
    this.isRunning = true;
    this.before = performance.now();
    requestAnimationFrame((now) => this.step(now));
  }

  stop(): void {
    this.isRunning = false;
    this.object.removeFromParent();
    this.scene.draw();
  }

  private step(now: number): void {
    if (!this.isRunning) return;
    this.part = (this.part + (now - this.before) / 1000 / ROUND) % 1;
    this.before = now;
    this.place();
    this.scene.draw();
    requestAnimationFrame((next) => this.step(next));
  }

  private place(): void {
    const at = this.part * (this.frames.length - 1);
    const [a, b] = [this.frames[Math.floor(at)], this.frames[Math.ceil(at)]];
    if (!a || !b) return;
    const t = at - Math.floor(at);
    const between = (x: Vec3, y: Vec3): Vector3 => new Vector3(...x).lerp(new Vector3(...y), t);
    const tangent = between(a.tangent, b.tangent).normalize();
    const normal = between(a.normal, b.normal).normalize();
    const side = new Vector3().crossVectors(normal, tangent).normalize();
    const [from, to] = this.scene.toView([a.xyz, b.xyz]) as [Vec3, Vec3];
    const position = between(from, to).addScaledVector(normal, SIZE * 0.55);
    this.object.matrix = new Matrix4().makeBasis(tangent, side, normal).setPosition(position);
  }
}
