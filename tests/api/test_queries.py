"""Tests distance, path and nearest on surfaces for which the answers have closed forms."""
import gzip
import json
import math
import unittest

from harness import SEARCHES, SQUARE, TWO_TRIANGLES, TestCase, form_tag, header_fields, sample


class ClosedForms(TestCase):
    """Searches each pair on a fresh mesh; the classes below use fields instead."""

    counter = "searches_total"
    source = None  # the end of the pair whose field exists: "from" or "to"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.files = {"square": SQUARE, "apart": TWO_TRIANGLES, "grid": sample("grid", columns=20, rows=20),
                     "box": sample("box", cells=4)}

    def build_field(self, mesh, source):
        self.daemon.ask_often(mesh, source)
        self.daemon.get(f"/v1/meshes/{mesh}/distance?from={source}&to={source}")
        self.assertEqual(self.daemon.get(f"/v1/meshes/{mesh}").json["fields_cached"], 1)

    def path(self, mesh, start, end):
        self.daemon.request("DELETE", f"/v1/meshes/{mesh}")
        self.daemon.put(mesh, self.files[mesh])
        if self.source:
            self.build_field(mesh, {"from": start, "to": end}[self.source])
        before = self.daemon.metric(self.counter)
        answer = self.daemon.get(f"/v1/meshes/{mesh}/path?from={start}&to={end}")
        self.assertEqual(answer.status, 200, answer)
        self.assertEqual(self.daemon.metric(self.counter) - before, 1, "it was answered in another way")
        return answer.json

    def distance(self, mesh, start, end):
        return self.path(mesh, start, end)["distance"]

    def test_flat(self):
        self.assertAlmostEqual(self.distance("square", "v:0", "v:2"), math.sqrt(2), 12)
        across = self.distance("square", "e:0-1:0.5", "f:1:0.25,0.25,0.5")
        self.assertAlmostEqual(across, math.dist((0.5, 0), (0.25, 0.75)), 12)
        far = self.distance("grid", "p:0.1,0.2,0", "p:0.9,0.7,0")
        self.assertAlmostEqual(far, math.dist((0.1, 0.2), (0.9, 0.7)), 12)

    def test_distances_are_a_metric(self):
        points = ["v:0", "p:1,1,1", "p:0.3,0.2,0", "p:0,0.4,0.7"]
        d = {(a, b): self.distance("box", a, b) for a in points for b in points}
        for a in points:
            self.assertEqual(d[a, a], 0)
            for b in points:
                self.assertAlmostEqual(d[a, b], d[b, a], 12)
                for c in points:
                    self.assertLessEqual(d[a, c], d[a, b] + d[b, c] + 1e-12)

    def test_opposite_corners_of_a_box(self):
        answer = self.path("box", "p:0,0,0", "p:1,1,1")
        self.assertAlmostEqual(answer["distance"], math.sqrt(5), 12)
        self.assertAlmostEqual(answer["path"]["length"], math.sqrt(5), 12)

    def test_a_path_runs_from_one_point_to_the_other(self):
        one, other = "p:0.1,0.2,0", "p:0.9,0.7,0"
        for start, end in ((one, other), (other, one)):
            answer = self.path("grid", start, end)
            points = [point["xyz"] for point in answer["path"]["points"]]
            self.assertEqual((points[0], points[-1]), (answer["from"]["xyz"], answer["to"]["xyz"]))
            self.assertAlmostEqual(sum(map(math.dist, points, points[1:])), answer["distance"], 12)

    def test_other_component(self):
        answer = self.path("apart", "v:0", "v:4")
        self.assertEqual((answer["distance"], answer["reason"], answer["path"]), (None, "no_path", None))


class FromTheFieldOfTheStart(ClosedForms):
    counter, source = "cache_hits_total", "from"


class FromTheFieldOfTheEnd(ClosedForms):
    """Queries use the field of the second point. Distances are the same, and the path must be
    reversed."""

    counter, source = "cache_hits_total", "to"


class Pairs(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("square", SQUARE)
        cls.daemon.put("grid", sample("grid", columns=20, rows=20))
        cls.daemon.put("box", sample("box", cells=4))

    def distance(self, mesh, start, end):
        answer = self.daemon.get(f"/v1/meshes/{mesh}/distance?from={start}&to={end}")
        self.assertEqual(answer.status, 200, answer)
        return answer.json["distance"]

    def test_get_and_post_agree(self):
        document = {"from": {"xyz": [0, 0, 0]}, "to": {"face": 7, "barycentric": [0.5, 0.25, 0.25]}}
        post = self.daemon.ask("box", "path", document)
        get = self.daemon.get("/v1/meshes/box/path?from=p:0,0,0&to=f:7:0.5,0.25,0.25")
        self.assertEqual(post.status, 200, post)
        self.assertEqual(post.json, get.json)
        self.assertEqual(post.headers["ETag"], get.headers["ETag"])
        self.assertEqual(get.headers["ETag"], form_tag(self.daemon.get("/v1/meshes/box").headers["ETag"], "json"))

    def test_answers_without_lines_take_no_geometry(self):
        for query, body in (("matrix", {"sources": ["v:0"], "targets": ["v:1"]}), ("nearest", {"point": "v:0"})):
            self.assertEqual(self.daemon.ask("grid", f"{query}?geometry=full", body).status, 200)
            for word in ("xyz", "none"):
                problem = self.assert_problem(self.daemon.ask("grid", f"{query}?geometry={word}", body), 400, "invalid_request")
                self.assertEqual(problem["parameter"], "geometry")

    def test_fields_and_geometry(self):
        url = "/v1/meshes/grid/path?from=v:0&to=v:5"
        self.assertEqual(list(self.daemon.get(f"{url}&select=distance").json), ["distance"])
        points = self.daemon.get(f"{url}&geometry=xyz").json["path"]["points"]
        self.assertTrue(all(len(point) == 3 for point in points))
        self.assertNotIn("points", self.daemon.get(f"{url}&geometry=none").json["path"])

    def test_compressed(self):
        url = "/v1/meshes/grid/path?from=v:0&to=p:0.99,0.93,0"
        plain, packed = self.daemon.get(url), self.daemon.get(url, Accept_Encoding="br, gzip")
        self.assertGreater(len(plain.body), 1024)
        self.assertEqual((plain.headers["Content-Encoding"], packed.headers["Content-Encoding"]), (None, "gzip"))
        self.assertIn("Accept-Encoding", packed.headers.get_all("Vary"))
        self.assertEqual(gzip.decompress(packed.body), plain.body)
        refused = self.daemon.get(url, Accept_Encoding="gzip;q=0, identity")
        self.assertIsNone(refused.headers["Content-Encoding"])

    def test_a_frequent_source_gets_a_field(self):
        self.daemon.put("fresh", sample("icosphere", level=4))
        before = {name: self.daemon.metric(name) for name in ("cache_builds_total", "searches_total")}

        def counted():
            return [self.daemon.metric(name) - before[name] for name in ("searches_total", "cache_builds_total")]

        def ask(first, last):
            """Queries vertex 12 with one other vertex after the other. Every second query swaps the
            two points, because queries are counted for both ends of a pair."""
            ends = [("v:12", f"v:{vertex}") for vertex in range(first, last)]
            return [self.distance("fresh", *(pair[::-1] if number % 2 else pair)) for number, pair in enumerate(ends)]

        searched = ask(100, 100 + SEARCHES - 1)
        self.assertEqual(counted(), [SEARCHES - 1, 0])
        built = ask(100 + SEARCHES - 1, 150)
        self.assertEqual(counted(), [SEARCHES - 1, 1])
        for one, other in zip(searched + built, ask(100, 150)):
            self.assertAlmostEqual(one, other, 12)
        self.assertEqual(counted(), [SEARCHES - 1, 1])

    def test_queries_of_different_sources_build_no_field(self):
        self.daemon.put("many", sample("icosphere", level=3))
        builds, searches = self.daemon.metric("cache_builds_total"), self.daemon.metric("searches_total")
        for number in range(200):
            self.distance("many", f"v:{number}", f"v:{number + 300}")
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds)
        self.assertEqual(self.daemon.metric("searches_total"), searches + 200)

    def test_absent_points(self):
        for point in ("v:99", "f:2:1,0,0", "e:1-3:0.5"):
            answer = self.daemon.get(f"/v1/meshes/square/distance?from=v:0&to={point}")
            problem = self.assert_problem(answer, 400, "invalid_request")
            self.assertEqual(problem["parameter"], "to")
        answer = self.daemon.ask("square", "distance", {"from": {"vertex": 0}, "to": {"vertex": 99}})
        self.assertTrue(self.assert_problem(answer, 400, "invalid_request")["pointer"].startswith("/to"))
        far = {"xyz": [9, 9, 9], "max_snap": 0.5}
        answer = self.daemon.ask("square", "distance", {"from": {"vertex": 0}, "to": far})
        self.assert_problem(answer, 422, "point_not_on_surface")

    def test_preconditions_of_a_query(self):
        etag = self.daemon.get("/v1/meshes/square").headers["ETag"]
        document = json.dumps({"from": {"vertex": 0}, "to": {"vertex": 2}})

        def post(**headers):
            return self.daemon.request("POST", "/v1/meshes/square/distance", document,
                                       header_fields({"Content-Type": "application/json", **headers}))

        for fine in ({"If_Match": etag}, {"If_Match": "*"}, {"If_None_Match": '"x"'}):
            self.assertEqual(post(**fine).status, 200, fine)
        for failed in ({"If_Match": '"x"'}, {"If_None_Match": etag}, {"If_None_Match": "*"}):
            self.assert_problem(post(**failed), 412, "precondition_failed")
        url = "/v1/meshes/square/distance?from=v:0&to=v:2"
        self.assert_problem(self.daemon.get(url, If_Match='"x"'), 412, "precondition_failed")
        self.assertEqual(self.daemon.get(url, If_None_Match=form_tag(etag, "json")).status, 304)
        self.assertEqual(self.daemon.get(url, If_None_Match=etag).status, 200)

    def test_an_absent_mesh(self):
        self.assert_problem(self.daemon.get("/v1/meshes/nobody/distance?from=v:0&to=v:1"), 404, "not_found")


class Nearest(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("square", SQUARE)

    def test_point_above(self):
        point = self.daemon.get("/v1/meshes/square/nearest?point=p:0.5,0.25,2").json
        self.assertEqual((point["face"], point["snap_distance"]), (0, 2))
        self.assertEqual(point["xyz"], [0.5, 0.25, 0])

    def test_forms_of_the_same_corner(self):
        forms = ["v:2", "f:0:0,0,1", "e:2-3:0", "p:1,1,0"]
        found = [self.daemon.get(f"/v1/meshes/square/nearest?point={form}").json for form in forms]
        for point in found:
            self.assertEqual((point["vertex"], point["face"], point["xyz"]), (2, 0, [1, 1, 0]))

    def test_ray(self):
        hit, missed = (
            self.daemon.ask("square", "nearest", {"point": {"ray": {"origin": origin, "direction": [0, 0, -1]}}})
            for origin in ([0.75, 0.5, 5], [7, 7, 5])
        )
        self.assertEqual(hit.json["xyz"], [0.75, 0.5, 0])
        self.assert_problem(missed, 422, "point_not_on_surface")

    def test_a_large_body_is_read_by_a_worker(self):
        document = {"point": {"vertex": 2}}
        answer = self.daemon.request("POST", "/v1/meshes/square/nearest", " " * 20000 + '{"point": {"vertex": 2}}',
                                     {"Content-Type": "application/json"})
        self.assertEqual(answer.status, 200, answer)
        self.assertEqual(answer.json, self.daemon.ask("square", "nearest", document).json)


class CompactPoints(TestCase):
    """JSON accepts a point as text wherever it accepts a point as an object. The answers are
    equal."""

    POINTS = {"v:0": {"vertex": 0}, "e:0-1:0.5": {"edge": [0, 1], "t": 0.5}, "f:1:0.25,0.25,0.5": {"face": 1, "barycentric": [0.25, 0.25, 0.5]},
              "p:0.5,0.75,1": {"xyz": [0.5, 0.75, 1]}}
    BODIES = [("nearest", lambda p: {"point": p}), ("distance", lambda p: {"from": p, "to": p}), ("path", lambda p: {"from": "v:3", "to": p, "via": [p]}),
              ("matrix", lambda p: {"sources": [p], "targets": [p, p]}), ("distance-to-set", lambda p: {"set": {"points": [p]}, "points": [p, "v:2"]}),
              ("distance-to-set", lambda p: {"set": {"curves": [{"points": [p, "v:2"]}]}, "points": [p]}), ("voronoi", lambda p: {"set": {"points": [p, "v:2"]}}),
              ("trace", lambda p: {"start": p, "fan": 3, "length": 0.1}), ("log", lambda p: {"from": p, "to": [p]}), ("mean", lambda p: {"points": [p, "v:1"]}),
              ("curve-distance", lambda p: {"a": {"points": [p]}, "b": {"points": ["v:2"]}}), ("farthest-points", lambda p: {"start": p, "count": 2}),
              ("transport", lambda p: {"from": "v:2", "to": p, "vectors": [{"direction": {"xyz": [-1, -0.5, 0]}, "length": 1}]}),
              ("spline", lambda p: {"points": [p, "v:2"], "samples": 3})]

    def setUp(self):
        super().setUp()
        self.daemon.put("square", SQUARE)

    def replace(self, value, replaced):
        if isinstance(value, str) and value in replaced:
            return replaced[value]
        if isinstance(value, list):
            return [self.replace(one, replaced) for one in value]
        return {name: self.replace(one, replaced) for name, one in value.items()} if isinstance(value, dict) else value

    def test_compact_points_get_the_answers_of_objects(self):
        objects = {**self.POINTS, **{f"v:{i}": {"vertex": i} for i in range(4)}}
        for name, body in self.BODIES:
            for point in self.POINTS:
                with self.subTest(query=name, point=point):
                    compact = self.daemon.ask("square", name, body(point))
                    spelled = self.daemon.ask("square", name, self.replace(body(point), objects))
                    self.assertEqual((compact.status, compact.json), (200, spelled.json))

    def test_invalid_points_are_refused_with_a_pointer(self):
        for name, body, pointer in (("nearest", {"point": "v:x"}, "/point"), ("path", {"from": "v:0", "to": "v:1", "via": ["v:0", "1"]}, "/via/1"),
                                    ("distance-to-set", {"set": {"points": ["v:0", "w:1"]}, "points": ["v:0"]}, "/set/points/1"),
                                    ("matrix", {"sources": [""], "targets": ["v:0"]}, "/sources/0"), ("distance", {"from": "v:9", "to": "v:0"}, "/from")):
            answer = self.daemon.ask("square", name, body)
            self.assertEqual((answer.status, answer.json["code"], answer.json["pointer"]), (400, "invalid_request", pointer), answer)


if __name__ == "__main__":
    unittest.main()
