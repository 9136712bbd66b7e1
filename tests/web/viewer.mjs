// The viewer as people use it: files dropped, points clicked and dragged, links followed, a phone, a keyboard.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { cpus } from "node:os";
import { setTimeout as sleep } from "node:timers/promises";
import { DESKTOP, PHONE } from "./browser.mjs";

const OCTAHEDRON = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n" +
  "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
const LEAST_RATE = 20; /* answers a second while a point is dragged */
const DRAG = 3000; /* milliseconds */
const MOUSE = 8; /* milliseconds from one place of the mouse to the next */
const RADIUS = 15; /* pixels: a circle that stays on the surface */
const SMALL = { viewport: { width: 960, height: 640 } }; /* pixels are drawn by the processor here */
const URL_DELAY = 1000; /* milliseconds: the URL is written when the hand rests */
const TICKS = 100; /* a second: the unit of /proc/PID/stat */

/** Until the page has loaded, asked, and been answered. */
export async function settle(page) {
  await page.waitForFunction(() => window.geodesicd);
  await page.evaluate(() => window.geodesicd.ready);
  await page.waitForFunction(() => !window.geodesicd.busy);
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

export const read = (page, name) => page.evaluate((key) => window.geodesicd[key], name);

/** The number that the answer shows, with all its digits. */
const shown = async (page) => Number(await page.locator("#answer dd.main").first().getAttribute("title"));

async function drop(page, name, text) {
  const transfer = await page.evaluateHandle(([file, content]) => {
    const data = new DataTransfer();
    data.items.add(new File([content], file));
    return data;
  }, [name, text]);
  for (const type of ["dragover", "drop"]) await page.dispatchEvent("body", type, { dataTransfer: transfer });
}

/** Two points of the picture where the surface is seen, about its middle. */
async function clickTwice(page, click) {
  const box = await page.locator("#canvas").boundingBox();
  for (const side of [-1, 1]) await click(box.x + box.width / 2 + side * box.width * 0.06, box.y + box.height / 2 + side * box.height * 0.04);
}

const asPoint = ({ face, barycentric }) => ({ face, barycentric });

async function assertEqualToApi(browser, page) {
  const { from, to } = await read(page, "points");
  const mesh = (await read(page, "state")).meshes;
  const answer = await browser.ask("POST", `/v1/meshes/${mesh}/path`, { from: asPoint(from[0]), to: asPoint(to[0]) });
  assert.equal((await read(page, "last")).distance, answer.distance);
  assert.equal(await shown(page), answer.distance);
  assert.ok(answer.distance > 0);
}

async function firstPicture(browser) {
  const begun = performance.now();
  const page = await browser.page(`/#meshes=${browser.settings.large}`);
  await settle(page);
  const seconds = (performance.now() - begun) / 1000;
  const sizes = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name, encodedBodySize }) => [new URL(name).pathname, encodedBodySize]));
  const own = sizes.filter(([name]) => /\.(js|css|svg)$/.test(name)).reduce((sum, [, size]) => sum + size, 0);
  console.log(`# web: ${browser.settings.large} and its first path are seen ${seconds.toFixed(2)} s after the page was opened; ${(own / 1024).toFixed(0)} KiB of script and style`);
  await browser.picture(page, "first-desktop");
}

async function dropAndClick(browser) {
  const page = await browser.page("/");
  await settle(page);
  await drop(page, "octahedron.obj", OCTAHEDRON);
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

/** Seconds of processor time that the browser's processes and the daemon have taken. */
async function processorSeconds(browser) {
  const session = await browser.launched.newBrowserCDPSession();
  const { processInfo } = await session.send("SystemInfo.getProcessInfo");
  const fields = readFileSync(`/proc/${browser.settings.daemon}/stat`, "utf8").split(") ")[1].split(" ");
  return processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, (Number(fields[11]) + Number(fields[12])) / TICKS);
}

/** Drags the point in circles for a while: answers, and what they took of the clock and of the processors. */
async function circle(browser, page, { x, y }) {
  let answers = 0;
  page.on("response", (response) => (answers += /\/path(\?|$)/.test(response.url()) ? 1 : 0));
  await page.mouse.move(x, y);
  await page.mouse.down();
  const [begun, before] = [performance.now(), await processorSeconds(browser)];
  for (let turn = 0; performance.now() < begun + DRAG; turn += 0.05) {
    await page.mouse.move(x + RADIUS * (1 - Math.cos(turn)), y - RADIUS * Math.sin(turn));
    await sleep(MOUSE);
  }
  const seconds = (performance.now() - begun) / 1000;
  const taken = (await processorSeconds(browser)) - before;
  await page.mouse.up();
  return { rate: answers / seconds, cost: taken / answers };
}

/** As often as is wanted, or, where others use the machine at the same time, at a cost at which its processors would do so. */
async function drag(browser) {
  const { large } = browser.settings;
  const page = await browser.page(`/#meshes=${large}&mode=pair`, SMALL);
  await settle(page);
  const handle = await page.getByRole("button", { name: "End", exact: true }).boundingBox();
  const { rate, cost } = await circle(browser, page, { x: handle.x + handle.width / 2, y: handle.y + handle.height / 2 });
  await settle(page);
  const told = `${rate.toFixed(0)} answers a second, ${(1000 * cost).toFixed(0)} ms of processor time each with their pictures`;
  console.log(`# web: a point dragged on ${large}: ${told}`);
  assert.ok(rate >= LEAST_RATE || cost <= cpus().length / LEAST_RATE, told);
  await assertEqualToApi(browser, page);
  await browser.picture(page, "dragged");
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
  await page.waitForTimeout(URL_DELAY);
  const again = await browser.page("/" + new URL(page.url()).hash);
  await settle(again);
  assert.equal((await read(again, "last")).distance, distance);
  assert.deepEqual(await read(again, "state"), await read(page, "state"));
}

async function copyAsCurl(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=pair`);
  await settle(page);
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.getByRole("button", { name: "Copy as curl" }).click();
  const command = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(command, await read(page, "curl"));
  const answer = JSON.parse(execFileSync("sh", ["-c", command], { stdio: ["ignore", "pipe", "ignore"] }));
  assert.equal(answer.distance, (await read(page, "last")).distance);
}

async function problems(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 4\d\d/);
  await drop(page, "broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n");
  await page.locator("#error").filter({ hasText: /vertex|index/ }).waitFor();
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

/** Three triangles on one edge: refused, then mended at the press of a button. */
async function mended(browser) {
  const page = await browser.page("/");
  await settle(page);
  page.tolerate(/status of 422/);
  await drop(page, "fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
  const mend = page.getByRole("button", { name: "Mend and upload" });
  await mend.click();
  await page.waitForFunction(() => window.geodesicd.state.meshes === "fan");
  await settle(page);
  assert.equal(await mend.count(), 0);
  assert.ok((await browser.ask("GET", "/v1/meshes/fan")).repair.edges_split > 0);
}

export const tests = {
  "time to first picture": firstPicture,
  "a file is dropped, two clicks, the API's own length": dropAndClick,
  "a refused file is mended": mended,
  "a point is dragged": drag,
  "a link shows the same": link,
  "copy as curl": copyAsCurl,
  "a problem is told": problems,
  "a phone, by touch": phone,
  "accessible in light and dark": accessible,
  "themes": themes,
};
