// The pixels of the picture.

import assert from "node:assert/strict";
import { putSample, settle } from "./viewer.mjs";

const FINE = ["torus", "columns=500", "rows=250"]; /* 250,000 faces, drawn without a preview */
const DENSE = ["torus", "columns=1050", "rows=524"]; /* 1.1 million faces */
const PATH = [228, 87, 46];
const NEAR = 24; /* of 255, in each channel */

/** Returns the number of pixels whose colour is near `colour`, and the number of reddish pixels. */
async function countPixels(page, colour) {
  const png = (await page.locator("#canvas").screenshot()).toString("base64");
  return page.evaluate(
    async ([base64, [r, g, b], near]) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const image = await createImageBitmap(new Blob([bytes]));
      const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      let [same, reddish] = [0, 0];
      for (let i = 0; i < data.length; i += 4) {
        const off = Math.max(
          Math.abs(data[i] - r),
          Math.abs(data[i + 1] - g),
          Math.abs(data[i + 2] - b),
        );
        same += off < near ? 1 : 0;
        reddish += data[i] > data[i + 2] + 15 ? 1 : 0;
      }
      return { same, reddish };
    },
    [png, colour, NEAR],
  );
}

const BLOCKS = [60, 40]; /* blocks into which pictures are averaged before they are compared */

/** Returns the mean colours of the picture's blocks. */
async function blocksOf(page) {
  const png = (await page.locator("#canvas").screenshot()).toString("base64");
  return page.evaluate(
    async ([base64, [width, height]]) => {
      const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      const size = { resizeWidth: width, resizeHeight: height, resizeQuality: "high" };
      const image = await createImageBitmap(new Blob([bytes]), size);
      const context = new OffscreenCanvas(width, height).getContext("2d");
      context.drawImage(image, 0, 0);
      return [...context.getImageData(0, 0, width, height).data];
    },
    [png, BLOCKS],
  );
}

const difference = (a, b) => a.reduce((sum, x, i) => sum + Math.abs(x - b[i]), 0) / a.length;

/**
 * During a drag, the page recolours pixels without drawing triangles. The picture must equal a new
 * drawing.
 */
async function recoloured(browser) {
  const { large } = browser.settings;
  const target = `/#meshes=${large}&mode=field&shadow=false&isolines=0`;
  const page = await browser.page(target, { viewport: { width: 960, height: 640 } });
  await settle(page);
  await page.evaluate(() => (document.getElementById("handles").style.opacity = 0));
  const first = await blocksOf(page);
  const box = await page.getByRole("button", { name: "Source", exact: true }).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (const step of [20, 40, 60, 80]) {
    await page.mouse.move(x + step, y);
    await settle(page);
  }
  const held = await blocksOf(page);
  await browser.picture(page, "recoloured");
  await page.mouse.up();
  await settle(page);
  const drawn = await blocksOf(page);
  const [moved, off] = [difference(first, drawn), difference(held, drawn)];
  assert.ok(off < moved / 4, `the drag's picture is off by ${off}, the one before by ${moved}`);
}

/**
 * A path on the far side of a dense surface shines through faintly, whatever its number of
 * segments.
 */
async function hiddenLines(browser, torus) {
  await putSample(browser, "dense", ...torus);
  const points = "from=p:0.9,-0.5,-0.4&to=p:0.9,0.5,-0.4";
  const page = await browser.page(
    `/#meshes=dense&mode=pair&${points}&up=z&shadow=false&camera=0.3,0.3,3,0,0,0`,
  );
  page.setDefaultTimeout(120000);
  page.tolerate(/status of 404/); // 404: a daemon without previews
  await settle(page);
  await page.evaluate(() => (document.getElementById("handles").hidden = true));
  await browser.picture(page, "hidden-line");
  const { same, reddish } = await countPixels(page, PATH);
  assert.ok(reddish > 200, `${reddish} pixels of the path`);
  assert.ok(same < 20, `${same} of ${reddish} pixels of the hidden path are opaque`);
  await browser.ask("DELETE", "/v1/meshes/dense");
}

export const tests = {
  "recoloured pixels equal a new drawing": recoloured,
  "hidden lines on 250,000 faces": (browser) => hiddenLines(browser, FINE),
};

export const longTests = {
  "hidden lines on 1.1 million faces": (browser) => hiddenLines(browser, DENSE),
};
