"""Tests the guarantees of a durable store: conditions, restarts, memory, a warm cache, the
operator's tools."""
import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import unittest

from harness import SQUARE, TETRAHEDRON, Daemon, TestCase, form_tag, header_fields, sample, wait_until
from stored import Stored
from test_batches import begin, results, wait


class Conditions(TestCase):
    def test_reads_with_if_none_match(self):
        mesh = self.daemon.put("known", SQUARE).headers["ETag"]
        for path, form in (("", None), ("/content", "obj"), ("/content?format=ply", "ply"), ("/distance?from=v:0&to=v:2", "json"),
                           ("/path?from=v:0&to=v:2", "json"), ("/nearest?point=p:0,0,1", "json")):
            url, etag = f"/v1/meshes/known{path}", form_tag(mesh, form) if form else mesh
            self.assertEqual(self.daemon.get(url).headers["ETag"], etag, path)
            for known in (etag, f"W/{etag}", f'"other", {etag}', f'W/"x" , W/{etag}', "*"):
                answer = self.daemon.get(url, If_None_Match=known)
                self.assertEqual((answer.status, answer.body, answer.headers["ETag"]), (304, b"", etag), (path, known))
            for other in ('"other"', etag.strip('"'), 'W/"x", "y"'):
                self.assertEqual(self.daemon.get(url, If_None_Match=other).status, 200, (path, other))

    def test_reads_with_if_match(self):
        etag = self.daemon.put("version", SQUARE).headers["ETag"]
        for path in ("", "/content", "/distance?from=v:0&to=v:2"):
            url = f"/v1/meshes/version{path}"
            self.assertEqual(self.daemon.get(url, If_Match=etag).status, 200)
            self.assert_problem(self.daemon.get(url, If_Match=f"W/{etag}"), 412, "precondition_failed")
            self.assert_problem(self.daemon.get(url, If_Match='"other"'), 412, "precondition_failed")

    def test_an_error_is_an_error_whatever_the_conditions(self):
        etag = form_tag(self.daemon.put("wrong", SQUARE).headers["ETag"], "json")
        answer = self.daemon.get("/v1/meshes/wrong/distance?from=v:0&to=v:9", If_None_Match=etag)
        self.assert_problem(answer, 400, "invalid_request")
        self.assert_problem(self.daemon.get("/v1/meshes/nobody", If_None_Match="*"), 404, "not_found")

    def test_changes_with_conditions(self):
        put, delete = self.daemon.put, lambda name, **headers: self.daemon.request(
            "DELETE", f"/v1/meshes/{name}", headers=header_fields(headers))
        etag = put("written", SQUARE, If_None_Match="*").headers["ETag"]
        self.assert_problem(put("written", SQUARE, If_None_Match="*"), 412, "precondition_failed")
        self.assert_problem(put("written", TETRAHEDRON, If_Match=f"W/{etag}"), 412, "precondition_failed")
        self.assert_problem(put("written", TETRAHEDRON, If_None_Match=f'"x", {etag}'), 412, "precondition_failed")
        second = put("written", TETRAHEDRON, If_Match=f'"x", {etag}').headers["ETag"]
        self.assertNotEqual(etag, second)
        self.assert_problem(delete("written", If_Match=etag), 412, "precondition_failed")
        self.assert_problem(delete("written", If_None_Match=second), 412, "precondition_failed")
        self.assertEqual(delete("written", If_Match=second).status, 204)
        self.assert_problem(delete("written", If_Match="*"), 404, "not_found")


class Race(Stored):
    def test_one_of_many_conditional_writes_wins(self):
        files = [sample("grid", columns=4 + i, rows=4) for i in range(8)]
        with self.start("--workers", "4") as daemon:
            etag = daemon.put("raced", SQUARE).headers["ETag"]
            with concurrent.futures.ThreadPoolExecutor(8) as pool:
                answers = list(pool.map(lambda file: daemon.put("raced", file, If_Match=etag), files))
            self.assertEqual(sorted(answer.status for answer in answers), [200] + [412] * 7)
            winner = next(answer for answer in answers if answer.status == 200)
            self.assertEqual(daemon.get("/v1/meshes/raced").json["sha256"], winner.json["sha256"])


class Restart(Stored):
    def test_everything_is_there_again(self):
        files = {"a": SQUARE, "b.c": TETRAHEDRON, "same": SQUARE, "torus": sample("torus")}
        with self.start() as daemon:
            before = {name: daemon.put(name, file).json for name, file in files.items()}
            daemon.put("gone", SQUARE)
            daemon.request("DELETE", "/v1/meshes/gone")
            daemon.put("torus", sample("torus"), "?triangulate=false&weld=1e-9&repair=split")
            before["torus"] = daemon.get("/v1/meshes/torus").json
            distance = daemon.get("/v1/meshes/torus/distance?from=v:0&to=v:9").body
            content = daemon.get("/v1/meshes/torus/content").body
        with self.start() as daemon:
            after = {mesh["name"]: mesh for mesh in daemon.get("/v1/meshes").json["meshes"]}
            for mesh in (*before.values(), *after.values()):
                mesh.pop("fields_cached")
            self.assertEqual(after, before)
            self.assertEqual(daemon.get("/v1/meshes/torus/distance?from=v:0&to=v:9").body, distance)
            self.assertEqual(daemon.get("/v1/meshes/torus/content").body, content)
            self.assertEqual(daemon.put("a", SQUARE).status, 200)
            self.assertEqual(daemon.put("a", SQUARE, If_None_Match="*").status, 412)
            self.assertEqual(daemon.request("DELETE", "/v1/meshes/a").status, 204)
            self.assertEqual(daemon.get("/v1/meshes/same/distance?from=v:0&to=v:2").status, 200)
        with self.start() as daemon:
            self.assertEqual(daemon.get("/v1/meshes/a").status, 404)
            self.assertEqual(daemon.get("/v1/meshes/same/content").status, 200)

    def test_one_daemon_for_each_folder(self):
        with self.start():
            second = self.tool("--listen", "127.0.0.1:0")
            self.assertEqual(second.returncode, 1)
            self.assertIn("in use by another geodesicd", second.stderr)

    def test_simultaneous_requests_share_one_load(self):
        with self.start() as daemon:
            for i in range(3):
                daemon.put(f"m{i}", sample("icosphere", level=4 + i % 2))
        with self.start("--workers", "2") as daemon:
            def ask(number):
                return daemon.get(f"/v1/meshes/m{number % 3}/distance?from=v:0&to=v:100")
            with concurrent.futures.ThreadPoolExecutor(30) as pool:
                answers = list(pool.map(ask, range(30)))
            self.assertEqual({answer.status for answer in answers}, {200})
            self.assertEqual(daemon.metric("mesh_loads_total"), 3)

    def test_a_description_needs_no_load(self):
        with self.start() as daemon:
            for i in range(20):
                daemon.put(f"m{i:02}", sample("icosphere", level=4))
        # no mesh fits into memory
        with self.start("--memory-budget", "2MiB", "--max-body", "1MiB") as daemon:
            self.assertEqual(len(daemon.get("/v1/meshes").json["meshes"]), 20)
            self.assertEqual(daemon.get("/v1/meshes/m07").json["vertices"], 2562)
            self.assertEqual(daemon.metric("mesh_loads_total"), 0)
            self.assertEqual(daemon.get("/v1/meshes/m07/distance?from=v:0&to=v:1").json["code"], "insufficient_memory")

    def test_the_most_used_surfaces_are_loaded_first(self):
        with self.start() as daemon:
            for name in ("cold", "hot", "warm"):
                size = daemon.put(name, sample("icosphere", level=5)).json["memory_bytes"]
            for name, times in (("hot", 9), ("warm", 3)):
                for _ in range(times):
                    daemon.get(f"/v1/meshes/{name}/nearest?point=p:0,0,1")
        with self.start() as daemon:  # all meshes fit into memory
            self.assertEqual(daemon.wait_for("mesh_loads_total", 3), 3)
        # room for one mesh
        with self.start("--memory-budget", str(37 * size // 10), "--max-body", "1MiB") as daemon:
            daemon.wait_for("mesh_loads_total")
            self.assertEqual(daemon.get("/v1/meshes/hot/nearest?point=p:0,0,1").status, 200)
            self.assertEqual(daemon.metric("mesh_loads_total"), 1, "another one was loaded first")
            self.assertEqual(daemon.get("/v1/meshes/warm/nearest?point=p:0,0,1").status, 200)
            self.assertEqual(daemon.metric("mesh_loads_total"), 2, "there was room for two")


class Memory(Stored):
    def test_unused_meshes_are_unloaded_first(self):
        """Meshes without fields are unloaded first."""
        file = sample("icosphere", level=4)
        with self.start("--memory-budget", "32MiB", "--max-body", "4MiB") as daemon:
            size = daemon.put("m0", file).json["memory_bytes"]
            daemon.ask_often("m0", "v:0")
            daemon.get("/v1/meshes/m0/distance?from=v:0&to=v:9")
            self.assertEqual(daemon.metric("cache_builds_total"), 1)
            count = 3 * (32 << 20) // size
            for i in range(1, count):
                self.assertEqual(daemon.put(f"m{i}", file).status, 201)
            self.assertGreater(daemon.metric("mesh_unloads_total"), 0)
            self.assertLess(daemon.metric("meshes_loaded"), count)
            self.assertEqual(daemon.get("/v1/meshes/m0").json["fields_cached"], 1)
            loads = daemon.metric("mesh_loads_total")
            self.assertEqual(daemon.get("/v1/meshes/m0/distance?from=v:0&to=v:9").status, 200)
            self.assertEqual(daemon.metric("mesh_loads_total"), loads)
            for i in (1, count // 2, count - 1):
                self.assertEqual(daemon.get(f"/v1/meshes/m{i}/distance?from=v:0&to=v:9").status, 200)
            self.assertGreater(daemon.metric("mesh_loads_total"), loads)
            self.assertEqual(daemon.metric("meshes"), count)


class Fields(Stored):
    URL = "/v1/meshes/ball/path?from=v:7&to=p:0,0,-9"

    def warm(self):
        with self.start("--persist-fields") as daemon:
            daemon.put("ball", sample("icosphere", level=4))
            for source in (*range(5), 7):
                daemon.ask_often("ball", f"v:{source}")
                daemon.get(f"/v1/meshes/ball/distance?from=v:{source}&to=p:0,0,-9")
            return daemon.get(self.URL).body

    def test_a_restart_is_warm(self):
        answer = self.warm()
        for _ in range(2):
            with self.start("--persist-fields") as daemon:
                self.assertEqual(daemon.get(self.URL).body, answer)
                self.assertEqual(daemon.metric("searches_total"), 0)
                self.assertGreaterEqual(daemon.metric("cache_hits_total"), 1)
                self.assertEqual(daemon.get("/v1/meshes/ball").json["fields_cached"], 6)
                self.assertIn('memory_bytes{class="fields"} ', daemon.get("/metrics").body.decode())

    def test_a_damaged_file_is_deleted(self):
        answer = self.warm()
        files = sorted(self.folder.glob("fields/*/*.field"))
        self.assertEqual(len(files), 6)
        for file in files:
            self.flip(file)
        with self.start("--persist-fields") as daemon:
            self.assertAlmostEqual(daemon.get(self.URL).json["distance"], json.loads(answer)["distance"], 12)
            self.assertEqual(daemon.metric("searches_total"), 1)
            wait_until(lambda: self.events(daemon).count("field_discarded") == 6)

    def test_damaged_files_of_fields_do_no_harm(self):
        answer = self.warm()
        with self.start("--persist-fields") as daemon:
            self.assertEqual(daemon.get(self.URL).body, answer)
            for file in self.folder.glob("fields/*/*.field"):
                os.truncate(file, 0)
            self.assertEqual(daemon.get(self.URL).body, answer)
            for source in range(5):
                self.assertEqual(daemon.get(f"/v1/meshes/ball/path?from=v:{source}&to=p:0,0,-9").status, 200)
            self.assertEqual(daemon.metric("searches_total"), 0)

    def test_stored_fields_are_deleted_with_their_mesh(self):
        self.warm()
        self.assertEqual(len(list(self.folder.glob("fields/*/*.field"))), 6)
        with self.start() as daemon:
            daemon.put("ball", SQUARE)
        with self.start("--persist-fields") as daemon:
            self.assertEqual(list(self.folder.glob("fields/*")), [])
            self.assertEqual(daemon.get("/v1/meshes/ball/distance?from=v:0&to=v:2").status, 200)


class Tools(Stored):
    def test_backup_while_running(self):
        copies = pathlib.Path(self.place.name)
        with self.start("--workers", "2") as daemon:
            daemon.put("kept", sample("torus"))
            answer = daemon.get("/v1/meshes/kept/distance?from=v:0&to=v:9").body
            stop = threading.Event()

            def churn():
                step = 0
                while not stop.is_set():
                    step += 1
                    daemon.put(f"churn{step % 3}", sample("grid", columns=3 + step % 7, rows=3))
                    if step % 5 == 0:
                        daemon.request("DELETE", f"/v1/meshes/churn{step // 5 % 3}")

            with concurrent.futures.ThreadPoolExecutor(1) as pool:
                churning = pool.submit(churn)
                results = [self.tool("--backup", copies / f"copy{i}") for i in range(4)]
                stop.set()
                churning.result()
        for i, result in enumerate(results):
            self.assertEqual(result.returncode, 0, result)
            check = self.tool("--check-store", folder=copies / f"copy{i}")
            self.assertEqual(check.returncode, 0, check)
        shutil.rmtree(self.folder)
        with Daemon("--data-dir", str(copies / "copy3")) as daemon:
            self.assertEqual(daemon.get("/v1/meshes/kept/distance?from=v:0&to=v:9").body, answer)
        self.assertEqual(self.tool("--backup", copies / "copy2", folder=copies / "copy3").returncode, 1)

    def test_batches_are_copied_and_restored(self):
        copy, again = (pathlib.Path(self.place.name) / name for name in ("copy", "again"))
        with self.start("--workers", "1") as daemon:
            daemon.put("sphere", sample("icosphere", level=4))
            done = begin(daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": [0, 5, 17]}).json["id"]
            wait(daemon, done)
            answers = results(daemon, done)
            under_way = begin(daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(150))}).json["id"]
            backup = self.tool("--backup", copy)
        self.assertEqual(backup.returncode, 0, backup)
        restored = self.tool("--restore", copy, folder=again)
        self.assertEqual(restored.returncode, 0, restored)
        check = self.tool("--check-store", folder=again)
        self.assertEqual((check.returncode, check.stderr), (0, ""), check)
        with Daemon("--data-dir", str(again)) as daemon:
            self.assertEqual(results(daemon, done), answers)
            self.assertEqual((wait(daemon, under_way)["done"], daemon.get(f"/v1/batches/{under_way}").json["failed"]), (150, 0))
        (copy / "geodesicd.db").unlink()
        self.assertEqual(self.tool("--backup", copy).returncode, 1, "a copy in the place of what a folder had")

    def test_an_unfinished_copy_is_refused_until_it_is_completed(self):
        copy, again = (pathlib.Path(self.place.name) / name for name in ("copy", "again"))
        with self.start() as daemon:
            daemon.put("sphere", sample("icosphere", level=2))
        self.assertEqual(self.tool("--backup", copy).returncode, 0)
        self.assertEqual(self.tool("--restore", copy, folder=again).returncode, 0)
        self.assertFalse((again / "unfinished").exists())
        refused = self.tool("--restore", copy, folder=again)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("holds a data folder already", refused.stdout)
        (again / "unfinished").touch()  # a killed restore leaves this file
        next(again.glob("objects/*/*")).write_bytes(b"a part")
        (again / "temporary" / "0").touch()
        (again / "manifests" / "of-another-time.manifest").touch()
        with self.assertRaisesRegex(RuntimeError, "is an unfinished copy: repeat the --restore or --backup that began it"):
            Daemon("--data-dir", str(again))
        for flags in (("--check-store",), ("--backup", copy / "of-it")):
            self.assertIn("is an unfinished copy", self.tool(*flags, folder=again).stdout)
        self.assertIn("is an unfinished copy", self.tool("--restore", again, folder=copy / "of-it").stdout)
        self.assertEqual(self.tool("--restore", copy, folder=again).returncode, 0)
        check = self.tool("--check-store", folder=again)
        self.assertEqual((check.returncode, check.stdout.count("fault")), (0, 1), check)
        with Daemon("--data-dir", str(again)) as daemon:
            self.assertEqual(daemon.get("/v1/meshes/sphere/distance?from=v:0&to=v:9").status, 200)

    def test_a_read_only_copy_is_checked_and_restored(self):
        """Needs the right to mount. The path has characters that SQLite's URIs escape."""
        with self.start() as daemon:
            daemon.put("square", SQUARE)
        copy = pathlib.Path(self.place.name) / "50%?#"
        self.assertEqual(self.tool("--backup", copy).returncode, 0)
        if not shutil.which("mount") or subprocess.run(["mount", "--bind", copy, copy], stderr=subprocess.DEVNULL).returncode:
            self.skipTest("no right to mount")
        try:
            subprocess.run(["mount", "-o", "remount,ro,bind", copy], check=True)
            for arguments, folder in ((("--check-store",), copy), (("--restore", copy), copy.with_name("again"))):
                done = self.tool(*arguments, folder=folder)
                self.assertEqual(done.returncode, 0, done)
        finally:
            subprocess.run(["umount", copy], check=True)

    def test_check_of_nothing(self):
        copy = pathlib.Path(self.place.name) / "copy"
        backup = self.tool("--backup", copy)
        self.assertEqual((backup.returncode, copy.exists()), (1, False), backup)
        self.assertIn("there is no data folder", backup.stdout)
        self.assertEqual(self.tool("--check-store").returncode, 1)
        self.assertFalse(self.folder.exists())
        self.folder.mkdir()
        check = self.tool("--check-store")
        self.assertEqual(check.returncode, 1)
        self.assertIn("there is no data folder", check.stdout)
        self.assertEqual(list(self.folder.iterdir()), [])

    def fill(self):
        """Fills a folder with each kind of file."""
        with self.start("--persist-fields", "--landmarks", "2") as daemon:
            daemon.put("ball", sample("icosphere", level=4))
            daemon.put("square", SQUARE)
            daemon.get("/v1/meshes/ball/distance?from=v:7&to=v:9")
            daemon.wait_for("landmarks_built_total")
            daemon.ask_often("square", "v:0")
            daemon.get("/v1/meshes/square/distance?from=v:0&to=v:2")
            wait(daemon, begin(daemon, {"query": "all-pairs", "mesh": "square", "vertices": [0, 1]}).json["id"])

    def contents(self):
        return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file() and not path.name.endswith("-shm")}

    def test_check_changes_nothing(self):
        self.fill()
        for kill in (False, True):
            daemon = self.start()
            daemon.put("another", TETRAHEDRON)
            if kill:
                daemon.process.send_signal(signal.SIGKILL)
                daemon.process.wait()
            daemon.stop()
            before = self.contents()
            check = self.tool("--check-store")
            self.assertEqual((check.returncode, check.stderr), (0, ""), check)
            self.assertRegex(check.stdout, r"^3 manifests, 3 rows, 3 files \(\d+ bytes\), 2 fields verified: 0 faults\n$")
            after = self.contents()
            self.assertEqual([path for path in {*before, *after} if before.get(path) != after.get(path)], [])

    def test_check_sees_every_damage(self):
        self.fill()
        check = self.tool("--check-store")
        self.assertEqual(check.returncode, 0, check)
        kept = self.folder.with_name("kept")
        shutil.copytree(self.folder, kept)

        def one(pattern):
            return next(self.folder.glob(pattern))

        damages = {
            "a file that no mesh has": lambda: (self.folder / "objects/00").mkdir(exist_ok=True) or
            (self.folder / "objects/00" / ("00" * 32)).write_bytes(b"not this"),
            "a foreign file": lambda: (one("objects/*") / "notes.txt").write_bytes(b"x"),
            "a file in another's place": lambda: one("objects/*/*").rename(self.folder / "objects" / ("0" * 64)),
            "a foreign manifest": lambda: (self.folder / "manifests/notes.txt").write_bytes(b"x"),
            "a field": lambda: self.flip(one("fields/*/*.field")),
            "landmarks": lambda: self.flip(one("fields/*/*.landmarks")),
            "an object": lambda: self.flip(one("objects/*/*")),
            "a lost object": lambda: one("objects/*/*").unlink(),
            "a manifest": lambda: self.flip(one("manifests/*")),
            "a lost manifest": lambda: one("manifests/*").unlink(),
            "the database": lambda: self.flip(self.folder / "geodesicd.db", 0),
            "the database of batches": lambda: self.flip(self.folder / "batches.db", 0),
            "a lost database": lambda: (self.folder / "geodesicd.db").unlink(),
        }
        for what, damage in damages.items():
            with self.subTest(what):
                damage()
                check = self.tool("--check-store")
                self.assertEqual(check.returncode, 1, check)
                self.assertRegex(check.stdout, r"fault: [^\n]+: [^\n]+\n(.*\n)*.* verified: [1-9]\d* faults\n$")
                shutil.rmtree(self.folder)
                shutil.copytree(kept, self.folder)


if __name__ == "__main__":
    unittest.main()
