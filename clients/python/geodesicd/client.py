"""The client of a daemon, and its resources: meshes, their fields, smooth surfaces, batches."""
from __future__ import annotations

import contextlib
import dataclasses
import os
import pathlib
import ssl
import time
import urllib.parse
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union, cast

from . import answers, arrays, notebook, ply, points
from .arrays import floats, numpy
from .errors import BadAnswer, GeodesicError, NotFound
from .jobs import Job, Progress, listener
from .points import Point, PointLike, Points, Vec3
from .transport import Response, Transport

DEFAULT_URL = "http://127.0.0.1:8080"
FLOATS = "application/octet-stream"
BATCH_WAIT = 30  # longest wait of one request for a batch, in seconds
SPLIT_MOST = 64  # largest number of meshes that one request creates
PREVIEW_WAIT = 0.5  # pause between two requests for a preview, in seconds


@dataclasses.dataclass(frozen=True)
class Path:
    """A path on the surface: its length, and its corners from the first to the last."""

    length: float
    points: List[Vec3]

    @classmethod
    def read(cls, answer: Mapping[str, Any]) -> "Path":
        return cls(answer["length"], [(x, y, z) for x, y, z in answer["points"]])


def point_set(sources: Union[Mapping[str, Any], PointLike, Points]) -> Dict[str, Any]:
    """Converts a set, a point, or a list or an array of points to a set of the contract. Three
    numbers that are not all integers are a point; three integers are three vertices."""
    sources = points.listed(sources)
    if isinstance(sources, Mapping) and sources.keys() & {"points", "curves", "boundaries"}:
        return dict(sources)
    if isinstance(sources, (list, tuple, range)) and not points.is_place(sources):
        return {"points": points.all_as_json(sources)}
    return {"points": [points.as_json(sources)]}


class Resource:
    """A resource at a path of the daemon, with its queries."""

    def __init__(self, client: "Client", location: str):
        self.client, self.location = client, location

    def query(self, name: str, body: Mapping[str, Any], *, progress: Optional[Progress] = None, **query: Any) -> Dict[str, Any]:
        """Sends any query of the contract (POST `location`/`name`) and returns its answer. Keywords
        are parameters of the query string (`select`, `geometry`, `timeout_ms`). With `progress` the
        query runs as a job, and the method waits for it. `progress` is a function that receives the
        progress in [0,1], or True for a tqdm bar."""
        return cast(Dict[str, Any], self.client.call("POST", f"{self.location}/{name}", query, body, progress=progress).json)

    def query_arrays(self, name: str, body: Mapping[str, Any], *, form: str = "f64", **query: Any) -> Dict[str, Any]:
        """Like `query`, but returns arrays by name (`matrix`, `isolines`, `trace`, `voronoi`, …).
        They are numpy arrays, or array.array stored by rows if numpy is missing. The form "f32" has
        single precision."""
        return arrays.read(self.client.call("POST", f"{self.location}/{name}", {**query, "format": form}, body).body)

    def _bulk(self, name: str, given: Mapping[str, Any]) -> Dict[str, Any]:
        headers = {"Content-Type": arrays.MEDIA_TYPE}
        return arrays.read(self.client.call("POST", f"{self.location}/{name}", {"format": "f64"}, arrays.write(given), headers).body)

    def delete(self) -> None:
        self.client.call("DELETE", self.location)

    def describe(self) -> Any:
        return self.client.call("GET", self.location).json

    def exists(self) -> bool:
        try:
            self.client.call("HEAD", self.location)
            return True
        except NotFound:
            return False


class Surface(Resource):
    """A named surface: a mesh, a subdivision surface, a NURBS."""

    def __init__(self, client: "Client", kind: str, name: str):
        super().__init__(client, f"/v1/{kind}/{urllib.parse.quote(name, safe='')}")
        self.name = name

    def __repr__(self) -> str:
        return f"<{self.location}>"

    def figure(self, layers: Sequence[Mapping[str, Any]], form: str = "png", progress: Optional[Progress] = None, **scene: Any) -> bytes:
        """Draws a figure of the surface with layers, as a PNG, SVG or GLB file. `layers` are those
        of the contract; keywords are the other members of the request:
        figure([{"path": {"from": {"vertex": 0}, "to": {"vertex": 9}}}], camera={"view": "top"})"""
        return self.client.call("POST", f"{self.location}/picture", {"format": form}, {"layers": list(layers), **scene}, progress=progress).body


class Field(Resource):
    """The distances from a set to the whole surface. The daemon stores them."""

    def __init__(self, mesh: "Mesh", answer: Dict[str, Any]):
        super().__init__(mesh.client, f"{mesh.location}/fields/{answer['id']}")
        self.mesh = mesh
        self.id: str = answer["id"]
        self.max: Optional[float] = answer["max"]
        self.farthest = Point.read(answer["farthest"]) if answer.get("farthest") else None

    def __repr__(self) -> str:
        return f"<{self.location}>"

    def describe(self) -> answers.Field:
        return cast(answers.Field, super().describe())

    def values(self) -> Any:
        """Returns the distance at each vertex, or NaN if no path reaches the vertex. The result is
        a writable numpy array, or an array.array("d") if numpy is missing."""
        return floats(self.client.call("GET", self.location + "/values", headers={"Accept": FLOATS}).body)

    def file(self, format: str = "ply") -> bytes:
        """Returns a file of the mesh with the distance at each vertex: ply, glb (as colours) or csv
        (a row per vertex)."""
        return self.client.call("GET", self.location + "/values", {"format": format}).body

    def distances(self, at: Points) -> List[Optional[float]]:
        """Returns the distance at each point, or None if no path reaches the point."""
        results = self.query("evaluate", {"points": points.all_as_json(at)}, select="distance")["results"]
        return [result["distance"] for result in results]

    def evaluate(self, at: Points, path: bool = False, gradient: bool = False) -> List[answers.Result]:
        """Returns for each point the distance and the nearest member of the set. With `path` and
        `gradient`, also returns the path to this member and the gradient."""
        body = {"points": points.all_as_json(at), "path": path, "gradient": gradient}
        return cast(List[answers.Result], self.query("evaluate", body)["results"])

    def isolines(self, levels: Union[Sequence[float], float, None] = None, tolerance: Optional[float] = None, count: Optional[int] = None,
                 geometry: Optional[str] = None) -> List[answers.Isoline]:
        """Returns the lines of each level, or of `count` equally spaced levels. Within faces the
        daemon approximates the curves to `tolerance`, by default to its own tolerance. `geometry`
        is "full", "xyz" or "none"."""
        return cast(List[answers.Isoline], self.query("isolines", self._levels(levels, tolerance, count), geometry=geometry)["isolines"])

    def isoline_arrays(self, levels: Union[Sequence[float], float, None] = None, tolerance: Optional[float] = None,
                       count: Optional[int] = None) -> Dict[str, Any]:
        """Like `isolines`, but returns arrays by name. Line i consists of the rows of `points` from
        `first[i]` to `first[i + 1]`; `level` and `length` have an entry for each line."""
        return self.query_arrays("isolines", self._levels(levels, tolerance, count))

    def isolines_file(self, levels: Union[Sequence[float], float], format: str = "obj", tolerance: Optional[float] = None, mesh: bool = False) -> bytes:
        """Returns the lines of all levels as a file: obj, glb or csv. If `mesh` is true, the file
        includes the mesh (obj and glb)."""
        query = {"format": format, "mesh": mesh or None}
        return self.client.call("POST", self.location + "/isolines", query, self._levels(levels, tolerance)).body

    @staticmethod
    def _levels(levels: Union[Sequence[float], float, None], tolerance: Optional[float], count: Optional[int] = None) -> Dict[str, Any]:
        if isinstance(levels, (int, float)):
            levels = [levels]
        given = {"levels": None if levels is None else list(points.listed(levels)), "tolerance": tolerance, "count": count}
        return {name: value for name, value in given.items() if value is not None}

    def show(self) -> Any:
        """Draws the mesh with the distances as colours (`Mesh.show`)."""
        return notebook.show(self.mesh, self)

    def _repr_html_(self) -> str:
        return notebook.html(self.mesh, f"distances on {self.mesh.name}, up to {self.max}", {"field": self.id})


class Mesh(Surface):
    """A triangle mesh. Its methods accept points in all forms of `geodesicd.points.as_json`."""

    def __init__(self, client: "Client", name: str):
        super().__init__(client, "meshes", name)

    def describe(self) -> answers.Mesh:
        return cast(answers.Mesh, super().describe())

    def distance(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = ()) -> Optional[float]:
        """Returns the exact distance, or None if no path joins the points."""
        return cast(Optional[float], self.query("distance", self._ends(start, end, via), select="distance")["distance"])

    def path(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = ()) -> Optional[Path]:
        """Returns a shortest path, or None if no path joins the points."""
        answer = self.query("path", self._ends(start, end, via), select="path", geometry="xyz")
        return Path.read(answer["path"]) if answer.get("path") else None

    def path_file(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = (), format: str = "obj", mesh: bool = False) -> bytes:
        """Returns a shortest path as a file: obj, glb, csv, or svg (the faces that the path
        crosses, unfolded into the plane). If `mesh` is true, the file includes the mesh (obj and
        glb)."""
        query = {"format": format, "mesh": mesh or None}
        return self.client.call("POST", self.location + "/path", query, self._ends(start, end, via)).body

    @staticmethod
    def _ends(start: PointLike, end: PointLike, via: Sequence[PointLike]) -> Dict[str, Any]:
        body: Dict[str, Any] = {"from": points.as_json(start), "to": points.as_json(end)}
        return {**body, "via": points.all_as_json(via)} if via else body

    def nearest(self, point: PointLike) -> Point:
        """Returns the surface point that `point` describes, with its face, barycentric coordinates
        and position (see `Point`)."""
        return Point.read(self.query("nearest", {"point": points.as_json(point)}))

    def pairs(self, starts: Any, ends: Any) -> Any:
        """Returns the distance of each pair of a start and an end, or NaN if no path joins the
        points of the pair. `starts` and `ends` are arrays or lists of vertex indices, or of rows of
        three coordinates, which stand for the nearest surface points. One of them may hold a single
        point for all pairs."""
        return self._bulk("pairs", {"from": starts, "to": ends})["distances"]

    def nearest_points(self, xyz: Any) -> Dict[str, Any]:
        """Returns the surface points nearest to rows of three coordinates, as the arrays `faces`,
        `barycentric`, `xyz`, `snap_distances`."""
        return self._bulk("nearest-points", {"points": xyz})

    def matrix(self, sources: Points, targets: Points, max_distance: Optional[float] = None,
               progress: Optional[Progress] = None) -> Any:
        """Returns the distances from each source to each target. A distance is NaN if no path joins
        the points or the distance exceeds `max_distance`. The result is a numpy array, or a list of
        array.array if numpy is missing."""
        sources, targets = points.all_as_json(sources), points.all_as_json(targets)
        body: Dict[str, Any] = {"sources": sources, "targets": targets}
        if max_distance is not None:
            body["max_distance"] = max_distance
        received = self.client.call("POST", self.location + "/matrix", None, body, {"Accept": FLOATS}, progress).body
        if len(received) != 8 * len(sources) * len(targets):
            raise BadAnswer("the matrix has another size")
        values = floats(received)
        if numpy is not None:
            return values.reshape(len(sources), len(targets))
        return [values[row * len(targets):(row + 1) * len(targets)] for row in range(len(sources))]

    def field(self, sources: Any, max_distance: Optional[float] = None, progress: Optional[Progress] = None) -> Field:
        """Computes the distances from a point, points or a set (`point_set`) to the whole surface.
        Equal requests return the same field."""
        body: Dict[str, Any] = {"set": point_set(sources)}
        if max_distance is not None:
            body["max_distance"] = max_distance
        return Field(self, self.query("fields", body, progress=progress))

    def distance_to_set(self, sources: Any, at: Points, path: bool = False) -> List[answers.Result]:
        """Returns for each point the nearest member of a set and the distance from this member.
        With `path`, also returns the path."""
        body = {"set": point_set(sources), "points": points.all_as_json(at), "path": path}
        return cast(List[answers.Result], self.query("distance-to-set", body)["results"])

    def picture(self, form: str = "png", **query: Any) -> bytes:
        """Returns a rendered picture as a PNG or SVG file. Keywords are parameters of the contract,
        with points in compact form: source="v:12", view="iso", size="800x600", **{"from": "v:3"},
        to="v:7", ..."""
        return self.client.call("GET", f"{self.location}/picture.{form}", query).body

    def show(self, field: Optional[Field] = None, path: Optional[Path] = None) -> Any:
        """Draws the mesh, optionally with the distances of a field as colours and with a path.
        Returns a figure of pyvista or plotly, if one is installed; otherwise the daemon's
        picture."""
        return notebook.show(self, field, path)

    def _repr_html_(self) -> str:
        return notebook.html(self, f"{self.name}: {self.describe()['faces']} faces", {})

    def arrays(self) -> Tuple[Any, Any]:
        """Returns (vertices, faces): rows of coordinates and rows of vertex indices, as numpy
        arrays, or as array.array if numpy is missing. `field.values()` has a distance for each
        vertex."""
        return ply.read(self.content("ply"))

    def content(self, format: str = "obj") -> bytes:
        """Returns the mesh as a file: obj, ply, off, stl, glb or gltf."""
        return self.client.call("GET", self.location + "/content", {"format": format}).body

    def derive(self, name: str, *operations: Mapping[str, Any], progress: Optional[Progress] = None) -> "Mesh":
        """Creates a mesh with this name by applying operations in order: {"operation": "simplify",
        "faces": 10000}. The contract also has fill, smooth, subdivide and components."""
        answer = self.query("derive", {"mesh": name, "operations": list(operations)}, progress=progress)
        return Mesh(self.client, answer["name"])

    def split(self, name: str, *operations: Mapping[str, Any], progress: Optional[Progress] = None) -> List["Mesh"]:
        """Applies the operations, if there are any. Then stores each component of the result as a
        separate mesh with the name name-1, name-2 and so on, by decreasing area."""
        steps = list(operations) or [{"operation": "components", "keep": SPLIT_MOST + 1}]
        answer = self.query("derive", {"mesh": name, "split": True, "operations": steps}, progress=progress)
        return [Mesh(self.client, part["name"]) for part in answer["meshes"]]

    def origins(self) -> List[List[float]]:
        """Returns for each vertex of a derived mesh its point on the original mesh: the face and
        the barycentric coordinates."""
        return cast(List[List[float]], self.client.call("GET", self.location + "/origins").json["origins"])

    def preview(self, faces: int = 100000, format: str = "glb", progress: Optional[Progress] = None) -> bytes:
        """Returns a simplified mesh for display as a glb or ply file. Blocks until the daemon has
        built the file."""
        tell = listener(progress)
        while True:
            answer = self.client.call("GET", self.location + "/preview", {"faces": faces, "format": format})
            if answer.status != 202:
                return answer.body
            if tell:
                tell(answer.json["progress"])
            time.sleep(PREVIEW_WAIT)


class Batch(Dict[str, Any]):
    """The last known state of a batch: `id`, `state` (running, done, cancelled), `items`, `done`,
    `failed`, `progress`."""

    def __init__(self, client: "Client", answer: Mapping[str, Any]):
        super().__init__(answer)
        self._client = client

    def refresh(self) -> "Batch":
        """Reads the state of the batch again."""
        self.update(self._client.batch(self["id"]))
        return self

    def wait(self, progress: Optional[Progress] = None) -> "Batch":
        """Waits until the batch has ended (`Client.wait_batch`)."""
        self.update(self._client.wait_batch(self["id"], progress))
        return self

    def results(self, wait: bool = False) -> Iterator[Dict[str, Any]]:
        """Yields the items that have an answer (`Client.batch_results`)."""
        return self._client.batch_results(self["id"], wait)

    def delete(self) -> None:
        """Cancels a running batch, or removes a batch that has ended."""
        self._client.delete_batch(self["id"])


class Client:
    """A client of one daemon. Thread-safe.

    url: the daemon's address: http://HOST:PORT, https://HOST:PORT or unix:PATH (default:
    $GEODESICD_URL, or http://127.0.0.1:8080). key: the access key, if the daemon requires one
    (default: $GEODESICD_KEY). timeout: a request fails after this many seconds without a byte.
    retries: how often the client repeats a request if the daemon is busy or the connection fails.
    context: the TLS context.
    """

    def __init__(self, url: Optional[str] = None, key: Optional[str] = None, timeout: float = 120, retries: int = 5,
                 context: Optional[ssl.SSLContext] = None):
        url = url or os.environ.get("GEODESICD_URL") or DEFAULT_URL
        self.transport = Transport(url, key or os.environ.get("GEODESICD_KEY"), timeout, retries, context)

    @property
    def _batch_wait(self) -> int:
        """Seconds that one request waits for a batch, so that it does not reach the timeout."""
        return max(1, min(BATCH_WAIT, int((self.transport.timeout or 2 * BATCH_WAIT) / 2)))

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections. The next call opens a new connection."""
        self.transport.close()

    # --- calls -----------------------------------------------------------------------------------

    def call(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Any = None,
             headers: Optional[Mapping[str, str]] = None, progress: Optional[Progress] = None, repeatable: bool = True) -> Response:
        """Sends any request. With `progress` the request runs as a job, and the method waits for
        it. If the wait is interrupted, the method cancels the job. Set repeatable=False for
        requests that create something new each time. The client then does not repeat the request if
        the connection fails, or after a refusal without Retry-After. The daemon may have executed
        such a request although the method raises ConnectionFailed or Overloaded."""
        if progress is None or progress is False:
            return self.transport.request(method, path, query, body, headers, repeatable)
        job = self.submit(method, path, query, body, headers)
        try:
            return job.wait(progress).response()
        except GeodesicError:
            raise
        except BaseException:  # the user interrupts the call, or `progress` raises an exception
            with contextlib.suppress(GeodesicError):
                job.cancel()
            raise

    def submit(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Any = None,
               headers: Optional[Mapping[str, str]] = None) -> Job:
        """Starts any query or upload as a job. Does not wait for the job."""
        response = self.transport.request(method, path, query, body, {**(headers or {}), "Prefer": "respond-async"})
        if response.status != 202:
            raise GeodesicError(f"{method} {path} can't be a job")
        return Job(self.transport, response.json)

    def service(self) -> answers.Service:
        """Returns the daemon's version, limits and capabilities."""
        return cast(answers.Service, self.call("GET", "/v1").json)

    def job(self, id: str) -> Job:
        return Job(self.transport, self.call("GET", f"/v1/jobs/{id}").json)

    def pages(self, path: str, member: str, **query: Any) -> Iterator[Dict[str, Any]]:
        """Yields all entries of a list. Keywords are parameters of each request: prefix="a-"."""
        after = None
        while True:
            page = self.call("GET", path, {**query, "after": after}).json
            yield from page[member]
            after = page["next"]
            if after is None:
                return

    # --- batches ---------------------------------------------------------------------------------

    def create_batch(self, request: Mapping[str, Any]) -> Batch:
        """Starts a batch, which is a query for many sources. It continues without this client and
        across restarts of the daemon. `request` is as in the contract: {"query": "all-pairs",
        "mesh", "vertices"} or {"query": "fields", "meshes", "set"}. After ConnectionFailed the
        batch may exist: GET /v1/batches lists all batches (`pages`)."""
        return Batch(self, self.call("POST", "/v1/batches", None, dict(request), repeatable=False).json)

    def batch(self, id: str) -> Batch:
        """Reads the state of a batch."""
        return Batch(self, self.call("GET", f"/v1/batches/{id}").json)

    def wait_batch(self, id: str, progress: Optional[Progress] = None) -> Batch:
        """Waits until a batch has ended. Calls `progress` about once a second with the fraction of
        finished work, in [0,1]."""
        tell = listener(progress)
        while True:
            batch = self.call("GET", f"/v1/batches/{id}", {"wait": 1 if tell else self._batch_wait}).json
            if tell:
                tell(batch["progress"])
            if batch["state"] != "running":
                return Batch(self, batch)

    def batch_results(self, id: str, wait: bool = False) -> Iterator[Dict[str, Any]]:
        """Yields the items that have an answer now, in the order of the request. An item has an
        `answer`, or a `problem` if it failed. With `wait` yields each item as soon as it has an
        answer, until the batch has ended."""
        if not wait:
            yield from self.pages(f"/v1/batches/{id}/results", "results")
            return
        cursor: Any = 0
        while cursor is not None:
            page = self.call("GET", f"/v1/batches/{id}/results", {"cursor": cursor, "wait": self._batch_wait}).json
            yield from page["results"]
            cursor = page["next"]

    def delete_batch(self, id: str) -> None:
        """Cancels a running batch, or removes a batch that has ended."""
        self.call("DELETE", f"/v1/batches/{id}")

    # --- surfaces --------------------------------------------------------------------------------

    def meshes(self, prefix: Optional[str] = None) -> Iterator[answers.Mesh]:
        """Yields the descriptions of all meshes, or of meshes whose names begin with `prefix`."""
        return cast(Iterator[answers.Mesh], self.pages("/v1/meshes", "meshes", prefix=prefix))

    def mesh(self, name: str) -> Mesh:
        """Returns the mesh with this name. Sends no request."""
        return Mesh(self, name)

    def upload(self, name: Optional[str], content: Union[str, "os.PathLike[str]", bytes, Tuple[Any, Any]], format: Optional[str] = None,
               weld: Optional[float] = None, repair: Optional[str] = None, progress: Optional[Progress] = None,
               description: Optional[str] = None, edits: Optional[Mapping[str, int]] = None) -> Mesh:
        """Creates or replaces a mesh. `content` is the path of a file, the bytes of a file, or
        (vertices, faces): rows of three coordinates and rows of vertex indices, as lists or arrays.
        Arrays are sent in binary form. If `name` is None, the daemon derives the name from the
        content. A non-manifold mesh raises InvalidMesh, unless weld=TOLERANCE or repair="split"
        repairs it. `description` is a short text for people; without it a replaced mesh keeps its
        description. The daemon applies `edits` before it stores the mesh: {"fill": 1000,
        "simplify": 50000}."""
        query = {"format": format, "weld": weld, "repair": repair, "description": description, **(edits or {})}
        headers: Dict[str, str] = {}
        body: Any = content
        if isinstance(content, list) and len(content) == 2:
            content = (content[0], content[1])
        if isinstance(content, tuple) and numpy is not None and any(hasattr(part, "dtype") for part in content):
            body = ply.write(*content)
        elif isinstance(content, tuple):
            vertices, faces = ([list(row) for row in points.listed(part)] for part in content)
            body = {"vertices": vertices, "faces": faces}
        elif not isinstance(content, (bytes, bytearray, memoryview)):
            body = pathlib.Path(content).read_bytes()
        if not isinstance(body, dict):
            headers["Content-Type"] = FLOATS  # the daemon detects the format from the bytes
        path = "/v1/meshes" if name is None else "/v1/meshes/" + urllib.parse.quote(name, safe="")
        answer = self.call("POST" if name is None else "PUT", path, query, body, headers, progress)
        return Mesh(self, answer.json["name"])

    def subdivision(self, name: str) -> Surface:
        """Returns the subdivision surface with this name. Sends no request."""
        return Surface(self, "subdivisions", name)

    def nurbs(self, name: str) -> Surface:
        """Returns the NURBS with this name. Sends no request."""
        return Surface(self, "nurbs", name)
