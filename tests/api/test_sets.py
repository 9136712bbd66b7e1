"""Tests distances to sets: the laws of a distance function, members with offsets and labels,
refusals."""
import concurrent.futures
import math
import random
import unittest

from harness import SQUARE, TWO_TRIANGLES, TestCase, sample

CORNER = {"set": {"points": [{"vertex": 0}]}, "points": [{"vertex": 1}]}


def random_point(chance, faces):
    weights = [chance.expovariate(1) for _ in range(3)]
    return {"face": chance.randrange(faces), "barycentric": [weight / sum(weights) for weight in weights]}


def random_set(chance, faces, size, spread):
    return [random_point(chance, faces) | {"offset": chance.random() * spread} for _ in range(size)]


class Sets(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        meshes = {
            "square": SQUARE,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=12, rows=12),
            "box": sample("box", cells=3),
            "terrain": sample("terrain", cells=10, amplitude=1),
            "torus": sample("torus"),
        }
        cls.faces = {name: mesh["faces"] for name, mesh in cls.put_all(meshes).items()}

    def results(self, mesh, members, points, options="", **more):
        answer = self.daemon.ask(mesh, f"distance-to-set{options}", {"set": {"points": members}, "points": points, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json["results"]

    def distances(self, mesh, members, points):
        return [result["distance"] for result in self.results(mesh, members, points, "?select=distance")]

    def test_flat(self):
        members = [{"xyz": [0.1, 0.2, 0]}, {"xyz": [0.9, 0.3, 0], "offset": 0.25, "label": "b"}]
        chance = random.Random(1)
        points = [[chance.random(), chance.random(), 0] for _ in range(50)]
        results = self.results("grid", members, [{"xyz": point} for point in points], path=True)
        for point, result in zip(points, results):
            ways = [math.dist(point, member["xyz"]) + member.get("offset", 0) for member in members]
            nearest = ways.index(min(ways))
            self.assertAlmostEqual(result["distance"], ways[nearest], 12)
            self.assertEqual((result["nearest"]["index"], result["nearest"]["label"]), (nearest, [None, "b"][nearest]))
            path = result["path"]
            self.assertAlmostEqual(path["length"] + members[nearest].get("offset", 0), result["distance"], 12)
            ends = path["points"][0]["xyz"], path["points"][-1]["xyz"]
            self.assertLess(math.dist(ends[0], point) + math.dist(ends[1], members[nearest]["xyz"]), 1e-12)

    def test_the_least_over_the_members(self):
        chance = random.Random(2)
        for mesh in ("grid", "box", "terrain", "torus"):
            faces = self.faces[mesh]
            members = random_set(chance, faces, 5, 0.3) + [{"vertex": 3, "offset": 0.05}, {"vertex": 9}]
            points = [random_point(chance, faces) for _ in range(40)] + [{"vertex": 17}]
            alone = [self.distances(mesh, [member], points) for member in members]
            results = self.results(mesh, members, points)
            for i, result in enumerate(results):
                ways = [distances[i] for distances in alone]
                self.assertLess(abs(result["distance"] - min(ways)), 1e-12 * (1 + min(ways)), (mesh, i))
                self.assertLess(abs(ways[result["nearest"]["index"]] - min(ways)), 1e-12 * (1 + min(ways)), (mesh, i))

    def test_the_distance_grows_no_faster_than_the_path(self):
        chance = random.Random(3)
        for mesh in ("box", "terrain", "torus"):
            faces = self.faces[mesh]
            members = random_set(chance, faces, 4, 0.5)
            points = [random_point(chance, faces) for _ in range(30)]
            to_set = self.distances(mesh, members, points)
            for i, point in enumerate(points[:6]):
                for j, way in enumerate(self.distances(mesh, [point], points)):
                    self.assertLess(abs(to_set[i] - to_set[j]), way + 1e-12, (mesh, i, j))

    def test_the_distance_at_a_member_is_at_most_its_offset(self):
        members = [{"vertex": 0, "offset": 2}, {"vertex": 0, "offset": 1, "label": "near"}, {"vertex": 2, "offset": 9}]
        results = self.results("square", members, [{"vertex": 0}, {"vertex": 2}], path=True)
        self.assertEqual((results[0]["distance"], results[0]["nearest"]["label"], results[0]["path"]["length"]), (1, "near", 0))
        self.assertAlmostEqual(results[1]["distance"], 1 + math.sqrt(2), 12)
        self.assertEqual(results[1]["nearest"]["index"], 1)

    def test_other_component(self):
        results = self.results("apart", [{"vertex": 0}], [{"vertex": 1}, {"vertex": 4}], path=True)
        self.assertEqual(results[0]["distance"], 1)
        self.assertEqual(results[1], {"distance": None, "reason": "no_path", "nearest": None, "path": None})
        both = self.results("apart", [{"vertex": 0}, {"vertex": 3}], [{"vertex": 1}, {"vertex": 4}])
        self.assertEqual([(result["distance"], result["nearest"]["index"]) for result in both], [(1, 0), (1, 1)])

    def test_fields_and_geometry(self):
        def ask(options):
            return self.results("grid", [{"vertex": 0}], [{"vertex": 9}], options, path=True)[0]

        self.assertEqual(list(ask("")), ["distance", "nearest", "path"])
        self.assertEqual(ask("?select=results"), ask(""))
        self.assertEqual(list(ask("?select=path")), ["path"])
        self.assertTrue(all(len(point) == 3 for point in ask("?geometry=xyz")["path"]["points"]))
        self.assertNotIn("points", ask("?geometry=none")["path"])

    def test_many_points(self):
        chance = random.Random(4)
        members = [random_point(chance, self.faces["torus"]) for _ in range(3)]
        points = [random_point(chance, self.faces["torus"]) for _ in range(5000)]
        together = self.distances("torus", members, points)
        alone = [self.distances("torus", members, [point])[0] for point in points[::500]]
        self.assertEqual(together[::500], alone)

    def test_the_field_of_a_set_is_built_once(self):
        builds, hits = self.daemon.metric("cache_builds_total"), self.daemon.metric("cache_hits_total")
        members = [{"vertex": 1, "label": "a"}, {"vertex": 2}]
        document = {"set": {"points": members}, "points": [{"vertex": 5}]}
        with concurrent.futures.ThreadPoolExecutor(16) as pool:
            answers = list(pool.map(lambda _: self.daemon.ask("terrain", "distance-to-set", document), range(48)))
        self.assertEqual({(answer.status, answer.body) for answer in answers}, {(200, answers[0].body)})
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds + 1)
        members[0]["label"] = "b"  # labels do not change the field
        self.results("terrain", members, [{"vertex": 6}])
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds + 1)
        self.assertGreater(self.daemon.metric("cache_hits_total"), hits)

    def test_refusals(self):
        wrong = [
            ({"set": {"points": [{"vertex": 0}], "curves": [{"boundary": 1}]}}, "/set/curves/0"),
            ({"set": {"boundaries": "none"}}, "/set/boundaries"),
            ({"set": {"points": []}}, "/set"),
            ({"set": {"points": [{"vertex": 0, "offset": -1}]}}, "/set/points/0/offset"),
            ({"set": {"points": [{"vertex": 0, "label": "x" * 129}]}}, "/set/points/0/label"),
            ({"set": {"points": [{"vertex": 0}, {"vertex": 4}]}}, "/set/points/1"),
            ({"set": {"points": [{"vertex": 0}, {"vertex": 0.5}]}}, "/set/points/1/vertex"),
            ({"points": []}, "/points"),
            ({"points": [{"vertex": 1}, {"vertex": 4}]}, "/points/1"),
            ({"path": "yes"}, "/path"),
            ({"gradient": True}, "/gradient"),
        ]
        for change, pointer in wrong:
            problem = self.assert_problem(self.daemon.ask("square", "distance-to-set", CORNER | change), 400, "invalid_request")
            self.assertEqual(problem["pointer"], pointer)
        many = CORNER | {"set": {"points": [{"vertex": 0}] * 65537}}
        problem = self.assert_problem(self.daemon.ask("square", "distance-to-set", many), 413, "too_large")
        self.assertEqual((problem["pointer"], problem["limit"]), ("/set/points", 65536))
        answer = self.daemon.ask("square", "distance-to-set?select=gradient", CORNER)
        self.assertEqual(self.assert_problem(answer, 400, "invalid_request")["parameter"], "select")
        self.assert_problem(self.daemon.ask("none", "distance-to-set", CORNER), 404, "not_found")
        far = CORNER | {"set": {"points": [{"xyz": [9, 9, 9], "max_snap": 1}]}}
        problem = self.assert_problem(self.daemon.ask("square", "distance-to-set", far), 422, "point_not_on_surface")
        self.assertEqual(problem["pointer"], "/set/points/0")


if __name__ == "__main__":
    unittest.main()
