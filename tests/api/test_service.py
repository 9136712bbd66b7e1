"""The daemon as a whole: start, health, headers, who may speak to it, the two lanes, overload, deadlines, drain."""
import concurrent.futures
import email.utils
import gzip
import itertools
import json
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SEARCHES, SQUARE, Daemon, TestCase, sample, wait_until


def slow_mesh():
    """A mesh on which one field takes long enough to watch: a rough terrain without flat parts."""
    return sample("terrain", cells=256, amplitude=1)


# What the processor must be able to do for each of the kernels, slowest first.
KERNELS = {"baseline": set(), "avx2": {"avx2"}, "avx512": {"avx512f", "avx512vl", "avx512dq"}}


PAGES = {"/": "text/html", "/app.js": "text/javascript", "/style.css": "text/css", "/docs": "text/html", "/docs/app.js": "text/javascript",
         "/docs/app.css": "text/css", "/licenses.txt": "text/plain"}


def own_kernels():
    """Those that this machine can run, slowest first."""
    flags = re.search(r"^flags\s*:(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    abilities = set(flags[1].split()) if flags else set()
    return [name for name, needed in KERNELS.items() if needed <= abilities]


def all_of(count, call):
    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        return list(pool.map(call, range(count)))


def run(*flags, environment=None):
    return subprocess.run([PROGRAM, *flags], capture_output=True, text=True, timeout=PATIENCE_SECONDS, env=environment)


class Start(unittest.TestCase):
    def assert_refused(self, result, *words):
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)

    def test_help_and_version(self):
        answer = run("--help")
        self.assertEqual(answer.returncode, 0)
        for flag in ("--listen", "--cpu", "--landmarks", "--memory-budget", "--drain-ms"):
            self.assertIn(flag, answer.stdout)
        self.assertRegex(run("--version").stdout, r"^geodesicd \d+\.\d+\.\d+\n$")

    def test_wrong_flags(self):
        self.assert_refused(run("--wrokers", "3"), "--workers")
        self.assert_refused(run("--workers"), "value")
        self.assert_refused(run("--workers", "many"), "whole number")
        self.assert_refused(run("--memory-budget", "4 apples"), "size")
        self.assert_refused(run("--landmarks", "17"), "0 to 16")
        self.assert_refused(run("workers"), "--")

    def test_other_addresses_than_loopback_need_keys(self):
        for address in ("0.0.0.0:0", "[::]:0", "192.0.2.1:80"):
            self.assert_refused(run("--listen", address), "refusing to listen", "keys")

    def test_a_taken_port(self):
        with Daemon() as daemon:
            result = run("--listen", daemon.address, "--store", "memory")
            self.assertEqual(result.returncode, 1)
            self.assertIn("start_failed", result.stderr)

    def test_environment_and_file(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "geodesicd.conf"
            file.write_text("# limits\nworkers = 3\nmax-body = 2MiB # small\n")
            with Daemon("--config", str(file), "--max-body", "3MiB") as daemon:
                limits = daemon.get("/v1").json["limits"]
                self.assertEqual((limits["workers"], limits["max_body_bytes"]), (3, 3 << 20))
            file.write_text("wrokers = 3\n")
            self.assert_refused(run("--config", str(file)), f"{file}:1", "workers")
        self.assert_refused(run(environment={"GEODESICD_WORKERS": "none"}), "GEODESICD_WORKERS")

    def test_kernels_that_do_not_exist(self):
        self.assert_refused(run("--cpu", "sse"), "'sse'", "auto, baseline, avx2 or avx512")
        self.assert_refused(run(environment={"GEODESICD_CPU": ""}), "GEODESICD_CPU")

    def test_kernels_that_this_machine_lacks(self):
        for name in set(KERNELS) - set(own_kernels()):
            result = run("--cpu", name, "--store", "memory", "--listen", "127.0.0.1:0")
            self.assertEqual(result.returncode, 1, result)
            self.assertIn(f"--cpu {name} ", json.loads(result.stderr)["message"])

    def test_unix_socket(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "geodesicd.socket"
            with Daemon(listen=f"unix:{path}"):
                with socket.socket(socket.AF_UNIX) as connection:
                    connection.connect(str(path))
                    connection.sendall(b"GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
                    self.assertTrue(connection.recv(4096).startswith(b"HTTP/1.1 200 "))
            self.assertFalse(path.exists())


class Cpu(unittest.TestCase):
    """Kernels are a matter of speed: what a client sees is the same to the last bit, by searches and from fields."""

    def answers(self, cpu, files):
        with Daemon("--cpu", cpu, "--landmarks", "0") as daemon:
            name = cpu if cpu != "auto" else own_kernels()[-1]
            self.assertIn(f'cpu="{name}"', daemon.get("/metrics").body.decode())
            self.assertEqual([line["cpu"] for line in daemon.log if line["event"] == "listening"], [name])
            bodies = []

            def ask(name, start, end):
                answer = daemon.get(f"/v1/meshes/{name}/path?from={start}&to={end}")
                self.assertEqual(answer.status, 200, answer)
                bodies.append(answer.body)

            for number, file in enumerate(files):
                name = f"m{number}"
                faces = daemon.put(name, file).json["faces"]
                for source in range(8):
                    ask(name, f"f:{source * 97 % faces}:0.2,0.3,0.5", f"f:{source * 389 % faces}:0.6,0.3,0.1")
                daemon.ask_often(name, "v:7")
                for target in range(8):
                    ask(name, "v:7", f"f:{target * 389 % faces}:0.6,0.3,0.1")
            self.assertEqual(daemon.metric("cache_builds_total"), len(files))
            self.assertEqual(daemon.metric("cache_hits_total"), 7 * len(files))
            return bodies

    def test_answers_are_the_same_to_the_last_bit(self):
        files = [sample("icosphere", level=4), sample("terrain", cells=32, amplitude=1), sample("torus")]
        expected = self.answers("baseline", files)
        for cpu in ("auto", *own_kernels()[1:]):
            self.assertEqual(self.answers(cpu, files), expected, cpu)


class Pages(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        if b"VIEWER=no" in cls.daemon.get("/").body:
            super().tearDownClass()
            raise unittest.SkipTest("this daemon was built without the viewer")

    def test_pages(self):
        self.assertEqual(self.daemon.get("/openapi.json").json["openapi"][:3], "3.1")
        for path, media_type in PAGES.items():
            plain, packed = self.daemon.get(path), self.daemon.get(path, Accept_Encoding="gzip")
            self.assertEqual((plain.status, plain.headers["Content-Type"].split(";")[0]), (200, media_type), path)
            self.assertEqual((packed.headers["Content-Encoding"], gzip.decompress(packed.body)), ("gzip", plain.body))
            head = self.daemon.request("HEAD", path)
            self.assertEqual((head.status, head.body, head.headers["ETag"]), (200, b"", plain.headers["ETag"]))
            self.assertEqual(head.headers["Content-Length"], str(len(plain.body)))
            for answer in (plain, packed):
                self.assertEqual((answer.headers["Vary"], answer.headers["Cache-Control"]), ("Accept-Encoding", "no-cache"))
                self.assertEqual(self.daemon.get(path, If_None_Match=answer.headers["ETag"]).status, 304)

    def test_an_index_is_its_folder(self):
        for index in ("/index.html", "/docs/index.html"):
            folder = index.removesuffix("index.html")
            tags = {self.daemon.get(path).headers["ETag"] for path in (index, folder, folder.rstrip("/") or "/")}
            self.assertEqual(len(tags), 1, index)
        for path in ("/docs/none.js", "/docs//index.html", "/docs/../app.js", "/src/main.ts", "/package.json"):
            self.assertNotEqual(self.daemon.get(path).status, 200, path)

    def test_pages_run_no_scripts_of_others(self):
        for path in PAGES:
            policy = self.daemon.get(path).headers["Content-Security-Policy"]
            self.assertNotRegex(policy, r"unsafe|script-src|http|\*")
            self.assertEqual("data:" in policy, path.startswith("/docs"), path)
        for path in ("/", "/docs"):
            for tag in re.findall(r"<(?:script|style)\b[^>]*>|\s(?:style|on\w+)=", self.daemon.get(path).body.decode()):
                self.assertIn(" src=", tag)


class Service(TestCase):
    def test_health(self):
        for path in ("/livez", "/readyz"):
            answer = self.daemon.get(path)
            self.assertEqual((answer.status, answer.json), (200, {"status": "ok"}))

    def test_description(self):
        service = self.daemon.get("/v1").json
        queries = {"distance", "path", "nearest", "matrix", "batch", "distance-to-set", "fields", "evaluate",
                   "isolines", "voronoi", "farthest-points", "curve-distance", "cut", "trace", "exp", "log", "transport", "mean",
                   "spline", "curve"}
        queries |= {f"nurbs/{name}" for name in ("evaluate", "nearest", "geodesic", "point-curve-distance", "curve-distance", "tessellate")}
        queries |= {f"subdivisions/{name}" for name in ("evaluate", "nearest", "trace", "distance", "path", "discretize")}
        self.assertEqual(set(service["capabilities"]["queries"]), queries)
        self.assertGreater(service["limits"]["memory_budget_bytes"], 0)

    def test_headers_of_every_answer(self):
        for path, status, source in (("/", 200, "self"), ("/v1", 200, "none"), ("/nowhere", 404, "none")):
            answer = self.daemon.get(path)
            headers = answer.headers
            self.assertEqual(answer.status, status)
            self.assertLess(abs(email.utils.parsedate_to_datetime(headers["Date"]).timestamp() - time.time()), 5)
            self.assertEqual(len(headers.get_all("Date")), 1)
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertIn(f"default-src '{source}'", headers["Content-Security-Policy"])
            self.assertTrue(headers["X-Request-Id"])
            self.assertIsNone(headers["Server"])

    def test_request_id(self):
        self.assertEqual(self.daemon.get("/v1", X_Request_Id="abc-1.2_Z").headers["X-Request-Id"], "abc-1.2_Z")
        for odd in ("a b", "x" * 65, 'a"b', "\u00e9"):
            made = self.daemon.get("/v1", X_Request_Id=odd.encode("latin-1")).headers["X-Request-Id"]
            self.assertNotEqual(made, odd)
            self.assertRegex(made, r"^[A-Za-z0-9._-]{1,64}$")

    def test_log(self):
        trace = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01"
        self.daemon.get('/v1/meshes/no"body\\', X_Request_Id="logged", traceparent=trace)
        line, = wait_until(lambda: [line for line in self.daemon.log if line.get("request_id") == "logged"], 5)
        self.assertEqual((line["status"], line["code"], line["traceparent"]), (400, "invalid_request", trace))

    def test_options(self):
        answer = self.daemon.request("OPTIONS", "/v1/meshes")
        self.assertEqual((answer.status, answer.headers["Allow"]), (204, "GET, HEAD, POST, OPTIONS"))
        self.assertEqual(self.daemon.request("DELETE", "/v1").headers["Allow"], "GET, HEAD, OPTIONS")

    def test_metrics(self):
        self.daemon.put("counted", SQUARE)
        text = self.daemon.get("/metrics").body.decode()
        self.assertIn('geodesicd_requests_total{method="PUT",route="/v1/meshes/{name}",status="201"} 1\n', text)
        self.assertIn('geodesicd_request_seconds_count{method="PUT",route="/v1/meshes/{name}"} 1\n', text)
        names = [line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")]
        self.assertEqual(len(names), len(set(names)))
        for line in text.splitlines():
            self.assertRegex(line, r"^(# (HELP|TYPE) geodesicd_\w+ .+|geodesicd_\w+(\{[^{}]*(\{\w+\}[^{}]*)*\})? \S+)$")

    def test_keep_alive(self):
        connection = self.daemon.connect()
        for path in ("/livez", "/nowhere", "/v1/meshes", "/v1/meshes/nobody"):
            answer = self.daemon.request("GET", path, connection=connection)
            self.assertNotEqual(answer.headers["Connection"], "close", path)
        connection.close()

    def test_pipelined_requests_are_answered_in_order(self):
        self.daemon.put("piped", SQUARE)
        mesh = "/v1/meshes/piped"
        targets = ("/livez", f"{mesh}/content", "/nowhere", f"{mesh}/distance?from=v:0&to=v:2", "/livez")
        form = "GET {} HTTP/1.1\r\nHost: localhost\r\nX-Request-Id: p{}\r\n\r\n"
        text = "".join(form.format(target, number) for number, target in enumerate(targets))
        received = self.daemon.raw(text.encode()[:-2] + b"Connection: close\r\n\r\n").decode()
        ids = [line.split()[1] for line in received.splitlines() if line.startswith("X-Request-Id")]
        self.assertEqual(ids, ["p0", "p1", "p2", "p3", "p4"])


class Guard(TestCase):
    flags = ("--allowed-host", "meshes.example,other.example")

    def test_hosts(self):
        for host in ("localhost", "LOCALHOST:80", "127.9.9.9:1", "[::1]:8080", "meshes.example", "other.example:443"):
            self.assertEqual(self.daemon.get("/v1", Host=host).status, 200, host)
        for host in ("evil.example", "localhost.evil.example", "evil.example:8080", "10.0.0.1", "[::2]", "",
                     "localhost:x", "::1", "meshes.example.evil", "localhost@evil.example", "127.0.0.1.evil.example"):
            self.assert_problem(self.daemon.get("/v1", Host=host), 403, "forbidden")

    def test_origins(self):
        for origin in ("http://evil.example", "null", "http://localhost:1", "https://meshes.example:444", ""):
            answer = self.daemon.get("/v1", Host="localhost:8080", Origin=origin)
            self.assert_problem(answer, 403, "forbidden")
            self.assertIsNone(answer.headers["Access-Control-Allow-Origin"])
        self.assertEqual(self.daemon.get("/v1", Host="localhost:8080", Origin="http://localhost:8080").status, 200)

    def test_sites(self):
        self.assert_problem(self.daemon.get("/v1", Sec_Fetch_Site="cross-site"), 403, "forbidden")
        for site in ("same-origin", "none"):
            self.assertEqual(self.daemon.get("/v1", Sec_Fetch_Site=site).status, 200)

    def test_a_foreign_page_changes_nothing(self):
        self.daemon.put("safe", SQUARE)
        answer = self.daemon.request("DELETE", "/v1/meshes/safe", headers={"Origin": "http://evil.example"})
        self.assert_problem(answer, 403, "forbidden")
        self.assert_problem(self.daemon.put("planted", SQUARE, Sec_Fetch_Site="cross-site"), 403, "forbidden")
        self.assertEqual([mesh["name"] for mesh in self.daemon.get("/v1/meshes").json["meshes"]], ["safe"])


class Lanes(TestCase):
    flags = ("--workers", "1", "--queue-length", "2", "--http-threads", "2", "--landmarks", "0")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("slow", slow_mesh())
        cls.daemon.put("square", SQUARE)
        cls.daemon.ask_often("square", "v:0")
        cls.daemon.get("/v1/meshes/square/distance?from=v:0&to=v:2")

    def ask(self, source, options=""):
        """Asks across the mesh, for a target that no other source is asked for with."""
        return self.daemon.get(f"/v1/meshes/slow/distance?from=v:{source}&to=v:{66000 - source}{options}")

    def ask_for_a_field(self, source):
        """Asks the question that a field is built for: the slowest there is."""
        self.daemon.ask_often("slow", f"v:{source}")
        return self.ask(source)

    def test_those_who_wait_for_one_field_take_no_place_in_the_queue(self):
        builds = self.daemon.metric("cache_builds_total")
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            first = pool.submit(self.ask_for_a_field, 600)
            while self.daemon.metric("cache_builds_total") == builds:
                self.assertFalse(first.done(), "too fast to watch")
            answers = all_of(10, lambda _: self.ask(600))
        self.assertEqual([answer.status for answer in answers], [200] * 10)
        self.assertEqual(self.daemon.metric("cache_builds_total") - builds, 1)

    def test_overload_is_told_at_once(self):
        with concurrent.futures.ThreadPoolExecutor(12) as pool:
            asked = [pool.submit(self.ask, source) for source in range(100, 112)]
            answers = [future.result() for future in asked]
        refused = [answer for answer in answers if answer.status == 503]
        self.assertGreaterEqual(len([answer for answer in answers if answer.status == 200]), 2)  # the queue's length
        self.assertGreater(len(refused), 0)
        for answer in refused:
            self.assert_problem(answer, 503, "overloaded")
            self.assertGreaterEqual(int(answer.headers["Retry-After"]), 1)

    def test_the_first_lane_stays_open(self):
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            builds = self.daemon.metric("cache_builds_total")
            slow = pool.submit(self.ask_for_a_field, 200)
            while self.daemon.metric("cache_builds_total") == builds:
                self.assertFalse(slow.done(), "too fast to watch")
            for path in ("/livez", "/v1/meshes/square", "/v1/meshes/square/distance?from=v:0&to=v:2",
                         "/v1/meshes/slow/nearest?point=p:0.5,0.5,3"):
                self.assertEqual(self.daemon.get(path).status, 200)
            self.assertFalse(slow.done(), "too fast to watch")
            self.assertEqual(slow.result().status, 200)

    def assert_ended(self, counter, ask):
        """With so little time that the work is begun, as its counter tells, but not finished."""
        begun = self.daemon.metric(counter)
        for timeout_ms in (3, 6, 12, 24, 48):
            self.assert_problem(ask(f"timeout_ms={timeout_ms}"), 504, "deadline_exceeded")
            if self.daemon.metric(counter) > begun:
                return
        self.fail("it was never begun")

    def test_deadline_of_the_work(self):
        started, document = time.monotonic(), {"set": {"points": [{"vertex": 300}]}}
        self.assert_ended("searches_total", lambda timeout: self.ask(300, options=f"&{timeout}"))
        self.assert_ended("cache_builds_total", lambda timeout: self.daemon.ask("slow", f"fields?{timeout}", document))
        self.assertLess(time.monotonic() - started, 2)

    def test_deadline_while_waiting(self):
        """A request that waits for a worker is answered at its own deadline."""
        builds = self.daemon.metric("cache_builds_total")
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            slow = pool.submit(self.ask_for_a_field, 400)
            while self.daemon.metric("cache_builds_total") == builds:
                self.assertFalse(slow.done(), "too fast to watch")
            self.assert_problem(self.ask(401, options="&timeout_ms=20"), 504, "deadline_exceeded")
            self.assertFalse(slow.done(), "too fast to watch")
            slow.result()

    def test_when_the_builder_gives_up_another_takes_over(self):
        """The builder waits for the worker, more than the queue holds wait for him: his deadline is not theirs."""
        self.daemon.ask_often("square", "v:1")
        url = "/v1/meshes/square/distance?from=v:1&to=v:3"
        builds, waits = self.daemon.metric("cache_builds_total"), self.daemon.metric("cache_waits_total")
        with concurrent.futures.ThreadPoolExecutor(7) as pool:
            slow = pool.submit(self.ask_for_a_field, 700)
            while self.daemon.metric("cache_builds_total") == builds:
                self.assertFalse(slow.done(), "too fast to watch")
            hasty = pool.submit(self.daemon.get, url + "&timeout_ms=80")
            while self.daemon.metric("cache_builds_total") == builds + 1:
                self.assertFalse(slow.done(), "too fast to watch")
            patient = [pool.submit(self.daemon.get, url) for _ in range(5)]
            self.assert_problem(hasty.result(), 504, "deadline_exceeded")
            self.assertFalse(slow.done(), "too fast to watch")
            self.assertEqual([future.result().status for future in (slow, *patient)], [200] * 6)
        self.assertEqual(self.daemon.metric("cache_waits_total") - waits, 5)
        self.assertEqual(self.daemon.metric("cache_builds_total") - builds, 3)

    def test_a_client_that_went_away_frees_its_worker(self):
        self.daemon.ask_often("slow", "v:500")
        connection = socket.create_connection(("127.0.0.1", self.daemon.port))
        connection.sendall(b"GET /v1/meshes/slow/distance?from=v:500&to=v:65500 HTTP/1.1\r\nHost: localhost\r\n\r\n")
        while not self.daemon.metric("workers_busy"):
            pass
        connection.close()
        while self.daemon.metric("workers_busy"):
            pass
        self.assertEqual(self.daemon.metric("requests_deferred"), 0)
        fields = self.daemon.metric("cache_fields")
        self.ask(500)
        self.assertEqual(self.daemon.metric("cache_fields") - fields, 1, "its field had been built in spite of it")


class Waiting(TestCase):
    flags = ("--workers", "2", "--queue-length", str(SEARCHES), "--landmarks", "0")

    def test_one_build_and_a_few_searches_for_all_who_ask_at_the_same_time(self):
        self.daemon.put("ball", sample("icosphere", level=5))
        builds, searches = self.daemon.metric("cache_builds_total"), self.daemon.metric("searches_total")
        answers = all_of(150, lambda _: self.daemon.get("/v1/meshes/ball/path?from=v:77&to=p:0,0,-9"))
        self.assertEqual({answer.status for answer in answers}, {200})
        for answer in answers:
            self.assertAlmostEqual(answer.json["distance"], answers[0].json["distance"], 12)
        self.assertEqual(self.daemon.metric("cache_builds_total") - builds, 1)
        self.assertLess(self.daemon.metric("searches_total") - searches, SEARCHES)

    def test_who_has_little_time_does_not_wait_for_a_field(self):
        self.daemon.put("slow", slow_mesh())
        self.daemon.ask_often("slow", "v:5")
        url = "/v1/meshes/slow/distance?from=v:5&to=p:9,9,0"
        builds, waits = self.daemon.metric("cache_builds_total"), self.daemon.metric("cache_waits_total")
        hasty = self.daemon.get(url + "&timeout_ms=1500")  # less than ten times what such a field may take
        self.assertIn(hasty.status, (200, 504), hasty)  # slow under sanitizers
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds)
        self.assertEqual(self.daemon.get(url).status, 200)
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds + 1)
        self.assertEqual(self.daemon.metric("cache_waits_total"), waits)


class Memory(TestCase):
    flags = ("--memory-budget", "72MiB", "--max-body", "8MiB", "--workers", "2", "--landmarks", "0")

    def test_fields_are_evicted_and_meshes_refused(self):
        self.assertEqual(self.daemon.put("ball", sample("icosphere", level=5)).status, 201)
        for source in range(0, 200, 10):
            self.daemon.ask_often("ball", f"v:{source}")
            self.assertEqual(self.daemon.get(f"/v1/meshes/ball/distance?from=v:{source}&to=p:0,0,-9").status, 200)
        self.assertGreater(self.daemon.metric("cache_evictions_total"), 0)
        large = self.daemon.put("large", sample("icosphere", level=7)[: 8 << 20])
        problem = self.assert_problem(large, 507, "insufficient_memory")
        self.assertEqual(problem["limit"], 72 << 20)
        self.assertEqual(self.daemon.get("/v1/meshes/ball/distance?from=v:3&to=p:0,0,-9").status, 200)
        metrics = self.daemon.get("/metrics").body.decode()
        self.assertIn('memory_bytes{class="flight"} 0\n', metrics)
        self.assertRegex(metrics, r'memory_bytes\{class="workspaces"\} [1-9]')
        self.assertIn(f'memory_bytes{{class="spare"}} {(72 << 20) // 16}\n', metrics)


class Drain(unittest.TestCase):
    def busy(self, *flags):
        """A daemon with a query under way, the query, and a connection that is open."""
        daemon = Daemon("--workers", "1", *flags)
        daemon.put("slow", slow_mesh())
        daemon.ask_often("slow", "v:0")
        pool = concurrent.futures.ThreadPoolExecutor(2)
        query = pool.submit(daemon.get, "/v1/meshes/slow/distance?from=v:0&to=p:9,9,0")
        connection = daemon.connect()
        while not daemon.metric("workers_busy"):
            pass
        daemon.request("GET", "/livez", connection=connection)
        return daemon, query, connection

    def test_what_is_under_way_is_finished(self):
        daemon, query, connection = self.busy()
        daemon.terminate()
        while "draining" not in [line["event"] for line in daemon.log]:
            time.sleep(0.001)
        ready = daemon.request("GET", "/readyz", connection=connection)
        self.assertEqual((ready.status, ready.json["status"], ready.headers["Connection"]), (503, "draining", "close"))
        with self.assertRaises(OSError):
            daemon.get("/livez")
        self.assertFalse(query.done(), "too fast to watch")
        self.assertEqual(query.result().status, 200)
        self.assertEqual(daemon.stop(), 0)

    def test_what_does_not_end_in_time_is_cancelled_and_told(self):
        daemon, query, _ = self.busy("--drain-ms", "10")
        daemon.terminate()
        answer = query.result()
        self.assertEqual((answer.status, answer.json["code"]), (503, "draining"))
        self.assertEqual(daemon.stop(), 0)

    def test_interrupt_ends_it_too(self):
        daemon = Daemon()
        daemon.process.send_signal(signal.SIGINT)
        self.assertEqual(daemon.stop(), 0)
        self.assertEqual(daemon.log[-1]["event"], "stopped")


class Crowd(TestCase):
    flags = ("--workers", "2", "--http-threads", "2", "--memory-budget", "128MiB", "--max-body", "4MiB")
    COUNTERS = ("cache_builds_total", "cache_hits_total", "cache_waits_total", "cache_evictions_total")
    ALLOWED = {"PUT": {200, 201}, "GET": {200, 400, 404}, "DELETE": {204, 404}}

    def setUp(self):
        self.files = [sample("icosphere", level=4), sample("torus"), sample("grid", columns=64, rows=64)]
        self.daemon.put("m3", sample("icosphere", level=5))  # nobody changes it: its fields stay until they are evicted
        self.wrong, self.is_over = [], threading.Event()
        self.counter = itertools.count()

    def request(self, method, path, body=None):
        answer = self.daemon.request(method, path, body)
        if answer.status not in self.ALLOWED[method]:
            self.wrong.append((method, path, answer))

    def change(self, seed):
        """Uploads, replaces and deletes."""
        chance = random.Random(seed)
        while not self.is_over.wait(0.05):
            body = chance.choice([None, *self.files])
            self.request("PUT" if body else "DELETE", f"/v1/meshes/m{chance.randrange(3)}", body)

    def query(self, seed):
        """Asks about one point so often, together with others, that a field is built and used, then about the next."""
        chance = random.Random(seed)
        while not self.is_over.is_set():
            source = next(self.counter) // 50
            self.request("GET", f"/v1/meshes/m{source % 4}/path?from=v:{source % 300}&to=v:{chance.randrange(300)}")

    def test_everything_at_the_same_time(self):
        """Every answer is one that is allowed, while fields are built, waited for, used and evicted."""
        enough, late = time.monotonic() + 3, time.monotonic() + PATIENCE_SECONDS
        threads = [threading.Thread(target=self.change if number < 2 else self.query, args=(number,))
                   for number in range(8)]
        for thread in threads:
            thread.start()
        counts = []
        while time.monotonic() < enough or (min(counts) == 0 and time.monotonic() < late):
            time.sleep(0.2)
            counts = [self.daemon.metric(name) for name in self.COUNTERS]
        self.is_over.set()
        for thread in threads:
            thread.join()
        self.assertEqual(self.wrong, [])
        self.assertGreater(min(counts), 0, dict(zip(self.COUNTERS, counts)))


class Manual(unittest.TestCase):
    def test_it_has_every_flag(self):
        script = pathlib.Path(__file__).resolve().parents[2] / "server" / "doc" / "manual.py"
        page = subprocess.run([script, PROGRAM], check=True, stdout=subprocess.PIPE, text=True).stdout
        told = subprocess.run([PROGRAM, "--help"], check=True, stdout=subprocess.PIPE, text=True).stdout
        flags = re.findall(r"^  (--[a-z-]+)", told, re.MULTILINE)
        self.assertGreater(len(flags), 30)
        for flag in flags:
            self.assertIn(".TP\n\\fB" + flag.replace("-", "\\-") + "\\fR", page)
        if shutil.which("groff"):
            made = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page, stderr=subprocess.PIPE, text=True)
            self.assertEqual((made.returncode, made.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
