"""Tests Voronoi diagrams and farthest points: closed forms, rules for labels and lines, limits, and
cancelling."""
import json
import math
import random
import time
import unittest

from harness import SQUARE, TETRAHEDRON, TWO_TRIANGLES, TestCase, sample


def random_point(chance, faces):
    weights = [chance.expovariate(1) for _ in range(3)]
    return {"face": chance.randrange(faces), "barycentric": [weight / sum(weights) for weight in weights]}


def as_request(point):
    """Returns a point of a path in the form of a request."""
    if "vertex" in point:
        return {"vertex": point["vertex"]}
    if "edge" in point:
        return {"edge": point["edge"], "t": point["t"]}
    return {"face": point["face"], "barycentric": point["barycentric"]}


class Voronoi(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        meshes = {
            "square": SQUARE,
            "tetrahedron": TETRAHEDRON,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=12, rows=12),
            "box": sample("box", cells=2),
            "terrain": sample("terrain", cells=24, amplitude=1),
            "torus": sample("torus"),
        }
        cls.meshes = cls.put_all(meshes)

    def ask(self, mesh, query, document, status=200):
        answer = self.daemon.ask(mesh, query, document)
        self.assertEqual(answer.status, status, answer)
        return answer.json

    def voronoi(self, mesh, members, options="", **more):
        return self.ask(mesh, f"voronoi{options}", {"set": {"points": members}, **more})

    def distances(self, mesh, members, points):
        document = {"set": {"points": members}, "points": points}
        return [result["distance"] for result in self.ask(mesh, "distance-to-set?select=distance", document)["results"]]

    # --- diagrams --------------------------------------------------------------------------------

    def test_perpendicular_bisector(self):
        answer = self.voronoi("grid", [{"xyz": [0.2, 0.5, 0]}, {"xyz": [0.8, 0.5, 0]}], "?geometry=xyz")
        self.assertEqual(set(answer["labels"]), {0, 1})
        [bisector] = answer["bisectors"]
        self.assertEqual((bisector["members"], bisector["closed"]), ([0, 1], False))
        self.assertAlmostEqual(bisector["length"], 1, 9)
        self.assertLess(max(abs(x - 0.5) for x, _, _ in bisector["points"]), 1e-9)

    def test_offsets_make_a_hyperbola(self):
        members = [{"xyz": [0.25, 0.5, 0]}, {"xyz": [0.75, 0.5, 0], "offset": 0.2}]
        coarse, fine = [self.voronoi("grid", members, "?geometry=xyz", tolerance=t)["bisectors"] for t in (1, 1e-7)]
        for bisector in coarse + fine:
            for x, y, _ in bisector["points"]:
                self.assertAlmostEqual(math.dist((x, y), (0.25, 0.5)), math.dist((x, y), (0.75, 0.5)) + 0.2, 9)
        self.assertGreater(len(fine[0]["points"]), 3 * len(coarse[0]["points"]))
        alone = self.voronoi("grid", [members[0], members[1] | {"offset": 0.6}])
        self.assertEqual((set(alone["labels"]), alone["bisectors"]), ({0}, []))

    def test_a_box_between_opposite_faces(self):
        answer = self.voronoi("box", [{"xyz": [0.5, 0.5, 0]}, {"xyz": [0.5, 0.5, 1]}], "?geometry=xyz")
        [bisector] = answer["bisectors"]
        self.assertTrue(bisector["closed"])
        self.assertAlmostEqual(bisector["length"], 4, 9)
        self.assertEqual(bisector["points"][0], bisector["points"][-1])

    def test_points_of_bisectors_are_equidistant(self):
        chance = random.Random(5)
        for mesh in ("terrain", "torus", "box"):
            members = [random_point(chance, self.meshes[mesh]["faces"]) | {"offset": chance.random() * 0.1} for _ in range(6)]
            answer = self.voronoi(mesh, members, "?geometry=full")
            self.assertGreater(len(answer["bisectors"]), 4)
            for bisector in answer["bisectors"]:
                points = [as_request(point) for point in bisector["points"]]
                least = self.distances(mesh, members, points)
                for member in bisector["members"]:
                    for distance, own in zip(least, self.distances(mesh, [members[member]], points)):
                        self.assertLess(abs(own - distance), 1e-9 * max(1, distance))

    def test_labels_name_the_nearest_member(self):
        chance = random.Random(6)
        for mesh in ("terrain", "torus"):
            count = self.meshes[mesh]["index_count"]
            members = [random_point(chance, self.meshes[mesh]["faces"]) for _ in range(5)]
            labels = self.voronoi(mesh, members, "?select=labels")
            self.assertEqual(list(labels), ["labels"])
            self.assertEqual(len(labels["labels"]), count)
            vertices = list(range(0, count, max(1, count // 200)))
            ways = [self.distances(mesh, [member], [{"vertex": v} for v in vertices]) for member in members]
            for i, vertex in enumerate(vertices):
                own, least = ways[labels["labels"][vertex]][i], min(way[i] for way in ways)
                self.assertLess(own - least, 1e-12 * (1 + least))

    def test_unreachable_vertices_have_no_label(self):
        answer = self.voronoi("apart", [{"vertex": 0}, {"vertex": 1}])
        self.assertEqual(answer["labels"][3:], [None] * 3)
        self.assertEqual(len(answer["bisectors"]), 1)
        both = self.voronoi("apart", [{"vertex": 0}, {"vertex": 4}])
        self.assertEqual((both["labels"], both["bisectors"]), ([0, 0, 0, 1, 1, 1], []))

    def test_members_that_coincide(self):
        answer = self.voronoi("square", [{"vertex": 0, "offset": 0.1}, {"vertex": 0}, {"vertex": 0}, {"vertex": 2}])
        self.assertEqual({label for label in answer["labels"]}, {1, 3})
        self.assertEqual([bisector["members"] for bisector in answer["bisectors"]], [[1, 3]])

    def test_fields_and_geometry(self):
        members = [{"vertex": 0}, {"vertex": 2}]
        self.assertEqual(list(self.voronoi("square", members, "?select=bisectors")), ["bisectors"])
        [bisector] = self.voronoi("square", members, "?geometry=none")["bisectors"]
        self.assertEqual(list(bisector), ["members", "closed", "length"])

    def test_the_field_is_shared_with_distances(self):
        members = [{"vertex": 1}, {"vertex": 3}, {"vertex": 8}]
        self.distances("torus", members, [{"vertex": 0}])
        builds = self.daemon.metric("cache_builds_total")
        self.voronoi("torus", members)
        self.assertEqual(self.daemon.metric("cache_builds_total"), builds)

    def test_refusals(self):
        members = {"points": [{"vertex": 0}]}
        for document, pointer in [
            ({}, "/set"),
            ({"set": members, "tolerance": 0}, "/tolerance"),
            ({"set": members, "tolerance": "fine"}, "/tolerance"),
            ({"set": members, "levels": [1]}, "/levels"),
            ({"set": {"points": [{"vertex": 99}]}}, "/set/points/0"),
        ]:
            problem = self.ask("square", "voronoi", document, 400)
            self.assertEqual((problem["code"], problem["pointer"]), ("invalid_request", pointer), document)
        self.assertEqual(self.daemon.ask("nothing", "voronoi", {"set": members}).status, 404)

    def test_too_many_points(self):
        members = [{"xyz": [0.25, 0.5, 0]}, {"xyz": [0.75, 0.5, 0], "offset": 0.2}]
        chance = random.Random(7)
        members += [random_point(chance, self.meshes["grid"]["faces"]) | {"offset": 0.1 * chance.random()} for _ in range(60)]
        problem = self.ask("grid", "voronoi", {"set": {"points": members}, "tolerance": 1e-15}, 413)
        self.assertEqual((problem["code"], problem["limit"]), ("too_large", 500000))

    # --- farthest points -------------------------------------------------------------------------

    def farthest(self, mesh, options="", **document):
        return self.ask(mesh, f"farthest-points{options}", document)

    def test_farthest_points_of_a_square(self):
        answer = self.farthest("square", count=5, start={"vertex": 0})
        self.assertEqual([point.get("vertex") for point in answer["points"][:2]], [0, 2])
        self.assertEqual({point.get("vertex") for point in answer["points"][2:4]}, {1, 3})
        for coordinate, expected in zip(answer["points"][4]["xyz"], (0.5, 0.5, 0)):
            self.assertAlmostEqual(coordinate, expected, 12)
        for radius, expected in zip(answer["radii"], (math.sqrt(2), 1, 1, math.sqrt(0.5), 0.5)):
            self.assertAlmostEqual(radius, expected, 12)

    def test_radii_are_distances_to_the_points_before(self):
        for mesh in ("torus", "terrain", "box"):
            answer = self.farthest(mesh, count=8)
            points, radii = [as_request(point) for point in answer["points"]], answer["radii"]
            self.assertEqual((len(points), len(radii), answer["points"][0]["vertex"]), (8, 8, 0))
            self.assertEqual(radii, sorted(radii, reverse=True))
            for i in range(1, 8):
                [distance] = self.distances(mesh, points[:i], [points[i]])
                self.assertAlmostEqual(distance, radii[i - 1], 9)
            vertices = [{"vertex": v} for v in range(self.meshes[mesh]["index_count"])]
            self.assertLess(max(self.distances(mesh, points, vertices)), radii[-1] * (1 + 1e-9))
            self.assertEqual(self.farthest(mesh, count=8), answer)

    def test_components_come_first(self):
        answer = self.farthest("apart", count=3, start={"vertex": 1})
        self.assertEqual([point.get("vertex") for point in answer["points"][:2]], [1, 3])
        self.assertEqual(answer["radii"][0], None)
        self.assertAlmostEqual(answer["radii"][1], math.sqrt(2), 12)

    def test_start_and_geometry(self):
        answer = self.farthest("square", count=1, start={"xyz": [0.25, 0.5, 1]})
        self.assertEqual(answer["points"][0]["snap_distance"], 1)
        self.assertEqual(self.farthest("square", "?geometry=xyz", count=1)["points"], [[0, 0, 0]])
        self.assertEqual(list(self.farthest("square", "?select=radii", count=1)), ["radii"])

    def test_farthest_refusals(self):
        for document, pointer in [({}, "/count"), ({"count": 0}, "/count"), ({"count": 1.5}, "/count"), ({"count": 2, "start": 3}, "/start"),
                                  ({"count": 2, "start": {"vertex": 4}}, "/start")]:
            problem = self.ask("square", "farthest-points", document, 400)
            self.assertEqual((problem["code"], problem["pointer"]), ("invalid_request", pointer), document)
        problem = self.ask("square", "farthest-points", {"count": 10001}, 413)
        self.assertEqual((problem["code"], problem["pointer"], problem["limit"]), ("too_large", "/count", 10000))

    def test_a_deadline_and_a_cancel_end_it(self):
        started = time.monotonic()
        self.ask("torus", "farthest-points?timeout_ms=50", {"count": 10000}, 504)
        self.assertLess(time.monotonic() - started, 5)
        document = json.dumps({"count": 10000})
        headers = {"Content-Type": "application/json", "Prefer": "respond-async"}
        answer = self.daemon.request("POST", "/v1/meshes/torus/farthest-points", document, headers)
        self.assertEqual(answer.status, 202, answer)
        job = answer.headers["Location"]
        progress = 0
        while progress == 0:
            progress = self.daemon.request("GET", job).json["progress"]
            self.assertLess(time.monotonic() - started, 60)
        self.assertLess(progress, 1)
        self.daemon.request("DELETE", job)
        while self.daemon.request("GET", job).json["state"] == "running":
            self.assertLess(time.monotonic() - started, 60)
        self.assertEqual(self.daemon.request("GET", job).json["state"], "cancelled")


if __name__ == "__main__":
    unittest.main()
