"""Tests the C client by scenario.c: the scenario and the client's own functions. Also runs the
examples of all clients."""
import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import sys
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

    def test_requests_are_repeated_if_the_daemon_is_busy(self):
        with scenario.busy(*[(503, {"Retry-After": "0"}, {"code": "overloaded"})] * 3, (0, {}, {}), (503, {}, {}), (503, {"Retry-After": "86400"}, {}), (302, {}, {}), (200, {}, {}),
                           (200, {}, {})) as (server, url):
            self.run_program("gd_client_scenario", url, "", "busy", GEODESICD_KEY="key\n")
            self.assertEqual(len(server.seen), 9)
            self.assertEqual(set(server.keys), {"Bearer key"})
            self.assertEqual(server.paths[-1], "/v1/jobs/j?wait=5")  # half of the timeout
            # the client requests no compression from a daemon on the same machine
            self.assertEqual(set(server.codings), {None})

    def test_the_timeout_includes_the_connection(self):
        with socket.create_server(("127.0.0.1", 0), backlog=0) as full, contextlib.ExitStack() as others:
            for _ in range(3):  # the queue is then full, and a further connection stays pending
                other = others.enter_context(socket.socket())
                other.setblocking(False)
                other.connect_ex(full.getsockname())
            self.run_scenario("http://127.0.0.1:%d" % full.getsockname()[1], "silent")

    def test_cmake_finds_the_client(self):
        """Builds a C++ program against the installed client by cmake."""
        if not shutil.which("cmake"):
            raise unittest.SkipTest("cmake is not installed")
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            for name in ("geodesicd-client-config.cmake", "geodesicd-client-config-version.cmake"):
                text = (scenario.CLIENTS / "c" / f"{name}.in").read_text()
                (place / name).write_text(text.replace("@LIBDIR@", str(BUILD)).replace("@PREFIX@", folder).replace("@VERSION@", "0.1.0"))
            (place / "include").symlink_to(scenario.CLIENTS / "c")
            (place / "CMakeLists.txt").write_text("""
                cmake_minimum_required(VERSION 3.16)
                project(example LANGUAGES C CXX)
                find_package(geodesicd-client 0.1 REQUIRED CONFIG PATHS ${CMAKE_SOURCE_DIR} NO_DEFAULT_PATH)
                add_executable(example include/example.cc)
                target_compile_features(example PRIVATE cxx_std_17)
                target_link_libraries(example geodesicd::client)
            """)
            for arguments in (["-S", place, "-B", place / "build"], ["--build", place / "build"]):
                done = subprocess.run(["cmake", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
                self.assertEqual(done.returncode, 0, done.stdout)
            self.assertTrue((place / "build" / "example").exists())

    def test_headers_need_no_other_library(self):
        """The headers need no other library, compile as C99 and C++17 without extensions, and may
        be included twice."""
        for compiler, standard, language in (("cc", "c99", "c"), ("c++", "c++17", "c++")):
            header = "geodesicd.h" if language == "c" else "geodesicd.hpp"
            done = subprocess.run([compiler, f"-std={standard}", "-pedantic-errors", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", scenario.CLIENTS / "c",
                                   "-x", language, "-"], input=f'#include "{header}"\n' * 2, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            self.assertEqual(done.returncode, 0, done.stdout)
        included = [line.split()[1] for line in (scenario.CLIENTS / "c/geodesicd.h").read_text().splitlines() if line.startswith("#include")]
        self.assertEqual(included, ["<stddef.h>", "<stdint.h>"])


class Examples(TestCase):
    """One program in each language; all print the same."""

    def programs(self, folder):
        yield "C", [BUILD / "gd_client_example"]
        yield "C++", [BUILD / "gd_client_example_cc"]
        yield "Python", [sys.executable, scenario.CLIENTS / "python/example.py"]
        if shutil.which("node"):
            (folder / "node_modules").mkdir()
            (folder / "node_modules/geodesicd").symlink_to(scenario.CLIENTS / "js")
            shutil.copy(scenario.CLIENTS / "js/example.js", folder / "example.mjs")
            yield "JavaScript", ["node", folder / "example.mjs"]

    def test_examples(self):
        environment = {**os.environ, "GEODESICD_URL": "http://" + self.daemon.address, "PYTHONDONTWRITEBYTECODE": "1"}
        with tempfile.TemporaryDirectory() as folder:
            good, bad = pathlib.Path(folder) / "good.obj", pathlib.Path(folder) / "bad.obj"
            good.write_bytes(SQUARE)
            bad.write_text("v 0 0 0\nf 1 1 1\n")
            for language, program in self.programs(pathlib.Path(folder)):
                for path, status, printed in ((good, 0, "^0.707106781187 over 2 points\n$"), (bad, 1, ".")):
                    with self.subTest(f"{language}, {path.name}"):
                        done = subprocess.run([*program, path], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
                        self.assertEqual(done.returncode, status, done.stdout)
                        self.assertRegex(done.stdout, printed)


if __name__ == "__main__":
    unittest.main()
