// Runs the tests in one browser, one after the other, each with a page of its own: a line a test, as tests/run.py reads them.

import { Browser } from "./browser.mjs";
import * as docs from "./docs.mjs";
import * as modes from "./modes.mjs";
import * as modules from "./modules.mjs";
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

for (const [group, tests] of Object.entries({ modules: modules.tests, viewer: viewer.tests, modes: await modes.tests(browser), docs: docs.tests })) {
  for (const [name, test] of Object.entries(tests)) {
    if (`${group}: ${name}`.includes(settings.only)) await run(`${group}: ${name}`, test);
  }
}
await browser.close();
process.exitCode = failed ? 1 : 0;
