// Edits of the mesh: the new mesh is compared with the original and opened.

import assert from "node:assert/strict";
import { read, settle } from "./viewer.mjs";

async function simplified(browser) {
  const { large } = browser.settings;
  const page = await browser.page(`/#meshes=${large}&mode=pair`);
  page.setDefaultTimeout(120000);
  await settle(page);
  await page.getByText("Edit the mesh").click();
  await page.getByRole("button", { name: "Make a new mesh" }).click();
  const open = page.getByRole("button", { name: `Open ${large}-2` });
  await open.waitFor();
  const [before, after] = [
    await browser.ask("GET", `/v1/meshes/${large}`),
    await browser.ask("GET", `/v1/meshes/${large}-2`),
  ];
  assert.ok(after.faces <= 0.2 * before.faces + 1, `${after.faces} of ${before.faces} faces`);
  await page.getByRole("slider", { name: "Before and after" }).fill("0.3");
  await browser.picture(page, "derive-compare");
  await open.click();
  await page.waitForFunction((name) => window.geodesicd.state.meshes === name, `${large}-2`);
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
  await browser.ask("DELETE", `/v1/meshes/${large}-2`);
}

export const tests = {
  "simplify, compare and open": simplified,
};
