"""Jobs: slow requests that the daemon runs in the background."""
from __future__ import annotations

import json
import importlib
from typing import Any, Callable, Dict, Optional, Union

from .errors import ConnectionFailed, JobCancelled, Overloaded
from .transport import Response, Transport

Listener = Callable[[float], None]
Progress = Union[Listener, bool]  # True shows a tqdm bar, if tqdm is installed


def listener(progress: Optional[Progress]) -> Optional[Listener]:
    """Returns the function that receives the progress in [0,1], or None without such a function."""
    if not isinstance(progress, bool):
        return progress
    try:
        bar = importlib.import_module("tqdm.auto").tqdm(total=1.0, bar_format="{percentage:3.0f} %|{bar}| {elapsed}") if progress else None
    except ImportError:
        bar = None

    def tell(part: float) -> None:
        if bar is not None:
            bar.update(part - bar.n)
            if part >= 1:
                bar.close()

    return tell if progress else None


class Job:
    """A request that the daemon runs as a job (202). The daemon keeps the result for some time.

    Attributes: `id`, and as last read `state` (queued, running, done, failed, cancelled) and
    `progress` (in [0,1]).
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

    def refresh(self, wait: int = 0) -> "Job":
        """Reads state and progress. Returns when the job has ended, or after `wait` seconds (at
        most 60)."""
        self._hear(self._transport.request("GET", f"/v1/jobs/{self.id}?wait={wait}").json)
        return self

    def wait(self, progress: Optional[Progress] = None) -> "Job":
        """Waits until the job has ended. Calls `progress` at once, and then at most ten times a
        second. Opens the stream of progress again if it breaks or is refused."""
        tell = listener(progress)
        if tell:
            tell(self.progress)
        while not self.is_over:
            try:
                for _, data in self._transport.events(f"/v1/jobs/{self.id}/events"):
                    self._hear(json.loads(data))
                    if tell:
                        tell(self.progress)
            except (ConnectionFailed, Overloaded):
                pass
            if not self.is_over:  # this request has retries, and it paces the loop
                self.refresh(wait=1)
                if tell:
                    tell(self.progress)
        return self

    def response(self) -> Response:
        """Returns the answer of a job that has ended, as if the request had not been a job. Raises
        a ProblemError if the job failed."""
        if self.state == "cancelled":
            raise JobCancelled(f"job {self.id} has been cancelled")
        return self._transport.request("GET", f"/v1/jobs/{self.id}/result")

    def cancel(self) -> None:
        """Stops the job within milliseconds. Deletes a job that has ended."""
        self._transport.request("DELETE", f"/v1/jobs/{self.id}")
