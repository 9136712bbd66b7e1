"""NURBS and other parametric surfaces: the resource, evaluation, shortest paths against closed forms, tessellations that remember (u, v)."""
import array
import functools
import json
import math
import random
import time
import unittest

from harness import SQUARE, Folder, TestCase, header_fields
from test_access import Keyed, digest, key_of, line

PI = math.pi
JSON = {"Content-Type": "application/json"}

# --- surfaces ------------------------------------------------------------------------------------------------------------

CIRCLE = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
CIRCLE_KNOTS = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]


def circle_weight(i):
    return math.sqrt(0.5) if i % 2 else 1


def rational_torus(major=2, minor=1):
    """A torus of 9 x 9 control points: u around the axis, v around the tube."""
    points = [[[(major + minor * c) * x, (major + minor * c) * y, minor * s] for c, s in CIRCLE] for x, y in CIRCLE]
    weights = [[circle_weight(i) * circle_weight(j) for j in range(9)] for i in range(9)]
    return {"degreeU": 2, "degreeV": 2, "knotsU": CIRCLE_KNOTS, "knotsV": CIRCLE_KNOTS, "controlPoints": points, "weights": weights}


def rational_sphere():
    """The unit sphere: v from the south pole to the north pole."""
    profile = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)]
    points = [[[r * x, r * y, h] for r, h in profile] for x, y in CIRCLE]
    weights = [[circle_weight(i) * circle_weight(j) for j in range(5)] for i in range(9)]
    return {"degreeU": 2, "degreeV": 2, "knotsU": CIRCLE_KNOTS, "knotsV": [0, 0, 0, 0.5, 0.5, 1, 1, 1], "controlPoints": points,
            "weights": weights}


def clamped(count, degree):
    inner = count - degree
    return [0] * degree + [i / inner for i in range(inner + 1)] + [1] * degree


def bumps(rows, columns, height, seed):
    """An open bicubic B-spline over cells of size 1."""
    chance = random.Random(seed)
    points = [[[i, j, chance.uniform(-height, height)] for j in range(columns)] for i in range(rows)]
    return {"degreeU": 3, "degreeV": 3, "knotsU": clamped(rows, 3), "knotsV": clamped(columns, 3), "controlPoints": points}


SADDLE = {"degreeU": 1, "degreeV": 1, "knotsU": [0, 0, 1, 1], "knotsV": [0, 0, 1, 1],
          "controlPoints": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]]}
TORUS = {"parametric": {"torus": {"major": 2, "minor": 1}}}
PLANE = {"parametric": {"graph": {"coefficients": [[0]], "u": [-4, 4], "v": [-4, 4]}}}
HELICOID = {"parametric": {"helicoid": {"pitch": 0.5, "u": [0, 6], "v": [-1, 2]}}}


def revolution(*points):
    return {"parametric": {"revolution": {"degree": 1, "knots": [0, *range(len(points)), len(points) - 1], "control_points": points}}}


CYLINDER = revolution([1, 0], [1, 5])
CONE = revolution([1, 0], [2, 3])
ANNULUS = revolution([1, 0], [3, 0])


# --- an evaluation of its own --------------------------------------------------------------------------------------------


def spline_at(degree, knots, points, t):
    """De Boor's algorithm."""
    span = max(i for i in range(degree, len(points)) if knots[i] <= t and knots[i] < knots[i + 1])
    d = [points[span - degree + i] for i in range(degree + 1)]
    for r in range(1, degree + 1):
        for i in range(degree, r - 1, -1):
            k = span - degree + i
            a = (t - knots[k]) / (knots[k + degree - r + 1] - knots[k])
            d[i] = [(1 - a) * x + a * y for x, y in zip(d[i - 1], d[i])]
    return d[degree]


def torus_at(u, v, major=2, minor=1):
    return [(major + minor * math.cos(v)) * math.cos(u), (major + minor * math.cos(v)) * math.sin(u), minor * math.sin(v)]


def wavy(count, u, v, radius, amplitude, waves):
    """A closed polyline around (u, v)."""
    corners = []
    for i in range(count):
        t = 2 * PI * i / count
        r = radius + amplitude * math.sin(waves * t)
        corners.append([u + r * math.cos(t), v + r * math.sin(t)])
    return {"polyline": corners, "closed": True}


class Nurbs(TestCase):
    surfaces = {}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.descriptions = {}
        for name, body in cls.surfaces.items():
            answer = cls.put(name, body)
            assert answer.status == 201, answer
            cls.descriptions[name] = answer.json

    @classmethod
    def put(cls, name, body, options="", **headers):
        text = body if isinstance(body, (str, bytes)) else json.dumps(body)
        return cls.daemon.request("PUT", f"/v1/nurbs/{name}{options}", text, header_fields(headers))

    def post(self, name, query, document, options="", **headers):
        return self.daemon.request("POST", f"/v1/nurbs/{name}/{query}{options}", json.dumps(document), {**JSON, **header_fields(headers)})

    def ask(self, name, query, document, options=""):
        answer = self.post(name, query, document, options)
        self.assertEqual(answer.status, 200, answer)
        return answer.json

    def refusal(self, name, query, document, status=400, code="invalid_request"):
        return self.assert_problem(self.post(name, query, document), status, code)

    def assert_near(self, found, expected, tolerance=1e-10):
        self.assertLessEqual(abs(found - expected), tolerance * max(1, abs(expected)), (found, expected))

    def assert_close(self, found, expected, tolerance=1e-12):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), tolerance, (found, expected))


class Resource(Nurbs):
    surfaces = {"torus": rational_torus(), "ring": TORUS, "sphere": rational_sphere(), "bumps": bumps(8, 4, 0.5, 1)}

    def test_the_examples_of_the_contract(self):
        paths = self.daemon.get("/openapi.json").json
        body = paths["components"]["requestBodies"]["NurbsFile"]["content"]["application/json"]["examples"]
        for name, example in body.items():
            self.assertIn(self.put(f"example-{name}", example["value"]).status, (200, 201))
        told = paths["components"]["examples"]["Sheet"]["value"]
        found = self.daemon.get("/v1/nurbs/example-sheet").json
        for key in ("sha256", "created", "etag", "memory_bytes", "name"):
            told.pop(key), found.pop(key)
        self.assertEqual(found, told)
        for query in ("evaluate", "nearest", "geodesic", "point-curve-distance", "curve-distance"):
            operation = paths["paths"][f"/v1/nurbs/{{name}}/{query}"]["post"]
            request = operation["requestBody"]["content"]["application/json"]["example"]
            answer = self.ask("example-sheet", query, request)
            told = operation["responses"]["200"]["content"]["application/json"].get("example")
            if query == "evaluate":
                for key, value in told["points"][0].items():
                    pairs = zip(value, answer["points"][0][key]) if isinstance(value, list) else [(value, answer["points"][0][key])]
                    for a, b in pairs:
                        self.assertAlmostEqual(a, b, 12, key)
            elif told:
                self.assertEqual(set(answer), set(told))

    def test_descriptions(self):
        torus, ring, sphere, open_ = (self.descriptions[name] for name in ("torus", "ring", "sphere", "bumps"))
        self.assertEqual((torus["shape"], torus["degree"], torus["control_points"], torus["rational"]), ("nurbs", [2, 2], [9, 9], True))
        self.assertEqual((ring["shape"], "degree" in ring, open_["rational"]), ("torus", False, False))
        for direction in "uv":
            self.assertEqual((torus["domain"][direction]["closed"], torus["domain"][direction]["pieces"]), (True, 4))
            self.assertEqual((ring["domain"][direction]["range"], ring["domain"][direction]["pieces"]), ([0, 2 * PI], 1))
            self.assertFalse(open_["domain"][direction]["closed"])
        self.assertEqual((sphere["domain"]["v"]["pole_low"], sphere["domain"]["v"]["pole_high"], sphere["domain"]["u"]["closed"]), (True,) * 3)
        self.assertTrue(all(d["geodesics"] and d["seeding_faces"] > 1000 for d in (torus, ring, sphere, open_)))

    def test_life(self):
        created = self.put("life", SADDLE)
        self.assertEqual((created.status, created.headers["Location"]), (201, "/v1/nurbs/life"))
        again = self.put("life", SADDLE)
        self.assertEqual((again.status, again.headers["ETag"]), (200, created.headers["ETag"]))
        replaced = self.put("life", bumps(5, 5, 0.1, 2))
        self.assertEqual(replaced.status, 200)
        self.assertNotEqual(replaced.headers["ETag"], created.headers["ETag"])
        self.assertEqual(self.put("life", SADDLE, If_None_Match="*").status, 412)
        self.assertEqual(self.daemon.get("/v1/nurbs/life", If_None_Match=replaced.headers["ETag"]).status, 304)
        self.assertEqual(self.daemon.request("HEAD", "/v1/nurbs/life").headers["ETag"], replaced.headers["ETag"])
        names = [surface["name"] for surface in self.daemon.get("/v1/nurbs?limit=1000").json["nurbs"]]
        self.assertEqual(names, sorted(names))
        self.assertLessEqual({"life", "torus", "ring"}, set(names))
        self.assertEqual(self.daemon.request("DELETE", "/v1/nurbs/life").status, 204)
        self.assert_problem(self.daemon.get("/v1/nurbs/life"), 404, "not_found")
        self.assertIn("NURBS", self.assert_problem(self.post("life", "evaluate", {"uv": [[0, 0]]}), 404, "not_found")["detail"])

    def test_kinds_have_names_of_their_own(self):
        self.assertEqual(self.daemon.put("torus", SQUARE).status, 201)
        self.assertEqual(self.daemon.get("/v1/nurbs/torus").json["shape"], "nurbs")
        self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/torus").status, 204)
        self.assertEqual(self.daemon.get("/v1/nurbs/torus").status, 200)

    def test_a_name_made_from_the_content(self):
        body = json.dumps(bumps(6, 5, 0.2, 9))
        answer = self.daemon.request("POST", "/v1/nurbs", body)
        self.assertEqual(answer.status, 201, answer)
        self.assertEqual(answer.headers["Location"], f"/v1/nurbs/{answer.json['sha256'][:32]}")
        self.assertEqual(self.daemon.request("POST", "/v1/nurbs", body).status, 200)

    def test_conventions(self):
        """The torus as other programs store it is the same surface."""
        canonical = rational_torus()
        flat = [[(point, weight) for point, weight in zip(*rows)] for rows in zip(canonical["controlPoints"], canonical["weights"])]
        multiplied = [[[weight * x for x in point] for point, weight in row] for row in flat]
        less = {"knotsU": CIRCLE_KNOTS[1:-1], "knotsV": CIRCLE_KNOTS[1:-1]}
        joined = lambda rows: [[[*point, weight] for point, (_, weight) in zip(a, b)] for a, b in zip(rows, flat)]
        bare = {key: value for key, value in canonical.items() if key != "weights"}
        forms = {
            "three": {**bare, "controlPoints": joined(canonical["controlPoints"]), "convention": "three"},
            "verb": {**canonical, "controlPoints": multiplied, "convention": "verb"},
            "rhino": {**bare, **less, "controlPoints": joined(multiplied), "convention": "rhino"},
        }
        places = {"uv": [[0.3, 0.7], [0.1, 0.9], [0.25, 0.5]]}
        expected = self.ask("torus", "evaluate", places)["points"]
        for name, form in forms.items():
            for options, body in (("", form), (f"?convention={name}", {k: v for k, v in form.items() if k != "convention"})):
                answer = self.put(f"as-{name}", body, options)
                self.assertIn(answer.status, (200, 201), answer)
                self.assertEqual((answer.json["convention"], answer.json["domain"]), (name, self.descriptions["torus"]["domain"]))
                for found, point in zip(self.ask(f"as-{name}", "evaluate", places)["points"], expected):
                    self.assert_close(found["xyz"], point["xyz"], 1e-14)
                    self.assert_close(found["duv"], point["duv"], 1e-11)
        clash = self.put("clash", {**canonical, "convention": "verb"}, "?convention=rhino")
        self.assertEqual(self.assert_problem(clash, 400, "invalid_request")["pointer"], "/convention")

    def test_refused_by_name(self):
        good = bumps(5, 5, 0.1, 3)
        spoil = lambda **changes: {**good, **changes}
        ones = [[1] * 5 for _ in range(5)]
        knots = good["knotsU"]
        far = json.loads(json.dumps(good["controlPoints"]))
        far[2][2][0] = 1e300
        for reason, body in {
            "decreasing_knots": spoil(knotsU=knots[:5] + [-1] + knots[6:]),
            "weight": spoil(weights=[[1] * 5] * 4 + [[1, 1, 1, 1, 0]]),
            "knot_count": spoil(knotsV=knots + [1]),
            "knot_multiplicity": {**bumps(8, 5, 0.1, 3), "knotsU": [0, 0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1, 1]},
            "degree": spoil(degreeU=0),
            "control_count": spoil(degreeV=5),
            "empty_domain": spoil(knotsU=[0] * 9),
            "extent": spoil(controlPoints=far),
            "trimmed": spoil(trimmingLoops=[]),
        }.items():
            with self.subTest(reason=reason):
                problem = self.assert_problem(self.put("refused", body), 422, "invalid_mesh")
                self.assertEqual(problem["reason"], reason)
        self.assertEqual(self.put("weighed", spoil(weights=ones)).json["rational"], False)

    def test_files_that_can_not_be_read(self):
        good = bumps(4, 4, 0.1, 3)
        points = good["controlPoints"]
        for pointer, body in (
            ("", b""), ("", b"{"), ("", b"\xff\x00"), ("", b"[]"), ("", SQUARE), ("/degreeU", {}), ("/colour", {**good, "colour": 1}),
            ("/degreeU", {**good, "degreeU": -1}), ("/degreeV", {**good, "degreeV": 2.5}), ("/knotsU", {**good, "knotsU": 3}),
            ("/knotsV/2", {**good, "knotsV": [0, 0, "x", 0, 1, 1, 1, 1]}), ("/controlPoints", {**good, "controlPoints": []}),
            ("/controlPoints/2", {**good, "controlPoints": points[:2] + [points[2][:3]] + points[3:]}),
            ("/controlPoints/1/0", {**good, "controlPoints": points[:1] + [[[0, 0]] + points[1][1:]] + points[2:]}),
            ("/controlPoints/3/3", {**good, "controlPoints": points[:3] + [points[3][:3] + [[0, 0, 0, 1]]]}),
            ("/weights", {**good, "weights": [[1]]}), ("/weights/1", {**good, "weights": [[1, 1, 1, 1], [1, 1, None, 1]] + [[1] * 4] * 2}),
            ("/convention", {**good, "convention": "nurbs++"}), ("/parametric", {"parametric": {}}),
            ("/parametric/cube", {"parametric": {"cube": {}}}), ("/parametric/torus/minor", {"parametric": {"torus": {"major": 1}}}),
            ("/parametric/torus", {"parametric": {"torus": {"major": 1, "minor": 2}}}), ("/degreeU", {"parametric": {}, "degreeU": 1}),
            ("/parametric/helicoid", {"parametric": {"helicoid": {"pitch": 0, "u": [0, 1], "v": [0, 1]}}}),
            ("/parametric/helicoid/u", {"parametric": {"helicoid": {"pitch": 1, "u": [0], "v": [0, 1]}}}),
            ("/parametric/graph/coefficients", {"parametric": {"graph": {"coefficients": [[1], []], "u": [0, 1], "v": [0, 1]}}}),
            ("/parametric/graph", {"parametric": {"graph": {"coefficients": [[1]], "u": [1, 1], "v": [0, 1]}}}),
            ("/parametric/revolution/knots", {"parametric": {"revolution": {"degree": 1, "knots": [0, 1], "control_points": [[1, 0], [1, 1]]}}}),
            ("/parametric/revolution", revolution([1, 0], [-1, 1])),
        ):
            with self.subTest(body=str(body)[:80]):
                problem = self.assert_problem(self.put("unread", body), 400, "invalid_request")
                self.assertEqual(problem["pointer"], pointer)
        self.assertEqual(self.assert_problem(self.put("unread", TORUS, "?convention=verb"), 400, "invalid_request")["parameter"], "convention")
        self.assertEqual(self.assert_problem(self.put("unread", SADDLE, "?weld=1"), 400, "invalid_request")["parameter"], "weld")
        self.assert_problem(self.daemon.get("/v1/nurbs/unread"), 404, "not_found")

    def test_without_a_tessellation(self):
        """A surface with a part that is one line can be evaluated; paths on it are refused, and why is said."""
        folded = {"degreeU": 1, "degreeV": 1, "knotsU": [0, 0, 1, 2, 2], "knotsV": [0, 0, 1, 1],
                  "controlPoints": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]], [[1, 0, 0], [1, 1, 0]]]}
        answer = self.put("folded", folded)
        self.assertEqual((answer.status, answer.json["geodesics"], "seeding_faces" in answer.json), (201, False, False), answer)
        self.assertEqual(self.ask("folded", "evaluate", {"uv": [[0.5, 0.5]]})["points"][0]["xyz"], [0.5, 0.5, 0])
        problem = self.refusal("folded", "geodesic", {"from": [0, 0], "to": [1, 1]}, 422, "invalid_mesh")
        self.assertEqual(problem["reason"], answer.json["reason"])


class Evaluation(Nurbs):
    surfaces = {"torus": rational_torus(), "ring": TORUS, "sphere": rational_sphere(), "saddle": SADDLE, "bumps": bumps(8, 4, 0.5, 1),
                "hills": bumps(8, 8, 3, 5)}

    def test_the_rational_torus(self):
        [point] = self.ask("torus", "evaluate", {"uv": [[0.3, 0.7]]})["points"]
        self.assert_close(point["xyz"], [-0.501298420681, 1.630882459688, -0.955863246107])
        self.assert_close(point["du"], [-10.179771947727, -3.129044383289, 0], 1e-11)
        self.assert_close(point["dv"], [-1.752994636132, 5.703046500942, -1.833938738906], 1e-11)
        self.assert_close(point["duv"], [-35.597729586211, -10.941981450229, 0], 1e-11)
        [point] = self.ask("sphere", "evaluate", {"uv": [[0.3, 0.7]]})["points"]
        self.assert_close(point["xyz"], [-0.239111804612, 0.777906396586, 0.581108581115])
        self.assert_near(point["gaussian_curvature"], 1, 1e-12)
        self.assert_near(abs(point["mean_curvature"]), 1, 1e-12)

    def test_the_torus(self):
        chance = random.Random(1)
        places = [[chance.uniform(-9, 9), chance.uniform(-9, 9)] for _ in range(3000)]
        points = self.ask("ring", "evaluate", {"uv": places})["points"]
        self.assertEqual(len(points), 3000)
        for (u, v), point in zip(places, points):
            self.assert_close(point["xyz"], torus_at(u, v), 1e-14)
            self.assert_close(point["normal"], [math.cos(v) * math.cos(u), math.cos(v) * math.sin(u), math.sin(v)], 1e-13)
            self.assert_near(point["gaussian_curvature"], math.cos(v) / (2 + math.cos(v)), 1e-12)

    def test_derivatives_are_those_of_the_position(self):
        h = 1e-5
        for name in ("torus", "bumps"):
            u, v = 0.31, 0.62
            steps = [[u, v], [u + h, v], [u - h, v], [u, v + h], [u, v - h]]
            x, ahead, behind, above, below = self.ask(name, "evaluate", {"uv": steps})["points"]
            for key, second, plus, minus in (("du", "duu", ahead, behind), ("dv", "dvv", above, below)):
                for k in range(3):
                    self.assertAlmostEqual((plus["xyz"][k] - minus["xyz"][k]) / (2 * h), x[key][k], 6)
                    self.assertAlmostEqual((plus[key][k] - minus[key][k]) / (2 * h), x[second][k], 5)
            for k in range(3):
                self.assertAlmostEqual((above["du"][k] - below["du"][k]) / (2 * h), x["duv"][k], 5)

    def test_at_a_pole(self):
        [point] = self.ask("sphere", "evaluate", {"uv": [[0.3, 1]]})["points"]
        self.assertEqual((point["normal"], point["gaussian_curvature"], point["mean_curvature"]), (None, None, None))
        self.assert_close(point["xyz"], [0, 0, 1], 1e-15)

    def test_fields(self):
        answer = self.ask("saddle", "evaluate", {"uv": [[0, 0], [1, 1]]}, "?fields=points,xyz,du")
        self.assertEqual(answer, {"points": [{"xyz": [0, 0, 0], "du": [1, 0, 0]}, {"xyz": [1, 1, 1], "du": [1, 0, 1]}]})

    def test_places_that_can_not_be(self):
        problem = self.refusal("saddle", "evaluate", {"uv": [[0, 0], [0.5, 1.5]]}, 422, "point_not_on_surface")
        self.assertEqual(problem["pointer"], "/uv/1")
        for pointer, document in (("/uv", {}), ("/uv", {"uv": []}), ("/uv/1", {"uv": [[0, 0], [1]]}), ("/uv/0", {"uv": [["a", 0]]}),
                                  ("/u", {"uv": [[0, 0]], "u": 1})):
            self.assertEqual(self.refusal("saddle", "evaluate", document)["pointer"], pointer)

    def test_nearest(self):
        """The global one: from random points the distance to the torus has a closed form."""
        chance = random.Random(2)
        for _ in range(60):
            x, y, z = (chance.uniform(-4, 4) for _ in range(3))
            expected = abs(math.hypot(math.hypot(x, y) - 2, z) - 1)
            for name in ("torus", "ring"):
                foot = self.ask(name, "nearest", {"xyz": [x, y, z]})
                self.assert_near(foot["distance"], expected, 1e-12)
                [point] = self.ask(name, "evaluate", {"uv": [foot["uv"]]})["points"]
                self.assert_close(point["xyz"], foot["xyz"], 1e-12)
        self.assertEqual(self.refusal("ring", "nearest", {"xyz": [1, 2]})["pointer"], "/xyz")

    def test_nearest_of_several(self):
        """Over hills and valleys there are several places to which the way is at right angles: no sample is nearer than the answer."""
        samples = [[i / 60, j / 60] for i in range(61) for j in range(61)]
        points = [point["xyz"] for point in self.ask("hills", "evaluate", {"uv": samples}, "?fields=points,xyz")["points"]]
        chance = random.Random(4)
        for _ in range(30):
            xyz = [chance.uniform(0, 7), chance.uniform(0, 7), chance.uniform(3, 9)]
            found = self.ask("hills", "nearest", {"xyz": xyz})["distance"]
            least = min(math.dist(xyz, point) for point in points)
            self.assertLessEqual(found, least + 1e-12)
            self.assertLess(least - found, 0.1)


class Geodesics(Nurbs):
    surfaces = {"ring": TORUS, "torus": rational_torus(), "sphere": rational_sphere(), "saddle": SADDLE, "plane": PLANE,
                "cylinder": CYLINDER, "cone": CONE, "annulus": ANNULUS, "bumps": bumps(8, 4, 0.5, 1), "helicoid": HELICOID}

    def geodesic(self, name, a, b, **options):
        return self.ask(name, "geodesic", {"from": a, "to": b, **options})

    def assert_proved(self, answer):
        self.assertTrue(answer["converged"] and answer["is_minimum"] and not answer["boundary_contact"], answer["warnings"])
        self.assertLess(answer["residual"], 1e-8)
        self.assertLess(answer["error_estimate"], 1e-10 * max(1, answer["length"]))

    def test_closed_forms(self):
        at = lambda u, v: [u, v]
        straight = lambda u, v, r: math.hypot(r * u, v)
        apex = math.hypot(1, 3)  # of the cone: its slant from the apex to v = 0; the slant to v is (1 + v) apex
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

    def test_the_sphere(self):
        """Great circles, beside the poles and through one."""
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
        """The B-spline of the answer is what its points are of, and is as long as it says."""
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
        self.assertEqual(len(pole), 3)  # both ends, and the pole

    def test_as_the_paper(self):
        """One B-spline of so many control points: errors fall, and the curve is never shorter than the shortest."""
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
        """Around the cylinder there are two ways, and the straight line is not always the only one on a torus."""
        answer = self.geodesic("cylinder", [0, 0], [2.5, 0.2], all_minima=True)
        lengths = [way["length"] for way in answer["minima"]]
        for k, found in enumerate(lengths[:2]):
            self.assert_near(found, math.hypot((2.5, 2 * PI - 2.5)[k], 1))
        self.assertEqual(lengths, sorted(lengths))
        self.assertEqual(answer["length"], lengths[0])
        self.assertTrue(all(way["is_minimum"] for way in answer["minima"]))
        self.assertNotIn("minima", self.geodesic("cylinder", [0, 0], [2.5, 0.2]))

    def test_along_the_border(self):
        """Around the hole of an annulus: two tangents and an arc of its rim."""
        answer = self.geodesic("annulus", [0, 0.1], [PI, 0.1])
        self.assert_near(answer["length"], 2 * math.sqrt(1.2**2 - 1) + PI - 2 * math.acos(1 / 1.2), 1e-9)
        self.assertTrue(answer["boundary_contact"])
        self.assertIn("boundary_contact", answer["warnings"])

    def test_geometry_and_fields(self):
        ask = lambda options: self.ask("saddle", "geodesic", {"from": [0, 0], "to": [1, 1], "samples": 3}, options)
        self.assertEqual(set(ask("?fields=length,ends")), {"length", "ends"})
        self.assertEqual(ask("?geometry=xyz&fields=points")["points"][::2], [[0, 0, 0], [1, 1, 1]])
        self.assertNotIn("points", ask("?geometry=none"))
        self.assertEqual(ask("?fields=ends"), {"ends": {"from": {"uv": [0, 0], "xyz": [0, 0, 0]}, "to": {"uv": [1, 1], "xyz": [1, 1, 1]}}})

    def test_the_same_place(self):
        for a, b in (([0.5, 0.5], [0.5, 0.5]), ([0, 1], [2 * PI, 1 - 2 * PI])):
            name = "saddle" if a == b else "ring"
            answer = self.geodesic(name, a, b)
            self.assertEqual((answer["length"], answer["control_points"], answer["knots"], len(answer["points"])), (0, [], [], 1))
            self.assertTrue(answer["is_minimum"] and answer["converged"])

    def test_requests_that_can_not_be(self):
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


class Curves(Nurbs):
    surfaces = {"plane": PLANE, "ring": TORUS, "torus": rational_torus(), "cylinder": CYLINDER, "bumps": bumps(8, 4, 0.5, 1),
                "saddle": SADDLE}

    CIRCLE = {"bspline": {"degree": 3, "knots": list(range(-3, 12)), "control_points": [
        [math.cos(PI * i / 4), math.sin(PI * i / 4)] for i in range(11)]}, "closed": True}

    @staticmethod
    @functools.cache
    def near_circle(count=200000):
        """Points of the closed cubic above, which is nearly a circle."""
        spline = Curves.CIRCLE["bspline"]
        return [spline_at(3, spline["knots"], spline["control_points"], 8 * i / count) for i in range(0, count, 100)]

    def end(self, answer, which, expected, tolerance=1e-9):
        self.assert_close(answer["ends"][which]["uv"], expected, tolerance)

    def test_the_nearer_side_of_a_circle(self):
        """The farthest point meets it at a right angle too; it is never the answer."""
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
        """`closed` is an edge more; without it the curve is open there."""
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
        """A helix around the cylinder, nearest to a point from all its turns."""
        helix = {"polyline": [[0, 0.1], [6 * PI, 0.9]]}
        answer = self.ask("cylinder", "point-curve-distance", {"point": [1, 0.5], "curve": helix})
        slope = 4 / (6 * PI)  # of the helix in the unrolled plane
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
        """No pair of points of the two curves is nearer; some are nearly as near."""
        a, b = wavy(24, 0.25, 0.4, 0.15, 0.02, 5), wavy(24, 0.75, 0.6, 0.15, 0.02, 5)
        answer = self.ask("bumps", "curve-distance", {"a": a, "b": b})
        corners = lambda curve: curve["polyline"][::3]
        least = min(self.ask("bumps", "geodesic", {"from": p, "to": q}, "?fields=length")["length"] for p in corners(a) for q in corners(b))
        self.assertLessEqual(answer["length"], least + 1e-10)
        self.assertGreater(answer["length"], 0.7 * least)
        back = self.ask("bumps", "curve-distance", {"a": b, "b": a})
        self.assert_near(back["length"], answer["length"], 1e-11)
        self.assert_close(back["ends"]["b"]["xyz"], answer["ends"]["a"]["xyz"], 1e-6)

    def test_curves_that_can_not_be(self):
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


class Time(Nurbs):
    """Work of seconds ends when it is not wanted any more."""

    flags = ("--workers", "2")
    surfaces = {"hills": bumps(60, 60, 0.3, 7)}
    HARD = {"a": wavy(2500, 0.25, 0.25, 0.2, 0.02, 40), "b": wavy(2500, 0.75, 0.75, 0.2, 0.02, 40), "all_minima": True, "tolerance": 1e-14}
    LATE = 1.0  # seconds of patience with a machine that does other things; the whole takes many

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
        until = time.monotonic() + 30
        while self.daemon.get(place).json["state"] == "queued":
            self.assertLess(time.monotonic(), until)
            time.sleep(0.002)
        time.sleep(0.1)
        self.assertEqual(self.daemon.get(place).json["state"], "running")
        begun = time.monotonic()
        self.assertEqual(self.daemon.request("DELETE", place).status, 204)
        while self.daemon.metric("workers_busy") > 0:
            self.assertLess(time.monotonic() - begun, self.LATE)
            time.sleep(0.002)

    def test_as_a_job(self):
        accepted = self.post("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]}, Prefer="respond-async")
        until = time.monotonic() + 30
        while (job := self.daemon.get(accepted.headers["Location"]).json)["state"] in ("queued", "running"):
            self.assertLess(time.monotonic(), until)
            time.sleep(0.01)
        self.assertEqual(job["state"], "done", job)
        self.assert_near(job["result"]["length"], self.ask("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]})["length"], 1e-15)

    def test_memory_is_given_back(self):
        flight = lambda: self.daemon.get("/metrics").body.decode().split('memory_bytes{class="flight"} ')[1].split("\n")[0]
        self.ask("hills", "geodesic", {"from": [0.45, 0.5], "to": [0.55, 0.5]})
        self.post("hills", "curve-distance", self.HARD, "?timeout_ms=50")
        self.ask("hills", "nearest", {"xyz": [1, 2, 3]})
        self.ask("hills", "evaluate", {"uv": [[0.1, 0.1]] * 5000})
        self.post("hills", "tessellate", {"mesh": "hills", "resolution": [20, 20]})
        until = time.monotonic() + 30
        while flight() != "0":
            self.assertLess(time.monotonic(), until, flight())
            time.sleep(0.01)


class Tessellations(Nurbs):
    surfaces = {"ring": TORUS, "torus": rational_torus(), "sphere": rational_sphere(), "saddle": SADDLE, "bumps": bumps(8, 4, 0.5, 1)}

    def tessellate(self, name, status=201, **document):
        answer = self.post(name, "tessellate", document)
        self.assertEqual(answer.status, status, answer)
        return answer

    def vertices(self, mesh):
        text = self.daemon.get(f"/v1/meshes/{mesh}/content?format=obj").body.decode()
        return [tuple(map(float, row.split()[1:])) for row in text.splitlines() if row.startswith("v ")]

    def test_vertices_remember_their_places(self):
        for name in self.surfaces:
            with self.subTest(name=name):
                made = self.tessellate(name, mesh=f"{name}-mesh", resolution=[12, 10])
                self.assertEqual(made.headers["Location"], f"/v1/meshes/{name}-mesh")
                self.assertEqual(made.json, self.daemon.get(f"/v1/meshes/{name}-mesh").json)
                self.assertEqual(made.headers["ETag"].strip('"'), made.json["etag"])
                answer = self.daemon.get(f"/v1/meshes/{name}-mesh/parameters")
                told = answer.json
                self.assertEqual(answer.headers["ETag"], made.headers["ETag"])
                self.assertEqual(told["nurbs"], {"name": name, "etag": self.descriptions[name]["etag"]})
                self.assertEqual(len(told["uv"]), made.json["index_count"])
                points = self.ask(name, "evaluate", {"uv": told["uv"]}, "?fields=points,xyz")["points"]
                for vertex, point in zip(self.vertices(f"{name}-mesh"), points):
                    self.assert_close(point["xyz"], vertex, 1e-15)

    def test_closed_directions_and_poles(self):
        count = lambda name, m, n: self.tessellate(name, mesh="counted", resolution=[m, n], status=self.status()).json
        self.made = False
        ring = count("ring", 12, 10)
        self.assertEqual((ring["vertices"], ring["faces"], ring["genus"], ring["boundaries"]), (120, 240, 1, []))
        self.assertEqual(self.daemon.get("/v1/meshes/counted/parameters").json["periods"], [2 * PI, 2 * PI])
        ball = count("sphere", 12, 10)
        self.assertEqual((ball["vertices"], ball["faces"], ball["euler_characteristic"]), (12 * 9 + 2, 12 * 18, 2))
        self.assertEqual(self.daemon.get("/v1/meshes/counted/parameters").json["periods"], [1, None])
        sheet = count("saddle", 3, 5)
        self.assertEqual((sheet["vertices"], sheet["faces"]), (24, 30))

    def status(self):
        """201 the first time, 200 when the name has a mesh."""
        made, self.made = self.made, True
        return 200 if made else 201

    def test_tolerance(self):
        """Middles of edges are about as near as asked for, and the finer the nearer."""
        counts = []
        for tolerance in (0.1, 0.01, 0.001):
            made = self.tessellate("ring", 201 if tolerance == 0.1 else 200, mesh="fine", tolerance=tolerance).json
            counts.append(made["faces"])
            text = self.daemon.get("/v1/meshes/fine/content?format=obj").body.decode().splitlines()
            vertices = [tuple(map(float, row.split()[1:])) for row in text if row.startswith("v ")]
            faces = [[int(i) - 1 for i in row.split()[1:]] for row in text if row.startswith("f ")]
            worst = 0
            for a, b, c in faces:
                for i, j in ((a, b), (b, c), (c, a)):
                    x, y, z = ((p + q) / 2 for p, q in zip(vertices[i], vertices[j]))
                    worst = max(worst, abs(math.hypot(math.hypot(x, y) - 2, z) - 1))
            self.assertLess(worst, 1.5 * tolerance)
        self.assertLess(counts[0] * 5, counts[1])
        self.assertLess(counts[1] * 5, counts[2])

    def test_the_mesh_is_a_mesh(self):
        """Its distances come near those of the surface, from above or below by the square of its edges."""
        self.tessellate("ring", mesh="near", resolution=[160, 80])
        uv = self.daemon.get("/v1/meshes/near/parameters").json["uv"]
        to = min(range(len(uv)), key=lambda i: math.dist(uv[i], [PI / 2, PI / 2]))
        self.assert_close(uv[to], [PI / 2, PI / 2], 1e-12)
        distance = self.daemon.get(f"/v1/meshes/near/distance?from=v:{uv.index([0, 0])}&to=v:{to}").json["distance"]
        self.assertLess(abs(distance / 4.0618928974654 - 1), 2e-3)

    def test_float64(self):
        self.tessellate("bumps", mesh="packed", resolution=[6, 5])
        whole = self.daemon.get("/v1/meshes/packed/parameters").json["uv"]
        packed = array.array("d", self.daemon.get("/v1/meshes/packed/parameters", Accept="application/octet-stream").body)
        self.assertEqual(list(packed), [x for pair in whole for x in pair])
        self.assertEqual(set(self.daemon.get("/v1/meshes/packed/parameters?fields=periods").json), {"periods"})

    def test_only_of_tessellations(self):
        self.tessellate("saddle", mesh="taken", resolution=[4, 4])
        self.assertEqual(self.daemon.get("/v1/meshes/taken/parameters").status, 200)
        self.assertEqual(self.daemon.put("taken", SQUARE).status, 200)
        self.assert_problem(self.daemon.get("/v1/meshes/taken/parameters"), 404, "not_found")
        self.assert_problem(self.daemon.get("/v1/meshes/nowhere/parameters"), 404, "not_found")

    def test_requests_that_can_not_be(self):
        for pointer, document in (
            ("", {"mesh": "m"}), ("", {"mesh": "m", "tolerance": 1, "resolution": [4, 4]}), ("/mesh", {"tolerance": 1}),
            ("/mesh", {"mesh": 3, "tolerance": 1}), ("/mesh", {"mesh": "a b", "tolerance": 1}), ("/tolerance", {"mesh": "m", "tolerance": 0}),
            ("/tolerance", {"mesh": "m", "tolerance": "fine"}), ("/resolution", {"mesh": "m", "resolution": [2, 5]}),
            ("/resolution", {"mesh": "m", "resolution": 5}), ("/level", {"mesh": "m", "resolution": [5, 5], "level": 1}),
        ):
            with self.subTest(document=document):
                self.assertEqual(self.refusal("saddle", "tessellate", document)["pointer"], pointer)
        self.assert_problem(self.post("saddle", "tessellate", {"mesh": "m", "resolution": [100000, 100000]}), 413, "too_large")
        self.assert_problem(self.post("ring", "tessellate", {"mesh": "m", "tolerance": 1e-12}), 413, "too_large")
        self.assert_problem(self.daemon.get("/v1/meshes/m"), 404, "not_found")


class Narrow(Nurbs):
    flags = ("--memory-budget", "24MiB", "--max-body", "8MiB")

    def test_over_the_budget(self):
        """What does not fit is refused, and nothing of it stays."""
        self.assertEqual(self.put("small", bumps(8, 4, 0.5, 1)).status, 201)
        self.assert_problem(self.put("large", bumps(250, 250, 0.1, 1)), 507, "insufficient_memory")
        self.assert_problem(self.post("small", "tessellate", {"mesh": "fine", "resolution": [700, 700]}), 507, "insufficient_memory")
        self.assertEqual([surface["name"] for surface in self.daemon.get("/v1/nurbs").json["nurbs"]], ["small"])
        self.assertEqual(self.daemon.get("/v1/meshes").json["meshes"], [])
        self.assertIn('memory_bytes{class="flight"} 0\n', self.daemon.get("/metrics").body.decode())
        self.ask("small", "geodesic", {"from": [0.1, 0.1], "to": [0.9, 0.9]})


class Roles(Keyed):
    keys = (line("reader") + line("writer", "role=write") +
            f"stranger sha256:{digest(key_of('stranger'))} tenant=another role=write\n")

    def test_who_may(self):
        tessellate = json.dumps({"mesh": "made", "resolution": [4, 4]})
        geodesic = json.dumps({"from": [0, 0], "to": [1, 1]})
        self.assert_problem(self.ask("PUT", "/v1/nurbs/saddle", "reader", json.dumps(SADDLE)), 403, "forbidden")
        self.assertEqual(self.ask("PUT", "/v1/nurbs/saddle", "writer", json.dumps(SADDLE)).status, 201)
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/tessellate", "reader", tessellate), 403, "forbidden")
        self.assertEqual(self.ask("POST", "/v1/nurbs/saddle/geodesic", "reader", geodesic).status, 200)
        self.assertEqual(self.ask("POST", "/v1/nurbs/saddle/tessellate", "writer", tessellate).status, 201)
        self.assertEqual(self.ask("GET", "/v1/meshes/made/parameters", "reader").status, 200)
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/geodesic", None, geodesic), 401, "unauthorized")
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/geodesic", "stranger", geodesic), 404, "not_found")
        self.assert_problem(self.ask("GET", "/v1/meshes/made/parameters", "stranger"), 404, "not_found")


class Durable(Folder):
    def test_surfaces_and_places_last(self):
        multiplied = rational_torus()
        multiplied["controlPoints"] = [[[w * x for x in point] for point, w in zip(*rows)]
                                       for rows in zip(multiplied["controlPoints"], multiplied["weights"])]
        question = json.dumps({"from": [0, 0], "to": [0.25, 0.25]})
        with self.start() as daemon:
            created = daemon.request("PUT", "/v1/nurbs/torus?convention=verb", json.dumps(multiplied))
            self.assertEqual(created.status, 201, created)
            made = daemon.request("POST", "/v1/nurbs/torus/tessellate", json.dumps({"mesh": "tube", "resolution": [9, 7]}), JSON)
            self.assertEqual(made.status, 201, made)
            places = daemon.get("/v1/meshes/tube/parameters").json
            length = daemon.request("POST", "/v1/nurbs/torus/geodesic", question, JSON).json["length"]
            told = [surface for surface in daemon.get("/v1/nurbs").json["nurbs"]]
        with self.start() as daemon:
            self.assertEqual(daemon.get("/v1/nurbs").json["nurbs"], told)
            self.assertEqual(daemon.get("/v1/meshes/tube/parameters").json, places)
            answer = daemon.request("POST", "/v1/nurbs/torus/geodesic", question, JSON)
            self.assertEqual((answer.json["length"], answer.headers["ETag"]), (length, created.headers["ETag"]))
            self.assertEqual(daemon.request("PUT", "/v1/nurbs/torus?convention=verb", json.dumps(multiplied)).status, 200)
            self.assertEqual(daemon.request("DELETE", "/v1/nurbs/torus").status, 204)
            self.assertEqual(daemon.get("/v1/meshes/tube/parameters").json, places)


if __name__ == "__main__":
    unittest.main()
