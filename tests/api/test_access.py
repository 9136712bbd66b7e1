"""Tests access: keys, roles, expiry, limits, reload, and pages of other origins."""
import base64
import concurrent.futures
import gzip
import hashlib
import json
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, Daemon, TestCase, header_fields, sample, wait_until


def digest(key):
    return hashlib.sha256(key.encode()).hexdigest()


def line(name, settings=""):
    """Returns the line of the keys' file for a key whose text is its name. All keys share the names
    of meshes; for separate tenants see test_tenants.py."""
    return f"{name} sha256:{digest(key_of(name))} tenant=all {settings}\n"


def key_of(name):
    return f"gdk_{name:x<43}"


def bearer(name):
    return {"Authorization": f"Bearer {key_of(name)}"}


def keygen(*arguments):
    return subprocess.run([PROGRAM, "keygen", *arguments], capture_output=True, text=True, timeout=PATIENCE_SECONDS)


class Files(unittest.TestCase):
    def test_an_unreadable_file_of_keys_leaves_the_keys_unchanged(self):
        with tempfile.TemporaryDirectory() as place:
            file = pathlib.Path(place) / "keys"
            file.write_text(line("first"))
            with Daemon("--keys", str(file)) as daemon:
                for make in (os.mkfifo, os.mkdir):
                    file.unlink()
                    make(file)
                    told = daemon.reload()
                    self.assertEqual(told["event"], "reload_failed")
                    self.assertIn("it is not a regular file", told["message"])
                    self.assertEqual(daemon.get("/v1", **bearer("first")).status, 200)
                    os.rmdir(file) if file.is_dir() else file.unlink()
                    file.write_text(line("first"))
                file.unlink()
                os.mkfifo(file)
                daemon.reload()
                self.assertEqual(daemon.stop(), 0)
            for flag in ("--keys", "--config"):
                refused = subprocess.run([PROGRAM, "--store", "memory", flag, str(file)], capture_output=True, text=True, timeout=PATIENCE_SECONDS)
                self.assertNotEqual(refused.returncode, 0)
                self.assertIn("it is not a regular file", refused.stderr)


class Keyed(TestCase):
    """Tests of a daemon with keys; the class's `keys` are the lines of the file."""

    keys = ""

    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.file = pathlib.Path(cls.place.name) / "keys"
        cls.file.write_text(cls.keys)
        cls.daemon = Daemon("--keys", str(cls.file), *cls.flags)

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        cls.place.cleanup()

    def ask(self, method, path, name=None, body=None, **headers):
        own = bearer(name) if name else {}
        return self.daemon.request(method, path, body, {**own, **header_fields(headers)})

    def logged(self, request_id):
        """Returns the log line of a request. The daemon writes this line slightly after the
        answer."""
        return wait_until(lambda: [entry for entry in self.daemon.log if entry.get("request_id") == request_id])[0]


class Roles(Keyed):
    keys = line("reader") + line("writer", "role=write") + line("old", "role=write expires=2001-01-01") + line("watch", "role=operator")

    def test_operations_without_key(self):
        for path in ("/livez", "/readyz", "/", "/openapi.json"):
            self.assertEqual(self.ask("GET", path).status, 200, path)
        self.assertEqual(self.ask("HEAD", "/livez").status, 200)
        self.assertEqual(self.ask("OPTIONS", "/v1/meshes").status, 204)

    def test_pages_need_no_key(self):
        self.skip_without_pages()
        for path in ("/app.js", "/style.css"):
            self.assertEqual(self.ask("GET", path).status, 200, path)

    def test_all_other_operations_need_a_key(self):
        paths = self.ask("GET", "/openapi.json").json["paths"]
        asked = 0
        for path, item in paths.items():
            for method in set(item) & {"get", "put", "post", "patch", "delete"}:
                if not item[method]["security"]:
                    continue
                concrete = path.replace("{name}", "square").replace("{id}", "x").replace("{job}", "x")
                for headers in ({}, {"Authorization": "Bearer gdk_wrong"}, bearer("old")):
                    answer = self.daemon.request(method.upper(), concrete, None, headers)
                    self.assert_problem(answer, 401, "unauthorized")
                    asked += 1
        self.assertGreater(asked, 90)
        for path in ("/nowhere", "/v1/nothing", "/metrics"):
            self.assert_problem(self.ask("GET", path), 401, "unauthorized")
            self.assertIn(self.ask("GET", path, "reader").status, (200, 404))

    def test_challenges(self):
        self.assertEqual(self.ask("GET", "/v1").headers["WWW-Authenticate"], 'Bearer realm="geodesicd"')
        for name in ("nobody", "old"):
            challenge = self.ask("GET", "/v1", name).headers["WWW-Authenticate"]
            self.assertEqual(challenge, 'Bearer realm="geodesicd", error="invalid_token"')
        self.assertIn("expired", self.ask("GET", "/v1", "old").json["detail"])

    def test_forms_of_the_header(self):
        key = key_of("reader")
        for value in (key, f"Basic {base64.b64encode(key.encode()).decode()}", "Bearer", f"Bearer {key[:-1]}", f"Bearer {key} x",
                      f"Bearer {key}y", f"Bearer {digest(key)}", f"Bearer sha256:{digest(key)}", f"Bearer,{key}"):
            self.assert_problem(self.daemon.get("/v1", Authorization=value), 401, "unauthorized")
        for value in (f"Bearer {key}", f"bearer {key}", f"BEARER  {key}"):
            self.assertEqual(self.daemon.get("/v1", Authorization=value).status, 200)
        self.assert_problem(self.daemon.get(f"/v1?key={key}"), 401, "unauthorized")
        twice = f"GET /v1 HTTP/1.1\r\nHost: a\r\nAuthorization: Bearer {key}\r\nAuthorization: Bearer {key}\r\n\r\n"
        self.assertTrue(self.daemon.raw(twice.encode(), shut=True).startswith(b"HTTP/1.1 401 "))

    def test_a_read_key_may_query_and_a_write_key_may_change(self):
        self.assert_problem(self.ask("PUT", "/v1/meshes/square", "reader", SQUARE), 403, "forbidden")
        self.assertEqual(self.ask("PUT", "/v1/meshes/square", "writer", SQUARE).status, 201)
        pair = json.dumps({"from": {"vertex": 0}, "to": {"vertex": 2}})
        for name in ("reader", "writer"):
            self.assertEqual(self.ask("POST", "/v1/meshes/square/distance", name, pair).status, 200)
            self.assertEqual(self.ask("GET", "/v1/meshes/square/distance?from=v:0&to=v:2", name).status, 200)
            field = self.ask("POST", "/v1/meshes/square/fields", name, '{"set": {"points": [{"vertex": 0}]}}')
            self.assertIn(field.status, (200, 201), field)
            job = self.ask("POST", "/v1/meshes/square/distance", name, pair, Prefer="respond-async")
            self.assertEqual(job.status, 202)
            self.assertEqual(self.ask("DELETE", job.headers["Location"], name).status, 204)
        for method, path in (("DELETE", "/v1/meshes/square"), ("POST", "/v1/meshes"), ("DELETE", f"/v1/meshes/square/fields/{field.json['id']}")):
            answer = self.ask(method, path, "reader")
            self.assert_problem(answer, 403, "forbidden")
            self.assertEqual(answer.headers["WWW-Authenticate"], 'Bearer realm="geodesicd", error="insufficient_scope"')
        self.assertEqual(self.ask("DELETE", "/v1/meshes/square", "writer").status, 204)

    def test_an_upload_without_key_is_refused_before_its_body(self):
        head = b"PUT /v1/meshes/big HTTP/1.1\r\nHost: a\r\nContent-Length: 100000000\r\nExpect: 100-continue\r\n"
        for name, status in ((None, b"401"), ("reader", b"403"), ("writer", b"100")):
            key = f"Authorization: Bearer {key_of(name)}\r\n".encode() if name else b""
            self.assertEqual(self.daemon.raw(head + key + b"\r\n")[9:12], status)

    def test_the_log_has_the_name_of_the_key_but_not_the_key(self):
        self.ask("GET", "/v1", "reader", X_Request_Id="named")
        self.assertEqual(self.logged("named")["key"], "reader")
        self.ask("GET", "/v1", "nobody", X_Request_Id="unnamed")
        refused = self.logged("unnamed")
        self.assertNotIn("key", refused)
        self.assertEqual((refused["peer"], refused["code"]), ("127.0.0.1", "unauthorized"))
        text = json.dumps(self.daemon.log)
        for name in ("reader", "nobody"):
            self.assertNotIn(key_of(name), text)
            self.assertNotIn(digest(key_of(name)), text)

    def test_any_host_is_accepted_with_keys(self):
        for host in ("meshes.example", "10.1.2.3:8080"):
            self.assertEqual(self.daemon.get("/v1", Host=host, **bearer("reader")).status, 200)
        answer = self.daemon.get("/v1", Origin="https://evil.example", **bearer("reader"))
        self.assert_problem(answer, 403, "forbidden")

    def test_metrics(self):
        self.ask("DELETE", "/v1/meshes/square", "reader")
        text = self.ask("GET", "/metrics", "watch").body.decode()
        for entry in ('geodesicd_key_requests_total{key="reader"}', 'geodesicd_key_refusals_total{key="reader",reason="role"}',
                      'geodesicd_problems_total{code="forbidden"}', "geodesicd_connections "):
            values = [float(row.rsplit(" ", 1)[1]) for row in text.splitlines() if row.startswith(entry)]
            self.assertEqual([value > 0 for value in values], [True], entry)


class Limits(Keyed):
    keys = line("fast", "role=write") + line("slow", "rate=3") + line("narrow", "concurrent=2") + line("single", "concurrent=1") + line("watch", "role=operator")
    flags = ("--workers", "1", "--landmarks", "0")

    def test_rate(self):
        started = time.monotonic()
        answers = [self.ask("GET", "/v1", "slow") for _ in range(30)]
        taken = time.monotonic() - started
        entered = [answer for answer in answers if answer.status == 200]
        self.assertLessEqual(len(entered), 3 + 3 * taken + 1)
        self.assertGreaterEqual(len(entered), 3)
        for answer in set(answers) - set(entered):
            problem = self.assert_problem(answer, 429, "rate_limited")
            self.assertEqual((problem["limit"], answer.headers["Retry-After"]), (3, "1"))
        self.assertEqual(self.ask("GET", "/v1", "fast").status, 200)  # other keys are not delayed
        time.sleep(int(answers[-1].headers["Retry-After"] or 1))
        self.assertEqual(self.ask("GET", "/v1", "slow").status, 200)

    def test_concurrent_requests_of_a_key_are_limited(self):
        self.assertEqual(self.ask("PUT", "/v1/meshes/rough", "fast", sample("terrain", cells=96, amplitude=1)).status, 201)
        path = "/v1/meshes/rough/matrix"
        body = json.dumps({"sources": [{"vertex": i} for i in range(40)], "targets": [{"vertex": 9000 + i} for i in range(400)]})
        with concurrent.futures.ThreadPoolExecutor(12) as pool:
            answers = list(pool.map(lambda _: self.ask("POST", path, "narrow", body), range(12)))
        statuses = sorted(answer.status for answer in answers)
        self.assertEqual(set(statuses), {200, 429}, statuses)
        for answer in answers:
            if answer.status == 429:
                self.assertEqual(self.assert_problem(answer, 429, "rate_limited")["limit"], 2)
                self.assertGreaterEqual(int(answer.headers["Retry-After"]), 1)
        # ended requests no longer count towards the limit of concurrent requests
        self.assertEqual(self.ask("GET", "/v1", "narrow").status, 200)

    def test_a_running_job_counts_as_a_request_of_its_key(self):
        self.ask("PUT", "/v1/meshes/wide", "fast", sample("terrain", cells=96, amplitude=1))
        body = json.dumps({"sources": [{"vertex": i} for i in range(400)], "targets": [{"vertex": 9000 + i} for i in range(400)]})
        job = self.ask("POST", "/v1/meshes/wide/matrix", "single", body, Prefer="respond-async")
        self.assertEqual(job.status, 202)
        self.assert_problem(self.ask("GET", "/v1", "single"), 429, "rate_limited")
        # the key can follow and cancel the job nevertheless
        place = job.headers["Location"]
        for path, status in ((place, 200), ("/v1/jobs", 200), (f"{place}/result", 409), ("/v1/batches", 200), ("/v1/batches/none", 404)):
            self.assertEqual(self.ask("GET", path, "single").status, status, path)
        self.assertEqual(self.ask("DELETE", place, "single").status, 204)
        wait_until(lambda: self.ask("GET", "/v1", "single").status == 200)

    def test_a_wait_for_a_job_takes_no_place(self):
        self.ask("PUT", "/v1/meshes/vast", "fast", sample("terrain", cells=96, amplitude=1))
        body = json.dumps({"sources": [{"vertex": i} for i in range(400)], "targets": [{"vertex": 9000 + i} for i in range(400)]})
        job = self.ask("POST", "/v1/meshes/vast/matrix", "fast", body, Prefer="respond-async").headers["Location"]
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            waiting = pool.submit(self.ask, "GET", f"{job}?wait=60", "single")
            wait_until(lambda: b"geodesicd_requests_deferred 2\n" in self.ask("GET", "/metrics", "watch").body)
            self.assertEqual(self.ask("GET", "/v1", "single").status, 200)
            self.assertEqual(self.ask("DELETE", job, "fast").status, 204)
            self.assertEqual(waiting.result().json["state"], "cancelled")


class Reload(Keyed):
    keys = line("first") + line("second")

    def test_reload(self):
        self.file.write_text(line("second") + line("third", "role=write"))
        self.assertEqual(self.ask("GET", "/v1", "third").status, 401)
        self.assertEqual(self.daemon.reload()["event"], "reloaded")
        self.assertEqual([self.ask("GET", "/v1", name).status for name in ("first", "second", "third")], [401, 200, 200])
        self.file.write_text("second sha256:broken\n")
        told = self.daemon.reload()
        self.assertEqual((told["event"], told["level"]), ("reload_failed", "error"))
        self.assertIn(f"{self.file}:1: ", told["message"])
        self.assertEqual([self.ask("GET", "/v1", name).status for name in ("first", "second", "third")], [401, 200, 200])
        self.file.unlink()
        self.assertEqual(self.daemon.reload()["event"], "reload_failed")
        self.assertEqual(self.ask("GET", "/v1", "second").status, 200)
        self.file.write_text(self.keys)
        self.assertEqual(self.daemon.reload()["event"], "reloaded")

    def test_reloads_under_load(self):
        """While the file of keys is reloaded repeatedly, the daemon answers each request according
        to the rights of its key."""
        stop = time.monotonic() + 1
        def ask(_):
            connection, statuses = self.daemon.connect(), set()
            while time.monotonic() < stop:
                statuses.add(self.daemon.request("GET", "/v1", headers=bearer("second"), connection=connection).status)
            connection.close()
            return statuses
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            asked = [pool.submit(ask, number) for number in range(4)]
            while time.monotonic() < stop:
                self.assertEqual(self.daemon.reload()["event"], "reloaded")
            self.assertEqual([future.result() for future in asked], [{200}] * 4)


class Start(unittest.TestCase):
    def run_daemon(self, *flags):
        return subprocess.run([PROGRAM, "--store", "memory", *flags], capture_output=True, text=True, timeout=PATIENCE_SECONDS)

    def test_keys_that_cannot_be_read(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "keys"
            for text, hint in ((None, "No such file"), ("", "holds no key"), ("a b c\n", f"{file}:1: ")):
                if text is not None:
                    file.write_text(text)
                result = self.run_daemon("--listen", "127.0.0.1:0", "--keys", str(file))
                self.assertEqual(result.returncode, 1, result)
                self.assertIn(hint, json.loads(result.stderr)["message"])

    def test_with_keys_the_daemon_listens_beyond_loopback(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "keys"
            file.write_text(line("a"))
            with Daemon("--keys", str(file), listen="0.0.0.0:0") as daemon:
                self.assertEqual(daemon.get("/v1").status, 401)
                self.assertEqual(daemon.get("/v1", **bearer("a")).status, 200)
            self.assertIn("keys_in_clear", [entry["event"] for entry in daemon.log])

    def test_keygen(self):
        made = keygen("ci", "--role", "write", "--expires", "90d", "--rate", "100", "--concurrent", "8")
        key, entry = made.stdout.splitlines()
        self.assertRegex(key, r"^gdk_[A-Za-z0-9_-]{43}$")
        self.assertEqual(entry.split()[:3], ["ci", f"sha256:{digest(key)}", "role=write"])
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "keys"
            file.write_text(entry + "\n")
            with Daemon("--keys", str(file)) as daemon:
                answer = daemon.put("square", SQUARE, Authorization=f"Bearer {key}")
                self.assertEqual(answer.status, 201)
        self.assertNotEqual(keygen("ci").stdout, keygen("ci").stdout)
        self.assertRegex(keygen("--help").stdout, r"^usage: .*\n$")
        for wrong in ((), ("a b",), ("--name", "a"), ("a", "--role", "root"), ("a", "--expires", "soon"), ("a", "--role")):
            result = keygen(*wrong)
            self.assertEqual((result.returncode, result.stdout), (2, ""), result)
            self.assertIn("usage", result.stderr)


class Origins(Keyed):
    keys = line("reader") + line("writer", "role=write")
    flags = ("--cors-origin", "https://maps.example,http://localhost:3000")
    origin = "https://maps.example"

    def preflight(self, path, method, origin):
        headers = {"Origin": origin, "Access-Control-Request-Method": method, "Access-Control-Request-Headers": "authorization"}
        return self.daemon.request("OPTIONS", path, headers={**headers, "Sec-Fetch-Site": "cross-site"})

    def test_preflight(self):
        answer = self.preflight("/v1/meshes/x", "PUT", self.origin)
        self.assertEqual(answer.status, 204)
        self.assertEqual(answer.headers["Access-Control-Allow-Origin"], self.origin)
        self.assertEqual(answer.headers["Access-Control-Allow-Methods"], "GET, HEAD, PUT, PATCH, DELETE")
        allowed = answer.headers["Access-Control-Allow-Headers"].lower().split(", ")
        self.assertLessEqual({"authorization", "content-type", "if-match", "prefer"}, set(allowed))
        self.assertGreater(int(answer.headers["Access-Control-Max-Age"]), 0)
        self.assertIn("Origin", answer.headers.get_all("Vary"))
        self.assertIsNone(answer.headers["Access-Control-Allow-Credentials"])

    def test_answers_may_be_read(self):
        for path, name, status in (("/v1", "reader", 200), ("/v1", None, 401), ("/v1/meshes/no", "reader", 404)):
            answer = self.ask("GET", path, name, Origin=self.origin, Sec_Fetch_Site="cross-site")
            self.assertEqual((answer.status, answer.headers["Access-Control-Allow-Origin"]), (status, self.origin))
            self.assertIn("Retry-After", answer.headers["Access-Control-Expose-Headers"])
        packed = self.ask("GET", "/openapi.json", Origin=self.origin, Accept_Encoding="gzip")
        self.assertEqual(packed.headers["Access-Control-Allow-Origin"], self.origin)
        self.assertEqual(json.loads(gzip.decompress(packed.body))["openapi"][:3], "3.1")

    def test_other_origins_are_refused(self):
        for origin in ("https://evil.example", "http://maps.example", "https://maps.example:8443", "null",
                       "https://maps.example.evil", "https://maps.exampl"):
            for answer in (self.preflight("/v1/meshes/x", "PUT", origin), self.ask("GET", "/v1", "reader", Origin=origin)):
                self.assert_problem(answer, 403, "forbidden")
                self.assertIsNone(answer.headers["Access-Control-Allow-Origin"])

    def test_a_request_without_origin_gets_no_cors_headers(self):
        """Pages of other origins get no CORS headers. The daemon's own page needs no CORS
        headers."""
        for headers in ({}, {"Host": "meshes.example", "Origin": "http://meshes.example"}):
            answer = self.ask("GET", "/v1", "reader", **headers)
            self.assertEqual(answer.status, 200)
            self.assertIsNone(answer.headers["Access-Control-Allow-Origin"])
            self.assertIn("Origin", answer.headers.get_all("Vary"))


if __name__ == "__main__":
    unittest.main()
