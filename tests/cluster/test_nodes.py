"""Tests daemons that share a database: uploads to any node, queries on every node, changes that
reach all nodes, and a database that fails and recovers."""
import concurrent.futures
import hashlib
import json
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest

import cluster
from cluster import BOUND_SECONDS, Node, Postgres, Relay
from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, TETRAHEDRON, Daemon, sample, wait_until
from test_access import keygen

LONG = os.environ.get("CLUSTER") == "long"
ASK = "/v1/meshes/{}/path?from=v:0&to=v:{}"
CUBE = json.dumps({"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
                   "faces": [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]})


def setUpModule():
    cluster.require()


class Shared(unittest.TestCase):
    """Tests that share a database, which each test empties at its start."""

    @classmethod
    def setUpClass(cls):
        cls.database = Postgres()

    @classmethod
    def tearDownClass(cls):
        cls.database.__exit__()

    def setUp(self):
        self.database.drop()
        self.nodes = []

    def tearDown(self):
        for node in self.nodes:
            if node.process.poll() is None:
                self.assertEqual(node.stop(), 0)
            logged = json.dumps(node.log)
            self.assertNotIn(Postgres.PASSWORD, logged)

    def start(self, *flags, port=None):
        self.nodes.append(Node(self.database, *flags, port=port))
        return self.nodes[-1]

    def rows(self, table):
        return int(self.database.query(f"SELECT count(*) FROM geodesicd.{table}"))


class Nodes(Shared):
    def test_any_node_answers_for_uploads_to_another(self):
        one, two, three = self.start(), self.start(), self.start("--workers", "1")
        spheres = {f"sphere-{level}": sample("icosphere", level=level) for level in (1, 2, 3)}
        with Daemon() as alone:
            for i, (name, body) in enumerate(spheres.items()):
                self.assertEqual((one, two, three)[i].put(name, body).status, 201)
                self.assertEqual(alone.put(name, body).status, 201)
            for name in spheres:
                for far in (1, 7, 11):
                    answers = {node.get(ASK.format(name, far)).body for node in (one, two, three, alone)}
                    self.assertEqual(len(answers), 1, "bit for bit")
                for other in (one, two, three):
                    self.assertEqual(other.get(f"/v1/meshes/{name}").headers["ETag"], alone.get(f"/v1/meshes/{name}").headers["ETag"])

    def test_each_upload_can_be_queried_at_once_at_another_node(self):
        one, two = self.start(), self.start()
        for i in range(40):
            writer, reader = (one, two) if i % 2 else (two, one)
            self.assertEqual(writer.put(f"mesh-{i}", SQUARE).status, 201)
            answer = reader.get(ASK.format(f"mesh-{i}", 2))
            self.assertEqual(answer.status, 200, answer)
        self.assertEqual(two.get("/v1/meshes?limit=1000").json, one.get("/v1/meshes?limit=1000").json)
        self.assertEqual(self.rows("objects"), 1)  # both meshes share one object

    def test_replacements_and_deletions_reach_other_nodes_in_time(self):
        one, two, three = self.start(), self.start(), self.start()
        slowest = 0
        for i in range(20):
            bodies = (SQUARE, TETRAHEDRON)
            self.assertIn(one.put("mesh", bodies[i % 2]).status, (200, 201))
            faces = (2, 4)[i % 2]
            for other in (two, three):
                slowest = max(slowest, other.wait_until(lambda node: node.get("/v1/meshes/mesh").json["faces"] == faces, BOUND_SECONDS))
                self.assertEqual(other.get(ASK.format("mesh", 2)).status, 200)
        self.assertEqual(one.request("DELETE", "/v1/meshes/mesh").status, 204)
        for other in (two, three):
            slowest = max(slowest, other.wait_until(lambda node: node.get("/v1/meshes/mesh").status == 404, BOUND_SECONDS))
        print(f"# a change reaches the other nodes within {slowest * 1e3:.0f} ms (promised: {BOUND_SECONDS * 1e3:.0f})")
        self.assertEqual((self.rows("objects"), self.rows("chunks")), (0, 0))

    def test_conditions_are_decided_by_the_database(self):
        one, two = self.start(), self.start()
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            for i in range(10):
                made = list(pool.map(lambda k: (one, two)[k % 2].put(f"new-{i}", (SQUARE, TETRAHEDRON)[k % 2], If_None_Match="*").status, range(8)))
                self.assertEqual(sorted(made), [201] + [412] * 7)
        tag = one.get("/v1/meshes/new-0").headers["ETag"]
        self.assertEqual(two.put("new-0", sample("icosphere", level=1), If_Match=tag).status, 200)
        self.assertEqual(one.put("new-0", SQUARE, If_Match=tag).status, 412)

    def test_other_kinds_and_derived_meshes(self):
        one, two = self.start(), self.start()
        answer = one.request("PUT", "/v1/subdivisions/cube", CUBE, {"Content-Type": "application/json"})
        self.assertEqual(answer.status, 201, answer)
        made = two.request("POST", "/v1/subdivisions/cube/tessellate", json.dumps({"level": 2, "mesh": "fine"}), {"Content-Type": "application/json"})
        self.assertEqual(made.status, 201, made)
        place = one.get("/v1/meshes/fine/places")  # uses the attachment that the other node made
        self.assertEqual(place.status, 200, place)
        self.assertEqual(place.body, two.get("/v1/meshes/fine/places").body)

    def test_tenants_are_strangers_on_every_node(self):
        with tempfile.NamedTemporaryFile("w") as file:
            keys = {name: keygen(name, "--role", "write").stdout.splitlines() for name in ("ann", "bob")}
            file.write("".join(f"{entry}\n" for _, entry in keys.values()))
            file.flush()
            one, two = self.start("--keys", file.name), self.start("--keys", file.name)
            bearer = {name: {"Authorization": f"Bearer {key}"} for name, (key, _) in keys.items()}
            self.assertEqual(one.request("PUT", "/v1/meshes/it", SQUARE, bearer["ann"]).status, 201)
            self.assertEqual(two.request("GET", "/v1/meshes/it", headers=bearer["bob"]).status, 404)
            self.assertEqual(two.request("PUT", "/v1/meshes/it", SQUARE, bearer["bob"]).status, 201)
            self.assertEqual(one.request("DELETE", "/v1/meshes/it", headers=bearer["bob"]).status, 204)
            self.assertEqual(two.request("GET", ASK.format("it", 2), headers=bearer["ann"]).status, 200)
            self.assertEqual(self.rows("objects"), 1)

    def test_a_restart_finds_everything_and_a_dead_node_leaves_nothing_behind(self):
        one, two = self.start(), self.start()
        self.assertEqual(one.put("kept", SQUARE).status, 201)
        one.kill()
        self.assertEqual(two.get(ASK.format("kept", 2)).status, 200)
        three = self.start()
        self.assertEqual([mesh["name"] for mesh in three.get("/v1/meshes").json["meshes"]], ["kept"])
        self.assertEqual(three.put("kept", SQUARE).status, 200)

    def test_damage_is_found_and_healed_by_an_upload(self):
        one = self.start()
        body = sample("icosphere", level=4)
        self.assertEqual(one.put("mesh", body).status, 201)
        self.database.query("UPDATE geodesicd.chunks SET bytes = set_byte(bytes, 1000, get_byte(bytes, 1000) # 1)")
        two = self.start("--scrub-s", "1")
        answer = two.get(ASK.format("mesh", 2))
        self.assertEqual((answer.status, answer.json["code"]), (500, "internal"))
        self.assertIn("SHA-256", answer.json["detail"])
        two.wait_for("scrub_rounds_total")
        wait_until(lambda: [line for line in two.log if line["event"] == "scrub_fault"])
        check = subprocess.run([PROGRAM, "--store", self.database.url, "--check-store"], capture_output=True, text=True)
        self.assertEqual(check.returncode, 1, check)
        self.assertEqual(two.put("mesh", body).status, 200)
        self.assertEqual(two.get(ASK.format("mesh", 2)).body, one.get(ASK.format("mesh", 2)).body)
        check = subprocess.run([PROGRAM, "--store", self.database.url, "--check-store"], capture_output=True, text=True)
        self.assertEqual(check.returncode, 0, check)

    def test_a_later_version_s_tables_are_left_alone(self):
        self.start()
        self.database.query("INSERT INTO geodesicd.migrations (version) VALUES (9999)")
        with self.assertRaises(RuntimeError) as refused:
            Node(self.database)
        self.assertIn("later version", str(refused.exception))


class Acknowledged:
    """Clients that upload and delete their own meshes, one after the other, and record the
    acknowledged states. A change that got a 503 may have happened or not. The client then repeats
    this change, as the answer demands."""

    def __init__(self, nodes, clients=4):
        self.nodes, self.over = nodes, threading.Event()
        self.known, self.answers, self.faults = {}, {}, []
        self.threads = [threading.Thread(target=self._client, args=(i,), daemon=True) for i in range(clients)]
        for thread in self.threads:
            thread.start()

    def _client(self, number):
        step = 0
        while not self.over.is_set():
            name, node = f"client-{number}-{step % 5}", self.nodes[(number + step) % len(self.nodes)]
            deletes, body = step % 7 == 6, (SQUARE, TETRAHEDRON)[step % 2]
            answer = node.request("DELETE", f"/v1/meshes/{name}") if deletes else node.put(name, body)
            self.answers[answer.status] = self.answers.get(answer.status, 0) + 1
            if answer.status == 503:
                if not answer.headers["Retry-After"]:
                    self.faults.append("503 without Retry-After")
                time.sleep(0.02)
                self.known.pop(name, None)  # the state is unknown until the change is repeated
                continue
            before, was_unsure = self.known.get(name), name not in self.known
            expected = ({204, 404} if was_unsure else {204 if before else 404}) if deletes else ({200, 201} if was_unsure else {200 if before else 201})
            if answer.status not in expected:
                self.faults.append((name, "DELETE" if deletes else "PUT", answer.status, expected))
            self.known[name] = None if deletes else hashlib.sha256(body).hexdigest()
            step += 1

    def end(self):
        self.over.set()
        for thread in self.threads:
            thread.join(PATIENCE_SECONDS)

    def _wrong(self, node):
        answers = {name: node.get(f"/v1/meshes/{name}") for name in self.known}
        return [(name, answer) for name, answer in answers.items() if (answer.json["sha256"] if answer.status == 200 else None) != self.known[name]]

    def check(self, test, nodes):
        """Checks that every node has exactly the acknowledged state once the promised time has
        passed."""
        test.assertEqual(self.faults, [])
        until = time.monotonic() + BOUND_SECONDS
        for node in nodes:
            while (wrong := self._wrong(node)) and time.monotonic() < until:
                time.sleep(0.02)
            test.assertEqual(wrong, [])


class Interruptions(Shared):
    def test_broken_connections_lose_and_repeat_no_change(self):
        nodes = [self.start(), self.start()]
        clients = Acknowledged(nodes)
        ended, until = 0, time.monotonic() + (60 if LONG else 6)
        while time.monotonic() < until:
            ended += self.database.end_connections()
            time.sleep(0.05)
        clients.end()
        print(f"# {ended} connections ended during {sum(clients.answers.values())} changes {clients.answers}: none lost, none repeated")
        clients.check(self, nodes)
        self.assertEqual(self.rows("objects"), len({sha for sha in clients.known.values() if sha}))

    def test_a_database_that_stops_and_starts(self):
        nodes = [self.start(), self.start()]
        self.assertEqual(nodes[0].put("cached", SQUARE).status, 201)
        self.assertEqual({node.get(ASK.format("cached", 2)).status for node in nodes}, {200})
        clients = Acknowledged(nodes)
        for how in (signal.SIGINT, signal.SIGQUIT) * (8 if LONG else 1):
            time.sleep(0.5)
            self.database.stop(how)
            for node in nodes:
                node.wait_until(lambda node: node.health() == "degraded", 5)
                self.assertEqual(node.get(ASK.format("cached", 2)).status, 200)
                self.assertEqual(node.get("/readyz").status, 200)
                refused = node.put("another", SQUARE)
                self.assertEqual((refused.status, refused.json["code"], refused.headers["Retry-After"]), (503, "store_unavailable", "1"))
                self.assertEqual(node.get("/v1/meshes/unknown").status, 503)
            self.database.start()
            for node in nodes:
                node.wait_until(lambda node: node.health() == "ok", 5)
        clients.end()
        print(f"# the database stopped and started under {sum(clients.answers.values())} changes {clients.answers}")
        clients.check(self, nodes)

    def test_a_network_that_is_cut(self):
        relay = Relay(self.database.port)
        self.addCleanup(relay.close)
        near, far = self.start(), self.start(port=relay.port)
        self.assertEqual(near.put("mesh", SQUARE).status, 201)
        self.assertEqual(far.get(ASK.format("mesh", 2)).status, 200)
        for cut in (relay.refuse, relay.hold):
            self.assertEqual(far.get(ASK.format("mesh", 2)).status, 200)
            cut()
            took = far.wait_until(lambda node: node.health() == "degraded", 10)
            begun = time.monotonic()
            self.assertEqual(far.get(ASK.format("mesh", 2)).status, 200)
            self.assertEqual(far.put("other", SQUARE).status, 503)
            self.assertLess(time.monotonic() - begun, 0.5)
            self.assertEqual(near.put("mesh", TETRAHEDRON if cut == relay.refuse else SQUARE).status, 200)
            relay.mend()
            back = far.wait_until(lambda node: node.health() == "ok", 10)
            faces = near.get("/v1/meshes/mesh").json["faces"]
            far.wait_until(lambda node: node.get("/v1/meshes/mesh").json["faces"] == faces, BOUND_SECONDS)
            print(f"# network cut ({cut.__name__}): noticed after {took:.2f} s, back {back:.2f} s after it was mended")

    def test_requests_end_soon_while_the_network_is_silent(self):
        relay = Relay(self.database.port)
        self.addCleanup(relay.close)
        far = self.start(port=relay.port)
        self.assertEqual(far.put("mesh", SQUARE).status, 201)
        self.assertEqual(far.get(ASK.format("mesh", 2)).status, 200)
        relay.hold()
        slowest, until = 0, time.monotonic() + 8
        while time.monotonic() < until:
            begun = time.monotonic()
            self.assertEqual(far.get(ASK.format("mesh", 2)).status, 200)
            slowest = max(slowest, time.monotonic() - begun)
            time.sleep(0.01)
        print(f"# a silent network: the slowest answer from memory took {slowest:.2f} s")
        self.assertLess(slowest, 4)
        relay.mend()
        far.wait_until(lambda node: node.health() == "ok", 10)

    def test_a_node_catches_up_after_a_long_absence(self):
        relay = Relay(self.database.port)
        self.addCleanup(relay.close)
        near, far = self.start(), self.start(port=relay.port)
        for name in ("stays", "changes", "goes"):
            self.assertEqual(near.put(name, SQUARE).status, 201)
            self.assertEqual(far.get(ASK.format(name, 2)).status, 200)
        relay.refuse()
        far.wait_until(lambda node: node.health() == "degraded", 10)
        self.assertEqual(near.put("changes", TETRAHEDRON).status, 200)
        self.assertEqual(near.request("DELETE", "/v1/meshes/goes").status, 204)
        # simulates the state after a hundred thousand other changes
        self.database.query("DELETE FROM geodesicd.surfaces WHERE record IS NULL")
        self.database.query("UPDATE geodesicd.clock SET version = version + 200000, forgotten = version + 100000")
        relay.mend()
        far.wait_until(lambda node: node.health() == "ok", 10)
        far.wait_until(lambda node: node.get("/v1/meshes/goes").status == 404, BOUND_SECONDS)
        self.assertEqual(far.get("/v1/meshes/changes").json["faces"], 4)
        self.assertEqual(far.get(ASK.format("stays", 2)).status, 200)
        self.assertEqual(near.put("changes", SQUARE).status, 200)
        far.wait_until(lambda node: node.get("/v1/meshes/changes").json["faces"] == 2, BOUND_SECONDS)

    def test_two_hundred_uploads_while_postgres_is_killed(self):
        if not LONG:
            self.skipTest("the long form: make test-cluster")
        nodes = [self.start(), self.start(), self.start()]
        clients = Acknowledged(nodes, clients=8)
        for _ in range(20):
            time.sleep(1)
            self.database.stop(signal.SIGQUIT)
            self.database.start()
        clients.end()
        clients.check(self, nodes)
