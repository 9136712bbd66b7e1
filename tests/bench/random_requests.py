"""Random requests of every kind for a large mesh, for tests/bench/around.py.

A request is a tuple of method, target, body and perhaps headers. Its kind is an operation of the
contract, or a variant of an operation that takes another time.
"""
import json
import random
import re

from common import ROOT

NDJSON = {"Content-Type": "application/x-ndjson"}
JOB = {"Content-Type": "application/json", "Prefer": "respond-async"}  # as the contract recommends
MESH = "/v1/meshes/large"
MESH_FORMATS = ["obj", "ply", "stl", "glb", "off"]
CUBE = {"vertices": [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)],
        "faces": [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]}
TORUS = {"parametric": {"torus": {"major": 2, "minor": 1}}}


def prepare(daemon, is_small):
    """Makes the meshes of the operations that need a mesh with a history: `derived`, `tube` of a
    NURBS surface, and `ball` of a subdivision surface."""
    daemon.ask("POST", f"{MESH}/derive", {"mesh": "derived", "operations": [{"operation": "components"}]})
    daemon.ask("PUT", "/v1/nurbs/torus", TORUS)
    side = 20 if is_small else 700
    daemon.ask("POST", "/v1/nurbs/torus/tessellate", {"mesh": "tube", "resolution": [side, side]})
    daemon.ask("PUT", "/v1/subdivisions/cube", CUBE)
    daemon.ask("POST", "/v1/subdivisions/cube/discretize", {"mesh": "ball", "level": 2 if is_small else 8})


class Draw:
    """Draws random points, curves and lengths of a mesh."""

    def __init__(self, seed, described):
        self.random = random.Random(seed)
        self.faces, self.vertices = described["faces"], described["vertices"]
        self.low, self.high = (described["bounding_box"][end] for end in ("min", "max"))
        self.diagonal = sum((b - a) ** 2 for a, b in zip(self.low, self.high)) ** 0.5

    def point(self):
        u, v = sorted((self.random.randrange(1, 1000), self.random.randrange(1, 1000)))
        inside = {"face": self.random.randrange(self.faces), "barycentric": [u / 1000, (v - u) / 1000, (1000 - v) / 1000]}
        return self.random.choice([{"vertex": self.random.randrange(self.vertices)}, inside])

    def points(self, most, least=1):
        return [self.point() for _ in range(self.random.randint(least, most))]

    def word(self):
        return f"v:{self.random.randrange(self.vertices)}"

    def place(self):
        return [self.random.uniform(a, b) for a, b in zip(self.low, self.high)]

    def ray(self):
        """Returns a ray from a corner of the bounding box into the box."""
        return {"origin": self.low, "direction": [b - a for a, b in zip(self.low, self.place())]}

    def length(self, most=1.0):
        return self.random.uniform(0.001, most) * self.diagonal

    def angle(self):
        return self.random.uniform(0, 6)

    def vectors(self):
        return [{"direction": self.angle(), "length": self.length()} for _ in range(self.random.randint(1, 9))]

    def curve(self, corners=3, closed=False):
        return {"points": [self.point() for _ in range(corners)], "closed": closed}

    def set(self, most=4):
        return {"points": self.points(most)}

    def pick(self, *choices):
        return self.random.choice(choices)


def pair_kinds(draw):
    """Returns the kinds that take two points or a few: functions by name, which make a request."""
    lines = [{"query": "distance", "from": draw.point(), "to": draw.point()}, {"query": "nearest", "point": {"xyz": draw.place()}},
             {"query": "transport", "from": draw.point(), "to": draw.point(), "vectors": draw.vectors()}]

    def text():
        chosen = [{**line, "from": draw.point()} if "from" in line else line for line in lines]
        return "".join(json.dumps(line) + "\n" for line in chosen).encode()

    def between(**more):
        return {"from": draw.point(), "to": draw.point(), **more}

    return {
        "distance": lambda: ("GET", f"{MESH}/distance?from={draw.word()}&to={draw.word()}"),
        "distance, body": lambda: ("POST", f"{MESH}/distance", between(via=draw.points(2))),
        "path": lambda: ("GET", f"{MESH}/path?from={draw.word()}&to={draw.word()}{draw.pick('', '&format=svg', '&format=glb&mesh=true')}"),
        "path, body": lambda: ("POST", f"{MESH}/path", between(via=draw.points(2))),
        "nearest": lambda: ("GET", f"{MESH}/nearest?point=p:{','.join(map(str, draw.place()))}"),
        "nearest, ray": lambda: ("POST", f"{MESH}/nearest", {"point": {"ray": draw.ray()}}),
        "matrix": lambda: ("POST", f"{MESH}/matrix", {"sources": draw.points(2), "targets": draw.points(8)}),
        "matrix, near": lambda: ("POST", f"{MESH}/matrix", {"sources": draw.points(3), "targets": draw.points(8), "max_distance": draw.length(0.1)}),
        "pairs": lambda: ("POST", f"{MESH}/pairs", {"from": [draw.point()], "to": draw.points(6)}),
        "nearest points": lambda: ("POST", f"{MESH}/nearest-points", {"points": [{"xyz": draw.place()} for _ in range(draw.random.randint(1, 500))]}),
        "queries": lambda: ("POST", f"{MESH}/queries", text(), NDJSON),
        "distance to set": lambda: ("POST", f"{MESH}/distance-to-set", {"set": draw.set(), "points": draw.points(9), "path": draw.pick(True, False)}),
        "distance to curve": lambda: ("POST", f"{MESH}/distance-to-set", {"set": {"curves": [draw.curve(3)]}, "points": draw.points(9)}),
        "curve distance": lambda: ("POST", f"{MESH}/curve-distance", {"a": draw.curve(3), "b": draw.curve(3)}),
        "curve distance, hausdorff": lambda: ("POST", f"{MESH}/curve-distance", {"a": draw.curve(3), "b": draw.curve(3), "measure": "hausdorff"}),
    }


def field_kinds(draw, field):
    """Returns the kinds of requests about a field, and about the diagrams that follow from a
    field."""
    return {
        "field": lambda: ("POST", f"{MESH}/fields", {"set": {"points": draw.points(3)}}),
        "field, near": lambda: ("POST", f"{MESH}/fields", {"set": {"points": draw.points(3)}, "max_distance": draw.length(0.2)}),
        "field of a curve": lambda: ("POST", f"{MESH}/fields", {"set": {"curves": [draw.curve()]}}),
        "fields": lambda: ("GET", f"{MESH}/fields"),
        "field, described": lambda: ("GET", field),
        "values": lambda: ("GET", f"{field}/values{draw.pick('', '?format=ply', '?format=glb', '?format=csv', '?format=npy', '?format=npz')}"),
        "evaluate": lambda: ("POST", f"{field}/evaluate", {"points": draw.points(1000), "gradient": True}),
        "evaluate, paths": lambda: ("POST", f"{field}/evaluate", {"points": draw.points(100), "path": True}),
        "wedges": lambda: ("GET", f"{field}/wedges?edge=0-1"),
        "isolines": lambda: ("GET", f"{field}/isolines?count={draw.random.randint(1, 20)}{draw.pick('', '&format=f64', '&format=glb')}"),
        "isolines, arcs": lambda: ("POST", f"{field}/isolines", {"count": draw.random.randint(1, 20), "arcs": True}),
        "isolines, new field": lambda: ("POST", f"{MESH}/picture?format=svg", {"layers": [{"field": draw.set()}, {"isolines": {"count": 20}}]}),
        "isolines, new field, glb": lambda: ("POST", f"{MESH}/picture?format=glb", {"layers": [{"field": draw.set()}, {"isolines": {"count": 20}}]}),
        "cut locus": lambda: ("POST", f"{MESH}/cut-locus", {"set": draw.set(), "min_angle": draw.random.uniform(0.1, 1)}, JOB),
        "cut locus of a field": lambda: ("GET", f"{field}/cut-locus?min_angle={draw.random.uniform(0.1, 1)}{draw.pick('', '&format=f64')}", None, JOB),
        "voronoi": lambda: ("POST", f"{MESH}/voronoi{draw.pick('', '?format=f64', '?format=npz')}", {"set": draw.set(6)}),
        "voronoi of curves": lambda: ("POST", f"{MESH}/voronoi", {"set": {"curves": [draw.curve(2), draw.curve(2)]}}),
        "farthest points": lambda: ("POST", f"{MESH}/farthest-points", {"count": draw.random.randint(1, 3), "start": draw.point()}),
    }


def line_kinds(draw):
    """Returns the kinds of lines, curves and tangent vectors."""
    def curve(operation, closed=False, **more):
        return lambda: ("POST", f"{MESH}/curve", {"curve": draw.curve(3, closed), "operation": operation, **more})

    return {
        "trace": lambda: ("POST", f"{MESH}/trace", {"start": draw.point(), "directions": [draw.angle() for _ in range(5)], "length": draw.length()}),
        "trace, fan": lambda: ("POST", f"{MESH}/trace", {"start": draw.point(), "fan": 100, "length": draw.length()}),
        "exp": lambda: ("POST", f"{MESH}/exp", {"start": draw.point(), "vectors": draw.vectors()}),
        "log": lambda: ("POST", f"{MESH}/log", {"from": draw.point(), "to": draw.points(5)}),
        "log of all": lambda: ("POST", f"{MESH}/log", {"from": draw.point(), "to": "all"}),
        "transport": lambda: ("POST", f"{MESH}/transport", {"from": draw.point(), "to": draw.point(), "vectors": draw.vectors()}),
        "mean": lambda: ("POST", f"{MESH}/mean", {"points": draw.points(4)}),
        "spline": lambda: ("POST", f"{MESH}/spline", {"points": [draw.point() for _ in range(4)], "samples": 9}),
        "spline, closed": lambda: ("POST", f"{MESH}/spline", {"points": [draw.point() for _ in range(4)], "closed": True, "frames": True}),
        "curve, length": curve("length"),
        "curve, resample": curve("resample", count=100),
        "curve, shorten": curve("shorten"),
        "curve, shorten in rounds": curve("shorten", rounds=10),
        "curve, closed geodesic": curve("closed-geodesic", closed=True),
        "curve, offset": lambda: curve("offset", distance=draw.length(0.1))(),
    }


def surface_kinds(draw):
    """Returns the kinds of the mesh itself: descriptions, files, pictures, edits."""
    def layers(*those, headers=None):
        return lambda: ("POST", f"{MESH}/picture?format={draw.pick('png', 'svg')}", {"layers": [one() for one in those]}, *([headers] if headers else []))

    def derived(operation, headers=None, **more):
        body = {"mesh": "edited", "operations": [{"operation": operation, **more}]}
        return lambda: ("POST", f"{MESH}/derive", body, *([headers] if headers else []))

    return {
        "describe": lambda: ("GET", MESH),
        "boundaries": lambda: ("GET", f"{MESH}/boundaries"),
        "content": lambda: ("GET", f"{MESH}/content?format={draw.pick(*MESH_FORMATS)}"),
        "preview": lambda: ("GET", f"{MESH}/preview"),
        "origins": lambda: ("GET", f"/v1/meshes/derived/origins{draw.pick('', '?format=f64')}"),
        "parameters": lambda: ("GET", f"/v1/meshes/tube/parameters{draw.pick('', '?format=f64')}"),
        "places": lambda: ("GET", f"/v1/meshes/ball/places{draw.pick('', '?format=f64')}"),
        "picture": lambda: ("GET", f"{MESH}/picture.png?source={draw.word()}&view={draw.pick('front', 'iso')}"),
        "picture of a path": lambda: ("GET", f"{MESH}/picture.svg?from={draw.word()}&to={draw.word()}"),
        "picture, lines": layers(lambda: {"trace": {"start": draw.point(), "fan": 9, "length": draw.length()}},
                                 lambda: {"path": {"from": draw.point(), "to": draw.point()}},
                                 lambda: {"curve": {"curve": draw.curve(), "operation": "shorten"}}),
        "picture, splines": layers(lambda: {"spline": {"points": [draw.point() for _ in range(3)], "samples": 9}}),
        "picture, glb": lambda: ("POST", f"{MESH}/picture?format=glb", {"layers": [{"path": {"from": draw.point(), "to": draw.point()}}]}),
        "picture, voronoi": layers(lambda: {"voronoi": {"set": draw.set()}}),
        "picture, cut locus": layers(lambda: {"cut_locus": {"set": draw.set(1), "min_angle": 0.1}}, headers=JOB),
        "picture, cut": layers(lambda: {"cut": {"curve": draw.curve(3, True)}}),
        "cut, selection": lambda: ("POST", f"{MESH}/cut", {"curve": draw.curve(3, True), "select_only": True}),
        "cut": lambda: ("POST", f"{MESH}/cut", {"curve": draw.curve(3, True), "inside": draw.point(), "names": ["piece"]}),
        "derive, simplify": derived("simplify", JOB, faces=1000),
        "derive, components": derived("components"),
        "derive, fill": derived("fill"),
        "derive, smooth": derived("smooth"),
        "derive, smooth and fill": lambda: ("POST", f"{MESH}/derive", {"mesh": "edited", "operations": [{"operation": "smooth"}, {"operation": "fill"}]}),
        "derive, subdivide": derived("subdivide", JOB),
    }


def service_kinds(draw, job, batch):
    """Returns the kinds of jobs and batches. `job` and `batch` are targets of finished ones."""
    return {
        "batch, new": lambda: ("POST", "/v1/batches", {"query": "all-pairs", "mesh": "large", "vertices": [draw.random.randrange(draw.vertices)]}),
        "batch": lambda: ("GET", batch),
        "batch, results": lambda: ("GET", f"{batch}/results"),
        "batches": lambda: ("GET", "/v1/batches"),
        "job": lambda: ("GET", job),
        "job, result": lambda: ("GET", f"{job}/result"),
        "jobs": lambda: ("GET", "/v1/jobs"),
        "meshes": lambda: ("GET", "/v1/meshes"),
    }


def kinds(draw, field, job, batch):
    return {**pair_kinds(draw), **field_kinds(draw, field), **line_kinds(draw), **surface_kinds(draw), **service_kinds(draw, job, batch)}


# --- coverage -----------------------------------------------------------------------------------


def operations():
    """Returns the contract's operations of meshes that have the method GET or POST, as texts such
    as "GET /v1/meshes/{name}/path". Former names and uploads are left out."""
    path, found = None, set()
    lines = (ROOT / "proto" / "openapi.yaml").read_text().splitlines()
    for i, line in enumerate(lines):
        if line.startswith("  /"):
            path = line.strip().rstrip(":")
        elif path and line in ("    get:", "    post:") and path.startswith("/v1/meshes/{name}"):
            found.add(f"{line.strip().rstrip(':').upper()} {path}")
        elif path and line == "      deprecated: true":
            found = {one for one in found if not one.endswith(" " + path)}
    return found


def template(request):
    """Returns the operation of a request, as `operations` does."""
    path = re.sub("^/v1/meshes/[^/]+", "/v1/meshes/{name}", request[1].partition("?")[0])
    return f"{request[0]} {re.sub('/fields/[0-9a-f]+', '/fields/{id}', path)}"


def missing(made):
    """Returns the operations that no kind of `made` requests."""
    return sorted(operations() - {template(make()) for make in made.values()})
