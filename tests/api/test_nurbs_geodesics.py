"""Compares shortest paths between two points of a NURBS or other parametric surface with closed
forms. Also tests the deadlines of these requests."""
import math
import random
import time
import unittest

from harness import wait_until
from nurbs import ANNULUS, CIRCLE, CIRCLE_KNOTS, CONE, CYLINDER, HELICOID, PI, PLANE, SADDLE, TORUS, Nurbs, bumps, circle_weight, rational_sphere, rational_torus, spline_at, wavy


class Geodesics(Nurbs):
    surfaces = {"ring": TORUS, "torus": rational_torus(), "sphere": rational_sphere(), "saddle": SADDLE, "plane": PLANE,
                "cylinder": CYLINDER, "cone": CONE, "annulus": ANNULUS, "wide": {"parametric": {"torus": {"major": 3, "minor": 1.1}}}, "bumps": bumps(8, 4, 0.5, 1), "helicoid": HELICOID}

    def geodesic(self, name, a, b, **options):
        return self.ask(name, "geodesic", {"from": a, "to": b, **options})

    def assert_proved(self, answer):
        self.assertTrue(answer["converged"] and answer["is_minimum"] and not answer["boundary_contact"], answer["warnings"])
        self.assertLess(answer["residual"], 1e-8)
        self.assertLess(answer["error_estimate"], 1e-10 * max(1, answer["length"]))

    def test_closed_forms(self):
        at = lambda u, v: [u, v]
        straight = lambda u, v, r: math.hypot(r * u, v)
        # `apex` is the slant height from the cone's apex to v = 0; the slant height to v is (1 + v)
        # apex
        apex = math.hypot(1, 3)
        slant = lambda v: (1 + v) * apex
        turned = lambda u, v, w: math.sqrt(slant(v) ** 2 + slant(w) ** 2 - 2 * slant(v) * slant(w) * math.cos(u / apex))
        for name, a, b, expected in (
            ("plane", [-3, 1], [2.5, -3.5], math.hypot(5.5, 4.5)),
            ("cylinder", [0.2, 0.1], [1.9, 0.8], math.hypot(1.7, 3.5)),
            ("cylinder", [0.1, 0.5], [2 * PI - 0.4, 0.5], 0.5),
            ("cone", [0.3, 0.2], [1.7, 0.9], turned(1.4, 0.2, 0.9)),
            ("saddle", [0, 0], [1, 1], 1.797852788781883),
            ("ring", [0, 0], [PI / 2, PI / 2], 4.0618928974654),
            ("ring", [0.3, 2.0], [2.1, 4.0], 2.8552575338283),
        ):
            with self.subTest(name=name, a=a):
                answer = self.geodesic(name, at(*a), at(*b))
                self.assert_near(answer["length"], expected)
                self.assert_proved(answer)
        self.assertEqual(straight(0, 1, 1), 1)

    def test_get(self):
        """GET returns the same answer as POST. The problem of a wrong request names the
        parameter."""
        path = "/v1/nurbs/ring/path?from=0.3,2.0&to=2.1,4.0"
        options = {"degree": 4, "control_points": 12, "tolerance": 1e-6, "all_minima": True, "samples": 3}
        for query, body in (("", {}), ("&degree=4&control_points=12&tolerance=1e-6&all_minima=true&samples=3", options)):
            answer = self.daemon.get(path + query)
            self.assertEqual(answer.json, self.ask("ring", "path", {"from": [0.3, 2.0], "to": [2.1, 4.0], **body}))
            self.assertEqual(self.daemon.get(path + query, If_None_Match=answer.headers["ETag"]).status, 304)
        length = self.daemon.get(path + "&select=length").json
        self.assertEqual(list(length), ["length"])
        for query, parameter in (("to=1,1", "from"), ("from=0&to=1,1", "from"), ("from=0,0&to=0,0,0", "to"), ("from=0,0&to=", "to"), ("from=0,0&to=1,x", "to"),
                                 ("from=0,0&to=1,1&degree=9", "degree"), ("from=0,0&to=1,1&degree=x", "degree"), ("from=0,0&to=1,1&all_minima=1", "all_minima"),
                                 ("from=0,0&to=1,1&samples=1.5", "samples"), ("from=0,0&to=1,1&control_points=2", "control_points"), ("from=0,0&to=1,1&foo=1", "foo")):
            problem = self.assert_problem(self.daemon.get("/v1/nurbs/ring/path?" + query), 400, "invalid_request")
            self.assertEqual((problem.get("parameter"), problem.get("pointer")), (parameter, None), query)
        problem = self.assert_problem(self.daemon.get("/v1/nurbs/plane/path?from=0,0&to=99,0"), 422, "point_not_on_surface")
        self.assertEqual(problem["parameter"], "to")

    def test_the_sphere(self):
        """Tests great circles close to the poles, and a great circle through a pole."""
        chance = random.Random(3)
        for _ in range(12):
            a, b = ([chance.random(), chance.uniform(0.1, 0.9)] for _ in range(2))
            answer = self.geodesic("sphere", a, b)
            p, q = (point["xyz"] for point in self.ask("sphere", "evaluate", {"uv": [a, b]})["points"])
            cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
            self.assert_near(answer["length"], math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(p, q))))
            self.assert_proved(answer)
        through = self.geodesic("sphere", [0.125, 0.75], [0.625, 0.9])
        p, q = (point["xyz"] for point in self.ask("sphere", "evaluate", {"uv": [[0.125, 0.75], [0.625, 0.9]]})["points"])
        self.assert_near(through["length"], math.acos(p[2]) + math.acos(q[2]))
        self.assertEqual(through["warnings"], ["through_pole"])

    def test_the_rational_torus_is_the_torus(self):
        quarter = lambda angle: {0: 0, PI / 2: 0.25}[angle]
        answer = self.geodesic("torus", [0, 0], [quarter(PI / 2), quarter(PI / 2)])
        self.assert_near(answer["length"], 4.0618928974654)
        self.assert_proved(answer)

    def test_symmetric(self):
        for name, a, b in (("bumps", [0.1, 0.1], [0.9, 0.8]), ("torus", [0.1, 0.2], [0.55, 0.8])):
            there, back = self.geodesic(name, a, b), self.geodesic(name, b, a)
            self.assert_near(there["length"], back["length"], 1e-12)

    def check_curve(self, name, answer):
        """Asserts that the answer's points lie on its B-spline, and that it has the stated
        length."""
        degree, knots, points = answer["degree"], answer["knots"], answer["control_points"]
        self.assertEqual(len(knots), len(points) + degree + 1)
        self.assertEqual(knots, sorted(knots))
        samples, last = answer["points"], knots[-1]
        for i in range(0, len(samples), 7):
            place = spline_at(degree, knots, points, last * i / (len(samples) - 1))
            self.assert_close(place, samples[i]["uv"], 1e-9)
        evaluated = self.ask(name, "evaluate", {"uv": [sample["uv"] for sample in samples]})["points"]
        for point, sample in zip(evaluated, samples):
            self.assert_close(point["xyz"], sample["xyz"], 1e-12)
        chords = sum(math.dist(a["xyz"], b["xyz"]) for a, b in zip(samples, samples[1:]))
        self.assertLess(answer["length"] - chords, 1e-5 * answer["length"])
        self.assertGreaterEqual(answer["length"], chords - 1e-12)

    def test_the_curve(self):
        for name, a, b in (("bumps", [0.05, 0.1], [0.95, 0.8]), ("torus", [0.9, 0.1], [0.2, 0.45]), ("ring", [6, 1], [7.5, 2.2])):
            with self.subTest(name=name):
                answer = self.geodesic(name, a, b, samples=701)
                self.assertEqual(len(answer["points"]), 701)
                self.check_curve(name, answer)
        through = self.geodesic("sphere", [0.125, 0.75], [0.625, 0.9])
        self.assertEqual(len(through["knots"]), len(through["control_points"]) + through["degree"] + 1)
        pole = [knot for knot in set(through["knots"]) if through["knots"].count(knot) == through["degree"] + 1]
        self.assertEqual(len(pole), 3)  # the points are both ends and the pole

    def test_single_splines_as_in_the_paper(self):
        """Uses one B-spline of a given number of control points: errors decrease, and the curve is
        never shorter than the shortest path."""
        exact = self.geodesic("bumps", [0.1, 0.1], [0.9, 0.8])["length"]
        for degree, most in ((2, 1e-5), (3, 1e-6)):
            errors = []
            for count in (4, 8, 16, 32):
                answer = self.geodesic("bumps", [0.1, 0.1], [0.9, 0.8], control_points=count, degree=degree)
                self.assertEqual((len(answer["control_points"]), answer["degree"]), (count, degree))
                errors.append(answer["length"] / exact - 1)
            self.assertTrue(all(error > -1e-11 for error in errors), errors)
            self.assertTrue(all(b < a for a, b in zip(errors, errors[1:])), errors)
            self.assertLess(errors[-1], most)

    def test_all_minima(self):
        """On the cylinder, the paths around either side are minima. All minima are listed by
        length."""
        answer = self.geodesic("cylinder", [0, 0], [2.5, 0.2], all_minima=True)
        lengths = [way["length"] for way in answer["minima"]]
        for k, found in enumerate(lengths[:2]):
            self.assert_near(found, math.hypot((2.5, 2 * PI - 2.5)[k], 1))
        self.assertEqual(lengths, sorted(lengths))
        self.assertEqual(answer["length"], lengths[0])
        self.assertTrue(all(way["is_minimum"] for way in answer["minima"]))
        self.assertEqual(answer["turn_limit"], 1)
        self.assertEqual({tuple(way["turns"]) for way in answer["minima"]}, {(0, 0), (1, 0), (-1, 0)})
        self.assertNotIn("minima", self.geodesic("cylinder", [0, 0], [2.5, 0.2]))
        self.assertEqual(self.geodesic("saddle", [0, 0], [1, 1], all_minima=True)["turn_limit"], 0)

    def test_classes(self):
        """On the cylinder of radius 1 and height 5 a path of m turns is a straight line of the
        unrolled plane. Each class of a torus has a minimum."""
        around, up = 2.5, 1
        lengths = [way["length"] for way in self.geodesic("cylinder", [0, 0], [2.5, 0.2], all_minima=True, turn_limit=2)["minima"]]
        expected = sorted(math.hypot(around + 2 * PI * m, up) for m in range(-2, 3))
        self.assertEqual(len(lengths), len(expected))
        for found, length in zip(lengths, expected):
            self.assert_near(found, length)
        for m in (-3, 0, 1, 4):
            expected = math.hypot(around + 2 * PI * m, up)
            turned = self.geodesic("cylinder", [0, 0], [2.5, 0.2], turns=[m, 0])
            self.assert_proved(turned)
            self.assertEqual(turned["turns"], [m, 0])
            self.assert_near(turned["length"], expected)
            initial = {"polyline": [[0, 0], [1 + PI * m, 0.6], [2.5 + 2 * PI * m, 0.2]]}
            self.assert_near(self.geodesic("cylinder", [0, 0], [2.5, 0.2], initial=initial)["length"], expected)
        loop = self.geodesic("cylinder", [0, 0.5], [0, 0.5], turns=[1, 0])
        self.assert_near(loop["length"], 2 * PI)
        found = self.geodesic("wide", [0, 0.3], [1, 0.5], all_minima=True)["minima"]
        self.assertEqual(len({tuple(way["turns"]) for way in found}), 9)
        for length in (3.980, 7.198, 7.626, 13.836):
            self.assertTrue(any(abs(way["length"] - length) < 0.001 for way in found), length)

    def test_classes_of_paths_to_curves(self):
        """A path with given winding numbers crosses its curve as often as they require: on the
        cylinder it runs around the axis, at a right angle to the line of constant u."""
        line = {"iso": "u", "value": 2.5}
        for m in (-2, -1, 0, 3):
            for operation, ends in (("point-curve-distance", {"point": [0, 0.2], "curve": line}),
                                    ("curve-distance", {"a": {"iso": "u", "value": 0}, "b": line})):
                with self.subTest(m=m, operation=operation):
                    turned = self.ask("cylinder", operation, {**ends, "turns": [m, 0]})
                    self.assertEqual(turned["turns"], [m, 0])
                    self.assert_near(turned["length"], abs(2.5 + 2 * PI * m))

    def test_impossible_classes(self):
        good = {"from": [0, 0], "to": [2.5, 0.2]}
        for pointer, document in (
            ("/turns", {"turns": [0, 1]}), ("/turns", {"turns": [17, 0]}), ("/turns", {"turns": "once"}), ("/turn_limit", {"turn_limit": 5}),
            ("/initial", {"initial": {"polyline": [[0, 0], [1, 0.2]]}}), ("/initial/polyline/1", {"initial": {"polyline": [[0, 0], [1, 7]]}}),
            ("/turns", {"turns": [1, 0], "all_minima": True}), ("/initial", {"initial": {"iso": "v", "value": 0}, "turns": [1, 0]}),
        ):
            with self.subTest(document=document):
                status, code = (422, "point_not_on_surface") if pointer.endswith("1") else (400, "invalid_request")
                self.assertEqual(self.refusal("cylinder", "geodesic", {**good, **document}, status, code)["pointer"], pointer)

    def test_along_the_border(self):
        """The path around the hole of an annulus consists of two tangents and an arc of the rim."""
        answer = self.geodesic("annulus", [0, 0.1], [PI, 0.1])
        self.assert_near(answer["length"], 2 * math.sqrt(1.2**2 - 1) + PI - 2 * math.acos(1 / 1.2), 1e-9)
        self.assertTrue(answer["boundary_contact"])
        self.assertIn("boundary_contact", answer["warnings"])

    def test_where_a_path_leaves_the_border(self):
        """A path along the inner circle of an annulus leaves the circle within a span of the
        spline. The error estimate includes this span."""
        points = [[[r * x, r * y, 0] for r in (1, 3)] for x, y in CIRCLE]
        weights = [[circle_weight(i)] * 2 for i in range(9)]
        self.put("rational", {"degreeU": 2, "degreeV": 1, "knotsU": CIRCLE_KNOTS, "knotsV": [0, 0, 1, 1], "controlPoints": points, "weights": weights})
        for a, b in (([0.5659181666724791, 0.13800502163322748], [0.8902661815581756, 0.3509656940636081]),
                     ([0.4840698407562408, 0.1092219935104376], [0.907560516238983, 0.5140527790107382])):
            p, q = (point["xyz"] for point in self.ask("rational", "evaluate", {"uv": [a, b]})["points"])
            r, s = math.hypot(*p), math.hypot(*q)
            angle = (math.atan2(q[1], q[0]) - math.atan2(p[1], p[0])) % (2 * PI)
            expected = math.sqrt(r * r - 1) + math.sqrt(s * s - 1) + min(angle, 2 * PI - angle) - math.acos(1 / r) - math.acos(1 / s)
            for tolerance in (1e-5, 1e-7, 1e-9, 1e-11):
                answer = self.ask("rational", "path", {"from": a, "to": b, "tolerance": tolerance})
                self.assertLess(abs(answer["length"] - expected), answer["error_estimate"])
                self.assertLess(answer["error_estimate"], 10 * tolerance)

    def test_beside_a_pole(self):
        """If only a path through a pole is found, its error estimate includes the bend at the
        pole."""
        for off in (1e-7, 1e-9):
            a, b = [0.1, 1 - off], [0.45, 0.6]
            answer = self.ask("sphere", "path", {"from": a, "to": b})
            p, q = (point["xyz"] for point in self.ask("sphere", "evaluate", {"uv": [a, b]})["points"])
            self.assertLess(abs(answer["length"] - 2 * math.asin(math.dist(p, q) / 2)), answer["error_estimate"] + 1e-14)

    def test_a_dent_in_the_border(self):
        """The border y = 6 d^2 x^2 - x^4 has a dent of width 2 sqrt(3) d. The path crosses the dent
        on a straight line, although no control point of the spline wants to leave the border."""
        heights = lambda d: [6 * d * d * q - r for q, r in zip((1, 0, -1 / 3, 0, 1), (1, -1, 1, -1, 1))]
        for d in (0.05, 0.1):
            points = [[[x, y, 0], [x, y + 8, 0]] for x, y in zip((-1, -0.5, 0, 0.5, 1), heights(d))]
            self.put("dent", {"degreeU": 4, "degreeV": 1, "knotsU": [0] * 5 + [1] * 5, "knotsV": [0, 0, 1, 1], "controlPoints": points})
            speed = lambda x: math.hypot(1, 12 * d * d * x - 4 * x**3)
            rim, n = math.sqrt(3) * d, 2000
            step = (0.8 - rim) / n
            arc = step / 3 * sum(speed(rim + i * step) * (1 if i in (0, n) else 4 if i % 2 else 2) for i in range(n + 1))
            for tolerance in (1e-5, 1e-8, 1e-11):
                answer = self.ask("dent", "path", {"from": [0.1, 0], "to": [0.9, 0], "tolerance": tolerance})
                self.assertLess(abs(answer["length"] - 2 * (arc + rim)), answer["error_estimate"])

    def test_geometry_and_fields(self):
        ask = lambda options: self.ask("saddle", "geodesic", {"from": [0, 0], "to": [1, 1], "samples": 3}, options)
        self.assertEqual(set(ask("?select=length,ends")), {"length", "ends"})
        self.assertEqual(ask("?geometry=xyz&select=points")["points"][::2], [[0, 0, 0], [1, 1, 1]])
        self.assertNotIn("points", ask("?geometry=none"))
        self.assertEqual(ask("?select=ends"), {"ends": {"from": {"uv": [0, 0], "xyz": [0, 0, 0]}, "to": {"uv": [1, 1], "xyz": [1, 1, 1]}}})

    def test_from_a_place_to_itself(self):
        for a, b in (([0.5, 0.5], [0.5, 0.5]), ([0, 1], [2 * PI, 1 - 2 * PI])):
            name = "saddle" if a == b else "ring"
            answer = self.geodesic(name, a, b)
            self.assertEqual((answer["length"], answer["control_points"], answer["knots"], len(answer["points"])), (0, [], [], 1))
            self.assertTrue(answer["is_minimum"] and answer["converged"])

    def test_invalid_requests(self):
        good = {"from": [0, 0], "to": [1, 1]}
        for pointer, document in (
            ("/to", {"from": [0, 0]}), ("/from", {"from": 3, "to": [0, 0]}), ("/from", {"from": [1, 2, 3], "to": [0, 0]}),
            ("/degree", {**good, "degree": 1}), ("/degree", {**good, "degree": 6}), ("/control_points", {**good, "control_points": 3}),
            ("/control_points", {**good, "degree": 5, "control_points": 5}), ("/tolerance", {**good, "tolerance": 0}),
            ("/tolerance", {**good, "tolerance": 1e-15}), ("/all_minima", {**good, "all_minima": 1}), ("/samples", {**good, "samples": 1}),
            ("/samples", {**good, "samples": 20000}), ("/via", {**good, "via": [0, 0]}),
        ):
            with self.subTest(document=document):
                self.assertEqual(self.refusal("saddle", "geodesic", document)["pointer"], pointer)
        outside = self.refusal("saddle", "geodesic", {"from": [0, 0], "to": [1, 2]}, 422, "point_not_on_surface")
        self.assertEqual(outside["pointer"], "/to")
        self.assertEqual(self.post("saddle", "geodesic", good, If_Match='"stale"').status, 412)
        self.assertEqual(self.daemon.get("/v1/nurbs/saddle/geodesic").status, 405)


class Time(Nurbs):
    """A request that takes seconds ends when its client disconnects or its deadline passes."""

    flags = ("--workers", "2")
    surfaces = {"hills": bumps(60, 60, 0.3, 7)}
    HARD = {"a": wavy(2500, 0.25, 0.25, 0.2, 0.02, 40), "b": wavy(2500, 0.75, 0.75, 0.2, 0.02, 40), "all_minima": True, "tolerance": 1e-14}
    LATE = 1.0  # permitted delay in seconds on a busy machine; the whole request takes much longer

    def test_deadlines(self):
        for wanted in (1, 30, 100, 250):
            begun = time.monotonic()
            answer = self.post("hills", "curve-distance", self.HARD, f"?timeout_ms={wanted}")
            taken = time.monotonic() - begun
            self.assert_problem(answer, 504, "deadline_exceeded")
            self.assertLess(taken, wanted / 1000 + self.LATE)

    def test_cancelled_jobs(self):
        accepted = self.post("hills", "curve-distance", self.HARD, Prefer="respond-async")
        self.assertEqual(accepted.status, 202, accepted)
        place = accepted.headers["Location"]
        wait_until(lambda: self.daemon.get(place).json["state"] != "queued")
        time.sleep(0.1)
        self.assertEqual(self.daemon.get(place).json["state"], "running")
        begun = time.monotonic()
        self.assertEqual(self.daemon.request("DELETE", place).status, 204)
        while self.daemon.metric("workers_busy") > 0:
            self.assertLess(time.monotonic() - begun, self.LATE)
            time.sleep(0.002)

    def test_as_a_job(self):
        accepted = self.post("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]}, Prefer="respond-async")
        job = self.daemon.ended(accepted)
        self.assertEqual(job["state"], "done", job)
        self.assert_near(job["result"]["length"], self.ask("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]})["length"], 1e-15)

    def test_memory_is_returned(self):
        self.ask("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]})
        self.post("hills", "curve-distance", self.HARD, "?timeout_ms=50")
        self.ask("hills", "nearest", {"xyz": [1, 2, 3]})
        self.ask("hills", "evaluate", {"uv": [[0.1, 0.1]] * 5000})
        self.post("hills", "tessellate", {"mesh": "hills", "resolution": [20, 20]})
        self.daemon.wait_for_flight()


if __name__ == "__main__":
    unittest.main()
