#!/usr/bin/env python3
"""Tests a disk that fails (inject.c):

- After a failed fsync, at any call, the store accepts no changes and continues to answer.
- On a full disk, at any write, uploads are refused, reads and deletes work, and the store recovers
  without a restart. Rebuilding the database meanwhile loses no mesh.
- With an EIO at any call, or interrupted or partial calls, nothing is lost.
- While the disk is slow, queries are answered, meshes that are created and deleted are present or
  absent, and the daemon can stop.

    tests/fault/disk.py [--most N] [--step N]

--most: only the first N calls fail in turn. --step: with EIO, only every N-th call fails.
"""
import argparse
import collections
import concurrent.futures
import itertools
import pathlib
import statistics
import sys
import tempfile
import threading
import time

from common import Ledger, Shimmed, build_shim, check, edges, harness, mesh
from figures import conclude, report

SLOW_MS = 20  # a time longer than any query of this test


class Trial:
    """A daemon on a folder with two meshes. Its disk fails when the test requests a failure."""

    def __init__(self, place, number, library, *flags):
        self.folder, self.order_file = place / f"data{number}", place / f"order{number}"
        self.library, self.flags = library, flags
        self.wrong, self.ledger = [], Ledger()
        self.order("fine")
        self.start()
        for name, edge in (("a", 1.5), ("b", 2.5)):
            self.put(name, edge)

    def start(self):
        self.daemon = Shimmed(self.folder, *self.flags, library=self.library,
                              environment={"INJECT_ROOT": str(self.folder), "INJECT_ORDER": str(self.order_file)})

    def order(self, text):
        self.order_file.write_text(text)

    @property
    def fired(self):
        """Returns whether the last requested failure has happened."""
        return self.order_file.with_name(self.order_file.name + ".fired").exists()

    def expect(self, what, got, *allowed):
        if got not in allowed:
            self.wrong.append(f"{what}: {got}, not one of {allowed}")

    def put(self, name, edge, padding=0):
        self.ledger.begin(name, edge)
        answer = self.daemon.put(name, mesh(edge, padding))
        if answer.status in (200, 201):
            self.ledger.end(name, edge)
        return answer

    def delete(self, name):
        self.ledger.begin(name, None)
        answer = self.daemon.request("DELETE", f"/v1/meshes/{name}")
        if answer.status == 204:
            self.ledger.end(name, None)
        return answer

    def expect_reads(self, when):
        for name, edge in self.ledger.acknowledged.items():
            answer = self.daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:1")
            if edge is not None:
                self.expect(f"{when}: distance on {name}", answer.json.get("distance"), edge)

    def end(self):
        """Restarts the daemon, and checks that all acknowledged changes are stored."""
        self.order("fine")
        self.expect("exit status", self.daemon.stop(), 0)
        if (result := check(self.folder)).returncode:
            self.wrong.append(result.stdout)
        with Shimmed(self.folder) as daemon:
            self.wrong += self.ledger.faults(edges(daemon))
            self.expect("upload after the restart", daemon.put("after", mesh(1)).status, 201)
        return self.wrong


def changes(trial):
    """Sends an upload, a replacement and a delete; returns their statuses."""
    return [trial.put("c", 0.75, 5000).status, trial.put("a", 1.25).status, trial.delete("b").status]


def try_fsync(place, number, library, call):
    trial = Trial(place, number, library)
    trial.order(f"fsync {call}")
    statuses = changes(trial)
    fired, ready = trial.fired, trial.daemon.get("/readyz")
    trial.expect("readyz", ready.status, 200)
    trial.expect("state", ready.json["status"], "read_only" if fired else "ok")
    if 507 in statuses:
        trial.expect("after the failed fsync", set(statuses[statuses.index(507) :]), {507})
    if fired:
        trial.expect("metric", trial.daemon.metric("store_writable"), 0)
        trial.expect("problem", trial.put("d", 1).json.get("code"), "insufficient_storage")
        trial.expect_reads("read-only")
        trial.ledger.possible.pop("d")  # the request was never sent
    return trial.end(), fired


def try_full(place, number, library, call):
    trial = Trial(place, number, library)
    trial.order(f"full {call}")
    status = trial.put("c", 0.75, 3000000).status
    trial.expect("upload", status, 201, 507)
    trial.expect("replacement", trial.put("a", 1.25, 3000000).status, 200, 507)
    fired = trial.fired
    if status == 507:
        trial.ledger.possible.pop("c")  # the refusal changed nothing
        trial.expect("the refused upload", trial.daemon.get("/v1/meshes/c").status, 404)
        trial.expect("metric", trial.daemon.metric("store_writable"), 1)
        trial.expect_reads("full disk")
        trial.expect("delete", trial.delete("b").status, 204)
        trial.expect("deleted", trial.daemon.get("/v1/meshes/b").status, 404)
        trial.order("fine")
        trial.expect("upload once there is room", trial.put("c", 0.75, 3000000).status, 201)
        trial.expect("ballast", (trial.folder / "ballast").exists(), True)
    return trial.end(), fired


def try_call(place, number, library, call):
    """Makes calls of all types fail, one at a time. Acknowledged changes must be stored. Each other
    change may be stored or not."""
    trial = Trial(place, number, library)
    trial.order(f"eio {call}")
    for status in changes(trial):
        trial.expect("change", status, 200, 201, 204, 500, 507)
    trial.expect_reads("after the failed call")
    return trial.end(), trial.fired


def try_start(place, number, library, call):
    """Tests a start during which the disk fails. The start may fail with a message. The next start
    finds all stored data."""
    trial = Trial(place, number, library)
    trial.daemon.stop()
    trial.order(f"eio {call}")
    try:
        trial.start()
    except RuntimeError as reason:
        trial.expect("the log says why it does not start", "error" in str(reason) or "fatal" in str(reason), True)
    else:
        for name in trial.ledger.acknowledged:
            trial.expect("a read after the start", trial.daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:1").status, 200, 500, 503)
    fired = trial.fired
    if trial.daemon.process.poll() is None:
        trial.daemon.stop()
    trial.order("fine")
    trial.start()
    trial.expect_reads("after the next start")
    return trial.end(), fired


def try_short(place, library):
    """Interrupted and partial reads and writes have no visible effect."""
    trial = Trial(place, "short", library)
    trial.order("short 3")
    for status, expected in zip(changes(trial), (201, 200, 204)):
        trial.expect("change", status, expected)
    trial.daemon.stop()
    trial.start()
    trial.expect_reads("read in parts")
    trial.expect("the order was carried out", trial.fired, True)
    return trial.end()


def try_rebuild(place, number, library, call):
    """The database is lost, and the disk has room to rebuild only a part of it. Then a client
    creates a mesh with the same bytes under another name, and deletes it."""
    trial = Trial(place, number, library)
    trial.put("c", 3.5)
    trial.daemon.stop()
    for file in trial.folder.glob("geodesicd.db*"):
        file.unlink()
    trial.order(f"full {call}")
    trial.start()
    fired = trial.fired
    for name, edge in list(trial.ledger.acknowledged.items()):
        trial.expect("upload of the same", trial.put("z", edge).status, 200, 201, 507)
        trial.expect("delete", trial.delete("z").status, 204, 404, 507)
    return trial.end(), fired


def run(kind, one, place, library, most, wrong, step=1):
    """Makes each `step`-th call fail in turn, until the changes need fewer calls."""
    for call in range(1, most + 1, step):
        faults, fired = one(place, f"{kind}{call}", library, call)
        wrong += [f"{kind} {call}: {fault}" for fault in faults]
        if not fired:
            return call - 1
    return most


# --- a slow disk --------------------------------------------------------------------------------


def run_beside(work, count, watch):
    """Starts `count` threads. Each thread calls `work` repeatedly, with its number. Meanwhile runs
    `watch`, and returns the result of `watch`."""
    stop = threading.Event()

    def repeat(number):
        while not stop.is_set():
            work(number)

    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        workers = [pool.submit(repeat, number) for number in range(count)]
        try:
            return watch()
        finally:
            stop.set()
            for worker in workers:
                worker.result()


def time_searches(daemon, count):
    connection, times = daemon.connect(), []
    for i in range(count):
        share = (i + 1) / (2 * count)
        # new points each time, so that a worker has to search
        place = f"{share},{share},{1 - 2 * share}"
        begun = time.monotonic()
        answer = daemon.request("GET", f"/v1/meshes/ball/distance?from=f:0:{place}&to=f:9:{place}", connection=connection)
        times.append(time.monotonic() - begun)
        assert answer.status == 200, answer
    return times


def wait_for_no_disk(place, library):
    """Checks that queries do not wait for the disk while many uploads and deletes wait for it.
    Returns the median time of a query in milliseconds."""
    trial = Trial(place, "waiting", library)
    trial.daemon.put("ball", harness.sample("icosphere", level=3))
    trial.order(f"slow {SLOW_MS}")

    def change(number):
        trial.daemon.put(f"u{number}", mesh(1 + number / 16))
        trial.daemon.request("DELETE", f"/v1/meshes/u{number}")

    median = 1000 * statistics.median(run_beside(change, 8, lambda: time_searches(trial.daemon, 100)))
    trial.expect(f"median of the searches beside a slow disk, {median:.1f} ms, is below one fsync's", median < SLOW_MS, True)
    trial.order("fine")
    trial.expect("exit status", trial.daemon.stop(), 0)
    return trial.wrong, median


def come_and_go(place, library):
    """Loads a mesh while a client deletes or replaces it. The daemon finds the mesh or reports it
    as absent, but never reports it as damaged."""
    files = [harness.sample("grid", columns=40 + number, rows=40) for number in range(6)]
    # the budget has room for one or two meshes
    trial = Trial(place, "coming", library, "--memory-budget", "4MiB", "--max-body", "1MiB")
    for number, file in enumerate(files):
        trial.daemon.put(f"g{number}", file)
    statuses, step = collections.Counter(), itertools.count()
    trial.order(f"slow {SLOW_MS}")

    def change(_):
        number = next(step) % len(files)
        trial.daemon.request("DELETE", f"/v1/meshes/g{number}")
        trial.daemon.put(f"g{number}", files[number])

    def watch():
        for number in range(600):
            statuses[trial.daemon.get(f"/v1/meshes/g{number % len(files)}/distance?from=v:0&to=v:1").status] += 1

    run_beside(change, 1, watch)
    trial.expect("statuses of meshes that come and go", set(statuses) - {507}, {200, 404})
    trial.expect("meshes were loaded meanwhile", trial.daemon.metric("mesh_loads_total") > 50, True)
    trial.order("fine")
    trial.expect("exit status", trial.daemon.stop(), 0)
    return trial.wrong


def end_while_waiting(place, library):
    """Stops a daemon while uploads wait for the disk. The daemon refuses these uploads, and keeps
    all acknowledged changes."""
    trial = Trial(place, "ending", library, "--drain-ms", "100")
    trial.order(f"slow {5 * SLOW_MS}")
    with concurrent.futures.ThreadPoolExecutor(12) as pool:
        answers = [pool.submit(trial.put, f"u{number}", 1 + number / 16) for number in range(12)]
        time.sleep(0.3)
        trial.expect("exit status", trial.daemon.stop(), 0)
    trial.expect("statuses of uploads when the daemon ends", {answer.result().status for answer in answers}, {201, 503})
    return trial.end()


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--most", type=int, default=60)
    arguments.add_argument("--step", type=int, default=1)
    options = arguments.parse_args()
    wrong = []
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(text).resolve()
        library = build_shim("inject", place)
        counts = [run(kind, one, place, library, options.most, wrong)
                  for kind, one in (("fsync", try_fsync), ("full", try_full), ("rebuild", try_rebuild))]
        calls = [run(kind, one, place, library, 10 * options.most, wrong, step)
                 for kind, one, step in (("eio", try_call, options.step), ("start", try_start, 1))]
        wrong += try_short(place, library)
        faults, median = wait_for_no_disk(place, library)
        wrong += faults + come_and_go(place, library) + end_while_waiting(place, library)
    for fault in wrong[:20]:
        print(f"wrong: {fault}")
    return conclude("disk", [
        report("failed fsync at each call", "read-only, nothing lost", f"{counts[0]} calls failed, {len(wrong)} faults", counts[0] and not wrong),
        report("disk full from each write on", "507, reads and deletes go on, recovery", f"{counts[1]} writes, {len(wrong)} faults", counts[1] and not wrong),
        report("disk full while a lost database is made again", "nothing lost", f"{counts[2]} writes, {len(wrong)} faults", counts[2] and not wrong),
        report("EIO at each call of the store", "nothing lost, the daemon lives", f"each {options.step}. of {calls[0]} calls of changes and each of {calls[1]} of a start, "
               f"{len(wrong)} faults", all(calls) and not wrong),
        report("a search beside a slow disk, median", f"< {SLOW_MS} ms", f"{median:.1f} ms", median < SLOW_MS)])


if __name__ == "__main__":
    sys.exit(main())
