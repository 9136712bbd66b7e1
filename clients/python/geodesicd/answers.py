"""Types of the answers. generate.py makes this file from proto/openapi.yaml; do not edit it."""
from typing import Any, Dict, List, Literal, TypedDict, Union


class Batch(TypedDict):
    id: str
    state: Literal["running", "done", "cancelled"]
    items: int
    done: int
    failed: int
    progress: float
    created: str


class _PointAnswer(TypedDict):
    face: int
    barycentric: List[float]
    xyz: List[float]


class PointAnswer(_PointAnswer, total=False):
    vertex: int
    edge: List[int]
    t: float
    snap_distance: float


class _Field(TypedDict):
    id: str
    wedges: int
    bytes: int
    build_ms: float
    max: Union[float, None]
    farthest: Union[PointAnswer, None]
    members: int
    max_distance: Union[float, None]
    set: Union[Dict[str, Any], None]
    created: str


class Field(_Field, total=False):
    reason: Literal["beyond_max_distance"]
    uses: int


class _PathPoint(TypedDict):
    xyz: List[float]


class PathPoint(_PathPoint, total=False):
    face: int
    barycentric: List[float]
    vertex: int
    edge: List[int]
    t: float


class Arc(TypedDict):
    face: int
    centre: List[float]
    radius: float
    start: float
    end: float


class _IsolineLinesItem(TypedDict):
    closed: bool
    length: float


class IsolineLinesItem(_IsolineLinesItem, total=False):
    points: List[Union[PathPoint, List[float]]]
    arcs: List[Arc]


class Isoline(TypedDict):
    level: float
    lines: List[IsolineLinesItem]


class JobResponse(TypedDict):
    status: int
    media_type: Union[str, None]
    bytes: int
    headers: Dict[str, Any]


class ProblemElementsItem(TypedDict, total=False):
    vertex: int
    edge: List[int]
    face: int
    line: int
    byte: int


class _Problem(TypedDict):
    type: str
    title: str
    status: int
    detail: str
    code: Literal["invalid_request", "unauthorized", "forbidden", "not_found", "method_not_allowed", "not_acceptable", "conflict", "field_evicted", "length_required", "precondition_failed", "too_large", "unsupported_media_type", "invalid_mesh", "point_not_on_surface", "rate_limited", "internal", "overloaded", "draining", "store_unavailable", "deadline_exceeded", "insufficient_memory", "insufficient_storage"]


class Problem(_Problem, total=False):
    pointer: str
    parameter: str
    reason: str
    limit: int
    elements: List[ProblemElementsItem]


class _Job(TypedDict):
    id: str
    state: Literal["queued", "running", "done", "failed", "cancelled"]
    progress: float
    created: str
    request: str


class Job(_Job, total=False):
    response: JobResponse
    result: Any
    problem: Problem


class BoundaryLoop(TypedDict):
    vertices: int
    length: float


class MeshOrientation(TypedDict):
    flipped_faces: int


class MeshBoundingBox(TypedDict):
    min: List[float]
    max: List[float]


class MeshEdgeLength(TypedDict):
    min: float
    mean: float
    max: float


class MeshRepairFirst(TypedDict, total=False):
    edges_split: List[List[int]]
    vertices_split: List[List[int]]
    vertices_welded: List[List[int]]
    vertices_merged: List[List[int]]
    duplicate_faces: List[List[int]]
    degenerate_faces: List[int]
    edges_flipped: List[List[int]]
    faces_cut: List[List[int]]
    lines_skipped: List[int]


class _MeshRepair(TypedDict):
    edges_split: int
    vertices_split: int
    vertices_welded: int
    vertices_merged: int
    duplicate_faces: int
    degenerate_faces: int
    edges_flipped: int
    largest_shift: float
    vertices_copied: int
    copies: List[List[int]]
    first: MeshRepairFirst


class MeshRepair(_MeshRepair, total=False):
    faces_cut: int
    lines_skipped: int


class _MeshDerivedFrom(TypedDict):
    etag: str
    largest_distance: float
    operations: List[Dict[str, Any]]


class MeshDerivedFrom(_MeshDerivedFrom, total=False):
    mesh: str


class _Mesh(TypedDict):
    name: str
    sha256: str
    index_count: int
    vertices: int
    faces: int
    edges: int
    components: int
    boundaries: List[BoundaryLoop]
    euler_characteristic: int
    genus: int
    orientation: MeshOrientation
    area: float
    bounding_box: MeshBoundingBox
    edge_length: MeshEdgeLength
    degenerate_faces: int
    saddle_vertices: int
    unreferenced_vertices: int
    repair: MeshRepair
    memory_bytes: int
    fields_cached: int
    created: str
    etag: str


class Mesh(_Mesh, total=False):
    boundary_count: int
    derived_from: MeshDerivedFrom
    description: str


class ResultNearest(TypedDict):
    index: int
    label: Union[str, None]
    point: PointAnswer


class _Path(TypedDict):
    length: float


class Path(_Path, total=False):
    points: List[Union[PathPoint, List[float]]]


class Direction(TypedDict):
    angle: float
    xyz: List[float]


class _Result(TypedDict):
    distance: Union[float, None]
    nearest: Union[ResultNearest, None]


class Result(_Result, total=False):
    reason: Literal["no_path", "beyond_max_distance"]
    path: Union[Path, None]
    gradient: Union[Direction, None]


class ServiceLimits(TypedDict):
    max_body_bytes: int
    max_faces: int
    timeout_ms: int
    memory_budget_bytes: int
    max_answer_bytes: int
    workers: int


class ServiceCapabilities(TypedDict):
    formats: List[str]
    queries: List[str]


class Service(TypedDict):
    version: str
    limits: ServiceLimits
    capabilities: ServiceCapabilities
