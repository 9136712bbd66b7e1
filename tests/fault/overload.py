#!/usr/bin/env python3
"""Overload: a closed loop measures the daemon's capacity for a mix of expensive queries; then an
open loop offers five times as much, regardless of the answers. The daemon must refuse excess
requests at once, and answer the other requests and /livez as fast as before.

    tests/fault/overload.py [--seconds N] [--seed N] [--short]

Requests come from gd_load (load.c), whose single thread uses some hundredths of a processor, so its
priority is not raised. The capacity is the mean of two measurements, before and after the overload.
No query repeats, so no answer comes from a cache. --short: small surfaces, and bounds that hold
while other tests use the processors.
"""
import argparse
import json
import random
import subprocess
import sys
import tempfile
import threading
import time

import mix
import process
from common import PROGRAM, Daemon
from figures import conclude, report

MIB = 1 << 20
BUDGET = 256 * MIB
TIMES = 5
WARM = 0.5
ASKED = {"goodput": 0.9, "refusal": 10, "livez": 50}
ASKED_SHORT = {"goodput": 0.1, "refusal": 250, "livez": 500}
# the second number of connections is larger than the queue
CLOSED_CONNECTIONS, OPEN_CONNECTIONS = 16, 1500
# The kinds have similar cost, because the random number of rare, expensive requests would differ
# between measurements.
WEIGHTS = {"matrix": 3, "to_set": 3, "field": 3, "path": 2, "log": 1}
FLAGS = ("--memory-budget", f"{BUDGET}", "--max-body", "16MiB", "--workers", "2", "--http-threads", "2", "--landmarks", "0", "--queue-length", "32")


def write_requests(path, source, count):
    with open(path, "wb") as file:
        for _ in range(count):
            text = mix.encode(source.next())
            file.write(b"%d\n" % len(text) + text)


def load(daemon, path, connections, rate, seconds):
    command = [PROGRAM.parent / "gd_load", str(daemon.port), path, str(connections), f"{rate:.3f}", f"{WARM}", f"{seconds}"]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)
    return json.loads(done.stdout)


class MemoryWatch(threading.Thread):
    """Measures the largest resident memory until it is stopped."""

    def __init__(self, daemon):
        super().__init__()
        self.target_daemon, self.most, self.stopped = daemon, 0, threading.Event()

    def run(self):
        while not self.stopped.wait(0.05):
            self.most = max(self.most, process.resident(self.target_daemon))


def goodput(result):
    return result["fulfilled"]["count"] / result["seconds"]


def measure(daemon, source, place, seconds):
    """Measures the capacity before and after the overload, and the overload."""
    def peak():
        write_requests(f"{place}/closed", source, round(3000 * (WARM + seconds)))
        return load(daemon, f"{place}/closed", CLOSED_CONNECTIONS, 0, seconds)

    before = peak()
    rate = TIMES * goodput(before)
    write_requests(f"{place}/open", source, round(rate * (WARM + seconds)) + 1)
    over = load(daemon, f"{place}/open", OPEN_CONNECTIONS, rate, seconds)
    while daemon.metric("queue_depth") or daemon.metric("workers_busy"):
        time.sleep(0.02)
    return before, rate, over, peak()


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--seconds", type=float, default=1.5, help="of each of the three measurements, beside half a second to warm up")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    asked = ASKED_SHORT if options.short else ASKED
    those = mix.surfaces(40, 4, 24) if options.short else mix.surfaces(56, 4, 40)
    with tempfile.TemporaryDirectory() as place, Daemon(*FLAGS) as daemon:
        empty = process.resident(daemon)
        source = mix.Mix(random.Random(options.seed), those, mix.upload(daemon, those), WEIGHTS)
        memory = MemoryWatch(daemon)
        memory.start()
        try:
            before, rate, over, after = measure(daemon, source, place, options.seconds)
        finally:
            memory.stopped.set()
            memory.join()
    top = (goodput(before) + goodput(after)) / 2
    statuses = set(over["statuses"]) | set(before["statuses"])
    return conclude("overload", [
        report(f"overload of {TIMES} times the capacity: goodput", f">= {asked['goodput']:.0%} of the peak",
               f"{goodput(over):.0f}/s of {top:.0f}/s ({goodput(before):.0f}, {goodput(after):.0f}) = {goodput(over) / top:.0%}, {rate:.0f}/s offered", goodput(over) >= asked["goodput"] * top),
        report("overload: 503 p99", f"<= {asked['refusal']} ms", f"{over['refused']['p99']:.1f} ms of {over['refused']['count']}",
               over["refused"]["count"] > 0 and over["refused"]["p99"] <= asked["refusal"]),
        report("overload: /livez p99", f"<= {asked['livez']} ms", f"{over['livez']['p99']:.1f} ms, at most {over['livez']['max']:.1f} ms, of {over['livez']['count']}",
               over["livez"]["count"] > 0 and over["livez"]["p99"] <= asked["livez"]),
        report("overload: resident memory", "budget + 10 % + 64 MiB", f"{memory.most / MIB:.0f} MiB, {empty / MIB:.0f} before, budget {BUDGET / MIB:.0f}",
               memory.most <= 1.1 * BUDGET + 64 * MIB),
        report("overload: no other answers, none broken", "200, 201, 503, 507",
               f"{dict(over['statuses'])}, {over['broken']} broken, {over['no_connection']} without a connection",
               statuses <= {"200", "201", "503", "507"} and over["broken"] == 0),
    ])


if __name__ == "__main__":
    sys.exit(main())
