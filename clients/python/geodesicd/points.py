"""Points of a surface, as they are asked about and as they come back."""
from __future__ import annotations

import dataclasses
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

Vec3 = Tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Point:
    """A point of a surface. `face`, `barycentric` and `xyz` are always known of one that comes back; `vertex`, or `edge` and `t`, when it lies on one.
    It can be asked about in turn."""

    face: Optional[int] = None
    barycentric: Optional[Vec3] = None
    xyz: Optional[Vec3] = None
    vertex: Optional[int] = None
    edge: Optional[Tuple[int, int]] = None
    t: Optional[float] = None
    snap_distance: Optional[float] = None

    @classmethod
    def read(cls, answer: Mapping[str, Any]) -> "Point":
        """Of an answer's point."""
        known = {field.name: answer[field.name] for field in dataclasses.fields(cls) if answer.get(field.name) is not None}
        return cls(**{name: tuple(value) if isinstance(value, list) else value for name, value in known.items()})

    def as_json(self) -> Dict[str, Any]:
        """The most exact of what is known."""
        if self.vertex is not None:
            return {"vertex": self.vertex}
        if self.edge is not None:
            return {"edge": list(self.edge), "t": self.t}
        if self.face is not None and self.barycentric is not None:
            return {"face": self.face, "barycentric": list(self.barycentric)}
        if self.xyz is None:
            raise ValueError("a point needs a vertex, an edge with t, a face with barycentric, or xyz")
        return {"xyz": list(self.xyz)}


PointLike = Union[Point, int, str, Mapping[str, Any], Sequence[float]]


def ray(origin: Sequence[float], direction: Sequence[float]) -> Dict[str, Any]:
    """The first point of the surface that the ray hits."""
    return {"ray": {"origin": [float(x) for x in origin], "direction": [float(x) for x in direction]}}


def near(xyz: Sequence[float], max_snap: Optional[float] = None) -> Dict[str, Any]:
    """The point of the surface nearest to a place in space, which may be `max_snap` away."""
    point: Dict[str, Any] = {"xyz": [float(x) for x in xyz]}
    return point if max_snap is None else {**point, "max_snap": float(max_snap)}


def as_json(point: PointLike) -> Dict[str, Any]:
    """What the daemon takes for a point, of: a Point; the index of a vertex; three coordinates (the nearest point); the compact forms "v:12",
    "e:3-9:0.25", "f:34:0.2,0.3,0.5", "p:1,2,3"; or a dictionary as the contract has it."""
    if isinstance(point, Point):
        return point.as_json()
    if isinstance(point, Mapping):
        return dict(point)
    if isinstance(point, str):
        return _read_compact(point)
    if hasattr(point, "__index__"):
        return {"vertex": point.__index__()}
    coordinates = [float(x) for x in point]  # type: ignore[union-attr]
    if len(coordinates) != 3:
        raise ValueError(f"a place in space has three coordinates, not {len(coordinates)}")
    return {"xyz": coordinates}


def all_as_json(points: Sequence[PointLike]) -> List[Dict[str, Any]]:
    return [as_json(point) for point in points]


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
    raise ValueError(f"{text!r} is no point; write v:12, e:3-9:0.25, f:34:0.2,0.3,0.5 or p:1,2,3")
