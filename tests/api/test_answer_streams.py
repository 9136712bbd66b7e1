"""Answer streams: large answers are encoded while their clients read them. Streamed answers have
the same bytes as answers that are stored for jobs."""
import gzip
import json
import socket
import time

from harness import Daemon, TestCase, sample, wait_until

MIB = 1 << 20
STREAMS = 32  # number of simultaneous streams
JSON = {"Content-Type": "application/json"}
# its answer has about 9 MiB
TRACE = ("trace", {"start": {"vertex": 0}, "fan": 8, "length": 1e6, "step_limit": 14000})


def in_ring(count):
    return [{"vertex": i} for i in range(0, 48, 48 // count)]


def square(count):
    those = [{"vertex": i % 24} for i in range(count)]
    return {"sources": those, "targets": those}


QUERIES = (
    TRACE,
    ("curve", {"curve": {"points": in_ring(4), "closed": True}, "operation": "resample", "count": 30000}),
    ("spline", {"points": in_ring(8), "samples": 1000, "frames": True}),
    ("matrix", square(400)),
    ("voronoi", {"set": {"points": [{"vertex": 97 * i} for i in range(12)]}, "tolerance": 1e-9}),
    ("cut", {"curve": {"points": [{"vertex": 24 * i} for i in range(48)], "closed": True}, "select_only": True}),
)


class Streams(TestCase):
    flags = ("--workers", "2", "--landmarks", "0", "--memory-budget", "512MiB")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ring", sample("torus", columns=48, rows=24))
        cls.daemon.put("fine", sample("terrain", cells=250, amplitude=1))
        field = cls.daemon.ask("fine", "fields", {"set": {"points": [{"vertex": 0}, {"vertex": 700}]}}).json["id"]
        cls.values = f"/v1/meshes/fine/fields/{field}/values"
        cls.isolines = f"/v1/meshes/fine/fields/{field}/isolines?count=50&arcs=true"

    def tearDown(self):
        wait_until(lambda: not self.daemon.metric("answer_streams"))
        self.assertEqual(self.daemon.metric("answer_streams_held_bytes"), 0)

    def open(self, kind, document, version="1.1", headers="", daemon=None):
        body = json.dumps(document).encode()
        connection = socket.socket()
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(60)
        connection.connect(("127.0.0.1", (daemon or self.daemon).port))
        connection.sendall(f"POST /v1/meshes/ring/{kind} HTTP/{version}\r\nHost: localhost\r\nContent-Type: application/json\r\n{headers}"
                           f"Connection: close\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
        return connection

    def rest(self, connection):
        received = []
        while data := connection.recv(1 << 20):
            received.append(data)
        connection.close()
        return b"".join(received)

    def result_of_job(self, kind, document):
        job = self.daemon.ended(self.daemon.ask("ring", kind, document, {"Prefer": "respond-async"}))
        return self.daemon.get(f"/v1/jobs/{job['id']}/result").body

    def count(self, *names):
        return [self.daemon.metric(name) for name in names]

    def test_a_stream_equals_the_stored_answer_of_a_job(self):
        for kind, document in QUERIES:
            with self.subTest(kind):
                kept = self.result_of_job(kind, document)
                whole = self.daemon.ask("ring", kind, document)
                self.assertEqual((whole.status, whole.headers["Content-Length"]), (200, str(len(whole.body))), kind)
                self.assertEqual(whole.body, kept)
                packed = self.daemon.ask("ring", kind, document, {"Accept-Encoding": "gzip"})
                self.assertEqual((packed.status, packed.headers["Content-Encoding"]), (200, "gzip"))
                self.assertEqual(gzip.decompress(packed.body), kept)
                old = self.rest(self.open(kind, document, version="1.0"))
                self.assertEqual(old.partition(b"\r\n\r\n")[2], kept)

    def test_a_get_is_streamed(self):
        for path in (self.values, self.isolines):
            whole = self.daemon.get(path)
            self.assertGreater(len(whole.body), MIB)
            self.assertIn("Accept-Encoding", ", ".join(whole.headers.get_all("Vary")))
            head = self.daemon.request("HEAD", path)
            self.assertEqual((head.headers["Content-Length"], head.headers["ETag"]), (str(len(whole.body)), whole.headers["ETag"]))
            known = self.daemon.get(path, If_None_Match=whole.headers["ETag"])
            self.assertEqual((known.status, known.body), (304, b""))
            packed = self.daemon.get(path, Accept_Encoding="gzip")
            self.assertEqual(gzip.decompress(packed.body), whole.body)
            self.assertNotEqual(packed.headers["ETag"], whole.headers["ETag"])

    def read_slowly(self, connection):
        received = connection.recv(4096)
        for _ in range(20):
            time.sleep(0.02)
            received += connection.recv(65536)
        return received

    def test_an_unread_stream_holds_its_state(self):
        whole = self.daemon.ask("ring", *TRACE).body
        connection = self.open(*TRACE)
        self.daemon.wait_for("answer_streams")
        wait_until(lambda: not self.daemon.metric("requests_deferred"))
        held = self.daemon.metric("answer_streams_held_bytes")
        self.assertTrue(len(whole) / 3 < held < len(whole) / 1.5, (held, len(whole)))
        received = self.read_slowly(connection)
        self.assertEqual(self.daemon.metric("answer_streams"), 1)
        received += self.rest(connection)
        self.assertEqual(received.partition(b"\r\n\r\n")[2], whole)

    def test_packed_for_a_slow_reader(self):
        connection = self.open(*TRACE, headers="Accept-Encoding: gzip\r\n")
        received = self.read_slowly(connection) + self.rest(connection)
        chunks, rest = [], received.partition(b"\r\n\r\n")[2]
        while rest:
            size, _, rest = rest.partition(b"\r\n")
            chunks.append(rest[:int(size, 16)])
            rest = rest[int(size, 16) + 2:]
        self.assertEqual(chunks[-1], b"")
        self.assertEqual(gzip.decompress(b"".join(chunks)), self.daemon.ask("ring", *TRACE).body)

    def test_a_stream_ends_when_its_client_disconnects(self):
        for size in (0, 100, 1000000):
            connection = self.open(*TRACE)
            self.daemon.wait_for("answer_streams")
            left = size
            while left > 0:
                left -= len(connection.recv(left))
            connection.close()
            wait_until(lambda: not self.daemon.metric("answer_streams"))

    def test_answers_beyond_the_pool_are_whole_texts(self):
        crowd = [self.open(*TRACE) for _ in range(STREAMS + 4)]
        wait_until(lambda: self.daemon.metric("answer_streams") == STREAMS and not self.daemon.metric("requests_deferred"))
        texts = {self.rest(connection).partition(b"\r\n\r\n")[2] for connection in reversed(crowd)}
        self.assertEqual(len(texts), 1)
        self.assertEqual(texts.pop(), self.daemon.ask("ring", *TRACE).body)

    def test_a_stream_has_the_size_limit_of_answers(self):
        size = len(self.daemon.ask("ring", *TRACE).body)
        for most, status in ((size - 1, 507), (size + 1000, 200)):
            with Daemon("--max-answer", str(most), "--landmarks", "0") as daemon:
                daemon.put("ring", sample("torus", columns=48, rows=24))
                answer = daemon.ask("ring", *TRACE)
                self.assertEqual(answer.status, status)
                self.assertEqual(answer.json.get("limit"), None if status == 200 else most)

    def test_ends_with_the_daemon(self):
        with Daemon("--drain-ms", "300", "--landmarks", "0") as daemon:
            daemon.put("ring", sample("torus", columns=48, rows=24))
            crowd = [self.open(*TRACE, daemon=daemon) for _ in range(3)]
            wait_until(lambda: daemon.metric("answer_streams") == len(crowd))
            began = time.monotonic()
            self.assertEqual(daemon.stop(), 0)
            self.assertLess(time.monotonic() - began, 8)
            for connection in crowd:
                connection.close()
