// Starts the viewer, and shows those who look for it what it knows: `window.geodesicd`.

import { buildAccess } from "./access.ts";
import { App } from "./app.ts";
import { button, byId } from "./dom.ts";
import { Display } from "./display.ts";
import { Help } from "./help.ts";
import { ModePicker } from "./modepicker.ts";
import { PointList } from "./pointlist.ts";
import { ServicePanel } from "./service.ts";
import { themeSwitch } from "./theme.ts";
import { Touch } from "./touch.ts";

const app = new App();
const display = new Display(app);
const help = new Help(app, display);
new ModePicker(app);
new PointList(app);
new ServicePanel(app.api);
new Touch(app.scene, (pixel) => app.addAt(pixel));
buildAccess(app);
app.onSurface = () => display.apply(false);
byId("switches").append(
  themeSwitch(() => display.apply(false)),
  button("Help", () => help.open(), { "aria-keyshortcuts": "?" }),
);

const ready = app.start();

declare global {
  interface Window {
    geodesicd: {
      /** Settled when the page shows what its URL says. */
      ready: Promise<void>;
      /** What the URL tells. */
      readonly state: Record<string, string>;
      /** The pixel of the window where a point of space is seen. */
      camera: { project: (point: [number, number, number]) => { x: number; y: number } };
      /** The points that are set, by group. */
      readonly points: Record<string, { face: number; barycentric: number[]; xyz: number[] }[]>;
      /** The last answer of the API to the present mode. */
      readonly last: unknown;
      /** Is a question under way? */
      readonly busy: boolean;
      /** Answers a second while something was dragged, in the last two seconds of it. */
      readonly answersPerSecond: number;
      /** What "Copy as curl" copies. */
      readonly curl: string;
    };
  }
}

window.geodesicd = {
  ready,
  get state() {
    return app.read();
  },
  camera: {
    project: (point) => {
      const box = app.scene.canvas.getBoundingClientRect();
      const { x, y } = app.scene.project(point);
      return { x: x + box.left, y: y + box.top };
    },
  },
  get points() {
    return Object.fromEntries(app.points.groups.map(({ id }) => [id, app.points.of(id)]));
  },
  get last() {
    return app.bench.last;
  },
  get busy() {
    return app.busy;
  },
  get answersPerSecond() {
    return app.rate.perSecond;
  },
  get curl() {
    return app.answer.curl();
  },
};
