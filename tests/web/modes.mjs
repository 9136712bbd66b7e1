// Changes to each mode, on its default surface, at desktop and phone size: an answer, no error, a
// picture. layout.mjs opens pages in each mode.

import assert from "node:assert/strict";
import { DESKTOP, PHONE } from "./browser.mjs";
import { read, settle } from "./viewer.mjs";

async function tryMode(browser, page, label, size) {
  const before = await page.locator("#answer").textContent();
  await page.getByRole("radio", { name: label, exact: true }).check({ force: true });
  await settle(page);
  assert.equal(await page.locator("#notice .error").textContent(), "");
  assert.ok(await read(page, "last"), "there is no answer");
  const answer = await page.locator("#answer").textContent();
  assert.notEqual(answer, "");
  assert.notEqual(answer, before);
  await browser.picture(page, `mode-${label.toLowerCase().replace(/[^a-z]+/g, "-")}-${size}`);
  if (size !== "desktop") return;
  await browser.assertAccessible(page);
  await page.emulateMedia({ colorScheme: null });
}

/** Tries all modes that the page offers, so that a new mode is tested automatically. */
async function tryAll(browser, size, window) {
  const page = await browser.page("/", window);
  await settle(page);
  const radios = page.getByRole("group", { name: "What to ask for" }).getByRole("radio");
  const labels = await radios.evaluateAll((all) => all.map((radio) => radio.labels?.[0]?.textContent ?? radio.getAttribute("aria-label")));
  assert.ok(labels.length >= 9, `the page offers ${labels}`);
  const failures = [];
  // the first mode comes last, because the page has opened in it
  for (const label of [...labels.slice(1), labels[0]]) {
    await tryMode(browser, page, label, size).catch((error) => failures.push(`${label}: ${error.stack}`));
  }
  assert.deepEqual(failures, []);
}

export const tests = {
  "on a desktop": (browser) => tryAll(browser, "desktop", DESKTOP),
  "on a phone": (browser) => tryAll(browser, "phone", PHONE),
};
