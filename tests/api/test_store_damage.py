"""Tests data folders that are damaged, shared with other programs, or from an earlier version."""
import concurrent.futures
import contextlib
import hashlib
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import tarfile
import unittest

from harness import SQUARE, TETRAHEDRON, Daemon, form_tag, wait_until
from stored import Stored
from test_batches import begin, wait

HERE = pathlib.Path(__file__).resolve().parent


class Damage(Stored):
    def fill(self):
        with self.start() as daemon:
            for name, file in (("a", SQUARE), ("b", TETRAHEDRON)):
                daemon.put(name, file)
            return {name: daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:2").body for name in "ab"}

    def test_a_missing_folder_is_an_error_for_the_operator(self):
        with self.start() as daemon:
            for folder, name in (("manifests", "a"), ("objects", "b")):
                away = self.folder / (folder + "-away")
                (self.folder / folder).rename(away)
                answer = daemon.put(name, SQUARE)
                self.assertEqual((answer.status, answer.json["code"]), (507, "insufficient_storage"), answer)
                self.assertIn("tell its operator", answer.json["detail"])
                self.assertEqual(daemon.get(f"/v1/meshes/{name}").status, 404)
                away.rename(self.folder / folder)
                self.assertEqual(daemon.put(name, SQUARE).status, 201)
            self.assertEqual(len([line for line in daemon.log if line.get("event") == "store_refused" and "No such file" in line["message"]]), 2)

    def test_a_removed_folder_shows_in_readyz(self):
        away = self.folder.with_name("away")
        self.fill()
        with self.start() as daemon:
            self.assertEqual(daemon.get("/readyz").json, {"status": "ok"})
            for what in (self.folder, self.folder / "objects", self.folder / "geodesicd.db"):
                what.rename(away)
                told = daemon.get("/readyz").json
                self.assertEqual(told["status"], "read_only", what)
                self.assertIn("was removed or replaced", told["reason"])
                self.assertEqual(daemon.metric("store_writable"), 0)
                away.rename(what)
                self.assertEqual(daemon.get("/readyz").json, {"status": "ok"}, what)
            self.folder.rename(away)
            shutil.copytree(away, self.folder)
            self.assertEqual(daemon.get("/readyz").json["status"], "read_only", "another folder in its place")
            shutil.rmtree(self.folder)
            away.rename(self.folder)
            wait_until(lambda: self.events(daemon).count("store_missing") == 7)

    def test_no_second_daemon_where_the_lock_was_removed(self):
        with self.start() as daemon:
            (self.folder / "lock").unlink()
            with self.assertRaisesRegex(RuntimeError, "is in use by another geodesicd"):
                self.start()
            self.assertIn("is in use by another geodesicd", self.tool("--check-store").stdout)
            self.assertEqual(daemon.put("a", SQUARE).status, 201)

    def test_all_files_are_private(self):
        self.folder.mkdir()
        mask = os.umask(0)
        try:
            for _ in range(2):
                with self.start("--persist-fields") as daemon:
                    daemon.put("sphere", SQUARE)
                    begin(daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": [0, 1]})
                    daemon.ask_often("sphere", "v:0")
                    daemon.get("/v1/meshes/sphere/distance?from=v:0&to=v:2")
                modes = {path: path.stat().st_mode & 0o77 for path in self.folder.rglob("*")}
                self.assertEqual([path for path, mode in modes.items() if mode], [])
                self.assertGreater(len(list(self.folder.glob("fields/*/*"))), 0)
                for name in ("geodesicd.db", "batches.db"):
                    (self.folder / name).chmod(0o644)  # earlier versions set this mode
        finally:
            os.umask(mask)

    def test_a_damaged_database_of_batches_is_set_aside(self):
        ask = {"query": "all-pairs", "mesh": "a", "vertices": [0, 1]}
        self.fill()
        with self.start() as daemon:
            self.assertEqual(begin(daemon, ask).status, 201)
        damages = {"its head": lambda path: self.flip(path, 0), "its root page": lambda path: self.flip(path, 101 / path.stat().st_size),
                   "all of it": lambda path: path.write_bytes(b"x" * 8192)}
        for number, (what, damage) in enumerate(damages.items()):
            damage(self.folder / "batches.db")
            with self.start() as daemon:
                self.assertEqual(self.events(daemon).count("batches_damaged"), 1, what)
                self.assertEqual(len(list(self.folder.glob("batches.db.damaged-*"))), number + 1)
                self.assertEqual(daemon.get("/readyz").json, {"status": "ok"})
                self.assertEqual(daemon.get("/v1/batches").json["batches"], [])
                self.assertEqual(wait(daemon, begin(daemon, ask).json["id"])["done"], 2)
                self.assertEqual(daemon.get("/v1/meshes").status, 200)

    def test_a_database_of_batches_that_cannot_be_opened_shows_in_readyz(self):
        self.fill()
        (self.folder / "batches.db").mkdir()
        with self.start() as daemon:
            told = daemon.get("/readyz").json
            self.assertEqual((told["status"], "batches" in told["reason"]), ("read_only", True), told)
            self.assertEqual(self.events(daemon).count("batches_unavailable"), 1)
            self.assertEqual(daemon.put("c", SQUARE).status, 201)
            (self.folder / "batches.db").rmdir()
            self.assertEqual(daemon.get("/v1/batches").status, 200)
            self.assertEqual(daemon.get("/readyz").json, {"status": "ok"})

    def test_a_damaged_file_makes_one_mesh_unavailable_until_the_next_upload(self):
        answers = self.fill()
        sha = json.loads(subprocess.run(["sed", "-n", "s/^description //p", self.folder / "manifests/a.manifest"],
                                        capture_output=True, check=True).stdout)["sha256"]
        self.flip(self.folder / "objects" / sha[:2] / sha)
        check = self.tool("--check-store")
        self.assertEqual(check.returncode, 1)
        self.assertIn("damaged or can't be read: a", check.stdout)
        with self.start() as daemon:
            answer = daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2")
            self.assertEqual((answer.status, answer.json["code"]), (500, "internal"))
            self.assertIn("upload the mesh again", answer.json["detail"])
            self.assertEqual(daemon.get("/v1/meshes/b/distance?from=v:0&to=v:2").body, answers["b"])
            self.assertEqual(daemon.get("/v1/meshes/a").status, 200)
            self.assertEqual(daemon.put("a", SQUARE).status, 200)
            self.assertEqual(daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2").body, answers["a"])
        self.assertEqual(self.tool("--check-store").returncode, 0)
        (self.folder / "objects" / sha[:2] / sha).unlink()
        with self.start() as daemon:
            answer = daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2")
            self.assertEqual((answer.status, answer.json["code"]), (500, "internal"))
            self.assertEqual(daemon.put("a", SQUARE).status, 200)

    def test_uploading_a_damaged_file_again_while_its_mesh_is_in_memory(self):
        with self.start() as daemon:
            daemon.put("a", SQUARE)
            answer = daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2").body
            for damage in (self.flip, pathlib.Path.unlink, lambda path: os.truncate(path, 3)):
                damage(self.objects()[0])
                self.assertEqual(daemon.put("a", SQUARE).status, 200)
                self.assertEqual(self.objects()[0].read_bytes(), SQUARE)
            self.assertEqual(daemon.metric("mesh_loads_total"), 0)
            self.assertEqual(daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2").body, answer)

    def test_the_same_is_sent_again_while_the_name_changes(self):
        """While the file of a mesh is checked, another upload may replace the mesh's record."""
        with self.start("--workers", "2") as daemon:
            files = (SQUARE, TETRAHEDRON)
            with concurrent.futures.ThreadPoolExecutor(6) as pool:
                answers = list(pool.map(lambda i: daemon.put("a", files[i // 3 % 2]), range(300)))
            self.assertEqual({answer.status for answer in answers} - {200, 201}, set())
            last = daemon.get("/v1/meshes/a").json
            daemon.ask_often("a", "v:0")
            self.assertEqual(daemon.get("/v1/meshes/a/distance?from=v:0&to=v:1").status, 200)
            self.assertEqual(daemon.get("/v1/meshes/a").json["fields_cached"], 1, "the cached fields are gone")
        with self.start() as daemon:
            self.assertEqual(daemon.get("/v1/meshes/a").json["sha256"], last["sha256"])

    def test_a_damaged_database_is_made_again(self):
        answers = self.fill()
        for damage in (lambda path: self.flip(path, 0.01), lambda path: path.write_bytes(b"no database at all" * 300),
                       lambda path: path.unlink(), lambda path: path.write_bytes(path.read_bytes()[:5000])):
            damage(self.folder / "geodesicd.db")
            with self.start() as daemon:
                for name, answer in answers.items():
                    self.assertEqual(daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:2").body, answer)
            self.assertEqual(self.tool("--check-store").returncode, 0)
        self.assertTrue(list(self.folder.glob("geodesicd.db.damaged-*")))

    def test_a_damaged_or_missing_manifest_is_written_again(self):
        answers = self.fill()
        for damage in (self.flip, pathlib.Path.unlink, lambda path: path.write_bytes(b"")):
            damage(self.folder / "manifests/a.manifest")
            self.assertEqual(self.tool("--check-store").returncode, 1)
            with self.start() as daemon:
                self.assertIn("store_mended", self.events(daemon))
                self.assertEqual(daemon.get("/v1/meshes/a/distance?from=v:0&to=v:2").body, answers["a"])
            self.assertEqual(self.tool("--check-store").returncode, 0)

    def test_a_later_version_is_respected(self):
        for later in ((b"geodesicd record 2\n", b"geodesicd record 4\n"), (b"kind mesh\n", b"kind dodecahedron\n")):
            self.fill()
            path = self.folder / "manifests/a.manifest"
            body = path.read_bytes().replace(*later)
            body = body[: body.rindex(b"checksum ")]
            path.write_bytes(body + b"checksum " + hashlib.sha256(body).hexdigest().encode() + b"\n")
            result = self.tool("--listen", "127.0.0.1:0")
            self.assertEqual(result.returncode, 1)
            self.assertIn("later version", result.stderr)
            shutil.rmtree(self.folder)


class Earlier(Stored):
    """Tests a data folder of the version that had only meshes. The folder has two meshes. Only one
    of them was used."""
    QUAD = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
    ETAGS = {"b.c": "8f4dfe45ae4ca44551131943695e5ea4", "square": "b63e441c952b3224dec8e246512b0075"}

    def setUp(self):
        super().setUp()
        with tarfile.open(HERE.parent / "data/store-1.tar.gz") as archive:
            archive.extractall(self.folder)

    def query(self, database, sql):
        connection = sqlite3.connect(f"file:{self.folder / database}?mode=ro", uri=True)
        with contextlib.closing(connection):
            return connection.execute(sql).fetchall()

    def assert_serves_both(self, daemon):
        meshes = {mesh["name"]: mesh for mesh in daemon.get("/v1/meshes").json["meshes"]}
        self.assertEqual({name: mesh["etag"] for name, mesh in meshes.items()}, self.ETAGS)
        self.assertEqual(meshes["b.c"]["created"], "2026-11-21T20:58:06Z")
        answer = daemon.get("/v1/meshes/square/distance?from=v:0&to=v:2")
        self.assertEqual((answer.status, answer.headers["ETag"]), (200, form_tag(f'"{self.ETAGS["square"]}"', "json")))
        self.assertAlmostEqual(answer.json["distance"], 2 ** 0.5, 14)
        self.assertEqual(daemon.get("/v1/meshes/b.c/distance?from=v:0&to=v:3").json["distance"], 1)

    def test_an_old_store_is_checked_and_copied_unchanged(self):
        copy = pathlib.Path(self.place.name) / "copy"
        for folder in (self.folder, copy):
            check = self.tool("--check-store", folder=folder)
            self.assertEqual((check.returncode, check.stderr), (0, ""), check)
            self.assertRegex(check.stdout, r"^2 manifests, 2 rows, 2 files \(106 bytes\), 0 fields verified: 0 faults\n$")
            if folder == self.folder:
                backup = self.tool("--backup", copy)
                self.assertEqual(backup.returncode, 0, backup)
        self.assertEqual(self.query("geodesicd.db", "PRAGMA user_version"), [(1,)])
        with Daemon("--data-dir", str(copy)) as daemon:
            self.assert_serves_both(daemon)

    def test_an_old_store_is_migrated_after_a_copy(self):
        before = self.query("geodesicd.db", "SELECT name, sha256, record, uses, used FROM surfaces")
        self.assertGreater(sum(row[3] for row in before), 0, "nothing was used")
        with self.start() as daemon:
            self.assert_serves_both(daemon)
            self.assertNotIn("store_mended", self.events(daemon))
            self.assertNotIn("store_database_damaged", self.events(daemon))
        self.assertEqual(self.query("geodesicd.db", "PRAGMA user_version"), [(2,)])
        self.assertEqual(self.query("geodesicd.db.before-migration", "PRAGMA user_version"), [(1,)])
        self.assertEqual(
            self.query("geodesicd.db.before-migration", "SELECT name, sha256, record, uses, used FROM surfaces"), before)
        after = self.query("geodesicd.db", "SELECT key, file, record FROM surfaces")
        self.assertEqual(after, [row[:3] for row in before])
        self.assertEqual(self.tool("--check-store").returncode, 0)

    def test_an_old_store_works_like_a_new_one(self):
        with self.start() as daemon:
            known = self.ETAGS["square"]
            self.assertEqual(daemon.put("square", self.QUAD, If_Match='"other"').status, 412)
            same = daemon.put("square", self.QUAD, If_Match=f'"{known}"')
            self.assertEqual((same.status, same.headers["ETag"]), (200, f'"{known}"'))
            self.assertEqual(same.json["created"], "2026-11-21T20:58:06Z")
            self.assertEqual(daemon.put("b.c", SQUARE).status, 200)
            self.assertEqual(daemon.put("new", TETRAHEDRON).status, 201)
            self.assertEqual(daemon.request("DELETE", "/v1/meshes/square").status, 204)
        with self.start() as daemon:
            self.assertEqual([mesh["name"] for mesh in daemon.get("/v1/meshes").json["meshes"]], ["b.c", "new"])
            self.assertEqual(daemon.get("/v1/meshes/b.c/distance?from=v:0&to=v:2").status, 200)
        self.assertEqual(self.tool("--check-store").returncode, 0)

    def test_manifests_of_an_old_store_suffice(self):
        for damage in (pathlib.Path.unlink, lambda path: path.write_bytes(b"no database at all" * 300)):
            damage(self.folder / "geodesicd.db")
            with self.start() as daemon:
                self.assert_serves_both(daemon)
            self.assertEqual(self.tool("--check-store").returncode, 0)

    def test_rows_of_an_old_store_suffice(self):
        for path in self.folder.glob("manifests/*"):
            path.unlink()
        with self.start() as daemon:
            self.assertEqual(self.events(daemon).count("store_mended"), 2)
            self.assert_serves_both(daemon)
        self.assertEqual(self.tool("--check-store").returncode, 0)


if __name__ == "__main__":
    unittest.main()
