"""Tests the daemon in its sandbox, observed from outside. tests/unit/server/access/test_sandbox.c
tests which actions fail inside the sandbox."""
import pathlib
import platform
import socket
import subprocess
import tempfile
import unittest

from harness import PROGRAM, SQUARE, Daemon, Folder

ASK = "/v1/meshes/a/distance?from=v:0&to=v:2"


def states(daemon):
    return next((line for line in daemon.log if line["event"] == "sandbox"), None)


def setUpModule():
    with Daemon() as daemon:
        if not states(daemon):
            raise unittest.SkipTest("this build has a sanitizer, which needs more rights")


class Sandbox(Folder):
    def keygen(self, name):
        return subprocess.run([PROGRAM, "keygen", name], check=True, capture_output=True, text=True).stdout.splitlines()

    def threads(self, daemon):
        """Returns the status of each thread in /proc."""
        folder = pathlib.Path(f"/proc/{daemon.process.pid}/task")
        return [dict(line.split(":\t", 1) for line in (task / "status").read_text().splitlines() if ":\t" in line)
                for task in folder.iterdir()]

    def test_all_threads_are_in_the_sandbox(self):
        with self.start("--scrub-s", "1", "--workers", "2") as daemon:
            said = states(daemon)
            threads = self.threads(daemon)
            self.assertGreater(len(threads), 6)
            self.assertEqual({thread["NoNewPrivs"] for thread in threads}, {"1"})
            if said["seccomp"] == "on":
                self.assertEqual({thread["Seccomp"] for thread in threads}, {"2"})
        if platform.machine() in ("x86_64", "aarch64") and int(platform.release().split(".")[0]) >= 6:
            self.assertEqual(said["seccomp"], "on")

    def test_the_sandbox_can_be_switched_off(self):
        with self.start("--sandbox", "off") as daemon:
            self.assertIsNone(states(daemon))
            self.assertEqual({thread["Seccomp"] for thread in self.threads(daemon)}, {"0"})
            self.assertEqual({thread["NoNewPrivs"] for thread in self.threads(daemon)}, {"0"})

    def test_a_store_in_a_folder_to_be_made(self):
        self.folder = self.folder / "far" / "below"
        for times in range(2):
            with self.start("--persist-fields", "--scrub-s", "1") as daemon:
                self.assertEqual(daemon.put("a", SQUARE).status, (201, 200)[times])
                daemon.ask_often("a", "v:0")
                self.assertEqual(daemon.get(ASK).status, 200)
                daemon.wait_for("scrub_rounds_total")
                self.assertEqual(daemon.request("DELETE", "/v1/meshes/b").status, 404)
            self.assertEqual(len(list(self.folder.glob("fields/*/*.field"))), 1)
        with self.start() as daemon:
            self.assertEqual(daemon.request("DELETE", "/v1/meshes/a").status, 204)
        self.assertEqual(list(self.folder.glob("objects/*/*")), [])

    def test_keys_are_exchanged_by_a_new_file_in_the_place_of_the_old(self):
        keys = pathlib.Path(self.place.name) / "access" / "keys"
        keys.parent.mkdir()
        (first, line), (second, other) = self.keygen("a"), self.keygen("b")
        keys.write_text(line + "\n")
        with self.start("--keys", str(keys)) as daemon:
            self.assertEqual(daemon.get("/v1", Authorization=f"Bearer {first}").status, 200)
            (keys.parent / "new").write_text(other + "\n")
            (keys.parent / "new").rename(keys)
            daemon.reload()
            self.assertEqual(daemon.get("/v1", Authorization=f"Bearer {first}").status, 401)
            self.assertEqual(daemon.get("/v1", Authorization=f"Bearer {second}").status, 200)

    def test_unix_sockets_come_and_go(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "socket"
            stale = socket.socket(socket.AF_UNIX)
            stale.bind(str(path))  # a socket left by a dead process
            stale.close()
            with Daemon(listen=f"unix:{path}"):
                with socket.socket(socket.AF_UNIX) as client:
                    client.connect(str(path))
                    client.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
                    self.assertIn(b" 200 ", client.recv(4096))
            self.assertFalse(path.exists())


if __name__ == "__main__":
    unittest.main()
