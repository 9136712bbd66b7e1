"""HTTP exchanges: a pool of open connections, gzip, retries with back-off."""
from __future__ import annotations

import gzip
import http.client
import json
import random
import re
import socket
import ssl
import threading
import time
import urllib.parse
import zlib
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple, Union

from .errors import BadAnswer, ConnectionFailed, problem_error

BACKOFF_SECONDS = 0.1  # pause before the first retry; the pause doubles with each further retry
BACKOFF_MOST = 10.0
RETRY_AFTER_MOST = 120.0  # a refusal with a longer Retry-After is raised at once
HEARTBEAT = 15.0  # the longest time between two lines of a stream of events
TEXTS = ("code", "detail", "title", "pointer", "parameter", "reason")  # members of a problem
LOOPBACK = re.compile(r"localhost|::1|127\.[\d.]+")


class Response(NamedTuple):
    status: int
    headers: Union[Mapping[str, str], http.client.HTTPMessage]  # names ignore case
    body: bytes

    @property
    def json(self) -> Any:
        """The JSON object of the body."""
        try:
            answer = json.loads(self.body)
        except (ValueError, RecursionError) as error:
            raise BadAnswer(f"the answer is not JSON: {error}") from error
        if not isinstance(answer, dict):
            raise BadAnswer("the answer is not a JSON object")
        return answer


class _UnixConnection(http.client.HTTPConnection):
    def __init__(self, path: str, timeout: float):
        super().__init__("localhost", timeout=timeout)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


class Transport:
    """Sends requests to one daemon. Thread-safe: the pool grows to the number of simultaneous
    requests.

    url: http://HOST:PORT, https://HOST:PORT or unix:PATH. key: sent as a bearer token. timeout: a
    request fails after this many seconds without a byte. retries: how often a request is repeated
    if the daemon is busy (429, 503; after Retry-After, or with back-off) or the connection fails.
    """

    def __init__(self, url: str, key: Optional[str], timeout: float, retries: int, context: Optional[ssl.SSLContext]):
        self.url = url.rstrip("/")
        self.timeout, self.retries = timeout, retries
        self._parts = urllib.parse.urlsplit(self.url)
        if self._parts.scheme not in ("http", "https", "unix"):
            raise ValueError(f"{url!r} is not an address of a daemon; write http://HOST:PORT, https://HOST:PORT or unix:PATH")
        self._context = context
        is_near = self._parts.scheme == "unix" or LOOPBACK.fullmatch(self._parts.hostname or "") is not None
        # on one machine, compressing takes longer than sending the uncompressed bytes
        self._headers = {"Accept-Encoding": "identity" if is_near else "gzip", "User-Agent": "geodesicd-python"}
        if key:
            key = key.strip()  # a key that is read from a file often ends with a newline
            if re.search(r"[^!-~]", key):
                raise ValueError("the key has characters that no key has")
            self._headers["Authorization"] = f"Bearer {key}"
        self._lock = threading.Lock()
        self._idle: List[http.client.HTTPConnection] = []

    def close(self) -> None:
        """Closes the connections. The next request opens a new connection."""
        with self._lock:
            idle, self._idle = self._idle, []
        for connection in idle:
            connection.close()

    def request(self, method: str, path: str, query: Optional[Mapping[str, Any]] = None, body: Union[bytes, Any, None] = None,
                headers: Optional[Mapping[str, str]] = None, repeatable: bool = True) -> Response:
        """Returns the answer, or raises the exception for the problem that it reports. Sends bytes
        unchanged and other bodies as JSON. Omits parameters of the query that are None.
        Set repeatable=False for requests that create something new each time. The client then does
        not repeat the request if the connection fails after it was opened, or after a refusal
        without Retry-After, because the daemon may have executed the request."""
        fields = {name: _parameter(value) for name, value in (query or {}).items() if value is not None}
        target = self._parts.path * (self._parts.scheme != "unix") + path + ("?" + urllib.parse.urlencode(fields) if fields else "")
        sent = {**self._headers, **(headers or {})}
        if body is not None and not isinstance(body, (bytes, bytearray, memoryview)):
            try:
                body = json.dumps(body, allow_nan=False).encode()
            except ValueError as error:
                raise ValueError("a number of the request is not finite (NaN or infinity)") from error
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
                self.close()  # the idle connections may be broken, too
                self._wait(attempt, None)
                continue
            retry_after = _seconds(response.headers.get("Retry-After"))
            is_busy = response.status in (429, 503) and (retry_after or 0) <= RETRY_AFTER_MOST and (repeatable or retry_after is not None)
            if not is_busy or attempt == self.retries:
                return _checked(response, retry_after)
            self._wait(attempt, retry_after)
        raise AssertionError("unreachable")

    def events(self, path: str) -> Iterator[Tuple[str, str]]:
        """Yields server-sent events as (event, data) until the daemon closes the stream. Uses a
        connection of its own."""
        connection = self._connect()
        connection.timeout = self.timeout and max(self.timeout, 2 * HEARTBEAT)
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
        """Opens a new connection. The daemon may have closed an idle connection of the pool, but
        not a new one."""
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
        # the socket is None if the daemon closes the connection after this answer
        if connection.sock is not None:
            with self._lock:
                self._idle.append(connection)
        if answer.headers.get("Content-Encoding") == "gzip":
            try:
                received = gzip.decompress(received)
            except (OSError, EOFError, zlib.error) as error:
                raise BadAnswer(f"the answer is not gzip, as its header says: {error}") from error
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
    if 200 <= response.status < 300:
        return response
    if response.status < 400:
        raise BadAnswer(f"the answer has the status {response.status}: another program answers at this address")
    try:
        problem = response.json
    except BadAnswer:
        problem = {}
    problem = {name: value for name, value in problem.items() if isinstance(value, str) or name not in TEXTS}
    raise problem_error(problem, response.status, response.headers.get("X-Request-Id", ""), retry_after)
