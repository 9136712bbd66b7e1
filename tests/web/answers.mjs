// Answers and their absence: incomplete points, refusals, a daemon that is busy, locked or stopped.

import assert from "node:assert/strict";
import { assertRate, hold, OCTAHEDRON, putSample, read, settle, SMALL } from "./viewer.mjs";

const LEAST_FIELDS = 8; /* fields a second while a source is dragged */

const open = async (browser, mode = "pair") => {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=${mode}`);
  await settle(page);
  return page;
};

async function clickMiddle(page) {
  const box = await page.locator("#canvas").boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
}

/** A third click removes both points and sets a new A, so the old answer must disappear. */
async function thirdClick(browser) {
  const page = await open(browser);
  await clickMiddle(page);
  await settle(page);
  const { from, to } = await read(page, "points");
  assert.deepEqual([from.length, to.length], [1, 0]);
  assert.equal(await page.locator("#answer dd.main").count(), 0);
  assert.equal(await page.locator("#readout").textContent(), "");
  assert.equal(await read(page, "curl"), "");
  assert.equal(await read(page, "last"), undefined);
}

const problem = (status, code, detail) => ({
  status,
  contentType: "application/problem+json",
  body: JSON.stringify({ status, code, detail }),
});

/** Answers queries of paths with this problem until the returned function is called. */
async function refuse(page, answer) {
  const handler = (route) => (answer ? route.fulfill(answer) : route.abort());
  await page.route(/\/path\?/, handler);
  return () => page.unroute(/\/path\?/, handler);
}

async function nudge(page) {
  await page.getByRole("button", { name: "End", exact: true }).focus();
  await page.keyboard.press("Shift+ArrowRight");
  await settle(page);
}

/** After a refusal nothing of the old answer is left, and the refused request can be copied. */
async function refusal(browser) {
  const page = await open(browser);
  page.tolerate(/status of 400/);
  const before = await read(page, "curl");
  await refuse(page, problem(400, "invalid_request", "the weights of the point are not numbers"));
  await nudge(page);
  assert.match(await page.locator("#notice .error").textContent(), /the weights of the point are not/i);
  assert.equal(await page.locator("#answer dd.main").count(), 0);
  assert.equal(await read(page, "last"), undefined);
  assert.notEqual(await read(page, "curl"), before);
  assert.match(await read(page, "curl"), /\/path\?/);
}

const busy = (seconds) => ({ ...problem(503, "overloaded", "the queue is full"), headers: { "Retry-After": `${seconds}` } });

/** Answers, their messages, and the number of requests if it is not 1. */
const CAUSES = [
  [problem(401, "unauthorized", "no key"), /access key/],
  [problem(404, "not_found", "there is no mesh of this name"), /does not have this surface/],
  [problem(503, "overloaded", "the queue is full"), /busy/],
  [busy(0), /busy/, 5],
  [busy(86400), /busy/],
  [problem(504, "deadline_exceeded", "the deadline passed"), /longer than the daemon permits/],
  [{ contentType: "application/json", body: '{"dist' }, /does not answer/],
  [null, /does not answer/],
];

async function retries(browser) {
  const page = await open(browser);
  page.tolerate(/status of (401|404|503|504)|ERR_FAILED/);
  let requests = 0;
  page.on("request", (request) => (requests += /\/path\?/.test(request.url()) ? 1 : 0));
  for (const [answer, sentence, count = 1] of CAUSES) {
    requests = 0;
    const permit = await refuse(page, answer);
    await nudge(page);
    assert.match(await page.locator("#notice .error").textContent(), sentence);
    assert.equal(requests, count);
    await permit();
    await page.getByRole("button", { name: "Try again" }).click();
    await settle(page);
    assert.equal(await page.locator("#notice .error").textContent(), "");
    assert.ok((await read(page, "last")).distance > 0);
  }
}

/** While the daemon is busy, the page waits and repeats the request. The user can end the wait. */
async function wait(browser) {
  const page = await open(browser);
  page.tolerate(/status of 503/);
  let [left, seconds] = [1, 9];
  await page.route(/\/path\?/, (route) => (left-- > 0 ? route.fulfill(busy(seconds)) : route.continue()));
  await page.getByRole("button", { name: "End", exact: true }).press("Shift+ArrowRight");
  const message = page.locator("#busy").filter({ hasText: /Next try in 9 s/ });
  await message.waitFor();
  await browser.picture(page, "busy-daemon");
  await message.getByRole("button", { name: "Cancel" }).click();
  await settle(page);
  assert.match(await page.locator("#notice .error").textContent(), /busy/);
  assert.equal(await page.locator("#busy").textContent(), "");
  [left, seconds] = [2, 0];
  await nudge(page);
  assert.equal(await page.locator("#notice .error").textContent(), "");
}

/** If the user cancels a question, the answer for the former points disappears. */
async function cancelled(browser) {
  const page = await open(browser);
  const release = await hold(page, /\/path\?/);
  await page.getByRole("button", { name: "End", exact: true }).focus();
  await page.keyboard.press("Shift+ArrowRight");
  await page.locator("#answer[aria-busy=true]").waitFor();
  await page.getByRole("button", { name: "Cancel" }).click();
  await settle(page);
  assert.equal(await page.locator("#answer").getAttribute("aria-busy"), "false");
  assert.match(await page.locator("#notice .error").textContent(), /cancelled/);
  assert.equal(await page.locator("#answer dd").count(), 0);
  release();
  await page.getByRole("button", { name: "Try again" }).click();
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
}

/** The pieces of a cut are not shown after the user has moved a point or changed the mode. */
async function lateCut(browser) {
  await putSample(browser, "ring", "torus", "columns=60", "rows=30");
  const changes = [
    (page) => page.getByRole("button", { name: "Point 1", exact: true }).press("Shift+ArrowRight"),
    (page) => page.getByRole("radio", { name: "Shortest path" }).check({ force: true }),
  ];
  for (const change of changes) {
    const page = await browser.page("/#meshes=ring&mode=cut");
    await settle(page);
    const release = await hold(page, /\/ring-\d+\/content/);
    await Promise.all([
      page.waitForRequest(/\/ring-\d+\/content/),
      page.getByRole("button", { name: "Cut", exact: true }).click(),
    ]);
    await change(page);
    release();
    await page.waitForLoadState("networkidle");
    await settle(page);
    assert.equal(await page.locator(".piece").count(), 0);
    assert.ok(await page.locator("#handles").isVisible());
    assert.ok(await read(page, "last"));
    await page.close();
  }
  const { meshes } = await browser.ask("GET", "/v1/meshes?limit=1000");
  for (const { name } of meshes.filter((mesh) => /^ring(-\d+)?$/.test(mesh.name)))
    await browser.ask("DELETE", `/v1/meshes/${name}`);
}

/** If the user removes the points, the progress of a question about them disappears. */
async function removedPoints(browser) {
  const page = await open(browser, "set");
  const body = 'data: {"state": "running", "progress": 0.5}\n\n';
  await page.route(/\/events$/, (route) => route.fulfill({ contentType: "text/event-stream", body }));
  await page.getByRole("button", { name: "Spread points evenly" }).click();
  await page.locator("#notice progress").waitFor();
  await page.locator("#points summary").click();
  await page.getByRole("button", { name: "Remove all points" }).click();
  await page.locator("#notice progress").waitFor({ state: "hidden" });
}

/** When the cursor leaves the picture, the page requests no more values for the legend. */
async function leftPicture(browser) {
  const page = await open(browser, "field");
  await hold(page, /\/evaluate/);
  let count = 0;
  page.on("request", (request) => (count += /\/evaluate/.test(request.url()) ? 1 : 0));
  const { x, y, width, height } = await page.locator("#canvas").boundingBox();
  for (const step of [0, 4, 8]) await page.mouse.move(x + width / 2 + step, y + height / 2);
  await page.mouse.move(x + width + 50, y + height / 2);
  await page.evaluate(() => fetch("/livez"));
  assert.equal(count, 1);
  assert.ok(await page.locator(".needle").isHidden());
}

/** If the stream of a job breaks, the page opens it again. */
async function brokenStream(browser) {
  const page = await open(browser);
  page.tolerate(/ERR_CONNECTION_RESET/);
  let streams = 0;
  page.on("request", (request) => (streams += request.url().endsWith("/events") ? 1 : 0));
  await page.route(/\/events$/, (route) => route.abort("connectionreset"), { times: 1 });
  await page.getByRole("radio", { name: "Distance field" }).check({ force: true });
  await page.waitForFunction(() => window.geodesicd.last?.max > 0);
  assert.equal(await page.locator("#notice .error").textContent(), "");
  assert.equal(streams, 2);
}

/** Without the role operator, metrics omit the memory. The page shows the reason, not zeros. */
async function hiddenMemory(browser) {
  const page = await open(browser);
  await page.route(/\/metrics/, (route) => route.fulfill({ body: "geodesicd_jobs 0\n" }));
  await page.locator("#service summary").click();
  await page.locator("#service").getByText("role operator").waitFor();
  assert.equal(await page.locator("#service dd").count(), 0);
}

/** Requests cannot send a key with characters beyond ASCII, so the page does not accept one. */
async function wrongKey(browser) {
  const page = await open(browser);
  await page.locator("#access summary").click();
  await page.locator("#key").fill("\u201cgdk_key\u201d");
  await page.keyboard.press("Enter");
  assert.ok(!(await page.locator("#key").evaluate((input) => input.validity.valid)));
  await page.locator("#key").fill(" gdk_key ");
  assert.ok(await page.locator("#key").evaluate((input) => input.validity.valid));
  assert.equal(await page.locator("#loads .error").textContent(), "");
}

/** A field follows the drag on a mesh of this size, and no request of the drag is a job. */
async function fieldDrag(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}&mode=field`, SMALL);
  await settle(page);
  const jobs = [];
  let lines = 0;
  page.on("request", (request) => request.headers()["prefer"] && jobs.push(request.url()));
  page.on("response", (response) => (lines += /\/isolines/.test(response.url()) ? 1 : 0));
  const check = () => {
    assert.deepEqual(jobs, []);
    assert.equal(lines, 0);
  };
  const values = { name: "Source", pattern: /\/pairs\?/, least: LEAST_FIELDS };
  await assertRate(browser, page, { ...values, check });
  await browser.picture(page, "field-dragged");
}

/**
 * While a dragged point is beside the surface, the previous answer stays without an error. If the
 * drag ends there, the refusal is shown.
 */
async function missed(browser) {
  const page = await open(browser);
  page.tolerate(/status of 422/);
  const box = await page.getByRole("button", { name: "End", exact: true }).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await refuse(page, problem(422, "point_not_on_surface", "the ray does not meet the surface"));
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 12, y);
  await settle(page);
  assert.equal(await page.locator("#notice .error").textContent(), "");
  assert.ok(await page.locator("#answer dd.main").isVisible());
  await page.mouse.up();
  await settle(page);
  assert.match(await page.locator("#notice .error").textContent(), /does not meet/);
}

/**
 * The cut locus of a corner of an octahedron: the four edges at the opposite corner. The octahedron
 * is too small for single precision. A drag of the corner shows distances that are not zero.
 */
async function cutLocus(browser) {
  const { url } = browser.settings;
  const body = OCTAHEDRON.replace(/^v .*$/gm, (row) => row.replace("1", "1e-60"));
  await fetch(`${url}/v1/meshes/octahedron`, { method: "PUT", body });
  const page = await browser.page("/#meshes=octahedron&mode=field&source=v:0&locus=true");
  await settle(page);
  const { lines } = await read(page, "last");
  const length = lines.reduce((sum, line) => sum + line.length, 0);
  assert.ok(Math.abs(1e60 * length - 4 * Math.SQRT2) < 1e-12, `${length}`);
  await page.locator("#download summary").click();
  await page.getByRole("button", { name: "Download Cut locus OBJ" }).waitFor();
  await browser.picture(page, "cut-locus");
  const box = await page.getByRole("button", { name: "Source", exact: true }).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x - 20, box.y + box.height / 2);
  await page.locator("#answer dt").filter({ hasText: "Farthest vertex" }).waitFor();
  const farthest = Number(await page.locator("#answer dd.main").getAttribute("title"));
  assert.ok(farthest > 2e-60 && farthest < 3e-60, `${farthest}`);
  await browser.ask("DELETE", "/v1/meshes/octahedron");
}

export const tests = {
  "a third click removes the answer": thirdClick,
  "a refusal removes the answer": refusal,
  "a drag beside the surface keeps the answer": missed,
  "a retry repeats the query": retries,
  "a busy daemon": wait,
  "a cancelled question leaves no answer": cancelled,
  "a late cut is not shown": lateCut,
  "progress ends with the points": removedPoints,
  "a value of the legend ends with the cursor": leftPicture,
  "a broken stream is opened again": brokenStream,
  "a key that no request can send": wrongKey,
  "a key that does not see the memory": hiddenMemory,
  "a field follows a drag without jobs": fieldDrag,
  "the cut locus of a source": cutLocus,
};
