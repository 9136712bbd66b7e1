#!/usr/bin/env python3
"""Tests clients that disconnect at a random byte of the handshake, of the request or of the answer.
They disconnect by a reset or by an ordinary close, with and without TLS. Afterwards the daemon
holds no more connections, threads, descriptors and references to meshes or fields than before.
At the end the test removes all data. All memory of the data must then be free, which detects leaked
references.

    tests/fault/disconnect.py [--count N] [--tls-count N] [--clients N] [--seed N]
"""
import argparse
import collections
import concurrent.futures
import contextlib
import http.client
import pathlib
import random
import shutil
import socket
import ssl
import struct
import sys
import tempfile
import time

import mix
import process
from common import Daemon
from figures import conclude, report
from test_tls import make_certificate

PATIENCE_SECONDS = 60
SETTLE_SECONDS = 15
ANSWER_BYTES = 30000  # largest number of bytes of an answer that a client reads
# A client disconnects if an answer does not begin within the first time, or does not continue
# within the second.
WAIT_SECONDS, SILENCE_SECONDS = 0.3, 0.005
FLAGS = ("--memory-budget", "128MiB", "--max-body", "16MiB", "--workers", "2", "--http-threads", "2", "--job-ttl-s", "1")
RESET = struct.pack("ii", 1, 0)  # SO_LINGER: close by a reset at once
# metrics that are positive while something runs
HELD = ("connections", "workers_busy", "queue_depth", "requests_deferred", "event_streams")
REMOVED = ("meshes", "meshes_loaded", "cache_fields", 'memory_bytes{class="meshes"}', 'memory_bytes{class="fields"}', 'memory_bytes{class="flight"}',
           'memory_bytes{class="landmarks"}', 'memory_bytes{class="discretizations"}', 'memory_bytes{class="jobs"}')


class TlsDaemon(Daemon):
    """A daemon with TLS, whose certificate is not verified."""

    def __init__(self, place, *flags):
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        self.context.check_hostname, self.context.verify_mode = False, ssl.CERT_NONE
        certificate, key = make_certificate(pathlib.Path(place), "daemon")
        super().__init__("--tls-cert", str(certificate), "--tls-key", str(key), *flags)

    def connect(self):
        return http.client.HTTPSConnection("localhost", self.port, timeout=PATIENCE_SECONDS, context=self.context)

    def hello(self):
        """Returns the client's first TLS message."""
        incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
        with contextlib.suppress(ssl.SSLWantReadError):
            self.context.wrap_bio(incoming, outgoing, server_hostname="localhost").do_handshake()
        return outgoing.read()


class Vanisher:
    """Connects, sends a request, and disconnects. `ends` counts the connections by the way in which
    they ended."""

    def __init__(self, daemon, seed, those, faces):
        self.daemon, self.chance, self.ends = daemon, random.Random(seed), collections.Counter()
        self.requests = mix.Mix(self.chance, those, faces)
        self.context = getattr(daemon, "context", None)
        self.hello = daemon.hello() if self.context else b""

    def vanish(self, count):
        for _ in range(count):
            plain = socket.create_connection(("127.0.0.1", self.daemon.port), timeout=PATIENCE_SECONDS)
            try:
                self.ask(plain)
            except (OSError, ssl.SSLError):
                self.ends["the daemon hung up first"] += 1
                plain.close()

    def ask(self, plain):
        if self.context and self.chance.random() < 0.2:
            plain.sendall(self.hello[: self.chance.randrange(len(self.hello) + 1)])
            self.go(plain, plain, "in the handshake")
            return
        connection = self.context.wrap_socket(plain, server_hostname="localhost", suppress_ragged_eofs=True) if self.context else plain
        text = self.text()
        if self.chance.random() < 0.5:
            connection.sendall(text[: self.chance.randrange(len(text) + 1)])
            if self.chance.random() < 0.3:
                time.sleep(self.chance.uniform(0, 0.003))
            self.go(connection, connection, "in the request")
        else:
            connection.sendall(text)
            self.read(connection, self.chance.randrange(1 + int(ANSWER_BYTES ** self.chance.random())))
            self.go(connection, connection, "in the answer")

    def text(self):
        """Returns the bytes of one request, of two requests, of a request in chunks, or of a
        request with Expect: 100-continue."""
        request = self.requests.next()
        form = self.chance.random()
        if form < 0.1 and request.body:
            head, body = mix.encode(request._replace(body=None)), request.body
            return head[:-2] + b"Transfer-Encoding: chunked\r\n\r\n%x\r\n%b\r\n0\r\n\r\n" % (len(body), body)
        if form < 0.2:
            return mix.encode(request) + mix.encode(self.requests.next())
        if form < 0.25 and request.body:
            return mix.encode(request._replace(headers={**request.headers, "Expect": "100-continue"}))
        return mix.encode(request)

    def read(self, connection, least):
        connection.settimeout(WAIT_SECONDS)
        have = 0
        with contextlib.suppress(TimeoutError):
            while have < least and (data := connection.recv(least - have)):
                have += len(data)
                connection.settimeout(SILENCE_SECONDS)

    def go(self, connection, plain, where):
        how = self.chance.choice(("reset", "end", "half an end"))
        if how == "reset":
            plain.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET)
        if how == "half an end":
            plain.shutdown(socket.SHUT_WR)
        connection.close()
        self.ends[f"{where}, {how}"] += 1


def settle(daemon, names, least):
    """Waits until these metrics are at most `least`. Waits for less time than the timeout of an
    idle connection. Returns the metrics that are still larger."""
    until = time.monotonic() + SETTLE_SECONDS
    while True:
        held = process.metrics(daemon)
        found = {name: held[name] for name in names if held[name] > least.get(name, 0)}
        if not found or time.monotonic() > until:
            return found
        time.sleep(0.05)


def remove_all(daemon):
    for collection in ("meshes", "subdivisions", "nurbs"):
        while items := daemon.get(f"/v1/{collection}?limit=100").json[collection]:
            for item in items:
                assert daemon.request("DELETE", f"/v1/{collection}/{item['name']}").status == 204


def at_rest(daemon):
    """Returns the numbers of descriptors and threads while no other client is connected."""
    settle(daemon, HELD, {"connections": 1})
    counts = []
    for _ in range(20):
        time.sleep(0.02)
        counts.append((process.descriptors(daemon), process.threads(daemon)))
    return min(counts)


def try_all(daemon, label, count, clients, seed):
    """Disconnects `count` times. Returns whether all checks pass."""
    chance = random.Random(seed)
    before = at_rest(daemon)
    those = mix.surfaces(16, 2, 10)
    faces = mix.upload(daemon, those)
    shares = [count // clients + (number < count % clients) for number in range(clients)]
    begun = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(clients) as pool:
        vanishers = [Vanisher(daemon, chance.random(), those, faces) for _ in range(clients)]
        list(pool.map(lambda pair: pair[0].vanish(pair[1]), zip(vanishers, shares)))
    seconds = time.monotonic() - begun
    running = settle(daemon, HELD, {"connections": 1})
    remove_all(daemon)
    left = settle(daemon, REMOVED, {})
    after = at_rest(daemon)
    ends = sum((vanisher.ends for vanisher in vanishers), collections.Counter())
    print(f"# {label}: " + ", ".join(f"{number} {end}" for end, number in sorted(ends.items())))
    return [
        report(f"{count} random disconnects, {label}: connections, threads, descriptors left", "0",
               f"{running or 0}; {before[1]} threads then {after[1]}, {before[0]} descriptors then {after[0]}; {count / seconds:.0f}/s",
               not running and after[1] == before[1] and after[0] <= before[0]),
        report(f"disconnects, {label}: references left, all removed", "0 bytes", f"{left or '0 bytes'}", not left),
        report(f"disconnects, {label}: failed checks", "0", f"{daemon.metric('failed_checks_total'):.0f}", daemon.metric("failed_checks_total") == 0),
    ]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--count", type=int, default=1500)
    arguments.add_argument("--tls-count", type=int, default=500)
    arguments.add_argument("--clients", type=int, default=16)
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    with Daemon(*FLAGS) as daemon:
        daemon.log = collections.deque(daemon.log, 1000)
        held = try_all(daemon, "in the clear", options.count, options.clients, options.seed)
    held.append(daemon.process.returncode == 0)
    if shutil.which("openssl"):
        with tempfile.TemporaryDirectory() as place, TlsDaemon(place, *FLAGS) as daemon:
            daemon.log = collections.deque(daemon.log, 1000)
            held += try_all(daemon, "by TLS", options.tls_count, options.clients, options.seed)
        held.append(daemon.process.returncode == 0)
    return conclude("disconnect", held)


if __name__ == "__main__":
    sys.exit(main())
