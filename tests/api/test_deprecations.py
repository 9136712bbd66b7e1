"""Tests former names of paths and parameters. They return the answers of their replacements and a
Deprecation header."""
import json
import re
import unittest

import contract
from contract_scene import JSON, Scene, dumps
from harness import TestCase

DEPRECATION, LINK = "@1795392000", re.compile(r'<(/docs/#/\w+/\w+)>; rel="deprecation"; type="text/html"')
PAIR = {"from": {"vertex": 0}, "to": {"vertex": 1}}
LINE = {"query": "distance", **PAIR}
ENDS = {"from": [0.1, 0.2], "to": [0.8, 0.9]}
FIELD = {"set": {"points": [{"vertex": 0}]}}
# Each row has the method, target and body with the former name, and then the target with the new
# name. The row ends with the new body if that differs. A list stands for a body of lines.
FORMER = [
    ("GET", "/v1/meshes/tetrahedron/distance?from=v:0&to=v:1&fields=distance", None, {"target": "/v1/meshes/tetrahedron/distance?from=v:0&to=v:1&select=distance"}),
    ("POST", "/v1/meshes/tetrahedron/path?fields=distance", PAIR, {"target": "/v1/meshes/tetrahedron/path?select=distance"}),
    ("POST", "/v1/meshes/tetrahedron/fields?fields=max", FIELD, {"target": "/v1/meshes/tetrahedron/fields?select=max"}),
    ("POST", "/v1/meshes/tetrahedron/batch", [LINE], {"target": "/v1/meshes/tetrahedron/queries"}),
    ("POST", "/v1/meshes/tetrahedron/batch?fields=distance", [LINE], {"target": "/v1/meshes/tetrahedron/queries?select=distance"}),
    ("POST", "/v1/meshes/tetrahedron/batch", [{**LINE, "fields": "distance"}],
     {"target": "/v1/meshes/tetrahedron/queries", "body": [{**LINE, "select": "distance"}]}),
    ("POST", "/v1/nurbs/sheet/geodesic", ENDS, {"target": "/v1/nurbs/sheet/path"}),
    ("POST", "/v1/nurbs/sheet/geodesic?fields=length", ENDS, {"target": "/v1/nurbs/sheet/path?select=length"}),
    ("POST", "/v1/nurbs/sheet/evaluate?fields=xyz", {"uv": [[0.5, 0.5]]}, {"target": "/v1/nurbs/sheet/evaluate?select=xyz"}),
    ("POST", "/v1/subdivisions/cube/discretize", {"mesh": "cube-mesh", "level": 1}, {"target": "/v1/subdivisions/cube/tessellate"}),
    ("POST", "/v1/subdivisions/cube/nearest?fields=uv", {"xyz": [0, 0, 2]}, {"target": "/v1/subdivisions/cube/nearest?select=uv"}),
]
VOLATILE = ("build_ms", "created")


class Deprecations(TestCase):
    def setUp(self):
        Scene(self.daemon, contract.load()).fill()

    def ask(self, method, target, body, **headers):
        if isinstance(body, list):
            return self.daemon.request(method, target, b"".join(dumps(line) + b"\n" for line in body), {"Content-Type": "application/x-ndjson", **headers})
        return self.daemon.request(method, target, None if body is None else dumps(body), {**(JSON if body else {}), **headers})

    def assert_deprecated(self, answer):
        self.assertEqual(answer.headers["Deprecation"], DEPRECATION)
        self.assertRegex(answer.headers["Link"], LINK)

    def assert_current(self, answer):
        self.assertIsNone(answer.headers.get("Deprecation"))
        self.assertIsNone(answer.headers.get("Link"))

    def body(self, answer):
        """Returns the body without members that differ between requests."""
        if answer.headers["Content-Type"] != "application/json":
            return answer.body
        return {key: value for key, value in answer.json.items() if key not in VOLATILE}

    def test_a_former_name_gives_the_same_answer(self):
        for method, target, body, new in FORMER:
            with self.subTest(target):
                # creates the result, so that both requests below find it
                self.ask(method, target, body)
                former = self.ask(method, target, body)
                current = self.ask(method, new["target"], new.get("body", body))
                self.assertIn(former.status, (200, 201), former.body)
                self.assert_deprecated(former)
                self.assert_current(current)
                self.assertEqual((former.status, self.body(former)), (current.status, self.body(current)))
                self.assertEqual(former.headers.get("ETag"), current.headers.get("ETag"))

    def test_the_table_has_every_deprecated_name_of_the_contract(self):
        document = contract.load().document
        tried = {contract.load().operation(method, target).path for method, target, *_ in FORMER}
        for path, item in document["paths"].items():
            if any(item.get(method, {}).get("deprecated") for method in contract.METHODS):
                self.assertIn(path, tried)
        components = document["components"]["parameters"].values()
        self.assertEqual([each["name"] for each in components if each.get("deprecated")], ["fields"])

    def test_problems_contain_the_name_that_the_client_sent(self):
        for name in ("fields", "select"):
            answer = self.ask("GET", f"/v1/meshes/tetrahedron/distance?from=v:0&to=v:1&{name}=no_such", None)
            self.assertEqual((answer.status, answer.json["parameter"]), (400, name))
        for query in ("fields=distance&select=distance", "fields=distance&fields=from"):
            answer = self.ask("GET", "/v1/meshes/tetrahedron/distance?from=v:0&to=v:1&" + query, None)
            self.assertEqual((answer.status, answer.json["parameter"]), (400, "fields"))
            self.assert_deprecated(answer)
        for name in ("fields", "select"):
            answer = self.ask("POST", "/v1/meshes/tetrahedron/queries", [{**LINE, name: "no_such"}])
            self.assertEqual(json.loads(answer.body)["pointer"], "/" + name)

    def test_a_former_name_is_unknown_in_other_operations(self):
        answer = self.ask("GET", "/v1/meshes?fields=name", None)
        self.assertEqual((answer.status, answer.json["parameter"]), (400, "fields"))
        self.assert_current(answer)

    def test_a_job_of_a_former_name_has_the_deprecation_header(self):
        accepted = self.ask("POST", "/v1/nurbs/sheet/geodesic?fields=length", ENDS, Prefer="respond-async")
        self.assertEqual(accepted.status, 202)
        self.assert_deprecated(accepted)
        self.assertEqual(list(self.daemon.ended(accepted)["result"]), ["length"])

    def test_conditions_work_with_former_names(self):
        target = "/v1/meshes/tetrahedron/distance?from=v:0&to=v:1&fields=distance"
        tag = self.ask("GET", target, None).headers["ETag"]
        answer = self.ask("GET", target, None, **{"If-None-Match": tag})
        self.assertEqual(answer.status, 304)
        self.assert_deprecated(answer)

    def test_the_link_leads_to_an_operation(self):
        names = {f"/docs/#/{each.tags[0]}/{each.name}" for each in contract.load().operations}
        for method, target, body, _ in FORMER:
            self.assertIn(LINK.match(self.ask(method, target, body).headers["Link"]).group(1), names)


if __name__ == "__main__":
    unittest.main()
