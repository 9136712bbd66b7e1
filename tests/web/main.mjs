// Runs the tests in one browser, one after the other, each with its own page. Prints a line for
// each test in the format that tests/run.py reads.

import { Browser } from "./browser.mjs";
import { runGroups } from "./groups.mjs";
import * as answers from "./answers.mjs";
import * as derive from "./derive.mjs";
import * as embed from "./embed.mjs";
import * as figures from "./figures.mjs";
import * as docs from "./docs.mjs";
import * as history from "./history.mjs";
import * as layout from "./layout.mjs";
import * as modes from "./modes.mjs";
import * as modules from "./modules.mjs";
import * as picture from "./picture.mjs";
import * as surfaces from "./surfaces.mjs";
import * as uploads from "./uploads.mjs";
import * as viewer from "./viewer.mjs";

const settings = JSON.parse(process.argv[2]);

const withLong = ({ tests, longTests }) => (settings.all ? { ...tests, ...longTests } : tests);

const groups = {
  modules: modules.tests,
  viewer: withLong(viewer),
  surfaces: surfaces.tests,
  uploads: uploads.tests,
  answers: answers.tests,
  history: history.tests,
  layout: layout.tests,
  picture: withLong(picture),
  derive: derive.tests,
  embed: embed.tests,
  modes: modes.tests,
  docs: docs.tests,
  figures: withLong(figures),
};
const chosen = Object.entries(groups).map(([group, tests]) =>
  Object.entries(tests)
    .map(([name, test]) => [`${group}: ${name}`, test])
    .filter(([name]) => settings.only.some((word) => name.includes(word))),
);

async function empty() {
  for (const kind of ["meshes", "subdivisions", "nurbs"]) {
    const list = (await (await fetch(`${settings.url}/v1/${kind}?limit=1000`)).json())[kind];
    for (const { name } of list.filter((surface) => surface.name !== settings.large))
      await fetch(`${settings.url}/v1/${kind}/${name}`, { method: "DELETE" });
  }
}

const failed = await runGroups(chosen, { open: () => Browser.open(settings), empty, say: console.log });
process.exitCode = failed ? 1 : 0;
