// A browser and watched pages: an error on a page fails the current test.

import assert from "node:assert/strict";
import { createRequire } from "node:module";
import path from "node:path";

const FLAGS = [
  "--disable-gpu",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
export const DESKTOP = { viewport: { width: 1440, height: 900 } };
export const PHONE = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };
/** A message that the software renderer logs when the browser reads the canvas. */
const DRIVER_HINT = /GL Driver Message \(OpenGL, Performance/;
export const PATIENCE = 30000; /* milliseconds: a software renderer on a busy machine is slow */

export class Browser {
  static async open(settings) {
    const require = createRequire(path.join(settings.peers, "package.json"));
    const { chromium } = require("playwright-core");
    const launched = await chromium.launch({ executablePath: settings.browser, args: FLAGS, headless: true, chromiumSandbox: false });
    return new Browser(settings, launched, require("axe-core").source);
  }

  constructor(settings, launched, axe) {
    Object.assign(this, { settings, launched, axe, pages: [] });
  }

  /** False after the browser's process has ended. */
  get isRunning() {
    return this.launched.isConnected();
  }

  close() {
    return this.launched.close();
  }

  /** Opens a page at `target`, by default on the daemon, in its own window. */
  async page(target, window = DESKTOP) {
    const context = await this.launched.newContext({ ...window, reducedMotion: "reduce" });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const watched = { context, complaints: [], tolerated: [] };
    const complain = (text) => watched.complaints.push(text);
    page.on("pageerror", (error) => complain(`exception: ${error.stack}`));
    page.on("console", (message) => ["error", "warning"].includes(message.type()) && complain(`console: ${message.text()}`));
    page.on("request", (request) => /^(data|blob):/.test(request.url()) || [this.settings.url, this.settings.host].some((own) => request.url().startsWith(own)) || complain(`asked ${request.url()}`));
    await page.exposeFunction("complainOfPolicy", (text) => complain(`Content-Security-Policy: ${text}`));
    await page.addInitScript(() =>
      addEventListener("securitypolicyviolation", (event) => window.complainOfPolicy(`${event.violatedDirective} ${event.blockedURI} ${event.sample}`)),
    );
    this.pages.push(watched);
    page.tolerate = (pattern) => watched.tolerated.push(pattern);
    await page.goto(new URL(target, this.settings.url).href);
    return page;
  }

  async closePages() {
    for (const { context } of this.pages.splice(0)) await context.close();
  }

  /** Fails if a page has logged an error that its test does not tolerate. */
  assertQuiet() {
    for (const { complaints, tolerated } of this.pages) {
      const patterns = [DRIVER_HINT, ...tolerated];
      assert.deepEqual(complaints.filter((text) => !patterns.some((pattern) => pattern.test(text))), []);
    }
  }

  async picture(page, name) {
    await page.screenshot({ path: path.join(this.settings.place, `${name}.png`) });
  }

  /** Sends a request to the API directly; returns the JSON answer. */
  async ask(method, target, body) {
    const answer = await fetch(this.settings.url + target, {
      method,
      headers: body && { "Content-Type": "application/json" },
      body: body && JSON.stringify(body),
    });
    return answer.status === 204 ? null : answer.json();
  }

  /** Asserts that axe-core finds nothing serious, in light and in dark mode. */
  async assertAccessible(page, options = {}) {
    await page.evaluate(this.axe);
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      // One frame for the event, one for the drawing.
      await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
      const { violations } = await page.evaluate((given) => window.axe.run(given.context ?? document, { resultTypes: ["violations"], ...given.run }), options);
      const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      const told = serious.map(({ id, nodes }) => `${colorScheme}: ${id}: ${nodes.slice(0, 4).map((node) => `${node.html.slice(0, 120)} ${node.any[0]?.message ?? ""}`)}`);
      assert.deepEqual(told, []);
    }
  }
}
