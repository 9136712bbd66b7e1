// The page of the API: it lists every operation of the contract, and each example works.

import assert from "node:assert/strict";
import { PATIENCE, PHONE } from "./browser.mjs";

const METHODS = ["head", "get", "put", "post", "patch", "delete"];
const ONE_EACH = ["get_livez", "put_mesh", "get_path", "get_picture_png", "post_distance", "put_nurbs", "post_subdivision_trace"];
const ENDLESS = new Set(["get_job_events"]); /* streams, which the page shows when they end */

async function open(browser, window) {
  const page = await browser.page("/docs", window);
  await page.locator(".opblock").first().waitFor();
  return page;
}

async function operations(browser) {
  const { paths } = await browser.ask("GET", "/openapi.json");
  return Object.values(paths).flatMap((item) => METHODS.filter((method) => item[method]).map((method) => ({ method, ...item[method] })));
}

async function complete(browser) {
  const page = await open(browser);
  assert.equal(await page.locator(".opblock").count(), (await operations(browser)).length);
  await browser.picture(page, "docs-desktop");
}

/**
 * Creates the example data. Surfaces of an earlier test still exist, so the page's uploads of the
 * same names end with 412.
 */
async function prepare(page) {
  page.tolerate(/status of 412/);
  await page.getByRole("button", { name: "Create example data" }).click();
  await page.getByRole("status").filter({ hasText: "Created:" }).waitFor();
}

/**
 * Opens the operation, executes it with its default values, and closes it. Returns the status that
 * the page shows.
 */
async function execute(page, { operationId, tags }) {
  const block = page.locator(`[id="operations-${tags[0]}-${operationId}"]`);
  await block.locator(".opblock-summary-control").click();
  await block.getByRole("button", { name: "Execute" }).click();
  const status = await block.locator(".live-responses-table tbody .response-col_status").first().textContent();
  await block.locator(".opblock-summary-control").click();
  return Number.parseInt(status, 10);
}

async function tryOut(browser) {
  const page = await open(browser);
  // the page slows down as answers stay on it
  if (browser.settings.all) page.setDefaultTimeout(6 * PATIENCE);
  await prepare(page);
  const wanted = browser.settings.all ? ({ operationId }) => !ENDLESS.has(operationId) : ({ operationId }) => ONE_EACH.includes(operationId);
  const all = (await operations(browser)).filter(wanted);
  const byMethod = (wanted) => all.filter(({ method }) => method === wanted);
  // an upload deletes the fields of the replaced mesh
  const lastly = [...byMethod("delete").reverse(), ...byMethod("put")];
  const refused = [];
  for (const operation of [...all.filter((one) => !lastly.includes(one)), ...lastly]) {
    const status = await execute(page, operation).catch((error) => error.message.split("\n")[0]);
    if (!(status >= 200 && status < 300)) refused.push(`${operation.operationId}: ${status}`);
  }
  console.log(`# web: ${all.length} operations tried out on the page of the API`);
  assert.deepEqual(refused, []);
}

/**
 * Executes operations before the button has created the example data. The page then creates the
 * data itself.
 */
async function firstUse(browser) {
  const page = await open(browser);
  const all = await operations(browser);
  for (const id of ["get_path", "get_field", "get_job"]) {
    const operation = all.find(({ operationId }) => operationId === id);
    assert.equal(await execute(page, operation), 200, id);
  }
}

async function conventions(browser) {
  const page = await open(browser);
  const first = await page.locator(".opblock").first().boundingBox();
  assert.ok(first.y < 900, `the first operation is ${first.y} pixels down the page`);
  await page.getByRole("button", { name: "Conventions" }).click();
  await page.locator(".info .description").waitFor({ state: "visible" });
}

async function accessible(browser) {
  const page = await open(browser);
  await browser.assertAccessible(page);
  const block = page.locator("#operations-queries-get_path");
  await block.locator(".opblock-summary-control").click();
  await block.getByRole("button", { name: "Execute" }).waitFor();
  await browser.assertAccessible(page);
  await browser.picture(page, "docs-operation-dark");
}

async function phone(browser) {
  const page = await open(browser, PHONE);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  await browser.picture(page, "docs-phone");
  assert.ok(wide <= 0, `the page is ${wide} pixels wider than the phone`);
}

const DOCUMENTS = ["tutorial", "how-to", "reference", "explanation", "operating", "comparison"];

/**
 * The drawings of each document load, and each document is accessible in light and dark mode and
 * fits a phone.
 */
async function documents(browser) {
  for (const name of DOCUMENTS) {
    const page = await browser.page(`/docs/${name}`);
    const loaded = await page.evaluate(() => [...document.images].map((image) => image.naturalWidth > 0));
    assert.ok(loaded.every(Boolean), `a drawing of ${name} did not load`);
    await browser.assertAccessible(page);
    await browser.picture(page, `document-${name}`);
    const narrow = await browser.page(`/docs/${name}`, PHONE);
    const wide = await narrow.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(wide <= 0, `${name} is ${wide} pixels wider than the phone`);
    await narrow.close();
  }
}

export const tests = {
  "documents are accessible, with drawings, and fit a phone": documents,
  "every operation is listed": complete,
  "an example works on first use": firstUse,
  "conventions are folded": conventions,
  "examples work when they are tried out": tryOut,
  "accessible in light and dark": accessible,
  "fits a phone": phone,
};
