"""Ambiguous requests behind HAProxy, which passes on what it takes for right, over connections that clients share. If the daemon saw one request more or
less than the proxy, somebody would get another's answer: what both have counted is compared, and a stranger asks between the attacks."""
import json
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import threading
import time
import unittest

from harness import PATIENCE_SECONDS, Daemon, wait_until
from test_hostile import ATTACKS, GET, HIDDEN

CONFIGURATION = """
global
    maxconn 200
    log stdout format raw local0
defaults
    mode http
    log global
    log-format "{{\\"server\\": \\"%s\\", \\"status\\": %ST, \\"state\\": \\"%tsc\\"}}"
    retries 0
    timeout connect 5s
    timeout client 2s
    timeout server 20s
    timeout http-request 2s
frontend front
    bind 127.0.0.1:{front}
    default_backend back
backend back
    http-reuse always
    server daemon 127.0.0.1:{back}
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Proxy:
    """HAProxy in front of a daemon; `log` is a line for each request that it has taken or refused."""

    def __init__(self, daemon):
        self.place = tempfile.TemporaryDirectory()
        self.port, self.log = free_port(), []
        file = pathlib.Path(self.place.name) / "haproxy.cfg"
        file.write_text(CONFIGURATION.format(front=self.port, back=daemon.port))
        self.process = subprocess.Popen(["haproxy", "-db", "-f", file], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()
        until = time.monotonic() + PATIENCE_SECONDS
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port)).close()
                return
            except OSError:
                if time.monotonic() > until:
                    raise
                time.sleep(0.02)

    def read(self):
        for line in self.process.stdout:
            if line.startswith("{"):
                self.log.append(json.loads(line))

    def forwarded(self):
        return [line for line in self.log if line["server"] == "daemon"]

    def stop(self):
        self.process.terminate()
        self.process.wait(PATIENCE_SECONDS)
        self.reader.join(PATIENCE_SECONDS)
        self.process.stdout.close()
        self.place.cleanup()


@unittest.skipUnless(shutil.which("haproxy"), "wants haproxy")
class Smuggling(unittest.TestCase):
    def setUp(self):
        self.daemon = Daemon()
        self.proxy = Proxy(self.daemon)

    def tearDown(self):
        self.proxy.stop()
        self.assertEqual(self.daemon.stop(), 0)

    def ask(self, text):
        """What comes back until the proxy closes."""
        received = b""
        with socket.create_connection(("127.0.0.1", self.proxy.port), timeout=PATIENCE_SECONDS) as connection:
            try:
                connection.sendall(text)
                connection.shutdown(socket.SHUT_WR)
                while data := connection.recv(65536):
                    received += data
            except (ConnectionResetError, BrokenPipeError):
                pass
        return received

    def assert_stranger_is_served(self, number):
        """One who asks for something of his own, over the connections that the attacks used."""
        answer = self.ask(GET + b"X-Request-Id: stranger-%d\r\nConnection: close\r\n\r\n" % number)
        self.assertRegex(answer, rb"^HTTP/1\.1 200 ")
        self.assertEqual(re.findall(rb"(?i)x-request-id: (\S+)", answer), [b"stranger-%d" % number])

    def accepted(self):
        """The statuses of requests that the daemon took for right, by its log; those that break off in their chunks are refused without a line there."""
        return sorted(line["status"] for line in self.daemon.log if line["event"] == "request" and line["status"] != 400)

    def taken(self):
        """The statuses of those that the proxy passed on and had answered with something else than a refusal."""
        return sorted(line["status"] for line in self.proxy.forwarded() if not line["state"].startswith("S") and line["status"] != 400)

    def test_both_see_the_same_requests(self):
        attacks = [text for texts in ATTACKS.values() for text in texts]
        for number, text in enumerate(attacks):
            self.ask(text + HIDDEN)
            self.assert_stranger_is_served(number)
        wait_until(lambda: self.accepted() == self.taken())  # both write their logs a little later
        taken, forwarded = self.taken(), self.proxy.forwarded()
        self.assertEqual(self.accepted(), taken)
        self.assertGreaterEqual(len(taken), len(attacks))  # the strangers
        hung_up = [line for line in forwarded if line["state"].startswith("S")]
        refused = len(forwarded) - len(hung_up) - len(taken)
        print(f"      behind haproxy: {len(attacks)} cases and as many strangers, {len(forwarded)} requests passed on, {len(taken)} accepted by both, "
              f"{refused} refused by the daemon, {len(hung_up)} hung up on; 0 accepted by one side only")


if __name__ == "__main__":
    unittest.main()
