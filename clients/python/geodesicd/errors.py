"""What a daemon answers when it can't do what it was asked for, as exceptions: one class a code of the contract."""
from __future__ import annotations

from typing import Any, Dict, List, Optional, Type


class GeodesicError(Exception):
    """Any failure of a call. The text is the daemon's sentence, which tells what to change."""


class ConnectionFailed(GeodesicError):
    """No answer came: the daemon is not there, hung up, or took longer than the client's timeout."""


class ProblemError(GeodesicError):
    """An answer that is a problem (RFC 9457).

    Attributes: `status` (of HTTP), `code`, `detail`, and where it applies `pointer` (into the body that was sent), `parameter` (of the query
    string), `limit` (the maximum that was passed), `elements` (the first offending ones), `retry_after` (seconds), `request_id`.
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
    """unauthorized: no key, or a wrong one."""


class Forbidden(ProblemError):
    """forbidden: the key may only read."""


class NotFound(ProblemError):
    """not_found: no such mesh, field, job or path."""


class Conflict(ProblemError):
    """conflict or precondition_failed."""


class TooLarge(ProblemError):
    """too_large: beyond a limit, which is `limit`."""


class InvalidMesh(ProblemError):
    """invalid_mesh: bytes that are no surface; `reason` and `elements` say why and where."""


class PointNotOnSurface(ProblemError):
    """point_not_on_surface: a ray without a hit, or max_snap was exceeded."""


class Overloaded(ProblemError):
    """overloaded, draining, store_unavailable or rate_limited: still so after the client's retries."""


class DeadlineExceeded(ProblemError):
    """deadline_exceeded."""


class Insufficient(ProblemError):
    """insufficient_memory or insufficient_storage."""


class JobCancelled(GeodesicError):
    """The job that was awaited has been cancelled."""


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

# Of answers without a body (HEAD), or that come from something in between.
_CODES = {400: "invalid_request", 401: "unauthorized", 403: "forbidden", 404: "not_found", 409: "conflict", 412: "precondition_failed",
          413: "too_large", 429: "rate_limited", 503: "overloaded", 504: "deadline_exceeded"}


def problem_error(problem: Dict[str, Any], status: int, request_id: str = "", retry_after: Optional[float] = None) -> ProblemError:
    """The exception of a problem's code; of one that this client does not know, a ProblemError."""
    problem = {"code": _CODES.get(status, ""), **problem}
    return _CLASSES.get(problem["code"], ProblemError)(problem, status, request_id, retry_after)
