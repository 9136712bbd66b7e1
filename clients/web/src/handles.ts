// Shows points as buttons over the picture. Mouse, pen and finger drag them; arrow keys move them.

import { make } from "./dom.ts";
import type { Place } from "./place.ts";
import type { Mark, Points } from "./points.ts";
import type { Pixel, Scene } from "./scene.ts";

const STEP = 4; /* pixels by which an arrow key moves a point */
const LARGE_STEP = 24; /* the same with Shift */
const STRIDES = 32; /* steps of the search for the outline */
const ARROWS: Record<string, Pixel> = {
  ArrowLeft: { x: -1, y: 0 },
  ArrowRight: { x: 1, y: 0 },
  ArrowUp: { x: 0, y: -1 },
  ArrowDown: { x: 0, y: 1 },
};

export class Handles {
  private marks: Mark[] = [];
  private readonly buttons: HTMLButtonElement[] = [];
  /** The dragged points, by the id of the finger or mouse that drags. */
  private readonly drags = new Map<number, { mark: Mark; offset: Pixel }>();

  constructor(
    private readonly layer: HTMLElement,
    private readonly scene: Scene,
    private readonly points: Points,
  ) {
    layer.addEventListener("wheel", (event) => this.passWheel(event), { passive: false });
  }

  /** Forwards wheel events to the canvas, so that the wheel zooms over a handle, too. */
  private passWheel(event: WheelEvent): void {
    event.preventDefault();
    this.scene.canvas.dispatchEvent(new WheelEvent(event.type, event));
  }

  /** Makes a button for each point. Buttons are reused, so that the focus stays. */
  update(): void {
    this.marks = this.points.all;
    const hadFocus = this.layer.contains(document.activeElement);
    while (this.buttons.length > this.marks.length) this.buttons.pop()!.remove();
    if (hadFocus && !this.layer.contains(document.activeElement))
      (this.buttons.at(-1) ?? this.scene.canvas).focus();
    while (this.buttons.length < this.marks.length) this.append();
    this.marks.forEach((mark, i) => this.describe(this.buttons[i]!, mark));
    this.place();
  }

  private describe(node: HTMLButtonElement, mark: Mark): void {
    const label = this.points.labelOf(mark);
    node.setAttribute("aria-label", label);
    node.title = `${label}: drag it, or move it by the arrow keys`;
    node.style.setProperty("--mark", mark.group.colour);
    const { letter = "", most } = mark.group;
    node.textContent = letter + (most === 1 ? "" : String(mark.index + 1));
  }

  private append(): void {
    const i = this.buttons.length;
    const node = make("button", {
      type: "button",
      class: "handle",
      pointerdown: (event: PointerEvent) => this.begin(event, i),
      pointermove: (event: PointerEvent) => this.drag(event),
      pointerup: (event: PointerEvent) => this.end(event),
      pointercancel: (event: PointerEvent) => this.end(event),
      keydown: (event: KeyboardEvent) => this.key(event, i),
    });
    this.buttons.push(node);
    this.layer.append(node);
  }

  /** Moves the buttons to their points in the picture. */
  place(): void {
    this.marks.forEach((mark, i) => {
      const { x, y } = this.scene.project(mark.place.xyz);
      const node = this.buttons[i]!;
      node.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      node.classList.toggle("behind", this.scene.hides(mark.place.xyz));
    });
  }

  private pixelOf(event: PointerEvent): Pixel {
    const box = this.layer.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private begin(event: PointerEvent, i: number): void {
    if (event.button !== 0) return;
    const mark = this.marks[i]!;
    const [at, pixel] = [this.scene.project(mark.place.xyz), this.pixelOf(event)];
    this.buttons[i]!.setPointerCapture(event.pointerId);
    const offset = { x: at.x - pixel.x, y: at.y - pixel.y };
    this.drags.set(event.pointerId, { mark, offset });
  }

  private drag(event: PointerEvent): void {
    const dragged = this.drags.get(event.pointerId);
    if (!dragged) return;
    const { mark, offset } = dragged;
    const pixel = this.pixelOf(event);
    const place = this.towardsMiddle({ x: pixel.x + offset.x, y: pixel.y + offset.y });
    if (place) this.points.move(mark, place, true);
  }

  /**
   * Returns the surface point at a pixel. If the pixel is beside the surface, returns the first
   * surface point on the line to the middle of the surface, so that a dragged point glides along
   * the outline.
   */
  private towardsMiddle(pixel: Pixel): Place | null {
    const middle = this.scene.middle;
    for (let i = 0; i < STRIDES; i++) {
      const t = i / STRIDES;
      const place = this.scene.pick({
        x: pixel.x + t * (middle.x - pixel.x),
        y: pixel.y + t * (middle.y - pixel.y),
      });
      if (place) return place;
    }
    return null;
  }

  private end(event: PointerEvent): void {
    const dragged = this.drags.get(event.pointerId);
    if (!dragged) return;
    this.drags.delete(event.pointerId);
    this.points.move(dragged.mark, dragged.mark.place, this.drags.size > 0);
  }

  private key(event: KeyboardEvent, i: number): void {
    const mark = this.marks[i]!;
    const arrow = ARROWS[event.key];
    if (arrow) this.step(mark, arrow, event.shiftKey ? LARGE_STEP : STEP);
    else if (event.key === "Delete" || event.key === "Backspace") this.points.remove(mark);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Moves a point by an arrow key. At the outline, the step is shorter, to stay on the surface. */
  private step(mark: Mark, arrow: Pixel, size: number): void {
    const at = this.scene.project(mark.place.xyz);
    for (let length = size; length >= 1; length /= 2) {
      const place = this.scene.pick({ x: at.x + arrow.x * length, y: at.y + arrow.y * length });
      if (place) return this.points.move(mark, place, false);
    }
  }
}
