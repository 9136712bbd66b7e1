"""Work that takes long: its progress, its result, its end."""
from __future__ import annotations

import json
from typing import Any, Callable, Dict, Optional

from .errors import JobCancelled
from .transport import Response, Transport

Progress = Callable[[float], None]


class Job:
    """A request that was accepted to be worked on (202). The daemon keeps its result for a while.

    Attributes: `id`, `state` (queued, running, done, failed, cancelled), `progress` (in [0,1]), as last heard of.
    """

    def __init__(self, transport: Transport, answer: Dict[str, Any]):
        self._transport = transport
        self.id: str = answer["id"]
        self._hear(answer)

    def __repr__(self) -> str:
        return f"<Job {self.id}: {self.state}, {self.progress:.0%}>"

    def _hear(self, answer: Dict[str, Any]) -> None:
        self.state: str = answer["state"]
        self.progress: float = answer["progress"]

    @property
    def is_over(self) -> bool:
        return self.state in ("done", "failed", "cancelled")

    def refresh(self) -> "Job":
        """Asks how far it is."""
        self._hear(self._transport.request("GET", f"/v1/jobs/{self.id}").json)
        return self

    def wait(self, progress: Optional[Progress] = None) -> "Job":
        """Until it is over; `progress` is told how far it is, ten times a second at most."""
        while not self.is_over:
            for _, data in self._transport.events(f"/v1/jobs/{self.id}/events"):
                self._hear(json.loads(data))
                if progress:
                    progress(self.progress)
        return self

    def response(self) -> Response:
        """The answer as it would have come at once, of a job that is over; the exception of its problem if it failed."""
        if self.state == "cancelled":
            raise JobCancelled(f"job {self.id} has been cancelled")
        return self._transport.request("GET", f"/v1/jobs/{self.id}/result")

    def cancel(self) -> None:
        """Stops it, within milliseconds. A job that is over is forgotten."""
        self._transport.request("DELETE", f"/v1/jobs/{self.id}")
