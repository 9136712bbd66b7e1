"""Surfaces, curves, an independent evaluation, and queries that all tests of NURBS share."""
import json
import math
import random

from harness import TestCase, header_fields

PI = math.pi
JSON = {"Content-Type": "application/json"}

# --- surfaces ------------------------------------------------------------------------------------

CIRCLE = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
CIRCLE_KNOTS = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]


def circle_weight(i):
    return math.sqrt(0.5) if i % 2 else 1


def rational_torus(major=2, minor=1):
    """Returns a torus of 9 x 9 control points: u around the axis, v around the tube."""
    points = [[[(major + minor * c) * x, (major + minor * c) * y, minor * s] for c, s in CIRCLE] for x, y in CIRCLE]
    weights = [[circle_weight(i) * circle_weight(j) for j in range(9)] for i in range(9)]
    return {"degreeU": 2, "degreeV": 2, "knotsU": CIRCLE_KNOTS, "knotsV": CIRCLE_KNOTS, "controlPoints": points, "weights": weights}


def rational_sphere():
    """Returns the unit sphere: v from the south pole to the north pole."""
    profile = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)]
    points = [[[r * x, r * y, h] for r, h in profile] for x, y in CIRCLE]
    weights = [[circle_weight(i) * circle_weight(j) for j in range(5)] for i in range(9)]
    return {"degreeU": 2, "degreeV": 2, "knotsU": CIRCLE_KNOTS, "knotsV": [0, 0, 0, 0.5, 0.5, 1, 1, 1], "controlPoints": points,
            "weights": weights}


def clamped(count, degree):
    inner = count - degree
    return [0] * degree + [i / inner for i in range(inner + 1)] + [1] * degree


def bumps(rows, columns, height, seed):
    """Returns an open bicubic B-spline over cells of size 1."""
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


# --- an evaluation of its own -------------------------------------------------------------------


def spline_at(degree, knots, points, t):
    """Evaluates a B-spline by De Boor's algorithm."""
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
    """Returns a closed polyline around (u, v)."""
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
