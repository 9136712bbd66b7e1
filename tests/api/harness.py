"""Starts a daemon of its own on a free port and speaks HTTP to it. Standard library only.

The program is $GEODESICD, or build/geodesicd; sample meshes come from gd_sample beside it.
"""
import functools
import http.client
import json
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest
import weakref

FORMAT_VERSION = "1"  # SERVER_FORMAT_VERSION of server/exchange/etag.h
PROGRAM = pathlib.Path(os.environ.get("GEODESICD", "build/geodesicd")).resolve()
START_SECONDS = 20  # sanitizers are slow to start
PATIENCE_SECONDS = 60
SEARCHES = 16  # number of searches from a source before its field is built: SERVER_CACHE_SEARCHES
LARGE = 10000  # a printed value with more characters than this is large

TETRAHEDRON = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"
TWO_TRIANGLES = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n"


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    @property
    def json(self):
        return json.loads(self.body)

    def __repr__(self):
        return f"<{self.status} {self.body[:300]!r}>"


@functools.cache
def sample(name, **parameters):
    """Returns the OBJ file of a sample mesh."""
    arguments = [f"{key}={value}" for key, value in parameters.items()]
    return subprocess.run([PROGRAM.parent / "gd_sample", name, *arguments], check=True, stdout=subprocess.PIPE).stdout


def header_fields(keywords):
    """Converts keywords to headers. For example, If_None_Match="*" becomes the header
    If-None-Match."""
    return {name.replace("_", "-"): value for name, value in keywords.items()}


def form_tag(etag, form):
    """Returns the ETag of an answer in that format; `etag` is the ETag of the mesh."""
    return f'{etag[:-1]}-{form}.{FORMAT_VERSION}"'


def hold_against_contract(method, path, answer):
    """Checks an answer against the contract. The API's suite (run.py) does so for every answer, not
    only for those of test_contract."""
    if os.environ.get("GEODESICD_CONTRACT") != "1":
        return
    import contract

    if faults := contract.load().faults(method, path, answer, is_thin=True):
        raise AssertionError("not as the contract says: " + "; ".join(faults))


def wait_until(look, seconds=PATIENCE_SECONDS):
    """Calls the function until its result is true, and returns the result."""
    until = time.monotonic() + seconds
    while not (found := look()):
        if time.monotonic() > until:
            raise TimeoutError(f"after {seconds} seconds there is still {found!r}")
        time.sleep(0.005)
    return found


class Daemon:
    """A running daemon, and a context manager that stops it. `log` has the lines that it has
    logged. `changes` counts the successful requests that may have changed surfaces, fields or
    jobs."""

    def __init__(self, *flags, listen="127.0.0.1:0"):
        store = () if "--data-dir" in flags else ("--store", "memory")
        self.log, self.changes = [], 0
        self.process = subprocess.Popen([PROGRAM, "--listen", listen, *store, *flags], stderr=subprocess.PIPE, text=True)
        # a failed test must not leave a daemon that holds its output open
        weakref.finalize(self, self.process.kill)
        self._listening = threading.Event()
        self._reader = threading.Thread(target=self._read_log, daemon=True)
        self._reader.start()
        self._listening.wait(START_SECONDS)
        if not any(line["event"] == "listening" for line in self.log):
            self.process.kill()
            raise RuntimeError(f"the daemon did not start: {self.log}")
        self.address = next(line["address"] for line in self.log if line.get("event") == "listening")

    def _read_log(self):
        for text in self.process.stderr:
            try:
                self.log.append(json.loads(text))
            except json.JSONDecodeError:
                self.log.append({"event": "not JSON", "message": text})
            if self.log[-1]["event"] == "listening":
                self._listening.set()
        self._listening.set()  # the daemon ended, so there is nothing to wait for

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    @property
    def port(self):
        return int(self.address.rpartition(":")[2])

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_SECONDS)

    def request(self, method, path, body=None, headers=None, connection=None):
        own = connection or self.connect()
        try:
            try:
                own.request(method, path, body, headers or {})
            except (BrokenPipeError, ConnectionResetError):
                # the daemon refused the request before the whole body was sent, and its answer has
                # arrived
                pass
            response = own.getresponse()
            answer = Answer(response.status, response.headers, response.read())
        finally:
            if not connection:
                own.close()
        self._count(method, answer)
        hold_against_contract(method, path, answer)
        return answer

    def _count(self, method, answer):
        self.changes += answer.status < 400 and (method not in ("GET", "HEAD") or answer.status == 202)

    def request_bare(self, method, path, headers):
        """Sends a request without a body, and without the Content-Length that http.client would
        add."""
        connection = self.connect()
        try:
            connection.putrequest(method, path, skip_host="Host" in headers)
            for name, value in headers.items():
                connection.putheader(name, value)
            connection.endheaders()
            response = connection.getresponse()
            answer = Answer(response.status, response.headers, response.read())
        finally:
            connection.close()
        self._count(method, answer)
        return answer

    def get(self, path, **headers):
        return self.request("GET", path, headers=header_fields(headers))

    def put(self, name, body, options="", **headers):
        return self.request("PUT", f"/v1/meshes/{name}{options}", body, header_fields(headers))

    def ask(self, name, query, document, headers=None):
        headers = {"Content-Type": "application/json", **(headers or {})}
        return self.request("POST", f"/v1/meshes/{name}/{query}", json.dumps(document), headers)

    def ask_often(self, name, source):
        """Queries a source as often as possible without building its field: the next query builds
        it."""
        connection = self.connect()
        for _ in range(SEARCHES - 1):
            answer = self.request("GET", f"/v1/meshes/{name}/distance?from={source}&to={source}", connection=connection)
            assert answer.status == 200, answer
        connection.close()

    def raw(self, text, shut=False):
        """Sends bytes unchanged. Returns all bytes until the daemon closes the connection or falls
        silent."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=3) as connection:
            received = b""
            try:
                connection.sendall(text)
                if shut:
                    connection.shutdown(socket.SHUT_WR)
                while data := connection.recv(65536):
                    received += data
            except (TimeoutError, ConnectionResetError, BrokenPipeError):
                pass
            return received

    def metric(self, name):
        """Returns the value of a metric without labels."""
        for line in self.get("/metrics").body.decode().splitlines():
            if line.startswith(f"geodesicd_{name} "):
                return float(line.split()[1])
        raise KeyError(name)

    def wait_for(self, name, least=1):
        """Waits until the metric has at least that value; returns it."""
        return wait_until(lambda: (value := self.metric(name)) >= least and value)

    def wait_for_flight(self, most=0):
        """Waits until requests hold at most that many bytes. A request returns its memory after the
        last byte of the answer was sent, so the client may have the answer earlier."""
        wait_until(lambda: self.metric('memory_bytes{class="flight"}') <= most)

    def ended(self, accepted):
        """Waits for the job of an accepted request to end, and returns it."""
        assert accepted.status == 202, accepted
        return wait_until(lambda: (job := self.get(accepted.headers["Location"]).json)["state"] not in ("queued", "running") and job)

    def terminate(self):
        self.process.send_signal(signal.SIGTERM)

    def reload(self):
        """Sends SIGHUP and returns the event that the daemon logs about it."""
        before = len(self.reloads())
        self.process.send_signal(signal.SIGHUP)
        return wait_until(lambda: self.reloads()[before:])[-1]

    def reloads(self):
        return [line for line in self.log if line["event"] in ("reloaded", "reload_failed")]

    def stop(self):
        """Ends the daemon by SIGTERM, as an operator does. Returns its exit status. Fails if the
        daemon has printed anything except its log, for example a sanitizer's report."""
        if self.process.poll() is None:
            self.terminate()
        try:
            status = self.process.wait(PATIENCE_SECONDS)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        self._reader.join(PATIENCE_SECONDS)
        self.process.stderr.close()
        noise = "".join(line["message"] for line in self.log if line["event"] == "not JSON")
        if noise and status != -signal.SIGKILL:
            raise AssertionError(f"the daemon ended with {status}: {noise}")
        return status


class Folder(unittest.TestCase):
    """Gives each test its own data folder."""

    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.place.name) / "data"

    def tearDown(self):
        self.place.cleanup()

    def start(self, *flags):
        return Daemon("--data-dir", str(self.folder), *flags)


class TestCase(unittest.TestCase):
    """Tests that share a daemon, started with the class's `flags`. The daemon must exit with status
    0."""

    flags = ()

    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(*cls.flags)

    @classmethod
    def tearDownClass(cls):
        status = cls.daemon.stop()
        if status != 0:
            raise AssertionError(f"the daemon ended with {status}")

    @classmethod
    def skip_without_pages(cls):
        """Skips the test if the daemon was built without the viewer and the docs."""
        if b"VIEWER=no" in cls.daemon.get("/").body:
            raise unittest.SkipTest("this daemon was built without the viewer (VIEWER=no)")

    @classmethod
    def put_all(cls, meshes):
        """Uploads meshes by name; returns their descriptions by name."""
        answers = {name: cls.daemon.put(name, body) for name, body in meshes.items()}
        assert all(answer.status == 201 for answer in answers.values()), answers
        return {name: answer.json for name, answer in answers.items()}

    def asked(self, mesh, query, document, status=200, headers=None):
        """Returns a query's answer as JSON; asserts its status."""
        answer = self.daemon.ask(mesh, query, document, headers)
        self.assertEqual(answer.status, status, answer)
        return answer.json

    def assertEqual(self, first, second, msg=None):
        """Like unittest's assertEqual, but prints only the first difference of large values.
        unittest computes all differences, which can take hours."""
        if first == second:
            return
        texts = repr(first), repr(second)
        if max(map(len, texts)) < LARGE:
            return super().assertEqual(first, second, msg)
        at = len(os.path.commonprefix(texts))
        around = [text[max(0, at - 40):at + 80] for text in texts]
        self.fail(self._formatMessage(msg, f"they differ at character {at} of {len(texts[0])} and {len(texts[1])}: {around[0]!r} is not {around[1]!r}"))

    def assert_place(self, actual, expected, places=12):
        self.assertEqual(len(actual), len(expected))
        for a, b in zip(actual, expected):
            self.assertAlmostEqual(a, b, places)

    def assert_problem(self, answer, status, code):
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (status, "application/problem+json"), answer)
        problem = answer.json
        self.assertEqual((problem["status"], problem["code"]), (status, code))
        self.assertEqual(problem["type"], f"urn:geodesicd:problem:{code}")
        self.assertTrue(problem["title"] and problem["detail"])
        return problem
