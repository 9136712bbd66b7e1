#!/usr/bin/env python3
"""Single flipped bytes, anywhere in the data folder, stopped cleanly or killed: the daemon starts; every answer is the one that
it would have been, or the damage was found and that mesh says that it is unavailable; the others are served.

    tests/fault/flip.py [--flips N] [--seed N]
"""
import argparse
import collections
import pathlib
import random
import shutil
import sys
import tempfile

from common import Shimmed, mesh

MESHES = {"a": mesh(1.5), "b": mesh(0.75, 4000), "same": mesh(1.5), "c": mesh(2.25, 300)}
FLAGS = ("--persist-fields",)


def answers(daemon):
    """What a client can see: descriptions, contents, distances. Each is a status and a body."""
    seen = {}
    for item in daemon.get("/v1/meshes?limit=100").json["meshes"]:
        item.pop("fields_cached")
        seen["description", item["name"]] = (200, item)
    for name in ("gone", *MESHES):
        for query in ("distance?from=v:0&to=v:1", "path?from=f:0:0.2,0.3,0.5&to=v:3", "content"):
            answer = daemon.get(f"/v1/meshes/{name}/{query}")
            body = answer.json if answer.status >= 400 else answer.body
            seen[query, name] = (answer.status, body.get("code") if isinstance(body, dict) else body)
    return seen


def prepare(place):
    """A folder that was closed, and one whose daemon was killed, so that the database's log is full; their answers."""
    closed, killed = place / "closed", place / "killed"
    daemon = Shimmed(closed, *FLAGS)
    for name, body in [("gone", mesh(9)), *MESHES.items()]:
        daemon.put(name, body)
    expected = answers(daemon)
    daemon.stop()
    daemon = Shimmed(closed, *FLAGS)
    daemon.request("DELETE", "/v1/meshes/gone")
    daemon.put("c", mesh(3))
    daemon.put("c", MESHES["c"])
    shutil.copytree(closed, killed)
    expected = answers(daemon)
    daemon.stop()
    return (closed, killed), expected


def flip(folder, chance):
    """Flips a byte of a file that is chosen by the toss of a die; its path and place."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size and path.name != "ballast")
    path = chance.choice(files)
    content = bytearray(path.read_bytes())
    at = chance.randrange(len(content))
    content[at] ^= chance.randrange(1, 256)
    path.write_bytes(content)
    return f"{path.relative_to(folder)}:{at}", path.suffix or path.parent.parent.name


def judge(before, after, log):
    """What is wrong with the answers after the damage, and whether anything was unavailable."""
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
            except Exception as failure:  # whatever it is, it is a fault of the daemon
                wrong.append((where, repr(failure)))
            shutil.rmtree(folder)
    for fault in wrong[:20]:
        print(f"wrong: {fault}")
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    print(f"# flipped bytes: {options.flips} ({kinds}), {len(wrong)} undetected or fatal (seed {seed})")
    print("not ok flip" if wrong else "ok flip")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
