// Runs groups of tests, one test after the other.

const MOST_CRASHES = 1; /* of the browser's process, in all groups */

/**
 * Runs the tests of all groups. Returns the number of failed tests. `open` starts a browser,
 * `empty` removes the surfaces that tests have left on the daemon, and `say` prints a line.
 *
 * The first time that the browser's own process ends, all tests of its group run again in a new
 * browser. The page's code runs in other processes: if one of these crashes, the test fails.
 */
export async function runGroups(groups, { open, empty, say }) {
  let browser = await open();
  let [failed, crashes] = [0, 0];

  /** Returns the name of the test in which the browser's process ended, if it may run again. */
  async function runGroup(tests) {
    for (const [name, test] of tests) {
      const begun = performance.now();
      const error = await errorOf(test, browser);
      if (error && !browser.isRunning && crashes++ < MOST_CRASHES) return name;
      const seconds = ((performance.now() - begun) / 1000).toFixed(3);
      say(`${error ? "not ok" : "ok"} ${seconds} s  web: ${name}${error ? `\n${error.stack}` : ""}`);
      failed += error ? 1 : 0;
    }
    return null;
  }

  for (const tests of groups) {
    for (let name = await runGroup(tests); name; name = await runGroup(tests)) {
      say(`# web: the browser's process ended during "${name}"; all tests of this group run again`);
      await empty();
      browser = await open();
    }
  }
  await browser.close();
  return failed;
}

/** Returns the error of a test, or null. */
async function errorOf(test, browser) {
  let found = null;
  try {
    await test(browser);
    browser.assertQuiet();
  } catch (error) {
    found = error;
  }
  try {
    await browser.closePages();
  } catch (error) {
    found ??= error;
  }
  return found;
}
