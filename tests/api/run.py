#!/usr/bin/env python3
"""Runs the API tests: one line for each test, a total, exit status 1 if any failed.

    tests/api/run.py [module or module.Class or module.Class.test ...]
"""
import importlib.util
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))

from reporting import run  # noqa: E402


def watch_the_contract():
    """Checks every answer against the contract, if its modules are installed. With
    GEODESICD_CONTRACT=0 only the tests of the contract check answers."""
    if importlib.util.find_spec("yaml") and importlib.util.find_spec("jsonschema"):
        os.environ.setdefault("GEODESICD_CONTRACT", "1")
    else:
        print("answers are not held against the contract: that takes python3-yaml and python3-jsonschema")


if __name__ == "__main__":
    watch_the_contract()
    sys.exit(run(HERE, sys.argv[1:]))
