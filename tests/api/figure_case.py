"""Reads figures of POST …/picture: lines and discs of an SVG, nodes of a GLB. Projects positions
independently."""
import json
import math
import xml.etree.ElementTree as ElementTree

from harness import TestCase
from test_files import read_glb
from test_pictures import SVG

MARGIN = 0.1  # largest margin, relative to the shorter side
SIDE = 4  # of the plate
RED = (0xd1, 0x12, 0x1f)


def plate(cells=8):
    """Returns a square of side SIDE in the plane z = 0, as OBJ."""
    lines = [f"v {SIDE * i / cells} {SIDE * j / cells} 0" for j in range(cells + 1) for i in range(cells + 1)]
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i + 1
            lines += [f"f {a} {a + 1} {a + cells + 2}", f"f {a} {a + cells + 2} {a + cells + 1}"]
    return ("\n".join(lines) + "\n").encode()


def positions_of(obj):
    return [tuple(map(float, line.split()[1:4])) for line in obj.decode().splitlines() if line.startswith("v ")]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


class Projection:
    """The parallel projection of a figure without a legend: the surface just fits."""

    def __init__(self, positions, direction, width, height, up=(0, 1, 0)):
        towards = unit(direction)
        self.right = unit(cross(up, towards))
        self.up = cross(towards, self.right)
        xs, ys = [dot(p, self.right) for p in positions], [dot(p, self.up) for p in positions]
        units = max(math.sqrt(width * height / 480000), 0.75)
        margin = min(16 * units, MARGIN * min(width, height))
        self.scale = min((width - 2 * margin) / (max(xs) - min(xs)), (height - 2 * margin) / (max(ys) - min(ys)))
        self.x, self.y = width / 2 - self.scale * (min(xs) + max(xs)) / 2, height / 2 + self.scale * (min(ys) + max(ys)) / 2

    def __call__(self, position):
        return self.x + self.scale * dot(position, self.right), self.y - self.scale * dot(position, self.up)


def subpaths(element):
    """Returns the polylines of an SVG path."""
    return [[tuple(map(float, place.split())) for place in part.split("L")] for part in element.get("d").split("M")[1:]]


def distance_to_line(place, line):
    best = math.inf
    for a, b in zip(line, line[1:]):
        along = (b[0] - a[0], b[1] - a[1])
        length = dot(along, along)
        t = min(max(dot((place[0] - a[0], place[1] - a[1]), along) / length, 0), 1) if length else 0
        best = min(best, math.dist(place, (a[0] + t * along[0], a[1] + t * along[1])))
    return best


class Figure:
    def __init__(self, body):
        self.root = ElementTree.fromstring(body)
        self.groups = {}
        for group in self.root.iter(SVG + "g"):
            self.groups.setdefault(group.get("id"), []).append(group)

    def lines(self, layer, dashed=False):
        """Returns the visible polylines of a layer, or its hidden polylines if `dashed`. If a group
        has several paths, uses the last path."""
        found = []
        for group in self.groups.get(f"layer-{layer}", ()):
            paths = [path for path in group.iter(SVG + "path") if bool(path.get("stroke-dasharray")) == dashed]
            found += subpaths(paths[-1]) if paths else []
        return found

    def discs(self, layer):
        """Returns (x, y, radius, colour, opacity) of a layer's circles."""
        return [(*(float(circle.get(name)) for name in ("cx", "cy", "r")), circle.get("fill"), float(circle.get("fill-opacity")))
                for group in self.groups.get(f"layer-{layer}", ()) for circle in group.iter(SVG + "circle")]

    def strokes(self, layer):
        return [path.get("stroke") for group in self.groups.get(f"layer-{layer}", ()) for path in group.iter(SVG + "path")]

    def texts(self):
        return [(text.text, float(text.get("x")), float(text.get("y"))) for text in self.root.iter(SVG + "text")]


def linear(colour):
    """Returns the linear components of #rrggbb."""
    values = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055)**2.4 for value in values]


def rows(flat, width=3):
    return list(zip(*(flat[k::width] for k in range(width))))


class Scene:
    """A figure as GLB: the surface, and the primitives of each node by name."""

    def __init__(self, body):
        self.document, self.lists = read_glb(body)
        root, *others = self.document["nodes"]
        assert root.get("children", []) == list(range(1, len(others) + 1)), root
        self.origin = root["translation"]
        surface = self.document["meshes"][root["mesh"]]["primitives"][0]
        self.places = self.positions(surface)
        self.faces = rows(self.lists[surface["indices"]])
        distances = surface["attributes"].get("_DISTANCE")
        self.distances = self.lists[distances] if distances is not None else None
        self.colour = self.document["materials"][surface["material"]]["pbrMetallicRoughness"].get("baseColorFactor")
        self.nodes = {}
        for node in others:
            self.nodes.setdefault(node["name"], []).append(self.document["meshes"][node["mesh"]])

    def positions(self, primitive):
        return [tuple(a + b for a, b in zip(place, self.origin)) for place in rows(self.lists[primitive["attributes"]["POSITION"]])]

    def points(self, name):
        """Returns the points of a node's marks."""
        [primitive] = self.nodes[name][-1]["primitives"]
        assert primitive["mode"] == 0, primitive
        return self.positions(primitive)

    def segments(self, name, i=0):
        [primitive] = self.nodes[name][i]["primitives"]
        assert primitive["mode"] == 1, primitive
        places = self.positions(primitive)
        return [(places[a], places[b]) for a, b in rows(self.lists[primitive["indices"]], 2)]

    def paint(self, name):
        return self.document["materials"][self.nodes[name][0]["primitives"][0]["material"]]["pbrMetallicRoughness"]["baseColorFactor"][:3]

    def area(self):
        corners = [[self.places[i] for i in face] for face in self.faces]
        sides = [[[q[k] - p[k] for k in range(3)] for q in rest] for p, *rest in corners]
        return sum(math.sqrt(dot(n, n)) / 2 for n in (cross(*pair) for pair in sides))


def distance_to_segment(place, segment):
    along, to = ([q - p for p, q in zip(segment[0], end)] for end in (segment[1], place))
    t = min(max(dot(along, to) / (dot(along, along) or 1), 0), 1)
    return math.dist([p + t * d for p, d in zip(segment[0], along)], place)


def length_of(segments):
    return sum(math.dist(*segment) for segment in segments)


class FigureCase(TestCase):
    kind = "meshes"

    def scene_of(self, layers, mesh="plate", **members):
        return Scene(self.posted({"layers": layers, **members}, mesh, "glb").body)

    def posted(self, document, mesh="plate", form="svg", status=200, **headers):
        answer = self.daemon.request("POST", f"/v1/{self.kind}/{mesh}/picture?format={form}", json.dumps(document).encode(),
                                     {"Content-Type": "application/json", **headers})
        self.assertEqual(answer.status, status, answer)
        return answer

    def figure(self, layers, mesh="plate", width=400, height=400, **members):
        document = {"layers": layers, "camera": {"view": "front"}, "legend": False, "width": width, "height": height, **members}
        return Figure(self.posted(document, mesh).body)

    def refused(self, layers, pointer, mesh="plate", status=400, code="invalid_request", **members):
        problem = self.posted({"layers": layers, **members}, mesh, status=status).json
        self.assertEqual((problem["code"], problem.get("pointer")), (code, pointer), problem)
        return problem["detail"]

    def assert_drawn(self, positions, lines, projection, away=0.15):
        """Asserts that each position is on a drawn line."""
        for position in positions:
            place = projection(position)
            self.assertLess(min(distance_to_line(place, line) for line in lines), away, position)
