#!/usr/bin/env python3
"""Runs the tests of daemons that share a PostgreSQL database; they skip without PostgreSQL.

    tests/cluster/run.py [--long] [module or module.Class or module.Class.test ...]
"""
import importlib.util
import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "api")]


def reporter():
    """tests/api/run.py, for how it reports a test."""
    found = importlib.util.spec_from_file_location("api_run", HERE.parent / "api" / "run.py")
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module.LineResult()


def main():
    names = [name for name in sys.argv[1:] if name != "--long"]
    if "--long" in sys.argv:
        os.environ["CLUSTER"] = "long"
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(names) if names else loader.discover(str(HERE))
    result = reporter()
    suite.run(result)
    for test, trace in result.failures + result.errors:
        print(f"\n{test.id()}\n{trace}")
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun} tests, {bad} failures")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
