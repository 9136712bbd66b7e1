"""Tests fields as resources: their life cycle, their values at vertices, points and edges, and
their eviction when memory is short."""
import concurrent.futures
import math
import random
import struct
import tempfile
import unittest

from harness import SQUARE, TETRAHEDRON, TWO_TRIANGLES, Daemon, TestCase, form_tag, sample

DESCRIPTION = ["id", "wedges", "bytes", "build_ms", "max", "farthest", "members", "max_distance", "set", "created"]


def vertices(*numbers, **more):
    return {"set": {"points": [{"vertex": number} for number in numbers]}, **more}


def random_point(chance, faces):
    weights = [chance.expovariate(1) for _ in range(3)]
    return {"face": chance.randrange(faces), "barycentric": [weight / sum(weights) for weight in weights]}


class Fields(TestCase):
    def make(self, mesh, document, status=201):
        answer = self.daemon.ask(mesh, "fields", document)
        self.assertEqual(answer.status, status, answer)
        return answer.json

    def get(self, mesh, path, **headers):
        return self.daemon.get(f"/v1/meshes/{mesh}/fields/{path}", **headers)


class Life(Fields):
    def test_equal_requests_make_one_field(self):
        self.daemon.put("tetrahedron", TETRAHEDRON)
        first = self.daemon.ask("tetrahedron", "fields", vertices(0))
        again = self.daemon.ask("tetrahedron", "fields", vertices(0))
        self.assertEqual((first.status, again.status), (201, 200))
        self.assertEqual(first.body, again.body)
        field = first.json
        self.assertEqual(list(field), DESCRIPTION)
        self.assertRegex(field["id"], "^[0-9a-f]{32}$")
        self.assertEqual(first.headers["Location"], f"/v1/meshes/tetrahedron/fields/{field['id']}")
        self.assertEqual(first.headers["ETag"], form_tag(self.daemon.get("/v1/meshes/tetrahedron").headers["ETag"], "json"))
        self.assertEqual(self.get("tetrahedron", field["id"]).body, first.body)
        self.assertEqual(self.daemon.get(first.headers["Location"] + "?select=max,id").json, {"id": field["id"], "max": field["max"]})
        self.assertEqual(self.daemon.get("/v1/meshes/tetrahedron").json["fields_cached"], 1)

    def test_lists_tell_fields_apart(self):
        self.daemon.put("told", SQUARE)
        few, many = {"points": ["v:0", {"vertex": 1, "label": "home"}]}, {"points": [{"xyz": [0.1, 0.2, 1 / (i + 1)]} for i in range(400)]}
        ids = {self.make("told", {"set": set})["id"]: set for set in (few, many)}
        self.get("told", list(ids)[0])
        self.get("told", f"{list(ids)[0]}/values")
        listed = {field["id"]: field for field in self.daemon.get("/v1/meshes/told/fields").json["fields"]}
        first, second = (listed[id] for id in ids)
        self.assertEqual(list(first), [*DESCRIPTION, "uses"])
        self.assertEqual((first["set"], second["set"]), (few, None))
        self.assertRegex(first["created"], r"^20\d\d-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertGreater(first["uses"], second["uses"])
        self.assertGreater(first["bytes"], 0)

    def test_ids_tell_requests_apart(self):
        self.daemon.put("ids", SQUARE)
        documents = [
            vertices(0),
            vertices(1),
            vertices(0, max_distance=0.5),
            vertices(0, 1),
            vertices(1, 0),
            {"set": {"points": [{"vertex": 0, "offset": 1}]}},
            {"set": {"points": [{"vertex": 0, "label": "home"}]}},
        ]
        ids = [self.make("ids", document)["id"] for document in documents]
        self.assertEqual(len(set(ids)), len(ids))
        self.assertEqual([self.make("ids", document, 200)["id"] for document in documents], ids)
        self.assertEqual(self.make("ids", {"set": {"points": [{"xyz": [0, 0, 0]}]}}, 200)["id"], ids[0])

    def test_list(self):
        self.daemon.put("listed", SQUARE)
        url = "/v1/meshes/listed/fields"
        self.assertEqual(self.daemon.get(url).json, {"fields": [], "next": None})
        fields = sorted((self.make("listed", vertices(number)) for number in range(4)), key=lambda field: field["id"])
        fields = [{**field, "uses": 0} for field in fields]
        self.assertEqual(self.daemon.get(url).json, {"fields": fields, "next": None})
        first = self.daemon.get(f"{url}?limit=3").json
        self.assertEqual((first["fields"], first["next"]), (fields[:3], fields[2]["id"]))
        rest = self.daemon.get(f"{url}?limit=3&after={first['next']}").json
        self.assertEqual(rest, {"fields": fields[3:], "next": None})

    def test_deletion(self):
        self.daemon.put("removed", SQUARE)
        field = self.make("removed", vertices(0))
        url = f"/v1/meshes/removed/fields/{field['id']}"
        self.assertEqual(self.daemon.request("DELETE", url).status, 204)
        self.assert_problem(self.daemon.request("DELETE", url), 404, "not_found")
        self.assert_problem(self.daemon.get(url), 404, "not_found")
        self.assert_problem(self.daemon.get(f"{url}/values"), 404, "not_found")
        self.assert_problem(self.daemon.ask("removed", f"fields/{field['id']}/evaluate", {"points": [{"vertex": 0}]}), 404, "not_found")
        self.assertEqual(self.daemon.get("/v1/meshes/removed").json["fields_cached"], 0)
        self.assertEqual(self.make("removed", vertices(0))["id"], field["id"])

    def test_deleting_a_mesh_deletes_its_fields(self):
        for change in ("replaced", "deleted"):
            self.daemon.put(change, SQUARE)
            field = self.make(change, vertices(0))["id"]
            self.daemon.put(change, SQUARE)  # uploading the same file again changes nothing
            self.assertEqual(self.get(change, field).status, 200)
            if change == "replaced":
                self.daemon.put(change, TETRAHEDRON)
            else:
                self.daemon.request("DELETE", f"/v1/meshes/{change}")
                self.assert_problem(self.get(change, field), 404, "not_found")
            self.daemon.put(change, SQUARE)
            self.assert_problem(self.get(change, field), 404, "not_found")

    def test_one_of_many_simultaneous_requests_builds(self):
        self.daemon.put("crowd", sample("icosphere", level=4))
        builds = self.daemon.metric("cache_builds_total")
        with concurrent.futures.ThreadPoolExecutor(24) as pool:
            answers = list(pool.map(lambda _: self.daemon.ask("crowd", "fields", vertices(7)), range(96)))
        self.assertEqual(len({answer.body for answer in answers}), 1)
        self.assertEqual(sorted(answer.status for answer in answers), [200] * 95 + [201])
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds + 1)

    def test_pairs_are_answered_from_the_field_of_a_point(self):
        self.daemon.put("pairs", sample("icosphere", level=3))
        self.make("pairs", vertices(7))
        hits, searches = self.daemon.metric("cache_hits_total"), self.daemon.metric("searches_total")
        self.assertEqual(self.daemon.get("/v1/meshes/pairs/distance?from=v:7&to=v:9").status, 200)
        self.assertEqual(self.daemon.get("/v1/meshes/pairs/path?to=v:7&from=v:12").status, 200)
        self.assertEqual(self.daemon.metric("cache_hits_total"), hits + 2)
        self.assertEqual(self.daemon.metric("searches_total"), searches)

    def test_refusals(self):
        self.daemon.put("refusals", SQUARE)
        for document, pointer in (
            ({}, "/set"),
            (vertices(0, radius=1), "/radius"),
            (vertices(0, max_distance=0), "/max_distance"),
            (vertices(9), "/set/points/0"),
            ({"set": {"curves": [{"vertices": [0, 9]}]}}, "/set/curves/0"),
        ):
            problem = self.assert_problem(self.daemon.ask("refusals", "fields", document), 400, "invalid_request")
            self.assertEqual(problem["pointer"], pointer)
        field = self.make("refusals", vertices(0))["id"]
        for path, parameter in (
            (f"{field}/wedges", "edge"),
            (f"{field}/wedges?edge=1", "edge"),
            (f"{field}/wedges?edge=1-3", "edge"),
            (f"{field}/values?select=value", "select"),
            (f"{field}?level=1", "level"),
        ):
            problem = self.assert_problem(self.get("refusals", path), 400, "invalid_request")
            self.assertEqual(problem["parameter"], parameter)
        for unknown in ("x", field[:-1], field + "0", field[:-1] + "g", "%00" * 32):
            self.assertIn(self.get("refusals", unknown).status, (400, 404), unknown)
        self.assert_problem(self.get("refusals", f"{field}/values", Accept="image/png"), 406, "not_acceptable")
        self.assert_problem(self.daemon.get("/v1/meshes/none/fields"), 404, "not_found")
        self.assert_problem(self.daemon.ask("refusals", f"fields/{field}", {}), 405, "method_not_allowed")


class Values(Fields):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        meshes = {
            "grid": sample("grid", columns=12, rows=12),
            "box": sample("box", cells=3),
            "terrain": sample("terrain", cells=10, amplitude=1),
            "torus": sample("torus"),
            "apart": b"v 9 9 9\n" + TWO_TRIANGLES.replace(b"f 1 2 3\nf 4 5 6", b"f 2 3 4\nf 5 6 7"),
        }
        cls.faces = {name: mesh["faces"] for name, mesh in cls.put_all(meshes).items()}

    def evaluate(self, mesh, field, points, options="", **more):
        answer = self.daemon.ask(mesh, f"fields/{field}/evaluate{options}", {"points": points, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json["results"]

    def test_evaluates_to_the_distance(self):
        chance = random.Random(1)
        for mesh in ("grid", "box", "terrain", "torus"):
            source = random_point(chance, self.faces[mesh])
            field = self.make(mesh, {"set": {"points": [source]}})["id"]
            points = [random_point(chance, self.faces[mesh]) for _ in range(30)] + [{"vertex": 5}, source]
            for point, result in zip(points, self.evaluate(mesh, field, points, path=True)):
                # no field has `point` as its source, so the daemon searches in this direction
                other = self.daemon.ask(mesh, "distance", {"from": point, "to": source | {"barycentric": source["barycentric"][:]}})
                self.assertLess(abs(result["distance"] - other.json["distance"]), 1e-12 * (1 + result["distance"]))
                self.assertAlmostEqual(result["path"]["length"], result["distance"], 12)
                self.assertEqual(result["nearest"]["index"], 0)

    def test_values_of_vertices(self):
        for mesh in ("box", "torus"):
            field = self.make(mesh, vertices(0, 9))["id"]
            values = self.get(mesh, f"{field}/values").json["values"]
            binary = self.get(mesh, f"{field}/values", Accept="application/octet-stream")
            self.assertEqual(binary.headers["Content-Type"], "application/octet-stream")
            self.assertEqual(list(struct.unpack(f"<{len(values)}d", binary.body)), values)
            results = self.evaluate(mesh, field, [{"vertex": number} for number in range(len(values))], "?select=distance")
            self.assertEqual([result["distance"] for result in results], values)

    def test_vertices_without_a_distance(self):
        field = self.make("apart", vertices(1))["id"]
        self.assertEqual(self.get("apart", f"{field}/values").json["values"], [None, 0, 1, 1, None, None, None])
        binary = self.get("apart", f"{field}/values", Accept="application/octet-stream").body
        self.assertEqual([math.isnan(value) for value in struct.unpack("<7d", binary)], [True, False, False, False] + [True] * 3)

    def test_max_distance(self):
        field = self.make("grid", {"set": {"points": [{"xyz": [0.4, 0.3, 0]}]}, "max_distance": 0.25})
        whole = self.make("grid", {"set": {"points": [{"xyz": [0.4, 0.3, 0]}]}})
        self.assertEqual((field["max_distance"], field["max"], field["farthest"]), (0.25, None, None))
        roomy = self.make("grid", {"set": {"points": [{"xyz": [0.4, 0.3, 0]}]}, "max_distance": 2})
        self.assertEqual((roomy["max"], roomy["farthest"]), (whole["max"], whole["farthest"]))
        self.assertLess(field["wedges"], whole["wedges"])
        chance = random.Random(2)
        points = [{"face": chance.randrange(self.faces["grid"]), "barycentric": [0.5, 0.25, 0.25]} for _ in range(200)]
        complete = self.evaluate("grid", whole["id"], points)
        partial = self.evaluate("grid", field["id"], points, path=True, gradient=True)
        known = 0
        for of_whole, of_field in zip(complete, partial):
            if of_whole["distance"] > 0.25:
                beyond = {"distance": None, "reason": "beyond_max_distance", "nearest": None, "path": None, "gradient": None}
                self.assertEqual(of_field, beyond)
            else:
                self.assertAlmostEqual(of_field["distance"], of_whole["distance"], 12)
                known += 1
        self.assertTrue(0 < known < 200)
        values = self.get("grid", f"{whole['id']}/values").json["values"]
        cut = self.get("grid", f"{field['id']}/values").json["values"]
        self.assertEqual([value is None for value in cut], [value > 0.25 for value in values])
        apart = self.make("apart", vertices(1, max_distance=0.5))["id"]
        reasons = [result["reason"] for result in self.evaluate("apart", apart, [{"vertex": 2}, {"vertex": 5}])]
        self.assertEqual(reasons, ["beyond_max_distance", "no_path"])

    def test_the_farthest_point(self):
        chance = random.Random(3)
        for mesh in ("grid", "box", "terrain", "torus"):
            field = self.make(mesh, {"set": {"points": [random_point(chance, self.faces[mesh]) for _ in range(2)]}})
            farthest = {"face": field["farthest"]["face"], "barycentric": field["farthest"]["barycentric"]}
            self.assertAlmostEqual(self.evaluate(mesh, field["id"], [farthest])[0]["distance"], field["max"], 9)
            points = [random_point(chance, self.faces[mesh]) for _ in range(1000)]
            results = self.evaluate(mesh, field["id"], points, "?select=distance")
            self.assertLessEqual(max(result["distance"] for result in results), field["max"] + 1e-12)
            values = self.get(mesh, f"{field['id']}/values").json["values"]
            self.assertLessEqual(max(values), field["max"] + 1e-12)

    def test_the_gradient_is_where_the_distance_grows(self):
        chance = random.Random(4)
        for mesh in ("grid", "terrain", "torus"):
            faces = self.faces[mesh]
            source = random_point(chance, faces)
            field = self.make(mesh, {"set": {"points": [source]}})["id"]
            points = [{"face": chance.randrange(faces), "barycentric": [0.4, 0.3, 0.3]} for _ in range(20)]
            right = 0
            for point, result in zip(points, self.evaluate(mesh, field, points, gradient=True, path=True)):
                gradient = result["gradient"]["xyz"]
                self.assertAlmostEqual(math.hypot(*gradient), 1, 9)
                here, there = (step["xyz"] for step in result["path"]["points"][:2])
                leg = [(a - b) / math.dist(here, there) for a, b in zip(here, there)]
                right += math.dist(leg, gradient) < 1e-6
            self.assertEqual(right, len(points))
            self.assertIsNone(self.evaluate(mesh, field, [source], gradient=True)[0]["gradient"])

    def test_the_gradient_is_a_direction(self):
        """In the unit square the gradient points away from corner 0. The gradient's angle is
        measured from the zero direction of the point."""
        self.daemon.put("square", SQUARE)
        field = self.make("square", vertices(0))["id"]
        places = (
            ({"face": 0, "barycentric": [0.5, 0.25, 0.25]}, (0.5, 0.25), 0),  # 0 -> 1
            ({"face": 1, "barycentric": [0.25, 0.25, 0.5]}, (0.25, 0.75), 1 / 4),  # 0 -> 2
            ({"edge": [2, 0], "t": 0.5}, (0.5, 0.5), 1 / 4),
            # this gradient and all following gradients point off the surface
            ({"edge": [1, 2], "t": 0.25}, (1, 0.25), 1 / 2),
            ({"edge": [3, 2], "t": 0.25}, (0.25, 1), 1),  # 2 -> 3
            ({"vertex": 1}, (1, 0), 1 / 2),
            ({"vertex": 2}, (1, 1), 1),
        )
        for (point, (x, y), zero), result in zip(places, self.evaluate("square", field, [place[0] for place in places], gradient=True)):
            gradient, way = result["gradient"], math.atan2(y, x)
            self.assertEqual(list(gradient), ["angle", "xyz"])
            self.assertLess(math.dist(gradient["xyz"], [math.cos(way), math.sin(way), 0]), 1e-14)
            self.assertLess(abs(math.remainder(gradient["angle"] - (way - zero * math.pi), 2 * math.pi)), 1e-14, point)

    def test_wedges_are_the_distance_along_an_edge(self):
        for mesh, corners in (("box", [0, 1]), ("torus", [0, 1])):
            field = self.make(mesh, {"set": {"points": [{"face": 7, "barycentric": [0.5, 0.25, 0.25]}]}})["id"]
            answer = self.get(mesh, f"{field}/wedges?edge={corners[1]}-{corners[0]}").json
            self.assertEqual(answer["edge"], corners)
            wedges = answer["wedges"]
            self.assertTrue(wedges)
            length = self.daemon.ask(mesh, "distance", {"from": {"vertex": 0}, "to": {"vertex": 1}}).json["distance"]
            for wedge in wedges:
                self.assertEqual(list(wedge), ["b0", "b1", "d0", "d1", "sigma", "tau", "source"])
                for end, way in (("b0", "d0"), ("b1", "d1")):
                    point = {"edge": corners, "t": min(wedge[end] / length, 1)}
                    distance = self.evaluate(mesh, field, [point])[0]["distance"]
                    self.assertLess(abs(wedge["sigma"] + wedge[way] - distance), 1e-6)

    def test_wedges_of_curves_name_their_members(self):
        curves = [{"vertices": [8, 9, 10, 11]}, {"points": [{"xyz": [0.1, 0.6, 0]}, {"xyz": [0.9, 0.7, 0]}]}]
        field = self.make("grid", {"set": {"points": [{"xyz": [0.51, 0.03, 0]}], "curves": curves}})["id"]
        seen = set()
        for low in range(120):
            for wedge in self.get("grid", f"{field}/wedges?edge={low}-{low + 1}").json.get("wedges", ()):
                seen.add(wedge["source"].get("member"))
                if "linear" in wedge:
                    self.assertEqual(list(wedge), ["b0", "b1", "d0", "d1", "sigma", "tau", "linear", "source"])
                    self.assertTrue(wedge["linear"])
                    self.assertLessEqual(abs(wedge["d1"] - wedge["d0"]), wedge["b1"] - wedge["b0"] + 1e-12)
                    seen.add(("line", wedge["source"]["member"]))
        self.assertLessEqual({0, 1, 2, ("line", 1), ("line", 2)}, seen)
        self.assertLessEqual(seen, {None, 0, 1, 2, ("line", 1), ("line", 2)})


class Memory(Fields):
    flags = ("--memory-budget", "24MiB", "--max-body", "8MiB", "--workers", "2", "--landmarks", "0")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        assert cls.daemon.put("sphere", sample("icosphere", level=4)).status == 201

    def test_evicted_fields_are_computed_again(self):
        fields = [self.make("sphere", vertices(number)) for number in range(30)]
        self.assertGreater(self.daemon.metric("cache_evictions_total"), 0)
        builds = self.daemon.metric("cache_builds_total")
        for number, field in enumerate(fields):
            self.assertEqual(self.get("sphere", field["id"]).json, field)
        # the descriptions of evicted fields are available without a new build
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds)
        for number, field in enumerate(fields):
            result = self.daemon.ask("sphere", f"fields/{field['id']}/evaluate", {"points": [{"vertex": number}]}).json["results"][0]
            self.assertEqual((result["distance"], result["nearest"]["point"]["vertex"]), (0, number))
        self.assertGreater(self.daemon.metric("cache_builds_total"), builds)
        self.assertEqual(self.make("sphere", vertices(0), 200), fields[0])

    def test_ids_stay_valid_after_eviction(self):
        self.daemon.put("tiny", SQUARE)
        field = self.make("tiny", vertices(0))["id"]
        for number in range(1, 1025):
            self.make("tiny", {"set": {"points": [{"edge": [0, 1], "t": number / 2000}]}})
        self.assert_problem(self.get("tiny", field), 410, "field_evicted")
        self.assert_problem(self.daemon.ask("tiny", f"fields/{field}/evaluate", {"points": [{"vertex": 0}]}), 410, "field_evicted")
        self.assertEqual(self.make("tiny", vertices(0))["id"], field)
        self.assertEqual(self.get("tiny", field).status, 200)

    def test_a_field_that_exceeds_the_budget(self):
        self.assertEqual(self.daemon.put("large", sample("terrain", cells=135, amplitude=1)).status, 201)
        problem = self.assert_problem(self.daemon.ask("large", "fields", vertices(9)), 507, "insufficient_memory")
        self.assertEqual(problem["limit"], 24 << 20)
        self.assertRegex(problem["detail"], r"^the field needs more than the available \d+ of the \d+ bytes")
        builds = self.daemon.metric("cache_builds_total")
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda _: self.daemon.ask("large", "fields", vertices(9)), range(8)))
        for answer in answers:
            self.assert_problem(answer, 507, "insufficient_memory")
        # most requests wait for another request's build and get its failure
        self.assertLess(self.daemon.metric("cache_builds_total"), builds + 8)
        self.daemon.request("DELETE", "/v1/meshes/large")


class Deadline(Fields):
    def test_a_build_ends_at_its_deadline_and_another_request_repeats_the_build(self):
        self.daemon.put("sphere", sample("icosphere", level=6))
        answer = self.daemon.ask("sphere", "fields?timeout_ms=1", vertices(3))
        self.assert_problem(answer, 504, "deadline_exceeded")
        self.make("sphere", vertices(3))


class Unloaded(Fields):
    def test_a_mesh_that_is_loaded_again_has_its_fields(self):
        with tempfile.TemporaryDirectory() as folder:
            with Daemon("--data-dir", folder, "--memory-budget", "16MiB", "--max-body", "4MiB", "--landmarks", "0") as daemon:
                body = sample("icosphere", level=4)
                daemon.put("first", body)
                field = daemon.ask("first", "fields", vertices(0)).json
                for number in range(12):
                    daemon.put(f"other{number}", body + b"# %d\n" % number)
                    daemon.get(f"/v1/meshes/other{number}/distance?from=v:0&to=v:1")
                self.assertGreater(daemon.metric("mesh_unloads_total"), 0)
                answer = daemon.get(f"/v1/meshes/first/fields/{field['id']}")
                self.assertEqual((answer.status, answer.json), (200, field))


if __name__ == "__main__":
    unittest.main()
