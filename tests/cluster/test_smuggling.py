"""Sends ambiguous requests through the shipped HAProxy configuration. The proxy and the daemon must
see the same sequence of requests. If the daemon saw one request more or less than the proxy, a
client would get another client's answer. Skipped without haproxy."""
import contextlib
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import unittest
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "api"))

from cluster import Relay  # noqa: E402
from front import Front  # noqa: E402
from harness import PATIENCE_SECONDS, Daemon, wait_until  # noqa: E402
from test_hostile import ABSOLUTE, ATTACKS, GET, HIDDEN, LENIENT, PUT, lines  # noqa: E402

GOOD = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"
# Changes of HAProxy's configuration that log each request: its line, its server, and the id in the
# node's answer.
OBSERVED = (("option httplog", 'log-format "request %HM %HU %s %ST %[var(txn.id)]"'),
            ("http-response set-header X-Served-By %s", "http-response set-header X-Served-By %s\n    http-response set-var(txn.id) res.hdr(x-request-id)"))


def path_of(uri):
    """Returns the path of a URI in the proxy's log, which writes unprintable bytes as #XX. The URI
    may be absolute."""
    plain = re.sub("#([0-9A-F]{2})", lambda found: chr(int(found[1], 16)), uri)
    plain = re.sub("(?i)^https?://[^/?]*/?", "/", plain)
    return urllib.parse.unquote(plain.partition("?")[0])


class Observed:
    """A daemon behind HAProxy, and the requests that each of the two has logged. HAProxy sends
    requests to `port`, or to the daemon if `port` is None."""

    def __init__(self, daemon, port=None):
        self.daemon, self.front = daemon, Front([port or daemon.port], OBSERVED)

    def ask(self, text):
        """Sends text; returns all bytes until the proxy closes the connection."""
        received = b""
        with socket.create_connection(("127.0.0.1", self.front.port), timeout=PATIENCE_SECONDS) as connection:
            try:
                connection.sendall(text)
                connection.shutdown(socket.SHUT_WR)
                while data := connection.recv(65536):
                    received += data
            except (ConnectionResetError, BrokenPipeError):
                pass
        return received

    def forwarded(self):
        """Yields (method, path, id or None) of each request that the proxy forwarded. If the id is
        None, libmicrohttpd wrote the answer instead of the daemon."""
        found = re.findall(rb"^.*?request (\S+) (\S+) (\S+) (-?\d+) (\S+)$", pathlib.Path(self.front.log.name).read_bytes(), re.M)
        return [(method.decode(), path_of(uri.decode("latin-1")), None if token == b"-" else token.decode())
                for method, uri, server, _, token in found if server == b"node1"]

    def read(self):
        """Yields (method, path, id) of each request that the daemon read, without the proxy's
        health checks."""
        return [(line["method"], line["path"], line["request_id"]) for line in list(self.daemon.log) if line["event"] == "request" and line["path"] != "/readyz"]

    def difference(self):
        """Returns the first request in which the two logs differ, or None.

        The daemon reads the forwarded requests in order, except those that the library refuses. An
        answer may be lost if the daemon closes before the proxy has sent the whole body."""
        forwarded, read = self.forwarded(), self.read()
        known = {token for _, _, token in forwarded if token}
        for method, path, token in forwarded:
            head = read[:1]
            if token:
                if head != [(method, path, token)]:
                    return f"forwarded {(method, path, token)}, read {head}"
                read.pop(0)
            elif head and head[0][:2] == (method, path) and head[0][2] not in known:
                read.pop(0)
        return f"read but not forwarded: {read[0]}" if read else None

    def settle(self):
        """Waits until both logs agree, or for a few seconds: logs are written slightly after the
        answers."""
        with contextlib.suppress(TimeoutError):
            wait_until(lambda: self.difference() is None, 5)

    def close(self):
        self.front.__exit__()


@unittest.skipUnless(shutil.which("haproxy"), "wants haproxy")
class Smuggling(unittest.TestCase):
    def start(self, make_port=lambda daemon: None):
        daemon = Daemon("--max-address-connections", "0", "--timeout-ms", "10000")
        self.addCleanup(daemon.stop)
        observed = Observed(daemon, make_port(daemon))
        self.addCleanup(observed.close)
        return observed

    def test_both_see_the_same_requests(self):
        observed = self.start()
        attacks = [text for table in (ATTACKS, LENIENT) for texts in table.values() for text in texts]
        attacks += [lines(b"GET " + target + b" HTTP/1.1", host)
                    for status in (b"200", b"403", b"404") for target in ABSOLUTE[status] for host in (b"Host: localhost", b"Host: example.com")]
        cases = [before + text + HIDDEN for text in attacks for before in (b"", GOOD)]
        self.assertGreaterEqual(len(set(cases)), 250)
        for number, text in enumerate(cases):
            observed.ask(text)
            if number % 8 == 7:  # another client uses the connections that the cases used
                answer = observed.ask(GET + b"X-Request-Id: stranger-%d\r\nConnection: close\r\n\r\n" % number)
                self.assertEqual(re.findall(rb"(?i)x-request-id: (\S+)", answer), [b"stranger-%d" % number], text)
        observed.settle()
        self.assertIsNone(observed.difference())
        forwarded, read = observed.forwarded(), observed.read()
        # the daemon must have read at least the requests before the attacks
        self.assertGreaterEqual(len(read), len(cases) // 2)
        print(f"      behind haproxy: {len(cases)} cases, {len(forwarded)} requests passed on, {len(read)} read by the daemon, 0 by one side only")

    def test_a_lax_reader_is_noticed(self):
        """Repeats the comparison with a server that ignores lengths, and therefore reads a request
        inside a body."""

        class Lax(Relay):
            def _pump(self, source, sink):
                try:
                    while data := source.recv(65536):
                        sink.sendall(data if data.startswith(b"HTTP/") else re.sub(rb"(?i)content-length: \d+\r\n", b"", data))
                except OSError:
                    pass

        observed = self.start(lambda daemon: Lax(daemon.port).port)
        self.assertIsNone(observed.difference())
        observed.ask(PUT + b"Content-Length: %d\r\n\r\n" % len(HIDDEN) + HIDDEN)
        wait_until(lambda: any("smuggled" in path for _, path, _ in observed.read()))
        self.assertIn("smuggled", observed.difference())


if __name__ == "__main__":
    unittest.main()
