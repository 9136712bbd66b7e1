#!/usr/bin/env python3
"""Runs the API tests: one line a test, a total, exit status 1 if any failed.

    tests/api/run.py [module or module.Class or module.Class.test ...]
"""
import importlib.util
import os
import pathlib
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))


class LineResult(unittest.TestResult):
    def startTest(self, test):
        super().startTest(test)
        self.started = time.monotonic()

    def report(self, verdict, test):
        print(f"{verdict:5} {time.monotonic() - self.started:7.3f} s  {test.id()}", flush=True)

    def addSuccess(self, test):
        super().addSuccess(test)
        self.report("ok", test)

    def addFailure(self, test, error):
        super().addFailure(test, error)
        self.report("not ok", test)

    def addError(self, test, error):
        super().addError(test, error)
        self.started = getattr(self, "started", time.monotonic())
        self.report("not ok", test)

    def addSkip(self, test, reason):
        super().addSkip(test, reason)
        self.report("skip", test)

    def addSubTest(self, test, subtest, error):
        super().addSubTest(test, subtest, error)
        if error:
            self.report("not ok", subtest)


def watch_the_contract():
    """Every answer is held against the contract, if there is what that takes. GEODESICD_CONTRACT=0: only where a test is about it."""
    if importlib.util.find_spec("yaml") and importlib.util.find_spec("jsonschema"):
        os.environ.setdefault("GEODESICD_CONTRACT", "1")
    else:
        print("answers are not held against the contract: that takes python3-yaml and python3-jsonschema")


def main():
    watch_the_contract()
    loader = unittest.TestLoader()
    here = str(pathlib.Path(__file__).parent)
    suite = loader.loadTestsFromNames(sys.argv[1:]) if len(sys.argv) > 1 else loader.discover(here)
    result = LineResult()
    suite.run(result)
    for test, trace in result.failures + result.errors:
        print(f"\n{test.id()}\n{trace}")
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun} tests, {bad} failures")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
