"""Tests query lists: the answer to each line equals the answer to the same query alone."""
import gzip
import http.client
import json
import random
import threading
import time
import unittest
import zlib

from harness import SEARCHES, TWO_TRIANGLES, Daemon, TestCase, form_tag, header_fields, sample, wait_until

NDJSON = {"Content-Type": "application/x-ndjson"}


def lines_of(*documents):
    return "".join(json.dumps(document) + "\n" for document in documents)


class Batches(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=3))
        cls.daemon.put("apart", TWO_TRIANGLES)

    def batch(self, mesh, body, query="", **headers):
        return self.daemon.request("POST", f"/v1/meshes/{mesh}/batch{query}", body, {**NDJSON, **header_fields(headers)})

    def answers(self, mesh, body, query=""):
        answer = self.batch(mesh, body, query)
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "application/x-ndjson"), answer)
        self.assertEqual(answer.headers["ETag"], form_tag(self.daemon.get(f"/v1/meshes/{mesh}").headers["ETag"], "ndjson"))
        self.assertTrue(not answer.body or answer.body.endswith(b"\n"))
        return [json.loads(line) for line in answer.body.splitlines()]

    def assert_line(self, answer, status, code, line):
        found = answer["status"], answer["code"], answer["elements"]
        self.assertEqual(found, (status, code, [{"line": line}]), answer)
        self.assertEqual(answer["type"], f"urn:geodesicd:problem:{code}")
        return answer

    def test_each_line_is_a_separate_query(self):
        a, b, c = {"vertex": 3}, {"xyz": [1, 2, 3]}, {"face": 7, "barycentric": [0.5, 0.25, 0.25]}
        queries = [
            ("distance", {"from": a, "to": b}),
            ("path", {"from": b, "to": c, "via": [a]}),
            ("nearest", {"point": b}),
            ("matrix", {"sources": [a, b], "targets": [a, b, c]}),
            ("matrix", {"sources": [a] * 9, "targets": [b, c] * 9, "max_distance": 1.5}),
            ("distance-to-set", {"set": {"points": [{**a, "label": "a"}, {**b, "offset": 0.5}]}, "points": [b, c], "path": True}),
            ("spline", {"points": [a, b, c], "closed": True, "samples": 4, "frames": True}),
            ("spline", {"points": [a, c], "samples": 3, "evaluation": "de_casteljau"}),
            ("trace", {"start": c, "fan": 3, "length": 2}),
            ("transport", {"from": a, "to": c, "vectors": [{"direction": 0.5, "length": 1}]}),
            ("voronoi", {"set": {"points": [a, b, c]}}),
        ]
        expected = [self.daemon.ask("ball", name, document) for name, document in queries]
        found = self.answers("ball", lines_of(*({"query": name, **document} for name, document in queries)))
        self.assertEqual(found, [{"status": answer.status, **answer.json} for answer in expected])

    def test_problems_equal_those_of_single_queries(self):
        queries = [("distance", {"from": {"vertex": 9999}, "to": {"vertex": 1}}), ("path", {"from": {"vertex": 0}}),
                   ("nearest", {"point": {"ray": {"origin": [9, 9, 9], "direction": [1, 0, 0]}}}),
                   ("matrix", {"sources": [{"vertex": 0}] * 2500, "targets": [{"vertex": 0}] * 2500}),
                   ("distance-to-set", {"set": {"points": []}, "points": [{"vertex": 0}]}),
                   ("distance-to-set", {"set": {"points": [{"vertex": 0}]}, "points": [{"vertex": 9999}]}),
                   ("distance", {"from": {"vertex": 0}, "to": {"vertex": 1}, "path": True})]
        found = self.answers("ball", lines_of(*({"query": name, **document} for name, document in queries)))
        for number, (name, document) in enumerate(queries):
            alone = self.daemon.ask("ball", name, document)
            self.assertEqual({**alone.json, "elements": [{"line": number + 1}]}, found[number])

    def test_a_bad_line_spoils_only_itself(self):
        good = json.dumps({"query": "distance", "from": {"vertex": 0}, "to": {"vertex": 1}, "select": "distance"})
        bad = ["nonsense", "[]", "{}", '{"query": 3}', '{"query": "batch"}', '{"query": "distance"', "\x00", "\xff",
               '"x"', "{} {}", '{"query":"distance","query":"path"}', "[" * 50]
        body = "".join(f"{good}\n{line}\n" for line in bad)
        found = self.answers("ball", body.encode("latin-1"))
        self.assertEqual(len(found), 2 * len(bad))
        self.assertEqual(len({json.dumps(answer) for answer in found[::2]}), 1)
        self.assertEqual(found[0]["status"], 200)
        for number, answer in enumerate(found[1::2]):
            self.assert_line(answer, 400, "invalid_request", 2 * number + 2)

    def test_the_error_of_an_unknown_query_lists_the_queries(self):
        names = ["distance", "path", "nearest", "matrix", "distance-to-set", "curve-distance", "spline", "trace", "transport", "voronoi"]
        answer, *others = self.answers("ball", lines_of({"query": "range"}, *({"query": name} for name in names)))
        self.assertEqual(answer["detail"], f'a batch has no query "range"; it takes {", ".join(names)}')
        for other in others:
            self.assertNotEqual(other["pointer"], "/query")

    def test_blank_lines_are_skipped_and_counted(self):
        line = '{"query":"nearest","point":{"vertex":0},"select":["vertex"]}'
        found = self.answers("ball", f"\n\n{line}\r\n \t\r\n\nnonsense\n{line}")
        self.assertEqual(found[::2], [{"status": 200, "vertex": 0}] * 2)
        self.assert_line(found[1], 400, "invalid_request", 6)
        self.assertEqual(self.answers("ball", "\n \n"), [])
        self.assertEqual(self.answers("ball", ""), [])

    def test_fields_and_geometry(self):
        pair = {"from": {"vertex": 0}, "to": {"vertex": 30}}
        found = self.answers("ball", lines_of(
            {"query": "distance", **pair, "select": "distance"},
            {"query": "distance", **pair, "select": ["to", "distance"]},
            {"query": "path", **pair, "select": ["path"], "geometry": "xyz"},
            {"query": "path", **pair, "geometry": "none"},
            {"query": "distance", **pair, "select": "reason"},
            {"query": "distance", **pair, "select": "path"},
            {"query": "distance", **pair, "geometry": "all"},
            {"query": "distance", **pair, "select": 3}))
        self.assertEqual([list(answer) for answer in found[:2]], [["status", "distance"], ["status", "distance", "to"]])
        self.assertTrue(all(len(point) == 3 for point in found[2]["path"]["points"]))
        self.assertEqual(list(found[3]["path"]), ["length"])
        self.assertEqual(found[4], {"status": 200})
        for number, pointer in ((5, "/select"), (6, "/geometry"), (7, "/select")):
            self.assertEqual(self.assert_line(found[number], 400, "invalid_request", number + 1)["pointer"], pointer)

    def test_options_of_the_query_string_are_defaults(self):
        pair = {"from": {"vertex": 0}, "to": {"vertex": 30}}
        body = lines_of({"query": "path", **pair}, {"query": "path", **pair, "geometry": "full", "select": "path"},
                        {"query": "nearest", "point": {"vertex": 0}})
        found = self.answers("ball", body, "?select=distance,path&geometry=none")
        self.assertEqual((list(found[0]), list(found[0]["path"])), (["status", "distance", "path"], ["length"]))
        self.assertEqual((list(found[1]), list(found[1]["path"])), (["status", "path"], ["length", "points"]))
        self.assertEqual(self.assert_line(found[2], 400, "invalid_request", 3)["parameter"], "select")
        for query in ("?geometry=all", "?from=v:0", "?timeout_ms=0"):
            self.assert_problem(self.batch("ball", body, query), 400, "invalid_request")

    def test_no_path(self):
        found = self.answers("apart", lines_of(
            {"query": "path", "from": {"vertex": 0}, "to": {"vertex": 4}},
            {"query": "matrix", "sources": [{"vertex": 0}], "targets": [{"vertex": 4}]}))
        self.assertEqual((found[0]["distance"], found[0]["reason"], found[0]["path"]), (None, "no_path", None))
        self.assertEqual(found[1], {"status": 200, "distances": [[None]], "reasons": [["no_path"]]})

    def test_media_types(self):
        line = lines_of({"query": "nearest", "point": {"vertex": 0}})
        self.assert_problem(self.batch("ball", line, Content_Type="application/json"), 415, "unsupported_media_type")
        self.assertEqual(self.batch("ball", line, Content_Type="Application/X-NDJSON; charset=utf-8").status, 200)
        self.assert_problem(self.batch("ball", line, Accept="application/json"), 406, "not_acceptable")
        self.assertEqual(self.batch("ball", line, Accept="application/*").status, 200)

    def test_compressed(self):
        body = lines_of({"query": "path", "from": {"vertex": 0}, "to": {"vertex": 300}}) * 5
        plain, packed = self.batch("ball", body), self.batch("ball", body, Accept_Encoding="gzip")
        self.assertEqual(packed.headers["Content-Encoding"], "gzip")
        self.assertEqual(gzip.decompress(packed.body), plain.body)

    def test_too_long_lines_and_bodies_are_refused(self):
        long = {"query": "matrix", "sources": [{"vertex": 0}], "targets": [{"vertex": 0}] * 20000}
        good = {"query": "nearest", "point": {"vertex": 0}}
        found = self.answers("ball", lines_of(good, long, good))
        self.assertEqual(self.assert_line(found[1], 413, "too_large", 2)["limit"], 262144)
        self.assertEqual(found[0], found[2])
        answer = self.batch("ball", lines_of(good) * 40000)
        self.assertIn("limit", self.assert_problem(answer, 413, "too_large"))

    def test_an_absent_mesh(self):
        answer = self.batch("nobody", lines_of({"query": "nearest", "point": {"vertex": 0}}))
        self.assert_problem(answer, 404, "not_found")

    def test_many_lines(self):
        numbers = random.Random(7)
        pairs = [(numbers.randrange(642), numbers.randrange(642)) for _ in range(2000)]
        found = self.answers("ball", lines_of(*(
            {"query": "distance", "from": {"vertex": a}, "to": {"vertex": b}, "select": "distance"} for a, b in pairs)))
        every = [{"vertex": number} for number in range(642)]
        matrix = self.daemon.ask("ball", "matrix", {"sources": every, "targets": every}).json["distances"]
        for (a, b), answer in zip(pairs, found, strict=True):
            self.assertAlmostEqual(answer["distance"], matrix[a][b], 12)

    def test_a_frequent_source_gets_a_field(self):
        self.daemon.put("fresh", sample("icosphere", level=4))
        builds = self.daemon.metric("cache_builds_total")
        targets = range(100, 100 + 2 * SEARCHES)
        self.answers("fresh", lines_of(*(
            {"query": "distance", "from": {"vertex": 7}, "to": {"vertex": number}} for number in targets)))
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds + 1)

    def test_remaining_lines_get_the_deadline_problem(self):
        self.daemon.put("large", sample("icosphere", level=6))
        some = [{"vertex": number} for number in range(300)]
        slow = {"query": "matrix", "sources": some, "targets": some}
        quick = {"query": "nearest", "point": {"vertex": 0}}
        begun = time.monotonic()
        found = self.answers("large", lines_of(quick, slow, quick), "?timeout_ms=200")
        self.assertLess(time.monotonic() - begun, 3)
        self.assertEqual(found[0]["status"], 200)
        self.assert_line(found[1], 504, "deadline_exceeded", 2)
        self.assert_line(found[2], 504, "deadline_exceeded", 3)

    def test_collected_answers_have_a_largest_size(self):
        many = [{"vertex": number} for number in range(642)] * 3
        row = {"query": "matrix", "sources": many, "targets": many}
        started = self.batch("ball", lines_of(row, row, row), Prefer="respond-async")
        self.assertEqual(started.status, 202)
        self.assertEqual(self.daemon.ended(started)["state"], "done")
        found = [json.loads(line) for line in self.daemon.get(started.headers["Location"] + "/result").body.splitlines()]
        self.assertEqual([answer["status"] for answer in found], [200, 413, 413])
        self.assertEqual(self.assert_line(found[1], 413, "too_large", 2)["limit"], 64 << 20)
        self.assertEqual([answer["status"] for answer in self.answers("ball", lines_of(row, row))], [200] * 2)


class Streams(TestCase):
    """If any line takes time, answers are sent as soon as they are ready."""
    QUICK = {"query": "nearest", "point": {"vertex": 0}}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=3))
        cls.daemon.put("large", sample("icosphere", level=6))
        some = [{"vertex": number} for number in range(8)]
        cls.slow = {"query": "matrix", "sources": some, "targets": some, "select": "distances"}

    def begin(self, mesh, body, query="", **headers):
        """Sends a batch; returns the connection and the unread answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=60)
        connection.request("POST", f"/v1/meshes/{mesh}/batch{query}", body, {**NDJSON, **headers})
        answer = connection.getresponse()
        self.addCleanup(connection.close)
        self.addCleanup(answer.close)
        return connection, answer

    def test_lines_are_sent_in_order_as_soon_as_they_are_ready(self):
        connection, answer = self.begin("large", lines_of(self.QUICK, self.slow, self.QUICK, self.slow, {"query": "x"}))
        self.assertEqual((answer.status, answer.getheader("Transfer-Encoding")), (200, "chunked"))
        self.assertEqual(answer.getheader("ETag"), form_tag(self.daemon.get("/v1/meshes/large").headers["ETag"], "ndjson"))
        found, times = [], []
        for line in answer:
            found.append(json.loads(line))
            times.append(time.monotonic())
        self.assertEqual([line["status"] for line in found], [200, 200, 200, 200, 400])
        self.assertEqual(["vertex" in line for line in found], [True, False, True, False, False])
        self.assertEqual(found[1], found[3])
        self.assertGreater(times[1] - times[0], 0.02)
        self.assertGreater(times[3] - times[2], 0.02)
        connection.request("GET", "/livez")  # the connection stays usable
        self.assertEqual(connection.getresponse().status, 200)

    def test_quick_lines_are_sent_together(self):
        _, answer = self.begin("ball", lines_of(self.QUICK, self.QUICK))
        self.assertEqual(answer.getheader("Transfer-Encoding"), None)
        self.assertEqual(len(answer.read()), int(answer.getheader("Content-Length")))

    def test_the_stream_equals_the_collected_answer(self):
        numbers = random.Random(3)
        body = lines_of(*({"query": "path", "from": {"vertex": numbers.randrange(642)}, "to": {"vertex": numbers.randrange(642)}}
                          for _ in range(500)))
        started = self.daemon.request("POST", "/v1/meshes/ball/queries", body, {**NDJSON, "Prefer": "respond-async"})
        self.assertEqual(self.daemon.ended(started)["state"], "done")
        whole = self.daemon.get(started.headers["Location"] + "/result").body
        for coding in ("identity", "gzip"):
            _, answer = self.begin("ball", body, **{"Accept-Encoding": coding})
            self.assertEqual((answer.getheader("Transfer-Encoding"), answer.getheader("Vary")), ("chunked", "Accept-Encoding"))
            bytes_read = answer.read()
            self.assertEqual(answer.getheader("Content-Encoding"), "gzip" if coding == "gzip" else None)
            found = gzip.decompress(bytes_read) if coding == "gzip" else bytes_read
            self.assertEqual([self.rounded(line) for line in found.splitlines()], [self.rounded(line) for line in whole.splitlines()])

    @staticmethod
    def rounded(line):
        answer = json.loads(line)
        return answer["status"], round(answer["distance"], 9), answer["from"], answer["to"]

    def test_a_packed_line_can_be_read_at_once(self):
        connection, answer = self.begin("large", lines_of(self.QUICK, *[self.slow] * 20), **{"Accept-Encoding": "gzip"})
        unpacker = zlib.decompressobj(31)
        line = b""
        while b"\n" not in line:
            line += unpacker.decompress(answer.read1(4096))
        self.assertEqual(json.loads(line.splitlines()[0])["vertex"], 0)
        connection.close()
        wait_until(self.is_idle, 10)

    def is_idle(self):
        return self.daemon.metric("workers_busy") == 0

    def test_a_client_that_disconnects_stops_the_work(self):
        connection, answer = self.begin("large", lines_of(self.QUICK, *[self.slow] * 1000))
        answer.readline()
        self.assertFalse(self.is_idle())
        connection.close()
        answer.close()
        wait_until(self.is_idle, 10)

    def test_a_slow_reader_stops_the_work_and_memory_stays_bounded(self):
        every = [{"vertex": number} for number in range(642)]
        row = {"query": "matrix", "sources": every, "targets": every, "select": "distances"}  # 7 MB
        connection, answer = self.begin("ball", lines_of(*[row] * 6))
        wait_until(self.is_idle)  # the work is suspended and occupies no worker
        self.daemon.wait_for_flight(24 << 20)
        found = [json.loads(line)["status"] for line in answer]
        self.assertEqual(found, [200] * 6)
        connection.close()

    def test_lines_after_the_deadline_get_504(self):
        _, answer = self.begin("large", lines_of(self.QUICK, *[self.slow] * 1000), "?timeout_ms=300")
        found = [json.loads(line) for line in answer]
        self.assertEqual((len(found), found[0]["status"], found[-1]["status"], found[-1]["code"]),
                         (1001, 200, 504, "deadline_exceeded"))
        self.assertEqual(found[-1]["elements"], [{"line": 1001}])

    def test_the_end_of_the_daemon(self):
        with Daemon("--drain-ms", "300") as daemon:
            daemon.put("large", sample("icosphere", level=6))
            connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=60)
            connection.request("POST", "/v1/meshes/large/queries", lines_of(self.QUICK, *[self.slow] * 1000), NDJSON)
            answer = connection.getresponse()
            answer.readline()
            self.assertEqual(daemon.stop(), 0)
            found = [json.loads(line)["status"] for line in answer]
            connection.close()
            self.assertEqual((len(found), found[-1]), (1000, 503))


class Parked(unittest.TestCase):
    def test_a_line_waits_for_a_field_that_another_request_builds(self):
        with Daemon("--workers", "4") as daemon:
            daemon.put("large", sample("icosphere", level=5))
            daemon.ask_often("large", "v:5")
            results = []
            body = lines_of(*(
                {"query": "distance", "from": {"vertex": 5}, "to": {"vertex": number}} for number in range(1000, 1010)))

            def ask():
                results.append(daemon.request("POST", "/v1/meshes/large/queries", body, NDJSON))

            threads = [threading.Thread(target=ask) for _ in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual({answer.status for answer in results}, {200})
            self.assertEqual(len({answer.body for answer in results}), 1)
            self.assertEqual(daemon.metric("cache_builds_total"), 1)


if __name__ == "__main__":
    unittest.main()
