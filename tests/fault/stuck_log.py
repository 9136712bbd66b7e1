#!/usr/bin/env python3
"""Tests an unread log. Standard error is a pipe, a socket (as under systemd) or a stopped terminal,
and the test stops reading it once the daemon listens. Requests and /livez are answered
nevertheless, and SIGTERM ends the daemon. The log, which is read later, states the exact number of
missing lines.

    tests/fault/stuck_log.py [--requests N]
"""
import argparse
import contextlib
import http.client
import json
import os
import pty
import select
import signal
import socket
import subprocess
import sys
import threading
import time
import tty

from common import PROGRAM
from figures import conclude, quantile, report

CLIENTS = 8
PATIENCE_SECONDS = 10  # a client waits this long; a later answer counts as no answer
# the daemon has nothing to drain; it may need one second for its log, and the rest is a margin for
# a busy machine
END_SECONDS = 10
BLOCK = 1 << 16


def open_pipe():
    return os.pipe()


def open_socket():
    reader, writer = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    return reader.detach(), writer.detach()


def open_terminal():
    reader, writer = pty.openpty()
    tty.setraw(writer)
    return reader, writer


SINKS = {"pipe": open_pipe, "socket": open_socket, "terminal": open_terminal}


class Stuck:
    """A daemon whose log the test reads up to the line `listening`, and later only on demand."""

    def __init__(self, kind):
        self.reader, writer = SINKS[kind]()
        self.process = subprocess.Popen([PROGRAM, "--listen", "127.0.0.1:0", "--store", "memory", "--workers", "2", "--http-threads", "2"], stderr=writer)
        os.close(writer)
        self.text = b""
        while b'"listening"' not in self.text:
            self.text += os.read(self.reader, 4096)
        line = next(line for line in self.text.splitlines() if b'"listening"' in line)
        self.port = int(json.loads(line)["address"].rpartition(":")[2])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        os.close(self.reader)

    def ask(self, count):
        """Sends requests as one client. Returns the seconds of each request that was answered with
        200."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_SECONDS)
        took = []
        with contextlib.suppress(OSError, http.client.HTTPException), contextlib.closing(connection):
            for number in range(count):
                begun = time.monotonic()
                connection.request("GET", "/livez" if number % 2 else f"/v1/meshes?after=a{number}")
                answer = connection.getresponse()
                if answer.read() and answer.status == 200:
                    took.append(time.monotonic() - begun)
        return took

    def dropped(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_SECONDS)
        with contextlib.closing(connection):
            connection.request("GET", "/metrics")
            lines = connection.getresponse().read().decode().splitlines()
        return next(int(float(line.split()[1])) for line in lines if line.startswith("geodesicd_log_lines_dropped_total"))

    def end(self):
        """Returns the seconds from SIGTERM to the end, or infinity if the daemon does not end."""
        begun = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        try:
            self.process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            return float("inf")
        return time.monotonic() - begun if self.process.returncode == 0 else float("inf")

    def read_rest(self):
        """Reads until the writer has closed the log, or no more bytes arrive."""
        while select.select([self.reader], [], [], 1)[0]:
            try:
                block = os.read(self.reader, BLOCK)
            except OSError:  # a closed terminal reports an error
                return
            if not block:
                return
            self.text += block


def ask_all(stuck, requests):
    took = []
    clients = [threading.Thread(target=lambda: took.extend(stuck.ask(requests // CLIENTS))) for _ in range(CLIENTS)]
    for client in clients:
        client.start()
    for client in clients:
        client.join()
    return took


def try_sink(kind, requests):
    with Stuck(kind) as stuck:
        took = ask_all(stuck, requests)
        dropped = stuck.dropped() if len(took) == requests else 0
        seconds = stuck.end()
    return [
        report(f"an unread log ({kind}): requests answered", f"{requests} of {requests}",
               f"{len(took)}, p99 {quantile(took, 0.99) * 1000:.1f} ms, {dropped} lines dropped", len(took) == requests and dropped > 0),
        report(f"an unread log ({kind}): SIGTERM ends the daemon", f"<= {END_SECONDS} s", f"{seconds:.2f} s", seconds <= END_SECONDS),
    ]


def try_account(requests):
    """Checks that the log finally has every line, or the number of missing lines."""
    with Stuck("pipe") as stuck:
        answered = len(ask_all(stuck, requests))
        stuck.read_rest()
        answered += len(stuck.ask(1))
        stuck.process.send_signal(signal.SIGTERM)
        stuck.read_rest()
        stuck.process.wait(END_SECONDS)
        lines = [json.loads(line) for line in stuck.text.splitlines()]
    told = sum(line["lines"] for line in lines if line["event"] == "log_dropped")
    shown = sum(line["event"] == "request" for line in lines)
    return [report("a log that is read again: lines that are shown, and told to be missing", f"{requests + 1} together", f"{shown} and {told}",
                   shown + told == answered == requests + 1 and told > 0 and lines[-1]["event"] == "stopped")]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--requests", type=int, default=8000, help="of each daemon")
    options = arguments.parse_args()
    held = []
    for kind in SINKS:
        held += try_sink(kind, options.requests)
    return conclude("stuck_log", [*held, *try_account(options.requests)])


if __name__ == "__main__":
    sys.exit(main())
