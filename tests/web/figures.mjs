// Times of the viewer, measured by the page itself: first paint, ready, upload to the first path.
// The rates of drags are printed by the tests of the drags.

import assert from "node:assert/strict";
import { drop, settle } from "./viewer.mjs";

const MOST_PACKED = 220e3; /* bytes of script and style, as sent */

const seconds = (milliseconds) => `${(milliseconds / 1000).toFixed(2)} s`;

/**
 * Opens the page twice, because the time of a browser's first page includes the start of its
 * processes.
 */
async function opening(browser) {
  const { large } = browser.settings;
  await settle(await browser.page(`/#meshes=${large}`));
  const page = await browser.page(`/#meshes=${large}`);
  await page.waitForFunction(() => window.geodesicd);
  const ready = await page.evaluate(async () => {
    await window.geodesicd.ready;
    return performance.now();
  });
  await settle(page);
  const shown = await page.evaluate(() => performance.now());
  const [paint] = await page.evaluate(() =>
    performance.getEntriesByType("paint").map(({ startTime }) => startTime),
  );
  console.log(
    `# web: first paint after ${seconds(paint)}, ${large} ready after ${seconds(ready)}, its first path after ${seconds(shown)}`,
  );
  assert.ok(paint < ready);
}

/** Measures the time from the drop of a file on the page to the picture of the first path. */
async function upload(browser) {
  const { large, url } = browser.settings;
  const text = await (await fetch(`${url}/v1/meshes/${large}/content?format=obj`)).text();
  const page = await browser.page("/");
  await settle(page);
  await page.evaluate(() =>
    addEventListener("drop", () => (window.dropped = performance.now()), { capture: true }),
  );
  await drop(page, ["dropped.obj", text]);
  await page.waitForFunction(() => window.geodesicd.state.meshes === "dropped");
  const time = await page.evaluate(async () => {
    while (!window.geodesicd.last) await new Promise((resume) => setTimeout(resume, 5));
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
    return performance.now() - window.dropped;
  });
  console.log(`# web: ${large} uploaded and its first path seen after ${seconds(time)}`);
  await browser.ask("DELETE", "/v1/meshes/dropped");
}

/** All files of script and style that the viewer loads are small when packed. */
async function packed(browser) {
  const page = await browser.page(`/#meshes=${browser.settings.large}`);
  await settle(page);
  const sizes = await page.evaluate(() =>
    performance
      .getEntriesByType("resource")
      .map(({ name, encodedBodySize }) => [new URL(name).pathname, encodedBodySize]),
  );
  const own = sizes.filter(([name]) => /\.(js|css|svg)$/.test(name));
  const total = own.reduce((sum, [, size]) => sum + size, 0);
  console.log(`# web: ${(total / 1000).toFixed(1)} KB of script and style, packed`);
  assert.ok(own.some(([name]) => name === "/worker.js"));
  assert.ok(total <= MOST_PACKED, `${total} bytes`);
}

export const tests = {
  "the size of the files": packed,
};

export const longTests = {
  "first paint and ready": opening,
  "upload to path": upload,
};
