"""Tests the daemon as a whole: start, CPU kernels, health, pages, headers, access by Host and
Origin, manual page."""
import email.utils
import gzip
import json
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, Daemon, TestCase, sample, wait_until


# The processor features that each kernel needs, slowest kernel first.
KERNELS = {"baseline": set(), "avx2": {"avx2"}, "avx512": {"avx512f", "avx512vl", "avx512dq"}}


PAGES = {"/": "text/html", "/app.js": "text/javascript", "/worker.js": "text/javascript", "/style.css": "text/css", "/docs": "text/html", "/docs/app.js": "text/javascript",
         "/docs/app.css": "text/css", "/licenses.txt": "text/plain"}


def own_kernels():
    """Returns the kernels that this machine can run, slowest first."""
    flags = re.search(r"^flags\s*:(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    abilities = set(flags[1].split()) if flags else set()
    return [name for name, needed in KERNELS.items() if needed <= abilities]


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
        self.assert_refused(run("--landmarks", "33"), "0 to 32")
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
    """Kernels differ only in speed: answers are equal to the last bit, from searches and from
    fields."""

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
        try:
            cls.skip_without_pages()
        except unittest.SkipTest:
            super().tearDownClass()
            raise

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

    def test_a_folder_serves_its_index(self):
        for index in ("/index.html", "/docs/index.html"):
            folder = index.removesuffix("index.html")
            tags = {self.daemon.get(path).headers["ETag"] for path in (index, folder, folder.rstrip("/") or "/")}
            self.assertEqual(len(tags), 1, index)
        for path in ("/docs/none.js", "/docs//index.html", "/docs/../app.js", "/src/main.ts", "/package.json"):
            self.assertNotEqual(self.daemon.get(path).status, 200, path)

    def test_pages_run_no_foreign_scripts(self):
        for path in PAGES:
            policy = self.daemon.get(path).headers["Content-Security-Policy"]
            self.assertNotRegex(policy, r"unsafe|script-src|http|\*")
            self.assertEqual("data:" in policy, path.startswith("/docs"), path)
        for path in ("/", "/docs"):
            for tag in re.findall(r"<(?:script|style)\b[^>]*>|\s(?:style|on\w+)=", self.daemon.get(path).body.decode()):
                self.assertIn(" src=", tag)


class Framing(TestCase):
    """Pages of listed origins may frame the viewer."""
    flags = ("--frame-ancestors", "https://a.example,https://b.example:8443")

    def test_pages_name_the_ancestors(self):
        for path in PAGES:
            policy = self.daemon.get(path).headers["Content-Security-Policy"]
            self.assertIn("frame-ancestors https://a.example https://b.example:8443; base-uri 'none'", policy)
            self.assertTrue(policy.startswith("default-src 'self'"), policy)

    def test_data_may_not_be_framed(self):
        policy = self.daemon.get("/v1").headers["Content-Security-Policy"]
        self.assertIn("frame-ancestors 'none'", policy)


class Service(TestCase):
    def test_health(self):
        for path in ("/livez", "/readyz"):
            answer = self.daemon.get(path)
            self.assertEqual((answer.status, answer.json), (200, {"status": "ok"}))

    def test_description(self):
        service = self.daemon.get("/v1").json
        queries = {"distance", "path", "nearest", "matrix", "pairs", "nearest-points", "queries", "batch", "distance-to-set", "fields", "evaluate",
                   "isolines", "cut-locus", "voronoi", "farthest-points", "curve-distance", "cut", "trace", "exp", "log", "transport", "mean",
                   "spline", "curve", "picture"}
        queries |= {f"nurbs/{name}" for name in ("evaluate", "nearest", "path", "geodesic", "point-curve-distance", "curve-distance", "tessellate",
                                             "picture")}
        queries |= {f"subdivisions/{name}" for name in ("evaluate", "nearest", "trace", "distance", "path", "tessellate", "discretize", "levels",
                                                    "picture")}
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
        self.skip_without_pages()
        for method, status in (("OPTIONS", 204), ("POST", 405), ("GET", 200)):
            answer = self.daemon.request(method, "/docs")
            self.assertEqual((answer.status, answer.headers["Allow"]), (status, None if method == "GET" else "GET, HEAD, OPTIONS"))

    def test_options_of_the_daemon(self):
        """The target * stands for the whole daemon."""
        answer = self.daemon.raw(b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        self.assertRegex(answer, rb"^HTTP/1.1 204 [^\0]*Allow: GET, HEAD, PUT, POST, PATCH, DELETE, OPTIONS\r\n")
        answer = self.daemon.raw(b"GET * HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        self.assertRegex(answer, rb"^HTTP/1.1 404 ")

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


class Manual(unittest.TestCase):
    def test_the_manual_has_every_flag(self):
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
