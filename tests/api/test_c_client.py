"""The C client: the scenario and its own functions, by scenario.c; its example."""
import os
import subprocess
import tempfile
import unittest

import scenario
from harness import PROGRAM, SQUARE, Daemon, TestCase

BUILD = PROGRAM.parent


class CClient(TestCase):
    def run_program(self, name, *arguments, **environment):
        done = subprocess.run([BUILD / name, *arguments], env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def run_scenario(self, url, *arguments):
        self.run_program("gd_client_scenario", url, str(scenario.CLIENTS / "scenario.json"), *arguments)

    def test_scenario(self):
        self.run_scenario("http://" + self.daemon.address)

    def test_unix_sockets(self):
        with tempfile.TemporaryDirectory() as folder, Daemon(listen="unix:" + folder + "/socket"):
            self.run_scenario("unix:" + folder + "/socket")

    def test_patience(self):
        with scenario.busy(*[(503, {"Retry-After": "0"}, {"code": "overloaded"})] * 3, (0, {}, {})) as (server, url):
            self.run_scenario(url, "busy")
            self.assertEqual(len(server.seen), 4)

    def test_example(self):
        path = BUILD / "client-example.obj"
        path.write_bytes(SQUARE)
        printed = self.run_program("gd_client_example", str(path), GEODESICD_URL="http://" + self.daemon.address)
        self.assertRegex(printed, r"distance: 0.70710678118654\d+, a path of \d points\nfarthest vertex: 2, 1.41421356237309\d+ away\n")


if __name__ == "__main__":
    unittest.main()
