// Marks the exact value under the cursor on the legend.

import type { App } from "./app.ts";
import { isAbort } from "./bench.ts";
import { Latest } from "./latest.ts";
import type { Place } from "./place.ts";

export class Hover {
  private readonly asker = new Latest<Place>((place) => this.ask(place));
  private running = new AbortController();

  constructor(private readonly app: App) {
    const { canvas } = app.scene;
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerleave", () => this.leave());
    app.watchers.push(() => this.leave()); /* the value may belong to an earlier answer */
  }

  private move(event: PointerEvent): void {
    const { app } = this;
    if (event.pointerType !== "mouse" || event.buttons !== 0 || !app.bench.legend.scale) return;
    const place = app.scene.pick({ x: event.offsetX, y: event.offsetY });
    if (place) this.asker.put(place);
    else this.leave();
  }

  private leave(): void {
    this.running.abort();
    this.asker.drop();
    this.app.bench.legend.point(null);
  }

  private async ask(place: Place): Promise<void> {
    const { app } = this;
    const running = (this.running = new AbortController());
    try {
      const value = await app.mode.valueAt(place, running.signal);
      if (!running.signal.aborted) app.bench.legend.point(value);
    } catch (error) {
      if (!isAbort(error)) app.bench.legend.point(null);
    }
  }
}
