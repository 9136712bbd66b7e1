"""Exact geodesics on surfaces, from a geodesicd daemon. Needs only the standard library; arrays are
numpy arrays if numpy is installed.

    import geodesicd

    client = geodesicd.Client()                          # http://127.0.0.1:8080
    bunny = client.upload("bunny", "bunny.obj")
    bunny.distance(12, 9000)                             # between two vertices
    bunny.path("v:12", (0.01, 0.12, 0.03)).points        # to the surface point nearest to (x, y, z)
    bunny.field([0, 100]).values()                       # a distance per vertex
    bunny.query("trace", {"start": {"vertex": 12}, "fan": 8, "length": 0.05})["paths"]
"""
from .aio import AsyncClient
from .client import Batch, Client, Field, Mesh, Path, Resource, Surface, point_set
from .errors import (BadAnswer, Conflict, ConnectionFailed, DeadlineExceeded, Forbidden, GeodesicError, Insufficient, InvalidMesh, InvalidRequest, JobCancelled,
                     NotFound, Overloaded, PointNotOnSurface, ProblemError, TooLarge, Unauthorized)
from .jobs import Job
from .points import Point, near, ray

__version__ = "0.1.0"

__all__ = [
    "AsyncClient", "BadAnswer", "Batch", "Client", "Conflict", "ConnectionFailed", "DeadlineExceeded", "Field", "Forbidden", "GeodesicError", "Insufficient", "InvalidMesh", "InvalidRequest",
    "Job", "JobCancelled", "Mesh", "NotFound", "Overloaded", "Path", "Point", "PointNotOnSurface", "ProblemError", "Resource", "Surface", "TooLarge",
    "Unauthorized", "near", "point_set", "ray"
]
