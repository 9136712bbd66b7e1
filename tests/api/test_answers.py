"""Tests the memory of answers. Answers count in the memory budget until their clients have read
them. Answers are limited in size, and are refused if the budget has no room. Also tests lists by
page, and the counted memory of records."""
import concurrent.futures
import json
import socket
import struct
import time
import unittest

from harness import TETRAHEDRON, Daemon, TestCase, form_tag, sample, wait_until

MIB = 1 << 20
RING = 24  # number of vertices in the queries
# a trace whose answer has about 9 MiB
LARGE = {"start": {"vertex": 0}, "fan": 8, "length": 1e6, "step_limit": 14000}


def loose_triangles(count):
    """Returns a binary STL file of triangles that do not touch each other. Each triangle therefore
    has its own boundary loop."""
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, 2 * i, 0, 0, 2 * i + 1, 0, 0, 2 * i, 1 + i / count, 0, 0) for i in range(count))
    return b"\0" * 80 + struct.pack("<I", count) + triangles


def held(daemon, name):
    lines = daemon.get("/metrics").body.decode().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(f'geodesicd_memory_bytes{{class="{name}"}}'))


def square(count):
    """Returns the request of a matrix with this many rows and columns."""
    those = [{"vertex": i % RING} for i in range(count)]
    return {"sources": those, "targets": those}


class Large(TestCase):
    flags = ("--memory-budget", "64MiB", "--max-body", "8MiB", "--workers", "2", "--landmarks", "0")

    def setUp(self):
        self.daemon.put("ring", sample("torus", columns=48, rows=24))

    def ask_unread(self):
        body = json.dumps(LARGE).encode()
        connection = socket.socket()
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(60)
        connection.connect(("127.0.0.1", self.daemon.port))
        connection.sendall(b"POST /v1/meshes/ring/trace HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                           b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        return connection

    def test_unread_answers_are_held_in_the_budget_and_others_refused(self):
        crowd = [self.ask_unread() for _ in range(12)]
        wait_until(lambda: not self.daemon.metric("requests_deferred") and held(self.daemon, "answers") > 8 * MIB)
        # answers may use half of the budget
        self.assertLessEqual(held(self.daemon, "answers"), 32 * MIB)
        refused = self.daemon.ask("ring", "trace", LARGE)
        self.assert_problem(refused, 507, "insufficient_memory")
        self.assertEqual(refused.headers["Retry-After"], "1")
        self.assertEqual(self.daemon.ask("ring", "matrix", square(3)).status, 200)
        statuses = [connection.recv(12) for connection in crowd]
        self.assertLessEqual(set(statuses), {b"HTTP/1.1 200", b"HTTP/1.1 507"})
        self.assertIn(b"HTTP/1.1 200", statuses)
        for connection in crowd:
            connection.close()
        wait_until(lambda: held(self.daemon, "answers") < MIB)
        self.assertEqual(self.daemon.ask("ring", "trace", LARGE).status, 200)

    def test_clients_that_read_nothing_are_cut_sooner_when_requests_are_refused(self):
        crowd = [self.ask_unread() for _ in range(12)]
        wait_until(lambda: not self.daemon.metric("requests_deferred"))
        began = time.monotonic()
        wait_until(lambda: self.daemon.ask("ring", "trace", LARGE).status == 200 or time.sleep(0.2))
        # if the daemon did not disconnect these clients early, this would take 30 s
        self.assertLess(time.monotonic() - began, 20)
        for connection in crowd:
            connection.close()

    def test_the_memory_of_a_read_answer_is_returned(self):
        for headers in ({}, {"Accept-Encoding": "gzip"}, {"Accept": "application/octet-stream"}):
            answer = self.daemon.ask("ring", "matrix", square(300), headers)
            self.assertEqual(answer.status, 200)
            self.assertGreater(len(answer.body), 10000)
        for form in ("obj", "ply", "gltf"):
            self.assertEqual(self.daemon.get(f"/v1/meshes/ring/content?format={form}").status, 200)
        # the remaining memory is that of the answer to this request
        wait_until(lambda: held(self.daemon, "answers") < MIB / 4)

    def test_results_of_jobs_are_sent_as_they_are_kept(self):
        whole = self.daemon.ask("ring", "matrix", square(300))
        job = self.daemon.ended(self.daemon.ask("ring", "matrix", square(300), {"Prefer": "respond-async"}))
        self.assertEqual(job["result"], whole.json)
        for encoding in ("identity", "gzip"):
            answer = self.daemon.get(f"/v1/jobs/{job['id']}/result", Accept_Encoding=encoding)
            self.assertEqual((answer.status, answer.body), (200, whole.body))
        head = self.daemon.request("HEAD", f"/v1/jobs/{job['id']}/result")
        self.assertEqual((head.status, head.headers["Content-Length"]), (200, str(len(whole.body))))
        known = self.daemon.get(f"/v1/jobs/{job['id']}/result", If_None_Match=whole.headers["ETag"])
        self.assertEqual((known.status, known.body), (304, b""))


class Limited(TestCase):
    flags = ("--max-answer", "64KiB", "--landmarks", "0")

    def test_an_answer_has_a_largest_size(self):
        self.daemon.put("ring", sample("torus", columns=48, rows=24))
        self.assertEqual(self.daemon.get("/v1").json["limits"]["max_answer_bytes"], 65536)
        field = self.daemon.ask("ring", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]
        for answer in (self.daemon.ask("ring", "matrix", square(100)), self.daemon.ask("ring", "matrix", square(100), {"Accept": "application/octet-stream"}),
                       self.daemon.ask("ring", "trace", {"start": {"vertex": 0}, "fan": 8, "length": 1000}),
                       self.daemon.get("/v1/meshes/ring/content?format=obj"), self.daemon.get(f"/v1/meshes/ring/fields/{field}/isolines?count=100"),
                       self.daemon.get("/v1/meshes/ring/picture.svg?source=v:0&size=1000x1000")):
            problem = self.assert_problem(answer, 507, "insufficient_memory")
            self.assertEqual(problem["limit"], 65536)
            self.assertIn("--max-answer", problem["detail"])
        self.assertEqual(self.daemon.ask("ring", "matrix", square(10)).status, 200)

    def test_a_batch_refuses_the_line_alone(self):
        lines = [{"query": "matrix", **square(3)}, {"query": "matrix", **square(100)}, {"query": "distance", "from": {"vertex": 0}, "to": {"vertex": 1}}]
        self.daemon.put("ring", sample("torus", columns=48, rows=24))
        answer = self.daemon.request("POST", "/v1/meshes/ring/batch", "\n".join(map(json.dumps, lines)), {"Content-Type": "application/x-ndjson"})
        self.assertEqual([json.loads(line)["status"] for line in answer.body.splitlines()], [200, 507, 200])


class Boundaries(TestCase):
    def test_a_description_has_the_first_boundaries(self):
        mesh = self.daemon.put("loose", loose_triangles(250)).json
        self.assertEqual((mesh["boundary_count"], len(mesh["boundaries"])), (250, 100))

    def test_all_boundaries_are_listed_by_page(self):
        mesh, found, after = self.daemon.put("loose", loose_triangles(250)).json, [], ""
        while after is not None:
            answer = self.daemon.get(f"/v1/meshes/loose/boundaries?limit=99{after and '&after=' + after}")
            self.assertEqual((answer.status, answer.headers["ETag"]), (200, form_tag(f'"{mesh["etag"]}"', "json")))
            found += answer.json["boundaries"]
            after = answer.json["next"]
        self.assertEqual(len(found), 250)
        self.assertEqual(found[:100], mesh["boundaries"])
        self.assertEqual(self.daemon.get("/v1/meshes/loose/boundaries?after=249").json, {"boundaries": [], "next": None})
        self.assert_problem(self.daemon.get("/v1/meshes/loose/boundaries?after=x"), 400, "invalid_request")
        self.daemon.put("closed", TETRAHEDRON)
        self.assertEqual(self.daemon.get("/v1/meshes/closed/boundaries").json, {"boundaries": [], "next": None})
        self.assert_problem(self.daemon.get("/v1/meshes/none/boundaries"), 404, "not_found")


class Lists(TestCase):
    flags = ("--landmarks", "0")

    def names(self, limit):
        found, after = [], ""
        while after is not None:
            page = self.daemon.get(f"/v1/meshes?limit={limit}{after and '&after=' + after}").json
            found.append([mesh["name"] for mesh in page["meshes"]])
            after = page["next"]
        return found

    def test_long_lists(self):
        body = loose_triangles(120)
        expected = [f"m{number:03}" for number in range(250)]
        for name in expected:
            self.daemon.put(name, body)
        for limit in (5, 16, 17, 100, 249, 1000):
            pages = self.names(limit)
            self.assertEqual(sum(pages, []), expected)
            self.assertLessEqual(max(map(len, pages)), limit)
        self.assertEqual(len(self.names(1000)), 2)  # a page ends after 1 MiB


class Busy(TestCase):
    flags = ("--workers", "1", "--landmarks", "0")

    def test_lists_do_not_wait_for_workers(self):
        for number in range(40):
            self.daemon.put(f"n{number}", TETRAHEDRON)
        self.daemon.put("ball", sample("icosphere", level=5))
        hog = self.daemon.ask("ball", "farthest-points", {"count": 10000}, {"Prefer": "respond-async"}).headers["Location"]
        self.daemon.wait_for("workers_busy")
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(self.daemon.get, ["/v1/meshes?limit=1000"] * 8 + ["/v1/jobs?limit=1000"] * 8))
        self.assertEqual({answer.status for answer in answers}, {200})
        self.assertEqual(self.daemon.get(hog).json["state"], "running")
        self.daemon.request("DELETE", hog)


class Documents(TestCase):
    """Parsed JSON takes up to a hundred times the size of its text."""

    flags = ("--memory-budget", "64MiB", "--max-body", "32MiB", "--landmarks", "0")

    def test_a_parsed_document_is_in_the_budget(self):
        self.daemon.put("tetra", TETRAHEDRON)
        empty = b"{}" + b",{}" * 330000
        for path, body in (("meshes/tetra/matrix", b'{"sources":[' + empty + b"]}"), ("batches", b'{"query":"all-pairs","mesh":"tetra","vertices":[' + empty + b"]}"),
                           ("nurbs", b'{"controlPoints":[' + empty + b"]}")):
            answer = self.daemon.request("POST", f"/v1/{path}", body, {"Content-Type": "application/json"})
            self.assert_problem(answer, 507, "insufficient_memory")
        batch = "\n".join(["{}", "[" + "[]," * 80000 + "[]]"])
        answer = self.daemon.request("POST", "/v1/meshes/tetra/batch", batch, {"Content-Type": "application/x-ndjson"})
        self.assertEqual([json.loads(line)["status"] for line in answer.body.splitlines()], [400, 400])
        wait_until(lambda: held(self.daemon, "flight") == 0)

    def test_the_request_of_a_batch_has_a_largest_size(self):
        answer = self.daemon.request("POST", "/v1/batches", b"[" + b" " * (5 * MIB) + b"]", {"Content-Type": "application/json"})
        self.assertEqual(self.assert_problem(answer, 413, "too_large")["limit"], 4 * MIB)


class Remembered(unittest.TestCase):
    def test_resident_memory_is_counted(self):
        with Daemon("--memory-budget", "32MiB", "--max-body", "4MiB", "--landmarks", "0") as daemon:
            empty = held(daemon, "records")
            for number in range(20):
                daemon.put(f"m{number}", TETRAHEDRON)
            full = held(daemon, "records")
            self.assertGreater(full - empty, 20 * 1000)
            job = daemon.ended(daemon.ask("m0", "fields", {"set": {"points": [{"vertex": 0}]}}, {"Prefer": "respond-async"}))["id"]
            self.assertGreater(held(daemon, "records"), full)
            daemon.request("DELETE", f"/v1/jobs/{job}")
            for number in range(20):
                daemon.request("DELETE", f"/v1/meshes/m{number}")
            self.assertEqual(held(daemon, "records"), empty)


if __name__ == "__main__":
    unittest.main()
