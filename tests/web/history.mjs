// Undo, redo, links, remembered units, kept paths, downloads.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { assertSameDistance, read, settle, shows } from "./viewer.mjs";

const open = async (browser, more = "") => {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair${more}`);
  await settle(page);
  return page;
};

async function nudge(page) {
  await page.getByRole("button", { name: "End", exact: true }).focus();
  await page.keyboard.press("Shift+ArrowRight");
  await settle(page);
}

const distance = async (page) => (await read(page, "last")).distance;

async function undo(browser) {
  const page = await open(browser);
  const first = await distance(page);
  await nudge(page);
  const second = await distance(page);
  assert.notEqual(first, second);
  await page.keyboard.press("Control+z");
  await shows(page, first);
  await page.keyboard.press("Control+Shift+z");
  await shows(page, second);
  // quick repeats, before the browser has taken the first step, do not leave the page
  await page.evaluate(() => {
    for (let i = 0; i < 3; i++)
      dispatchEvent(new KeyboardEvent("keydown", { key: "z", ctrlKey: true }));
  });
  await shows(page, first);
}

/** A link holds unit, colours, edges, mode and via points, and a mesh keeps its unit. */
async function link(browser) {
  const page = await open(browser);
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  const box = await page.locator("#canvas").boundingBox();
  await page.keyboard.down("Shift");
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
  await page.keyboard.up("Shift");
  await page.getByText("Display and units").click();
  await page.getByLabel("Unit of the file").selectOption("mm");
  await page.getByLabel("Colour map", { exact: true }).selectOption("turbo");
  await page.getByLabel("Edges of the mesh").check();
  await settle(page);
  assert.match(await page.locator("#answer dd.main").textContent(), / mm$/);
  await page.getByRole("button", { name: "Copy link" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor();
  const address = await page.evaluate(() => navigator.clipboard.readText());
  for (const part of [/unit=mm/, /ramp=turbo/, /edges=true/, /via=f:/, /camera=/])
    assert.match(address, part);
  const again = await browser.page(new URL(address).hash.replace(/^/, "/"));
  await settle(again);
  assertSameDistance(await distance(again), await distance(page));
  assert.deepEqual(await read(again, "state"), await read(page, "state"));
  await page.goto(`${browser.settings.url}/docs`);
  await page.goto(`${browser.settings.url}/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  assert.equal((await read(page, "state")).unit, "mm");
}

/** Invalid parameters of a link become defaults, and numbers become steps of the sliders. */
async function invalidLink(browser) {
  const page = await open(browser, "&from=f:0:5,5,-9&to=f:0:-0.5,0.5,1&camera=0,0,x");
  assert.equal((await read(page, "state")).points, "none");
  const { camera } = await read(page, "state");
  await page.getByRole("button", { name: "Fit", exact: true }).click();
  await settle(page);
  assert.equal((await read(page, "state")).camera, camera);
  await page.evaluate(() => (location.hash = location.hash.replace(/mode=.*/, "mode=field&isolines=2.7")));
  await page.waitForFunction(() => window.geodesicd.last?.max > 0);
  await settle(page);
  assert.equal((await read(page, "state")).isolines, "3");
  assert.equal(await page.locator("#notice .error").textContent(), "");
}

async function saved(page, name) {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name, exact: true }).click(),
  ]);
  return readFileSync(await download.path());
}

async function kept(browser) {
  const page = await open(browser);
  await page.getByRole("button", { name: "Keep path" }).click();
  const first = await distance(page);
  await nudge(page);
  await page.keyboard.press("k");
  assert.equal(await page.locator(".kept").count(), 2);
  await page.getByRole("textbox", { name: "Name of the path" }).first().fill('nose, "left"');
  const rows = (await saved(page, "Download CSV")).toString().trim().split("\n");
  assert.equal(rows.length, 3);
  assert.ok(rows[1].startsWith('"nose, ""left""",'), rows[1]);
  assert.equal(Number(rows[1].split(",")[2]), first);
  await browser.picture(page, "kept-paths");
  await page.getByRole("button", { name: "Delete Path 2" }).click();
  assert.equal(await page.locator(".kept").count(), 1);
}

/** Files of a path and of a field hold the exact numbers of the answers. */
async function files(browser) {
  const page = await open(browser);
  await page.locator("#download summary").click();
  const { path } = await read(page, "last");
  const obj = (await saved(page, "Download OBJ")).toString().split("\n");
  const points = obj
    .filter((row) => row.startsWith("v "))
    .map((row) => row.slice(2).split(" ").map(Number));
  assert.deepEqual(points, path.points);
  assert.deepEqual(JSON.parse(await saved(page, "Download JSON")).path.points, path.points);
  assert.match((await saved(page, "Download SVG, unfolded")).toString(), /<svg/);
  const png = await saved(page, "Download PNG");
  const box = await page.locator("#canvas").boundingBox();
  assert.deepEqual([png.readUInt32BE(16), png.readUInt32BE(20)], [2 * box.width, 2 * box.height]);
  await page.getByRole("radio", { name: "Distance field", exact: true }).check({ force: true });
  await settle(page);
  const npy = await saved(page, "Download Field NPY");
  assert.equal(npy.subarray(1, 6).toString(), "NUMPY");
  assert.match((await saved(page, "Download Lines OBJ")).toString(), /^l /m);
  page.tolerate(/status of 410/);
  await page.route(/\/values\?format=csv/, (route) => route.fulfill({ status: 410 }));
  await page.getByRole("button", { name: "Download Field CSV" }).click();
  await page.locator("#notice .error").filter({ hasText: /no longer has this result/ }).waitFor();
  await Promise.all([
    page.waitForResponse(/\/fields(\?|$)/),
    page.getByRole("button", { name: "Try again" }).click(),
  ]);
  await settle(page);
  assert.equal(await page.locator("#notice .error").textContent(), "");
}

export const tests = {
  "undo and redo": undo,
  "a link holds the view": link,
  "a link with invalid parameters": invalidLink,
  "kept paths": kept,
  "answers as files": files,
};
