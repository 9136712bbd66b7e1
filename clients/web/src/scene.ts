// The picture: camera, light, the surface's skin and the lines on it. A frame is drawn when something has changed,
// never else.

import {
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  LinearSRGBColorSpace,
  PerspectiveCamera,
  Scene as ThreeScene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Backdrop } from "./backdrop.ts";
import { Lines } from "./lines.ts";
import { Skin } from "./skin.ts";
import type { Surface } from "./surface.ts";
import type { Place } from "./place.ts";
import { scale, subtract, unit, type Vec3 } from "./vector.ts";

export interface Pixel {
  x: number;
  y: number;
}

const FIELD_OF_VIEW = 35; /* degrees, upright */
const MARGIN = 1.12; /* of the surface's sphere */

/** Where the processor draws, smooth edges would cost more than half of the frames. */
function hasGraphicsCard(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const info = context?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(context!.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software/i.test(name);
}

export class Scene {
  readonly lines = new Lines();
  /** Lines that are many and stay: they are drawn with the surface, once. */
  readonly fixedLines = new Lines();
  /** What moves on the surface. */
  readonly props = new Group();
  /** What a mode shows beside the surface, or instead of it. */
  readonly solids = new Group();
  /** Called after each frame. */
  onFrame: () => void = () => {};
  /** Called when the user has moved the camera. */
  onCamera: () => void = () => {};
  skin: Skin | undefined;
  private surface: Surface | undefined;
  private readonly renderer: WebGLRenderer;
  /** The surface and its light; what lies on it, which is drawn over it. */
  private readonly ground = new ThreeScene();
  private readonly above = new ThreeScene();
  private readonly sky = new HemisphereLight(0xffffff, 0x98a0a8, 1.5);
  private readonly backdrop: Backdrop;
  private readonly camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  private controls: OrbitControls;
  private wanted = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    const isFast = hasGraphicsCard();
    this.renderer = new WebGLRenderer({ canvas, antialias: isFast });
    this.renderer.autoClear = false;
    this.renderer.setPixelRatio(isFast ? Math.min(devicePixelRatio, 2) : 1);
    this.backdrop = new Backdrop(isFast ? 4 : 0);
    const lamp = new DirectionalLight(0xffffff, 2.2);
    lamp.position.set(-0.6, 0.8, 1);
    this.camera.add(lamp);
    this.ground.add(this.camera, this.sky, this.solids, this.fixedLines.group);
    this.above.add(new HemisphereLight(0xffffff, 0x606870, 2), lamp.clone(), this.props, this.lines.group);
    this.controls = this.makeControls("y");
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  private makeControls(up: string): OrbitControls {
    this.camera.up.set(0, up === "y" ? 1 : 0, up === "y" ? 0 : 1);
    this.sky.position.copy(this.camera.up);
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.minDistance = 0.02;
    controls.maxDistance = 30;
    controls.addEventListener("change", () => this.redraw());
    controls.addEventListener("end", () => this.onCamera());
    return controls;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.redraw();
  }

  /** The colour behind the surface. */
  setGround(colour: string): void {
    this.ground.background = new Color().setStyle(
      colour,
      LinearSRGBColorSpace,
    ); /* as it is: the backdrop stores what screens take */
    this.redraw();
  }

  /** Asks for a frame in which the surface itself looks different. */
  redraw(): void {
    this.backdrop.spoil();
    this.draw();
  }

  /** Asks for a frame: something on the surface has changed. */
  draw(): void {
    if (this.wanted) return;
    this.wanted = true;
    requestAnimationFrame(() => {
      this.wanted = false;
      this.clip();
      this.backdrop.draw(this.renderer, this.ground, this.camera);
      this.renderer.render(this.above, this.camera);
      this.onFrame();
    });
  }

  /** Depth is used up between the near and the far side of the surface, wherever the camera is. */
  private clip(): void {
    const distance = this.camera.position.length();
    this.camera.near = Math.max(0.002, (distance - 1.5) * 0.8);
    this.camera.far = distance + 3;
    this.camera.updateProjectionMatrix();
  }

  show(surface: Surface | undefined): void {
    if (this.skin) this.ground.remove(this.skin.mesh);
    this.skin?.dispose();
    this.lines.clear();
    this.fixedLines.clear();
    this.props.clear();
    this.solids.clear();
    this.surface = surface;
    this.skin = surface && new Skin(surface.positions, surface.triangles.faces, surface.fine);
    if (this.skin) this.ground.add(this.skin.mesh);
    this.redraw();
  }

  showEdges(show: boolean): void {
    this.skin?.showEdges(show);
    this.redraw();
  }

  /** The surface from a little above, as large as it fits. */
  fit(): void {
    const angle = ((FIELD_OF_VIEW / 2) * Math.PI) / 180;
    const narrow = Math.atan(Math.tan(angle) * Math.min(1, this.camera.aspect));
    const distance = MARGIN / Math.sin(narrow);
    const up = this.up === "y";
    const from: Vec3 = unit(up ? [0.5, 0.42, 1] : [0.5, -1, 0.42]);
    this.camera.position.set(...scale(from, distance));
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.redraw();
  }

  get up(): string {
    return this.camera.up.y === 1 ? "y" : "z";
  }

  set up(axis: string) {
    if (axis === this.up) return;
    this.controls.dispose();
    this.controls = this.makeControls(axis);
  }

  /** Turns about the middle, in radians. */
  turn(right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    const polar = offset.angleTo(this.camera.up);
    offset.applyAxisAngle(side, Math.max(0.02 - polar, Math.min(Math.PI - 0.02 - polar, -up)));
    offset.applyAxisAngle(this.camera.up, right);
    this.camera.position.copy(this.controls.target).add(offset);
    this.moved();
  }

  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target).divideScalar(factor);
    this.camera.position.copy(this.controls.target).add(offset);
    this.moved();
  }

  private moved(): void {
    this.controls.update();
    this.redraw();
    this.onCamera();
  }

  /** Position and target of the camera, in the frame. */
  get view(): string {
    const numbers = [...this.camera.position.toArray(), ...this.controls.target.toArray()];
    return numbers.map((x) => Number(x.toFixed(4))).join(",");
  }

  set view(text: string) {
    const [x, y, z, a, b, c] = text.split(",").map(Number);
    const numbers = [x, y, z, a, b, c];
    if (!numbers.every((n) => n !== undefined && Number.isFinite(n))) return;
    this.camera.position.set(x!, y!, z!);
    this.controls.target.set(a!, b!, c!);
    this.controls.update();
    this.redraw();
  }

  get size(): Pixel {
    return { x: this.canvas.clientWidth, y: this.canvas.clientHeight };
  }

  /** The pixel of the canvas where a point of space (in the file's unit) is seen. */
  project(xyz: Vec3): Pixel {
    this.camera.updateMatrixWorld();
    const p = new Vector3(...(this.surface?.frame.toView(xyz) ?? xyz)).project(this.camera);
    return { x: ((p.x + 1) / 2) * this.size.x, y: ((1 - p.y) / 2) * this.size.y };
  }

  /** Where the middle of the surface's box is seen. */
  get middle(): Pixel {
    return this.project(this.surface?.frame.centre ?? [0, 0, 0]);
  }

  /** The ray through a pixel, in the frame. */
  private ray(pixel: Pixel): { origin: Vec3; direction: Vec3 } {
    this.camera.updateMatrixWorld();
    const far = new Vector3((2 * pixel.x) / this.size.x - 1, 1 - (2 * pixel.y) / this.size.y, 0.5).unproject(
      this.camera,
    );
    const origin = this.camera.position.toArray() as Vec3;
    return { origin, direction: unit(subtract(far.toArray() as Vec3, origin)) };
  }

  /** The place of the surface that is seen at a pixel. */
  pick(pixel: Pixel): Place | null {
    const { origin, direction } = this.ray(pixel);
    return this.surface?.cast(origin, direction) ?? null;
  }

  /** Whether the surface hides a point of it. */
  hides(xyz: Vec3): boolean {
    if (!this.surface) return false;
    const origin = this.camera.position.toArray() as Vec3;
    const to = subtract(this.surface.frame.toView(xyz), origin);
    const hit = this.surface.bvh.cast(origin, to);
    return hit !== null && hit.distance < 1 - 2e-3;
  }

  toView(points: Vec3[]): Vec3[] {
    const frame = this.surface?.frame;
    return frame ? points.map((p) => frame.toView(p)) : [];
  }
}
