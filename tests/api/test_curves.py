"""Tests exact distances to curves that are members of sets, and the distance between two curves."""
import json
import math
import random
import unittest

from harness import SQUARE, TWO_TRIANGLES, TestCase, sample


def xyz(*position):
    return {"xyz": list(position)}


def line(*positions, **more):
    return {"points": [xyz(*position) for position in positions], **more}


def to_segment(p, a, b):
    span, way = [v - u for u, v in zip(a, b)], [v - u for u, v in zip(a, p)]
    part = sum(s * w for s, w in zip(span, way)) / sum(s * s for s in span)
    part = min(max(part, 0), 1)
    return math.dist(p, [u + part * s for u, s in zip(a, span)])


class Curves(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.put_all({
            "square": SQUARE,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=12, rows=12),
            "box": sample("box", cells=3),
            "cylinder": sample("cylinder", radius=1, height=3),
            "terrain": sample("terrain", cells=20, amplitude=1),
        })

    def results(self, mesh, members, points, **more):
        answer = self.daemon.ask(mesh, "distance-to-set", {"set": members, "points": points, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json["results"]

    def between(self, mesh, a, b, options="", **more):
        answer = self.daemon.ask(mesh, f"curve-distance{options}", {"a": a, "b": b, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json

    def test_distance_to_a_line_in_the_plane(self):
        chance = random.Random(1)
        a, b = (0.13, 0.21, 0), (0.81, 0.47, 0)
        points = [(chance.random(), chance.random(), 0) for _ in range(100)]
        results = self.results("grid", {"curves": [line(a, b, label="road")]}, [xyz(*p) for p in points], path=True)
        for p, result in zip(points, results):
            self.assertAlmostEqual(result["distance"], to_segment(p, a, b), 13)
            self.assertEqual((result["nearest"]["index"], result["nearest"]["label"]), (0, "road"))
            foot = result["nearest"]["point"]["xyz"]
            self.assertLess(to_segment(foot, a, b), 1e-12)
            self.assertAlmostEqual(math.dist(p, foot), result["distance"], 12)
            self.assertEqual(result["path"]["points"][-1]["xyz"], foot)
            self.assertAlmostEqual(result["path"]["length"], result["distance"], 12)

    def test_points_curves_and_boundaries_mixed(self):
        chance = random.Random(2)
        members = {
            "boundaries": "all",
            "points": [{**xyz(0.5, 0.5, 0), "label": "middle"}],
            "curves": [line((0.2, 0.3, 0), (0.4, 0.7, 0), offset=0.05), {"boundary": 0, "offset": 3}],
        }
        points = [(chance.random(), chance.random(), 0) for _ in range(100)]
        seen = set()
        for p, result in zip(points, self.results("grid", members, [xyz(*p) for p in points])):
            ways = [math.dist(p, (0.5, 0.5, 0)), to_segment(p, (0.2, 0.3, 0), (0.4, 0.7, 0)) + 0.05, 9,
                    min(p[0], 1 - p[0], p[1], 1 - p[1])]
            self.assertAlmostEqual(result["distance"], min(ways), 12)
            self.assertEqual(result["nearest"]["index"], ways.index(min(ways)))
            seen.add(result["nearest"]["index"])
        self.assertEqual(seen, {0, 1, 3})

    def test_parallels_of_a_cylinder(self):
        points = [xyz(math.cos(i), math.sin(i), 0.3 * i) for i in range(10)]
        for point, result in zip(points, self.results("cylinder", {"boundaries": [0]}, points)):
            self.assertAlmostEqual(result["distance"], point["xyz"][2], 12)
        labelled = {"boundaries": [{"boundary": 1, "label": "rim", "offset": 1}]}
        self.assertEqual(self.results("cylinder", labelled, points[:1])[0]["nearest"]["label"], "rim")

    def test_samples_come_from_above(self):
        chance = random.Random(3)
        curve = {"points": [{"face": 7, "barycentric": [0.2, 0.3, 0.5]}, {"face": 700, "barycentric": [0.4, 0.3, 0.3]}]}
        path = self.daemon.ask("terrain", "path", {"from": curve["points"][0], "to": curve["points"][1]}).json["path"]
        at = [{"face": chance.randrange(800), "barycentric": [0.25, 0.25, 0.5]} for _ in range(40)]
        exact = [result["distance"] for result in self.results("terrain", {"curves": [curve]}, at)]
        before = math.inf
        for parts in (1, 4, 16):
            samples = []
            for p, q in zip(path["points"], path["points"][1:]):
                samples += [xyz(*[u + (v - u) * i / parts for u, v in zip(p["xyz"], q["xyz"])]) for i in range(parts)]
            samples.append(xyz(*path["points"][-1]["xyz"]))
            sampled = [result["distance"] for result in self.results("terrain", {"points": samples}, at)]
            excess = [s - e for s, e in zip(sampled, exact)]
            self.assertGreater(min(excess), -1e-12)
            self.assertLess(max(excess), before)
            before = max(excess)
        self.assertLess(before, 1e-4)

    def test_fields_of_curves(self):
        fields = self.daemon.ask("grid", "fields", {"set": {"curves": [line((0.2, 0.5, 0), (0.8, 0.5, 0))]}})
        self.assertEqual(fields.status, 201, fields)
        again = self.daemon.ask("grid", "fields", {"set": {"curves": [line((0.2, 0.5, 0), (0.8, 0.5, 0))]}})
        self.assertEqual((again.status, again.json["id"]), (200, fields.json["id"]))
        answer = self.daemon.ask("grid", f"fields/{fields.json['id']}/evaluate", {"points": [xyz(0.5, 0.8, 0), xyz(0.5, 0.5, 0)], "gradient": True})
        first, on_it = answer.json["results"]
        self.assertAlmostEqual(first["distance"], 0.3, 13)
        for u, v in zip(first["gradient"]["xyz"], (0, 1, 0)):
            self.assertAlmostEqual(u, v, 12)
        self.assertAlmostEqual(on_it["distance"], 0, 14)
        self.assertIsNone(on_it["gradient"])

    def test_isolines_and_voronoi_of_curves(self):
        fields = self.daemon.ask("grid", "fields", {"set": {"curves": [line((0.3, 0.5, 0), (0.7, 0.5, 0))]}})
        answer = self.daemon.get(f"/v1/meshes/grid/fields/{fields.json['id']}/isolines?levels=0.2&arcs=true")
        (lines,) = answer.json["isolines"]
        self.assertAlmostEqual(sum(line["length"] for line in lines["lines"]), 0.8 + 0.4 * math.pi, 9)
        arcs = [arc for line in lines["lines"] for arc in line["arcs"]]
        self.assertTrue(any(arc.get("straight") for arc in arcs) and any("radius" in arc for arc in arcs))
        members = {"points": [xyz(0.5, 0.75, 0)], "curves": [line((0, 0.25, 0), (1, 0.25, 0))]}
        answer = self.daemon.ask("grid", "voronoi", {"set": members, "tolerance": 1e-6})
        self.assertEqual(answer.status, 200, answer)
        (bisector,) = answer.json["bisectors"]
        self.assertEqual(bisector["members"], [0, 1])
        # the bisector is a parabola
        self.assertAlmostEqual(bisector["length"], 0.5 * (math.sqrt(2) + math.asinh(1)), 5)
        self.assertEqual(set(answer.json["labels"]), {0, 1})

    def test_curve_to_curve(self):
        found = self.between("grid", line((0.1, 0.2, 0), (0.9, 0.2, 0)), line((0.3, 0.5, 0), (0.3, 0.9, 0)))
        self.assertAlmostEqual(found["distance"], 0.3, 13)
        a, b = found["closest"]["a"], found["closest"]["b"]
        self.assertLess(math.dist(a["point"]["xyz"], (0.3, 0.2, 0)) + math.dist(b["point"]["xyz"], (0.3, 0.5, 0)), 1e-12)
        self.assertAlmostEqual(a["parameter"], 0.25, 12)
        self.assertEqual(b["parameter"], 0)
        self.assertAlmostEqual(a["angle"], math.pi / 2, 9)
        self.assertAlmostEqual(found["path"]["length"], 0.3, 13)
        ends = found["path"]["points"][0]["xyz"], found["path"]["points"][-1]["xyz"]
        self.assertEqual(list(ends), [a["point"]["xyz"], b["point"]["xyz"]])

    def test_curves_that_meet(self):
        found = self.between("grid", line((0.1, 0.4, 0), (0.9, 0.4, 0)), line((0.5, 0.1, 0), (0.5, 0.9, 0)))
        self.assertEqual(found["distance"], 0)
        for place in found["closest"].values():
            self.assertLess(math.dist(place["point"]["xyz"], (0.5, 0.4, 0)), 1e-12)
            self.assertIsNone(place["angle"])
        self.assertEqual(found["path"]["length"], 0)

    def test_symmetry(self):
        chance = random.Random(4)
        for mesh in ("box", "terrain", "cylinder"):
            for _ in range(6):
                a, b = ({"points": [{"face": chance.randrange(50), "barycentric": [0.2, 0.5, 0.3]} for _ in range(3)],
                         "closed": chance.random() < 0.5} for _ in range(2))
                there, back = self.between(mesh, a, b), self.between(mesh, b, a)
                self.assertLessEqual(abs(there["distance"] - back["distance"]), 1e-12 * (1 + there["distance"]))
                one, other = (self.between(mesh, *pair, measure="hausdorff") for pair in ((a, b), (b, a)))
                self.assertLessEqual(abs(one["a_to_b"] - other["b_to_a"]), 1e-12 * (1 + one["a_to_b"]))
                self.assertEqual(one["distance"], max(one["a_to_b"], one["b_to_a"]))
                self.assertGreaterEqual(one["distance"], there["distance"] - 1e-12)

    def test_hausdorff(self):
        a, b = line((0.1, 0.2, 0), (0.9, 0.2, 0)), line((0.3, 0.3, 0), (0.3, 0.9, 0))
        found = self.between("grid", a, b, measure="hausdorff")
        self.assertAlmostEqual(found["b_to_a"], 0.7, 13)
        self.assertAlmostEqual(found["a_to_b"], math.hypot(0.6, 0.1), 13)
        self.assertEqual(found["distance"], found["b_to_a"])
        farthest = found["farthest"]["a_to_b"]
        self.assertLess(math.dist(farthest["a"]["point"]["xyz"], (0.9, 0.2, 0)), 1e-12)
        self.assertLess(math.dist(farthest["b"]["point"]["xyz"], (0.3, 0.3, 0)), 1e-12)
        self.assertNotIn("closest", found)

    def test_hausdorff_builds_missing_fields_together(self):
        def counted(a, b):
            names = "cache_builds_total", "cache_hits_total"
            before = [self.daemon.metric(name) for name in names]
            found = self.between("terrain", a, b, measure="hausdorff")
            return found, [self.daemon.metric(name) - value for name, value in zip(names, before)]

        a, b, c = ({"vertices": vertices} for vertices in ([0, 1], [200, 201], [300, 301]))
        found, builds_and_hits = counted(a, b)
        self.assertEqual(builds_and_hits, [2, 1])  # the query finds the second field in the cache
        self.assertEqual(counted(a, b), (found, [0, 2]))
        self.assertEqual(counted(a, c)[1], [1, 1])
        found, builds_and_hits = counted(*[{"vertices": [400, 401]}] * 2)
        self.assertEqual((found["distance"], builds_and_hits), (0, [1, 1]))

    def test_no_path(self):
        found = self.between("apart", {"vertices": [0, 1]}, {"vertices": [3, 4]})
        self.assertEqual(found, {"distance": None, "reason": "no_path", "closest": None, "path": None})
        self.assertIsNone(self.between("apart", {"vertices": [0, 1]}, {"vertices": [3, 4]}, measure="hausdorff")["distance"])
        results = self.results("apart", {"curves": [{"vertices": [0, 1]}]}, [{"vertex": 2}, {"vertex": 4}])
        self.assertEqual(results[1]["reason"], "no_path")

    def test_in_a_batch(self):
        document = {"a": {"vertices": [0, 1]}, "b": {"points": [{"vertex": 2}]}}
        alone = self.between("square", document["a"], document["b"])
        body = json.dumps({"query": "curve-distance", **document})
        answer = self.daemon.request("POST", "/v1/meshes/square/batch", body, {"Content-Type": "application/x-ndjson"})
        self.assertEqual(json.loads(answer.body), {"status": 200, **alone})

    def test_refusals(self):
        wrong = [
            ({"a": {"vertices": [0, 1]}}, 400, "/b"),
            ({"a": {"spline": {}}, "b": {"vertices": [0]}}, 400, "/a/spline/points"),
            ({"a": {"vertices": [0, 99]}, "b": {"vertices": [0]}}, 400, "/a"),
            ({"a": {"vertices": [0]}, "b": {"boundary": 5}}, 400, "/b"),
            ({"a": {"vertices": [0]}, "b": {"vertices": [0]}, "measure": "max"}, 400, "/measure"),
        ]
        for document, status, pointer in wrong:
            answer = self.daemon.ask("square", "curve-distance", document)
            self.assertEqual((answer.status, answer.json.get("pointer")), (status, pointer), answer.json)
        for members, pointer in (({"boundaries": "all"}, "/set/boundaries"), ({"curves": [{"vertices": [0, 7]}]}, "/set/curves/0")):
            answer = self.daemon.ask("box", "distance-to-set", {"set": members, "points": [{"vertex": 0}]})
            self.assertEqual((answer.status, answer.json.get("pointer")), (400, pointer), answer.json)


class Memory(TestCase):
    """There is memory for one field of a Hausdorff distance, but not for two."""
    flags = ("--memory-budget", "14MiB", "--max-body", "4MiB", "--workers", "2", "--landmarks", "0")

    def test_hausdorff_needs_memory_for_one_field(self):
        cells = 60
        self.assertEqual(self.daemon.put("terrain", sample("terrain", cells=cells, amplitude=1)).status, 201)
        for number in range(12):
            a, b = ({"vertices": [start, start + 1]} for start in (number * (cells + 1), (cells - number) * (cells + 1) + number))
            found = [self.daemon.ask("terrain", "curve-distance", {"a": of, "b": to, "measure": "hausdorff"}) for of, to in ((a, b), (b, a))]
            self.assertEqual([answer.status for answer in found], [200, 200], found)
            self.assertEqual(found[0].json["distance"], found[1].json["distance"])
        self.assertGreater(self.daemon.metric("cache_evictions_total"), 0)


if __name__ == "__main__":
    unittest.main()
