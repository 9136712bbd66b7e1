"""The daemon and what it holds: meshes, their fields, smooth surfaces, jobs."""
from __future__ import annotations

import array
import dataclasses
import os
import pathlib
import ssl
import sys
import urllib.parse
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Union

from . import arrays, points
from .errors import GeodesicError, NotFound
from .jobs import Job, Progress
from .points import Point, PointLike, Vec3
from .transport import Response, Transport

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

DEFAULT_URL = "http://127.0.0.1:8080"
FLOATS = "application/octet-stream"
BATCH_WAIT = 30  # seconds, of one request that waits for a batch


@dataclasses.dataclass(frozen=True)
class Path:
    """A path on the surface: its length, and its corners from the first to the last."""

    length: float
    points: List[Vec3]

    @classmethod
    def read(cls, answer: Mapping[str, Any]) -> "Path":
        return cls(answer["length"], [tuple(xyz) for xyz in answer["points"]])


def _floats(body: bytes) -> Any:
    """Of little-endian float64: a numpy array, or without numpy an array.array."""
    if numpy is not None:
        return numpy.frombuffer(body, dtype="<f8")
    values = array.array("d", body)
    if sys.byteorder == "big":
        values.byteswap()
    return values


def point_set(sources: Union[Mapping[str, Any], PointLike, Sequence[PointLike]]) -> Dict[str, Any]:
    """A set as the contract has it, of: such a set; a point; a list of points."""
    if isinstance(sources, Mapping) and sources.keys() & {"points", "curves", "boundaries"}:
        return dict(sources)
    if isinstance(sources, (list, tuple)) and not (len(sources) == 3 and all(isinstance(x, float) for x in sources)):
        return {"points": points.all_as_json(sources)}
    return {"points": [points.as_json(sources)]}  # type: ignore[arg-type]


class Resource:
    """What lies at a path of the daemon, and is asked there."""

    def __init__(self, client: "Client", location: str):
        self.client, self.location = client, location

    def query(self, name: str, body: Mapping[str, Any], *, progress: Optional[Progress] = None, **query: Any) -> Dict[str, Any]:
        """Any query of the contract: the answer to POST `location`/`name`. Keywords go into the query string (`select`, `geometry`, `timeout_ms`). With
        `progress` it is a job that is awaited, and `progress` is told how far it is."""
        return self.client.call("POST", f"{self.location}/{name}", query, body, progress=progress).json

    def query_arrays(self, name: str, body: Mapping[str, Any], *, form: str = "f64", **query: Any) -> Dict[str, Any]:
        """The same as arrays by name (`matrix`, `isolines`, `trace`, `voronoi`, …): numpy's, or without numpy an array.array each, row after row; with the
        form "f32" of single precision."""
        return arrays.read(self.client.call("POST", f"{self.location}/{name}", {**query, "format": form}, body).body)

    def _bulk(self, name: str, given: Mapping[str, Any]) -> Dict[str, Any]:
        headers = {"Content-Type": arrays.MEDIA_TYPE}
        return arrays.read(self.client.call("POST", f"{self.location}/{name}", {"format": "f64"}, arrays.write(given), headers).body)

    def delete(self) -> None:
        self.client.call("DELETE", self.location)

    def describe(self) -> Dict[str, Any]:
        return self.client.call("GET", self.location).json

    def exists(self) -> bool:
        try:
            self.client.call("HEAD", self.location)
            return True
        except NotFound:
            return False


class Surface(Resource):
    """A surface that has a name: a mesh, a subdivision surface, a NURBS."""

    def __init__(self, client: "Client", kind: str, name: str):
        super().__init__(client, f"/v1/{kind}/{urllib.parse.quote(name, safe='')}")
        self.name = name

    def __repr__(self) -> str:
        return f"<{self.location}>"


class Field(Resource):
    """The distances from a set to the whole surface, kept by the daemon."""

    def __init__(self, mesh: "Mesh", answer: Dict[str, Any]):
        super().__init__(mesh.client, f"{mesh.location}/fields/{answer['id']}")
        self.id: str = answer["id"]
        self.max: Optional[float] = answer["max"]
        self.farthest = Point.read(answer["farthest"]) if answer.get("farthest") else None

    def values(self) -> Any:
        """The distance at each vertex, NaN where there is none: a numpy array, or an array.array("d")."""
        return _floats(self.client.call("GET", self.location + "/values", headers={"Accept": FLOATS}).body)

    def file(self, format: str = "ply") -> bytes:
        """The mesh with the distance at each vertex, as a file: ply, glb (as colours) or csv (a row per vertex)."""
        return self.client.call("GET", self.location + "/values", {"format": format}).body

    def distances(self, at: Sequence[PointLike]) -> List[Optional[float]]:
        """The distance at each point; None where there is none."""
        results = self.query("evaluate", {"points": points.all_as_json(at)}, select="distance")["results"]
        return [result["distance"] for result in results]

    def evaluate(self, at: Sequence[PointLike], path: bool = False, gradient: bool = False) -> List[Dict[str, Any]]:
        """At each point the distance, the nearest member of the set, and what is asked for."""
        body = {"points": points.all_as_json(at), "path": path, "gradient": gradient}
        return self.query("evaluate", body)["results"]

    def isolines(self, levels: Sequence[float], tolerance: Optional[float] = None) -> List[Dict[str, Any]]:
        """For each level its lines; flattened to `tolerance` within faces, or without it to the daemon's own."""
        return self.query("isolines", self._levels(levels, tolerance))["isolines"]

    def isolines_file(self, levels: Sequence[float], format: str = "obj", tolerance: Optional[float] = None, mesh: bool = False) -> bytes:
        """The lines of all levels as a file: obj, glb or csv; `mesh`: with their mesh, of obj and glb."""
        query = {"format": format, "mesh": mesh or None}
        return self.client.call("POST", self.location + "/isolines", query, self._levels(levels, tolerance)).body

    @staticmethod
    def _levels(levels: Sequence[float], tolerance: Optional[float]) -> Dict[str, Any]:
        return {"levels": list(levels), **({} if tolerance is None else {"tolerance": tolerance})}


class Mesh(Surface):
    """A triangle mesh. Points are given in any of the forms of `geodesicd.points.as_json`."""

    def __init__(self, client: "Client", name: str):
        super().__init__(client, "meshes", name)

    def distance(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = ()) -> Optional[float]:
        """The exact distance; None if no path joins the points."""
        return self.query("distance", self._ends(start, end, via), select="distance")["distance"]

    def path(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = ()) -> Optional[Path]:
        """A shortest path; None if there is none."""
        answer = self.query("path", self._ends(start, end, via), select="path", geometry="xyz")
        return Path.read(answer["path"]) if answer.get("path") else None

    def path_file(self, start: PointLike, end: PointLike, via: Sequence[PointLike] = (), format: str = "obj", mesh: bool = False) -> bytes:
        """A shortest path as a file: obj, glb, csv, or svg (the faces that it runs through, laid flat); of obj and glb with its mesh, if wanted."""
        query = {"format": format, "mesh": mesh or None}
        return self.client.call("POST", self.location + "/path", query, self._ends(start, end, via)).body

    @staticmethod
    def _ends(start: PointLike, end: PointLike, via: Sequence[PointLike]) -> Dict[str, Any]:
        body: Dict[str, Any] = {"from": points.as_json(start), "to": points.as_json(end)}
        return {**body, "via": points.all_as_json(via)} if via else body

    def nearest(self, point: PointLike) -> Point:
        """The point of the surface that is meant, with all that is known of it."""
        return Point.read(self.query("nearest", {"point": points.as_json(point)}))

    def pairs(self, starts: Any, ends: Any) -> Any:
        """The distance of each pair of a start and an end, NaN where there is no path. Both are arrays or lists: of vertices, or of rows of three
        coordinates, whose nearest points are taken; one of them may have one point for all pairs."""
        return self._bulk("pairs", {"from": starts, "to": ends})["distances"]

    def nearest_points(self, xyz: Any) -> Dict[str, Any]:
        """The nearest points of the surface to rows of three coordinates: arrays `faces`, `barycentric`, `xyz`, `snap_distances`."""
        return self._bulk("nearest-points", {"points": xyz})

    def matrix(self, sources: Sequence[PointLike], targets: Sequence[PointLike], max_distance: Optional[float] = None,
               progress: Optional[Progress] = None) -> Any:
        """The distances from each source to each target, NaN where there is none: a numpy array, or without numpy a list of array.array."""
        body: Dict[str, Any] = {"sources": points.all_as_json(sources), "targets": points.all_as_json(targets)}
        if max_distance is not None:
            body["max_distance"] = max_distance
        values = _floats(self.client.call("POST", self.location + "/matrix", None, body, {"Accept": FLOATS}, progress).body)
        if numpy is not None:
            return values.reshape(len(sources), len(targets))
        return [values[row * len(targets):(row + 1) * len(targets)] for row in range(len(sources))]

    def field(self, sources: Any, max_distance: Optional[float] = None, progress: Optional[Progress] = None) -> Field:
        """The distances from a point, points or a set (`point_set`) to all of the surface. The same request gives the same field again."""
        body: Dict[str, Any] = {"set": point_set(sources)}
        if max_distance is not None:
            body["max_distance"] = max_distance
        return Field(self, self.query("fields", body, progress=progress))

    def distance_to_set(self, sources: Any, at: Sequence[PointLike], path: bool = False) -> List[Dict[str, Any]]:
        """At each point the distance to the nearest member of a set, and which it is."""
        return self.query("distance-to-set", {"set": point_set(sources), "points": points.all_as_json(at), "path": path})["results"]

    def picture(self, form: str = "png", **query: Any) -> bytes:
        """A rendered picture, a file of form png or svg. Keywords as the contract has them, points in compact form: source="v:12", view="iso",
        size="800x600", **{"from": "v:3"}, to="v:7", ..."""
        return self.client.call("GET", f"{self.location}/picture.{form}", query).body

    def content(self, format: str = "obj") -> bytes:
        """The mesh as a file: obj, ply, off, stl, glb or gltf."""
        return self.client.call("GET", self.location + "/content", {"format": format}).body


class Client:
    """A daemon.

    url: where it is (default: $GEODESICD_URL, or http://127.0.0.1:8080); also https:// and unix:PATH. key: of a daemon that wants one (default:
    $GEODESICD_KEY). timeout: seconds without a byte. retries: how often a request is sent again that a busy daemon turned away. context: of TLS.
    Thread-safe.
    """

    def __init__(self, url: Optional[str] = None, key: Optional[str] = None, timeout: float = 120, retries: int = 5,
                 context: Optional[ssl.SSLContext] = None):
        url = url or os.environ.get("GEODESICD_URL", DEFAULT_URL)
        self.transport = Transport(url, key or os.environ.get("GEODESICD_KEY"), timeout, retries, context)

    def __enter__(self) -> "Client":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections; the next call opens another one."""
        self.transport.close()

    # --- calls -----------------------------------------------------------------------------------------------------------

    def call(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Any = None,
             headers: Optional[Mapping[str, str]] = None, progress: Optional[Progress] = None, repeatable: bool = True) -> Response:
        """Any request; with `progress` as a job that is awaited. What is not repeatable, as it makes something new each time, is not sent again when
        its connection fails: ConnectionFailed, and it may have been done."""
        if progress is None:
            return self.transport.request(method, path, query, body, headers, repeatable)
        return self.submit(method, path, query, body, headers).wait(progress).response()

    def submit(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Any = None,
               headers: Optional[Mapping[str, str]] = None) -> Job:
        """Any query or upload as a job, which is not awaited."""
        response = self.transport.request(method, path, query, body, {**(headers or {}), "Prefer": "respond-async"})
        if response.status != 202:
            raise GeodesicError(f"{method} {path} can't be a job")
        return Job(self.transport, response.json)

    def service(self) -> Dict[str, Any]:
        """The daemon's version, limits and capabilities."""
        return self.call("GET", "/v1").json

    def job(self, id: str) -> Job:
        return Job(self.transport, self.call("GET", f"/v1/jobs/{id}").json)

    def pages(self, path: str, member: str, **query: Any) -> Iterator[Dict[str, Any]]:
        """All entries of a list; keywords are parameters of each request, such as prefix="a-"."""
        after = None
        while True:
            page = self.call("GET", path, {**query, "after": after}).json
            yield from page[member]
            after = page["next"]
            if after is None:
                return

    # --- batches ---------------------------------------------------------------------------------------------------------

    def create_batch(self, request: Mapping[str, Any]) -> Dict[str, Any]:
        """Begins work of many sources, which outlives this client and the daemon: {"query": "all-pairs", "mesh", "vertices"} or {"query": "fields",
        "meshes", "set"}, as the contract has it. The batch: its `id`, `state` (running, done, cancelled), `items`, `done`, `failed`, `progress`. After
        ConnectionFailed it may have begun all the same: GET /v1/batches lists those that have (`pages`)."""
        return self.call("POST", "/v1/batches", None, dict(request), repeatable=False).json

    def batch(self, id: str) -> Dict[str, Any]:
        """How far it is."""
        return self.call("GET", f"/v1/batches/{id}").json

    def wait_batch(self, id: str, progress: Optional[Progress] = None) -> Dict[str, Any]:
        """The batch, once it has ended. `progress` is called about once a second with the part that is done, in [0,1]."""
        while True:
            batch = self.call("GET", f"/v1/batches/{id}", {"wait": 1 if progress else BATCH_WAIT}).json
            if progress:
                progress(batch["progress"])
            if batch["state"] != "running":
                return batch

    def batch_results(self, id: str, wait: bool = False) -> Iterator[Dict[str, Any]]:
        """The items that have an answer by now, in their order: `answer`, or the `problem` of one that failed. With `wait` each item as soon as it is
        answered, until the batch has ended."""
        if not wait:
            yield from self.pages(f"/v1/batches/{id}/results", "results")
            return
        cursor: Any = 0
        while cursor is not None:
            page = self.call("GET", f"/v1/batches/{id}/results", {"cursor": cursor, "wait": BATCH_WAIT}).json
            yield from page["results"]
            cursor = page["next"]

    def delete_batch(self, id: str) -> None:
        """Cancels it; removes one that has ended."""
        self.call("DELETE", f"/v1/batches/{id}")

    # --- what it holds ---------------------------------------------------------------------------------------------------

    def meshes(self, prefix: Optional[str] = None) -> Iterator[Dict[str, Any]]:
        """The descriptions of all meshes, or of those whose names begin with `prefix`."""
        return self.pages("/v1/meshes", "meshes", prefix=prefix)

    def mesh(self, name: str) -> Mesh:
        """The mesh of that name; nothing is asked yet."""
        return Mesh(self, name)

    def upload(self, name: Optional[str], content: Union[str, os.PathLike, bytes, Tuple[Any, Any]], format: Optional[str] = None,
               weld: Optional[float] = None, repair: Optional[str] = None, progress: Optional[Progress] = None) -> Mesh:
        """Creates or replaces a mesh of a file (a path), of a file's bytes, or of (vertices, faces), as lists or arrays. Name None: one made of the
        content. What is no surface is refused with InvalidMesh, unless weld=TOLERANCE or repair="split" mends it."""
        query = {"format": format, "weld": weld, "repair": repair}
        headers: Dict[str, str] = {}
        body: Any = content
        if isinstance(content, tuple):
            vertices, faces = (part.tolist() if hasattr(part, "tolist") else [list(row) for row in part] for part in content)
            body = {"vertices": vertices, "faces": faces}
        elif not isinstance(content, (bytes, bytearray, memoryview)):
            body = pathlib.Path(content).read_bytes()
        if not isinstance(body, dict):
            headers["Content-Type"] = FLOATS  # the bytes tell what they are
        path = "/v1/meshes" if name is None else "/v1/meshes/" + urllib.parse.quote(name, safe="")
        answer = self.call("POST" if name is None else "PUT", path, query, body, headers, progress)
        return Mesh(self, answer.json["name"])

    def subdivision(self, name: str) -> Surface:
        """The limit surface of that name, to be asked by `query`."""
        return Surface(self, "subdivisions", name)

    def nurbs(self, name: str) -> Surface:
        """The NURBS of that name, to be asked by `query`."""
        return Surface(self, "nurbs", name)
