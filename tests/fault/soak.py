#!/usr/bin/env python3
"""A soak: sends the random mix, including uploads, replacements, jobs and refusals, for a given
time, and watches memory, descriptors and threads. Prints the series; --svg also draws it.

    tests/fault/soak.py [--seconds N] [--clients N] [--pause MS] [--seed N] [--svg FILE]

The daemon is warm once the memory budget has been used up, but not before the first quarter. From
then on, the test measures the slope of resident memory (by least squares) and the numbers of
threads and descriptors. At the end everything is removed and the clients leave. The resources that
the daemon then holds are compared with those before the clients came.
"""
import argparse
import collections
import http.client
import random
import sys
import tempfile
import threading
import time

import mix
import process
from common import Daemon
from figures import conclude, report

MIB = 1 << 20
BUDGET = 128 * MIB
SAMPLES = 240
ROWS = 24  # number of rows of the printed series
FULL = 0.9  # the budget counts as used up if this share of it is used
DRIFT = 0.05  # growth by more than this share of the budget over the measured time is a leak
SHORT_SECONDS = 600  # in a soak shorter than this, the caches may still be filling
TRIM_SECONDS = 11  # period in which the daemon returns free heap memory to the system
# bytes that the allocator may keep beyond the memory of a new daemon; the daemon does not count
# them
EMPTY_SLACK = 48 * MIB
FLAGS = ("--memory-budget", f"{BUDGET}", "--workers", "2", "--http-threads", "2", "--max-body", "16MiB", "--max-jobs", "200", "--job-ttl-s", "60", "--scrub-s", "60",
         "--persist-fields")

Sample = collections.namedtuple("Sample", "seconds requests resident counted descriptors threads connections")


class Client(threading.Thread):
    """Sends requests until it is stopped. `statuses` counts the answers; `faults` lists the
    violations."""

    def __init__(self, daemon, requests, pause):
        super().__init__()
        self.target_daemon, self.requests, self.pause = daemon, requests, pause
        self.statuses, self.faults, self.stopped = collections.Counter(), [], threading.Event()

    def run(self):
        connection = self.target_daemon.connect()
        while not self.stopped.wait(self.pause):
            request = self.requests.next()
            try:
                answer = self.target_daemon.request(request.method, request.path, request.body, dict(request.headers), connection)
            except (OSError, http.client.HTTPException) as fault:
                self.faults.append(f"{request.kind}: {fault!r}")
                connection.close()
                continue
            self.requests.learn(request, answer)
            self.statuses[answer.status] += 1
            if answer.status >= 500 and answer.status not in (503, 504, 507):
                self.faults.append(f"{request.kind}: {answer}")
        connection.close()


def take(daemon, begun, clients):
    held = process.metrics(daemon)
    return Sample(time.monotonic() - begun, sum(sum(client.statuses.values()) for client in clients), process.resident(daemon),
                  sum(value for name, value in held.items() if name.startswith("memory_bytes{")), process.descriptors(daemon),
                  process.threads(daemon), held["connections"])


def take_at_rest(daemon, clients):
    """Returns the fewest resources that the daemon holds while no other request runs. Samples
    several times, because a closed connection may remain for a moment."""
    def one():
        time.sleep(0.05)
        return take(daemon, time.monotonic(), clients)

    return min((one() for _ in range(20)), key=lambda sample: (sample.descriptors, sample.threads))


def slope(series):
    """Returns the slope in bytes a second, by least squares."""
    mean_x = sum(sample.seconds for sample in series) / len(series)
    mean_y = sum(sample.resident for sample in series) / len(series)
    spread = sum((sample.seconds - mean_x) ** 2 for sample in series)
    return sum((sample.seconds - mean_x) * (sample.resident - mean_y) for sample in series) / spread if spread else 0


def watch(daemon, clients, seconds):
    begun, series = time.monotonic(), []
    while (now := time.monotonic() - begun) < seconds:
        time.sleep(max(0, seconds * (len(series) + 1) / SAMPLES - now))
        series.append(take(daemon, begun, clients))
    return series


def empty(daemon):
    """Removes everything that is stored, and waits until nothing runs."""
    for collection in ("meshes", "subdivisions", "nurbs"):
        while items := daemon.get(f"/v1/{collection}?limit=100").json[collection]:
            for item in items:
                assert daemon.request("DELETE", f"/v1/{collection}/{item['name']}").status == 204
    while any(daemon.metric(name) for name in ("workers_busy", "queue_depth", "requests_deferred")):
        time.sleep(0.05)
    time.sleep(TRIM_SECONDS)


def print_series(series):
    print(f"# {'seconds':>8} {'requests':>9} {'resident MiB':>13} {'counted MiB':>12} {'descriptors':>12} {'threads':>8} {'connections':>12}")
    for sample in series[:: max(1, len(series) // ROWS)]:
        print(f"# {sample.seconds:8.0f} {sample.requests:9} {sample.resident / MIB:13.1f} {sample.counted / MIB:12.1f} {sample.descriptors:12} "
              f"{sample.threads:8} {sample.connections:12.0f}")


def draw(series, path):
    """Draws four panels, each from zero to its greatest value."""
    width, height, gap = 760, 110, 34
    panels = [("resident memory, MiB", [sample.resident / MIB for sample in series]), ("counted memory, MiB", [sample.counted / MIB for sample in series]),
              ("descriptors", [sample.descriptors for sample in series]), ("threads", [sample.threads for sample in series])]
    parts = []
    for number, (label, values) in enumerate(panels):
        top, greatest = number * (height + gap) + gap, max(values) or 1
        places = " ".join(f"{60 + width * sample.seconds / series[-1].seconds:.1f},{top + height * (1 - value / greatest):.1f}"
                          for sample, value in zip(series, values))
        parts.append(f'<text x="60" y="{top - 6}">{label}: at most {greatest:.0f}</text><rect x="60" y="{top}" width="{width}" height="{height}" '
                     f'fill="none" stroke="#bbb"/><polyline points="{places}" fill="none" stroke="#1f77b4"/>')
    with open(path, "w") as file:
        file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width + 80}" height="{len(panels) * (height + gap) + gap}" '
                   f'font-family="sans-serif" font-size="12">{"".join(parts)}'
                   f'<text x="60" y="{len(panels) * (height + gap) + gap - 12}">{series[-1].seconds:.0f} seconds</text></svg>\n')


def warmed(series):
    """Returns the samples after the warm-up. If the budget was never used up, returns all samples
    after the first quarter."""
    full = next((sample.seconds for sample in series if sample.counted >= FULL * BUDGET), 0)
    return [sample for sample in series if sample.seconds >= max(full, series[-1].seconds / 4)]


def report_growth(warm, lasting, before):
    """Reports whether memory is never released."""
    if lasting > SHORT_SECONDS:
        rate = slope(warm)
        return report("soak: slope of resident memory after warm-up", f"within {DRIFT:.0%} of the budget over the time",
                      f"{rate * 3600 / MIB:+.1f} MiB/h, {rate * lasting / MIB:+.2f} MiB in {lasting:.0f} s", rate * lasting <= DRIFT * BUDGET)
    beyond = max(sample.resident - before.resident - sample.counted for sample in warm)
    return report("soak: resident memory beyond what is counted", f"<= {EMPTY_SLACK // MIB} MiB", f"at most {beyond / MIB:.0f} MiB", beyond <= EMPTY_SLACK)


def judge(series, before, after, clients):
    warm = warmed(series)
    lasting = warm[-1].seconds - warm[0].seconds
    faults = [fault for client in clients for fault in client.faults]
    for fault in faults[:10]:
        print(f"wrong: {fault}")
    statuses = sum((client.statuses for client in clients), collections.Counter())
    peak = max(sample.resident for sample in series) - before.resident
    span = {key: [getattr(sample, key) for sample in warm] for key in ("descriptors", "threads")}
    hours = f"{series[-1].seconds / 3600:.2f} h" if series[-1].seconds > 600 else f"{series[-1].seconds:.0f} s"
    return [
        report(f"soak of {hours}, random mix", "no fault", f"{series[-1].requests} requests, {len(faults)} faults, {dict(sorted(statuses.items()))}", not faults),
        report_growth(warm, lasting, before),
        report("soak: resident memory at most", "budget + 10 %", f"{peak / MIB:.0f} MiB = {peak / BUDGET:.0%} of the budget", peak <= 1.1 * BUDGET),
        report("soak: threads", "flat", f"{min(span['threads'])} to {max(span['threads'])}", len(set(span["threads"])) == 1),
        report("soak: descriptors", "flat", f"{min(span['descriptors'])} to {max(span['descriptors'])}",
               max(span["descriptors"]) <= before.descriptors + len(clients) + 4),
        report("soak: held in the end, emptied", "as before",
               f"{after.descriptors} descriptors ({before.descriptors}), {after.threads} threads ({before.threads}), "
               f"{after.counted / MIB:.0f} MiB counted, {after.resident / MIB:.0f} MiB resident",
               (after.descriptors, after.threads) == (before.descriptors, before.threads) and
               after.resident - before.resident <= after.counted + EMPTY_SLACK),
    ]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--seconds", type=float, default=10)
    arguments.add_argument("--clients", type=int, default=2)
    arguments.add_argument("--pause", type=float, default=0, help="milliseconds before each request of a client")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--svg")
    options = arguments.parse_args()
    chance = random.Random(options.seed)
    those = mix.surfaces(60, 4, 40)
    with tempfile.TemporaryDirectory() as place, Daemon("--data-dir", f"{place}/data", *FLAGS) as daemon:
        daemon.log = collections.deque(daemon.log, 1000)
        before = take_at_rest(daemon, [])
        faces = mix.upload(daemon, those)
        clients = [Client(daemon, mix.Mix(random.Random(chance.random()), those, faces), options.pause / 1000) for _ in range(options.clients)]
        for client in clients:
            client.start()
        series = watch(daemon, clients, options.seconds)
        for client in clients:
            client.stopped.set()
            client.join()
        empty(daemon)
        after = take_at_rest(daemon, clients)
    print_series(series)
    if options.svg:
        draw(series, options.svg)
    return conclude("soak", judge(series, before, after, clients))


if __name__ == "__main__":
    sys.exit(main())
