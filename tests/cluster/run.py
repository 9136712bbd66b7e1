#!/usr/bin/env python3
"""Runs the tests of daemons that share a PostgreSQL database; they skip without PostgreSQL.

    tests/cluster/run.py [--long] [module or module.Class or module.Class.test ...]
"""
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "api")]

from reporting import run  # noqa: E402

if __name__ == "__main__":
    if "--long" in sys.argv:
        os.environ["CLUSTER"] = "long"
    sys.exit(run(HERE, [name for name in sys.argv[1:] if name != "--long"]))
