"""Tests matrices. Each entry equals the distance of a single query."""
import gzip
import json
import math
import random
import socket
import struct
import threading
import time
import unittest

from harness import SQUARE, TWO_TRIANGLES, Daemon, TestCase, form_tag, header_fields, sample, wait_until


def vertices(numbers):
    return [{"vertex": number} for number in numbers]


def some_points(numbers, count, index_count, faces):
    """Returns points of all kinds except rays."""
    points = []
    for _ in range(count):
        a, b = sorted((numbers.random(), numbers.random()))
        points.append(numbers.choice([
            {"vertex": numbers.randrange(index_count)},
            {"face": numbers.randrange(faces), "barycentric": [a, b - a, 1 - b]},
            {"face": numbers.randrange(faces), "barycentric": [0, a, 1 - a]},
            {"xyz": [numbers.uniform(-1, 1) for _ in range(3)]},
        ]))
    return points


class Entries(TestCase):
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("apart", TWO_TRIANGLES)
        cls.daemon.put("square", SQUARE)
        cls.daemon.put("ball", sample("icosphere", level=4))
        cls.daemon.put("terrain", sample("terrain", cells=30))
        cls.daemon.put("box", sample("box", cells=4))

    def matrix(self, mesh, sources, targets, **more):
        answer = self.daemon.ask(mesh, "matrix", {"sources": sources, "targets": targets, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json

    def assert_alone(self, mesh, sources, targets, distances):
        connection = self.daemon.connect()
        self.assertEqual([len(row) for row in distances], [len(targets)] * len(sources))
        for source, row in zip(sources, distances):
            for target, distance in zip(targets, row):
                body = json.dumps({"from": source, "to": target})
                alone = self.daemon.request("POST", f"/v1/meshes/{mesh}/distance", body,
                                            {"Content-Type": "application/json"}, connection).json["distance"]
                self.assertLessEqual(abs(distance - alone), 1e-12 * max(1, alone), (source, target))
        connection.close()

    def test_entries_are_single_distances(self):
        numbers = random.Random(3)
        for mesh in ("ball", "terrain", "box"):
            description = self.daemon.get(f"/v1/meshes/{mesh}").json
            size = description["index_count"], description["faces"]
            for rows, columns in ((12, 12), (2, 40), (40, 2), (1, 1), (3, 5), (1, 30)):
                sources, targets = (some_points(numbers, count, *size) for count in (rows, columns))
                self.assert_alone(mesh, sources, targets, self.matrix(mesh, sources, targets)["distances"])

    def test_symmetric_and_a_metric(self):
        points = some_points(random.Random(4), 30, 900, 1700)
        d = self.matrix("terrain", points, points)["distances"]
        for i, row in enumerate(d):
            self.assertEqual(row[i], 0)
            for j, distance in enumerate(row):
                self.assertLessEqual(abs(distance - d[j][i]), 1e-12 * max(1, distance))
                for k in range(len(d)):
                    self.assertLessEqual(distance, d[i][k] + d[k][j] + 1e-12)

    def test_transposed(self):
        numbers = random.Random(5)
        sources, targets = (some_points(numbers, count, 2500, 5000) for count in (9, 33))
        one, other = self.matrix("ball", sources, targets), self.matrix("ball", targets, sources)
        self.assertEqual(one["distances"], [list(column) for column in zip(*other["distances"])])

    def test_flat(self):
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        d = self.matrix("square", vertices(range(4)), vertices(range(4)))["distances"]
        for a, row in zip(corners, d):
            for b, distance in zip(corners, row):
                self.assertAlmostEqual(distance, math.dist(a, b), 12)

    def test_components(self):
        answer = self.matrix("apart", vertices([0, 3, 1]), vertices([4, 1]))
        self.assertEqual(answer["distances"], [[None, 1], [1, None], [None, 0]])
        self.assertEqual(answer["reasons"], [["no_path", None], [None, "no_path"], ["no_path", None]])
        answer = self.matrix("apart", vertices([0, 1]), vertices([3, 4]))
        self.assertEqual(answer["reasons"], [["no_path"] * 2] * 2)
        many = self.matrix("apart", vertices([0, 3] * 20), vertices([4, 1, 2, 5] * 8))
        nulls = [[distance is None for distance in row] for row in many["distances"][:2]]
        self.assertEqual(nulls, [[True, False, False, True] * 8, [False, True, True, False] * 8])

    def test_no_reasons_without_nulls(self):
        self.assertEqual(list(self.matrix("square", vertices([0]), vertices([1]))), ["distances"])

    def test_max_distance(self):
        self.check_limits(vertices(range(0, 200, 20)), vertices(range(0, 2500, 50)))
        numbers = random.Random(6)
        self.check_limits(*(some_points(numbers, count, 2500, 5000) for count in (9, 33)))

    def check_limits(self, sources, targets):
        whole = self.matrix("ball", sources, targets)["distances"]
        for limit in (1e-9, 0.5, 1.7, 1e308):
            cut = self.matrix("ball", sources, targets, max_distance=limit)
            for i, row in enumerate(whole):
                for j, distance in enumerate(row):
                    if distance > limit:
                        self.assertEqual((cut["distances"][i][j], cut["reasons"][i][j]), (None, "beyond_max_distance"))
                    else:
                        self.assertAlmostEqual(cut["distances"][i][j], distance, 12)
        self.assertNotIn("reasons", cut)

    def test_a_distance_at_the_limit_is_within(self):
        answer = self.matrix("square", vertices([0]), vertices([1, 2]), max_distance=1)
        self.assertEqual(answer["distances"], [[1, None]])
        both = self.matrix("apart", vertices([0]), vertices([1, 2, 3, 4, 5] * 5), max_distance=1.2)
        self.assertEqual(both["distances"][0][:5], [1, 1, None, None, None])
        self.assertEqual(both["reasons"][0][:5], [None, None, "no_path", "no_path", "no_path"])

    def test_repeated_points_are_computed_once(self):
        self.daemon.put("fresh", sample("icosphere", level=5))
        few, many = vertices([7, 90]), vertices([7, 90] * 150)
        targets = vertices(range(400, 800))
        begun = time.monotonic()
        expected = self.matrix("fresh", few, targets)["distances"]
        between = time.monotonic()
        self.assertEqual(self.matrix("fresh", many, targets)["distances"], expected * 150)
        once, often = between - begun, time.monotonic() - between
        self.assertLess(often, 20 * once + 1)
        self.assertEqual(self.matrix("fresh", targets[:3] * 50, few * 50)["distances"],
                         [[expected[j % 2][i % 3] for j in range(100)] for i in range(150)])

    def test_cached_fields_are_used(self):
        self.daemon.put("cached", sample("icosphere", level=4))
        for source in (7, 9):
            self.daemon.ask_often("cached", f"v:{source}")
            self.daemon.get(f"/v1/meshes/cached/distance?from=v:{source}&to=v:8")
        hits, builds = self.daemon.metric("cache_hits_total"), self.daemon.metric("cache_builds_total")
        sources, targets = vertices([7, 9]), vertices(range(100, 150))
        distances = self.matrix("cached", sources, targets)["distances"]
        self.assertEqual(self.daemon.metric("cache_hits_total"), hits + 2)
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds)
        self.assert_alone("cached", sources, targets, distances)

    def test_fields_of_rows_are_not_kept(self):
        self.daemon.put("dropped", sample("icosphere", level=4))
        before = self.daemon.metric("cache_fields")
        self.matrix("dropped", vertices(range(20)), vertices(range(100, 150)))
        self.assertEqual(self.daemon.get("/v1/meshes/dropped").json["fields_cached"], 0)
        self.assertEqual(self.daemon.metric("cache_fields"), before)


class Forms(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=3))
        cls.daemon.put("apart", TWO_TRIANGLES)

    def post(self, mesh, document, query="", **headers):
        return self.daemon.ask(mesh, f"matrix{query}", document, header_fields(headers))

    def test_bytes(self):
        document = {"sources": vertices([0, 3, 1]), "targets": vertices([4, 1])}
        answer = self.post("apart", document, Accept="application/octet-stream")
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "application/octet-stream"))
        self.assertEqual(answer.headers["ETag"], form_tag(self.daemon.get("/v1/meshes/apart").headers["ETag"], "float64"))
        values = struct.unpack("<6d", answer.body)
        self.assertEqual([None if math.isnan(value) else value for value in values], [None, 1, 1, None, None, 0])

    def test_bytes_are_the_json_array(self):
        document = {"sources": vertices(range(10)), "targets": vertices(range(50, 100))}
        plain = self.post("ball", document).json["distances"]
        packed = self.post("ball", document, Accept="application/octet-stream", Accept_Encoding="gzip")
        self.assertEqual(packed.headers["Content-Encoding"], "gzip")
        self.assertEqual(list(struct.unpack("<500d", gzip.decompress(packed.body))), sum(plain, []))
        zipped = self.post("ball", document, Accept_Encoding="gzip")
        self.assertEqual(json.loads(gzip.decompress(zipped.body))["distances"], plain)

    def test_json_unless_bytes_are_preferred(self):
        document = {"sources": vertices([0]), "targets": vertices([1])}
        forms = (("*/*", "json"), ("application/json, application/octet-stream", "json"), ("application/*", "json"),
                 ("application/json;q=0.5, application/octet-stream", "octet-stream"))
        for accept, form in forms:
            answer = self.post("ball", document, Accept=accept)
            self.assertEqual(answer.headers["Content-Type"], f"application/{form}", accept)
        self.assert_problem(self.post("ball", document, Accept="text/html"), 406, "not_acceptable")

    def test_fields(self):
        document = {"sources": vertices([0]), "targets": vertices([1, 4])}
        self.assertEqual(self.post("apart", document, "?select=reasons").json, {"reasons": [[None, "no_path"]]})
        self.assertEqual(list(self.post("apart", document, "?select=distances").json), ["distances", "reasons"])
        self.assert_problem(self.post("apart", document, "?select=from"), 400, "invalid_request")
        self.assert_problem(self.post("apart", document, "?via=v:1"), 400, "invalid_request")

    def test_refusals(self):
        good = vertices([0])
        for document, pointer in (({"sources": good}, "/targets"), ({"sources": [], "targets": good}, "/sources"),
                                  ({"sources": good, "targets": vertices([9999])}, "/targets/0"),
                                  ({"sources": good, "targets": good, "max_distance": 0}, "/max_distance"),
                                  ({"sources": good, "targets": good, "from": {}}, "/from")):
            problem = self.assert_problem(self.post("ball", document), 400, "invalid_request")
            self.assertEqual(problem["pointer"], pointer)
        far = {"sources": good, "targets": [{"xyz": [9, 9, 9], "max_snap": 1}]}
        problem = self.assert_problem(self.post("ball", far), 422, "point_not_on_surface")
        self.assertEqual(problem["pointer"], "/targets/0")
        self.assert_problem(self.daemon.get("/v1/meshes/ball/matrix"), 405, "method_not_allowed")
        self.assert_problem(self.post("nobody", {"sources": good, "targets": good}), 404, "not_found")

    def test_a_matrix_may_be_too_large(self):
        answer = self.post("ball", {"sources": vertices([0] * 2001), "targets": vertices([0] * 2000)})
        self.assertEqual(self.assert_problem(answer, 413, "too_large")["limit"], 4000000)


class Limits(TestCase):
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("large", sample("icosphere", level=6))

    def document(self, rows=60, columns=100):
        return {"sources": vertices(range(rows)), "targets": vertices(range(1000, 1000 + columns))}

    def test_a_deadline_ends_all_rows(self):
        begun = time.monotonic()
        answer = self.daemon.request("POST", "/v1/meshes/large/matrix?timeout_ms=100", json.dumps(self.document(500)),
                                     {"Content-Type": "application/json"})
        self.assert_problem(answer, 504, "deadline_exceeded")
        self.assertLess(time.monotonic() - begun, 3)
        self.assertEqual(self.daemon.ask("large", "distance", {"from": {"vertex": 0}, "to": {"vertex": 9}}).status, 200)

    def test_a_client_that_disconnects_ends_all_rows(self):
        body = json.dumps(self.document(500)).encode()
        head = ("POST /v1/meshes/large/matrix HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                f"Content-Length: {len(body)}\r\n\r\n")
        with socket.create_connection(("127.0.0.1", self.daemon.port)) as connection:
            connection.sendall(head.encode() + body)
            time.sleep(0.3)
        wait_until(lambda: self.daemon.metric("workers_busy") == 0, 20)

    def test_other_requests_are_answered_during_a_matrix(self):
        """Helpers return to the queue after each row, so a long matrix leaves one of the two
        workers to other requests."""
        result = []
        thread = threading.Thread(target=lambda: result.append(self.daemon.ask("large", "matrix", self.document(25))))
        thread.start()
        self.daemon.wait_for("workers_busy", 2)
        waits = []
        for number in range(5):
            begun = time.monotonic()
            pair = {"from": {"vertex": 2000 + number}, "to": {"vertex": 30000 - number}}
            answer = self.daemon.ask("large", "distance", pair)
            waits.append(time.monotonic() - begun)
            self.assertEqual(answer.status, 200)
        is_running = thread.is_alive()
        thread.join()
        self.assertEqual(result[0].status, 200, result[0])
        self.assertTrue(is_running, f"the matrix was over before the others: {waits}")

    def test_progress_is_rows_done(self):
        answer = self.daemon.request("POST", "/v1/meshes/large/matrix", json.dumps(self.document(200)),
                                     {"Content-Type": "application/json", "Prefer": "respond-async"})
        self.assertEqual(answer.status, 202, answer)
        job, seen = answer.headers["Location"], [0]
        until = time.monotonic() + 60
        while len(seen) < 5 and time.monotonic() < until:
            time.sleep(0.02)
            progress = self.daemon.get(job).json["progress"]
            self.assertGreaterEqual(progress, seen[-1])
            seen += [progress] if progress > seen[-1] else []
        self.assertLess(seen[-1], 0.5)
        self.assertEqual((len(seen), self.daemon.request("DELETE", job).status), (5, 204))

    def test_measure(self):
        """Prints a measured time and checks nothing."""
        self.daemon.put("terrain", sample("terrain", cells=173))
        document = {"sources": vertices(range(0, 30000, 300)), "targets": vertices(range(7, 30007, 30))}
        begun = time.monotonic()
        answer = self.daemon.request("POST", "/v1/meshes/terrain/matrix", json.dumps(document),
                                     {"Content-Type": "application/json", "Accept": "application/octet-stream"})
        milliseconds = 1000 * (time.monotonic() - begun)
        self.assertEqual((answer.status, len(answer.body)), (200, 800000), answer)
        size = self.daemon.get("/v1/meshes/terrain").json["vertices"]
        print(f"# matrix 100 x 1000, {size} vertices: {milliseconds:.0f} ms")


class LittleMemory(unittest.TestCase):
    mesh = staticmethod(lambda: sample("icosphere", level=4))
    document = {"sources": vertices(range(6)),
                "targets": [{"face": number, "barycentric": [0.2, 0.3, 0.5]} for number in range(1000, 1040)]}

    def least(self, workers, expected):
        """Returns the smallest budget, in MiB, with which the matrix is answered."""
        for budget in range(3, 60):
            flags = ("--workers", workers, "--memory-budget", f"{budget}MiB", "--max-body", "1MiB", "--landmarks", "0")
            with Daemon(*flags) as daemon:
                if daemon.put("ball", self.mesh()).status != 201:
                    continue
                answer = daemon.ask("ball", "matrix", self.document)
                if answer.status == 200:
                    self.assertEqual(answer.json, expected)
                    return budget
                self.assertEqual((answer.status, answer.json["code"]), (507, "insufficient_memory"), answer)
        return budget

    def test_rows_without_memory_wait_for_other_rows(self):
        """A row waits for other rows while the budget has no room for it. Several workers therefore
        need no more memory than one worker."""
        with Daemon("--workers", "2") as roomy:
            roomy.put("ball", self.mesh())
            expected = roomy.ask("ball", "matrix", self.document).json
        least = self.least("1", expected)
        self.assertGreater(least, 3)
        self.assertLessEqual(self.least("3", expected), least + 1)


if __name__ == "__main__":
    unittest.main()
