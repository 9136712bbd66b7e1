"""Tests straightest geodesics (`trace` and `exp`): closed forms, rules, forms of directions,
refused requests, and limits."""
import json
import math
import unittest

from harness import SQUARE, TETRAHEDRON, TestCase, sample


class Tracing(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.put_all({
            "square": SQUARE,
            "tetrahedron": TETRAHEDRON,
            "grid": sample("grid", columns=12, rows=12),
            "box": sample("box", cells=3),
            "torus": sample("torus"),
        })

    def trace(self, mesh, options="", **document):
        return self.asked(mesh, f"trace{options}", document)["paths"]


class Trace(Tracing):
    def test_straight_in_the_plane(self):
        start = {"xyz": [0.31, 0.47, 0]}
        for angle in (0.1, 2, 4):
            vector = [math.cos(angle), math.sin(angle), 0]
            [path] = self.trace("grid", start=start, directions=[vector], length=0.3)
            self.assertEqual(path["end_reason"], "length")
            self.assertAlmostEqual(path["length"], 0.3, 14)
            self.assert_place(path["points"][-1]["xyz"], [0.31 + 0.3 * vector[0], 0.47 + 0.3 * vector[1], 0])
            self.assert_place(path["end_direction"]["xyz"], vector)
            self.assertIn("face", path["points"][0])
            self.assertIn("edge", path["points"][1])
            # continues from the end of the path; a request accepts the members of the answer
            end = {name: path["points"][-1][name] for name in ("face", "barycentric")}
            [more] = self.trace("grid", start=end, directions=[path["end_direction"]], length=0.05)
            self.assert_place(more["points"][-1]["xyz"], [0.31 + 0.35 * vector[0], 0.47 + 0.35 * vector[1], 0])

    def test_forms_of_directions(self):
        start = {"face": 0, "barycentric": [0.5, 0.25, 0.25]}
        paths = self.trace("square", start=start, directions=[0.5, {"angle": 0.5}, [math.cos(0.5), math.sin(0.5), 7],
                                                              {"xyz": [math.cos(0.5), math.sin(0.5), 0]},
                                                              {"angle": 0.5, "xyz": [0, 0, 1]}], length=0.2)
        self.assertEqual(len(paths), 5)
        for path in paths:
            self.assert_place(path["points"][-1]["xyz"], paths[0]["points"][-1]["xyz"])
            self.assertAlmostEqual(path["end_direction"]["angle"], 0.5, 12)

    def test_a_fan(self):
        paths = self.trace("grid", "?geometry=xyz", start={"xyz": [0.5, 0.5, 0]}, fan=12, length=0.25)
        self.assertEqual(len(paths), 12)
        for path in paths:
            x, y, _ = path["points"][-1]
            self.assertAlmostEqual(math.hypot(x - 0.5, y - 0.5), 0.25, 12)
        paths = self.trace("square", "?geometry=none", start={"vertex": 0}, fan=5, length=0.25)
        self.assertEqual([set(path) for path in paths], [{"length", "end_direction", "end_reason"}] * 5)
        angles = [math.atan2(*reversed(path["end_direction"]["xyz"][:2])) for path in paths]
        self.assert_place(angles, [math.pi / 8 * i for i in range(5)])

    def test_boundary_rules(self):
        question = {"start": {"xyz": [0.5, 0.5, 0]}, "directions": [[2, 1, 0]], "length": math.sqrt(1.25) / 2 + 0.1}
        [stopped] = self.trace("grid", **question)
        self.assertEqual(stopped["end_reason"], "boundary")
        self.assert_place(stopped["points"][-1]["xyz"], [1, 0.75, 0])
        self.assert_place(stopped["end_direction"]["xyz"], [2 / math.sqrt(5), 1 / math.sqrt(5), 0])
        [slid] = self.trace("grid", **question, boundary_rule="slide")
        self.assertEqual(slid["end_reason"], "length")
        self.assert_place(slid["points"][-1]["xyz"], [1, 0.85, 0])

    def test_around_a_box_and_back_to_itself(self):
        description = self.daemon.get("/v1/meshes/box").json
        low, high = description["bounding_box"]["min"], description["bounding_box"]["max"]
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        size = [b - a for a, b in zip(low, high)]
        start = {"xyz": [middle[0] + 0.01, middle[1] + 0.02, high[2]]}
        [path] = self.trace("box", start=start, directions=[[1, 0, 0]], length=100, stop_at_self_intersection=True)
        self.assertEqual(path["end_reason"], "self_intersection")
        self.assertAlmostEqual(path["length"], 2 * (size[0] + size[2]), 11)
        self.assert_place(path["points"][-1]["xyz"], path["points"][0]["xyz"])
        for rule in ("bisect", "limit_normal"):
            [path] = self.trace("box", start=start, directions=[[1, 0, 0]], length=7, vertex_rule=rule)
            self.assertAlmostEqual(path["length"], 7, 12)

    def test_limits(self):
        question = {"start": {"vertex": 0}, "directions": [1], "length": 1e9}
        [path] = self.trace("torus", "?geometry=none", **question, step_limit=1000)
        self.assertEqual(path["end_reason"], "step_limit")
        self.asked("torus", "trace?timeout_ms=1", {**question, "directions": [1] * 10000}, 504)
        problem = self.asked("torus", "trace", {"start": {"vertex": 0}, "fan": 10001, "length": 1}, 413)
        self.assertEqual((problem["pointer"], problem["limit"]), ("/fan", 10000))
        accepted = self.daemon.request("POST", "/v1/meshes/torus/trace", json.dumps({**question, "length": 1}),
                                       {"Content-Type": "application/json", "Prefer": "respond-async"})
        self.assertEqual(accepted.status, 202)

    def test_fields(self):
        answer = self.asked("square", "trace?select=start", {"start": {"vertex": 2}, "fan": 3, "length": 1})
        self.assertEqual(list(answer), ["start"])
        self.assertEqual(answer["start"]["vertex"], 2)

    def test_refusals(self):
        good = {"start": {"vertex": 0}, "length": 1, "directions": [0.1]}
        for change, pointer in [({"directions": []}, "/directions"), ({"fan": 3}, ""), ({"directions": None}, ""),
                                ({"length": -1}, "/length"), ({"length": None}, "/length"), ({"start": None}, "/start"),
                                ({"vertex_rule": "x"}, "/vertex_rule"), ({"boundary_rule": 1}, "/boundary_rule"),
                                ({"step_limit": 0}, "/step_limit"), ({"step_limit": 1000001}, "/step_limit"),
                                ({"stop_at_self_intersection": 1}, "/stop_at_self_intersection"),
                                ({"directions": ["x"]}, "/directions/0"), ({"directions": [0, [1, 2]]}, "/directions/1"),
                                ({"directions": [{}]}, "/directions/0"), ({"directions": [{"angel": 1}]}, "/directions/0/angel"),
                                ({"directions": [[0, 0, 0]]}, "/directions/0"), ({"directions": [[0, 0, 1]]}, "/directions/0"),
                                ({"lenght": 1}, "/lenght")]:
            document = {name: value for name, value in {**good, **change}.items() if value is not None}
            problem = self.asked("square", "trace", document, 400)
            self.assertEqual(problem["pointer"], pointer, (change, problem))
        problem = self.asked("square", "trace", {**good, "directions": [0.1, 3]}, 422)
        self.assertEqual((problem["code"], problem["pointer"]), ("point_not_on_surface", "/directions/1"))


class Exp(Tracing):
    def test_points_and_paths(self):
        answer = self.asked("grid", "exp", {"start": {"xyz": [0.4, 0.5, 0]},
                                          "vectors": [{"direction": [1, 0, 0], "length": 0.2},
                                                      {"direction": [0, 1, 0], "length": 0.9},
                                                      {"direction": [0, -1, 0], "length": 0}]})
        self.assert_place(answer["points"][0]["xyz"], [0.6, 0.5, 0])
        self.assert_place(answer["points"][1]["xyz"], [0.4, 1, 0])
        self.assert_place(answer["points"][2]["xyz"], [0.4, 0.5, 0])
        self.assertEqual([path["end_reason"] for path in answer["paths"]], ["length", "boundary", "length"])
        self.assertEqual([vector["length"] for vector in answer["vectors"]], [0.2, 0.9, 0])
        self.assert_place(answer["vectors"][1]["direction"]["xyz"], [0, 1, 0])

    def test_combinations(self):
        answer = self.asked("grid", "exp", {"start": {"xyz": [0.4, 0.5, 0]}, "combine": [2, -1],
                                          "vectors": [{"direction": [1, 0, 0], "length": 0.1},
                                                      {"direction": [0, 1, 0], "length": 0.15}]})
        [point], [vector] = answer["points"], answer["vectors"]
        self.assert_place(point["xyz"], [0.6, 0.35, 0])
        self.assertAlmostEqual(vector["length"], 0.25, 14)

    def test_segments_follow_each_other(self):
        start = {"face": 0, "barycentric": [0.5, 0.25, 0.25]}
        legs = [{"direction": 0, "length": 0.1}, {"direction": math.pi / 2, "length": 0.05}]
        answer = self.asked("square", "exp", {"start": start, "vectors": [{"segments": legs}]})
        x, y, _ = answer["paths"][0]["points"][0]["xyz"]
        self.assert_place(answer["points"][0]["xyz"], [x + 0.1, y + 0.05, 0])
        self.assertAlmostEqual(answer["vectors"][0]["length"], 0.15, 14)

    def test_refusals(self):
        vector = {"direction": 0.1, "length": 1}
        good = {"start": {"vertex": 0}, "vectors": [vector]}
        for change, pointer in [({"vectors": []}, "/vectors"), ({"vectors": 1}, "/vectors"), ({"vectors": None}, "/vectors"),
                                ({"vectors": [1]}, "/vectors/0"), ({"vectors": [{}]}, "/vectors/0/direction"),
                                ({"vectors": [{"direction": 1}]}, "/vectors/0/length"),
                                ({"vectors": [{**vector, "length": -1}]}, "/vectors/0/length"),
                                ({"vectors": [{"segments": []}]}, "/vectors/0"),
                                ({"vectors": [{"segments": [1]}]}, "/vectors/0/segments/0"),
                                ({"vectors": [{"segments": [vector, {"direction": [1, 0, 0], "length": 1}]}]},
                                 "/vectors/0/segments/1/direction"),
                                ({"combine": [1, 2]}, "/combine"), ({"combine": ["x"]}, "/combine/0"),
                                ({"combine": [1], "vectors": [{"segments": [vector, vector]}]}, "/vectors/0")]:
            document = {name: value for name, value in {**good, **change}.items() if value is not None}
            problem = self.asked("square", "exp", document, 400)
            self.assertEqual(problem["pointer"], pointer, (change, problem))
        self.asked("square", "exp", {"start": {"vertex": 0}, "vectors": [{"direction": 3, "length": 1}]}, 422)
        many = {"start": {"vertex": 0}, "vectors": [{"segments": [vector] * 5001}] * 2}
        self.assertEqual(self.asked("square", "exp", many, 413)["limit"], 10000)


if __name__ == "__main__":
    unittest.main()
