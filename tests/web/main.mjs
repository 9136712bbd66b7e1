// Runs the tests in one browser, one after the other, each with its own page. Prints a line for
// each test in the format that tests/run.py reads.

import { Browser } from "./browser.mjs";
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
const browser = await Browser.open(settings);
let failed = 0;

async function run(name, test) {
  const begun = performance.now();
  const report = (verdict, more = "") => console.log(`${verdict} ${((performance.now() - begun) / 1000).toFixed(3)} s  web: ${name}${more}`);
  try {
    await test(browser);
    browser.assertQuiet();
    report("ok");
  } catch (error) {
    failed++;
    report("not ok", `\n${error.stack}`);
  }
  await browser.closePages();
}

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
for (const [group, tests] of Object.entries(groups)) {
  for (const [name, test] of Object.entries(tests)) {
    if (settings.only.some((word) => `${group}: ${name}`.includes(word))) await run(`${group}: ${name}`, test);
  }
}
await browser.close();
process.exitCode = failed ? 1 : 0;
