// Embeds the page in a frame of another page. `?embed=1` hides the panel. The page posts each
// answer to its parent, and the parent sets the points by messages. clients/js/viewer.js is the
// parent's side.

import type { App } from "./app.ts";

export interface EmbedMessage {
  /** The fragment of the address to show. */
  geodesicd: "show";
  fragment: string;
}

export function embed(app: App): void {
  if (!new URLSearchParams(location.search).has("embed")) return;
  document.body.classList.add("embedded");
  if (parent === window) return;
  app.watchers.push(() => {
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
