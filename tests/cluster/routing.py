#!/usr/bin/env python3
"""Tests three nodes behind HAProxy with the shipped configuration, on loopback: which node gets a
request; the results of requests when a node dies, restarts or is overloaded; and the gain if one
node gets all requests for a mesh.

    tests/cluster/routing.py [--short] [--seconds N]

Each node has its own folder, into which everything is uploaded; shared.py tests a shared store.
Needs haproxy.
"""
import argparse
import collections
import contextlib
import http.client
import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import yaml

from front import SHIPPED, Front
from load import Load, Questions
from nodes import HERE, Member

import harness
from figures import conclude, report

NODES = 3
NAMES = 300
ERRORS = 3  # errors after which HAProxy regards a node as dead: error-limit
BUDGET = "40MiB"  # memory for a third of the requested fields
POST = {"Content-Type": "application/json"}


def terrain(cells, seed):
    return harness.sample("terrain", cells=cells, seed=seed), (cells + 1) ** 2


class Cluster:
    """The nodes, the front, the queries, and a separate node that gives the expected answers."""

    def __init__(self, place, stack, short):
        self.nodes = [stack.enter_context(self.node(place, number)) for number in range(NODES)]
        ports = [node.port for node in self.nodes]
        self.front = stack.enter_context(Front(ports))
        # a second proxy that shows to which node a name belongs
        self.ring = stack.enter_context(Front(ports, [("hash-balance-factor 150", "hash-balance-factor 0")]))
        self.questions = Questions({f"m{i}": terrain(20, i) for i in range(6 if short else 24)}, 4)
        with harness.Daemon("--landmarks", "0") as alone:
            self.questions.upload(alone)
            self.questions.learn(alone)
        for node in self.nodes:
            self.questions.upload(node.daemon)

    @staticmethod
    @contextlib.contextmanager
    def node(place, number):
        node = Member("--data-dir", f"{place}/{number}", "--landmarks", "0")
        try:
            yield node
        finally:
            node.stop()

    def ask(self, path, method="GET", body=None, headers=None, front=None):
        connection = http.client.HTTPConnection("127.0.0.1", (front or self.front).port, timeout=60)
        try:
            connection.request(method, path, body, headers or {})
            response = connection.getresponse()
            return harness.Answer(response.status, response.headers, response.read())
        finally:
            connection.close()

    def places(self):
        """Returns the node for each of many names. Sends requests for meshes, which need not
        exist."""
        return {name: self.ask(f"/v1/meshes/{name}", front=self.ring).headers["X-Served-By"] for name in (f"n{i}" for i in range(NAMES))}

    def wait_until(self, count):
        for front in (self.front, self.ring):
            front.wait_until(count)


def count(places):
    return dict(sorted(collections.Counter(places.values()).items()))


def share_and_stay(cluster):
    """Each mesh belongs to one node, and each node has meshes. Another node occasionally answers,
    if HAProxy has not finished the preceding request."""
    seen = collections.defaultdict(collections.Counter)
    for path in 3 * cluster.questions.paths:
        answer = cluster.ask(path)
        assert answer.body in cluster.questions.allowed[path], (path, answer)
        seen[path.split("/")[3]][answer.headers["X-Served-By"]] += 1
    by_its_node, total = sum(max(counts.values()) for counts in seen.values()), 3 * len(cluster.questions.paths)
    places = cluster.places()
    largest = max(count(places).values()) / NAMES
    return [report("a mesh's requests go to its node", ">= 90 %",
                   f"{by_its_node} of {total}, {len(seen)} meshes, all answers as one node's to the last byte", by_its_node >= 0.9 * total),
            report("names are spread over three nodes", "<= 1/3 + 5 % on one", f"{count(places)} of {NAMES}", largest <= 1 / NODES + 0.05 and len(count(places)) == NODES)]


def lose_a_node(cluster):
    """Kills a node under load. Only the meshes of this node move to other nodes, and they return
    when the node runs again."""
    before, victim = cluster.places(), cluster.nodes[1]
    retried = cluster.front.total("haproxy_backend_redispatch_warnings_total")
    with Load(cluster.front.port, cluster.questions) as load:
        time.sleep(1)
        victim.kill()
        cluster.wait_until(NODES - 1)
        time.sleep(1)
    retried = cluster.front.total("haproxy_backend_redispatch_warnings_total") - retried
    during = cluster.places()
    victim.daemon.stop()
    victim.start()
    cluster.wait_until(NODES)
    after = cluster.places()
    moved = [name for name in before if before[name] != during[name]]
    strangers = [name for name in moved if before[name] != "node2"]
    return [report("a node is killed under load: wrong answers", "0", load.told(), not load.wrong and load.count > 100),
            report("a node is killed under load: failed requests", "0: reads are repeated at another node",
                   f"{len(load.failed)}; HAProxy asked another node {retried:.0f} times, {load.clients} requests were under way"
                   + "".join(f"; {item}" for item in load.failed[:3]), not load.failed and retried <= 2 * load.clients + ERRORS),
            report("keys that move when one of three nodes is lost", "<= 1/3 + 5 %", f"{len(moved) / NAMES:.1%}, {len(strangers)} of them another node's",
                   len(moved) <= NAMES * (1 / NODES + 0.05) and not strangers),
            report("keys are back with their node", "all", f"{sum(before[name] == after[name] for name in before)} of {NAMES}", before == after)]


def restart_in_turn(cluster):
    """Restarts nodes as an upgrade does: each ends by SIGTERM and starts again, while clients send
    queries."""
    with Load(cluster.front.port, cluster.questions) as load:
        time.sleep(0.5)
        for node in cluster.nodes:
            node.stop()
            node.start()
            cluster.wait_until(NODES)
    return [report("rolling restart under load: failed requests", "0", load.told() + "".join(f"; {item}" for item in load.failed[:3]),
                   not load.failed and not load.wrong and load.count > 100)]


def find_jobs(cluster):
    """Requests about a job may arrive at any node and still find the job."""
    ids = []
    for number in range(30):
        path = f"/v1/meshes/m{number % 6}/distance"
        answer = cluster.ask(path, "POST", json.dumps({"from": {"vertex": 0}, "to": {"vertex": number}}), {**POST, "Prefer": "respond-async"})
        ids.append(answer.headers["Location"])
    found = [cluster.ask(location) for location in ids]
    nodes = {answer.headers["X-Served-By"] for answer in found}
    told = [cluster.ask(f"{location}/events") for location in ids[:6]]
    return [report("jobs are found behind HAProxy", "all", f"{sum(answer.status == 200 for answer in found)} of {len(ids)}, on {len(nodes)} nodes",
                   all(answer.status == 200 for answer in found) and len(nodes) > 1),
            report("events of jobs come through HAProxy", "all", f"{sum(b'event:' in answer.body for answer in told)} of {len(told)}",
                   all(answer.headers["Content-Type"] == "text/event-stream" and b"event:" in answer.body for answer in told))]


def spill_over(cluster):
    """When many clients query one mesh, other nodes help. The queries are new, so that they take
    some time."""
    cells = 60
    for node in cluster.nodes:
        node.daemon.put("hot", terrain(cells, 1)[0])
    served, failed = collections.Counter(), []

    def ask(number):
        for turn in range(6):
            body = {"set": {"points": [{"vertex": 100 * number + turn}]}, "points": [{"vertex": 3000}]}
            answer = cluster.ask("/v1/meshes/hot/distance-to-set", "POST", json.dumps(body), POST)
            served[answer.headers["X-Served-By"]] += 1
            if answer.status != 200:
                failed.append(answer)

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(12)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    most = max(served.values()) / served.total()
    return [report("a mesh that many ask for spills over", "no node has all, none fails",
                   f"{dict(sorted(served.items()))}, {len(failed)} failed" + "".join(f"; {answer}" for answer in failed[:2]), len(served) > 1 and most < 0.9 and not failed)]


def lose_uploads(cluster):
    """HAProxy does not repeat an upload whose node dies: the client gets the failure."""
    outcomes, large = collections.Counter(), terrain(150, 3)[0]
    victim = cluster.nodes[0]
    names = [name for name, node in cluster.places().items() if node == "node1"][:8]

    def put(name):
        answer = cluster.ask(f"/v1/meshes/{name}", "PUT", large)
        outcomes[answer.status] += 1

    threads = [threading.Thread(target=put, args=(name,)) for name in names]
    for thread in threads:
        thread.start()
    time.sleep(0.05)
    victim.kill()
    for thread in threads:
        thread.join()
    elsewhere = sum(node.daemon.get(f"/v1/meshes/{name}").status == 200 for node in cluster.nodes[1:] for name in names)
    cluster.wait_until(NODES - 1)
    victim.daemon.stop()
    victim.start()
    cluster.wait_until(NODES)
    kept = sum(victim.daemon.get(f"/v1/meshes/{name}").status == 200 for name in names)
    fulfilled = outcomes[200] + outcomes[201]
    return [report("uploads to a node that is killed", "answered or refused, none lost, none made twice", f"{dict(outcomes)}; {kept} there, {elsewhere} elsewhere",
                   set(outcomes) <= {200, 201, 502, 503, 504} and kept + elsewhere >= fulfilled and kept + elsewhere <= len(names))]


# --- what hashing gains -------------------------------------------------------------------------


def hits(cluster_nodes):
    values = [sum(node.daemon.metric(name) for node in cluster_nodes) for name in ("cache_hits_total", "cache_misses_total")]
    return values


def hit_rate(short, replacements):
    """Returns the hit rate of nodes that can each hold only a part of all fields."""
    meshes = {f"h{i}": terrain(40, i) for i in range(9)}
    with contextlib.ExitStack() as stack:
        nodes = [Member("--store", "memory", "--landmarks", "0", "--memory-budget", BUDGET, "--max-body", "4MiB") for _ in range(NODES)]
        for node in nodes:
            stack.callback(node.kill)
        front = stack.enter_context(Front([node.port for node in nodes], replacements))
        for name, (file, _) in meshes.items():
            for node in nodes:
                assert node.daemon.put(name, file).status == 201
        paths = [f"/v1/meshes/{name}/distance-to-set" for name in meshes]
        connection = http.client.HTTPConnection("127.0.0.1", front.port, timeout=60)

        chance = random.Random(1)

        def ask(count):
            for _ in range(count):
                body = {"set": {"points": [{"vertex": chance.randrange(6)}]}, "points": [{"vertex": 300}]}
                connection.request("POST", chance.choice(paths), json.dumps(body), POST)
                answer = connection.getresponse()
                assert answer.read() and answer.status == 200, answer.status

        ask(300)
        before = hits(nodes)
        ask(300 if short else 2000)
        gained = [after - first for after, first in zip(hits(nodes), before)]
    return gained[0] / max(1, sum(gained))


def gain_by_hashing(short):
    hashed, in_turn = hit_rate(short, []), hit_rate(short, [("balance hash path,field(4,/)", "balance roundrobin")])
    return [report("cache hits with hashing, and in turn", "a fifth of the misses", f"{hashed:.1%} against {in_turn:.1%}", 1 - hashed <= 0.2 * (1 - in_turn))]


def wrk(port, targets, place, seconds):
    """Returns the requests a second, by wrk."""
    script = pathlib.Path(place) / "targets.lua"
    lines = ",\n".join(f'wrk.format("GET", "{target}")' for target in targets)
    script.write_text(f"local requests, at\nfunction init() requests = {{{lines}}}; at = 0 end\nfunction request() at = at % #requests + 1; return requests[at] end\n")
    told = subprocess.run(["wrk", "-t1", "-c32", f"-d{seconds}s", "--latency", "-s", script, f"http://127.0.0.1:{port}"], check=True, capture_output=True, text=True).stdout
    return float(re.search(r"Requests/sec: *(\S+)", told)[1]), re.search(r"99% *(\S+)", told)[1]


def through_and_direct(cluster, place, seconds):
    if not shutil.which("wrk"):
        print("skip routing: throughput wants wrk")
        return []
    targets = cluster.questions.paths
    for _ in range(harness.SEARCHES + 1):  # builds all fields on every node
        for node in cluster.nodes:
            for target in targets:
                node.daemon.get(target)
    direct, through = wrk(cluster.nodes[0].port, targets, place, seconds), wrk(cluster.front.port, targets, place, seconds)
    return [report("cached paths a second: through HAProxy, of one node directly", "reported", f"{through[0]:.0f} (p99 {through[1]}) against {direct[0]:.0f} (p99 {direct[1]}), "
                   "all on this machine's processors", through[0] > 0)]


def know_the_contract():
    """Checks that requests that HAProxy may repeat have no lasting effect: no POST of a query
    creates something."""
    contract = yaml.safe_load((HERE.parent.parent / "proto/openapi.yaml").read_text())
    text = SHIPPED.read_text()
    listed = set(re.search(r"acl leaves_something path_end (.*)", text)[1].split())
    makers = {"/" + path.rpartition("/")[2] for path, operations in contract["paths"].items()
              if path.count("/") > 3 and {"201", "409"} & set(operations.get("post", {}).get("responses", {}))}
    return [report("queries that leave something behind are not repeated", "all that the contract has", f"{sorted(makers)}", makers == listed)]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--seconds", type=int, default=5, help="of each measurement of throughput")
    options = arguments.parse_args()
    if not shutil.which("haproxy"):
        print("skip routing: haproxy is not installed")
        return 0
    held = know_the_contract()
    with tempfile.TemporaryDirectory() as place, contextlib.ExitStack() as stack:
        cluster = Cluster(place, stack, options.short)
        for test in (share_and_stay, lose_a_node, restart_in_turn, find_jobs, spill_over, lose_uploads):
            held += test(cluster)
        held += through_and_direct(cluster, place, 1 if options.short else options.seconds)
    held += gain_by_hashing(options.short)
    return conclude("routing", held)


if __name__ == "__main__":
    sys.exit(main())
