"""Tests distances from a point to a curve, and distances between curves, on NURBS and other
parametric surfaces."""
import functools
import math
import unittest

from nurbs import CYLINDER, PI, PLANE, SADDLE, TORUS, Nurbs, bumps, rational_torus, spline_at, wavy


class Curves(Nurbs):
    surfaces = {"plane": PLANE, "ring": TORUS, "torus": rational_torus(), "cylinder": CYLINDER, "bumps": bumps(8, 4, 0.5, 1),
                "saddle": SADDLE}

    CIRCLE = {"bspline": {"degree": 3, "knots": list(range(-3, 12)), "control_points": [
        [math.cos(PI * i / 4), math.sin(PI * i / 4)] for i in range(11)]}, "closed": True}

    @staticmethod
    @functools.cache
    def near_circle(count=200000):
        """Returns points of the closed cubic above, which is nearly a circle."""
        spline = Curves.CIRCLE["bspline"]
        return [spline_at(3, spline["knots"], spline["control_points"], 8 * i / count) for i in range(0, count, 100)]

    def end(self, answer, which, expected, tolerance=1e-9):
        self.assert_close(answer["ends"][which]["uv"], expected, tolerance)

    def test_the_nearer_side_of_a_circle(self):
        """The path to the farthest point also meets the circle at a right angle, but must never be
        the answer."""
        for angle in (0, PI / 4, PI / 2, PI):
            point = [2 * math.cos(angle), 2 * math.sin(angle)]
            answer = self.ask("plane", "point-curve-distance", {"point": point, "curve": self.CIRCLE})
            self.assertTrue(answer["is_minimum"])
            self.assertLess(answer["length"], 1.1)
            self.assertLess(abs(answer["ends"]["curve"]["angle"] - PI / 2), 1e-8)
            self.assertEqual(set(answer["ends"]), {"curve"})
            nearest = min(math.dist(point, place) for place in self.near_circle())
            self.assertLessEqual(answer["length"], nearest + 1e-12)
            self.assertLess(nearest - answer["length"], 1e-5)

    def test_straight_lines(self):
        line = {"polyline": [[-3, 2], [3, 2]]}
        answer = self.ask("plane", "point-curve-distance", {"point": [0.5, -1], "curve": line})
        self.assert_near(answer["length"], 3, 1e-12)
        self.assert_near(answer["ends"]["curve"]["parameter"], 3.5 / 6, 1e-9)
        self.end(answer, "curve", [0.5, 2])
        beyond = self.ask("plane", "point-curve-distance", {"point": [3.5, 1], "curve": line})
        self.assert_near(beyond["length"], math.hypot(0.5, 1), 1e-12)
        self.assertEqual((beyond["warnings"], beyond["ends"]["curve"]["parameter"]), (["curve_corner"], 1))

    def test_closed_polylines(self):
        """`closed` adds an edge between the last and the first point. Without `closed`, no edge
        joins these points."""
        corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
        for closed, expected in ((True, 1), (False, math.sqrt(2))):
            answer = self.ask("plane", "point-curve-distance", {"point": [-2, 0], "curve": {"polyline": corners, "closed": closed}})
            self.assert_near(answer["length"], expected, 1e-12)
        self.assert_near(self.ask("plane", "point-curve-distance", {"point": [-2, 0.5], "curve": {
            "polyline": corners, "closed": True}})["ends"]["curve"]["parameter"], 3.25, 1e-9)

    def test_iso_lines(self):
        answer = self.ask("ring", "curve-distance", {"a": {"iso": "u", "value": 0}, "b": {"iso": "u", "value": PI / 2}})
        self.assert_near(answer["length"], PI / 2, 1e-12)  # along the inner equator
        self.end(answer, "a", [0, PI], 1e-6)
        for end in answer["ends"].values():
            self.assertLess(abs(end["angle"] - PI / 2), 1e-8)
        outer = {"a": {"iso": "u", "value": 0, "range": [-1, 1]}, "b": {"iso": "u", "value": PI / 2, "range": [-1, 1]}}
        self.assertGreater(self.ask("ring", "curve-distance", outer)["length"], PI / 2 + 0.1)
        height = self.ask("cylinder", "curve-distance", {"a": {"iso": "v", "value": 0.2}, "b": {"iso": "v", "value": 0.9}})
        self.assert_near(height["length"], 3.5, 1e-12)

    def test_winding_curves(self):
        """Finds the nearest point among all turns of a helix around the cylinder."""
        helix = {"polyline": [[0, 0.1], [6 * PI, 0.9]]}
        answer = self.ask("cylinder", "point-curve-distance", {"point": [1, 0.5], "curve": helix})
        slope = 4 / (6 * PI)  # slope of the helix in the unrolled plane
        expected = min(abs(0.5 + slope * (1 + 2 * PI * k) - 2.5) / math.hypot(1, slope) for k in range(-1, 4))
        self.assert_near(answer["length"], expected)
        self.assertLess(abs(answer["ends"]["curve"]["angle"] - PI / 2), 1e-8)

    def test_curves_that_meet(self):
        answer = self.ask("plane", "curve-distance", {"a": {"polyline": [[-1, 0], [1, 0]]}, "b": {"polyline": [[0.25, -1], [0.25, 1]]}})
        self.assertEqual((answer["length"], answer["control_points"]), (0, []))
        self.assert_close(answer["points"][0]["uv"], [0.25, 0], 1e-9)
        self.assert_near(answer["ends"]["a"]["parameter"], 0.625, 1e-9)
        self.assertIsNone(answer["ends"]["b"]["angle"])

    def test_against_many_pairs_of_points(self):
        """No sampled pair of points of the two curves is nearer than the answer, and the nearest
        sampled pair is almost as near."""
        a, b = wavy(24, 0.25, 0.4, 0.15, 0.02, 5), wavy(24, 0.75, 0.6, 0.15, 0.02, 5)
        answer = self.ask("bumps", "curve-distance", {"a": a, "b": b})
        corners = lambda curve: curve["polyline"][::3]
        least = min(self.ask("bumps", "geodesic", {"from": p, "to": q}, "?select=length")["length"] for p in corners(a) for q in corners(b))
        self.assertLessEqual(answer["length"], least + 1e-10)
        self.assertGreater(answer["length"], 0.7 * least)
        back = self.ask("bumps", "curve-distance", {"a": b, "b": a})
        self.assert_near(back["length"], answer["length"], 1e-11)
        self.assert_close(back["ends"]["b"]["xyz"], answer["ends"]["a"]["xyz"], 1e-6)

    def test_invalid_curves(self):
        ask = lambda curve: self.post("saddle", "point-curve-distance", {"point": [0, 0], "curve": curve})
        for pointer, curve in (
            ("/curve", {}), ("/curve", {"circle": 1}), ("/curve/polyline", {"polyline": []}), ("/curve", {"polyline": [[0, 1]]}),
            ("/curve", {"polyline": [[0, 1], [0, 1]]}), ("/curve/polyline/1", {"polyline": [[0, 1], [0]]}),
            ("/curve/iso", {"polyline": [[0, 1], [1, 1]], "iso": "u"}), ("/curve/iso", {"iso": "w", "value": 0}),
            ("/curve/value", {"iso": "u"}), ("/curve/range", {"iso": "u", "value": 0, "range": [1, 0]}), ("/curve", {"iso": "u", "value": 7}),
            ("/curve/closed", {"polyline": [[0, 1], [1, 1]], "closed": "yes"}),
            ("/curve/bspline", {"bspline": []}), ("/curve/bspline/degree", {"bspline": {"degree": "x"}}),
            ("/curve/bspline/knots", {"bspline": {"degree": 1, "knots": [0, 1], "control_points": [[0, 1], [1, 1]]}}),
            ("/curve", {"bspline": {"degree": 1, "knots": [0, 0, 1, 0], "control_points": [[0, 1], [1, 1]]}}),
            ("/curve", {"bspline": {"degree": 1, "knots": [0, 0, 1, 1], "control_points": [[0, 1], [1, 1]]}, "closed": True}),
        ):
            with self.subTest(curve=curve):
                self.assertEqual(self.assert_problem(ask(curve), 400, "invalid_request")["pointer"], pointer)
        outside = self.assert_problem(ask({"polyline": [[0, 1], [0.5, 2], [1, 1]]}), 422, "point_not_on_surface")
        self.assertEqual(outside["pointer"], "/curve/polyline/1")
        many = self.assert_problem(ask({"polyline": [[i / 5000, 1] for i in range(5000)]}), 413, "too_large")
        self.assertEqual(many["limit"], 4096)


if __name__ == "__main__":
    unittest.main()
