"""Random requests of every kind on surfaces of several kinds, for the soak, the disconnects, the
deadlines and the overload."""
import collections
import json

from common import harness
from harness import sample

Request = collections.namedtuple("Request", "kind method path body headers")
Surface = collections.namedtuple("Surface", "name collection body options")

JSON = {"Content-Type": "application/json"}
CUBE = (b"v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        b"f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n")
TORUS = json.dumps({"parametric": {"torus": {"major": 2, "minor": 1}}}).encode()

# Relative frequencies of the kinds of requests; `upload`, `tessellate` and `discretize` replace
# surfaces.
WEIGHTS = {
    "distance": 20, "path": 12, "nearest": 4, "often": 6, "matrix": 4, "batch": 3, "to_set": 4, "field": 5, "values": 2, "evaluate": 3,
    "isolines": 3, "describe": 3, "list": 2, "voronoi": 2, "farthest": 1, "curve_distance": 2, "trace": 3, "exp": 2, "log": 2,
    "transport": 2, "mean": 1, "spline": 2, "curve": 2, "cut": 2, "upload": 2, "remove": 1, "wrong": 3, "job": 1, "content": 1,
    "limit_evaluate": 2, "limit_nearest": 2, "limit_trace": 1, "limit_path": 1, "discretize": 1,
    "picture": 2, "figure": 1, "nurbs_evaluate": 2, "nurbs_nearest": 2, "nurbs_geodesic": 1, "nurbs_distance": 1, "tessellate": 1,
}


def surfaces(cells, level, rings):
    """Returns three meshes of those sizes (a terrain, a sphere, a torus), a subdivision surface and
    a NURBS surface."""
    return [
        Surface("terrain", "meshes", sample("terrain", cells=cells, amplitude=1), ""),
        Surface("sphere", "meshes", sample("icosphere", level=level), ""),
        Surface("ring", "meshes", sample("torus", columns=2 * rings, rows=rings), ""),
        Surface("cube", "subdivisions", CUBE, ""),
        Surface("donut", "nurbs", TORUS, ""),
    ]


def upload(daemon, those):
    """Uploads surfaces; returns the number of faces of each mesh, by name."""
    faces = {}
    for surface in those:
        answer = daemon.request("PUT", f"/v1/{surface.collection}/{surface.name}{surface.options}", surface.body, {})
        assert answer.status in (200, 201), answer
        if surface.collection == "meshes":
            faces[surface.name] = answer.json["faces"]
    return faces


def encode(request):
    """Returns the bytes of a request: head and body."""
    body = request.body or b""
    lines = [f"{request.method} {request.path} HTTP/1.1", "Host: localhost", *(f"{name}: {value}" for name, value in request.headers.items())]
    if body:
        lines.append(f"Content-Length: {len(body)}")
    return "\r\n".join([*lines, "", ""]).encode() + body


class Mix:
    """Makes random requests. Collects the ids of fields from answers that are passed to `learn`."""

    def __init__(self, chance, those, faces, weights=None):
        self.chance, self.surfaces, self.faces = chance, those, faces
        weights = weights or WEIGHTS
        self.kinds, self.weights = list(weights), list(weights.values())
        self.fields = collections.deque(maxlen=16)  # paths of fields

    def next(self, kind=None):
        kind = kind or self.chance.choices(self.kinds, self.weights)[0]
        mesh = self.chance.choice(list(self.faces))
        return getattr(self, kind)(mesh)

    def learn(self, request, answer):
        """Adds the field of an answer, or removes a field that no longer exists."""
        if request.kind == "field" and answer.status in (200, 201):
            self.fields.append(f"{request.path}/{answer.json['id']}")
        if answer.status in (404, 410) and "/fields/" in request.path:
            gone = request.path.rpartition("/")[0]
            self.fields = collections.deque((path for path in self.fields if path != gone), maxlen=16)

    # --- parts -----------------------------------------------------------------------------------

    def point(self, mesh):
        a, b = sorted((self.chance.random(), self.chance.random()))
        return {"face": self.chance.randrange(self.faces[mesh]), "barycentric": [a, b - a, 1 - b]}

    def points(self, mesh, count):
        return [self.point(mesh) for _ in range(count)]

    def near_points(self, mesh, count):
        """Returns points of consecutive faces of the file, which lie close to one another."""
        first = self.chance.randrange(self.faces[mesh])
        return [{"face": (first + 2 * i) % self.faces[mesh], "barycentric": [0.2, 0.3, 0.5]} for i in range(count)]

    def set(self, mesh):
        members = {"points": self.points(mesh, self.chance.randint(1, 4))}
        if self.chance.random() < 0.5:
            members["curves"] = [{"points": self.points(mesh, 2)}]
        return members

    def place(self):
        return {"face": self.chance.randrange(6), "uv": [self.chance.random(), self.chance.random()]}

    def uv(self):
        return [self.chance.uniform(0, 6.28), self.chance.uniform(0, 6.28)]

    def direction(self):
        return self.chance.uniform(0, 6.28)

    def post(self, kind, path, document, **headers):
        return Request(kind, "POST", f"/v1/{path}", json.dumps(document).encode(), {**JSON, **headers})

    def ask(self, kind, mesh, query, **document):
        return self.post(kind, f"meshes/{mesh}/{query}", document)

    def get(self, kind, path, **headers):
        return Request(kind, "GET", f"/v1/{path}", None, headers)

    def of_field(self, kind, make):
        """Returns a request about an existing field. Without a field, returns a request that
        creates one."""
        if not self.fields:
            return self.field(self.chance.choice(list(self.faces)))
        return make(self.chance.choice(self.fields).removeprefix("/v1/"))

    # --- meshes ----------------------------------------------------------------------------------

    def distance(self, mesh):
        return self.ask("distance", mesh, "distance", **{"from": self.point(mesh), "to": self.point(mesh)})

    def path(self, mesh):
        return self.ask("path", mesh, "path", **{"from": self.point(mesh), "to": self.point(mesh), "via": self.points(mesh, 1)})

    def often(self, mesh):
        """Repeats the same source, so that the daemon answers from the field of this source."""
        return self.get("often", f"meshes/{mesh}/path?from=v:7&to=f:{self.chance.randrange(self.faces[mesh])}:0.2,0.3,0.5&geometry=xyz",
                        **{"Accept-Encoding": "gzip"})

    def nearest(self, mesh):
        return self.get("nearest", f"meshes/{mesh}/nearest?point=p:{self.chance.random()},{self.chance.random()},1")

    def matrix(self, mesh):
        return self.ask("matrix", mesh, "matrix", sources=self.points(mesh, 4), targets=self.points(mesh, 30))

    def batch(self, mesh):
        lines = [json.dumps({"query": "distance", "from": a, "to": b}) for a, b in zip(self.points(mesh, 8), self.points(mesh, 8))]
        return Request("batch", "POST", f"/v1/meshes/{mesh}/batch", "\n".join(lines).encode(), {"Content-Type": "application/x-ndjson"})

    def to_set(self, mesh):
        return self.ask("to_set", mesh, "distance-to-set", set=self.set(mesh), points=self.points(mesh, 20), path=True)

    def field(self, mesh):
        return self.ask("field", mesh, "fields", set=self.set(mesh))

    def values(self, _):
        return self.of_field("values", lambda path: self.get("values", f"{path}/values", Accept="application/octet-stream"))

    def evaluate(self, _):
        return self.of_field("evaluate", lambda path: self.post("evaluate", f"{path}/evaluate", {
            "points": self.points(path.split("/")[1], 30), "gradient": True}))

    def isolines(self, _):
        return self.of_field("isolines", lambda path: self.get("isolines", f"{path}/isolines?count={self.chance.randint(1, 5)}"))

    def picture(self, mesh):
        return self.get("picture", f"meshes/{mesh}/picture.{self.chance.choice(('png', 'svg'))}?source=v:{self.chance.randint(0, 9)}&from=v:0&to=v:5"
                                   f"&size={self.chance.randint(16, 400)}x{self.chance.randint(16, 300)}")

    def figure(self, mesh):
        points, width = self.points(mesh, 3), self.chance.randint(16, 400)
        layers = [{"voronoi": {"set": {"points": points}}}, {"field": {"points": points[:1]}}, {"trace": {"start": points[1], "fan": 20, "length": 1}},
                  {"points": points, "labels": ["a", "b", "c"]}]
        return self.ask("figure", mesh, "picture", layers=self.chance.sample(layers, self.chance.randint(0, 4)), width=width, height=width)

    def describe(self, mesh):
        return self.get("describe", f"meshes/{mesh}")

    def list(self, mesh):
        return self.get("list", self.chance.choice(("meshes", f"meshes/{mesh}/fields", "jobs", "nurbs", "subdivisions")))

    def voronoi(self, mesh):
        return self.ask("voronoi", mesh, "voronoi", set={"points": self.points(mesh, 4)})

    def farthest(self, mesh):
        return self.ask("farthest", mesh, "farthest-points", count=self.chance.randint(2, 4))

    def curve_distance(self, mesh):
        return self.ask("curve_distance", mesh, "curve-distance", a={"points": self.points(mesh, 2)}, b={"points": self.points(mesh, 2)},
                        measure=self.chance.choice(("min", "hausdorff")))

    def trace(self, mesh):
        return self.ask("trace", mesh, "trace", start=self.point(mesh), fan=8, length=self.chance.uniform(0.1, 5))

    def exp(self, mesh):
        return self.ask("exp", mesh, "exp", start=self.point(mesh), vectors=[{"direction": self.direction(), "length": 1}])

    def log(self, mesh):
        to = self.points(mesh, 5) if self.chance.random() < 0.8 else "all"
        return self.ask("log", mesh, "log", **{"from": self.point(mesh), "to": to})

    def transport(self, mesh):
        return self.ask("transport", mesh, "transport", **{"from": self.point(mesh), "to": self.point(mesh),
                                                           "vectors": [{"direction": self.direction(), "length": 1}]})

    def mean(self, mesh):
        return self.ask("mean", mesh, "mean", points=self.near_points(mesh, 3))

    def spline(self, mesh):
        return self.ask("spline", mesh, "spline", points=self.near_points(mesh, 4), samples=8, frames=True)

    def curve(self, mesh):
        operation = self.chance.choice(({"operation": "length"}, {"operation": "resample", "count": 20}, {"operation": "shorten"},
                                        {"operation": "offset", "distance": 0.05}))
        return self.ask("curve", mesh, "curve", curve={"points": self.points(mesh, 3)}, **operation)

    def cut(self, mesh):
        return self.ask("cut", mesh, "cut", curve={"points": self.near_points(mesh, 3), "closed": True}, select_only=True)

    def content(self, mesh):
        return self.get("content", f"meshes/{mesh}/content?format={self.chance.choice(('obj', 'ply', 'stl', 'off', 'glb', 'gltf'))}",
                        **{"Accept-Encoding": "gzip"})

    def upload(self, _):
        surface = self.chance.choice(self.surfaces)
        name = surface.name if self.chance.random() < 0.5 else f"copy{self.chance.randrange(3)}"
        return Request("upload", "PUT", f"/v1/{surface.collection}/{name}", surface.body, {})

    def remove(self, _):
        return Request("remove", "DELETE", f"/v1/meshes/{self.chance.choice(('copy0', 'copy1', 'copy2', 'tiles', 'limit'))}", None, {})

    def wrong(self, mesh):
        """Returns a request that is refused: a malformed mesh, or a vertex, a mesh or a field that
        does not exist."""
        return self.chance.choice((
            Request("wrong", "PUT", "/v1/meshes/wrong", self.chance.randbytes(300), {}),
            Request("wrong", "PUT", "/v1/meshes/wrong", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", {}),
            Request("wrong", "POST", f"/v1/meshes/{mesh}/distance", b'{"from": {"vertex": 1e999}}', JSON),
            self.ask("wrong", mesh, "distance", **{"from": {"vertex": 4294967295}, "to": {"vertex": 0}}),
            self.get("wrong", "meshes/none/path?from=v:0&to=v:1"), self.get("wrong", f"meshes/{mesh}/fields/{'0' * 32}/values")))

    def job(self, mesh):
        return self.post("job", f"meshes/{mesh}/fields", {"set": self.set(mesh)}, Prefer="respond-async")

    # --- smooth surfaces -------------------------------------------------------------------------

    def limit_evaluate(self, _):
        return self.post("limit_evaluate", "subdivisions/cube/evaluate", {"points": [self.place() for _ in range(50)]})

    def limit_nearest(self, _):
        return self.post("limit_nearest", "subdivisions/cube/nearest", {"xyz": [self.chance.uniform(-1, 1) for _ in range(3)]})

    def limit_trace(self, _):
        return self.post("limit_trace", "subdivisions/cube/trace", {"start": self.place(), "fan": 4, "length": 2, "smooth": True})

    def limit_path(self, _):
        return self.post("limit_path", "subdivisions/cube/path", {"from": self.place(), "to": self.place(), "level": 3})

    def discretize(self, _):
        return self.post("discretize", "subdivisions/cube/discretize", {"mesh": "limit", "level": self.chance.randint(2, 4)})

    def nurbs_evaluate(self, _):
        return self.post("nurbs_evaluate", "nurbs/donut/evaluate", {"uv": [self.uv() for _ in range(50)]})

    def nurbs_nearest(self, _):
        return self.post("nurbs_nearest", "nurbs/donut/nearest", {"xyz": [self.chance.uniform(-3, 3) for _ in range(3)]})

    def nurbs_geodesic(self, _):
        return self.post("nurbs_geodesic", "nurbs/donut/geodesic", {"from": self.uv(), "to": self.uv()})

    def nurbs_distance(self, _):
        return self.post("nurbs_distance", "nurbs/donut/point-curve-distance",
                         {"point": self.uv(), "curve": {"iso": "v", "value": self.chance.uniform(0, 6.28)}})

    def tessellate(self, _):
        count = self.chance.randint(8, 60)
        return self.post("tessellate", "nurbs/donut/tessellate", {"mesh": "tiles", "resolution": [count, count]})
