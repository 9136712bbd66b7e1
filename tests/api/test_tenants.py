"""Names of each tenant's own: what one has, another can't tell from what nobody has."""
import pathlib
import subprocess
import unittest

from harness import PATIENCE_SECONDS, PROGRAM, SQUARE, TETRAHEDRON, Daemon, Folder
from test_access import bearer, digest, key_of, keygen

KEYS = ("ann role=write", "bob role=write", "viewer role=read tenant=ann", "second role=write tenant=ann", "plain role=write tenant=")
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
        """The answer about a foreign name is, byte for byte, that about one that nobody has."""
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

    def test_nothing_tells_that_another_has_the_same(self):
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

    def test_jobs_are_known_to_their_tenant(self):
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
            events = self.ask("GET", put.headers["Location"] + "/events", "bob")  # ends with the job
            self.assertIn(b"done", events.body)
            self.assertEqual((self.names("ann"), self.names("bob")), (["it"], ["later"]))

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
        with Daemon("--data-dir", str(self.folder)) as daemon:  # without keys: what nobody's key names
            self.assertEqual([mesh["faces"] for mesh in daemon.get("/v1/meshes").json["meshes"]], [4])

    def test_keygen_names_the_tenant(self):
        self.assertIn(" tenant=ann", keygen("viewer", "--tenant", "ann").stdout.splitlines()[1])
        self.assertEqual(keygen("viewer", "--tenant", "no such").returncode, 2)
        self.keys.write_text("viewer sha256:" + digest("x") + " tenant=../up\n")
        refused = subprocess.run([PROGRAM, "--store", "memory", "--listen", "127.0.0.1:0", "--keys", self.keys], text=True,
                                 capture_output=True, timeout=PATIENCE_SECONDS)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("a tenant has the form of a name", refused.stderr)


if __name__ == "__main__":
    unittest.main()
