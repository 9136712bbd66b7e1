"""Converts arrays to binary PLY files and back. Binary numbers stay exact."""
from __future__ import annotations

import array
import struct
from typing import Any, Tuple

from .arrays import little, numpy

_HEAD = """ply
format binary_little_endian 1.0
element vertex {}
property double x
property double y
property double z
element face {}
property list uchar uint vertex_indices
end_header
"""


def write(vertices: Any, faces: Any) -> bytes:
    """Returns a PLY file. `vertices` has rows of three coordinates, `faces` has rows of vertex
    indices. Needs numpy."""
    points, corners = numpy.asarray(vertices), numpy.asarray(faces)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"vertices are rows of three coordinates, not of the shape {points.shape}")
    if corners.ndim != 2 or corners.dtype.kind not in "iu":
        raise ValueError(f"faces are rows of whole numbers, not {corners.dtype} of the shape {corners.shape}")
    if corners.size and not 0 <= corners.min() <= corners.max() < len(points):
        raise ValueError(f"faces name vertices from 0 to {len(points) - 1}, not {corners.min()} or {corners.max()}")
    rows = numpy.empty(len(corners), [("count", "u1"), ("corners", "<u4", (corners.shape[1],))])
    rows["count"], rows["corners"] = corners.shape[1], corners
    return b"".join([_HEAD.format(len(points), len(corners)).encode(), points.astype("<f8").tobytes(), rows.tobytes()])


def read(body: bytes) -> Tuple[Any, Any]:
    """Returns (vertices, faces) as rows of three: numpy arrays, or array.array if numpy is missing.
    Reads binary PLY only in the form that the daemon writes."""
    start = body.index(b"end_header\n") + len(b"end_header\n")
    vertices, faces = (int(line.split()[2]) for line in body[:start].splitlines() if line.startswith(b"element "))
    middle = start + 24 * vertices
    if numpy is None:
        corners = array.array("I", (index for row in struct.iter_unpack("<xIII", body[middle:]) for index in row))
        return little(array.array("d", body[start:middle])), corners
    rows = numpy.frombuffer(body, [("count", "u1"), ("corners", "<u4", 3)], faces, middle)
    return numpy.frombuffer(bytearray(body[start:middle]), "<f8").reshape(vertices, 3), rows["corners"].copy()
