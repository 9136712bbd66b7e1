#!/usr/bin/env python3
"""Tests three nodes that share a PostgreSQL server, behind HAProxy with the shipped configuration,
on loopback: the answers that clients get when nodes, the database or the network between them fail
and recover. (test_nodes.py tests the nodes themselves; routing.py
tests which node gets a request.)

    tests/cluster/shared.py [--short]

Needs haproxy and postgresql.
"""
import argparse
import contextlib
import shutil
import sys
import time
import unittest

import cluster
from front import Front
from load import Load, Questions, Uploads
from nodes import Member

import harness
from figures import conclude, report

NODES = 3
PAUSE = 1.5  # the load runs this many seconds before and after each event


class Cluster:
    """The database, the nodes, and the proxy. The last node connects to the database through a
    relay."""

    def __init__(self, stack, short):
        self.database = stack.enter_context(cluster.Postgres())
        self.relay = cluster.Relay(self.database.port)
        stack.callback(self.relay.close)
        ports = [self.database.port] * (NODES - 1) + [self.relay.port]
        self.members = [Member("--store", self.database.url_at(port), "--landmarks", "0") for port in ports]
        for member in self.members:
            stack.callback(member.stop)
        self.front = stack.enter_context(Front([member.port for member in self.members]))
        meshes = {f"m{i}": (harness.sample("terrain", cells=16, seed=i), 17 * 17) for i in range(6 if short else 30)}
        self.questions = Questions(meshes, 4)
        with harness.Daemon("--landmarks", "0") as alone:
            self.questions.upload(alone)
            self.questions.learn(alone)
        self.uploads = []

    def load(self):
        return Load(self.front.port, self.questions, clients=4)

    def upload(self):
        self.uploads.append(Uploads(self.front.port, f"u{len(self.uploads)}-"))
        return self.uploads[-1]

    def health(self, member):
        return member.daemon.get("/readyz").json["status"]

    def wait_for_health(self, members, wanted):
        """Waits until the health of the members is as wanted; returns the seconds."""
        begun = time.monotonic()
        while any(self.health(member) != wanted for member in members):
            if time.monotonic() - begun > harness.PATIENCE_SECONDS:
                raise TimeoutError(f"nodes are not {wanted}")
            time.sleep(0.02)
        return time.monotonic() - begun


def spread(shared):
    """Each mesh is uploaded to one node; every node answers queries about it."""
    for number, (name, (file, _)) in enumerate(shared.questions.meshes.items()):
        assert shared.members[number % NODES].daemon.put(name, file).status == 201
    answers = [(path, member.daemon.get(path)) for member in shared.members for path in shared.questions.paths]
    wrong = [(path, answer) for path, answer in answers if answer.body not in shared.questions.allowed[path]]
    return [report("uploads to any node, questions to every one", "as one node's, to the last byte",
                   f"{len(answers) - len(wrong)} of {len(answers)}" + "".join(map(str, wrong[:1])), not wrong)]


def kill_a_node(shared):
    with shared.load() as load, shared.upload() as uploads:
        time.sleep(PAUSE)
        shared.members[0].kill()
        shared.front.wait_until(NODES - 1)
        time.sleep(PAUSE)
        shared.members[0].daemon.stop()
        shared.members[0].start()
        shared.front.wait_until(NODES)
    uploads.verify_all()
    return [report("a node is killed under load: reads", "0 failed, 0 wrong", load.told(), not load.failed and not load.wrong and load.count > 50),
            report("a node is killed under load: uploads", "those acknowledged are there; at most the one under way is refused", uploads.told(),
                   not uploads.wrong and len(uploads.refused) <= 1 and len(uploads.stored) > 2)]


def restart_in_turn(shared):
    with shared.load() as load, shared.upload() as uploads:
        time.sleep(PAUSE)
        for member in shared.members:
            member.stop()
            member.start()
            shared.front.wait_until(NODES)
    uploads.verify_all()
    return [report("rolling restart under load", "0 failed", f"{load.told()}; uploads: {uploads.told()}",
                   not (load.failed or load.wrong or uploads.refused or uploads.wrong) and load.count > 100 and len(uploads.stored) > 10)]


def wait_for_refusal(uploads):
    """Waits until an upload is refused. An upload in progress is retried for some seconds."""
    until = time.monotonic() + harness.PATIENCE_SECONDS
    while not uploads.refused and time.monotonic() < until:
        time.sleep(0.05)
    time.sleep(PAUSE)


def stop_the_database(shared):
    """Stops the database. All queried surfaces are in memory, so nodes continue to answer
    queries."""
    with shared.load() as load, shared.upload() as uploads:
        time.sleep(PAUSE)
        shared.database.stop()
        shared.wait_for_health(shared.members, "degraded")
        wait_for_refusal(uploads)
        up = shared.front.up()
        begun = time.monotonic()
        shared.database.start()
        seconds = shared.wait_for_health(shared.members, "ok")
        started = time.monotonic() - begun - seconds
        time.sleep(PAUSE)
        count = len(uploads.stored)
        time.sleep(PAUSE)
    uploads.verify_all()
    statuses = {status for _, status, _ in uploads.refused}
    return [report("the database is stopped: reads from memory", "0 failed, 0 wrong, no node taken out",
                   f"{load.told()}; {len(up)} nodes up", not load.failed and not load.wrong and len(up) == NODES),
            report("the database is stopped: uploads", "503, and those acknowledged are there",
                   f"{uploads.told()}; refused with {statuses}", statuses == {503} and not uploads.wrong),
            report("the database is back: recovery", "by itself",
                   f"{seconds:.2f} s after its start of {started:.1f} s; {len(uploads.stored) - count} uploads in the next {PAUSE} s", len(uploads.stored) > count)]


def cut_the_network(shared):
    """Cuts the network between one node and the database; HAProxy continues to send requests to
    that node."""
    cut = shared.members[-1]
    with shared.load() as load, shared.upload() as uploads:
        time.sleep(PAUSE)
        shared.relay.refuse()
        noticed = shared.wait_for_health([cut], "degraded")
        others = {shared.health(member) for member in shared.members[:-1]}
        wait_for_refusal(uploads)
        shared.relay.mend()
        seconds = shared.wait_for_health([cut], "ok")
        time.sleep(PAUSE)
    uploads.verify_all()
    statuses = {status for _, status, _ in uploads.refused}
    return [report("the network between a node and the database is cut: reads", "0 failed, 0 wrong", load.told(), not load.failed and not load.wrong),
            report("the network is cut: uploads", "503 of that node only, those acknowledged are there", f"{uploads.told()}; others are {others}",
                   statuses <= {503} and others == {"ok"} and not uploads.wrong and uploads.stored),
            report("the network is mended: recovery", "by itself", f"noticed after {noticed:.2f} s, back after {seconds:.2f} s", seconds < 10)]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    if not shutil.which("haproxy"):
        print("skip shared: haproxy is not installed")
        return 0
    try:
        cluster.require()
        cluster.unprivileged()
    except unittest.SkipTest as reason:
        print(f"skip shared: {reason}")
        return 0
    held = []
    with contextlib.ExitStack() as stack:
        shared = Cluster(stack, options.short)
        for test in (spread, kill_a_node, restart_in_turn, stop_the_database, cut_the_network):
            held += test(shared)
    return conclude("shared", held)


if __name__ == "__main__":
    sys.exit(main())
