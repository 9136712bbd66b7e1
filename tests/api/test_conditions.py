"""Tests preconditions by RFC 9110, sections 8.8.3 and 13, in tables of methods, representations and
conditions."""
import json
import re
import unittest

from harness import FORMAT_VERSION, TestCase, form_tag, sample

JSON = {"Content-Type": "application/json"}
MESH = "/v1/meshes/bent"

# The forms of each URL's answer. A key is the form's name in the entity tag; a value is the Accept
# header. The form None is the mesh itself, whose tag has no form name.
ANSWERS = {
    "": {None: "application/json"},
    "/content": {"obj": "model/obj", "ply": "application/x-ply", "stl": "model/stl", "glb": "model/gltf-binary"},
    "/boundaries": {"json": "application/json"},
    "/distance?from=v:0&to=v:7": {"json": "application/json"},
    "/path?from=v:0&to=v:7": {"json": "application/json", "obj": "model/obj", "csv": "text/csv", "svg": "image/svg+xml"},
    "/fields/{field}": {"json": "application/json"},
    "/fields/{field}/values": {"json": "application/json", "float64": "application/octet-stream", "csv": "text/csv", "ply": "application/x-ply"},
    "/fields/{field}/isolines?count=3": {"json": "application/json", "glb": "model/gltf-binary"},
    "/picture.png?size=64x64": {"png": "image/png"},
    "/picture.svg?size=64x64": {"svg": "image/svg+xml"},
}
QUERIES = {
    "/distance": ({"from": {"vertex": 0}, "to": {"vertex": 7}}, {"json": "application/json"}),
    "/matrix": ({"sources": [{"vertex": 0}], "targets": [{"vertex": 7}]}, {"json": "application/json", "float64": "application/octet-stream"}),
}
CODINGS = ("identity", "gzip")

# Status of GET and HEAD by If-Match and If-None-Match. `{own}` is the tag of the uncompressed
# representation. `{sent}` is the tag of the answer as it is sent. `{other}` is the tag of another
# form. `{past}` is a tag with another format version. `{mesh}` is the tag of the mesh.
READS = (
    (None, None, 200),
    (None, '"{sent}"', 304),
    (None, '"{own}"', 304),
    (None, '"{own}-gzip"', 304),
    (None, 'W/"{sent}"', 304),
    (None, '"x", W/"{sent}"', 304),
    (None, "*", 304),
    (None, '"x"', 200),
    (None, "{sent}", 200),
    (None, '"{other}"', 200),
    (None, '"{other}-gzip"', 200),
    (None, '"{past}"', 200),
    (None, '"{own}-gzip-gzip"', 200),
    ('"{sent}"', None, 200),
    ('"{own}-gzip"', None, 200),
    ('"{other}"', None, 200),
    ('"{mesh}"', None, 200),
    ('"{mesh}-gzip"', None, 200),
    ('"x", "{sent}"', None, 200),
    ("*", None, 200),
    ('W/"{sent}"', None, 412),
    ('W/"{mesh}"', None, 412),
    ('"x"', None, 412),
    ('"{past}"', None, 412),
    # RFC 9110, 13.2.2: If-Match is evaluated first
    ('"x"', '"{sent}"', 412),
    ('"x"', '"x"', 412),
    ('"{mesh}"', '"{sent}"', 304),
    ('"{mesh}"', '"x"', 200),
)
# Status of methods that change the mesh, and of queries by POST (200). These methods accept any tag
# of the mesh.
WRITES = (
    ('"{mesh}"', None, 200),
    ('"{mesh}-gzip"', None, 200),
    ('"{own}"', None, 200),
    ('"{own}-gzip"', None, 200),
    ('"{other}"', None, 200),
    ('"x", "{mesh}"', None, 200),
    ("*", None, 200),
    (None, '"x"', 200),
    ('"{mesh}"', '"x"', 200),
    ('W/"{mesh}"', None, 412),
    ('"x"', None, 412),
    ('"{past}"', None, 412),
    ('"{mesh}-"', None, 412),
    ('"{mesh}-.1"', None, 412),
    (None, '"{mesh}"', 412),
    (None, 'W/"{mesh}-gzip"', 412),
    (None, '"{own}"', 412),
    (None, '"{other}"', 412),
    (None, "*", 412),
    ('"{mesh}"', '"{mesh}"', 412),
    ('"x"', '"x"', 412),
)


def conditions(if_match, if_none_match, tags):
    pairs = (("If-Match", if_match), ("If-None-Match", if_none_match))
    return {name: value.format(**tags) for name, value in pairs if value}


class Conditions(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.file = sample("grid", columns=20, rows=20)
        cls.mesh = cls.daemon.put("bent", cls.file).headers["ETag"].strip('"')
        cls.field = cls.daemon.ask("bent", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]

    def tags(self, form, **more):
        def tag(form, version=FORMAT_VERSION):
            return f"{self.mesh}-{form}.{version}"

        own = tag(form) if form else self.mesh
        return {"mesh": self.mesh, "own": own, "other": tag("csv" if form != "csv" else "json"), "past": tag(form or "json", 0), **more}

    def representations(self):
        for path, forms in ANSWERS.items():
            for form, accept in forms.items():
                for coding in CODINGS:
                    yield MESH + path.format(field=self.field), form, {"Accept": accept, "Accept-Encoding": coding}

    def test_each_representation_has_a_tag(self):
        bodies = {}
        for path, form, headers in self.representations():
            answer = self.daemon.request("GET", path, None, headers)
            with self.subTest(path=path, **headers):
                tag = answer.headers["ETag"]
                packed = "-gzip" if answer.headers["Content-Encoding"] else ""
                self.assertEqual((answer.status, tag), (200, f'"{self.tags(form)["own"]}{packed}"'))
                self.assertEqual(bodies.setdefault((path, tag), answer.body), answer.body)
                if "/values" in path:
                    self.assertIn("Accept", ", ".join(answer.headers.get_all("Vary")).split(", "))

    def test_reads(self):
        for path, form, headers in self.representations():
            sent = self.daemon.request("GET", path, None, headers).headers["ETag"].strip('"')
            for if_match, if_none_match, status in READS:
                given = conditions(if_match, if_none_match, self.tags(form, sent=sent))
                for method in ("GET", "HEAD"):
                    with self.subTest(method=method, path=path, **headers, **given):
                        answer = self.daemon.request(method, path, None, {**headers, **given})
                        self.assertEqual(answer.status, status)
                        if status == 304:
                            self.assertEqual(answer.body, b"")
                            self.assertIn(answer.headers["ETag"].strip('"').removesuffix("-gzip"), sent)

    def test_queries(self):
        for path, (document, forms) in QUERIES.items():
            for form, accept in forms.items():
                for if_match, if_none_match, status in WRITES:
                    given = conditions(if_match, if_none_match, self.tags(form))
                    with self.subTest(path=path, accept=accept, **given):
                        answer = self.daemon.request("POST", MESH + path, json.dumps(document), {**JSON, "Accept": accept, **given})
                        self.assertEqual(answer.status, status)
                        if status == 200:
                            self.assertEqual(answer.headers["ETag"], f'"{self.tags(form)["own"]}"')

    def test_changes(self):
        for if_match, if_none_match, status in WRITES:
            given = conditions(if_match, if_none_match, self.tags("json"))
            with self.subTest(**given):
                answer = self.daemon.request("PUT", MESH, self.file, given)
                self.assertEqual(answer.status, status)
                if status == 200:
                    self.assertEqual(answer.headers["ETag"], f'"{self.mesh}"')
                name = self.daemon.put("gone", self.file).headers["ETag"].strip('"')
                gone = {header: value.replace(self.mesh, name) for header, value in given.items()}
                self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/gone", None, gone).status, 204 if status == 200 else 412)

    def test_dates_and_ranges_are_ignored(self):
        """The resources have no date, and the daemon serves no ranges."""
        old, new = "Mon, 01 Jan 1990 00:00:00 GMT", "Fri, 01 Jan 2100 00:00:00 GMT"
        path = f"{MESH}/fields/{self.field}/values"
        tag = self.daemon.get(path).headers["ETag"]
        for headers, status in (({"If-Modified-Since": new}, 200), ({"If-Unmodified-Since": old}, 200),
                                ({"If-Modified-Since": new, "If-None-Match": '"x"'}, 200),
                                ({"If-Modified-Since": old, "If-None-Match": tag}, 304),
                                ({"If-Unmodified-Since": old, "If-Match": tag}, 200),
                                ({"Range": "bytes=0-9", "If-Range": tag}, 200)):
            for method in ("GET", "HEAD"):
                with self.subTest(method=method, **headers):
                    self.assertEqual(self.daemon.request(method, path, None, headers).status, status)

    def test_errors_come_before_conditions(self):
        """RFC 9110, 13.2.1: a request that fails without conditions fails in the same way with
        conditions."""
        for path, headers, status in (("/v1/meshes/nobody", {}, 404), (f"{MESH}/distance?from=v:0&to=v:99999", {}, 400),
                                      (f"{MESH}/fields/{'0' * 32}/values", {}, 404), (f"{MESH}/content", {"Accept": "text/html"}, 406)):
            for given in ({"If-None-Match": "*"}, {"If-Match": '"x"'}, {"If-Match": "*", "If-None-Match": f'"{self.mesh}"'}):
                with self.subTest(path=path, **given):
                    self.assertEqual(self.daemon.request("GET", path, None, {**headers, **given}).status, status)

    def test_options_ignores_conditions(self):
        for given in ({"If-Match": '"x"'}, {"If-None-Match": "*"}):
            self.assertEqual(self.daemon.request("OPTIONS", MESH, None, given).status, 204)

    def test_answers_of_jobs_have_the_same_tags(self):
        path = f"{MESH}/matrix"
        document = json.dumps(QUERIES["/matrix"][0])
        job = self.daemon.ended(self.daemon.request("POST", path, document, {**JSON, "Accept": "application/octet-stream", "Prefer": "respond-async"}))
        result = f"/v1/jobs/{job['id']}/result"
        tags = self.tags("float64")
        self.assertEqual(self.daemon.get(result).headers["ETag"], f'"{tags["own"]}"')
        for if_match, if_none_match, status in ((None, '"{own}"', 304), (None, '"{other}"', 200), (None, '"{mesh}"', 200), ('"{mesh}"', None, 200)):
            given = conditions(if_match, if_none_match, tags)
            self.assertEqual(self.daemon.request("GET", result, None, given).status, status, given)

    def test_pages(self):
        tag = self.daemon.get("/openapi.json").headers["ETag"]
        self.assertTrue(re.fullmatch('"[0-9a-f]{32}"', tag))
        for given, status in (({"If-None-Match": tag}, 304), ({"If-None-Match": form_tag(tag, "json")}, 200), ({"If-Match": tag}, 200), ({"If-Match": '"x"'}, 412)):
            self.assertEqual(self.daemon.request("GET", "/openapi.json", None, given).status, status, given)


if __name__ == "__main__":
    unittest.main()
