// The viewer as people use it: files dropped, points clicked and dragged, links followed, a phone,
// a keyboard.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { cpus } from "node:os";
import { setTimeout as sleep } from "node:timers/promises";
import { DESKTOP, PATIENCE, PHONE } from "./browser.mjs";

export const OCTAHEDRON = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n" +
  "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
const LEAST_RATE = 25; /* answers a second while a point is dragged */
const LEAST_DENSE_RATE = 15; /* on 1.1 million faces */
const DRAG = 3000; /* milliseconds */
const BESIDE_OTHERS = 4; /* the rates are divided by this, unless the long form measures them */
const LEAST_ANSWERS = 5; /* a drag lasts at least until it has this number of answers */
const DENSE_LEAD = 12000; /* milliseconds of a drag in which landmarks and a field are built */
const MOUSE = 8; /* milliseconds between two positions of the mouse */
const RADIUS = 15; /* pixels: a circle that stays on the surface */
// small, because the processor draws the pixels here
export const SMALL = { viewport: { width: 960, height: 640 } };
const SAME_DISTANCE = 1e-13; /* largest relative difference */
const TICKS = 100; /* ticks a second: the unit of /proc/PID/stat */

/** Waits until the page has loaded and shows an answer. */
export async function settle(page) {
  await page.waitForFunction(() => window.geodesicd);
  await page.evaluate(() => window.geodesicd.ready);
  await page.waitForFunction(() => !window.geodesicd.busy);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

/** Waits for this distance. A cached field and a search may differ in the last bits. */
export const shows = (page, distance) =>
  page.waitForFunction(([wanted, slack]) => Math.abs(window.geodesicd.last?.distance - wanted) <= slack * wanted, [distance, SAME_DISTANCE]);

/** Expects two answers to be the same distance. */
export function assertSameDistance(one, other) {
  assert.ok(Math.abs(one - other) <= SAME_DISTANCE * Math.abs(other), `${one} is not ${other}`);
}

export const read = (page, name) => page.evaluate((key) => window.geodesicd[key], name);

/** Returns the number that the answer shows, with all its digits. */
const shown = async (page) => Number(await page.locator("#answer dd.main").first().getAttribute("title"));

/** Drops files, given by their names and contents, on the page. */
export async function drop(page, ...files) {
  const transfer = await page.evaluateHandle((all) => {
    const data = new DataTransfer();
    for (const [name, bytes] of all) data.items.add(new File([Uint8Array.from(bytes)], name));
    return data;
  }, files.map(([name, content]) => [name, [...Buffer.from(content)]]));
  for (const type of ["dragover", "drop"]) await page.dispatchEvent("body", type, { dataTransfer: transfer });
}

/** Holds requests whose address matches, until the returned function is called. */
export async function hold(page, pattern) {
  let release = () => {};
  const held = new Promise((resolve) => (release = resolve));
  await page.route(pattern, async (route) => {
    await held;
    await route.continue().catch(() => {}); // the page may have aborted the request
  });
  return release;
}

/** Clicks two points of the picture near the middle of the surface. */
async function clickTwice(page, click) {
  const box = await page.locator("#canvas").boundingBox();
  for (const side of [-1, 1]) await click(box.x + box.width / 2 + side * box.width * 0.06, box.y + box.height / 2 + side * box.height * 0.04);
}

const asPoint = ({ face, barycentric }) => ({ face, barycentric });

async function assertEqualToApi(browser, page) {
  const { from, to } = await read(page, "points");
  const mesh = (await read(page, "state")).meshes;
  const answer = await browser.ask("POST", `/v1/meshes/${mesh}/path`, { from: asPoint(from[0]), to: asPoint(to[0]) });
  const { distance } = await read(page, "last");
  assertSameDistance(distance, answer.distance);
  assert.equal(await shown(page), distance);
  assert.ok(answer.distance > 0);
}

async function firstPicture(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}`);
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
  await browser.picture(page, "first-desktop");
}

async function dropAndClick(browser) {
  const page = await browser.page("/");
  await settle(page);
  await drop(page, ["octahedron.obj", OCTAHEDRON]);
  await page.waitForFunction(() => window.geodesicd.state.meshes === "octahedron");
  await settle(page);
  for (const label of ["Start", "End"]) {
    await page.getByRole("button", { name: label, exact: true }).focus();
    await page.keyboard.press("Delete");
  }
  await clickTwice(page, (x, y) => page.mouse.click(x, y));
  await settle(page);
  await assertEqualToApi(browser, page);
  await browser.ask("DELETE", "/v1/meshes/octahedron");
}

/** Returns the seconds of processor time that the browser's processes and the daemon have used. */
async function processorSeconds(browser) {
  const session = await browser.launched.newBrowserCDPSession();
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  const fields = readFileSync(`/proc/${browser.settings.daemon}/stat`, "utf8").split(") ")[1].split(" ");
  return processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, (Number(fields[11]) + Number(fields[12])) / TICKS);
}

/** Moves the mouse in circles, starting at (x, y), for a while and until `isDone`. */
async function circle(page, { x, y }, milliseconds, isDone = () => true) {
  const end = performance.now() + milliseconds;
  const isEnd = () => performance.now() > (isDone() ? end : end + PATIENCE);
  for (let turn = 0; !isEnd(); turn += 0.05) {
    await page.mouse.move(x + RADIUS * (1 - Math.cos(turn)), y - RADIUS * Math.sin(turn));
    await sleep(MOUSE);
  }
}

/**
 * Drags the point of this name in circles for a while, and checks the number of answers a second.
 * If other programs use the machine, the processor time decides instead: the machine's processors
 * must suffice for that rate. Under `make test`, other tests run at the same time, and a fraction
 * of the rate suffices. The drag begins `lead` milliseconds before the measurement. `check` runs
 * before the drag ends.
 */
export async function assertRate(browser, page, { name, pattern, least, lead = 0, check = () => {} }) {
  const handle = await page.getByRole("button", { name, exact: true }).boundingBox();
  const [x, y] = [handle.x + handle.width / 2, handle.y + handle.height / 2];
  let answers = 0;
  page.on("response", (response) => (answers += pattern.test(response.url()) ? 1 : 0));
  await page.mouse.move(x, y);
  await page.mouse.down();
  await circle(page, { x, y }, lead);
  answers = 0;
  const [begun, before] = [performance.now(), await processorSeconds(browser)];
  await circle(page, { x, y }, DRAG, () => answers >= LEAST_ANSWERS);
  const seconds = (performance.now() - begun) / 1000;
  const taken = (await processorSeconds(browser)) - before;
  check();
  await page.mouse.up();
  await settle(page);
  const [rate, cost] = [answers / seconds, taken / answers];
  const told = `${rate.toFixed(1)} answers a second, ${(1000 * cost).toFixed(0)} ms of processor time each with their pictures`;
  const { meshes, mode } = await read(page, "state");
  console.log(`# web: a point dragged on ${meshes}, ${mode}: ${told}`);
  const wanted = browser.settings.all ? least : least / BESIDE_OTHERS;
  assert.ok(rate >= wanted || cost <= cpus().length / wanted, told);
}

const PATH = { name: "End", pattern: /\/path(\?|$)/ };

async function drag(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`, SMALL);
  await settle(page);
  await assertRate(browser, page, { ...PATH, least: LEAST_RATE });
  await assertEqualToApi(browser, page);
  await browser.picture(page, "dragged");
}

/** Uploads a mesh that the sample maker makes from these arguments. */
export async function putSample({ settings }, name, ...sample) {
  const body = execFileSync(settings.sampler, sample, { maxBuffer: 2 ** 28 });
  await fetch(`${settings.url}/v1/meshes/${name}`, { method: "PUT", body });
}

async function dragDense(browser) {
  await putSample(browser, "dense", "terrain", "cells=740");
  const page = await browser.page("/#meshes=dense&mode=pair&up=z", SMALL);
  page.setDefaultTimeout(4 * PATIENCE);
  // 404: a daemon without previews; 422: a ray that hits only the preview
  page.tolerate(/status of (404|422)/);
  await settle(page);
  await assertRate(browser, page, { ...PATH, least: LEAST_DENSE_RATE, lead: DENSE_LEAD });
  await browser.ask("DELETE", "/v1/meshes/dense");
}

async function link(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await page.getByRole("button", { name: "Start", exact: true }).focus();
  const before = await read(page, "points");
  await page.keyboard.press("Shift+ArrowRight");
  await page.locator("#canvas").focus();
  await page.keyboard.press("ArrowUp");
  await settle(page);
  assert.notDeepEqual(await read(page, "points"), before);
  const { distance } = await read(page, "last");
  const again = await browser.page("/" + new URL(page.url()).hash);
  await settle(again);
  assertSameDistance((await read(again, "last")).distance, distance);
  assert.deepEqual(await read(again, "state"), await read(page, "state"));
}

async function copyAsCurl(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.getByRole("button", { name: "Copy as curl" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor();
  const command = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(command, await read(page, "curl"));
  const answer = JSON.parse(execFileSync("sh", ["-c", command], { stdio: ["ignore", "pipe", "ignore"] }));
  assertSameDistance(answer.distance, (await read(page, "last")).distance);
}

async function problems(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 4\d\d/);
  await drop(page, ["broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n"]);
  await page.locator("#uploads .error").filter({ hasText: /vertex|index/ }).waitFor();
  await browser.picture(page, "problem-desktop");
}

async function phone(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`, PHONE);
  await settle(page);
  await clickTwice(page, (x, y) => page.touchscreen.tap(x, y));
  await settle(page);
  await assertEqualToApi(browser, page);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(wide <= 0, `the page is ${wide} pixels wider than the phone`);
  await browser.picture(page, "phone");
  await browser.assertAccessible(page);
}

async function accessible(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`, DESKTOP);
  await settle(page);
  await page.evaluate(() => document.querySelectorAll("details").forEach((part) => (part.open = true)));
  await browser.assertAccessible(page);
  await page.getByRole("button", { name: "Help" }).click();
  await page.getByRole("dialog").waitFor();
  await browser.assertAccessible(page);
  await browser.picture(page, "help-dark");
}

async function themes(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`, PHONE);
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    await settle(page);
    await browser.picture(page, `phone-${colorScheme}`);
  }
}

/** A mesh of three triangles on one edge is refused. Then a button of the page repairs it. */
async function mended(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 422/);
  await drop(page, ["fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"]);
  const mend = page.getByRole("button", { name: "Mend and upload" });
  await mend.click();
  await page.waitForFunction(() => window.geodesicd.state.meshes === "fan");
  await settle(page);
  assert.equal(await mend.count(), 0);
  assert.ok((await browser.ask("GET", "/v1/meshes/fan")).repair.edges_split > 0);
}

/** Two fingers drag two points at the same time. */
async function fingers(browser) {
  await putSample(browser, "ball", "icosphere", "level=4");
  const page = await browser.page("/#meshes=ball&mode=pair", PHONE);
  await settle(page);
  const session = await page.context().newCDPSession(page);
  const middle = async (name) => {
    const box = await page.getByRole("button", { name, exact: true }).boundingBox();
    return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
  };
  const touch = (type, ...touchPoints) => session.send("Input.dispatchTouchEvent", { type, touchPoints });
  const [a, b] = [{ ...(await middle("Start")), id: 0 }, { ...(await middle("End")), id: 1 }];
  await touch("touchStart", a);
  await touch("touchStart", a, b);
  for (const step of [4, 8]) await touch("touchMove", { ...a, y: a.y + step }, { ...b, y: b.y + step });
  await touch("touchEnd");
  await settle(page);
  for (const [name, { x, y }] of Object.entries({ Start: a, End: b })) {
    const after = await middle(name);
    assert.ok(Math.hypot(after.x - x, after.y - y - 8) < 4, `${name}: ${x}, ${y} to ${after.x}, ${after.y}`);
  }
  await browser.ask("DELETE", "/v1/meshes/ball");
}

const focused = (page) => page.evaluate(() => document.activeElement.getAttribute("aria-label"));

/** After a point is removed, its row disappears, and the focus goes to the next point. */
async function removal(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=set`);
  await settle(page);
  await page.locator("#points summary").click();
  await page.getByRole("textbox", { name: "Point 1", exact: true }).fill(" v:12 ");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => window.geodesicd.points.points[0].barycentric.includes(1));
  await page.getByRole("button", { name: "Remove Point 2", exact: true }).click();
  assert.equal(await page.locator(".point").count(), 6); // five points, and a row for a new one
  assert.equal(await focused(page), "Remove Point 2");
  await page.getByRole("button", { name: "Point 5", exact: true }).focus();
  await page.keyboard.press("Delete");
  assert.equal(await focused(page), "Point 4");
  await settle(page);
}

export const tests = {
  "the first picture": firstPicture,
  "a file is dropped, two clicks, the API's own length": dropAndClick,
  "a refused file is repaired": mended,
  "a point is dragged": drag,
  "a link shows the same": link,
  "copy as curl": copyAsCurl,
  "a problem is shown": problems,
  "a phone, by touch": phone,
  "two fingers drag two points": fingers,
  "a removed point": removal,
  "accessible in light and dark": accessible,
  "themes": themes,
};

export const longTests = {
  "a point is dragged on 1.1 million faces": dragDense,
};
