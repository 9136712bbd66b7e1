"""Points of a surface in requests and in answers."""
from __future__ import annotations

import array
import dataclasses
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

Vec3 = Tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Point:
    """A point of a surface, for requests and in answers. A point of an answer always has `face`,
    `barycentric` and `xyz`. It has `vertex` if it lies on a vertex, `edge` and `t` if it lies on an
    edge."""

    face: Optional[int] = None
    barycentric: Optional[Vec3] = None
    xyz: Optional[Vec3] = None
    vertex: Optional[int] = None
    edge: Optional[Tuple[int, int]] = None
    t: Optional[float] = None
    snap_distance: Optional[float] = None

    @classmethod
    def read(cls, answer: Mapping[str, Any]) -> "Point":
        """Reads a point of an answer."""
        known = {field.name: answer[field.name] for field in dataclasses.fields(cls) if answer.get(field.name) is not None}
        values: Dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in known.items()}
        return cls(**values)

    def as_json(self) -> Dict[str, Any]:
        """Returns the most exact form of the point that a request can have."""
        if self.vertex is not None:
            return {"vertex": self.vertex}
        if self.edge is not None:
            return {"edge": list(self.edge), "t": self.t}
        if self.face is not None and self.barycentric is not None:
            return {"face": self.face, "barycentric": list(self.barycentric)}
        if self.xyz is None:
            raise ValueError("a point needs a vertex, an edge with t, a face with barycentric, or xyz")
        return {"xyz": list(self.xyz)}


# Arrays are Any, since numpy is optional.
PointLike = Union[Point, int, str, Mapping[str, Any], Sequence[float], Any]
Points = Union[Sequence[PointLike], Any]


def ray(origin: Sequence[float], direction: Sequence[float]) -> Dict[str, Any]:
    """Returns, as a point of a request, the first surface point that the ray hits."""
    return {"ray": {"origin": [float(x) for x in origin], "direction": [float(x) for x in direction]}}


def near(xyz: Sequence[float], max_snap: Optional[float] = None) -> Dict[str, Any]:
    """Returns, as a point of a request, the surface point nearest to a point in space. The daemon
    reports an error if their distance exceeds `max_snap`."""
    point: Dict[str, Any] = {"xyz": [float(x) for x in xyz]}
    return point if max_snap is None else {**point, "max_snap": float(max_snap)}


def as_json(point: PointLike) -> Dict[str, Any]:
    """Converts a point to the form of the contract. It may be a Point; the index of a vertex; three
    coordinates (the nearest point), also as a row of an array; a compact form ("v:12",
    "e:3-9:0.25", "f:34:0.2,0.3,0.5", "p:1,2,3"); or a dictionary as in the contract."""
    point = listed(point)
    if isinstance(point, Point):
        return point.as_json()
    if isinstance(point, Mapping):
        return dict(point)
    if isinstance(point, str):
        return _read_compact(point)
    if hasattr(point, "__index__") and not isinstance(point, bool):
        return {"vertex": point.__index__()}
    if isinstance(point, (bool, float)) or len(point) != 3:
        raise ValueError(f"{point!r} is not a point; give the index of a vertex, or three coordinates")
    return {"xyz": [float(x) for x in point]}


def listed(values: Any) -> Any:
    """Converts a numpy array to a list, a numpy mask to the list of its true indices, and a flat
    array.array of more than three floats to a list of rows of three. Returns other values
    unchanged."""
    if getattr(values, "dtype", None) == bool and values.ndim == 1:
        values = values.nonzero()[0]
    if isinstance(values, array.array) and values.typecode in "fd" and len(values) > 3:
        return [values[i:i + 3].tolist() for i in range(0, len(values), 3)]
    return values.tolist() if hasattr(values, "tolist") else values


def is_place(values: Any) -> bool:
    """Returns whether values are three numbers that are not all integers: coordinates."""
    return len(values) == 3 and any(isinstance(x, float) for x in values) and all(isinstance(x, (int, float)) for x in values)


def all_as_json(points: Points) -> List[Dict[str, Any]]:
    """Converts a sequence of points, an array of vertex indices, or rows of coordinates to the form
    of the contract."""
    return [as_json(point) for point in listed(points)]


def _read_compact(text: str) -> Dict[str, Any]:
    try:
        kind, _, rest = text.partition(":")
        if kind == "v":
            return {"vertex": int(rest)}
        if kind == "e":
            edge, _, t = rest.partition(":")
            first, _, second = edge.partition("-")
            return {"edge": [int(first), int(second)], "t": float(t)}
        if kind == "f":
            face, _, weights = rest.partition(":")
            return {"face": int(face), "barycentric": [float(x) for x in weights.split(",")]}
        if kind == "p":
            return {"xyz": [float(x) for x in rest.split(",")]}
    except ValueError:
        pass
    raise ValueError(f"{text!r} is not a point; write v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1,2,3")
