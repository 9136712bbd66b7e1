#!/usr/bin/env python3
"""Flips single bytes anywhere in the data folder of a stopped or killed daemon. Then the daemon
must start. Its answers must be unchanged. Only a mesh may be unavailable, if the daemon has found
its damage.

    tests/fault/flip.py [--flips N] [--seed N]
"""
import argparse
import collections
import pathlib
import random
import shutil
import sys
import tempfile
import time

from common import Shimmed, harness, mesh
from figures import conclude, report

MESHES = {"a": mesh(1.5), "b": mesh(0.75, 4000), "same": mesh(1.5), "c": mesh(2.25, 300)}
FLAGS = ("--persist-fields", "--landmarks", "2")
SOURCES = ("v:0", "f:0:0.2,0.3,0.5")  # the sources of the fields that the answers use


def grid(cells):
    """Returns a square of `cells` unit cells a side, large enough for landmarks
    (server/surfaces/landmarks.c). Distances along its edges are whole numbers."""
    row = cells + 1
    vertices = [f"v {i % row} {i // row} 0\n" for i in range(row * row)]
    corners = [i * row + k + 1 for i in range(cells) for k in range(cells)]
    faces = [f"f {v} {v + 1} {v + row + 1}\nf {v} {v + row + 1} {v + row}\n" for v in corners]
    return "".join(vertices + faces).encode()


LARGE = grid(33)
SEARCH = "distance?from=v:2&to=v:3"  # this query has other points, so that it uses landmarks
QUERIES = (f"distance?from={SOURCES[0]}&to=v:1", f"path?from={SOURCES[1]}&to=v:3", SEARCH)


def warm(daemon):
    """Repeats queries until the fields and landmarks exist that the test damages."""
    for name in ("large", *MESHES):
        for source in SOURCES:
            daemon.ask_often(name, source)
        for query in QUERIES:
            daemon.get(f"/v1/meshes/{name}/{query}")
    get_landmarks(daemon)


def get_landmarks(daemon):
    """Waits until the large mesh has its landmarks, loaded or, if those are damaged, rebuilt. A
    search starts the build."""
    if daemon.get(f"/v1/meshes/large/{SEARCH}").status != 200:
        return
    until = time.monotonic() + harness.PATIENCE_SECONDS
    while not daemon.metric("landmarks_loaded_total") + daemon.metric("landmarks_built_total"):
        if time.monotonic() > until:
            raise TimeoutError("the large mesh got no landmarks")
        time.sleep(0.005)


def has_all_kinds(folder):
    """Returns whether the folder has fields and landmarks to damage."""
    return all(any(folder.rglob("*" + suffix)) for suffix in (".field", ".landmarks"))


def answers(daemon):
    """Returns the answers that a client can get: descriptions, contents, distances. Each answer has
    a status and a body."""
    seen = {}
    get_landmarks(daemon)
    for item in daemon.get("/v1/meshes?limit=100").json["meshes"]:
        item.pop("fields_cached")
        seen["description", item["name"]] = (200, item)
    for name in ("gone", "large", *MESHES):
        for query in QUERIES + ("content",):
            answer = daemon.get(f"/v1/meshes/{name}/{query}")
            body = answer.json if answer.status >= 400 else answer.body
            seen[query, name] = (answer.status, body.get("code") if isinstance(body, dict) else body)
    return seen


def prepare(place):
    """Prepares the folder of a stopped daemon, and the folder of a killed daemon. The database of
    the killed daemon has a log that is not empty. Returns both folders, and the answers that a
    daemon on either folder gives."""
    closed, killed = place / "closed", place / "killed"
    daemon = Shimmed(closed, *FLAGS)
    for name, body in [("gone", mesh(9)), ("large", LARGE), *MESHES.items()]:
        daemon.put(name, body)
    warm(daemon)
    daemon.stop()
    daemon = Shimmed(closed, *FLAGS)
    daemon.request("DELETE", "/v1/meshes/gone")
    daemon.put("c", mesh(3))
    daemon.put("c", MESHES["c"])
    shutil.copytree(closed, killed)
    expected = answers(daemon)
    daemon.stop()
    if not has_all_kinds(closed) or not has_all_kinds(killed):
        raise RuntimeError("there are no persisted fields or landmarks to damage")
    return (closed, killed), expected


def flip(folder, chance):
    """Flips a byte of a random file; returns its path and position."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size and path.name != "ballast")
    path = chance.choice(files)
    content = bytearray(path.read_bytes())
    at = chance.randrange(len(content))
    content[at] ^= chance.randrange(1, 256)
    path.write_bytes(content)
    return f"{path.relative_to(folder)}:{at}", path.suffix or path.parent.parent.name


def judge(before, after, log):
    """Returns the faults of the answers after the damage, and whether anything was unavailable."""
    complaints = [line for line in log if line.get("level") in ("warn", "error") and line["event"] != "request"]
    differ = [key for key in {*before, *after} if before.get(key) != after.get(key)]
    unavailable = {name for query, name in differ if after.get((query, name)) == (500, "internal")}
    wrong = [(key, before.get(key), after.get(key)) for key in differ if after.get(key) != (500, "internal")]
    wrong += [line for line in log if line["event"] == "not JSON"]
    if unavailable and not complaints:
        wrong.append("unavailable, but nothing was logged")
    if len(unavailable) > 1 and unavailable != {"a", "same"}:
        wrong.append(f"one byte, but several meshes are unavailable: {unavailable}")
    return wrong, bool(unavailable), bool(complaints)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--flips", type=int, default=100)
    arguments.add_argument("--seed", type=int, default=None)
    options = arguments.parse_args()
    seed = options.seed if options.seed is not None else random.randrange(1 << 32)
    chance, wrong, counts = random.Random(seed), [], collections.Counter()
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(text)
        folders, expected = prepare(place)
        for number in range(options.flips):
            folder = place / "flipped"
            shutil.copytree(folders[number % 2], folder)
            where, kind = flip(folder, chance)
            try:
                daemon = Shimmed(folder, *FLAGS)
                after = answers(daemon)
                status = daemon.stop()
                faults, unavailable, complained = judge(expected, after, daemon.log)
                wrong += [(where, fault) for fault in faults + ([f"exit status {status}"] if status else [])]
                counts["unavailable" if unavailable else "found and mended" if complained else "without effect"] += 1
            except Exception as failure:  # any exception is a fault of the daemon
                wrong.append((where, repr(failure)))
            shutil.rmtree(folder)
    for fault in wrong[:20]:
        print(f"wrong: {fault}")
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    return conclude("flip", [report("one byte of the store flipped", "detected, or without effect",
                                    f"{options.flips} flips ({kinds}), {len(wrong)} undetected or fatal (seed {seed})", not wrong)])


if __name__ == "__main__":
    sys.exit(main())
