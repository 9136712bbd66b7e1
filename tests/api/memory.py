#!/usr/bin/env python3
"""Measures the daemon's memory against its budget, and its first field against later fields. Prints
figures, not a verdict.

    tests/api/memory.py [OBJ ...]

Without files it uses sample meshes. Each row has the number of requested fields, and the resident
memory as a multiple of the budget and of the counted bytes. The memory of a daemon without meshes
is subtracted.
"""
import pathlib
import statistics
import sys
import time

from harness import Daemon, sample

FIELDS = 200
BUDGETS = ("96MiB", "512MiB", "2GiB")
FRESH = 7  # number of daemons
STRIDE = 7919  # number of faces between one source and the next source
CLASSES = ("meshes", "fields", "flight", "answers", "records", "workspaces", "landmarks", "spare")


def sample_files():
    return {
        "grid 16": sample("grid", columns=16, rows=16),
        "grid 200": sample("grid", columns=200, rows=200),
        "terrain 96": sample("terrain", cells=96, amplitude=1),
        "icosphere 5": sample("icosphere", level=5),
    }


def resident(daemon):
    """Returns the bytes of resident memory that are not backed by a file."""
    for line in pathlib.Path(f"/proc/{daemon.process.pid}/status").read_text().splitlines():
        if line.startswith("RssAnon:"):
            return int(line.split()[1]) << 10
    raise KeyError("RssAnon")


def counted(daemon):
    lines = daemon.get("/metrics").body.decode().splitlines()
    values = dict(line.split() for line in lines if line.startswith("geodesicd_memory_bytes{"))
    return {name: int(values[f'geodesicd_memory_bytes{{class="{name}"}}']) for name in CLASSES}



def ask(daemon, name, count, number):
    """Queries a new source until its field is built; returns the duration of the last query, which
    builds the field."""
    source, target = f"f:{STRIDE * number % count}:0.2,0.3,0.5", (STRIDE * number + count // 2) % count
    daemon.ask_often(name, source)
    begin = time.monotonic()
    answer = daemon.get(f"/v1/meshes/{name}/distance?from={source}&to=f:{target}:0.5,0.2,0.3")
    assert answer.status in (200, 507), answer
    return time.monotonic() - begin


def upload(daemon, files):
    counts = {}
    for number, body in enumerate(files.values()):
        answer = daemon.put(f"m{number}", body)
        if answer.status == 201:
            counts[f"m{number}"] = answer.json["faces"]
    return counts


def against_budget(budget, files):
    with Daemon("--memory-budget", budget, "--max-body", "64MiB", "--workers", "2") as daemon:
        before = resident(daemon)
        limit = daemon.metric("memory_budget_bytes")
        counts, peak = upload(daemon, files), 0
        for number in range(FIELDS):
            for name, count in counts.items():
                ask(daemon, name, count, number)
                peak = max(peak, resident(daemon))
        held = counted(daemon)
        total = sum(held.values())
        grown = resident(daemon) - before
        print(f"{budget:>7} {len(counts)} meshes, {FIELDS} fields each: resident {grown / 1e6:.0f} MB, peak {(peak - before) / 1e6:.0f} MB "
              f"= {(peak - before) / limit:.2f} of the budget; counted {total / 1e6:.0f} MB: "
              + ", ".join(f"{name} {value / 1e6:.0f}" for name, value in held.items()), flush=True)


def first_against_later(label, body):
    first, later = [], []
    with Daemon() as warm:
        count = warm.put("m", body).json["faces"]
        for number in range(FRESH, 3 * FRESH):
            ask(warm, "m", count, number)
        for number in range(FRESH):
            with Daemon() as fresh:
                fresh.put("m", body)
                first.append(ask(fresh, "m", count, number))
            later.append(ask(warm, "m", count, number))
    ratio = statistics.median(a / b for a, b in zip(first, later))
    print(f"{label:>16}: first field {statistics.median(first) * 1e3:.1f} ms, later {statistics.median(later) * 1e3:.1f} ms, "
          f"ratio {ratio:.2f}", flush=True)


def main():
    files = {pathlib.Path(path).stem: pathlib.Path(path).read_bytes() for path in sys.argv[1:]} or sample_files()
    for budget in BUDGETS:
        against_budget(budget, files)
    for label, body in files.items():
        first_against_later(label, body)


if __name__ == "__main__":
    main()
