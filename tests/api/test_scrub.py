"""Tests the scrub, which checks stored files in idle time. The scrub reads slowly, reports each
damage once, and accepts a repaired file. A backup restores lost files."""
import pathlib
import re
import shutil
import subprocess
import time
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, TETRAHEDRON, Daemon, Folder, sample

ASK = "/v1/meshes/{}/distance?from=v:0&to=v:2"


class Stored(Folder):
    def fill(self):
        with self.start() as daemon:
            for name, file in (("a", SQUARE), ("b", TETRAHEDRON), ("c", sample("torus"))):
                self.assertEqual(daemon.put(name, file).status, 201)
            return {name: daemon.get(ASK.format(name)).json["distance"] for name in "abc"}

    def object_of(self, name):
        manifest = (self.folder / f"manifests/{name}.manifest").read_text()
        sha256 = re.search(r'"sha256":"([0-9a-f]{64})"', manifest)[1]
        return self.folder / "objects" / sha256[:2] / sha256

    def damage(self, name):
        path = self.object_of(name)
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 4
        path.write_bytes(content)

    def wait_for_a_round(self, daemon):
        """Waits until two rounds have ended, so that the second round began after this call."""
        daemon.wait_for("scrub_rounds_total", daemon.metric("scrub_rounds_total") + 2)

    def faults(self, daemon):
        return [line for line in daemon.log if line["event"] == "scrub_fault"]


class Scrub(Stored):
    def test_an_intact_store_has_no_faults(self):
        self.fill()
        size = sum(path.stat().st_size for path in self.folder.glob("objects/*/*"))
        with self.start("--scrub-s", "2") as daemon:
            self.assertEqual(daemon.metric("scrub_end_timestamp_seconds"), 0)
            daemon.wait_for("scrub_rounds_total")
            self.assertEqual(daemon.metric("scrub_progress"), 1)
            self.assertEqual((daemon.metric("scrub_faults"), daemon.metric("store_damaged_files")), (0, 0))
            self.assertEqual(daemon.metric("scrub_files_total"), 3 * daemon.metric("scrub_rounds_total"))
            self.assertEqual(daemon.metric("scrub_bytes_total"), size * daemon.metric("scrub_rounds_total"))
            self.assertAlmostEqual(daemon.metric("scrub_end_timestamp_seconds"), time.time(), delta=10)
            self.assertEqual(self.faults(daemon), [])

    def test_damage_is_found_without_a_query_and_repaired_by_an_upload(self):
        answers = self.fill()
        self.damage("a")
        self.object_of("b").unlink()
        with self.start("--scrub-s", "1") as daemon:
            self.wait_for_a_round(daemon)
            found = {line["key"]: line["message"] for line in self.faults(daemon)}
            self.assertEqual(set(found), {"a", "b"})
            self.assertIn("SHA-256", found["a"])
            self.assertIn("is missing", found["b"])
            self.assertEqual((daemon.metric("scrub_faults"), daemon.metric("store_damaged_files")), (2, 1))
            for name in "ab":
                answer = daemon.get(ASK.format(name))
                self.assertEqual((answer.status, answer.json["code"]), (500, "internal"))
                self.assertIn("upload the mesh again", answer.json["detail"])
            self.assertEqual(daemon.get(ASK.format("c")).json["distance"], answers["c"])
            for name, file in (("a", SQUARE), ("b", TETRAHEDRON)):
                self.assertEqual(daemon.put(name, file).status, 200)
                self.assertEqual(daemon.get(ASK.format(name)).json["distance"], answers[name])
            self.wait_for_a_round(daemon)
            self.assertEqual((daemon.metric("scrub_faults"), daemon.metric("store_damaged_files")), (0, 0))

    def test_files_in_quarantine_are_not_read(self):
        self.fill()
        good = self.object_of("a").read_bytes()
        self.damage("a")
        with self.start("--scrub-s", "0") as daemon:
            self.assertEqual(daemon.get(ASK.format("a")).status, 500)
            self.assertEqual(daemon.metric("store_damaged_files"), 1)
            self.object_of("a").write_bytes(good)
            self.assertEqual(daemon.get(ASK.format("a")).status, 500)
            self.assertNotIn("geodesicd_scrub_", daemon.get("/metrics").body.decode())
            self.assertEqual(daemon.request("DELETE", "/v1/meshes/a").status, 204)
            self.assertEqual(daemon.metric("store_damaged_files"), 0)

    def test_a_scrub_is_slow_and_stops_at_once(self):
        self.fill()
        largest = max(path.stat().st_size for path in self.folder.glob("objects/*/*"))
        self.assertGreater(largest, 10 << 10)
        with self.start("--scrub-s", "1", "--scrub-rate", "1KiB") as daemon:
            daemon.wait_for("scrub_bytes_total", largest)
            time.sleep(2)  # the scrub pauses for ten seconds after it has read
            self.assertEqual(daemon.metric("scrub_rounds_total"), 0)
            self.assertLess(daemon.metric("scrub_progress"), 1)
            begun = time.monotonic()
            self.assertEqual(daemon.stop(), 0)
            self.assertLess(time.monotonic() - begun, 5)

    def test_a_store_in_memory_has_no_scrub(self):
        with Daemon("--scrub-s", "1") as daemon:
            daemon.put("a", SQUARE)
            self.assertNotIn("geodesicd_scrub_", daemon.get("/metrics").body.decode())


class Restore(Stored):
    def tool(self, folder, *flags):
        return subprocess.run([PROGRAM, "--data-dir", folder, *flags], capture_output=True, text=True, timeout=PATIENCE_SECONDS)

    def setUp(self):
        super().setUp()
        self.answers = self.fill()
        self.backup = pathlib.Path(self.place.name) / "backup"
        self.assertEqual(self.tool(self.folder, "--backup", self.backup).returncode, 0)

    def test_a_restore_brings_lost_files_back(self):
        shutil.rmtree(self.folder)
        result = self.tool(self.folder, "--restore", self.backup)
        self.assertEqual(result.returncode, 0, result)
        self.assertRegex(result.stdout, r"^3 surfaces, \d+ bytes, copied from ")
        for folder in (self.folder, self.backup):
            self.assertEqual(self.tool(folder, "--check-store").returncode, 0)
        for path in self.folder.glob("objects/*/*"):
            self.assertEqual(path.stat().st_nlink, 1, "the folders share blocks of the disk")
        with self.start() as daemon:
            for name, distance in self.answers.items():
                self.assertEqual(daemon.get(ASK.format(name)).json["distance"], distance)
            daemon.request("DELETE", "/v1/meshes/a")
        self.assertEqual(self.tool(self.backup, "--check-store").returncode, 0)

    def test_refusals(self):
        before = {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}
        result = self.tool(self.folder, "--restore", self.backup)
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds a data folder already", result.stdout)
        self.assertEqual({path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}, before)
        nowhere = self.tool(self.folder.parent / "new", "--restore", self.folder.parent / "nowhere")
        self.assertEqual(nowhere.returncode, 1)
        self.assertIn("there is no data folder at", nowhere.stdout)
        self.assertFalse((self.folder.parent / "new").exists())
        with Daemon("--data-dir", str(self.backup)):
            self.assertEqual(self.tool(self.folder.parent / "new", "--restore", self.backup).returncode, 1)

    def test_a_damaged_backup_is_reported(self):
        target = next(self.backup.glob("objects/*/*"))
        target.unlink()
        target.write_bytes(b"not what it was")
        result = self.tool(self.folder.parent / "new", "--restore", self.backup)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stdout, r"an uploaded file is damaged, or can't be copied: [abc]\n")


if __name__ == "__main__":
    unittest.main()
