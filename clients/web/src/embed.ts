// Embeds the page in a frame of another page. `?embed=1` hides the panel. The page posts each
// answer to its parent, and the parent sets the points by messages. clients/js/viewer.js is the
// parent's side.

import type { App } from "./app.ts";
import { byId, isEmbedded, make } from "./dom.ts";

export interface EmbedMessage {
  /** The fragment of the address to show. */
  geodesicd: "show";
  fragment: string;
}

/** Shows an error over the picture until the next answer. */
function showTroubles(app: App): void {
  const node = make("p", { id: "trouble", role: "alert" });
  byId("stage").append(node);
  app.onTrouble = (message) => {
    node.textContent = message;
    parent.postMessage({ geodesicd: "error", message }, "*");
  };
  app.watchers.push(() => {
    if (app.bench.last !== undefined) node.textContent = "";
  });
}

export function embed(app: App): void {
  if (!isEmbedded) return;
  document.body.classList.add("embedded");
  showTroubles(app);
  if (parent === window) return;
  app.watchers.push(() => {
    if (app.bench.last === undefined) return;
    const { path } = app.mode;
    parent.postMessage(
      { geodesicd: "answer", state: app.read(), length: path?.length ?? null },
      "*",
    );
  });
  addEventListener("message", ({ source, data }: MessageEvent<EmbedMessage>) => {
    if (source !== parent || data?.geodesicd !== "show" || typeof data.fragment !== "string")
      return;
    location.hash = data.fragment;
  });
}
