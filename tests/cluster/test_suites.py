"""Runs the suites of stores and queues over PostgreSQL. tests/unit runs the same suites over the
local implementations."""
import os
import re
import subprocess
import unittest

import cluster
from test_nodes import Shared, setUpModule  # noqa: F401  (skips without PostgreSQL)


class Suites(Shared):
    def run_suite(self, name):
        program = cluster.BUILD / "tests" / "unit" / "server" / name
        if not program.exists():
            self.skipTest(f"{program} is not built: make test-build")
        done = subprocess.run([program], env={**os.environ, "GEODESICD_TEST_STORE": self.database.url, "CMOCKA_MESSAGE_OUTPUT": "TAP"},
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotRegex(done.stdout, re.compile(r"^(not )?ok.*# SKIP", re.M))

    def test_stores(self):
        self.run_suite("store/test_store")

    def test_queues_of_batches(self):
        self.run_suite("jobs/test_batch_queue")


if __name__ == "__main__":
    unittest.main()
