// The picture: camera, surface, shadow and lines. The page draws a frame only after a change. After
// a rest it draws the fine frame, which has smooth edges and ambient occlusion.

import {
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  LinearSRGBColorSpace,
  MathUtils,
  PerspectiveCamera,
  Plane,
  Scene as ThreeScene,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { FullScreenQuad } from "three/examples/jsm/postprocessing/Pass.js";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Backdrop } from "./backdrop.ts";
import { shaded } from "./creases.ts";
import { FaceMap } from "./facemap.ts";
import { Lines } from "./lines.ts";
import { Screen } from "./passes.ts";
import { Shadow } from "./shadow.ts";
import { Skin } from "./skin.ts";
import type { Surface } from "./surface.ts";
import type { Place } from "./place.ts";
import { scale, subtract, unit, type Vec3 } from "./vector.ts";

export interface Pixel {
  x: number;
  y: number;
}

/* radians; the angle that the camera sees along the shorter side of the picture */
const FIELD_OF_VIEW = (35 * Math.PI) / 180;
const MARGIN = 1.12; /* the camera shows the surface's bounding sphere enlarged by this factor */
const REST = 500; /* milliseconds without a frame before the fine frame */
/* number of drawn pixels for each pixel of the screen, in each direction, during a drag */
const MOVING_RATIO = 0.5;

/** Returns whether WebGL uses a graphics card. Without one, smooth edges halve the frame rate. */
function hasGraphicsCard(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const info = context?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(context!.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software/i.test(name);
}

export class Scene {
  readonly lines = new Lines();
  /**
   * Lines that have many points and change rarely. They are part of the saved drawing of the
   * surface.
   */
  readonly fixedLines = new Lines();
  /** Paths that the user keeps. */
  readonly keptLines = new Lines();
  /** Objects that move on the surface. */
  readonly props = new Group();
  /** Solids that a mode shows beside the surface or instead of it. */
  readonly solids = new Group();
  /** Called after each frame. */
  onFrame: () => void = () => {};
  /** Whether the page waits for an answer that changes the picture. */
  isWaiting: () => boolean = () => false;
  /** Called when the browser has lost WebGL, and when it has restored it. */
  onLoss: (isLost: boolean) => void = () => {};
  /** Called when the user has moved the camera. */
  onCamera: () => void = () => {};
  skin: Skin | undefined;
  /** The size of the picture, in CSS pixels. */
  size: Pixel = { x: 1, y: 1 };
  private surface: Surface | undefined;
  private readonly renderer: WebGLRenderer;
  /** `ground` has the surface; `above` has lines and objects that are drawn over it. */
  private readonly ground = new ThreeScene();
  private readonly above = new ThreeScene();
  private readonly backdrop = new Backdrop();
  private readonly screen = new Screen();
  private readonly shadow = new Shadow();
  private readonly isFast = hasGraphicsCard();
  private readonly ratio = this.isFast ? Math.min(devicePixelRatio, 2) : 1;
  private faceMap: FaceMap | undefined;
  /** Whether values have changed since the surface was drawn. */
  private hasNewValues = false;
  private rest = 0;
  /** Whether the user drags. Fine frames then wait, because they would delay the next answer. */
  private isHeld = false;
  /**
   * A surface to compare with. `part` is the fraction of the picture that shows the first surface.
   */
  private other: Skin | undefined;
  private part = 0.5;
  private readonly leftSide = new Plane();
  private readonly rightSide = new Plane();
  private hasShadow = true;
  private isShadowCast = false;
  private readonly camera = new PerspectiveCamera(undefined, 1, 0.01, 100);
  private controls: OrbitControls;
  private wanted = false;
  /** Whether the page has shown a surface. Before that it draws no frame, to start faster. */
  private hasShown = false;

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: this.isFast, stencil: true });
    this.renderer.autoClear = false;
    this.renderer.debug.checkShaderErrors = false; /* the check would block the page */
    this.renderer.setPixelRatio(this.ratio);
    const lamp = new DirectionalLight(0xffffff, 2.2);
    lamp.position.set(-0.6, 0.8, 1);
    this.ground.add(this.camera, this.solids, this.shadow.mesh, this.fixedLines.group);
    this.above.add(new HemisphereLight(0xffffff, 0x606870, 2), lamp, this.props);
    this.above.add(this.keptLines.group, this.lines.group);
    this.controls = this.makeControls("y");
    canvas.addEventListener("webglcontextlost", () => this.onLoss(true));
    canvas.addEventListener("webglcontextrestored", () => {
      this.onLoss(false);
      this.isShadowCast = false;
      this.redraw();
    });
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
  }

  /**
   * Compiles the shader programs while the user chooses a file. Otherwise, without a graphics card,
   * the compilation would block the page in the first frame.
   */
  warmUp(): void {
    const { renderer, lines } = this;
    const [positions, faces] = [Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), Uint32Array.of(0, 1, 2)];
    const skin = new Skin({ positions, faces }, shaded(positions, faces));
    const target = new WebGLRenderTarget(1, 1, { stencilBuffer: true });
    this.ground.add(skin.mesh);
    lines.set("first", [[[0, 0, 0], [1, 0, 0]]], { colour: "white", width: 1 });
    this.shadow.cast(renderer, skin.mesh, "y", 0);
    renderer.setRenderTarget(target);
    this.backdrop.draw(renderer, this.ground, this.camera, { wantsFine: false });
    renderer.render(this.above, this.camera);
    renderer.setRenderTarget(null);
    target.dispose();
    lines.clear();
    this.shadow.mesh.visible = false;
    /* the skin is not disposed, because three.js would drop the programs */
    this.ground.remove(skin.mesh);
    this.backdrop.invalidate();
  }

  private makeControls(up: string): OrbitControls {
    this.camera.up.set(0, up === "y" ? 1 : 0, up === "y" ? 0 : 1);
    this.isShadowCast = false;
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.minDistance = 0.02;
    controls.maxDistance = 30;
    controls.zoomToCursor = true;
    controls.addEventListener("change", () => this.redraw());
    controls.addEventListener("start", () => this.hold(true));
    controls.addEventListener("end", () => {
      this.hold(false);
      this.onCamera();
    });
    return controls;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (width === 0 || height === 0) return;
    this.size = { x: width, y: height };
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = MathUtils.radToDeg(2 * Math.atan(this.tangent));
    this.camera.updateProjectionMatrix();
    this.redraw();
  }

  /** The tangent of half the vertical angle that the camera sees. */
  private get tangent(): number {
    return Math.tan(FIELD_OF_VIEW / 2) / Math.min(1, this.camera.aspect);
  }

  /** Sets the colour behind the surface. */
  setGround(colour: string): void {
    this.ground.background = new Color().setStyle(
      colour,
      LinearSRGBColorSpace,
    ); /* the colour is not converted to linear, because the backdrop stores sRGB colours */
    this.redraw();
  }

  /** Requests a frame that draws the surface again. */
  redraw(): void {
    this.backdrop.invalidate();
    this.faceMap?.invalidate();
    this.hasNewValues = false;
    this.draw();
  }

  /** Requests a frame after a change that concerns only the values of the surface. */
  recolour(): void {
    const isCheap = this.isHeld && !this.isFast && !this.other && this.skin?.showsValuesAlone;
    if (!isCheap) return this.redraw();
    this.hasNewValues = true;
    this.draw();
  }

  /** Begins or ends a drag. Without a graphics card, frames of a drag have fewer pixels. */
  hold(isHeld: boolean): void {
    if (isHeld === this.isHeld) return;
    this.isHeld = isHeld;
    clearTimeout(this.rest);
    if (isHeld) return;
    if (this.hasNewValues) this.redraw();
    else this.draw();
  }

  /** Requests a frame after a change that concerns only lines or objects on the surface. */
  draw(): void {
    clearTimeout(this.rest);
    if (this.wanted || !this.hasShown) return;
    this.wanted = true;
    requestAnimationFrame(() => {
      this.wanted = false;
      if (!this.isFast) this.scale(this.isHeld ? MOVING_RATIO : this.ratio);
      this.drawNow(this.isFast);
      this.onFrame();
      this.awaitRest();
    });
  }

  /** Draws the fine frame after REST, once no answer is pending that would change the picture. */
  private awaitRest(): void {
    if (this.isFast || this.isHeld || !this.skin) return;
    this.rest = setTimeout(() => {
      if (this.isWaiting()) this.awaitRest();
      else this.drawNow(true);
    }, REST);
  }

  /** Sets the number of drawn pixels for each pixel of the screen, in each direction. */
  private scale(ratio: number): void {
    if (this.renderer.getPixelRatio() === ratio) return;
    this.renderer.setPixelRatio(ratio);
    if (!this.backdrop.isFine) this.backdrop.invalidate();
  }

  /** Draws a frame. Composes a fine frame off the screen, where lines get smooth edges, too. */
  private drawNow(isFine: boolean): void {
    const { renderer } = this;
    this.fitDepth();
    if (this.other) this.placeSplit();
    if (this.hasShadow && this.skin && !this.isShadowCast) this.castShadow();
    const pass = this.hasNewValues ? this.recoloured() : undefined;
    renderer.setRenderTarget(isFine && !this.isFast ? this.screen.target(renderer) : null);
    renderer.clear(false, false, true);
    this.backdrop.draw(renderer, this.ground, this.camera, { wantsFine: isFine, pass });
    renderer.render(this.above, this.camera);
    if (isFine && !this.isFast) this.screen.show(renderer);
  }

  private recoloured(): FullScreenQuad {
    this.faceMap ??= new FaceMap(this.skin!, this.backdrop.saved);
    return this.faceMap.prepare(this.renderer, this.camera);
  }

  private castShadow(): void {
    this.isShadowCast = true;
    this.shadow.cast(this.renderer, this.skin!.mesh, this.up as "y" | "z", this.lowest());
    this.backdrop.invalidate();
  }

  /** Returns the least coordinate along the upward axis, in normalised coordinates. */
  private lowest(): number {
    const { positions, triangles } = this.surface!;
    const axis = this.up === "y" ? 1 : 2;
    let low = 0;
    for (const vertex of triangles.faces) low = Math.min(low, positions[3 * vertex + axis]!);
    return low;
  }

  /**
   * Shows another surface on the right side of the picture, in the normalised coordinates of the
   * first surface. undefined removes it.
   */
  compare(other: Surface | undefined): void {
    this.other?.mesh.removeFromParent();
    this.other?.dispose();
    const { surface, skin } = this;
    this.other = other && surface ? this.otherSkin(other, surface) : undefined;
    this.renderer.localClippingEnabled = this.other !== undefined;
    if (skin) skin.clippingPlanes = this.other ? [this.leftSide] : null;
    this.redraw();
  }

  private otherSkin(other: Surface, surface: Surface): Skin {
    const positions = surface.view(other.triangles.positions);
    const { faces } = other.triangles;
    const skin = new Skin({ positions, faces }, shaded(positions, faces));
    skin.mesh.material.color = this.skin!.mesh.material.color;
    skin.clippingPlanes = [this.rightSide];
    this.ground.add(skin.mesh);
    return skin;
  }

  /** Sets the fraction of the picture's width that shows the first surface. */
  split(part: number): void {
    this.part = part;
    this.redraw();
  }

  /** Computes the clipping planes, which the camera sees as the vertical line at `part`. */
  private placeSplit(): void {
    this.camera.updateMatrixWorld();
    const on = (y: number): Vector3 =>
      new Vector3(2 * this.part - 1, y, 0.5).unproject(this.camera);
    this.leftSide.setFromCoplanarPoints(this.camera.position, on(1), on(-1));
    const left = new Vector3(-2, 0, 0.5).unproject(this.camera);
    if (this.leftSide.distanceToPoint(left) < 0) this.leftSide.negate();
    this.rightSide.copy(this.leftSide).negate();
  }

  /**
   * Returns the picture as a PNG file, `factor` times as large as on the screen in each direction.
   */
  async snapshot(factor: number): Promise<Blob> {
    const { renderer, canvas } = this;
    clearTimeout(this.rest);
    renderer.setPixelRatio(factor * this.ratio);
    this.backdrop.invalidate();
    this.drawNow(true);
    const file = new Promise<Blob>((resolve) =>
      canvas.toBlob((blob) => resolve(blob!), "image/png"),
    );
    renderer.setPixelRatio(this.ratio);
    this.redraw();
    return file;
  }

  /** Fits the near and far planes to the surface, for a precise depth buffer. */
  private fitDepth(): void {
    const distance = this.camera.position.length();
    this.camera.near = Math.max(0.002, (distance - 1.5) * 0.8);
    this.camera.far = distance + 3;
    this.camera.updateProjectionMatrix();
  }

  show(surface: Surface | undefined): void {
    this.hasShown ||= surface !== undefined;
    this.compare(undefined);
    if (this.skin) this.ground.remove(this.skin.mesh);
    this.skin?.dispose();
    this.faceMap?.dispose();
    this.faceMap = undefined;
    this.lines.clear();
    this.fixedLines.clear();
    this.keptLines.clear();
    this.props.clear();
    this.solids.clear();
    this.surface = surface;
    this.isShadowCast = false;
    this.shadow.mesh.visible = false;
    for (const lines of [this.lines, this.fixedLines, this.keptLines])
      lines.isOverPreview = surface?.isPreview ?? false;
    const own = surface && { positions: surface.positions, faces: surface.triangles.faces };
    this.skin = own && new Skin(own, surface.shaded, surface.fine);
    if (this.skin) this.ground.add(this.skin.mesh);
    this.redraw();
  }

  showEdges(show: boolean): void {
    this.skin?.showEdges(show);
    this.redraw();
  }

  showShadow(show: boolean): void {
    this.hasShadow = show;
    if (!show) this.isShadowCast = this.shadow.mesh.visible = false;
    this.redraw();
  }

  /** Moves the camera so that the surface fills the picture, seen from slightly above. */
  fit(): void {
    const distance = MARGIN / Math.sin(FIELD_OF_VIEW / 2);
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

  /** Turns the camera about its target, by radians. */
  turn(right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    const polar = offset.angleTo(this.camera.up);
    offset.applyAxisAngle(side, Math.max(0.02 - polar, Math.min(Math.PI - 0.02 - polar, -up)));
    offset.applyAxisAngle(this.camera.up, right);
    this.camera.position.copy(this.controls.target).add(offset);
    this.moved();
  }

  /** Shifts the picture, by fractions of its height. */
  shift(right: number, up: number): void {
    this.camera.updateMatrixWorld();
    const [side, upwards, back] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(side, upwards, back);
    const distance = this.camera.position.distanceTo(this.controls.target);
    const height = 2 * distance * this.tangent;
    const step = side.multiplyScalar(-right * height).addScaledVector(upwards, -up * height);
    this.camera.position.add(step);
    this.controls.target.add(step);
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

  /** Position and target of the camera, in normalised coordinates. */
  get view(): string {
    const numbers = [...this.camera.position.toArray(), ...this.controls.target.toArray()];
    return numbers.map((x) => Number(x.toFixed(4))).join(",");
  }

  /** Sets the camera from the text of an address. Invalid text leaves the camera unchanged. */
  set view(text: string) {
    const [x, y, z, a, b, c] = text.split(",").map(Number);
    const numbers = [x, y, z, a, b, c];
    if (!numbers.every((n) => n !== undefined && Number.isFinite(n))) return;
    this.camera.position.set(x!, y!, z!);
    this.controls.target.set(a!, b!, c!);
    this.controls.update();
    this.redraw();
  }

  /** Returns the pixel of the canvas that shows a point in space (in the file's unit). */
  project(xyz: Vec3): Pixel {
    this.camera.updateMatrixWorld();
    const p = new Vector3(...(this.surface?.viewOf(xyz) ?? xyz)).project(this.camera);
    return { x: ((p.x + 1) / 2) * this.size.x, y: ((1 - p.y) / 2) * this.size.y };
  }

  /** The pixel that shows the middle of the surface's box. */
  get middle(): Pixel {
    return this.project(this.surface?.frame.centre ?? [0, 0, 0]);
  }

  /** Returns the ray through a pixel, in normalised coordinates. */
  private ray(pixel: Pixel): { origin: Vec3; direction: Vec3 } {
    this.camera.updateMatrixWorld();
    const far = new Vector3(
      (2 * pixel.x) / this.size.x - 1,
      1 - (2 * pixel.y) / this.size.y,
      0.5,
    ).unproject(this.camera);
    const origin = this.camera.position.toArray() as Vec3;
    return { origin, direction: unit(subtract(far.toArray() as Vec3, origin)) };
  }

  /** Returns the place of the surface that a pixel shows, or null if the pixel shows no surface. */
  pick(pixel: Pixel): Place | null {
    const { origin, direction } = this.ray(pixel);
    return this.surface?.cast(origin, direction) ?? null;
  }

  /** Returns whether the surface hides one of its points. */
  hides(xyz: Vec3): boolean {
    if (!this.surface) return false;
    const origin = this.camera.position.toArray() as Vec3;
    const to = subtract(this.surface.viewOf(xyz), origin);
    const hit = this.surface.bvh.cast(origin, to);
    return hit !== null && hit.distance < 1 - 2e-3;
  }

  toView(points: Vec3[]): Vec3[] {
    const { surface } = this;
    return surface ? points.map((p) => surface.viewOf(p)) : [];
  }
}
