#!/usr/bin/env python3
"""Tests unfinished request heads. Clients from several addresses begin a request and do not finish
it. Each client replaces a closed connection at once. Meanwhile other clients request /livez over
new connections, and no such request may fail. Later the clients finish a request and keep the
connection idle.

    tests/fault/halfopen.py [--heads N] [--addresses N] [--seconds S] [--most N] [--short]

--short: lower limits of the daemon (--max-connections), and fewer clients.
"""
import argparse
import errno
import select
import socket
import sys
import threading
import time

from common import Daemon
from figures import conclude, quantile, report

HEAD = b"GET /livez HTTP/1.1\r\nHost: localhost\r\nX: "
WHOLE = b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n"
PATIENCE = 5  # a probe waits for its answer at most this many seconds


class Crowd(threading.Thread):
    """Keeps `count` connections open from addresses of the loopback network."""

    def __init__(self, port, count, addresses, text):
        super().__init__(daemon=True)
        self.port, self.count, self.addresses, self.text = port, count, addresses, text
        self.poll, self.all = select.epoll(), {}
        self.opened = self.refused = self.most = 0
        self.stopped = threading.Event()

    def join_in(self):
        connection = socket.socket()
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_IP, 24, 1)  # IP_BIND_ADDRESS_NO_PORT
        connection.bind((f"127.0.1.{1 + self.opened % self.addresses}", 0))
        if connection.connect_ex(("127.0.0.1", self.port)) not in (0, errno.EINPROGRESS):
            connection.close()
            self.refused += 1
            return
        self.opened += 1
        self.all[connection.fileno()] = connection
        self.poll.register(connection, select.EPOLLIN | select.EPOLLOUT | select.EPOLLRDHUP | select.EPOLLET)

    def leave(self, number):
        self.all.pop(number).close()

    def on_event(self, number, events):
        connection = self.all[number]
        try:
            if events & (select.EPOLLRDHUP | select.EPOLLHUP | select.EPOLLERR):
                self.leave(number)
            elif events & select.EPOLLIN:
                if not connection.recv(4096):
                    self.leave(number)
            elif events & select.EPOLLOUT:
                connection.send(self.text)
        except OSError:
            self.leave(number)

    def run(self):
        while not self.stopped.is_set():
            for _ in range(min(200, self.count - len(self.all))):
                self.join_in()
            self.most = max(self.most, len(self.all))
            for number, events in self.poll.poll(0.01):
                if number in self.all:
                    self.on_event(number, events)
        for number in list(self.all):
            self.leave(number)


def probe(port):
    """Returns the seconds that a new client waits for its answer, or infinity if no answer
    arrives."""
    began = time.monotonic()
    try:
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as connection:
            connection.sendall(WHOLE)
            if connection.recv(4096).startswith(b"HTTP/1.1 200 "):
                return time.monotonic() - began
    except OSError:
        pass
    return float("inf")


def attack(options, text):
    flags = ("--max-connections", str(options.most)) if options.most else ()
    with Daemon("--http-threads", "2", *flags) as daemon:
        crowd = Crowd(daemon.port, options.heads, options.addresses, text)
        crowd.start()
        times, until = [], time.monotonic() + options.seconds
        while time.monotonic() < until:
            times.append(probe(daemon.port))
            time.sleep(0.02)
        crowd.stopped.set()
        crowd.join()
        return crowd, times, daemon.metric("connections_cut_total")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--heads", type=int, default=10000)
    arguments.add_argument("--addresses", type=int, default=6)
    arguments.add_argument("--seconds", type=float, default=90)
    arguments.add_argument("--most", type=int, default=0)
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    if options.short:
        options.heads, options.most, options.seconds = 600, 400, 3
    held = []
    for what, text in (("half-open heads", HEAD), ("connections that are kept without a request", WHOLE)):
        crowd, times, cut = attack(options, text)
        failed = sum(seconds == float("inf") for seconds in times)
        held.append(report(f"{options.heads} {what} do not keep new clients out", "0 probes failed",
                           f"{failed} of {len(times)} probes failed, p99 {1000 * quantile(times, 0.99):.0f} ms; {crowd.opened} connections, "
                           f"{crowd.most} at once, {cut:.0f} heads cut", failed == 0 and crowd.opened > options.heads))
    return conclude("halfopen", held)


if __name__ == "__main__":
    sys.exit(main())
