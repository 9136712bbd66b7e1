"""Tests cut loci and medial axes. Compares them with unfoldings of a box and with closed forms in
the plane. Also tests the forms of the answer, and refusals."""
import csv
import io
import json
import math
import random
import struct

from harness import SQUARE, TestCase, sample

SIZE = (1, 2, 3)  # of the box
# for each side of the box: a corner, and the axes of its two edges at this corner
SIDES = [((0, 0, 0), 0, 1), ((0, 0, SIZE[2]), 0, 1), ((0, 0, 0), 1, 2), ((SIZE[0], 0, 0), 1, 2), ((0, 0, 0), 0, 2), ((0, SIZE[1], 0), 0, 2)]


def unit(axis):
    return tuple(float(k == axis) for k in range(3))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def along(a, t, b):
    return tuple(x + t * y for x, y in zip(a, b))


def on_side(k, point):
    """Returns whether a point lies on side k."""
    corner, first, second = SIDES[k]
    return abs(point[3 - first - second] - corner[3 - first - second]) < 1e-9


def edge_between(k, other):
    """Returns both ends of the edge that two sides of the box share, or None if they share no
    edge."""
    corners = [tuple(SIZE[i] * (n >> i & 1) for i in range(3)) for n in range(8)]
    shared = [corner for corner in corners if on_side(k, corner) and on_side(other, corner)]
    return shared if len(shared) == 2 else None


class Box:
    """The straight paths from one point on a box. Each sequence of sides is unfolded into the plane
    of its last side."""

    def __init__(self, start):
        # for each side: (image of the start, edges that the path crosses)
        self.images = [[] for _ in SIDES]
        for k in range(len(SIDES)):
            if on_side(k, start):
                self.unfold([k], self.flat(k, start), [])

    @staticmethod
    def flat(k, point):
        corner, first, second = SIDES[k]
        return point[first] - corner[first], point[second] - corner[second]

    def unfold(self, sides, image, edges):
        k = sides[-1]
        self.images[k].append((image, edges))
        for other in range(len(SIDES)):
            edge = edge_between(k, other)
            if other in sides or not edge or len(sides) > 4:
                continue
            # `move` takes a point in the plane of side k, and unfolds it about the common edge into
            # the plane of the other side.
            a, b = (self.flat(k, end) for end in edge)
            c, d = (self.flat(other, end) for end in edge)
            length = math.dist(a, b)
            u, v = ((b[0] - a[0]) / length, (b[1] - a[1]) / length), ((d[0] - c[0]) / length, (d[1] - c[1]) / length)
            inner = [tuple(0.5 * SIZE[axis] for axis in SIDES[side][1:]) for side in (k, other)]

            def move(point):
                foot = (point[0] - a[0]) * u[0] + (point[1] - a[1]) * u[1]
                height = (point[1] - a[1]) * u[0] - (point[0] - a[0]) * u[1]
                before = (inner[0][1] - a[1]) * u[0] - (inner[0][0] - a[0]) * u[1]
                behind = (inner[1][1] - c[1]) * v[0] - (inner[1][0] - c[0]) * v[1]
                height *= -1 if before * behind > 0 else 1
                return c[0] + foot * v[0] - height * v[1], c[1] + foot * v[1] + height * v[0]

            self.unfold([*sides, other], move(image), [tuple(map(move, each)) for each in [*edges, (a, b)]])

    def ways(self, k, point):
        """Returns (length, image) of each straight path to a point of side k, the shortest path
        first."""
        x, found = self.flat(k, point), []
        for image, edges in self.images[k]:
            is_inside = True
            for a, b in edges:
                s = [(x[0] - image[0]) * (end[1] - image[1]) - (x[1] - image[1]) * (end[0] - image[0]) for end in (a, b)]
                is_inside &= s[0] * s[1] <= 1e-9
            if is_inside:
                found.append((math.dist(x, image), image))
        return sorted(found)


def distance_to_lines(point, lines):
    least = math.inf
    for line in lines:
        for a, b in zip(line["points"], line["points"][1:]):
            d = minus(b, a)
            t = min(max(dot(minus(point, a), d) / max(dot(d, d), 1e-300), 0), 1)
            least = min(least, math.dist(point, along(a, t, d)))
    return least


class CutLocus(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({"square": SQUARE, "grid": sample("grid", columns=9, rows=9), "box": sample("box", a=1, b=2, c=3, cells=3),
                                  "ball": sample("icosphere", level=3)})

    def lines(self, mesh, sources, options="", **more):
        answer = self.daemon.ask(mesh, f"cut-locus{options}", {"set": sources, **more})
        self.assertEqual(answer.status, 200, answer)
        return answer.json["lines"]

    # --- a box -----------------------------------------------------------------------------------

    def test_box_unfolded(self):
        """Two straight paths of equal, least length lead to each point of the cut locus. Elsewhere
        the shortest path changes continuously."""
        chance, sides = random.Random(5), range(len(SIDES))
        for start in [(0.31, 0.7, 3), (0.5, 1, 3), (0, 1.2, 2.2)]:
            box = Box(start)
            lines = self.lines("box", {"points": [{"xyz": start}]}, tolerance=1e-9)
            for line in lines:
                for point in line["points"]:
                    for k in sides:
                        if on_side(k, point):
                            ways = box.ways(k, point)
                            others = [length for length, image in ways if math.dist(image, ways[0][1]) > 1e-3]
                            # only one shortest path leads to a vertex of the box
                            if not all(min(abs(point[i]), abs(point[i] - SIZE[i])) < 1e-9 for i in range(3)):
                                self.assertLess(others[0] - ways[0][0], 1e-9, point)
            jumps = 0
            for _ in range(200):
                k = chance.choice(sides)
                corner, first, second = SIDES[k]
                a, b = (along(along(corner, chance.random() * SIZE[first], unit(first)), chance.random() * SIZE[second], unit(second)) for _ in range(2))
                if math.dist(box.ways(k, a)[0][1], box.ways(k, b)[0][1]) < 1e-6:
                    continue
                image = box.ways(k, a)[0][1]
                for _ in range(50):
                    middle = along(a, 0.5, minus(b, a))
                    is_same = math.dist(box.ways(k, middle)[0][1], image) < 1e-6
                    a, b = (middle, b) if is_same else (a, middle)
                self.assertLess(distance_to_lines(a, lines), 1e-8)
                jumps += 1
            self.assertGreater(jumps, 20)

    # --- curves of the plane ---------------------------------------------------------------------

    RECTANGLE = {"curves": [{"points": [{"xyz": [x, y, 0]} for x, y in ((0.1, 0.2), (0.9, 0.2), (0.9, 0.7), (0.1, 0.7))], "closed": True}]}

    def test_rectangle(self):
        """With `segments`, members are the sides of the rectangle, numbered from the first point of
        the curve."""
        lines = self.lines("grid", self.RECTANGLE, members="segments")
        length = {}
        for line in lines:
            length[tuple(line["members"])] = length.get(tuple(line["members"]), 0) + line["length"]
            for x, y, _ in line["points"]:
                nearest = sorted([x - 0.1, 0.9 - x, y - 0.2, 0.7 - y])
                self.assertLess(nearest[1] - nearest[0], 1e-9)
        self.assertEqual(set(length), {(0, 1), (1, 2), (2, 3), (0, 3), (0, 2)})
        for members, total in length.items():
            self.assertAlmostEqual(total, 0.3 if members == (0, 2) else 0.25 * math.sqrt(2), 8)
        together = self.lines("grid", self.RECTANGLE)
        self.assertEqual(len(together), 5)
        self.assertEqual({tuple(line["members"]) for line in together}, {(0, 0)})
        # paths meet at the angle pi / 2 on the lines from the corners, and at the angle pi on the
        # middle line
        [middle] = self.lines("grid", self.RECTANGLE, min_angle=2)
        self.assertAlmostEqual(middle["length"], 0.3, 8)

    def test_smooth_curve(self):
        """A polyline that approximates an ellipse turns little at its corners, so `min_angle` omits
        the lines that begin there."""
        ring = [(0.5 + 0.4 * math.cos(0.1 * math.pi * i / 2), 0.5 + 0.2 * math.sin(0.1 * math.pi * i / 2)) for i in range(40)]
        ellipse = {"curves": [{"points": [{"xyz": [x, y, 0]} for x, y in ring], "closed": True}]}
        many = self.lines("grid", ellipse, members="segments")
        self.assertGreater(len(many), 40)
        [axis] = self.lines("grid", ellipse, min_angle=0.4)
        for x, y, _ in axis["points"]:
            self.assertLess(abs(y - 0.5), 1e-8)
            self.assertLess(abs(x - 0.5), 0.31)  # the centres of curvature are at 0.5 -+ 0.3

    # --- forms -----------------------------------------------------------------------------------

    def test_forms(self):
        for member in ({"points": [{"vertex": 0}]}, self.RECTANGLE):
            mesh = "grid" if "curves" in member else "ball"
            lines = self.lines(mesh, member, min_angle=0.1)
            field = self.daemon.ask(mesh, "fields", {"set": member}).json["id"]
            path = f"/v1/meshes/{mesh}/fields/{field}/cut-locus"
            got = self.daemon.request("GET", f"{path}?min_angle=0.1").json
            self.assertEqual(got["lines"], lines)
            rows = list(csv.DictReader(io.StringIO(self.daemon.request("GET", f"{path}?min_angle=0.1&format=csv").body.decode())))
            self.assertEqual(len(rows), sum(len(line["points"]) for line in lines))
            obj = self.daemon.request("GET", f"{path}?min_angle=0.1&format=obj").body.decode()
            self.assertEqual(sum(row.startswith("l ") for row in obj.splitlines()), len(lines))
            glb = self.daemon.request("GET", f"{path}?min_angle=0.1&format=glb&mesh=true").body
            self.assertEqual(glb[:4], b"glTF")
            size = struct.unpack_from("<I", glb, 12)[0]
            self.assertIn("meshes", json.loads(glb[20:20 + size]))

    def test_segments_of_a_field(self):
        field = self.daemon.ask("grid", "fields", {"set": self.RECTANGLE}).json["id"]
        got = self.daemon.request("GET", f"/v1/meshes/grid/fields/{field}/cut-locus?members=segments").json
        self.assertEqual(got["lines"], self.lines("grid", self.RECTANGLE, members="segments"))
        for limit in (0.1, 1000):
            field = self.daemon.ask("grid", "fields", {"set": self.RECTANGLE, "max_distance": limit}).json["id"]
            problem = self.daemon.request("GET", f"/v1/meshes/grid/fields/{field}/cut-locus")
            self.assertIn("max_distance", self.assert_problem(problem, 400, "invalid_request")["detail"])

    def test_nothing_and_refusals(self):
        self.assertEqual(self.lines("square", {"points": [{"vertex": 0}]}), [])
        self.assertEqual(self.daemon.ask("square", "cut-locus?format=obj", {"set": {"points": [{"vertex": 0}]}}).status, 406)
        for more, place in (({"min_angle": -1}, "/min_angle"), ({"min_angle": 4}, "/min_angle"), ({"tolerance": 0}, "/tolerance"),
                            ({"members": "parts"}, "/members")):
            answer = self.daemon.ask("square", "cut-locus", {"set": {"points": [{"vertex": 0}]}, **more})
            self.assertEqual((answer.status, answer.json["pointer"]), (400, place), answer)
        chance = random.Random(7)
        points = [{"xyz": [chance.random(), chance.random(), 0], "offset": 0.1 * chance.random()} for _ in range(200)]
        answer = self.daemon.ask("grid", "cut-locus", {"set": {"points": points}, "tolerance": 1e-15})
        self.assertEqual((answer.status, answer.json["code"]), (413, "too_large"))
