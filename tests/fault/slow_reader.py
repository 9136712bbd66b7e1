#!/usr/bin/env python3
"""Clients that read a long answer steadily, but slowly: above 16 KiB a second none is cut; one that stops reading is.

    tests/fault/slow_reader.py [--seconds S]
"""
import argparse
import concurrent.futures
import socket
import sys
import time

from common import Daemon, harness
from figures import conclude, report

RATES = (20_000, 24_000, 50_000)
PIECE = 0.25  # seconds between two reads


def ask(port, path):
    connection = socket.create_connection(("127.0.0.1", port), timeout=harness.PATIENCE_SECONDS)
    connection.sendall(f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
    return connection


def read_steadily(port, path, rate, seconds):
    """For how long a client that reads so many bytes a second is served; at most as long as asked for."""
    began, taken = time.monotonic(), 0
    with ask(port, path) as connection:
        while (passed := time.monotonic() - began) < seconds:
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
    return seconds


def stop_reading(port, path, seconds):
    """When a client that reads nothing is cut."""
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
    arguments.add_argument("--seconds", type=float, default=150)
    options = arguments.parse_args()
    held = []
    with Daemon("--workers", "1", "--memory-budget", "1GiB") as daemon, concurrent.futures.ThreadPoolExecutor(8) as pool:
        body = harness.sample("icosphere", level=7)
        assert daemon.put("large", body).status == 201
        path = "/v1/meshes/large/content?format=obj"
        size = len(daemon.get(path).body)
        times = [pool.submit(read_steadily, daemon.port, path, rate, options.seconds) for rate in RATES]
        stopped = pool.submit(stop_reading, daemon.port, path, options.seconds)
        for rate, served in zip(RATES, times):
            held.append(report(f"a client that reads {rate // 1000} KB/s is not cut", f"{options.seconds:.0f} s", f"{served.result():.0f} s of {size >> 20} MiB",
                               served.result() == options.seconds))
        held.append(report("a client that stops reading is cut", "90 s", f"{stopped.result():.0f} s", stopped.result() < 90))
    return conclude("slow_reader", held)


if __name__ == "__main__":
    sys.exit(main())
