"""Tests the Python client: the scenario, the client's own features, and its behaviour with a busy
daemon."""
import gzip
import itertools
import os
import socket
import sys
import tempfile
import threading
import unittest

import scenario
from harness import SQUARE, Daemon, TestCase, sample, wait_until

sys.path.insert(0, str(scenario.CLIENTS / "python"))
import geodesicd  # noqa: E402


class Scenario(TestCase):
    def run_step(self, client, step):
        if "upload" in step:
            content = (step["arrays"]["vertices"], step["arrays"]["faces"]) if "arrays" in step else step["file"].encode()
            return client.upload(step["upload"], content, edits=step.get("edits")).describe()
        if "call" in step:
            mesh = client.mesh(step["mesh"])
            return [list(row) for row in mesh.matrix(step["sources"], step["targets"])] if step["call"] == "matrix" else list(mesh.field(step["sources"]).values())
        if "delete" in step:
            return client.mesh(step["delete"]).delete()
        if "derive" in step:
            return client.mesh("scenario").derive(step["derive"], *step["operations"]).describe()
        if "split" in step:
            return [part.describe() for part in client.mesh("scenario").split(step["split"], *step["operations"])]
        if "preview" in step:
            return client.mesh(step["preview"]).preview(step["faces"])[:4].decode()
        return client.mesh("scenario").query(step["query"], step["body"])

    def test_scenario(self):
        with geodesicd.Client("http://" + self.daemon.address) as client:
            for step in scenario.STEPS:
                with self.subTest(step=step):
                    if "problem" in step:
                        with self.assertRaises(geodesicd.ProblemError) as caught:
                            self.run_step(client, step)
                        scenario.check(self, caught.exception.problem, step["problem"])
                        self.assertEqual(caught.exception.status, step["problem"]["status"])
                    else:
                        scenario.check(self, self.run_step(client, step), step.get("expect"))


class Meshes(TestCase):
    def setUp(self):
        self.client = geodesicd.Client("http://" + self.daemon.address)
        self.square = self.client.upload("square", SQUARE)

    def tearDown(self):
        self.client.close()

    def test_points_in_all_forms(self):
        for point in (2, "v:2", (1.0, 1.0, 0.0), {"vertex": 2}, geodesicd.Point(vertex=2), geodesicd.near((1, 1, 0), 0.1), "p:1,1,0", "e:1-2:1",
                      "f:0:0,0,1", geodesicd.ray((1, 1, 5), (0, 0, -1)), self.square.nearest((1, 1, 7))):
            self.assertAlmostEqual(self.square.distance(0, point), 2**0.5, delta=1e-12, msg=point)
        for point in ("w:2", "v:x", "", (1.0, 2.0)):
            with self.assertRaises(ValueError, msg=point):
                self.square.distance(0, point)
        with self.assertRaisesRegex(ValueError, "not finite"):
            self.square.distance(0, (1.0, float("nan"), 0.0))

    def test_path(self):
        path = self.square.path(1, 3)
        self.assertAlmostEqual(path.length, 2**0.5)
        self.assertEqual((path.points[0], path.points[-1]), ((1, 0, 0), (0, 1, 0)))
        self.assertAlmostEqual(self.square.distance(1, 3, via=[0]), 2)
        self.assertEqual(len(self.square.path_file(1, 3, via=[0], format="csv").splitlines()), 4)
        self.assertIn(b"<svg", self.square.path_file(1, 3, format="svg"))
        self.assertNotIn(b"\nf ", self.square.path_file(1, 3))
        self.assertIn(b"\nf ", self.square.path_file(1, 3, mesh=True))

    def test_points_without_a_path(self):
        islands = self.client.upload("islands", ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0]], [[0, 1, 2], [3, 4, 5]]))
        self.assertIsNone(islands.distance(0, 3))
        self.assertIsNone(islands.path(0, 3))
        row = list(islands.matrix([0], [1, 3])[0])
        self.assertEqual(row[0], 1)
        self.assertNotEqual(row[1], row[1])

    def test_bulk(self):
        pairs = list(self.square.pairs([0, 0], [1, 2]))
        self.assertEqual([round(value, 12) for value in pairs], [round(self.square.distance(0, 1), 12), round(self.square.distance(0, 2), 12)])
        self.assertEqual(list(self.square.pairs([0], [(1.0, 0.0, 0.0)])), [self.square.distance(0, (1.0, 0.0, 0.0))])
        self.assertEqual(len(self.square.nearest_points([(0.2, 0.1, 1.0)])["faces"]), 1)

    def test_fields(self):
        field = self.square.field([0, 1], progress=lambda part: None)
        self.assertEqual([round(float(value), 12) for value in field.values()], [0, 0, 1, 1])
        for distance, expected in zip(field.distances(["v:2", (0.5, 0.5, 0.0)]), (1, 0.5**0.5)):
            self.assertAlmostEqual(distance, expected, delta=1e-12)
        self.assertAlmostEqual(field.max, field.distances([field.farthest])[0])
        self.assertIn("gradient", field.evaluate([2], gradient=True)[0])
        lines = field.query_arrays("isolines", {"levels": [0.5]})
        self.assertEqual((len(lines["first"]), len(lines["level"])), (2, 1))
        self.assertEqual(len(field.isolines([0.5])), 1)
        self.assertTrue(field.isolines_file([0.5], "csv", tolerance=0.1).startswith(b"line,point,x,y,z,along,level\r\n"))
        self.assertIn(b"\nf ", field.isolines_file([0.25, 0.5], mesh=True))
        self.assertEqual(self.square.field([0, 1]).id, field.id)
        self.assertEqual((field.file()[:4], field.file("glb")[:4]), (b"ply\n", b"glTF"))
        self.assertEqual(len(field.file("csv").splitlines()), 5)
        field.delete()
        with self.assertRaises(geodesicd.NotFound):
            field.describe()

    def test_sets(self):
        whole = {"boundaries": "all"}
        self.assertAlmostEqual(self.square.field(whole).max, 0.5)
        self.assertEqual(self.square.distance_to_set(whole, [(0.5, 0.25, 0.0)])[0]["distance"], 0.25)
        self.assertEqual(geodesicd.point_set((0.5, 0.25, 0.0)), {"points": [{"xyz": [0.5, 0.25, 0.0]}]})

    def test_names_and_contents(self):
        self.assertTrue(self.square.exists())
        self.assertFalse(self.client.mesh("nobody").exists())
        self.assertIn(b"v ", self.square.content())
        again = self.client.upload(None, self.square.content("ply"))
        self.assertEqual(again.describe()["faces"], 2)
        small = again.derive("square-small", {"operation": "subdivide", "levels": 2}, {"operation": "simplify", "faces": 8})
        self.assertEqual((small.describe()["faces"], len(small.origins())), (8, small.describe()["vertices"]))
        self.assertEqual((small.preview()[:4], small.preview(1000, "ply")[:4]), (b"glTF", b"ply\n"))
        for i in range(3):
            self.client.upload(f"many-{i}", SQUARE)
        self.assertLessEqual({"square", "many-0", "many-2"}, {mesh["name"] for mesh in self.client.meshes()})

    def test_figures(self):
        layers = [{"path": {"from": {"vertex": 0}, "to": {"vertex": 2}}, "label": "a path"}]
        self.assertEqual(self.square.figure(layers, width=32, height=32)[:4], b"\x89PNG")
        self.assertIn(b">a path</text>", self.square.figure(layers, "svg", camera={"view": "top"}))

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "mesh.off")
            with open(path, "wb") as file:
                file.write(self.square.content("off"))
            self.assertEqual(self.client.upload("from-file", path).describe()["vertices"], 4)
        with self.assertRaises(OSError):
            self.client.upload("from-file", "/there/is/none")

    def test_jobs_report_progress_and_can_be_cancelled(self):
        mesh = self.client.upload("sphere", sample("icosphere", level=6))
        seen = []
        field = mesh.field(0, progress=seen.append)
        self.assertGreater(field.max, 2)
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(seen[-1], 1)
        job = self.client.submit("POST", mesh.location + "/matrix", None,
                                 {"sources": [{"vertex": i} for i in range(500)], "targets": [{"vertex": i} for i in range(500)]})
        job.cancel()
        with self.assertRaises(geodesicd.JobCancelled):
            job.wait().response()
        failed = self.client.submit("POST", mesh.location + "/distance", None, {"from": {"vertex": 0}, "to": {"vertex": 10**9}}).wait()
        with self.assertRaises(geodesicd.InvalidRequest):
            failed.response()
        self.assertEqual(self.client.job(failed.id).state, "failed")
        started = self.client.submit("POST", mesh.location + "/fields", None, {"set": {"points": ["v:77"]}})
        self.assertEqual(started.refresh(wait=60).state, "done")

    def ended(self, batch):
        return wait_until(lambda: (now := self.client.batch(batch["id"]))["state"] != "running" and now)

    def test_lists_by_prefix(self):
        for name in ("a-1", "a-2", "b-1"):
            self.daemon.put(name, SQUARE)
        self.assertEqual([mesh["name"] for mesh in self.client.meshes("a-")], ["a-1", "a-2"])

    def test_batches(self):
        batch = self.client.create_batch({"query": "all-pairs", "mesh": "square", "vertices": [0, 1, 2]})
        self.assertEqual(sorted(item["item"] for item in self.client.batch_results(batch["id"], wait=True)), [0, 1, 2])
        told = []
        self.assertEqual(self.client.wait_batch(batch["id"], told.append), self.ended(batch))
        self.assertEqual(told[-1], 1)
        batch = self.client.wait_batch(batch["id"])
        self.assertEqual((batch["state"], batch["items"], batch["done"], batch["failed"]), ("done", 3, 3, 0))
        rows = [item["answer"]["distances"][0] for item in self.client.batch_results(batch["id"])]
        for row, expected in zip(rows, ([0, 1, 2**0.5], [1, 0, 1], [2**0.5, 1, 0])):
            for distance, known in zip(row, expected):
                self.assertAlmostEqual(distance, known, delta=1e-12)
        self.assertEqual(len(rows), 3)
        self.client.delete_batch(batch["id"])
        with self.assertRaises(geodesicd.NotFound):
            self.client.batch(batch["id"])

    def test_results_of_batches_go_over_pages(self):
        many = self.client.create_batch({"query": "fields", "meshes": ["nobody"] * 150, "set": {"points": [{"vertex": 0}]}})
        self.ended(many)
        results = list(self.client.batch_results(many["id"]))
        self.assertEqual([result["item"] for result in results], list(range(150)))
        self.assertEqual({result["problem"]["code"] for result in results}, {"not_found"})
        self.client.delete_batch(many["id"])

    def test_each_thread_has_its_connection(self):
        answers = []
        threads = [threading.Thread(target=lambda: answers.extend(self.square.distance(0, 2) for _ in range(50))) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(set(answers), {2**0.5})
        self.assertEqual(len(answers), 400)


class Patience(unittest.TestCase):
    OVERLOADED = (503, {"Retry-After": "0"}, {"code": "overloaded", "detail": "the queue is full"})

    def test_refused_requests_are_repeated(self):
        with scenario.busy(self.OVERLOADED, (429, {}, {}), (0, {}, {})) as (server, url), geodesicd.Client(url) as client:
            self.assertEqual(client.service(), {"version": "1"})
            self.assertEqual(len(server.seen), 4)
            # the daemon compresses no answers for clients on its own machine
            self.assertEqual(set(server.codings), {"identity"})

    def test_requests_that_create_something_are_not_repeated(self):
        with scenario.busy(self.OVERLOADED, (0, {}, {})) as (server, url), geodesicd.Client(url) as client:
            with self.assertRaises(geodesicd.ConnectionFailed):
                client.create_batch({"query": "fields"})
            # the client retries after a refusal, but not if the daemon may have received the
            # request
            self.assertEqual(len(server.seen), 2)
        with scenario.busy((503, {}, {"code": "store_unavailable"})) as (server, url), geodesicd.Client(url) as client:
            with self.assertRaises(geodesicd.Overloaded):  # the batch may exist
                client.create_batch({"query": "fields"})
            self.assertEqual(len(server.seen), 1)

    def test_the_client_waits_for_retry_after(self):
        with scenario.busy((503, {"Retry-After": "1"}, {})) as (server, url), geodesicd.Client(url) as client:
            client.service()
            self.assertGreaterEqual(server.seen[1] - server.seen[0], 1)

    def test_repetitions_are_limited(self):
        with scenario.busy(*[self.OVERLOADED] * 9) as (server, url), geodesicd.Client(url, retries=2) as client:
            with self.assertRaises(geodesicd.Overloaded) as caught:
                client.service()
            self.assertEqual((caught.exception.status, caught.exception.retry_after, len(server.seen)), (503, 0, 3))
            self.assertEqual(str(caught.exception), "the queue is full")

    def test_a_long_retry_after_is_raised(self):
        with scenario.busy((503, {"Retry-After": "86400"}, {})) as (_, url), geodesicd.Client(url) as client:
            with self.assertRaises(geodesicd.Overloaded) as caught:
                client.service()
            self.assertEqual(caught.exception.retry_after, 86400)

    def test_answers_of_other_programs(self):
        calls = (geodesicd.Client.service, lambda client: client.mesh("m").distance(0, 1), lambda client: client.mesh("m").matrix([0], [1]))
        answers = [(302, {"Location": "/"}, b""), (204, {}, b""), (200, {}, b"<html>"), (200, {}, [])]
        for call, answer in itertools.product(calls, answers):
            with self.subTest(str(answer)), scenario.busy(answer) as (_, url), geodesicd.Client(url) as client:
                self.assertRaises(geodesicd.BadAnswer, call, client)
        with scenario.busy((400, {}, {"code": [], "detail": {}})) as (_, url), geodesicd.Client(url) as client:
            self.assertRaises(geodesicd.ProblemError, client.service)

    def test_blanks_around_a_key_are_ignored(self):
        with scenario.busy() as (server, url), geodesicd.Client(url, key="key\n") as client:
            client.service()
            self.assertEqual(server.keys, ["Bearer key"])
            with self.assertRaises(ValueError) as caught:
                geodesicd.Client(url, key="secret\nX: y")
            self.assertNotIn("secret", str(caught.exception))

    def test_waits_are_shorter_than_the_timeout(self):
        with scenario.busy((200, {}, {"id": "b", "state": "done"})) as (server, url), geodesicd.Client(url, timeout=10) as client:
            client.wait_batch("b")
            self.assertEqual(server.paths, ["/v1/batches/b?wait=5"])

    def test_a_job_is_followed_if_its_stream_breaks_or_is_refused(self):
        running, done = ({"id": "j", "state": state, "progress": 0.5} for state in ("running", "done"))
        part = (200, {"Content-Length": 999, "Connection": "close"}, b'data: {"state": "running", "progress": 0.25}\n\n')
        answers = [(202, {}, running), part, (200, {}, running), self.OVERLOADED, (200, {}, running), (0, {}, {}), (200, {}, done)]
        seen = []
        with scenario.busy(*answers) as (server, url), geodesicd.Client(url) as client:
            job = client.submit("POST", "/v1/meshes/m/fields", body={}).wait(seen.append)
            self.assertEqual(job.state, "done")
            self.assertEqual(seen, [0.5, 0.25, 0.5, 0.5, 0.5])
            self.assertEqual(server.paths[1:], ["/v1/jobs/j/events", "/v1/jobs/j?wait=1"] * 3)

    def test_an_interrupted_call_cancels_its_job(self):
        def interrupt(part):
            raise KeyboardInterrupt

        with scenario.busy((202, {}, {"id": "j", "state": "queued", "progress": 0})) as (server, url), geodesicd.Client(url) as client:
            self.assertRaises(KeyboardInterrupt, client.call, "POST", "/v1/meshes/m/fields", progress=interrupt)
            self.assertEqual(server.paths[1:], ["/v1/jobs/j"])

    def test_connections_of_an_earlier_daemon_are_dropped(self):
        with scenario.busy() as (server, url), geodesicd.Client(url, retries=1) as client:
            for _ in range(4):
                idle = client.transport._open()
                idle.sock.shutdown(socket.SHUT_RDWR)  # as if the daemon had ended since then
                client.transport._idle.append(idle)
            self.assertEqual(client.service(), {"version": "1"})

    def test_damaged_gzip(self):
        for body in (b"no gzip", gzip.compress(b"{}")[:-9], gzip.compress(b"{}")[:10] + b"\xff" * 9):
            with scenario.busy((200, {"Content-Encoding": "gzip"}, body)) as (server, url), geodesicd.Client(url) as client:
                self.assertRaises(geodesicd.BadAnswer, client.service)
                self.assertEqual(len(server.seen), 1)

    def test_answers_of_proxies(self):
        with scenario.busy((502, {}, b"<html>bad gateway</html>")) as (_, url), geodesicd.Client(url) as client:
            with self.assertRaises(geodesicd.ProblemError) as caught:
                client.service()
            self.assertEqual(caught.exception.status, 502)

    def test_no_daemon(self):
        with self.assertRaises(geodesicd.ConnectionFailed):
            geodesicd.Client("http://127.0.0.1:1", retries=1).service()
        with self.assertRaises(ValueError):
            geodesicd.Client("localhost:8080")


class Elsewhere(unittest.TestCase):
    def test_unix_sockets(self):
        with tempfile.TemporaryDirectory() as folder, Daemon(listen="unix:" + folder + "/socket"):
            with geodesicd.Client("unix:" + folder + "/socket") as client:
                self.assertEqual(client.upload("square", SQUARE).distance(0, 1), 1)


if __name__ == "__main__":
    unittest.main()
