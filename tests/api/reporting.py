"""Finds and runs tests and reports them: one line for each test, and a total."""
import time
import unittest


class LineResult(unittest.TestResult):
    def startTest(self, test):
        super().startTest(test)
        self.started = time.monotonic()

    def report(self, verdict, test, reason=""):
        now = time.monotonic()
        # `started` is missing if a whole class failed or was skipped
        print(f"{verdict:5} {now - getattr(self, 'started', now):7.3f} s  {test.id()}" + (f": {reason}" if reason else ""), flush=True)

    def addSuccess(self, test):
        super().addSuccess(test)
        self.report("ok", test)

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self.report("not ok", test)

    def addError(self, test, error):
        super().addError(test, error)
        self.report("not ok", test)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.report("skip", test, reason)

    def addSubTest(self, test, subtest, error):
        super().addSubTest(test, subtest, error)
        if error:
            self.report("not ok", subtest)


def run(folder, names):
    """Runs the tests of these names, or all tests of the folder. Returns the exit status: 1 if any
    failed."""
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(names) if names else loader.discover(str(folder))
    result = LineResult()
    suite.run(result)
    for test, trace in result.failures + result.errors:
        print(f"\n{test.id()}\n{trace}")
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun} tests, {bad} failures")
    return 1 if bad else 0
