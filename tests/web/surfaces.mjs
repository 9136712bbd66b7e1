// Surfaces that other clients change, loads that fail or overtake each other, browsers that block
// storage.

import assert from "node:assert/strict";
import { drop, hold, OCTAHEDRON, read, settle } from "./viewer.mjs";

const TETRAHEDRON = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const LONG = `${"long-name.".repeat(13).slice(0, 127)}x`; /* 128 characters, with dots */

const put = (browser, name, body = OCTAHEDRON) =>
  fetch(`${browser.settings.url}/v1/meshes/${name}`, { method: "PUT", body });

/** Runs a test with meshes of these names, and deletes them afterwards. */
const withMeshes = (names, test) => async (browser) => {
  for (const name of names) await put(browser, name);
  try {
    await test(browser);
  } finally {
    for (const name of names)
      await fetch(`${browser.settings.url}/v1/meshes/${name}`, { method: "DELETE" });
  }
};

async function open(browser, target, window) {
  const page = await browser.page(target, window);
  await settle(page);
  return page;
}

const shownMesh = async (page) => (await read(page, "state")).meshes;
const select = (page) => page.getByLabel("On the daemon");

async function nudge(page) {
  await page.getByRole("button", { name: "End", exact: true }).focus();
  await page.keyboard.press("Shift+ArrowRight");
  await settle(page);
}

/** A link to a missing mesh shows no old surface and no old answer. */
const missingLink = withMeshes(["here"], async (browser) => {
  const page = await open(browser, "/#meshes=here&mode=pair");
  page.tolerate(/status of 404/);
  assert.ok(await read(page, "last"));
  await page.evaluate(() => (location.hash = "meshes=gone&mode=field"));
  await page.locator("#loads .error").filter({ hasText: /does not have/ }).waitFor();
  await settle(page);
  assert.equal(await read(page, "last"), undefined);
  assert.equal(await shownMesh(page), undefined);
  assert.equal(await page.locator("#answer dd").count(), 0);
  assert.ok(await page.locator("#start").isVisible());
  await put(browser, "gone");
  await page.getByRole("button", { name: "Try again" }).click();
  await page.waitForFunction(() => window.geodesicd.state.meshes === "gone");
  await settle(page);
  assert.equal((await read(page, "state")).mode, "field");
  await browser.ask("DELETE", "/v1/meshes/gone");
});

/**
 * If the chosen surface is missing, the page keeps the open surface and its answer, and removes the
 * name from the list.
 */
const missingChoice = withMeshes(["here", "gone"], async (browser) => {
  const page = await open(browser, "/#meshes=here&mode=pair");
  page.tolerate(/status of 404/);
  const { distance } = await read(page, "last");
  await browser.ask("DELETE", "/v1/meshes/gone");
  await select(page).selectOption("meshes/gone");
  await page.locator("#loads .error").filter({ hasText: /does not have/ }).waitFor();
  await settle(page);
  assert.equal((await read(page, "last")).distance, distance);
  assert.ok(await page.locator("#answer dd.main").isVisible());
  assert.equal(await select(page).inputValue(), "meshes/here");
  await page.waitForFunction(() => !document.querySelector('option[value="meshes/gone"]'));
});

/**
 * If the user cancels a load, the open surface stays. If two surfaces load at the same time, the
 * page shows the surface chosen last.
 */
const overtaken = withMeshes(["slow", "quick"], async (browser) => {
  const page = await open(browser, "/#meshes=quick&mode=pair");
  const release = await hold(page, /\/slow\/content/);
  const asked = () => page.waitForRequest(/\/slow\/content/);
  await Promise.all([asked(), select(page).selectOption("meshes/slow")]);
  await page.locator("#busy").getByRole("button", { name: "Cancel" }).click();
  await settle(page);
  assert.equal(await select(page).inputValue(), "meshes/quick");
  assert.ok(await page.locator("#answer dd.main").isVisible());
  assert.match(await page.locator("#loads .error").textContent(), /cancelled/);
  await Promise.all([asked(), page.getByRole("button", { name: "Try again" }).click()]);
  await Promise.all([
    page.waitForResponse(/\/quick\/content/),
    select(page).selectOption("meshes/quick"),
  ]);
  release();
  await settle(page);
  assert.equal(await shownMesh(page), "quick");
  assert.equal(await page.locator("#busy").textContent(), "");
});

/** Undo of an edit ends the load of another surface. */
const undone = withMeshes(["slow", "quick"], async (browser) => {
  const page = await open(browser, "/#meshes=quick&mode=pair");
  await nudge(page);
  const release = await hold(page, /\/slow\/content/);
  await Promise.all([
    page.waitForRequest(/\/slow\/content/),
    select(page).selectOption("meshes/slow"),
  ]);
  await Promise.all([
    page.waitForRequest(/\/quick\/path/),
    page.getByRole("button", { name: "Undo" }).click(),
  ]);
  release();
  await settle(page);
  assert.equal(await shownMesh(page), "quick");
  assert.equal(await page.locator("#busy").textContent(), "");
});

/** A mode of the open surface ends the load of a surface of another kind. */
const otherMode = withMeshes(["here"], async (browser) => {
  const { url } = browser.settings;
  const body = JSON.stringify({ parametric: { torus: { major: 2, minor: 0.7 } } });
  await fetch(`${url}/v1/nurbs/ring`, { method: "PUT", body });
  const page = await open(browser, "/#meshes=here&mode=pair");
  const release = await hold(page, /\/nurbs\/.*\/evaluate/);
  const choose = (name) => page.getByRole("radio", { name, exact: true }).check({ force: true });
  await Promise.all([page.waitForRequest(/\/evaluate/), choose("NURBS")]);
  await choose("Shortest path");
  release();
  await settle(page);
  assert.equal(await shownMesh(page), "here");
  assert.equal(await page.locator("#busy").textContent(), "");
  await browser.ask("DELETE", "/v1/nurbs/ring");
});

/** If the script of the worker does not load, the page says so, and can try again. */
const worker = withMeshes(["here"], async (browser) => {
  const page = await browser.page("/icon.svg");
  page.tolerate(/status of 404|ERR_FAILED/); // the browser requests an icon for /icon.svg
  await page.route(/worker\.js/, (route) => route.abort());
  await page.goto(`${browser.settings.url}/#meshes=here&mode=pair`);
  await page.locator("#loads .error").filter({ hasText: /could not load/ }).waitFor();
  await page.unroute(/worker\.js/);
  await page.getByRole("button", { name: "Try again" }).click();
  await page.waitForFunction(() => window.geodesicd.last?.distance > 0);
});

const deleted = withMeshes(["lost"], async (browser) => {
  const page = await open(browser, "/#meshes=lost&mode=pair");
  page.tolerate(/status of 404/);
  page.on("dialog", (dialog) => dialog.accept());
  await browser.ask("DELETE", "/v1/meshes/lost");
  await nudge(page);
  assert.match(await page.locator("#notice .error").textContent(), /does not have this surface/);
  await page.waitForFunction(() => !document.querySelector('option[value="meshes/lost"]'));
  await page.getByRole("button", { name: "Delete", exact: true }).click();
  await page.locator("#start").waitFor();
  assert.equal(await shownMesh(page), undefined);
});

/** After another client has replaced the mesh, no answer mixes the two versions. */
const replaced = withMeshes(["swap"], async (browser) => {
  const page = await open(browser, "/#meshes=swap&mode=pair");
  page.tolerate(/status of 412/);
  await put(browser, "swap", TETRAHEDRON);
  await nudge(page);
  assert.match(await page.locator("#notice .error").textContent(), /has replaced this surface/);
  assert.equal(await read(page, "last"), undefined);
  assert.doesNotMatch(await read(page, "curl"), /If-Match/);
  await page.getByRole("button", { name: "Load it again" }).click();
  await page.locator("#surface-facts").filter({ hasText: "4 faces" }).waitFor();
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
});

/** The question about a taken name stays until it is answered, whatever else the page shows. */
const patient = withMeshes(["taken", "other"], async (browser) => {
  const page = await open(browser, "/#meshes=taken&mode=pair");
  page.tolerate(/status of 412/);
  await drop(page, ["taken.obj", TETRAHEDRON]);
  await page.getByRole("button", { name: "Replace taken" }).waitFor();
  await select(page).selectOption("meshes/other");
  await page.waitForFunction(() => window.geodesicd.state.meshes === "other");
  await page.getByRole("button", { name: "Do not upload" }).click();
  await settle(page);
  assert.equal(await page.locator("#uploads .error").filter({ hasText: /./ }).count(), 0);
});

/** If several files are refused, the page names each file with the reason. */
const refusals = withMeshes(["here"], async (browser) => {
  const page = await open(browser, "/#meshes=here&mode=pair");
  page.tolerate(/status of 422/);
  const bad = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n";
  await drop(page, ["first.obj", bad], ["second.obj", bad]);
  const errors = page.locator("#uploads .error").filter({ hasText: /./ });
  await errors.nth(1).waitFor();
  await settle(page);
  assert.match((await errors.allTextContents()).join("\n"), /first\.obj.*\n.*second\.obj/);
  assert.ok(await page.locator("#answer dd.main").isVisible());
  for (const left of [1, 0]) {
    await page.getByRole("button", { name: "Dismiss" }).first().click();
    assert.equal(await errors.count(), left);
  }
});

/** Browsers may block storage in frames of other sites. */
const blocked = withMeshes(["here"], async (browser) => {
  const page = await browser.page("/icon.svg");
  page.tolerate(/status of 404/); // the browser requests an icon for /icon.svg
  await page.addInitScript(() => {
    for (const name of ["localStorage", "sessionStorage"])
      Object.defineProperty(window, name, {
        get: () => {
          throw new DOMException("blocked", "SecurityError");
        },
      });
  });
  await page.goto(`${browser.settings.url}/#meshes=here&mode=pair`);
  await settle(page);
  assert.ok((await read(page, "last")).distance > 0);
  await page.getByRole("button", { name: "Dark" }).click();
});

/** A name of the greatest length fits into the page, and a name with a suffix is shortened. */
const longName = withMeshes([LONG], async (browser) => {
  for (const viewport of [{ width: 390, height: 844 }, { width: 1366, height: 768 }]) {
    const page = await open(browser, `/#meshes=${LONG}&mode=cut`, { viewport });
    assert.equal(await page.locator("#notice .error").textContent(), "");
    await page.getByText("Edit the mesh").click();
    const wide = await page.evaluate(() =>
      [...document.querySelectorAll("#panel *")].filter(
        (node) => node.getBoundingClientRect().right > innerWidth + 1 && !node.closest("#modes"),
      ).map((node) => node.outerHTML.slice(0, 80)),
    );
    assert.deepEqual(wide, []);
    await page.getByRole("button", { name: "Make a new mesh" }).click();
    await page.getByRole("button", { name: /^Open / }).waitFor();
    await browser.picture(page, `long-name-${viewport.width}`);
    const names = (await browser.ask("GET", "/v1/meshes?limit=1000")).meshes.map(({ name }) => name);
    const made = names.find((name) => name !== LONG && name.startsWith("long-name"));
    await browser.ask("DELETE", `/v1/meshes/${made}`);
    await browser.closePages();
  }
});

/** When the page gets the focus again, it offers the meshes that other clients have added. */
const added = withMeshes(["here"], async (browser) => {
  const page = await open(browser, "/#meshes=here&mode=pair");
  await put(browser, "added");
  await page.evaluate(() => dispatchEvent(new Event("focus")));
  await page.waitForFunction(() => document.querySelector('option[value="meshes/added"]'));
  await browser.ask("DELETE", "/v1/meshes/added");
});

export const tests = {
  "a link to a missing mesh": missingLink,
  "a choice that fails keeps the answer": missingChoice,
  "the surface chosen last is shown": overtaken,
  "undo ends a load": undone,
  "a mode of another kind ends a load": otherMode,
  "a worker that does not load": worker,
  "a mesh deleted by another client": deleted,
  "a mesh replaced by another client": replaced,
  "a mesh added by another client": added,
  "the choice about a taken name stays": patient,
  "each refused file is named": refusals,
  "a browser without storage": blocked,
  "a long name": longName,
};
