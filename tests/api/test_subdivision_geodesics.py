"""Tests traces and shortest paths of subdivision surfaces, on the mesh and on the surface, by
closed forms and by laws. Also tests refusals."""
import json
import math
import unittest

from subdivisions import DIAGONAL, MIDDLE, MIRROR, Subdivisions


class Trace(Subdivisions):
    def test_the_closed_geodesics_of_the_cube(self):
        """In the mirror planes y = 0 and x = y a trace returns to its start. On the mesh, the gap
        is the error of the level. On the surface, the gap is at most 1e-8."""
        vertex = {"face": 0, "uv": [0, 0]}  # a vertex of valence 3 in the plane x = y
        for start, direction, length, plane in [(MIDDLE, [1, 0, 0], MIRROR, (0, 1, 0)), (MIDDLE, [1, 1, 0], DIAGONAL, (1, -1, 0)),
                                                (vertex, [1, 1, 1], DIAGONAL, (1, -1, 0))]:
            def far(point):
                return abs(sum(a * b for a, b in zip(plane, point["xyz"])))

            question = {"start": start, "directions": [direction], "length": length}
            [path] = self.ask("cube", "trace", {**question, "smooth": True})["paths"]
            self.assertEqual(path["end_reason"], "length")
            self.assert_near(path["points"][-1]["xyz"], path["points"][0]["xyz"], 1e-10)
            self.assertLess(max(map(far, path["points"])), 1e-10)
            for rule in ("limit_normal", "bisect"):
                before = 1
                for level in (3, 5, 7):
                    answer = self.ask("cube", "trace", {**question, "vertex_rule": rule, "level": level})
                    self.assertEqual(answer["level"], level)
                    [path] = answer["paths"]
                    self.assertLess(max(map(far, path["points"])), 1e-9, (rule, level))
                    gap = math.dist(path["points"][-1]["xyz"], path["points"][0]["xyz"])
                    # the method has second order, so two more levels divide the gap by sixteen
                    self.assertLess(gap, 0.2 * before)
                    before = gap
                self.assertLess(gap, 1e-3)

    def test_error_falls_with_the_level(self):
        question = {"start": {"face": 2, "uv": [0.3, 0.6]}, "fan": 16, "length": 1.2}
        smooth = self.ask("cube", "trace", {**question, "smooth": True})["paths"]
        errors = []
        for level in (3, 4, 5, 6, 7):
            rough = self.ask("cube", "trace?geometry=xyz", {**question, "level": level})["paths"]
            off = [math.dist(a["points"][-1], b["points"][-1]["xyz"]) for a, b in zip(rough, smooth)]
            errors.append(sum(off) / len(off))
        self.assertLess(errors[-1], 1e-3)
        # order 3/2 (engine/doc/021) divides the error by 64
        self.assertLess(errors[-1], errors[0] / 50)

    def test_directions_and_geometry(self):
        question = {"start": MIDDLE, "length": 0.3}
        paths = self.ask("cube", "trace", {**question, "directions": [math.pi / 2, [0, 1, 5], {"angle": math.pi / 2}], "smooth": True})["paths"]
        for path in paths:
            self.assert_near(path["points"][-1]["xyz"], paths[0]["points"][-1]["xyz"], 1e-11)
        fan = self.ask("cube", "trace?geometry=none", {**question, "fan": 4})["paths"]
        self.assertEqual([set(path) for path in fan], [{"length", "end_direction", "end_reason"}] * 4)
        for i, path in enumerate(fan):
            self.assertAlmostEqual(path["length"], 0.3, 13)
            angle = [math.cos(i * math.pi / 2), math.sin(i * math.pi / 2)]
            self.assertGreater(sum(a * b for a, b in zip(angle, path["end_direction"]["xyz"])), 0.9)
        answer = self.ask("cube", "trace?select=start", {**question, "fan": 3})
        self.assertEqual(list(answer), ["start"])
        self.assert_near(answer["start"]["xyz"], [0, 0, 68 / 81])

    def test_places_of_points_lie_where_they_say(self):
        for name, start, scale in [("cube", MIDDLE, 1e-3), ("loop", {"face": 2, "uv": [0.2, 0.2]}, 1e-3),
                                   ("prism", {"face": 1, "corner": 1, "uv": [0.4, 0.4]}, 3e-3)]:
            for smooth in (False, True):
                paths = self.ask(name, "trace", {"start": start, "fan": 5, "length": 1, "smooth": smooth})["paths"]
                for path in paths:
                    places = [{key: point[key] for key in ("face", "corner", "uv") if key in point} for point in path["points"]]
                    for told, point in zip(path["points"], self.ask(name, "evaluate", {"points": places})["points"]):
                        self.assert_near(told["xyz"], point["xyz"], 1e-9 if smooth else scale)

    def test_the_boundary(self):
        for smooth in (True, False):
            question = {"start": {"face": 0, "uv": [0.5, 0.5]}, "directions": [[1, 0, 0]], "length": 9, "smooth": smooth}
            [path] = self.ask("sheet", "trace", question)["paths"]
            self.assertEqual(path["end_reason"], "boundary")
            self.assertLess(path["length"], 1)
            edge = {"start": {"face": 0, "uv": [1, 0.5]}, "directions": [[1, 0, 0], [-1, 0, 0]], "length": 0.2, "smooth": smooth}
            off, on = self.ask("sheet", "trace", edge)["paths"]
            self.assertEqual((off["end_reason"], off["length"]), ("boundary", 0))
            self.assertEqual(on["end_reason"], "length")

    def test_no_path_leaves_the_surface_and_returns(self):
        """The boundary of this surface bends inwards. A straight line between two of its points
        leaves the surface, and returns within one step of the integration."""
        points = [[0, 0, -0.25], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]] + [[1.2 * x, 1.2 * y, 0] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        self.put("star", {"points": points, "faceVertexCounts": [4] * 4, "interpolateBoundary": "edgeAndCorner",
                          "faceVertexIndices": [0, 1, 5, 2, 0, 2, 6, 3, 0, 3, 7, 4, 0, 4, 8, 1]})
        start, end = ({"face": 3, "uv": [1, v]} for v in (0.01, 0.31))
        border = [point["xyz"] for point in self.ask("star", "evaluate", {"points": [{"face": 3, "uv": [1, 0.01 + 0.0003 * i]} for i in range(1001)]})["points"]]
        length = sum(map(math.dist, border, border[1:]))
        straight = [b - a for a, b in zip(border[0], border[-1])]
        [path] = self.ask("star", "trace", {"start": start, "directions": [straight], "length": 1, "smooth": True})["paths"]
        self.assertEqual((path["end_reason"], path["length"]), ("boundary", 0))
        for ends in ((start, end), (end, start)):
            answer = self.ask("star", "distance", {"from": ends[0], "to": ends[1]})
            self.assertLess(abs(answer["distance"] - length), answer["error_estimate"])

    def test_a_line_ends_where_it_meets_itself(self):
        """With stop_at_self_intersection, the closed geodesic of the mirror plane ends at its
        start. Each line of a fan ends where it meets itself."""
        question = {"start": MIDDLE, "length": 20, "level": 4, "stop_at_self_intersection": True}
        [path] = self.ask("cube", "trace", {**question, "directions": [[1, 0, 0]]})["paths"]
        self.assertEqual(path["end_reason"], "self_intersection")
        self.assert_near(path["points"][-1]["xyz"], path["points"][0]["xyz"], 1e-9)
        self.assertLess(abs(path["length"] - MIRROR), 0.02)
        for path in self.ask("cube", "trace", {**question, "fan": 7, "vertex_rule": "bisect"})["paths"]:
            self.assertEqual(path["end_reason"], "self_intersection")
            end, points = path["points"][-1]["xyz"], [point["xyz"] for point in path["points"]]
            self.assertLess(min(self.off_segment(end, a, b) for a, b in zip(points[:-3], points[1:])), 1e-9)
        free = self.ask("cube", "trace", {**question, "directions": [[1, 0, 0]], "stop_at_self_intersection": False})["paths"]
        self.assertEqual(free[0]["end_reason"], "length")

    @staticmethod
    def off_segment(point, a, b):
        along = [q - p for p, q in zip(a, b)]
        square = sum(x * x for x in along)
        part = min(max(sum(x * (q - p) for x, p, q in zip(along, a, point)) / square, 0), 1) if square else 0
        return math.dist(point, [p + part * x for p, x in zip(a, along)])

    def test_refusals(self):
        good = {"start": MIDDLE, "length": 1, "fan": 2}
        for change, pointer in [({"start": None}, "/start"), ({"length": -1}, "/length"), ({"level": 13}, "/level"), ({"level": 1.5}, "/level"),
                                ({"vertex_rule": "x"}, "/vertex_rule"), ({"smooth": 1}, "/smooth"), ({"fan": 0}, "/fan"),
                                ({"directions": [1]}, ""), ({"boundary_rule": "stop"}, "/boundary_rule"),
                                ({"smooth": True, "stop_at_self_intersection": True}, "/stop_at_self_intersection")]:
            document = {key: value for key, value in {**good, **change}.items() if value is not None}
            self.assertEqual(self.ask("cube", "trace", document, 400)["pointer"], pointer, change)
        self.assertEqual(self.ask("cube", "trace", {**good, "fan": 10001}, 413)["limit"], 10000)
        for query in ("distance", "path"):
            answer = self.daemon.get(f"/v1/subdivisions/cube/{query}?from=f:0:0.5,0.5&to=f:5:0.5,0.5&level=12")
            self.assertEqual((answer.status, answer.json["parameter"]), (413, "level"))
        self.assertEqual(self.ask("prism", "trace", {**good, "level": 0, "start": {"face": 0, "uv": [0, 0]}}, 400)["pointer"], "/level")
        for smooth in (True, False):
            problem = self.ask("cube", "trace", {"start": MIDDLE, "length": 1, "directions": [0, [0, 0, 1]], "smooth": smooth}, 400)
            self.assertEqual(problem["pointer"], "/directions/1")
        self.ask("cube", "trace?timeout_ms=1", {**good, "fan": 10000, "length": 1000, "smooth": True}, 504)

    def test_as_a_job(self):
        accepted = self.daemon.request("POST", "/v1/subdivisions/cube/trace", json.dumps({"start": MIDDLE, "length": 1, "fan": 2}),
                                       {"Content-Type": "application/json", "Prefer": "respond-async"})
        self.assertEqual(self.daemon.ended(accepted)["state"], "done")


class Paths(Subdivisions):
    def test_a_quarter_of_the_mirror_geodesic(self):
        for level in (3, 6):
            answer = self.ask("cube", "path", {"from": MIDDLE, "to": {"face": 5, "uv": [0.5, 0.5]}, "level": level})
            self.assertAlmostEqual(answer["distance"], MIRROR / 4, 10)
            self.assertTrue(answer["relaxed"])
            self.assertLess(answer["error_estimate"], 1e-9)
            self.assertLess(abs(answer["mesh_distance"] - answer["distance"]), 0.1 * 4 ** (2 - level))
            self.assertEqual((answer["level"], answer["path"]["length"]), (level, answer["distance"]))
            self.assert_near(answer["path"]["points"][0]["xyz"], answer["from"]["xyz"])
            self.assert_near(answer["path"]["points"][-1]["xyz"], answer["to"]["xyz"], 1e-9)
            self.assertEqual(answer["path"]["points"][-1]["uv"], [0.5, 0.5])
        answer = self.ask("cube", "distance", {"from": MIDDLE, "to": {"face": 5, "uv": [0.5, 0.5]}})
        self.assertNotIn("path", answer)
        self.assertAlmostEqual(answer["distance"], MIRROR / 4, 10)

    def test_a_path_is_a_trace(self):
        """A trace that starts in the direction of the computed geodesic arrives at its end."""
        for name, start, end in [("cube", {"face": 0, "uv": [0.2, 0.7]}, {"face": 2, "uv": [0.6, 0.5]}),
                                 ("loop", {"face": 0, "uv": [0.2, 0.3]}, {"face": 1, "uv": [0.5, 0.2]}),
                                 ("prism", {"face": 1, "corner": 0, "uv": [0.9, 0.8]}, {"face": 2, "uv": [0.5, 0.3]})]:
            answer = self.ask(name, "path", {"from": start, "to": end})
            self.assertTrue(answer["relaxed"], answer)
            back = self.ask(name, "distance", {"from": end, "to": start})
            self.assertAlmostEqual(answer["distance"], back["distance"], 9)
            first, second = answer["path"]["points"][:2]
            way = [b - a for a, b in zip(first["xyz"], second["xyz"])]
            [path] = self.ask(name, "trace", {"start": start, "directions": [way], "length": answer["distance"], "smooth": True})["paths"]
            self.assertLess(math.dist(path["points"][-1]["xyz"], answer["to"]["xyz"]), 2 * math.hypot(*way) ** 2)

    def test_get(self):
        """GET returns the same answer as POST. The problem of a wrong request names the
        parameter."""
        places = (("f:0:0.5,0.5", MIDDLE), ("f:5:0:0.25,1e-1", {"face": 5, "corner": 0, "uv": [0.25, 0.1]}))
        ends = "from={}&to={}".format(*(text for text, _ in places))
        for query, level in (("distance", ""), ("path", ""), ("path", "&level=3")):
            path = f"/v1/subdivisions/cube/{query}?{ends}{level}"
            answer, body = self.daemon.get(path), {"from": places[0][1], "to": places[1][1], **({"level": 3} if level else {})}
            self.assertEqual(answer.json, self.ask("cube", query, body))
            self.assertEqual(self.daemon.get(path, If_None_Match=answer.headers["ETag"]).status, 304)
        self.assertEqual(self.daemon.get("/v1/subdivisions/prism/distance?from=f:1:1:0.5,0.5&to=f:1:1:0.5,0.5").json["distance"], 0)
        for query, parameter in (("to=f:0:0,0", "from"), ("from=0,0&to=f:0:0,0", "from"), ("from=f:0:0&to=f:0:0,0", "from"), ("from=f:0:0,0&to=f:0:0:0:0,0", "to"),
                                 ("from=f:99:0,0&to=f:0:0,0", "from"), ("from=f:0:0,0&to=f:-1:0,0", "to"), ("from=f:0:0,0&to=f:1:0,0&level=13", "level"),
                                 ("from=f:0:0,0&to=f:1:0,0&level=x", "level"), ("from=f:0:0,0&to=f:1:0,0&foo=1", "foo")):
            problem = self.assert_problem(self.daemon.get("/v1/subdivisions/cube/path?" + query), 400, "invalid_request")
            self.assertEqual((problem.get("parameter"), problem.get("pointer")), (parameter, None), query)
        problem = self.assert_problem(self.daemon.get("/v1/subdivisions/cube/path?from=f:0:0,0&to=f:1:2,0"), 422, "point_not_on_surface")
        self.assertEqual(problem["parameter"], "to")

    def test_no_path_and_one_point(self):
        places = {"from": {"face": 0, "uv": [0.5, 0.5]}, "to": {"face": 1, "uv": [0.5, 0.5]}}
        answer = self.ask("pair", "path", places)
        self.assertEqual((answer["distance"], answer["reason"], answer["path"]), (None, "no_path", None))
        self.assertNotIn("error_estimate", answer)
        answer = self.ask("cube", "path", {"from": MIDDLE, "to": MIDDLE})
        self.assertEqual(answer["distance"], 0)
        self.assertEqual(list(self.ask("cube", "path?select=path&geometry=none", {"from": MIDDLE, "to": MIDDLE})["path"]), ["length"])
        for change, pointer in [({"to": None}, "/to"), ({"level": 20}, "/level"), ({"via": []}, "/via")]:
            document = {key: value for key, value in {"from": MIDDLE, "to": MIDDLE, **change}.items() if value is not None}
            self.assertEqual(self.ask("cube", "path", document, 400)["pointer"], pointer)


if __name__ == "__main__":
    unittest.main()
