// Edits of the mesh: the new mesh is compared with the original and opened.

import assert from "node:assert/strict";
import { OCTAHEDRON, read, settle } from "./viewer.mjs";

async function simplified(browser) {
  const { large } = browser.settings;
  const page = await browser.page(`/#meshes=${large}&mode=pair`);
  page.setDefaultTimeout(120000);
  await settle(page);
  await page.getByText("Edit the mesh").click();
  const make = page.getByRole("button", { name: "Make a new mesh" });
  await make.click();
  assert.ok(await make.isDisabled()); // a second edit would replace the first one
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

/** Fills the hole of an octahedron without one face, then smooths it. */
async function filledAndSmoothed(browser) {
  const open = OCTAHEDRON.replace(/f [^\n]*\n$/, "");
  await fetch(`${browser.settings.url}/v1/meshes/shell`, { method: "PUT", body: open });
  const page = await browser.page("/#meshes=shell&mode=pair");
  await settle(page);
  await page.getByText("Edit the mesh").click();
  for (const [edit, name] of [["fill", "shell-2"], ["smooth", "shell-3"]]) {
    await page.getByLabel("Edit", { exact: true }).selectOption(edit);
    await page.getByRole("button", { name: "Make a new mesh" }).click();
    await page.getByRole("button", { name: `Open ${name}` }).waitFor();
  }
  const [filled, smooth] = [
    await browser.ask("GET", "/v1/meshes/shell-2"),
    await browser.ask("GET", "/v1/meshes/shell-3"),
  ];
  assert.deepEqual([filled.faces, filled.boundary_count], [8, 0]);
  assert.equal(smooth.faces, 7);
  assert.notEqual(smooth.sha256, filled.sha256);
  for (const name of ["shell", "shell-2", "shell-3"])
    await browser.ask("DELETE", `/v1/meshes/${name}`);
}

export const tests = {
  "simplify, compare and open": simplified,
  "fill a hole, and smooth": filledAndSmoothed,
};
