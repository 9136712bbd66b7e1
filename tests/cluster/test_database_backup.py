"""Tests backup and restore of a PostgreSQL store by the commands of the operating guide."""
import pathlib
import re
import subprocess
import tempfile
import threading

import cluster
from harness import PROGRAM, SQUARE, Daemon, sample
from test_batches import begin, results, wait
from test_nodes import Shared, setUpModule  # noqa: F401  (skips without PostgreSQL)

GUIDE = pathlib.Path(__file__).resolve().parents[2] / "server/doc/guide/operating.md"


def commands():
    """Returns the commands of the section about PostgreSQL: dump, restore, check."""
    section = re.search(r"^\*\*PostgreSQL\.\*\*(.*?)^## ", GUIDE.read_text(), re.M | re.S)[1]
    return [line for block in re.findall(r"```console\n(.*?)```", section, re.S) for line in block.splitlines()]


class DatabaseBackup(Shared):
    def setUp(self):
        super().setUp()
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)
        for name in ("geodesicd", "restored"):
            self.database.query(f"DROP DATABASE IF EXISTS {name}")
        self.database.query("CREATE DATABASE geodesicd")

    def url(self, name):
        return self.database.url.rpartition("/")[0] + "/" + name

    def node_at(self, name):
        node = Daemon("--store", self.url(name))
        self.nodes.append(node)
        return node

    def run_command(self, command):
        """Runs a command of the guide with the addresses and programs of this test."""
        self.assertRegex(command, "postgresql://")
        words = [re.sub(r"postgresql://\w+@db/(\w+)", lambda found: self.url(found[1]), word) for word in command.split()]
        program = PROGRAM if words[0] == "geodesicd" else cluster.program(words[0])
        done = subprocess.run([program, *words[1:]], cwd=self.place.name, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def fill(self, node):
        for name, body in {"square": SQUARE, "sphere": sample("icosphere", level=4)}.items():
            self.assertEqual(node.put(name, body).status, 201)
        self.assertEqual(node.ask("sphere", "derive", {"mesh": "thin", "operations": [{"operation": "simplify", "faces": 500}]}).status, 201)
        self.assertEqual(node.request("PUT", "/v1/subdivisions/cube", sample("box", cells=1), {"Content-Type": "model/obj"}).status, 201)
        batch = begin(node, {"query": "all-pairs", "mesh": "sphere", "vertices": [0, 5, 17]}).json["id"]
        wait(node, batch)
        return batch

    def answers(self, node, batch):
        """Returns what clients see: descriptions with their ETags, distances, results."""
        paths = [*(f"/v1/meshes/{name}" for name in ("square", "sphere", "thin")), "/v1/subdivisions/cube", "/v1/meshes/thin/origins",
                 "/v1/meshes/sphere/path?from=v:0&to=v:100", "/v1/meshes/thin/distance?from=v:0&to=v:100"]
        got = [(path, node.get(path)) for path in paths]
        self.assertEqual([(path, answer.status) for path, answer in got], [(path, 200) for path in paths])
        described = [(path, answer.headers.get("ETag"), {**answer.json, "fields_cached": 0, "memory_bytes": 0}) for path, answer in got]
        return described, results(node, batch)

    def test_a_dump_is_restored_into_a_new_database(self):
        dump, restore, check = commands()
        node = self.node_at("geodesicd")
        batch = self.fill(node)
        before = self.answers(node, batch)
        self.run_command(dump)
        self.assertEqual(node.put("later", SQUARE).status, 201)  # not in the dump
        self.assertEqual(node.stop(), 0)
        self.database.query("DROP DATABASE geodesicd")
        self.run_command(restore)
        self.run_command(check)
        restored = self.node_at("geodesicd")
        self.assertEqual(self.answers(restored, batch), before)
        self.assertEqual(restored.get("/v1/meshes/later").status, 404)
        self.assertEqual(restored.put("square", sample("icosphere", level=1)).status, 200)
        self.assertEqual(restored.get("/v1/meshes/square").json["vertices"], 42)

    def test_a_dump_during_uploads_has_each_mesh_whole(self):
        dump, _, check = commands()
        node, is_over, stored = self.node_at("geodesicd"), threading.Event(), []

        def upload():
            while not is_over.is_set():
                name = f"m{len(stored)}"
                assert node.put(name, sample("icosphere", level=1 + len(stored) % 5)).status == 201
                stored.append(name)

        writer = threading.Thread(target=upload)
        writer.start()
        try:
            while len(stored) < 5:
                is_over.wait(0.01)
            known = list(stored)
            self.run_command(dump)
        finally:
            is_over.set()
            writer.join()
        self.database.query("CREATE DATABASE restored")
        done = subprocess.run([cluster.program("pg_restore"), "--dbname", self.url("restored"), f"{self.place.name}/geodesicd.dump"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.run_command(check.replace("/geodesicd ", "/restored "))
        restored = self.node_at("restored")
        listed = [mesh["name"] for mesh in restored.get("/v1/meshes?limit=1000").json["meshes"]]
        self.assertEqual(set(known) - set(listed), set())
        for name in listed:
            for path in (f"/v1/meshes/{name}/content?format=obj", f"/v1/meshes/{name}/distance?from=v:0&to=v:7"):
                self.assertEqual(restored.get(path).body, node.get(path).body, path)
