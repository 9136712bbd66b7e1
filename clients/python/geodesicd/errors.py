"""Exceptions of the client. Each error code of the contract belongs to one class."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Type


class GeodesicError(Exception):
    """A failed call. The message says what is wrong and what to change."""


class ConnectionFailed(GeodesicError):
    """The daemon did not answer: it does not run at this address, closed the connection, or took
    longer than the client's timeout."""


class BadAnswer(GeodesicError):
    """The answer does not match the contract: another program answers at this address."""


class ProblemError(GeodesicError):
    """An error that the daemon reports (RFC 9457).

    Attributes: `status` (HTTP status), `code`, `detail`. These may be absent: `pointer` (into the
    request's body), `parameter` (of the query string), `reason`, `limit` (the maximum that the
    request exceeds), `elements` (the first offending ones), `retry_after` (seconds), `request_id`.
    """

    def __init__(self, problem: Dict[str, Any], status: int, request_id: str = "", retry_after: Optional[float] = None):
        self.problem = problem
        self.status = status
        self.code: str = problem.get("code", "")
        self.detail: str = problem.get("detail") or problem.get("title") or f"the answer has the status {status}"
        self.pointer: Optional[str] = problem.get("pointer")
        self.parameter: Optional[str] = problem.get("parameter")
        self.reason: Optional[str] = problem.get("reason")
        self.limit: Optional[float] = problem.get("limit")
        self.elements: List[Any] = problem.get("elements", [])
        self.request_id = request_id
        self.retry_after = retry_after
        super().__init__(self.detail + (f" (at {self.pointer})" if self.pointer else ""))


class InvalidRequest(ProblemError):
    """invalid_request: a wrong type, an unknown field, an index out of range, ..."""


class Unauthorized(ProblemError):
    """unauthorized: the request has no key, or a wrong key."""


class Forbidden(ProblemError):
    """forbidden: the key may only read."""


class NotFound(ProblemError):
    """not_found: the mesh, field, job or path does not exist."""


class Conflict(ProblemError):
    """conflict or precondition_failed."""


class TooLarge(ProblemError):
    """too_large: the request exceeds a limit of the daemon, `limit`."""


class InvalidMesh(ProblemError):
    """invalid_mesh: the upload is not a valid surface; `reason` and `elements` say why and
    where."""


class PointNotOnSurface(ProblemError):
    """point_not_on_surface: a ray has no hit, or a point is farther away than max_snap."""


class Overloaded(ProblemError):
    """overloaded, draining, store_unavailable or rate_limited: the daemon is still busy after all
    retries."""


class DeadlineExceeded(ProblemError):
    """deadline_exceeded: the request took longer than its timeout."""


class Insufficient(ProblemError):
    """insufficient_memory or insufficient_storage."""


class JobCancelled(GeodesicError):
    """The awaited job was cancelled."""


_CLASSES: Dict[str, Type[ProblemError]] = {
    "invalid_request": InvalidRequest,
    "unauthorized": Unauthorized,
    "forbidden": Forbidden,
    "not_found": NotFound,
    "conflict": Conflict,
    "precondition_failed": Conflict,
    "too_large": TooLarge,
    "invalid_mesh": InvalidMesh,
    "point_not_on_surface": PointNotOnSurface,
    "overloaded": Overloaded,
    "draining": Overloaded,
    "store_unavailable": Overloaded,
    "rate_limited": Overloaded,
    "deadline_exceeded": DeadlineExceeded,
    "insufficient_memory": Insufficient,
    "insufficient_storage": Insufficient,
}

# Codes for answers without a problem as body: answers to HEAD, and errors of proxies.
_CODES = {400: "invalid_request", 401: "unauthorized", 403: "forbidden", 404: "not_found", 409: "conflict", 412: "precondition_failed",
          413: "too_large", 429: "rate_limited", 503: "overloaded", 504: "deadline_exceeded"}


def problem_error(problem: Dict[str, Any], status: int, request_id: str = "", retry_after: Optional[float] = None) -> ProblemError:
    """Returns the exception for a problem's code; a ProblemError if the code is unknown."""
    problem = {"code": _CODES.get(status, ""), **problem}
    return _CLASSES.get(problem["code"], ProblemError)(problem, status, request_id, retry_after)
