"""Tests fields of the same seeds with different radii. The cache keeps the field of the largest
radius. Answers from this field equal answers from a field of the requested radius."""
import concurrent.futures
import random
import unittest

from harness import TestCase, sample


def members(*numbers):
    """Returns a set of vertices and a point of a face."""
    return {"points": [{"vertex": number} for number in numbers] + [{"face": 40, "barycentric": [0.2, 0.3, 0.5], "offset": 0.1}]}


class Radii(TestCase):
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        meshes = {name: sample("terrain", cells=40, amplitude=0.5) for name in ("near", "fresh", "chain", "crowd", "sets", "pairs", "matrix")}
        cls.put_all(meshes)

    def metrics(self, *names):
        return [self.daemon.metric(f"cache_{name}_total") for name in names]

    def make(self, mesh, number, **more):
        answer = self.daemon.ask(mesh, "fields", {"set": members(number), **more})
        self.assertIn(answer.status, (200, 201), answer)
        return answer.json["id"]

    def values(self, mesh, field):
        answer = self.daemon.get(f"/v1/meshes/{mesh}/fields/{field}/values")
        self.assertEqual(answer.status, 200, answer)
        return answer.json["values"]

    def assert_same(self, values, expected):
        self.assertEqual([value is None for value in values], [value is None for value in expected])
        for value, other in zip(values, expected):
            if value is not None:
                self.assertLessEqual(abs(value - other), 1e-12 * max(value, other))

    def assert_limited(self, values, whole, limit):
        self.assert_same(values, [value if value <= limit else None for value in whole])

    def test_a_larger_field_replaces_a_smaller_one_which_keeps_its_answers(self):
        whole = self.values("fresh", self.make("fresh", 5))
        near = self.make("near", 5, max_distance=0.3)
        self.assert_limited(self.values("near", near), whole, 0.3)
        before = self.metrics("builds")[0]
        far = self.make("near", 5, max_distance=0.6)
        self.assertEqual(self.metrics("builds"), [before + 1])
        self.assert_limited(self.values("near", far), whole, 0.6)
        self.assert_limited(self.values("near", near), whole, 0.3)
        self.assert_same(self.values("near", self.make("near", 5)), whole)
        self.assertEqual(self.metrics("builds"), [before + 2])
        self.assertEqual(self.daemon.get("/v1/meshes/near").json["fields_cached"], 1)
        self.assert_limited(self.values("near", near), whole, 0.3)
        self.assert_limited(self.values("near", far), whole, 0.6)
        self.assert_limited(self.values("near", self.make("near", 5, max_distance=0.1)), whole, 0.1)
        self.assertEqual(self.metrics("builds"), [before + 2])

    def test_the_largest_distance_of_a_partial_field_is_unknown(self):
        self.assertIsNotNone(self.daemon.ask("chain", "fields", {"set": members(1)}).json["max"])
        field = self.daemon.ask("chain", "fields", {"set": members(1), "max_distance": 0.2}).json
        self.assertEqual((field["max"], field["farthest"], field["max_distance"]), (None, None, 0.2))

    def test_points_beyond_the_limit_are_reported_as_before(self):
        points = [{"vertex": number} for number in range(0, 1600, 37)]
        near = self.make("chain", 7, max_distance=0.35)
        url = f"fields/{near}/evaluate"
        alone = self.daemon.ask("chain", url, {"points": points, "path": True}).json["results"]
        self.make("chain", 7)
        shared = self.daemon.ask("chain", url, {"points": points, "path": True}).json["results"]
        reasons = [result.get("reason") for result in alone]
        self.assertIn("beyond_max_distance", reasons)
        self.assertIn(None, reasons)
        self.assertEqual([result.get("reason") for result in shared], reasons)
        for one, other in zip(alone, shared):
            if one["distance"] is None:
                self.assertEqual(one, other)
            else:
                self.assertLessEqual(abs(one["distance"] - other["distance"]), 1e-12)
                self.assertLessEqual(abs(one["path"]["length"] - other["path"]["length"]), 1e-9)
        levels = self.daemon.ask("chain", f"fields/{near}/isolines", {"levels": [0.5]})
        self.assert_problem(levels, 400, "invalid_request")

    def test_removing_the_smaller_field_keeps_the_larger_one(self):
        near, far = self.make("sets", 3, max_distance=0.2), self.make("sets", 3, max_distance=0.4)
        hits = self.metrics("builds")
        self.assertEqual(self.daemon.request("DELETE", f"/v1/meshes/sets/fields/{near}").status, 204)
        self.values("sets", far)
        self.assertEqual(self.metrics("builds"), hits)

    def test_distances_to_a_set_build_a_larger_field(self):
        points = [{"vertex": number} for number in range(0, 1600, 101)]
        self.make("sets", 9, max_distance=0.3)
        builds = self.metrics("builds")[0]
        answer = self.daemon.ask("sets", "distance-to-set", {"set": members(9), "points": points})
        self.assertEqual(self.metrics("builds"), [builds + 1])
        whole = self.values("fresh", self.make("fresh", 9))
        self.assert_same([result["distance"] for result in answer.json["results"]], whole[::101][: len(points)])

    def test_the_field_of_pairs_replaces_one_with_a_radius(self):
        field = self.daemon.ask("pairs", "fields", {"set": {"points": [{"vertex": 11}]}, "max_distance": 0.3})
        self.assertEqual(field.status, 201)
        before = self.metrics("builds")[0]
        self.daemon.ask_often("pairs", "v:11")
        distance = self.daemon.get("/v1/meshes/pairs/distance?from=v:11&to=v:1500").json["distance"]
        self.assertEqual(self.metrics("builds"), [before + 1])
        other = self.daemon.get("/v1/meshes/fresh/distance?from=v:11&to=v:1500").json["distance"]
        self.assertLessEqual(abs(distance - other), 1e-12 * other)

    def test_a_matrix_with_a_limit_uses_fields_of_that_radius(self):
        near = [{"vertex": number} for number in (20, 30)]
        targets = [{"vertex": number} for number in range(0, 1600, 53)]
        request = {"sources": near, "targets": targets, "max_distance": 0.4}
        expected = self.daemon.ask("fresh", "matrix", request).json
        for vertex in near:
            self.assertEqual(self.daemon.ask("matrix", "fields", {"set": {"points": [vertex]}, "max_distance": 0.5}).status, 201)
        hits = self.metrics("hits")[0]
        answer = self.daemon.ask("matrix", "matrix", request).json
        self.assertEqual(self.metrics("hits"), [hits + 2])
        self.assertEqual(answer["reasons"], expected["reasons"])
        for row, other in zip(answer["distances"], expected["distances"]):
            self.assert_same(row, other)

    def test_many_reaches_at_once(self):
        whole = self.values("fresh", self.make("fresh", 13))
        chance = random.Random(3)
        limits = [chance.choice([0.1, 0.2, 0.35, 0.5, 0.8, None]) for _ in range(96)]

        def ask(limit):
            field = self.make("crowd", 13, **({"max_distance": limit} if limit else {}))
            return self.values("crowd", field)

        with concurrent.futures.ThreadPoolExecutor(24) as pool:
            for limit, values in zip(limits, pool.map(ask, limits)):
                self.assert_limited(values, whole, limit or 1e9)
        self.assertEqual(self.daemon.get("/v1/meshes/crowd").json["fields_cached"], 1)


class ShortOfMemory(TestCase):
    flags = ("--workers", "2", "--memory-budget", "16MiB", "--max-body", "4MiB", "--landmarks", "0")

    def test_larger_fields_fit_into_little_memory(self):
        self.put_all({"terrain": sample("terrain", cells=60, amplitude=0.5)})
        for number in range(12):
            for limit in (0.2, 0.5, 0.9, None):
                document = {"set": members(97 * number), **({"max_distance": limit} if limit else {})}
                answer = self.daemon.ask("terrain", "fields", document)
                self.assertIn(answer.status, (200, 201), answer)


if __name__ == "__main__":
    unittest.main()
