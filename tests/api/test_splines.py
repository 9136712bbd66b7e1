"""Tests geodesic Hermite splines alone, with frames, and as curves of other queries."""
import json
import math
import unittest

from harness import SQUARE, TETRAHEDRON, TWO_TRIANGLES, TestCase, sample


def place(x, y, z=0):
    return {"xyz": [x, y, z]}


class Splines(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({
            "square": SQUARE,
            "tetrahedron": TETRAHEDRON,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=20, rows=20),
            "sphere": sample("icosphere", level=4),
            "torus": sample("torus"),
            "ball": sample("icosphere", level=2),
        })

    def test_the_answer_has_the_step(self):
        points = [place(0.1, 0.5), place(0.9, 0.5)]
        straight = 0.8
        for request, count in (({"spacing": 0.3}, 3), ({"spacing": 0.6}, 1), ({"spacing": 2}, 1), ({"samples": 4, "speed": "constant"}, 4)):
            answer = self.asked("grid", "spline", {"points": points, "frames": True, **request})
            self.assertEqual(len(answer["frames"]), count + 1)
            self.assertAlmostEqual(answer["step"], straight / count, delta=1e-6)
        self.assertNotIn("step", self.asked("grid", "spline", {"points": points, "samples": 4}))

    # --- the curve -------------------------------------------------------------------------------

    def test_classical_in_the_plane(self):
        points = [place(0.3, 0.4), place(0.5, 0.6), place(0.7, 0.45)]
        answer = self.asked("grid", "spline", {"points": points, "alpha": 0, "at": [0, 0.5, 1, 1.5, 2], "frames": True})
        self.assertEqual(answer["parameters"], [0, 1, 2])
        tangents = [(0.2, 0.2875), (0.2, 0.025), (0.2, -0.2375)]
        for joint, tangent in zip(answer["joints"], tangents):
            self.assertAlmostEqual(joint["tangent"]["length"], math.hypot(*tangent), 12)
            self.assertLess(joint["angle_jump"], 1e-12)
            self.assertLess(joint["speed_jump"], 1e-12)
        for frame in answer["frames"]:
            i = min(int(frame["parameter"]), 1)
            t = frame["parameter"] - i
            p, q, u, v = points[i]["xyz"], points[i + 1]["xyz"], tangents[i], tangents[i + 1]
            basis = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, 3 * t**2 - 2 * t**3, t**3 - t**2)
            slopes = (6 * t**2 - 6 * t, 3 * t**2 - 4 * t + 1, 6 * t - 6 * t**2, 3 * t**2 - 2 * t)
            at = [sum(b * w for b, w in zip(basis, (p[k], u[k], q[k], v[k]))) for k in range(2)]
            speed = [sum(b * w for b, w in zip(slopes, (p[k], u[k], q[k], v[k]))) for k in range(2)]
            self.assert_place(frame["xyz"], at + [0])
            self.assertAlmostEqual(frame["speed"], math.hypot(*speed), 12)
            self.assert_place(frame["tangent"], [s / math.hypot(*speed) for s in speed] + [0])
            self.assert_place(frame["normal"], [0, 0, 1])
            self.assert_place(frame["binormal"], [-frame["tangent"][1], frame["tangent"][0], 0])

    def test_points_are_met_and_control_points_answered(self):
        points = [{"vertex": v} for v in (0, 40, 300, 1200)]
        for closed in (False, True):
            for rule in ("symmetric", "paper"):
                document = {"points": points, "closed": closed, "tangent_rule": rule, "samples": 5, "frames": True}
                answer = self.asked("sphere", "spline", document)
                self.assertEqual(len(answer["segments"]), 4 if closed else 3)
                for i, frame in enumerate(answer["frames"][::5]):
                    xyz = self.asked("sphere", "nearest", {"point": points[i % 4]})["xyz"]
                    self.assert_place(frame["xyz"], xyz, 15)
                    self.assertEqual(answer["segments"][min(i, len(answer["segments"]) - 1)]["control_points"][0]
                                     ["xyz"] == xyz, i < len(answer["segments"]))
                self.assertFalse(any(segment["clipped"] for segment in answer["segments"]))
                self.assertTrue(all(joint["angle_jump"] < 1e-9 for joint in answer["joints"]))

    def test_tension_one_is_the_geodesic_polyline(self):
        points = [{"vertex": v} for v in (3, 500, 900)]
        answer = self.asked("torus", "spline", {"points": points, "tension": 1, "end_rule": "zero", "samples": 3})
        distances = [self.asked("torus", "distance", {"from": a, "to": b})["distance"] for a, b in zip(points, points[1:])]
        self.assertAlmostEqual(answer["path"]["length"], sum(distances), 10)
        self.assert_place([segment["distance"] for segment in answer["segments"]], distances)

    def test_joints_without_speed_turn_like_the_polyline(self):
        points = [{"vertex": v} for v in (3, 500, 900)]
        answer = self.asked("torus", "spline", {"points": points, "tension": 1, "end_rule": "zero", "alpha": 1, "samples": 3})
        back = self.asked("torus", "log", {"from": points[1], "to": [points[0], points[2]]})["vectors"]
        apart = abs(back[0]["direction"]["angle"] - back[1]["direction"]["angle"])
        self.assertAlmostEqual(answer["joints"][1]["angle_jump"], abs(apart - math.pi), 9)
        self.assertGreater(answer["joints"][1]["angle_jump"], 0.1)
        self.assertEqual([answer["joints"][i]["angle_jump"] for i in (0, 2)], [0, 0])

    def test_equal_arc_lengths(self):
        points = [{"vertex": v} for v in (0, 40, 300)]
        fine = self.asked("sphere", "spline?geometry=none", {"points": points, "tolerance": 1e-6})["path"]["length"]
        even = self.asked("sphere", "spline", {"points": points, "samples": 20, "speed": "constant", "frames": True})
        spacing = self.asked("sphere", "spline", {"points": points, "spacing": fine / 40, "frames": True})
        for answer in (even, spacing):
            places = [frame["xyz"] for frame in answer["frames"]]
            self.assertEqual(len(places), 41)
            chords = [math.dist(a, b) for a, b in zip(places, places[1:])]
            self.assertLess(max(chords) / min(chords), 1.01)

    def test_given_tangents(self):
        document = {"points": [place(0.2, 0.5), place(0.8, 0.5)], "alpha": 0, "at": [0.5], "frames": True,
                    "tangents": [{"direction": [0, 1, 0], "length": 0.4}, {"direction": [0, -1, 0], "length": 0.4}]}
        self.assert_place(self.asked("grid", "spline", document)["frames"][0]["xyz"], [0.5, 0.6, 0])
        document["tangents"][1] = None
        self.assertGreater(self.asked("grid", "spline", document)["frames"][0]["xyz"][1], 0.5)
        document["tangents"][0]["length"] = 30
        answer = self.asked("grid", "spline", document)
        self.assertEqual([segment["clipped"] for segment in answer["segments"]], [True])

    # --- the cut locus ---------------------------------------------------------------------------

    def test_a_point_beyond_the_cut_locus(self):
        """Between the poles of a ball there are several shortest paths. The member cut_locus of the
        segment reports this. If one end is close to its pole but not at the pole, there is one
        shortest path."""
        for end, is_cut in ((place(0, 0, -1), True), (place(0.02, 0.01, -1), False)):
            answer = self.asked("ball", "spline", {"points": [place(1, 0.2, 0.3), place(0, 0, 1), end]})
            self.assertEqual([segment["cut_locus"] for segment in answer["segments"]], [False, is_cut])

    # --- as a curve ------------------------------------------------------------------------------

    def test_as_a_curve_of_every_query(self):
        spline = {"points": [place(0.2, 0.2), place(0.5, 0.3), place(0.8, 0.2)], "tolerance": 1e-4}
        distance = self.asked("grid", "curve-distance", {"a": {"spline": spline}, "b": {"points": [place(0.5, 0.9)]}})
        self.assertAlmostEqual(distance["distance"], 0.6, 9)
        members = {"curves": [{"spline": spline, "label": "bow"}]}
        answer = self.asked("grid", "distance-to-set", {"set": members, "points": [place(0.5, 0.9)]})
        self.assertAlmostEqual(answer["results"][0]["distance"], 0.6, 9)
        self.assertEqual(answer["results"][0]["nearest"]["label"], "bow")
        field = self.asked("grid", "fields", {"set": members}, 201)["id"]
        [value] = self.asked("grid", f"fields/{field}/evaluate", {"points": [place(0.5, 0.9)]})["results"]
        self.assertAlmostEqual(value["distance"], 0.6, 9)
        answer = self.daemon.get(f"/v1/meshes/grid/fields/{field}/isolines?levels=0.6&geometry=xyz")
        [level] = answer.json["isolines"]
        self.assertLess(min(math.dist(at, (0.5, 0.9, 0)) for line in level["lines"] for at in line["points"]), 0.05)
        both = {"curves": members["curves"], "points": [place(0.5, 0.9)]}
        [bisector] = self.asked("grid", "voronoi?geometry=xyz", {"set": both})["bisectors"]
        self.assertLess(min(math.dist(at, (0.5, 0.6, 0)) for at in bisector["points"]), 0.05)
        for operation, more in (("length", {}), ("resample", {"count": 9}), ("shorten", {}), ("offset", {"distance": 0.1})):
            self.asked("grid", "curve", {"curve": {"spline": spline}, "operation": operation, **more})
        lines = json.dumps({"query": "curve-distance", "a": {"spline": spline}, "b": {"points": [place(0.5, 0.9)]}})
        batch = self.daemon.request("POST", "/v1/meshes/grid/batch", lines, {"Content-Type": "application/x-ndjson"})
        self.assertAlmostEqual(json.loads(batch.body.splitlines()[0])["distance"], 0.6, 9)
        loop = {"points": [place(0.3, 0.3), place(0.7, 0.3), place(0.7, 0.7), place(0.3, 0.7)], "closed": True}
        cut = self.asked("grid", "cut", {"curve": {"spline": loop}, "select_only": True})
        self.assertTrue(cut["separates"])
        self.assertEqual(len(cut["pieces"]), 2)

    # --- what is refused -------------------------------------------------------------------------

    def test_refusals(self):
        a, b = place(0.2, 0.2), place(0.6, 0.5)
        for document, pointer in (
            ({"points": [a]}, "/points"),
            ({"points": [a, b, b]}, "/points/2"),
            ({"points": [a, b, a], "closed": True}, "/points/2"),
            ({"points": [a, b], "alpha": 2}, "/alpha"),
            ({"points": [a, b], "tension": -1}, "/tension"),
            ({"points": [a, b], "tangent_rule": "best"}, "/tangent_rule"),
            ({"points": [a, b], "samples": 0}, "/samples"),
            ({"points": [a, b], "samples": 3, "spacing": 1}, ""),
            ({"points": [a, b], "spacing": 1, "speed": "constant"}, "/speed"),
            ({"points": [a, b], "tolerance": 0}, "/tolerance"),
            ({"points": [a, b], "at": []}, "/at"),
            ({"points": [a, b], "at": [9]}, ""),
            ({"points": [a, b], "tangents": [None]}, "/tangents"),
            ({"points": [a, b], "tangents": [{"direction": 0}, None]}, "/tangents/0/length"),
            ({"points": [a, b], "other": 1}, "/other"),
        ):
            problem = self.asked("grid", "spline", document, 400)
            self.assertEqual(problem["code"], "invalid_request")
            self.assertEqual(problem["pointer"], pointer, problem)
        apart = {"points": [{"vertex": 0}, {"vertex": 3}]}
        self.assertEqual(self.asked("apart", "spline", apart, 400)["pointer"], "/points/1")
        problem = self.asked("grid", "curve-distance", {"a": {"spline": {"points": [a, a]}}, "b": {"points": [b]}}, 400)
        self.assertEqual(problem["pointer"], "/a/spline/points/1")
        problem = self.asked("grid", "cut", {"curve": {"spline": {"points": [a, b], "frames": True}}}, 400)
        self.assertEqual(problem["pointer"], "/curve/spline/frames")

    def test_two_points_closed_run_there_and_back(self):
        answer = self.asked("grid", "spline", {"points": [place(0.2, 0.5), place(0.8, 0.5)], "closed": True})
        self.assertAlmostEqual(answer["path"]["length"], 1.2, 12)


if __name__ == "__main__":
    unittest.main()
