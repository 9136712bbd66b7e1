"""Tests trimmed surfaces: loops of the file, the domain that these loops bound, paths in this
domain, and durability."""
import json
import math
import unittest

from harness import Folder
from nurbs import CIRCLE, CIRCLE_KNOTS, JSON, Nurbs, circle_weight

HALF = math.sqrt(0.5)


def circle(u, v, radius):
    """Returns a loop of one rational curve around (u, v)."""
    corners = ((1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0))
    points = [[u + radius * x, v + radius * y, HALF if x and y else 1] for x, y in corners]
    return [{"degree": 2, "knots": CIRCLE_KNOTS, "controlPoints": points}]


def plate(**trims):
    """Returns the square [0, 4] x [0, 4] of the plane with trimming loops."""
    return {"parametric": {"graph": {"coefficients": [[0]], "u": [0, 4], "v": [0, 4]}}, "trims": trims}


SQUARE_LOOP = [{"polyline": [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]}]
L_LOOP = [{"polyline": [[0, 0], [4, 0], [4, 1], [1, 1]]}, {"degree": 1, "controlPoints": [[1, 1], [1, 4]]}, {"polyline": [[1, 4], [0, 4], [0, 0]]}]
# length of the path from (0.5, 2) to (3.5, 2) around the unit circle at (2, 2)
AROUND = 2 * math.sqrt(1.25) + (math.pi - 2 * math.acos(1 / 1.5))


class Trims(Nurbs):
    surfaces = {"plate": plate(outer=SQUARE_LOOP, holes=[circle(2, 2, 1)]), "angle": plate(outer=L_LOOP)}

    def test_descriptions(self):
        told = self.daemon.get("/v1/nurbs/plate").json
        self.assertEqual((told["trimming_loops"], told["outer_loop"], told["geodesics"]), (2, True, True))
        self.put("untrimmed", {"parametric": {"torus": {"major": 2, "minor": 1}}})
        self.assertFalse({"trimming_loops", "outer_loop"} & set(self.daemon.get("/v1/nurbs/untrimmed").json))

    def test_paths_stay_in_the_domain(self):
        answer = self.ask("plate", "path", {"from": [0.5, 2], "to": [3.5, 2], "samples": 200, "all_minima": True})
        self.assertAlmostEqual(answer["length"], AROUND, 10)
        self.assertEqual((answer["converged"], answer["is_minimum"], answer["boundary_contact"]), (True, True, True))
        self.assertEqual(len(answer["minima"]), 2)
        for path in answer["minima"]:
            self.assertAlmostEqual(path["length"], AROUND, 10)
            self.assertTrue(all(math.dist(point["uv"], (2, 2)) > 1 - 1e-8 for point in path["points"]))
        corner = self.ask("angle", "path", {"from": [3.5, 0.5], "to": [0.5, 3.5]})
        self.assertAlmostEqual(corner["length"], 2 * math.hypot(2.5, 0.5), 10)
        straight = self.ask("angle", "path", {"from": [0.5, 0.5], "to": [0.5, 3.5]})
        self.assertEqual((straight["boundary_contact"], straight["warnings"]), (False, []))

    def test_paths_to_corners_of_loops(self):
        """A straight path to a corner is not taken for a path along the next edge of the loop."""
        for name, loops in {"square": [[1, 1], [3, 1], [3, 3], [1, 3]], "triangle": [[1, 1], [3, 1], [2, 3]]}.items():
            self.assertEqual(self.put(name, plate(holes=[[{"polyline": [*loops, loops[0]]}]])).status, 201)
        for name, start, end, length in (("angle", [4, 0], [1, 1], math.hypot(3, 1)), ("angle", [0, 4], [1, 1], math.hypot(1, 3)),
                                         ("square", [2.5, 0.2], [1, 1], math.hypot(1.5, 0.8)), ("square", [3.7, 3.1], [1, 3], math.hypot(2.7, 0.1)),
                                         ("triangle", [3.6, 0.6], [1, 1], math.hypot(2.6, 0.4))):
            with self.subTest(name=name, start=start, end=end):
                for ends in ((start, end), (end, start)):
                    self.assertAlmostEqual(self.ask(name, "path", {"from": ends[0], "to": ends[1]})["length"], length, 12)

    def test_paths_that_begin_on_an_edge_of_a_loop(self):
        triangle = [[1, 1], [3, 1], [2, 3]]
        self.put("wedge", plate(holes=[[{"polyline": [*triangle, triangle[0]]}]]))
        for end, length in (([2.7, 1.9], math.hypot(0.6, 1.2) + math.hypot(0.7, 1.1)), ([2.1, 3], math.hypot(0.6, 1.2) + 0.1)):
            for ends in (([1.4, 1.8], end), (end, [1.4, 1.8])):
                self.assertAlmostEqual(self.ask("wedge", "path", {"from": ends[0], "to": ends[1]})["length"], length, 12)

    def test_paths_do_not_turn_back_on_an_edge_of_a_loop(self):
        """A rounding error of an angle does not lengthen the part of a path on a straight edge."""
        corners = [[1.8921134990534747, 0.23645706531919014], [1.2276538096090794, 0.34590654837634444], [2.5265151265835906, 0.3478185285718752]]
        outer = [[0.2, 0.9], [math.pi, 0.9], [math.pi, 0.5], [5.983185307179586, 0.5], [5.983185307179586, 0.1], [0.2, 0.0125], [0.2, 0.9]]
        self.put("tube", {"parametric": {"revolution": {"degree": 1, "knots": [0, 0, 1, 1], "control_points": [[1, 0], [1, 8]]}},
                          "trims": {"outer": [{"polyline": outer}], "holes": [[{"polyline": [*corners, corners[0]]}]]}})
        places = [[1.5947488056397061, 0.28543883575706375], corners[1], [3.017141994485376, 0.8727191847045639]]
        unrolled = [(u, 8 * v) for u, v in places]
        answer = self.ask("tube", "path", {"from": places[0], "to": places[2]})
        self.assertAlmostEqual(answer["length"], sum(map(math.dist, unrolled, unrolled[1:])), 12)

    def test_a_straight_path_to_a_corner_of_a_hole(self):
        """The contacts of the path on the mesh do not lead the path around the hole."""
        corners = [[0.5339154544924296, 4.120881860190122], [0.3032655142927095, 4.129459625223042], [0.20649810684096673, 4.010928278638832],
                   [0.250744911103007, 3.8047189364072085], [0.41120196215621063, 3.9324897448845983]]
        self.put("strip", {"parametric": {"graph": {"coefficients": [[0]], "u": [0, 2], "v": [0, 8]}},
                           "trims": {"holes": [[{"polyline": [*corners, corners[0]]}]]}})
        start = [0, 0.3347142389061757]
        self.assertAlmostEqual(self.ask("strip", "path", {"from": start, "to": corners[0]})["length"], math.dist(start, corners[0]), 12)

    def test_paths_along_the_border(self):
        """A path along the inner circle of a quarter of an annulus has the length of the arc,
        although its speed is uneven."""
        points = [[[r * x, r * y, 0] for r in (1, 3)] for x, y in CIRCLE[:3]]
        weights = [[circle_weight(i) * 20**i] * 2 for i in range(3)]
        self.put("ring", {"degreeU": 2, "degreeV": 1, "knotsU": [0, 0, 0, 1, 1, 1], "knotsV": [0, 0, 1, 1], "controlPoints": points, "weights": weights,
                          "trims": {"holes": [circle(0.8, 0.7, 0.1)]}})
        for a, b in ((0, 1), (0, 0.5), (0.01, 0.9)):
            p, q = (point["xyz"] for point in self.ask("ring", "evaluate", {"uv": [[a, 0], [b, 0]]})["points"])
            angle = (math.atan2(q[1], q[0]) - math.atan2(p[1], p[0])) % (2 * math.pi)
            for tolerance in (1e-5, 1e-8, 1e-11):
                answer = self.ask("ring", "path", {"from": [a, 0], "to": [b, 0], "tolerance": tolerance})
                self.assertLess(abs(answer["length"] - angle), answer["error_estimate"] + 1e-13)

    def test_points_on_sampled_paths_are_in_the_domain(self):
        points = self.ask("plate", "path", {"from": [0.5, 2.1], "to": [3.5, 2], "samples": 100})["points"]
        self.assertEqual(len(self.ask("plate", "evaluate", {"uv": [point["uv"] for point in points]})["points"]), 100)

    def test_places_that_are_cut_away(self):
        for query, body, pointer in (("evaluate", {"uv": [[0, 0], [2, 2]]}, "/uv/1"),
                                     ("path", {"from": [2, 2], "to": [0, 0]}, "/from"),
                                     ("point-curve-distance", {"point": [0, 0], "curve": {"polyline": [[3, 1], [2, 2]]}}, "/curve/polyline/1"),
                                     ("point-curve-distance", {"point": [0, 0], "curve": {"polyline": [[0.5, 2], [3.5, 2]]}}, "/curve")):
            with self.subTest(query=query, pointer=pointer):
                problem = self.assert_problem(self.post("plate", query, body), 422, "point_not_on_surface")
                self.assertEqual(problem["pointer"], pointer)
                self.assertIn("trimming loops", problem["detail"])

    def test_nearest(self):
        found = self.ask("plate", "nearest", {"xyz": [2.3, 2.4, 0]})
        self.assertAlmostEqual(found["distance"], 0.5, 10)
        self.assertAlmostEqual(found["uv"][0], 2.6, 8)

    def test_the_mesh_has_the_hole(self):
        self.assertEqual(self.post("plate", "tessellate", {"mesh": "plate-mesh", "tolerance": 0.001}).status, 201)
        mesh = self.daemon.get("/v1/meshes/plate-mesh").json
        self.assertEqual((len(mesh["boundaries"]), mesh["components"]), (2, 1))
        self.assertAlmostEqual(mesh["boundaries"][1]["length"], 2 * math.pi, 3)
        self.assertAlmostEqual(mesh["area"], 16 - math.pi, 2)
        places = self.daemon.get("/v1/meshes/plate-mesh/parameters").json["uv"]
        self.assertTrue(all(math.dist(uv, (2, 2)) > 1 - 1e-9 for uv in places))

    def test_what_trimmed_surfaces_do_not_offer(self):
        ends, curve = {"from": [0.5, 2], "to": [0.5, 3]}, {"iso": "u", "value": 3.5}
        for query, body, member, value in (("path", ends, "turns", [0, 0]), ("path", ends, "initial", {"polyline": [[0.5, 2], [0.5, 3]]}),
                                           ("path", ends, "degree", 2), ("path", ends, "control_points", 9),
                                           ("point-curve-distance", {"point": [0.5, 2], "curve": curve}, "all_minima", True)):
            problem = self.refusal("plate", query, {**body, member: value})
            self.assertEqual(problem["pointer"], f"/{member}")
        for option in ("degree=2", "control_points=9"):
            problem = self.assert_problem(self.daemon.get(f"/v1/nurbs/plate/path?from=0.5,2&to=0.5,3&{option}"), 400, "invalid_request")
            self.assertEqual(problem["parameter"], option.split("=")[0])

    def test_faulty_loops(self):
        bow = [{"polyline": [[1, 1], [3, 3], [1, 3], [3, 1], [1, 1]]}]
        open_ = [{"polyline": [[1, 1], [3, 1]]}, {"polyline": [[3, 1], [3, 3], [1, 3]]}]
        for pointer, part, trims in (("/trims/outer/0", "itself", {"outer": bow}),
                                     ("/trims/holes/0/1", "not closed", {"holes": [open_]}),
                                     ("/trims/holes/1/0", "touches", {"holes": [circle(2, 2, 1), circle(3, 2, 0.5)]}),
                                     ("/trims/holes/1/0", "inside hole 0", {"holes": [circle(2, 2, 1), circle(2, 2, 0.5)]}),
                                     ("/trims/holes/0/0", "outside the outer loop", {"outer": L_LOOP, "holes": [circle(3, 3, 0.5)]})):
            with self.subTest(pointer=pointer, part=part):
                problem = self.assert_problem(self.put("faulty", plate(**trims)), 422, "invalid_mesh")
                self.assertEqual((problem["reason"], problem["pointer"]), ("trims", pointer))
                self.assertIn(part, problem["detail"])
        for pointer, trims in (("/trims", {}), ("/trims/inner", {"inner": []}), ("/trims/holes", {"holes": 3}), ("/trims/outer", {"outer": []}),
                               ("/trims/outer/0/degree", {"outer": [{"controlPoints": [[1, 1], [2, 2]]}]}),
                               ("/trims/outer/0/polyline/1", {"outer": [{"polyline": [[1, 1], [2]]}]}),
                               ("/trims/outer/0/knots", {"outer": [{"degree": 1, "knots": [0, 1], "controlPoints": [[1, 1], [2, 2]]}]}),
                               ("/trims/outer/0/weights", {"outer": [{"degree": 1, "weights": [1], "controlPoints": [[1, 1], [2, 2]]}]})):
            with self.subTest(pointer=pointer):
                problem = self.assert_problem(self.put("faulty", plate(**trims)), 400, "invalid_request")
                self.assertEqual(problem["pointer"], pointer)


class Durable(Folder):
    def test_loops_survive_a_restart(self):
        request = json.dumps({"from": [0.5, 2], "to": [3.5, 2]})
        with self.start() as daemon:
            self.assertEqual(daemon.request("PUT", "/v1/nurbs/plate", json.dumps(Trims.surfaces["plate"]), JSON).status, 201)
            before = daemon.request("POST", "/v1/nurbs/plate/path", request, JSON)
        with self.start() as daemon:
            after = daemon.request("POST", "/v1/nurbs/plate/path", request, JSON)
            self.assertEqual((after.status, after.json), (200, before.json))
            self.assertEqual(daemon.get("/v1/nurbs/plate").json["trimming_loops"], 2)


if __name__ == "__main__":
    unittest.main()
