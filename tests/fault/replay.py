#!/usr/bin/env python3
"""Tests power cuts. record.c records one scenario's changes to the data folder, through several
lives of the daemon, some of which end by a kill. For each prefix of the changes, the test rebuilds
the folder in a state that a power cut at that moment may leave. Then --check-store must find no
fault, the daemon must start, and must have every change that it had acknowledged before.

A cut may lose changes that were not synced: contents written since the file's last fsync, and names
changed since their folder's last fsync. Each cut is tried in three modes, which differ in the
changes that survive:
    none     none of them
    mixed    a random half of them: each write and each name survives with probability 1/2
    all      all of them (as after a kill)

    tests/fault/replay.py [--step N] [--mixed N] [--seed N]
"""
import argparse
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

from common import GONE, PROGRAM, Ledger, Shimmed, build_shim, check, edges, mesh
from figures import conclude, report

DATA = "data"  # name of the data folder in the recorded folder

HEAD = re.compile(rb"(\w) (\d+) (-?\d+) \[(.*?)\] \[(.*?)\]\n")


# --- the scenario -------------------------------------------------------------------------------


def mark(log, text):
    """Adds an entry of the test between the entries of the daemon. The daemon answers after its
    syncs, so the order is correct."""
    with open(log, "ab") as file:
        file.write(b"A 0 0 [%s] []\n" % text.encode())


RESTART, KILL = "restart", "kill"
STEPS = [("a", 1.5, 0), ("b", 0.75, 9000), ("a", 1.25, 0), ("c", 1.25, 0), ("b", None, 0), KILL, ("a", None, 0), ("d", 2.5, 70000),
         ("b", 0.875, 300), RESTART, ("c", 3.5, 0), ("a", 1.5, 0), ("d", None, 0), KILL, ("a", 4.5, 20000)]


class Scenario:
    """Creates meshes, some of them with equal contents. Replaces the contents of meshes by other
    contents and by the same contents, and deletes meshes. Restarts and kills the daemon several
    times."""

    def __init__(self, root, log, library):
        self.folder, self.log, self.library = root / DATA, log, library
        self.environment = {"RECORD_ROOT": str(root), "RECORD_LOG": str(log)}

    def start(self, **environment):
        self.daemon = Shimmed(self.folder, library=self.library, environment={**self.environment, **environment})

    def die_at_the_start(self):
        """Kills the daemon after it has made a folder whose name is not durable yet. Returns false
        if the daemon made no folder."""
        environment = {**os.environ, **self.environment, "LD_PRELOAD": str(self.library), "RECORD_KILL": "M",
                       "GEODESICD_SANDBOX": "off"}
        process = subprocess.Popen([PROGRAM, "--data-dir", self.folder, "--listen", "127.0.0.1:0"], env=environment,
                                   stderr=subprocess.PIPE, text=True)
        while (line := process.stderr.readline()) and '"listening"' not in line:
            pass
        process.kill()
        process.wait()
        process.stderr.close()
        return not line

    def change(self, name, edge, padding):
        mark(self.log, f"begin {name} {edge}")
        answer = self.daemon.request("DELETE", f"/v1/meshes/{name}") if edge is None else self.daemon.put(name, mesh(edge, padding))
        assert answer.status in (200, 201, 204), answer
        mark(self.log, f"end {name} {edge}")

    def change_twice(self, name, edge):
        """Kills the daemon after it has made the folder for the bytes of a mesh. The next life
        stores the same bytes."""
        self.daemon.stop()
        self.start(RECORD_KILL="M")
        try:
            self.change(name, edge, 0)
            raise AssertionError("the folder was there already")
        except GONE:
            self.daemon.kill()
        self.start()
        self.change(name, edge, 0)

    def run(self):
        while self.die_at_the_start():
            pass
        self.start()
        for step in STEPS:
            if isinstance(step, tuple):
                self.change(*step)
                continue
            self.daemon.stop() if step == RESTART else self.daemon.kill()
            self.start()
        self.change_twice("e", 5.5)
        self.daemon.stop()


def read_log(log):
    data, at, entries = log.read_bytes(), 0, []
    while at < len(data):
        head = HEAD.match(data, at)
        kind, size, number = head[1].decode(), int(head[2]), int(head[3])
        entries.append((kind, number, head[4].decode(), head[5].decode(), data[head.end() : head.end() + size]))
        at = head.end() + size
    return entries


# --- a file system that forgets -----------------------------------------------------------------


class File:
    """The contents of a file on the disk, and the writes that are not synced yet."""

    def __init__(self):
        self.durable, self.pending = b"", []

    @staticmethod
    def applied(content, changes):
        content = bytearray(content)
        for at, data in changes:
            if data is None:  # truncate
                del content[at:]
                content.extend(bytes(at - len(content)))
            else:
                content.extend(bytes(max(0, at - len(content))))
                content[at : at + len(data)] = data
        return bytes(content)

    def sync(self):
        self.durable, self.pending = self.applied(self.durable, self.pending), []

    def content(self, lost, chance):
        kept = {"none": [], "all": self.pending}.get(lost)
        return self.applied(self.durable, [c for c in self.pending if chance.random() < 0.5] if kept is None else kept)


class Folder:
    def __init__(self):
        self.durable, self.now = {}, {}

    def sync(self):
        self.durable = dict(self.now)

    def names(self, lost, chance):
        if lost != "mixed":
            return self.durable if lost == "none" else self.now
        both = {name: (self.durable.get(name), self.now.get(name)) for name in {*self.durable, *self.now}}
        chosen = {name: before if before is after or chance.random() < 0.5 else after
                  for name, (before, after) in both.items()}
        return {name: node for name, node in chosen.items() if node}


class Disk:
    def __init__(self, root):
        self.base, self.top = pathlib.Path(root), Folder()

    def folder(self, path):
        node = self.top
        for part in path.relative_to(self.base).parts:
            node = node.now[part]
        return node

    def place(self, text):
        path = pathlib.Path(text)
        return self.folder(path.parent), path.name

    def play(self, kind, number, first, second, data):
        if kind == "A" or first == str(self.base):
            if kind == "S":
                self.top.sync()
            return
        if kind in "WTS" and first.endswith(" (deleted)"):
            return
        folder, name = self.place(first)
        if kind == "C":
            folder.now[name] = File()
        elif kind == "M":
            folder.now[name] = Folder()
        elif kind in "WT":
            folder.now[name].pending.append((number, data if kind == "W" else None))
        elif kind == "S":
            folder.now[name].sync()
        elif kind in "UD":
            del folder.now[name]
        else:
            other, other_name = self.place(second)
            other.now[other_name] = folder.now[name]
            if kind == "R":
                del folder.now[name]

    def write(self, root, lost, chance):
        """Writes the folder in the state after a power cut."""
        def write_folder(folder, path):
            path.mkdir()
            for name, node in folder.names(lost, chance).items():
                if isinstance(node, Folder):
                    write_folder(node, path / name)
                # the -shm file is shared memory, which SQLite creates again
                elif not name.endswith("-shm"):
                    (path / name).write_bytes(node.content(lost, chance))

        write_folder(self.top, pathlib.Path(root))


# --- the trial ----------------------------------------------------------------------------------


def follow(ledger, text):
    act, name, edge = text.split()
    (ledger.begin if act == "begin" else ledger.end)(name, None if edge == "None" else float(edge))


def trial(disk, ledger, place, lost, chance):
    """Returns the faults after a cut at this moment."""
    folder = place / "cut"
    disk.write(folder, lost, chance)
    wrong = []
    # before the first acknowledgement the data folder may be incomplete
    if ledger.acknowledged and (result := check(folder / DATA)).returncode:
        wrong.append(result.stdout)
    try:
        daemon = Shimmed(folder / DATA)
        wrong += ledger.faults(edges(daemon))
        daemon.kill()
    except RuntimeError as failure:
        wrong.append(str(failure))
    shutil.rmtree(folder)
    return wrong


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--step", type=int, default=8, help="every STEPth prefix")
    arguments.add_argument("--mixed", type=int, default=1, help="how many mixtures of each")
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    chance, ledger, wrong, cuts, prefixes = random.Random(options.seed), Ledger(), [], 0, 0
    with tempfile.TemporaryDirectory() as text:
        place = pathlib.Path(os.path.realpath(text))
        root, log = place / "recorded", place / "log"
        root.mkdir()
        Scenario(root, log, build_shim("record", place)).run()
        entries = read_log(log)
        disk = Disk(root)
        for number, (kind, at, first, second, data) in enumerate(entries):
            disk.play(kind, at, first, second, data)
            if kind == "A":
                follow(ledger, first)
            if number % options.step and number != len(entries) - 1:
                continue
            prefixes += 1
            for lost in ["none", "all"] + ["mixed"] * options.mixed:
                cuts += 1
                wrong += [(number, lost, fault) for fault in trial(disk, ledger, place, lost, chance)]
    for fault in wrong[:20]:
        print(f"wrong: {fault}")
    return conclude("replay", [report("power cuts at recorded writes, unsynced data dropped", "0 lost, 0 torn, each start succeeds",
                                      f"{prefixes} of {len(entries)} prefixes, {cuts} cuts, {len(wrong)} lost, torn or unable to start", not wrong)])


if __name__ == "__main__":
    sys.exit(main())
