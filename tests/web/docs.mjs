// The API's page: every operation of the contract is there, and its example works when it is tried out.

import assert from "node:assert/strict";
import { PATIENCE, PHONE } from "./browser.mjs";

const METHODS = ["head", "get", "put", "post", "delete"];
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

async function prepare(page) {
  await page.getByRole("button", { name: "Make what the examples speak of" }).click();
  await page.getByRole("status").filter({ hasText: "Made:" }).waitFor();
}

/** Opens the operation, executes it as it is filled in, and closes it: the status that the page shows. */
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
  if (browser.settings.all) page.setDefaultTimeout(6 * PATIENCE); // the page slows down as answers stay on it
  await prepare(page);
  const wanted = browser.settings.all ? ({ operationId }) => !ENDLESS.has(operationId) : ({ operationId }) => ONE_EACH.includes(operationId);
  const all = (await operations(browser)).filter(wanted);
  const byMethod = (wanted) => all.filter(({ method }) => method === wanted);
  const lastly = [...byMethod("delete").reverse(), ...byMethod("put")]; // an upload ends the fields of what was there
  const refused = [];
  for (const operation of [...all.filter((one) => !lastly.includes(one)), ...lastly]) {
    const status = await execute(page, operation).catch((error) => error.message.split("\n")[0]);
    if (!(status >= 200 && status < 300)) refused.push(`${operation.operationId}: ${status}`);
  }
  console.log(`# web: ${all.length} operations tried out on the page of the API`);
  assert.deepEqual(refused, []);
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

export const tests = {
  "every operation is there": complete,
  "examples work when they are tried out": tryOut,
  "accessible in light and dark": accessible,
  "fits a phone": phone,
};
