"""HTTP exchanges: connections that are kept and used again, gzip, retries with back-off."""
from __future__ import annotations

import gzip
import http.client
import json
import random
import socket
import ssl
import threading
import time
import urllib.parse
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple, Union

from .errors import ConnectionFailed, problem_error

BACKOFF_SECONDS = 0.1  # before the first retry; twice as long before each next one
BACKOFF_MOST = 10.0


class Response(NamedTuple):
    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


class _UnixConnection(http.client.HTTPConnection):
    def __init__(self, path: str, timeout: float):
        super().__init__("localhost", timeout=timeout)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


class Transport:
    """Where the daemon is, and how patient to be. Thread-safe: as many connections are kept as were ever needed at once.

    url: http://HOST:PORT, https://HOST:PORT or unix:PATH. key: sent as a bearer key. timeout: seconds without a byte. retries: of a request
    that a busy daemon turned away (429, 503; as long as its Retry-After says, or with back-off), or whose connection failed.
    """

    def __init__(self, url: str, key: Optional[str], timeout: float, retries: int, context: Optional[ssl.SSLContext]):
        self.url = url.rstrip("/")
        self.timeout, self.retries = timeout, retries
        self._parts = urllib.parse.urlsplit(self.url)
        if self._parts.scheme not in ("http", "https", "unix"):
            raise ValueError(f"{url!r} is no address of a daemon; write http://HOST:PORT, https://HOST:PORT or unix:PATH")
        self._context = context
        self._headers = {"Accept-Encoding": "gzip", "User-Agent": "geodesicd-python"}
        if key:
            self._headers["Authorization"] = f"Bearer {key}"
        self._lock = threading.Lock()
        self._idle: List[http.client.HTTPConnection] = []

    def close(self) -> None:
        """Closes the connections; the next request opens another one."""
        with self._lock:
            idle, self._idle = self._idle, []
        for connection in idle:
            connection.close()

    def request(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Union[bytes, Any, None] = None,
                headers: Optional[Mapping[str, str]] = None, repeatable: bool = True) -> Response:
        """The answer, or the exception of its problem. A body that is no bytes is sent as JSON; values of None in the query are left out. What is not
        repeatable makes something new each time: it is not sent again when its connection fails, as it may have arrived."""
        fields = {name: _parameter(value) for name, value in (query or {}).items() if value is not None}
        target = self._parts.path * (self._parts.scheme != "unix") + path + ("?" + urllib.parse.urlencode(fields) if fields else "")
        sent = {**self._headers, **(headers or {})}
        if body is not None and not isinstance(body, (bytes, bytearray, memoryview)):
            body = json.dumps(body, allow_nan=False).encode()
            sent.setdefault("Content-Type", "application/json")
        for attempt in range(self.retries + 1):
            connection = None
            try:
                connection = self._take() if repeatable else self._open()
                response = self._exchange(connection, method, target, body, sent)
            except (OSError, http.client.HTTPException) as error:
                may_have_arrived = connection is not None and not repeatable
                if attempt == self.retries or may_have_arrived or isinstance(error, (TimeoutError, socket.timeout, ssl.SSLCertVerificationError)):
                    raise ConnectionFailed(f"no answer from {self.url}: {error or type(error).__name__}") from error
                self._wait(attempt, None)
                continue
            retry_after = _seconds(response.headers.get("Retry-After"))
            if response.status not in (429, 503) or attempt == self.retries:
                return _checked(response, retry_after)
            self._wait(attempt, retry_after)
        raise AssertionError("unreachable")

    def events(self, path: str) -> Iterator[Tuple[str, str]]:
        """Server-sent events, (event, data) each, on a connection of their own, until the daemon ends them."""
        connection = self._connect()
        try:
            connection.request("GET", path, headers={**self._headers, "Accept-Encoding": "identity", "Accept": "text/event-stream"})
            answer = connection.getresponse()
            if answer.status != 200:
                _checked(Response(answer.status, answer.headers, answer.read()), None)
                return
            event = ""
            for line in answer:
                name, _, value = line.decode().rstrip("\r\n").partition(": ")
                if name == "event":
                    event = value
                elif name == "data":
                    yield event, value
        except (OSError, http.client.HTTPException) as error:
            raise ConnectionFailed(f"no events from {self.url}: {error or type(error).__name__}") from error
        finally:
            connection.close()

    def _connect(self) -> http.client.HTTPConnection:
        parts = self._parts
        if parts.scheme == "unix":
            return _UnixConnection(parts.path or parts.netloc, self.timeout)
        if parts.scheme == "https":
            return http.client.HTTPSConnection(parts.hostname or "", parts.port, timeout=self.timeout, context=self._context)
        return http.client.HTTPConnection(parts.hostname or "", parts.port, timeout=self.timeout)

    def _take(self) -> http.client.HTTPConnection:
        with self._lock:
            if self._idle:
                return self._idle.pop()
        return self._open()

    def _open(self) -> http.client.HTTPConnection:
        """One that is new, which the daemon has had no time to close."""
        connection = self._connect()
        connection.connect()
        if self._parts.scheme != "unix":
            connection.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return connection

    def _exchange(self, connection: http.client.HTTPConnection, method: str, target: str, body: Optional[bytes],
                  headers: Dict[str, str]) -> Response:
        try:
            connection.request(method, target, body=body, headers=headers)
            answer = connection.getresponse()
            received = answer.read()
        except BaseException:
            connection.close()
            raise
        if connection.sock is not None:  # else the daemon wanted it closed
            with self._lock:
                self._idle.append(connection)
        if answer.headers.get("Content-Encoding") == "gzip":
            received = gzip.decompress(received)
        return Response(answer.status, answer.headers, received)

    @staticmethod
    def _wait(attempt: int, retry_after: Optional[float]) -> None:
        backoff = min(BACKOFF_SECONDS * 2**attempt, BACKOFF_MOST)
        time.sleep(retry_after if retry_after is not None else backoff * (0.5 + random.random()))


def _parameter(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _seconds(text: Optional[str]) -> Optional[float]:
    return float(text) if text and text.isdigit() else None


def _checked(response: Response, retry_after: Optional[float]) -> Response:
    if response.status < 400:
        return response
    try:
        problem = response.json
    except ValueError:
        problem = {}
    if not isinstance(problem, dict):
        problem = {}
    raise problem_error(problem, response.status, response.headers.get("X-Request-Id", ""), retry_after)
