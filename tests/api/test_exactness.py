"""Tests exactness. Repeats recorded cases with points close to vertices and in very small faces.
Also queries one pair by every operation of the API."""
import json
import math
import os
import pathlib
import random
import unittest

from harness import SEARCHES, Daemon, TestCase, sample

SHARED = pathlib.Path(os.environ.get("GEODESICD_SHARED", "../shared")) / "exactness"

PROMISE = 1e-9  # largest permitted relative error of a distance
# largest permitted relative difference between two operations that return the distance of the same
# pair
ONE_LANE = 1e-12


def cases(kind):
    if not SHARED.exists():
        raise unittest.SkipTest(f"there is no folder {SHARED}")
    return [case for case in json.loads((SHARED / "cases.json").read_text()) if kind(case)]


def relative(a, b):
    return 0 if a == b else abs(a - b) / max(abs(a), abs(b))


def positions(mesh):
    lines = (SHARED / mesh).read_text().splitlines()
    return [[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")]


class Asking(TestCase):
    """Queries the distance of one pair by each operation that returns it."""

    def pair(self, mesh, start, end, query="distance"):
        answer = self.asked(mesh, query, {"from": start, "to": end})
        return answer["distance"], answer["path"]["length"] if query == "path" else answer["distance"]

    def to_set(self, mesh, members, end, path=False):
        [result] = self.asked(mesh, "distance-to-set", {"set": {"points": members}, "points": [end], "path": path})["results"]
        return result["distance"]

    def matrix(self, mesh, start, end):
        return self.asked(mesh, "matrix", {"sources": [start], "targets": [end]})["distances"][0][0]

    def batch(self, mesh, start, end):
        line = json.dumps({"query": "distance", "from": start, "to": end})
        answer = self.daemon.request("POST", f"/v1/meshes/{mesh}/batch", line + "\n", {"Content-Type": "application/x-ndjson"})
        self.assertEqual(answer.status, 200, answer)
        [result] = [json.loads(text) for text in answer.body.splitlines()]
        self.assertEqual(result["status"], 200, result)
        return result["distance"]

    def field(self, mesh, start, end):
        answer = self.daemon.ask(mesh, "fields", {"set": {"points": [start]}})
        self.assertIn(answer.status, (200, 201), answer)
        [result] = self.asked(mesh, f"fields/{answer.json['id']}/evaluate", {"points": [end]})["results"]
        return result["distance"]

    def all_lanes(self, mesh, start, end):
        """Queries a pair by all operations. The first queries use searches. Later queries use a
        field, which the daemon builds at the sixteenth query of a source, or for the operation
        `field`."""
        yield from (self.pair(mesh, start, end)[0] for _ in range(SEARCHES + 4))
        yield self.matrix(mesh, start, end)
        yield self.matrix(mesh, end, start)
        for a, b in ((start, end), (end, start)):
            yield from self.pair(mesh, a, b, "path")
            yield self.batch(mesh, a, b)
            yield self.to_set(mesh, [a], b)
            yield self.field(mesh, a, b)
            yield from self.pair(mesh, a, b, "path")

    def check_lanes(self, mesh, start, end):
        distances = list(self.all_lanes(mesh, start, end))
        worst = max(relative(distance, distances[0]) for distance in distances)
        self.assertLessEqual(worst, ONE_LANE, (start, end, distances))
        return distances[0]


class Recorded(Asking):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for file in SHARED.glob("*.obj") if SHARED.exists() else ():
            answer = cls.daemon.put(file.stem, file.read_bytes())
            assert answer.status == 201, answer

    def each(self, kind, check):
        for case in cases(kind):
            with self.subTest(case["mesh"]):
                check(pathlib.Path(case["mesh"]).stem, case)

    def check_distance(self, mesh, case):
        for _ in range(case.get("repeat", 1)):
            distance = self.pair(mesh, case["from"], case["to"])[0]
            self.assertLessEqual(relative(distance, case["distance"]), PROMISE, distance)
        self.check_lanes(mesh, case["from"], case["to"])

    def check_path(self, mesh, case):
        for start, end in ((case["from"], case["to"]), (case["to"], case["from"])):
            for found in self.pair(mesh, start, end, "path"):
                self.assertLessEqual(relative(found, case["distance"]), PROMISE)

    def check_set(self, mesh, case):
        distance = self.to_set(mesh, case["set"], case["to"], path=True)
        self.assertLessEqual(relative(distance, case["distance"]), PROMISE)

    def check_rounded_vertex(self, mesh, case):
        vertex = positions(case["mesh"])[case["beside_vertex"]]
        beside = self.to_set(mesh, [case["from"]], case["to"], path=True)
        distance = self.to_set(mesh, [{"vertex": case["beside_vertex"]}], case["to"], path=True)
        apart = math.dist(vertex, case["from"]["xyz"])
        self.assertLessEqual(abs(beside - distance), apart + ONE_LANE * distance)

    def check_log(self, mesh, case):
        vectors = self.asked(mesh, "log", {"from": case["from"], "to": [case["to"]]})["vectors"]
        end = self.asked(mesh, "exp", {"start": case["from"], "vectors": vectors})["points"][0]
        goal = positions(case["mesh"])[case["to"]["vertex"]]
        self.assertLessEqual(math.dist(end["xyz"], goal), PROMISE * vectors[0]["length"])
        self.asked(mesh, "transport", {"from": case["from"], "to": case["to"], "vectors": vectors})

    def test_distances(self):
        self.each(lambda case: case["ask"] == "distance", self.check_distance)

    def test_paths(self):
        self.each(lambda case: case["ask"] == "path", self.check_path)

    def test_sets(self):
        self.each(lambda case: "set" in case, self.check_set)

    def test_rounded_vertices(self):
        """Tests the triangle inequality for a source close to a vertex. The distance from the
        source is at most the sum of two distances: from the vertex, and between source and
        vertex."""
        self.each(lambda case: "beside_vertex" in case, self.check_rounded_vertex)

    def test_logs(self):
        """`exp` and `transport` accept the vectors that `log` returns, including their member
        cut_locus."""
        self.each(lambda case: case["ask"] == "log", self.check_log)


class Lanes(Asking):
    """Tests points in general position, without landmarks and with landmarks."""

    flags = ("--landmarks", "4")
    PAIRS = 3
    MESHES = {"terrain": sample("terrain", cells=12, amplitude=0.7), "torus": sample("torus", columns=16, rows=10),
              "graded": sample("graded", bend=1)}

    def random_point(self, numbers, faces):
        a, b = sorted((numbers.random(), numbers.random()))
        return {"face": numbers.randrange(faces), "barycentric": [a, b - a, 1 - b]}

    def test_all_operations_give_one_distance(self):
        numbers = random.Random(1)
        with Daemon("--landmarks", "0") as plain:
            for name, description in self.put_all(self.MESHES).items():
                self.assertEqual(plain.put(name, self.MESHES[name]).status, 201)
                for _ in range(self.PAIRS):
                    ends = [self.random_point(numbers, description["faces"]) for _ in range(2)]
                    distance = self.check_lanes(name, *ends)
                    answer = plain.ask(name, "distance", {"from": ends[0], "to": ends[1]})
                    self.assertEqual(answer.status, 200, answer)
                    self.assertLessEqual(relative(answer.json["distance"], distance), ONE_LANE)


if __name__ == "__main__":
    unittest.main()
