// The access key, for a daemon with keys.

import type { App } from "./app.ts";
import { byId, make } from "./dom.ts";

export function buildAccess(app: App): void {
  const input = make("input", {
    type: "password",
    id: "key",
    autocomplete: "off",
    value: app.api.key,
  });
  const take = (event: SubmitEvent): void => {
    event.preventDefault();
    app.api.key = input.value.trim();
    void app.reload();
  };
  const row = make("div", { class: "row" }, input, make("button", { type: "submit" }, "Use it"));
  const label = make(
    "label",
    { for: "key" },
    "Sent with each request; forgotten when this tab closes",
  );
  byId("access").append(make("form", { submit: take }, label, row));
}
