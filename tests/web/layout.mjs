// The page at three sizes: visible answers, a panel that folds, zoom by the wheel, the start card.

import assert from "node:assert/strict";
import { PHONE } from "./browser.mjs";
import { putSample, read, settle } from "./viewer.mjs";

const LAPTOP = { viewport: { width: 1366, height: 768 } };

const MODES = ["pair", "field", "set", "curves", "trace", "spline", "cut", "limit", "nurbs"];

const overlap = (a, b) =>
  a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

async function answersInSight(browser) {
  await putSample(browser, "ring", "torus", "columns=60", "rows=30");
  for (const mode of MODES) {
    const surface = ["limit", "nurbs"].includes(mode) ? "" : "meshes=ring&";
    const page = await browser.page(`/#${surface}mode=${mode}`, LAPTOP);
    await settle(page);
    const box = await page.locator("#actions").boundingBox();
    assert.ok(
      box.y + box.height <= LAPTOP.viewport.height,
      `${mode}: the answer ends at ${box.y + box.height}`,
    );
    await browser.picture(page, `laptop-${mode}`);
    await browser.closePages();
  }
  await browser.ask("DELETE", "/v1/meshes/ring");
}

/** Returns how far two fixed points of the scene are apart in the picture, in pixels. */
const widthOf = (page) =>
  page.evaluate(() => {
    const [x, y, z] = window.geodesicd.state.camera.split(",").map(Number);
    const size = Math.hypot(x, z);
    const [a, b] = [-0.05, 0.05].map((part) =>
      window.geodesicd.camera.project([(part * z) / size, 0.1, (-part * x) / size]),
    );
    return Math.hypot(a.x - b.x, a.y - b.y);
  });

async function sheet(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=field`, PHONE);
  await settle(page);
  assert.ok(!(await page.locator("#readout").isVisible()));
  const before = await page.locator("#canvas").boundingBox();
  const width = await widthOf(page);
  await page.getByRole("button", { name: "Hide the controls" }).click();
  await settle(page);
  const after = await page.locator("#canvas").boundingBox();
  assert.ok(after.height > before.height + 200, `${before.height} pixels, folded ${after.height}`);
  const ratio = (await widthOf(page)) / width;
  assert.ok(Math.abs(ratio - 1) < 0.01, `the surface is ${ratio} times as wide`);
  const readout = await page.locator("#readout").boundingBox();
  for (const name of ["#toolbar", "#legend"])
    assert.ok(
      !overlap(readout, await page.locator(name).boundingBox()),
      `the readout covers ${name}`,
    );
  await browser.picture(page, "phone-folded");
  await page.getByRole("button", { name: "Show the controls" }).click();
}

/** On a phone on its side, the picture keeps half of the window, and the panel scrolls. */
async function sideways(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=field`, PHONE);
  await settle(page);
  await page.locator("#access summary").click();
  for (const [width, height] of [[667, 375], [568, 320]]) {
    await page.setViewportSize({ width, height });
    const canvas = await page.locator("#canvas").boundingBox();
    assert.equal(canvas.height, height);
    assert.ok(canvas.width >= width / 2, `the picture is ${canvas.width} pixels wide`);
    await page.locator("#key").scrollIntoViewIfNeeded();
    const key = await page.locator("#key").boundingBox();
    assert.ok(key.y >= 0 && key.y + key.height <= height, `the key is at ${key.y}`);
    const wide = await page.locator("#panel").evaluate((panel) => panel.scrollWidth - panel.clientWidth);
    assert.ok(wide <= 0, `the panel is ${wide} pixels too wide`);
    await browser.picture(page, `phone-sideways-${width}`);
  }
}

async function wheel(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  const { to } = await read(page, "points");
  const seen = () => page.evaluate((xyz) => window.geodesicd.camera.project(xyz), to[0].xyz);
  const [{ x, y }, camera] = [await seen(), (await read(page, "state")).camera];
  await page.mouse.move(x, y); // the wheel must zoom over the handle of the point, too
  await page.mouse.wheel(0, -400);
  await page.waitForFunction((before) => window.geodesicd.state.camera !== before, camera);
  const after = await seen();
  const moved = Math.hypot(after.x - x, after.y - y);
  assert.ok(moved < 12, `the point under the cursor moved by ${moved} pixels`);
}

async function startCard(browser) {
  const { meshes } = await browser.ask("GET", "/v1/meshes");
  const page = await browser.page("/icon.svg"); // a page on which the route is installed first
  page.tolerate(/status of 404/); // the browser requests an icon for /icon.svg
  await page.route(/\/v1\/meshes\/[^/]+$/, async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, json: { ...(await response.json()), faces: 5e6 } });
  });
  await page.goto(browser.settings.url);
  await settle(page);
  for (const { name } of meshes.slice(0, 3))
    assert.ok(await page.locator("#start").getByRole("button", { name, exact: true }).isVisible());
  await browser.picture(page, "start");
  // on a small window, the card scrolls
  await page.setViewportSize({ width: 568, height: 320 });
  const card = page.locator("#start");
  const { y, height } = await card.boundingBox();
  assert.ok(y >= 0 && y + height <= 320, `the card has ${height} pixels from ${y}`);
  await card.getByRole("button", { name: "Vase (revolution)" }).click({ trial: true });
}

const meshNames = async (browser) =>
  (await browser.ask("GET", "/v1/meshes?limit=1000")).meshes.map(({ name }) => name);

/** Smooth surfaces are drawn without adding a mesh to the public list. */
async function nothingStored(browser) {
  const page = await browser.page("/");
  await settle(page);
  const before = await meshNames(browser);
  for (const [mode, number] of [["NURBS", "length"], ["Catmull-Clark", "distance"]]) {
    await page.getByRole("radio", { name: mode, exact: true }).check({ force: true });
    await settle(page);
    assert.ok((await read(page, "last"))[number] > 0, mode);
    assert.deepEqual(await meshNames(browser), before, mode);
  }
}

const PRISM =
  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\n" +
  "f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";

/** The daemon makes the mesh of a control mesh with polygons; the page deletes it. */
async function polygonsLeaveNothing(browser) {
  const { url } = browser.settings;
  await fetch(`${url}/v1/subdivisions/prism`, { method: "PUT", body: PRISM });
  const before = await meshNames(browser);
  const page = await browser.page("/#subdivisions=prism&mode=limit");
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
  assert.deepEqual(await meshNames(browser), before);
  await browser.ask("DELETE", "/v1/subdivisions/prism");
}

/** A path that crosses the seam of a torus enters the drawing of the domain on the other side. */
async function seam(browser) {
  const { url } = browser.settings;
  const body = JSON.stringify({ parametric: { torus: { major: 2, minor: 0.7 } } });
  await fetch(`${url}/v1/nurbs/ring`, { method: "PUT", body });
  const page = await browser.page("/#nurbs=ring&mode=nurbs&what=curves");
  await settle(page);
  const inside = await page.locator(".domain").evaluate((drawing) => {
    const box = drawing.querySelector(".border").getBoundingClientRect();
    const isIn = (node) => {
      const { left, right, top, bottom } = node.getBoundingClientRect();
      return right > box.left && left < box.right && bottom > box.top + 1 && top < box.bottom - 1;
    };
    return [...drawing.querySelectorAll(".path")].filter(isIn).length;
  });
  assert.equal(inside, 2);
  assert.equal((await read(page, "state")).up, "z");
  await browser.ask("DELETE", "/v1/nurbs/ring");
}

/**
 * The page draws a trimmed surface and shows an answer. No mesh of this surface stays on the
 * daemon.
 */
async function trims(browser) {
  const { url } = browser.settings;
  const hole = [[0.48, 0.48], [0.52, 0.48], [0.52, 0.52], [0.48, 0.52], [0.48, 0.48]];
  const body = JSON.stringify({
    parametric: { graph: { coefficients: [[0]], u: [0, 1], v: [0, 1] } },
    trims: { holes: [[{ polyline: hole }]] },
  });
  await fetch(`${url}/v1/nurbs/frame`, { method: "PUT", body });
  const before = await meshNames(browser);
  const page = await browser.page("/#nurbs=frame&mode=nurbs");
  await settle(page);
  assert.ok((await read(page, "last")).length > 0);
  assert.deepEqual(await meshNames(browser), before);
  await browser.picture(page, "nurbs-trims");
  await browser.ask("DELETE", "/v1/nurbs/frame");
}

/**
 * If the user chooses a class of paths on a torus, the path has the chosen turns, and is longer
 * than the shortest path.
 */
async function turns(browser) {
  const { url } = browser.settings;
  const body = JSON.stringify({ parametric: { torus: { major: 2, minor: 0.7 } } });
  await fetch(`${url}/v1/nurbs/ring`, { method: "PUT", body });
  const page = await browser.page("/#nurbs=ring&mode=nurbs");
  await settle(page);
  const shortest = await read(page, "last");
  await page.getByLabel("Of all paths").selectOption("turns");
  const slider = page.getByLabel("Turns in u");
  await slider.fill("2");
  await settle(page);
  const found = await read(page, "last");
  assert.deepEqual(found.turns, [2, 0]);
  assert.ok(found.length > shortest.length);
  await browser.picture(page, "nurbs-turns");
  await browser.ask("DELETE", "/v1/nurbs/ring");
}

/** The keyboard turns and shifts the picture, and moves a point up to the outline. */
async function keys(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await page.locator("#canvas").focus();
  const camera = async () => (await read(page, "state")).camera.split(",").map(Number);
  const before = await camera();
  await page.keyboard.press("ArrowLeft");
  const turned = await camera();
  assert.deepEqual(turned.slice(3), before.slice(3));
  assert.notDeepEqual(turned, before);
  await page.keyboard.press("Shift+ArrowLeft");
  const shifted = await camera();
  const step = shifted.map((x, i) => x - turned[i]);
  assert.ok(Math.hypot(...step.slice(0, 3)) > 0.05);
  for (let axis = 0; axis < 3; axis++) assert.ok(Math.abs(step[axis] - step[axis + 3]) < 2e-4);
  const end = page.getByRole("button", { name: "End", exact: true });
  const pressed = async (key, count) => {
    for (let i = 0; i < count; i++) await end.press(key);
    return (await end.boundingBox()).x;
  };
  const outline = await pressed("Shift+ArrowRight", 25);
  assert.ok(Math.abs((await pressed("ArrowRight", 8)) - outline) < 2);
}

/** Colours of the legend carry data, so forced colours do not replace them. */
async function forcedColours(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=set`);
  await page.emulateMedia({ forcedColors: "active" });
  await settle(page);
  const colours = await page.locator(".swatch").evaluateAll((all) =>
    all.map((swatch) => getComputedStyle(swatch).backgroundColor),
  );
  assert.equal(new Set(colours).size, 6);
}

/** Without WebGL, the page says so, and shows no controls that would do nothing. */
async function withoutWebGl(browser) {
  const page = await browser.page("/icon.svg", { viewport: { width: 360, height: 640 } });
  page.tolerate(/status of 404|Error creating WebGL context/); // the browser requests an icon
  await page.addInitScript(() => (HTMLCanvasElement.prototype.getContext = () => null));
  await page.goto(browser.settings.url);
  const message = await page.getByRole("alert").boundingBox();
  assert.ok(message.x >= 0 && message.x + message.width <= 360);
  assert.match(await page.getByRole("alert").textContent(), /needs WebGL 2/);
  assert.ok(await page.locator("#panel").isHidden());
  await browser.picture(page, "without-webgl");
}

/** If the browser loses WebGL, the page says so until the picture is back. */
async function lostWebGl(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await page.evaluate(() => {
    const gl = document.getElementById("canvas").getContext("webgl2");
    window.loss = gl.getExtension("WEBGL_lose_context");
    window.loss.loseContext();
  });
  const message = page.locator("#busy").filter({ hasText: /has lost the picture/ });
  await message.waitFor();
  await page.evaluate(() => (location.hash += "&unit=mm"));
  await settle(page);
  assert.ok(await message.isVisible());
  await page.evaluate(() => window.loss.restoreContext());
  await message.waitFor({ state: "detached" });
}

async function deleting(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  assert.ok(await page.getByRole("button", { name: "Delete", exact: true }).isVisible());
}

export const tests = {
  "answers are in sight on a laptop": answersInSight,
  "the sheet of a phone folds": sheet,
  "a phone on its side": sideways,
  "the wheel zooms to the cursor": wheel,
  "the start card lists the daemon's meshes": startCard,
  "smooth surfaces leave no mesh": nothingStored,
  "a control mesh with polygons leaves no mesh": polygonsLeaveNothing,
  "the domain of a torus repeats": seam,
  "a chosen class of paths on a torus": turns,
  "a trimmed surface": trims,
  "keys move the picture": keys,
  "delete is in sight": deleting,
  "forced colours": forcedColours,
  "without WebGL": withoutWebGl,
  "lost WebGL": lostWebGl,
};
