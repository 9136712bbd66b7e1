#!/usr/bin/env python3
"""Kills the daemon by SIGKILL during uploads, replacements and deletes. No acknowledged change is
lost, no change is stored in part, and the next start succeeds. The page cache survives a kill;
replay.py tests power cuts.

    tests/fault/kill.py [--loops N] [--seed N]
"""
import argparse
import random
import sys
import tempfile
import threading
import time

from common import GONE, Ledger, Shimmed, check, edges, mesh
from figures import conclude, report

CLIENTS = 3
NAMES = 3  # number of names of each client; no other client changes these names


def change(daemon, ledger, number, chance, until):
    """Uploads, replaces and deletes until the daemon is gone; returns the number of acknowledged
    changes."""
    acknowledged = 0
    connection = daemon.connect()
    try:
        while time.monotonic() < until:
            name = f"m{number}-{chance.randrange(NAMES)}"
            if chance.random() < 0.3:
                ledger.begin(name, None)
                answer = daemon.request("DELETE", f"/v1/meshes/{name}", connection=connection)
                if answer.status in (204, 404):
                    ledger.end(name, None)
            else:
                edge = round(chance.uniform(0.5, 2), 6)
                body = mesh(edge, chance.choice((0, 100, 5000, 300000)))
                ledger.begin(name, edge)
                answer = daemon.request("PUT", f"/v1/meshes/{name}", body, connection=connection)
                if answer.status in (200, 201):
                    ledger.end(name, edge)
            if answer.status not in (200, 201, 204, 404):
                raise AssertionError(answer)
            acknowledged += 1
    except GONE:
        pass
    return acknowledged


def loop(folder, ledger, chance):
    """Runs one life of a daemon; returns the faults, and the number of acknowledged changes."""
    daemon = Shimmed(folder)
    found = edges(daemon)
    wrong = ledger.faults(found)
    ledger.settle(found)
    counts = [0] * CLIENTS
    ledgers = [Ledger() for _ in range(CLIENTS)]

    def run(number, seed):
        counts[number] = change(daemon, ledgers[number], number, random.Random(seed), time.monotonic() + 5)

    threads = [threading.Thread(target=run, args=(number, chance.random())) for number in range(CLIENTS)]
    for thread in threads:
        thread.start()
    time.sleep(chance.uniform(0.002, 0.3))
    daemon.kill()
    for thread in threads:
        thread.join()
    for own in ledgers:
        ledger.acknowledged.update(own.acknowledged)
        for name, possible in own.possible.items():
            ledger.possible[name] = possible
    return wrong, sum(counts)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--loops", type=int, default=40)
    arguments.add_argument("--seed", type=int, default=None)
    options = arguments.parse_args()
    seed = options.seed if options.seed is not None else random.randrange(1 << 32)
    chance, ledger, wrong, acknowledged = random.Random(seed), Ledger(), [], 0
    with tempfile.TemporaryDirectory() as place:
        folder = f"{place}/data"
        for number in range(options.loops):
            faults, count = loop(folder, ledger, chance)
            wrong += faults
            acknowledged += count
            if number % 10 == 9 and (result := check(folder)).returncode:
                wrong.append(result.stdout)
        with Shimmed(folder) as daemon:
            wrong += ledger.faults(edges(daemon))
    for fault in wrong:
        print(f"wrong: {fault}")
    return conclude("kill", [report("kill -9 during uploads, replacements, deletes", "0 lost, 0 torn, each start succeeds",
                                    f"{options.loops} loops, {acknowledged} acknowledged changes, {len(wrong)} lost or torn (seed {seed})", not wrong)])


if __name__ == "__main__":
    sys.exit(main())
