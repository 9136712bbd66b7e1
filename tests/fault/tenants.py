#!/usr/bin/env python3
"""Measures how long one tenant's queries take: alone, while another tenant floods the daemon with
jobs, and while it floods the daemon with waiting requests.

    tests/fault/tenants.py [--count N] [--short]

Both tenants request new fields, each of which takes some hundredths of a second. The victim sends
one request after the other. The flood sends five times as many requests as the daemon can answer.
The floods come from gd_load (load.c). --short: smaller surfaces, and no bound on the ratio, since
other tests use the processors; but no query may be refused.
"""
import argparse
import http.client
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import time

import mix
from common import PROGRAM, Daemon
from figures import conclude, quantile, report
from harness import sample, wait_until
from test_access import bearer, digest, key_of

RATIO = 3
TIMES = 5
CLIENTS = 600  # number of clients of the flood, which is larger than the queue
FLAGS = ("--memory-budget", "2GiB", "--workers", "2", "--http-threads", "2", "--landmarks", "0", "--timeout-ms", "30000")
# `ann-jobs`: a second key of the victim's tenant
VICTIM, FLOOD, SAME, WATCH = "ann", "bob", "ann-jobs", "watch"


class Keyed(Daemon):
    def __init__(self, place, cells):
        keys = pathlib.Path(place) / "keys"
        settings = {VICTIM: "role=write", FLOOD: "role=write", SAME: f"role=write tenant={VICTIM}", WATCH: "role=operator"}
        keys.write_text("".join(f"{name} sha256:{digest(key_of(name))} {text}\n" for name, text in settings.items()))
        super().__init__("--keys", str(keys), *FLAGS)
        self.vertices = (cells + 1) ** 2
        for name in (VICTIM, FLOOD):
            answer = self.request("PUT", "/v1/meshes/it", sample("terrain", cells=cells, amplitude=1), bearer(name))
            assert answer.status == 201, answer


def question(chance, vertices):
    """Returns a request for the field of a new set."""
    points = [{"vertex": vertex} for vertex in chance.sample(range(vertices), 2)]
    return json.dumps({"set": {"points": points}}).encode()


def flood(daemon, place, name, headers, rate, seconds):
    """Starts a flood of `rate` requests a second for `seconds`, regardless of the answers. Returns
    the process."""
    chance, path = random.Random(name), f"{place}/requests"
    with open(path, "wb") as file:
        for _ in range(round(rate * seconds) + 1):
            text = mix.encode(mix.Request("field", "POST", "/v1/meshes/it/fields", question(chance, daemon.vertices), {**mix.JSON, **bearer(name), **headers}))
            file.write(b"%d\n" % len(text) + text)
    command = [PROGRAM.parent / "gd_load", str(daemon.port), path, str(CLIENTS), f"{rate:.3f}", "0", f"{seconds:.3f}"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)


def ask(daemon, count, seed):
    """Returns the seconds of each query, and the statuses of failures."""
    chance, took, refused = random.Random(seed), [], []
    for _ in range(count):
        begun = time.monotonic()
        try:
            status = daemon.request("POST", "/v1/meshes/it/fields", question(chance, daemon.vertices), {**mix.JSON, **bearer(VICTIM)}).status
        except (OSError, http.client.HTTPException) as error:
            status = repr(error)
        if status == 201:
            took.append(time.monotonic() - begun)
        else:
            refused.append(status)
    return took, refused


def measure(daemon, place, what, count, bound):
    name, headers = {"jobs": (FLOOD, {"Prefer": "respond-async"}), "requests": (FLOOD, {}),
                     "jobs of its own": (SAME, {"Prefer": "respond-async"})}[what]
    own, _ = ask(daemon, count, f"{what}-alone")
    seconds = 2 + count * 4 * quantile(own, 0.5)
    load = flood(daemon, place, name, headers, TIMES * 2 / quantile(own, 0.5), seconds)
    time.sleep(1)
    beside, refused = ask(daemon, count, f"{what}-beside")
    under_load = load.poll() is None
    load.wait()
    statuses = json.loads(load.stdout.read())["statuses"]
    load.stdout.close()
    wait_until_idle(daemon)
    more, _ = ask(daemon, count, f"{what}-after")
    ratio = quantile(beside, 0.99) / quantile(own + more, 0.99)
    return report(f"a tenant beside a flood of {what}: p99", f"none refused, {bound} times its own" if bound else "none refused",
                  f"{quantile(beside, 0.99) * 1000:.0f} ms of {quantile(own + more, 0.99) * 1000:.0f} ms = {ratio:.1f} times (median "
                  f"{quantile(beside, 0.5) * 1000:.0f} of {quantile(own + more, 0.5) * 1000:.0f} ms), {len(refused)} of {count} refused {refused[:3]}; the flood: {statuses}"
                  + ("" if under_load else ", which ended early"),
                  not refused and (not bound or ratio <= bound))


def wait_until_idle(daemon):
    """Removes the remains of the flood, and waits until no request waits for a worker."""
    for name in (FLOOD, SAME):
        while jobs := daemon.request("GET", "/v1/jobs?limit=1000", None, bearer(name)).json["jobs"]:
            for job in jobs:
                daemon.request("DELETE", f"/v1/jobs/{job['id']}", None, bearer(name))
    wait_until(lambda: "\ngeodesicd_requests_deferred 0\n" in daemon.request("GET", "/metrics", None, bearer(WATCH)).body.decode())


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--count", type=int, default=200, help="questions of each measurement")
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    count, cells, bound = (12, 80, None) if options.short else (options.count, 160, RATIO)
    with tempfile.TemporaryDirectory() as place, Keyed(place, cells) as daemon:
        return conclude("tenants", [measure(daemon, place, what, count, bound) for what in ("jobs", "requests", "jobs of its own")])


if __name__ == "__main__":
    sys.exit(main())
