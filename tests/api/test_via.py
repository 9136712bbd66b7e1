"""Tests distance and path via other points. A leg is the part between two consecutive points. The
distance is the sum of the distances of the legs."""
import itertools
import math
import random
import unittest

from harness import SEARCHES, TWO_TRIANGLES, TestCase, sample


class Via(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=4))
        cls.daemon.put("grid", sample("grid", columns=20, rows=20))
        cls.daemon.put("apart", TWO_TRIANGLES)

    def distance(self, mesh, start, end):
        return self.daemon.get(f"/v1/meshes/{mesh}/distance?from={start}&to={end}").json["distance"]

    def test_legs_are_summed(self):
        numbers = random.Random(1)
        for count in (1, 2, 5):
            stops = [f"v:{numbers.randrange(2000)}" for _ in range(count + 2)]
            url = f"from={stops[0]}&to={stops[-1]}&via={';'.join(stops[1:-1])}"
            answer = self.daemon.get(f"/v1/meshes/ball/path?{url}")
            self.assertEqual(answer.status, 200, answer)
            legs = sum(self.distance("ball", *pair) for pair in itertools.pairwise(stops))
            self.assertAlmostEqual(answer.json["distance"], legs, 12)
            self.assertAlmostEqual(answer.json["path"]["length"], legs, 12)
            distance = self.daemon.get(f"/v1/meshes/ball/distance?{url}").json["distance"]
            self.assertEqual(distance, answer.json["distance"])

    def test_the_path_is_one_polyline_through_all_points(self):
        document = {"from": {"xyz": [0.1, 0.1, 0]}, "via": [{"xyz": [0.9, 0.2, 0]}, {"vertex": 77}],
                    "to": {"xyz": [0.3, 0.9, 0]}}
        answer = self.daemon.ask("grid", "path", document).json
        points = [point["xyz"] for point in answer["path"]["points"]]
        self.assertEqual((points[0], points[-1]), (answer["from"]["xyz"], answer["to"]["xyz"]))
        self.assertEqual([via["xyz"] in points for via in answer["via"]], [True, True])
        self.assertTrue(all(a != b for a, b in itertools.pairwise(points)))
        self.assertAlmostEqual(sum(map(math.dist, points, points[1:])), answer["distance"], 12)
        stops = [answer["from"]["xyz"], *(via["xyz"] for via in answer["via"]), answer["to"]["xyz"]]
        self.assertAlmostEqual(sum(map(math.dist, stops, stops[1:])), answer["distance"], 12)

    def test_via_is_located_like_the_ends(self):
        document = {"from": {"vertex": 0}, "via": [{"xyz": [0.5, 0.26, 2]}, {"vertex": 3}], "to": {"vertex": 9}}
        answer = self.daemon.ask("grid", "distance", document).json
        self.assertEqual(list(answer), ["distance", "from", "to", "via"])
        self.assertEqual((answer["via"][0]["snap_distance"], answer["via"][1]["vertex"]), (2, 3))
        wanted = self.daemon.get("/v1/meshes/grid/distance?select=via&from=v:0&to=v:9&via=v:3")
        self.assertEqual(list(wanted.json), ["via"])

    def test_an_empty_list_gives_the_direct_path(self):
        plain = self.daemon.ask("grid", "path", {"from": {"vertex": 0}, "to": {"vertex": 9}})
        empty = self.daemon.ask("grid", "path", {"from": {"vertex": 0}, "to": {"vertex": 9}, "via": []})
        self.assertEqual(plain.json, empty.json)
        self.assertNotIn("via", plain.json)

    def test_points_that_repeat(self):
        answer = self.daemon.get("/v1/meshes/ball/path?from=v:5&to=v:5&via=v:5;v:5").json
        self.assertEqual((answer["distance"], answer["path"]["length"]), (0, 0))
        there_and_back = self.daemon.get("/v1/meshes/ball/path?from=v:5&to=v:5&via=v:900").json
        self.assertAlmostEqual(there_and_back["distance"], 2 * self.distance("ball", "v:5", "v:900"), 12)

    def test_a_leg_without_a_path_makes_the_path_null(self):
        for stops in ("from=v:0&to=v:1&via=v:4", "from=v:0&to=v:4&via=v:1", "from=v:4&to=v:0&via=v:1;v:2"):
            answer = self.daemon.get(f"/v1/meshes/apart/path?{stops}")
            self.assertEqual(answer.status, 200)
            found = answer.json
            self.assertEqual((found["distance"], found["reason"], found["path"]), (None, "no_path", None))

    def test_each_leg_uses_a_cached_field_or_a_search(self):
        """A leg with a cached field at either end is not searched."""
        self.daemon.put("fresh", sample("icosphere", level=4))
        self.daemon.ask_often("fresh", "v:7")
        self.daemon.get("/v1/meshes/fresh/distance?from=v:7&to=v:8")
        builds, searches = self.daemon.metric("cache_builds_total"), self.daemon.metric("searches_total")
        url = "/v1/meshes/fresh/distance?from=v:100&to=v:300&via=v:7;v:200"
        answer = self.daemon.get(url).json
        self.assertEqual(self.daemon.metric("searches_total"), searches + 1)
        legs = sum(self.distance("fresh", *pair) for pair in (("v:100", "v:7"), ("v:7", "v:200"), ("v:200", "v:300")))
        self.assertAlmostEqual(answer["distance"], legs, 12)
        for _ in range(SEARCHES):
            self.daemon.get(url)
        self.assertGreater(self.daemon.metric("cache_builds_total"), builds)
        self.assertAlmostEqual(self.daemon.get(url).json["distance"], answer["distance"], 12)

    def test_refusals(self):
        for via in ("", "v:1;", "v:1,v:2", "x", "v:99999"):
            answer = self.daemon.get(f"/v1/meshes/ball/path?from=v:0&to=v:1&via={via}")
            problem = self.assert_problem(answer, 400, "invalid_request")
            self.assertEqual(problem["parameter"], "via")
        document = {"from": {"vertex": 0}, "to": {"vertex": 1}, "via": [{"vertex": 1}, {"vertex": 99999}]}
        problem = self.assert_problem(self.daemon.ask("ball", "path", document), 400, "invalid_request")
        self.assertEqual(problem["pointer"], "/via/1")
        document["via"] = [{"vertex": 1}] * 1001
        problem = self.assert_problem(self.daemon.ask("ball", "path", document), 413, "too_large")
        self.assertEqual((problem["limit"], problem["pointer"]), (1000, "/via"))
        document["via"].pop()
        self.assertEqual(self.daemon.ask("ball", "path", document).status, 200)


if __name__ == "__main__":
    unittest.main()
