// Clicks and keys on the picture: a click sets a point, a drag turns the camera.

import type { Pixel, Scene } from "./scene.ts";

const SLACK = 5; /* pixels by which the pointer may move during a click */
const TURN = Math.PI / 36; /* radians by which an arrow key turns the camera */
/* fraction of the picture's height by which Shift and an arrow key shift the picture */
const SHIFT = 0.05;

export class Touch {
  private down: Pixel | null = null;

  constructor(
    private readonly scene: Scene,
    private readonly onClick: (pixel: Pixel, hasShift: boolean) => void,
  ) {
    const { canvas } = scene;
    canvas.addEventListener(
      "pointerdown",
      (event) => (this.down = event.isPrimary && event.button === 0 ? pixelOf(event) : null),
    );
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  private up(event: PointerEvent): void {
    const at = pixelOf(event);
    if (this.down && event.isPrimary && Math.hypot(at.x - this.down.x, at.y - this.down.y) <= SLACK)
      this.onClick(at, event.shiftKey);
    this.down = null;
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { scene } = this;
    const move = (right: number, up: number): void =>
      event.shiftKey ? scene.shift(SHIFT * right, SHIFT * up) : scene.turn(TURN * right, TURN * up);
    const actions: Record<string, () => void> = {
      ArrowLeft: () => move(-1, 0),
      ArrowRight: () => move(1, 0),
      ArrowUp: () => move(0, 1),
      ArrowDown: () => move(0, -1),
      "+": () => scene.zoom(1.15),
      "=": () => scene.zoom(1.15),
      "-": () => scene.zoom(1 / 1.15),
    };
    const action = actions[event.key];
    if (!action) return;
    action();
    event.preventDefault();
  }
}

const pixelOf = (event: PointerEvent): Pixel => ({ x: event.offsetX, y: event.offsetY });
