// The viewer in pages of other origins: <geodesic-viewer> and the three.js example, on a page of an
// origin that the daemon permits by --frame-ancestors and --cors-origin.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { OCTAHEDRON } from "./viewer.mjs";

const CLIENT = path.join(path.dirname(fileURLToPath(import.meta.url)), "../../clients/js");
const DAEMON = "http://127.0.0.1:8080"; /* the address in the example */

/** Serves files of these names, from the origin that the daemon permits, while `work` runs. */
async function withPage(browser, files, work) {
  const server = createServer((request, response) => {
    const name = request.url.slice(1) || "index.html";
    const type = name.endsWith(".js") ? "text/javascript" : "text/html";
    response.writeHead(name in files ? 200 : 404, { "Content-Type": type }).end(files[name]);
  });
  const { hostname, port } = new URL(browser.settings.host);
  await new Promise((resolve) => server.listen(Number(port), hostname, resolve));
  const { url } = browser.settings;
  await fetch(`${url}/v1/meshes/demo`, { method: "PUT", body: OCTAHEDRON });
  try {
    await work();
  } finally {
    await browser.closePages();
    server.closeAllConnections();
    await new Promise((resolve) => server.close(resolve));
    await browser.ask("DELETE", "/v1/meshes/demo");
  }
}

/** A page with the element, which collects the lengths of its answers. */
const elementPage = (url) => ({
  "viewer.js": readFileSync(path.join(CLIENT, "viewer.js")),
  "index.html": `<!doctype html><html lang="en"><link rel="icon" href="data:,">
    <script type="module" src="/viewer.js"></script>
    <geodesic-viewer server="${url}" mesh="demo" from="v:0" to="v:1"></geodesic-viewer>
    <script>window.lengths = [], window.errors = [];
      const viewer = document.querySelector("geodesic-viewer");
      viewer.addEventListener("answer", ({ detail }) => window.lengths.push(detail.length));
      viewer.addEventListener("error", ({ detail }) => window.errors.push(detail.message));
    </script>`,
});

const answered = (page, length) =>
  page.waitForFunction((wanted) => Math.abs(window.lengths.at(-1) - wanted) < 1e-12, length);

async function element(browser) {
  const { url, host } = browser.settings;
  await withPage(browser, elementPage(url), async () => {
    const length = async (to) =>
      (await browser.ask("GET", `/v1/meshes/demo/path?from=v:0&to=${to}`)).distance;
    const page = await browser.page(`${host}/`);
    await answered(page, await length("v:1"));
    const viewer = page.frames()[1];
    assert.ok(await viewer.locator("#canvas").isVisible());
    assert.ok(!(await viewer.locator("#panel").isVisible()));
    await page.evaluate(() => document.querySelector("geodesic-viewer").setAttribute("to", "v:2"));
    await answered(page, await length("v:2"));
    await browser.picture(page, "embedded");
    browser.assertQuiet();
  });
}

/**
 * If a mesh is missing, the outer page gets an error. The frame shows the error, without controls
 * for uploads.
 */
async function missing(browser) {
  const { url, host } = browser.settings;
  await withPage(browser, elementPage(url), async () => {
    const page = await browser.page(`${host}/`);
    page.tolerate(/status of 404/);
    await page.waitForFunction(() => window.lengths.length > 0);
    await page.evaluate(() => document.querySelector("geodesic-viewer").setAttribute("mesh", "no"));
    await page.waitForFunction(() => window.errors.length > 0);
    assert.match(await page.evaluate(() => window.errors[0]), /does not have this surface/);
    const viewer = page.frames()[1];
    assert.match(await viewer.locator("#trouble").textContent(), /does not have this surface/);
    assert.ok(!(await viewer.locator("#start").isVisible()));
    await page.evaluate(() => document.querySelector("geodesic-viewer").setAttribute("mesh", "demo"));
    await viewer.waitForFunction(() => !document.getElementById("trouble").textContent);
    browser.assertQuiet();
  });
}

/** The daemon refuses the frame in a page of an origin that it does not permit. */
async function otherOrigin(browser) {
  const { url, host } = browser.settings;
  await withPage(browser, elementPage(url), async () => {
    const page = await browser.page("about:blank");
    page.tolerate(/status of 403|frame-ancestors|asked http:\/\/localhost/);
    const refused = page.waitForResponse((response) => response.url().includes("embed=1"));
    await page.goto(host.replace("127.0.0.1", "localhost"));
    assert.equal((await refused).status(), 403);
    assert.deepEqual(await page.evaluate(() => window.lengths), []);
    browser.assertQuiet();
  });
}

/** The example of three.js, bundled with the packages of the viewer. */
function example({ pages, url }) {
  const { buildSync } = createRequire(path.join(pages, "package.json"))("esbuild");
  const [{ text }] = buildSync({
    stdin: {
      contents: readFileSync(path.join(CLIENT, "example-three.js"), "utf8").replace(DAEMON, url),
      resolveDir: CLIENT,
    },
    alias: { geodesicd: path.join(CLIENT, "index.js") },
    bundle: true,
    format: "esm",
    nodePaths: [path.join(pages, "node_modules")],
    write: false,
  }).outputFiles;
  return text;
}

async function threeExample(browser) {
  const { settings } = browser;
  const html = `<!doctype html><html lang="en"><link rel="icon" href="data:,">
    <style>body { margin: 0 }</style><canvas></canvas>
    <script type="module" src="/example.js"></script>`;
  const files = { "index.html": html, "example.js": example(settings) };
  await withPage(browser, files, async () => {
    const page = await browser.page(`${settings.host}/`, { viewport: { width: 320, height: 320 } });
    const paths = [];
    page.on("response", (response) => /\/path(\?|$)/.test(response.url()) && paths.push(response));
    for (let x = 130; paths.length < 2; x = 130 + ((x + 7) % 60)) {
      await page.mouse.move(x, 160);
      await page.waitForTimeout(50);
    }
    assert.ok(paths.every((response) => response.ok()));
    await browser.picture(page, "three-example");
    browser.assertQuiet();
  });
}

export const tests = {
  "an element in a page of another origin": element,
  "an element for a missing mesh": missing,
  "no frame in a page that is not permitted": otherOrigin,
  "a path follows the mouse in three.js": threeExample,
};
