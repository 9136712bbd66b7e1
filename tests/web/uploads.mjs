// Files of the user: existing names, several files, refusals.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { utimesSync, writeFileSync } from "node:fs";
import path from "node:path";
import { gzipSync } from "node:zlib";
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

/** Returns a 3MF file with one object, a tetrahedron. */
function packed() {
  const vertices = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"].map((row) => row.replace(/(.) (.) (.)/, '<vertex x="$1" y="$2" z="$3"/>'));
  const triangles = ["0 2 1", "0 1 3", "1 2 3", "0 3 2"].map((row) => row.replace(/(.) (.) (.)/, '<triangle v1="$1" v2="$2" v3="$3"/>'));
  const mesh = `<mesh><vertices>${vertices.join("")}</vertices><triangles>${triangles.join("")}</triangles></mesh>`;
  const input =
    '<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>' +
    `<object id="1">${mesh}</object></resources><build><item objectid="1"/></build></model>`;
  const program = "import sys, zipfile; zipfile.ZipFile(sys.stdout.buffer, 'w').writestr('3D/3dmodel.model', sys.stdin.read())";
  return execFileSync("python3", ["-c", program], { input });
}

/** Returns a tetrahedron in each format that the daemon reads, and a compressed one, by names. */
async function everyFormat({ settings: { url } }) {
  const source = `${url}/v1/meshes/source`;
  await fetch(source, { method: "PUT", body: TETRAHEDRON });
  const content = async (format) => Buffer.from(await (await fetch(`${source}/content?format=${format}`)).arrayBuffer());
  const { capabilities } = await (await fetch(`${url}/v1`)).json();
  const files = { "a-gz.obj.gz": gzipSync(TETRAHEDRON), "a-json.json": '{"vertices":[[0,0,0],[1,0,0],[0,1,0],[0,0,1]],"faces":[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]}', "a-3mf.3mf": packed() };
  for (const format of capabilities.formats) files[`a-${format}.${format}`] ??= await content(format);
  await fetch(source, { method: "DELETE" });
  return Object.entries(files);
}

/** If the daemon rejects a file, the page shows the daemon's sentence. */
async function assertRejected(page, { url }) {
  page.tolerate(/status of 4\d\d/);
  const outside = '{"asset":{"version":"2.0"},"buffers":[{"uri":"points.bin","byteLength":9}]}';
  const files = [["no.3mf", "no archive"], ["no.glb", "glTF"], ["no.gltf", outside], ["no.txt", "a letter"], ["no.obj.gz", "no gzip"]];
  await drop(page, ...files);
  const errors = page.locator("#uploads .error").filter({ hasText: /./ });
  await errors.nth(files.length - 1).waitFor();
  const shown = (await errors.allTextContents()).join("\n");
  for (const [name, body] of files) {
    const headers = name.endsWith(".gz") ? { "Content-Encoding": "gzip" } : {};
    const { detail } = await (await fetch(`${url}/v1/meshes/no`, { method: "PUT", body, headers })).json();
    assert.ok(shown.includes(`File ${name}: ${detail}`), `${name}: ${detail}\n${shown}`);
  }
}

/** The page uploads each format. The user chooses some files in a dialog, and drops the others. */
async function formats(browser) {
  const files = await everyFormat(browser);
  const names = files.map(([name]) => name.split(".")[0]);
  const page = await browser.page("/");
  await settle(page);
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Upload", exact: true }).click()]);
  const accepted = (await page.locator("#file").getAttribute("accept")).split(",");
  for (const [name] of files) assert.ok(accepted.some((ending) => name.endsWith(ending)), name);
  const half = files.length >> 1;
  await chooser.setFiles(files.slice(0, half).map(([name, content]) => ({ name, mimeType: "", buffer: Buffer.from(content) })));
  await drop(page, ...files.slice(half));
  await shows(page, names.at(-1));
  for (const name of names) assert.equal(await facesOf(browser, name), 4, name);
  await removeAll(browser, ...names);
  await assertRejected(page, browser.settings);
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
  "each format, chosen and dropped": formats,
  "a file dropped while another one opens": later,
  "a mesh dropped on a NURBS surface": meshOnNurbs,
  "a refused file leaves the answer": refused,
  "a file that has changed": changed,
  "the browser asks before leaving a running upload": leaving,
};
