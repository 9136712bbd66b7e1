#!/usr/bin/env python3
"""Tests clients that read a long answer steadily but slowly. The daemon never disconnects a client
that reads more than 16 KiB a second. It disconnects a client that stops reading. The clients'
receive buffers differ in size. So the kernels buffer different amounts between daemon and client.

    tests/fault/slow_reader.py [--seconds S]
"""
import argparse
import concurrent.futures
import socket
import sys
import time

from common import Daemon, harness
from figures import conclude, report

RATES = (24_000, 50_000)
BUFFERS = (0, 4096, 1 << 20)  # sizes in bytes; 0 selects the system's default
LEVELS = (6, 7)  # levels of the meshes: 4 and 16 MB
PIECE = 0.25  # seconds between two reads


def ask(port, path, buffer=0):
    connection = socket.socket()
    if buffer:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
    connection.settimeout(harness.PATIENCE_SECONDS)
    connection.connect(("127.0.0.1", port))
    connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    return connection


def read_steadily(port, path, size, rate, buffer, seconds):
    """Reads `rate` bytes a second. Returns after how many seconds the daemon closed the connection.
    Returns None if the client read the whole answer, or read for `seconds`."""
    began, taken = time.monotonic(), 0
    with ask(port, path, buffer) as connection:
        while taken < size and (passed := time.monotonic() - began) < seconds:
            due = int(rate * passed) - taken
            if due > 0:
                try:
                    got = connection.recv(due)
                except ConnectionError:
                    got = b""
                if not got:
                    return passed
                taken += len(got)
            time.sleep(PIECE)
    return None


def stop_reading(port, path, seconds):
    """Returns after how many seconds the daemon disconnects a client that reads nothing."""
    began = time.monotonic()
    with ask(port, path) as connection:
        while (passed := time.monotonic() - began) < seconds:
            time.sleep(1)
            try:
                if connection.send(b"\r"):
                    continue
            except ConnectionError:
                return passed
    return float("inf")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--seconds", type=float, default=240)
    options = arguments.parse_args()
    held = []
    with Daemon("--workers", "1", "--memory-budget", "1GiB") as daemon, concurrent.futures.ThreadPoolExecutor(16) as pool:
        served = {rate: [] for rate in RATES}
        for level in LEVELS:
            assert daemon.put(f"m{level}", harness.sample("icosphere", level=level)).status == 201
            path = f"/v1/meshes/m{level}/content?format=obj"
            size = len(daemon.get(path).body)
            for rate in RATES:
                served[rate] += [pool.submit(read_steadily, daemon.port, path, size, rate, buffer, options.seconds) for buffer in BUFFERS]
        stopped = pool.submit(stop_reading, daemon.port, path, options.seconds)
        for rate, clients in served.items():
            cut = [f"{seconds:.0f} s" for client in clients if (seconds := client.result()) is not None]
            held.append(report(f"a client that reads {rate // 1000} KB/s is not cut", f"{options.seconds:.0f} s",
                               f"{len(cut)} of {len(clients)} clients cut{': after ' + ', '.join(cut) if cut else ''}", not cut))
        held.append(report("a client that stops reading is cut", "90 s", f"{stopped.result():.0f} s", stopped.result() < 90))
    return conclude("slow_reader", held)


if __name__ == "__main__":
    sys.exit(main())
