"""Tests that each tenant has its own names. A tenant can't distinguish another tenant's names from
unused names."""
import contextlib
import json
import pathlib
import re
import socket
import subprocess
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, TETRAHEDRON, Daemon, Folder, sample, wait_until
from test_access import bearer, digest, key_of, keygen

KEYS = ("ann role=write", "bob role=write", "viewer role=read tenant=ann", "second role=write tenant=ann", "plain role=write tenant=",
        "watch role=operator", "watch-ann role=operator tenant=ann")
ANNS = {"ann", "viewer", "second", "watch-ann"}  # the keys of one tenant
PAIR = '{"from": {"vertex": 0}, "to": {"vertex": 2}}'


class Tenants(Folder):
    def setUp(self):
        super().setUp()
        self.keys = pathlib.Path(self.place.name) / "keys"
        self.keys.write_text("".join(f"{name} sha256:{digest(key_of(name))} {settings}\n"
                                     for name, settings in (line.split(" ", 1) for line in KEYS)))

    def start(self, *flags):
        self.daemon = super().start("--keys", str(self.keys), *flags)
        return self.daemon

    def ask(self, method, path, name, body=None, **headers):
        return self.daemon.request(method, path, body, {**bearer(name), **headers})

    def names(self, who):
        return [mesh["name"] for mesh in self.ask("GET", "/v1/meshes", who).json["meshes"]]

    def assert_same_as_nothing(self, method, path, who, body=None):
        """Asserts that the answer for another tenant's name equals, byte for byte, the answer for
        an unused name."""
        foreign = self.ask(method, path, who, body, **{"X-Request-Id": "same"})
        absent = self.ask(method, path.replace("it", "no"), who, body, **{"X-Request-Id": "same"})
        self.assertEqual((foreign.status, foreign.body), (404, absent.body), (method, path))
        pairs = [[pair for pair in answer.headers.items() if pair[0] != "Date"] for answer in (foreign, absent)]
        self.assertEqual(*pairs)

    def test_foreign_names_are_absent(self):
        with self.start():
            self.assertEqual(self.ask("PUT", "/v1/meshes/it", "ann", SQUARE).status, 201)
            for method, path, body in (("GET", "", None), ("HEAD", "", None), ("DELETE", "", None), ("GET", "/content", None),
                                       ("GET", "/distance?from=v:0&to=v:2", None), ("POST", "/distance", PAIR),
                                       ("GET", "/fields", None), ("POST", "/fields", '{"set": {"points": [{"vertex": 0}]}}'),
                                       ("POST", "/batch", '{"query": "nearest", "point": {"vertex": 0}}\n')):
                self.assert_same_as_nothing(method, f"/v1/meshes/it{path}", "bob", body)
            self.assertEqual(self.names("bob"), [])
            self.assertEqual(self.names("plain"), [])
            self.assertEqual(self.names("ann"), ["it"])

    def test_no_answer_reveals_the_files_of_another_tenant(self):
        with self.start():
            answers = {}
            for who in ("ann", "bob"):
                put = self.ask("PUT", "/v1/meshes/it", who, SQUARE, **{"If-None-Match": "*"})
                posted = self.ask("POST", "/v1/meshes", who, SQUARE)
                field = self.ask("POST", "/v1/meshes/it/fields", who, '{"set": {"points": [{"vertex": 0}]}}')
                self.assertEqual([answer.status for answer in (put, posted, field)], [201, 201, 201])
                answers[who] = {**put.json, "etag": None, "created": None}, posted.headers["Location"]
                self.assertNotEqual(self.ask("GET", "/v1/meshes/it", who).json["fields_cached"], 2)
                self.assert_same_as_nothing("GET", f"/v1/meshes/it/fields/{field.json['id']}", "plain")
            self.assertEqual(answers["ann"], answers["bob"])
            etags = {self.ask("GET", "/v1/meshes/it", who).headers["ETag"] for who in ("ann", "bob")}
            self.assertEqual(len(etags), 2)
        self.assertEqual(len(list(self.folder.glob("objects/*/*"))), 2, "an object was shared")

    def test_keys_of_one_tenant_share(self):
        with self.start():
            self.assertEqual(self.ask("PUT", "/v1/meshes/it", "ann", SQUARE).status, 201)
            self.assertEqual(self.ask("GET", "/v1/meshes/it/distance?from=v:0&to=v:2", "viewer").status, 200)
            self.assertEqual(self.ask("PUT", "/v1/meshes/it", "viewer", SQUARE).status, 403)
            self.assertEqual(self.ask("PUT", "/v1/meshes/it", "second", SQUARE).status, 200)
            self.assertEqual(self.ask("DELETE", "/v1/meshes/it", "second").status, 204)
            self.assertEqual(self.names("ann"), [])

    def test_jobs_are_visible_to_their_tenant_only(self):
        with self.start():
            self.ask("PUT", "/v1/meshes/it", "ann", SQUARE)
            job = self.ask("POST", "/v1/meshes/it/distance", "ann", PAIR, Prefer="respond-async").headers["Location"]
            self.assertEqual(self.ask("GET", job, "viewer").status, 200)
            for suffix in ("", "/result", "/events"):
                self.assertEqual(self.ask("GET", job + suffix, "bob").status, 404)
            self.assertEqual(self.ask("DELETE", job, "bob").status, 404)
            self.assertEqual(self.ask("GET", "/v1/jobs", "bob").json["jobs"], [])
            self.assertEqual(len(self.ask("GET", "/v1/jobs", "ann").json["jobs"]), 1)
            put = self.ask("PUT", "/v1/meshes/later", "bob", SQUARE, Prefer="respond-async")
            self.assertEqual(put.status, 202)
            # ends with the job
            events = self.ask("GET", put.headers["Location"] + "/events", "bob")
            self.assertIn(b"done", events.body)
            self.assertEqual((self.names("ann"), self.names("bob")), (["it"], ["later"]))

    def metrics(self, who, **headers):
        return self.ask("GET", "/metrics", who, **headers).body.decode()

    def test_only_operators_get_the_metrics_of_all_tenants(self):
        """Only keys give the rights of an operator. A local client address, as behind a proxy, does
        not give them, and neither do the proxy's headers."""
        with self.start():
            self.ask("PUT", "/v1/meshes/it", "ann", SQUARE)
            job = self.ask("POST", "/v1/meshes/it/distance", "ann", PAIR, Prefer="respond-async").headers["Location"]
            wait_until(lambda: self.ask("GET", job, "ann").json["state"] == "done")
            for who, own in (("ann", ANNS), ("viewer", ANNS), ("bob", {"bob"}), ("plain", {"plain"})):
                for headers in ({}, {"X-Forwarded-For": "127.0.0.1"}, {"Forwarded": "for=127.0.0.1"}):
                    text = self.metrics(who, **headers)
                    self.assertEqual(set(re.findall(r'key="([^"]+)"', text)), own, who)
                    self.assertEqual(set(re.findall(r"^geodesicd_(\w+)", text, re.M)), {"key_requests_total", "key_requests", "key_refusals_total", "jobs"})
                    self.assertIn(f'geodesicd_jobs{{state="done"}} {int(own == ANNS)}\n', text)
            for who in ("watch", "watch-ann"):
                text = self.metrics(who)
                self.assertEqual(set(re.findall(r'key="([^"]+)"', text)), {entry.split()[0] for entry in KEYS})
                for name in ("memory_bytes", "requests_total", "uptime_seconds", "log_lines_dropped_total"):
                    self.assertIn(f"\ngeodesicd_{name}", text)
                self.assertEqual(self.ask("PUT", "/v1/meshes/it", who, SQUARE).status, 403)

    def test_an_operator_sees_no_meshes_of_others(self):
        with self.start():
            self.ask("PUT", "/v1/meshes/it", "ann", SQUARE)
            self.assertEqual(self.names("watch"), [])
            self.assert_same_as_nothing("GET", "/v1/meshes/it", "watch")

    def job(self, who):
        """Runs a job with an answer of some 100 kB; returns its location once it is done."""
        body = json.dumps({"from": {"vertex": 0}, "to": "all"})
        answer = self.ask("POST", "/v1/meshes/grid/log", who, body, Prefer="respond-async")
        self.assertEqual(answer.status, 202, answer)
        wait_until(lambda: self.ask("GET", answer.headers["Location"], who).json["state"] in ("done", "failed"))
        return answer.headers["Location"]

    def test_results_of_one_tenant_do_not_evict_those_of_another(self):
        """Results of jobs may take an eighth of the memory budget. Beyond that the daemon evicts
        results of the tenant whose results take the most memory."""
        with self.start("--memory-budget", "32MiB", "--max-body", "4MiB"):
            for who in ("ann", "bob"):
                self.assertEqual(self.ask("PUT", "/v1/meshes/grid", who, sample("grid", columns=30, rows=30)).status, 201)
            own = [self.job("bob") for _ in range(3)]
            others = [self.job("ann") for _ in range(60)]
            self.assertEqual([self.ask("GET", job + "/result", "bob").status for job in own], [200] * 3)
            kept = [self.ask("GET", job, "ann").status for job in others]
            self.assertEqual(kept, sorted(kept, reverse=True), "the oldest go first")
            self.assertEqual((kept[0], kept[-1]), (404, 200))

    def test_jobs_of_one_tenant_do_not_evict_those_of_another(self):
        with self.start("--max-jobs", "20"):
            for who in ("ann", "bob"):
                self.assertEqual(self.ask("PUT", "/v1/meshes/grid", who, sample("grid", columns=3, rows=3)).status, 201)
            own = [self.job("bob") for _ in range(5)]
            others = [self.job("ann" if number % 2 else "second") for number in range(60)]
            self.assertEqual([self.ask("GET", job, "bob").status for job in own], [200] * 5)
            self.assertEqual(sum(self.ask("GET", job, "ann").status == 200 for job in others), 15)

    def connect(self, who, head, rest=b"\r\n"):
        """Begins a request on a connection that stays open, and unread, until the end of the
        test."""
        connection = socket.socket()
        self.addCleanup(connection.close)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.connect(("127.0.0.1", self.daemon.port))
        head = f"{head} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {key_of(who)}\r\n"
        with contextlib.suppress(ConnectionError):  # the daemon has refused the head
            connection.sendall(head.encode() + rest)

    def memory(self, kind):
        pattern = f'^geodesicd_memory_bytes{{class="{kind}"}} (.*)$'
        return int(re.search(pattern, self.ask("GET", "/metrics", "watch").body.decode(), re.M)[1])

    def test_bodies_of_one_tenant_leave_memory_to_others(self):
        """A tenant withholds the ends of bodies that need more than the memory budget together."""
        with self.start("--memory-budget", "64MiB", "--max-body", "8MiB"):
            for number in range(80):
                self.connect("viewer" if number % 2 else "ann", "POST /v1/meshes/grid/pairs",
                             b"Content-Length: %d\r\n\r\n" % (1 << 20) + bytes((1 << 20) - 1))
            wait_until(lambda: self.memory("flight") > 25 << 20)
            large = self.ask("PUT", "/v1/meshes/grid", "ann", bytes(8 << 20))
            self.assertEqual((large.status, large.headers["Retry-After"]), (507, "1"), large)
            self.assertIn("tenant", large.json["detail"])
            self.assertLessEqual(self.memory("flight"), 33 << 20)
            self.assertEqual(self.ask("PUT", "/v1/meshes/grid", "bob", sample("grid", columns=100, rows=100)).status, 201)

    # a query whose answer of 8 MB is larger than the kernel's buffers
    LARGE = json.dumps({"sources": [{"vertex": i % 99} for i in range(84)], "targets": [{"vertex": i % 99} for i in range(12000)]})
    BINARY = {"Accept": "application/octet-stream"}

    def put_grids(self):
        for who in ("ann", "bob"):
            self.assertEqual(self.ask("PUT", "/v1/meshes/grid", who, sample("grid", columns=10, rows=10)).status, 201)

    def test_unread_answers_of_one_tenant_leave_memory_to_others(self):
        with self.start("--memory-budget", "128MiB", "--max-body", "8MiB"):
            self.put_grids()
            for _ in range(12):
                self.connect("ann", "POST /v1/meshes/grid/matrix",
                             f"Accept: application/octet-stream\r\nContent-Length: {len(self.LARGE)}\r\n\r\n{self.LARGE}".encode())
            wait_until(lambda: self.memory("answers") > 16 << 20)
            wait_until(lambda: len([line for line in self.daemon.log if line.get("route", "").endswith("/matrix")]) == 12)
            self.assertLessEqual(self.memory("answers"), 33 << 20)
            answer = self.ask("POST", "/v1/meshes/grid/matrix", "bob", self.LARGE, **self.BINARY)
            self.assertEqual((answer.status, len(answer.body)), (200, 84 * 12000 * 8), answer)

    def test_an_answer_beyond_the_share_of_a_tenant_is_too_large(self):
        """Such an answer never fits, so no time to try again is named."""
        with self.start("--memory-budget", "24MiB", "--max-body", "4MiB"):
            self.put_grids()
            limit = self.ask("GET", "/v1", "ann").json["limits"]["max_answer_bytes"]
            self.assertEqual(limit, 6 << 20)
            refused = self.ask("POST", "/v1/meshes/grid/matrix", "ann", self.LARGE, **self.BINARY)
            self.assertEqual((refused.status, refused.json["limit"], refused.headers["Retry-After"]), (507, limit, None), refused)
            self.assertIn("--memory-budget", refused.json["detail"])

    def large_job(self, who):
        """Runs a job with a large result; returns its URL and its last state."""
        location = self.ask("POST", "/v1/meshes/grid/matrix", who, self.LARGE, Prefer="respond-async", **self.BINARY).headers["Location"]
        return location, wait_until(lambda: (state := self.ask("GET", location, who).json["state"]) in ("done", "failed") and state)

    def test_unread_results_of_one_tenant_leave_room_to_jobs_of_others(self):
        """A tenant deletes its jobs while it reads their results slowly."""
        with self.start("--memory-budget", "128MiB", "--max-body", "8MiB"):
            self.put_grids()
            for _ in range(2):
                location, state = self.large_job("ann")
                self.assertEqual(state, "done")
                self.connect("ann", f"GET {location}/result")
                wait_until(lambda: [line for line in self.daemon.log if line.get("path") == location + "/result"])
                self.assertEqual(self.ask("DELETE", location, "ann").status, 204)
            self.assertEqual(self.large_job("bob")[1], "done")

    def test_a_tenant_with_a_full_queue_leaves_places_for_others(self):
        """While 250 jobs of one tenant wait, another tenant's query is answered at once, and its
        job is accepted."""
        with self.start("--workers", "1", "--landmarks", "0", "--queue-length", "64", "--timeout-ms", "120000"):
            for who in ("ann", "bob"):
                self.assertEqual(self.ask("PUT", "/v1/meshes/grid", who, sample("terrain", cells=120, amplitude=1)).status, 201)
            sources = json.dumps({"sources": [{"vertex": 11 * i} for i in range(1000)], "targets": [{"vertex": 4877 * i} for i in range(4)]})
            flood = [self.ask("POST", "/v1/meshes/grid/matrix", "ann", sources, Prefer="respond-async") for _ in range(250)]
            self.assertEqual({answer.status for answer in flood}, {202, 503})
            for vertex in range(3):
                body = json.dumps({"set": {"points": [{"vertex": 17 + vertex}]}})
                answer = self.ask("POST", "/v1/meshes/grid/fields?timeout_ms=30000", "bob", body)
                self.assertEqual(answer.status, 201, answer)
            self.assertEqual(self.ask("POST", "/v1/meshes/grid/matrix", "bob", sources, Prefer="respond-async").status, 202)
            jobs = [answer.headers["Location"] for answer in flood if answer.status == 202]
            self.assertIn("queued", [self.ask("GET", job, "ann").json["state"] for job in jobs])
            for job in jobs:
                self.ask("DELETE", job, "ann")

    def test_a_restart_mixes_nothing(self):
        with self.start():
            self.ask("PUT", "/v1/meshes/it", "ann", SQUARE)
            self.ask("PUT", "/v1/meshes/it", "bob", TETRAHEDRON)
            self.ask("PUT", "/v1/meshes/it", "plain", TETRAHEDRON)
        with self.start():
            faces = [self.ask("GET", "/v1/meshes/it", who).json["faces"] for who in ("ann", "bob", "plain")]
            self.assertEqual(faces, [2, 4, 4])
            self.assertEqual(self.ask("GET", "/v1/meshes/it/distance?from=v:0&to=v:3", "bob").status, 200)
            self.assertEqual(self.ask("DELETE", "/v1/meshes/it", "bob").status, 204)
            self.assertEqual(self.names("plain"), ["it"])
        # a daemon without keys lists only the surfaces that belong to no tenant
        with Daemon("--data-dir", str(self.folder)) as daemon:
            self.assertEqual([mesh["faces"] for mesh in daemon.get("/v1/meshes").json["meshes"]], [4])

    def test_keygen_names_the_tenant(self):
        self.assertIn(" tenant=ann", keygen("viewer", "--tenant", "ann").stdout.splitlines()[1])
        self.assertEqual(keygen("viewer", "--tenant", "no such").returncode, 2)
        self.assertIn(" role=operator", keygen("watch", "--role", "operator").stdout.splitlines()[1])
        self.assertEqual(keygen("watch", "--role", "root").returncode, 2)
        self.keys.write_text("viewer sha256:" + digest("x") + " tenant=../up\n")
        refused = subprocess.run([PROGRAM, "--store", "memory", "--listen", "127.0.0.1:0", "--keys", self.keys], text=True,
                                 capture_output=True, timeout=PATIENCE_SECONDS)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("a tenant has 1 to 64 letters, digits", refused.stderr)


if __name__ == "__main__":
    unittest.main()
