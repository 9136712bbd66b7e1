// Starts the viewer, and publishes its state as `window.geodesicd`.

import { App } from "./app.ts";
import { button, byId, make } from "./dom.ts";
import { Derive } from "./derive.ts";
import { Downloads } from "./download.ts";
import { embed } from "./embed.ts";
import { Help } from "./help.ts";
import { Hover } from "./hover.ts";
import { Kept } from "./kept.ts";
import { ModePicker } from "./modepicker.ts";
import { buildAccess, buildFold, themeSwitch } from "./panel.ts";
import { PointList } from "./pointlist.ts";
import { ServicePanel } from "./service.ts";
import { Touch } from "./touch.ts";

function start(): App {
  try {
    return new App();
  } catch (error) {
    const text = "This page needs WebGL 2. Switch on hardware acceleration. Without it, use the ";
    const message = make("p", { role: "alert" }, text, make("a", { href: "/docs" }, "API"), ".");
    document.body.classList.add("embedded");
    byId("stage").replaceChildren(message);
    throw error;
  }
}

const app = start();
const kept = new Kept(app);
const help = new Help(app, kept);
new Derive(app);
new Downloads(app);
new Hover(app);
new ModePicker(app);
new PointList(app);
new ServicePanel(app.api);
new Touch(app.scene, (pixel, hasShift) => app.addAt(pixel, hasShift));
buildAccess(app.api, () => void app.reload());
buildFold();
embed(app);
byId("switches").append(
  themeSwitch(() => app.display.apply()),
  button("Help", () => help.open(), { "aria-keyshortcuts": "?" }),
);

const ready = app.start();

declare global {
  interface Window {
    geodesicd: {
      /** Resolves when the page shows the content of its address. */
      ready: Promise<void>;
      /** The parameters of the address. */
      readonly state: Record<string, string>;
      /** Returns the pixel of the window that shows a point in space. */
      camera: { project: (point: [number, number, number]) => { x: number; y: number } };
      /** The points that the user has set, by group. */
      readonly points: Record<string, { face: number; barycentric: number[]; xyz: number[] }[]>;
      /** The last answer of the API to a query of the mode. */
      readonly last: unknown;
      /** Whether a query, a load or an upload is running. */
      readonly busy: boolean;
      /** Answers per second in the last two seconds of a drag. */
      readonly answersPerSecond: number;
      /** The command that "Copy as curl" copies. */
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
