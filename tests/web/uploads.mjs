// Files of the user: existing names, several files, refusals.

import assert from "node:assert/strict";
import { utimesSync, writeFileSync } from "node:fs";
import path from "node:path";
import { drop, hold, OCTAHEDRON, settle } from "./viewer.mjs";

const TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

const facesOf = async (browser, name) => (await browser.ask("GET", `/v1/meshes/${name}`)).faces;

const shows = (page, name) =>
  page.waitForFunction((mesh) => window.geodesicd.state.meshes === mesh, name);

/** Opens a page and drops a mesh whose name is taken. */
async function conflict(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 412/);
  await drop(page, ["twice.obj", OCTAHEDRON]);
  await shows(page, "twice");
  await drop(page, ["twice.obj", TETRAHEDRON]);
  await page.getByRole("button", { name: "Replace twice" }).waitFor();
  assert.equal(await facesOf(browser, "twice"), 8);
  return page;
}

async function removeAll(browser, ...names) {
  for (const name of names) await browser.ask("DELETE", `/v1/meshes/${name}`);
}

async function keepBoth(browser) {
  const page = await conflict(browser);
  await browser.picture(page, "upload-conflict");
  await page.getByRole("button", { name: /Keep both/ }).click();
  await shows(page, "twice-2");
  assert.deepEqual([await facesOf(browser, "twice"), await facesOf(browser, "twice-2")], [8, 4]);
  await removeAll(browser, "twice", "twice-2");
}

async function replace(browser) {
  const page = await conflict(browser);
  await page.getByRole("button", { name: "Replace twice" }).click();
  await page.locator("#surface-facts").filter({ hasText: "4 faces" }).waitFor();
  assert.equal(await facesOf(browser, "twice"), 4);
  await removeAll(browser, "twice");
}

/** Uploads two files. The busy daemon refuses the first one twice. */
async function several(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 503/);
  const busy = { status: 503, headers: { "Retry-After": "0" } };
  await page.route(/\/v1\/meshes\/one/, (route) => route.fulfill(busy), { times: 2 });
  await drop(page, ["one.obj", OCTAHEDRON], ["two.obj", TETRAHEDRON]);
  await shows(page, "two");
  assert.deepEqual([await facesOf(browser, "one"), await facesOf(browser, "two")], [8, 4]);
  await removeAll(browser, "one", "two");
}

/** A file that is dropped while the page opens another one is uploaded, too. */
async function later(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  const release = await hold(page, /\/one\/content/);
  await Promise.all([page.waitForRequest(/\/one\/content/), drop(page, ["one.obj", OCTAHEDRON])]);
  await drop(page, ["two.obj", TETRAHEDRON]);
  await shows(page, "two");
  release();
  await settle(page);
  await shows(page, "two");
  await removeAll(browser, "one", "two");
}

/** A mesh that is dropped on a NURBS surface is uploaded as a mesh. */
async function meshOnNurbs(browser) {
  const { url } = browser.settings;
  const body = JSON.stringify({ parametric: { torus: { major: 2, minor: 0.7 } } });
  await fetch(`${url}/v1/nurbs/ring`, { method: "PUT", body });
  const page = await browser.page("/#nurbs=ring&mode=nurbs");
  await settle(page);
  await drop(page, ["one.obj", OCTAHEDRON]);
  await shows(page, "one");
  await removeAll(browser, "one");
  await browser.ask("DELETE", "/v1/nurbs/ring");
}

/** A refused file leaves the shown answer unchanged. */
async function refused(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  page.tolerate(/status of 422/);
  const before = await page.evaluate(() => window.geodesicd.curl);
  await drop(page, ["broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n"]);
  await page
    .locator("#uploads .error")
    .filter({ hasText: /vertex|index/ })
    .waitFor();
  assert.ok(await page.locator("#answer dd.main").isVisible());
  assert.equal(await page.evaluate(() => window.geodesicd.curl), before);
}

/** The browser does not read a file that the user has corrected after the daemon refused it. */
async function changed(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  page.tolerate(/status of 422|ERR_UPLOAD_FILE_CHANGED/);
  const file = path.join(browser.settings.place, "changed.obj");
  writeFileSync(file, "v 0 0 0\nf 1 2 7\n");
  await page.locator("#file").setInputFiles(file);
  const again = page.getByRole("button", { name: "Upload again" });
  await again.waitFor();
  writeFileSync(file, OCTAHEDRON);
  utimesSync(file, 0, 0); // the browser compares seconds
  await again.click();
  await page.locator("#uploads .error").filter({ hasText: /choose it again/ }).waitFor();
  await page.locator("#file").setInputFiles(file);
  await shows(page, "changed");
  await settle(page);
  await removeAll(browser, "changed");
}

/** The browser asks before the user leaves a running upload. */
async function leaving(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await hold(page, /\/v1\/meshes\/held/);
  await page.getByRole("button", { name: "Fit" }).click(); // browsers ask only after an interaction
  await drop(page, ["held.obj", OCTAHEDRON]);
  await page.locator("#uploads progress").waitFor();
  const asked = page.waitForEvent("dialog");
  await page.close({ runBeforeUnload: true });
  const dialog = await asked;
  assert.equal(dialog.type(), "beforeunload");
  await dialog.dismiss();
}

export const tests = {
  "a taken name: keep both": keepBoth,
  "a taken name: replace": replace,
  "several files at once": several,
  "a file dropped while another one opens": later,
  "a mesh dropped on a NURBS surface": meshOnNurbs,
  "a refused file leaves the answer": refused,
  "a file that has changed": changed,
  "the browser asks before leaving a running upload": leaving,
};
