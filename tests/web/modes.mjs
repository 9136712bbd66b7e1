// Tests each mode once on its default surface: an answer, no error, a picture at desktop and phone
// size.

import assert from "node:assert/strict";
import { DESKTOP, PHONE } from "./browser.mjs";
import { read, settle } from "./viewer.mjs";

/** Returns the modes that the page offers, so that a new mode is tested automatically. */
async function labels(browser) {
  const page = await browser.page("/");
  await settle(page);
  const found = await page.getByRole("group", { name: "What to ask for" }).getByRole("radio").all();
  const names = await Promise.all(found.map((radio) => radio.evaluate((node) => node.labels?.[0]?.textContent ?? node.getAttribute("aria-label"))));
  await browser.closePages();
  return names;
}

async function tryMode(browser, label) {
  for (const [size, window] of [["desktop", DESKTOP], ["phone", PHONE]]) {
    const page = await browser.page("/", window);
    await settle(page);
    await page.getByRole("radio", { name: label, exact: true }).check({ force: true });
    await settle(page);
    assert.equal(await page.locator("#notice .error").textContent(), "");
    assert.ok(await read(page, "last"), "there is no answer");
    assert.notEqual(await page.locator("#answer").textContent(), "");
    await browser.picture(page, `mode-${label.toLowerCase().replace(/[^a-z]+/g, "-")}-${size}`);
    if (size === "desktop") await browser.assertAccessible(page);
  }
}

export const tests = async (browser) => Object.fromEntries((await labels(browser)).map((label) => [label, (own) => tryMode(own, label)]));
