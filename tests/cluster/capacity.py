#!/usr/bin/env python3
"""Compares the capacity model of "Many machines" in server/doc/guide/operating.md with
measurements: predictions, measured values, and their differences.

    tests/cluster/capacity.py [--short] [--meshes N --faces F --active N --fields N --rate N --hits
    SHARE --memory GIB --cores N --price N]

With --meshes it only prints the model's number of nodes for the given values. Otherwise the part
that uses haproxy is skipped if that is missing.
"""
import argparse
import contextlib
import dataclasses
import json
import math
import shutil
import subprocess
import sys
import tempfile

from front import Front
from nodes import Member

import harness
import process
from figures import conclude, report

# The model's constants, which equal the constants in the guide.
MESH_BYTES = 340  # memory in bytes for each face
# bytes for each edge; a mesh has 3/2 edges for each face
FIELD_BYTES = {"terrain": 114, "scan": 295, "smooth": 645}
RECORD_BYTES = 1300  # bytes that every node holds for each stored mesh (server/doc/014)
# released fields are kept up to this share of the memory budget, and up to this number of bytes
SPARE_SHARE, SPARE_MOST = 16, 256 << 20
FULL = 0.9  # share of the budget at which eviction of fields begins
BUSY = 0.6  # waiting times grow if the load exceeds this share of the processors
GIB = 1 << 30


@dataclasses.dataclass
class Costs:
    """Processor seconds. `hit` is the cost of an answer from a cached field, including HAProxy's
    share. The other costs concern a mesh that is not in memory: loading one face, and a search."""
    hit: float = 40e-6
    load_face: float = 0.7e-6
    search: float = 3e-3


def usable(budget):
    return FULL * (budget - min(budget / SPARE_SHARE, SPARE_MOST))


def active_bytes(faces, fields, kind="scan"):
    """Returns the bytes of a used mesh with that many fields."""
    return faces * (MESH_BYTES + 1.5 * fields * FIELD_BYTES[kind])


def nodes(options, costs=Costs()):
    """Returns the number of nodes by memory and by processors, without the spare node."""
    room = usable(options.memory * GIB) - RECORD_BYTES * options.meshes
    by_memory = options.active * active_bytes(options.faces, options.fields) / room
    work = options.rate * (options.hits * costs.hit + (1 - options.hits) * (costs.load_face * options.faces + costs.search))
    return by_memory, work / (BUSY * options.cores)


def print_nodes(options):
    by_memory, by_processors = nodes(options)
    count = math.ceil(max(by_memory, by_processors)) + 1
    print(f"by memory {by_memory:.2f} nodes, by processors {by_processors:.3f}; with one to spare {count} nodes, {count * options.price:.0f} a month")
    return 0


# --- what is measured ---------------------------------------------------------------------------


def compare(what, predicted, measured, tolerance, unit=""):
    off = measured / predicted - 1
    asked = "reported" if tolerance == math.inf else f"within {tolerance:.0%}"
    return report(f"capacity: {what}", asked, f"predicted {predicted:.4g}{unit}, measured {measured:.4g}{unit} ({off:+.1%})", abs(off) <= tolerance)


def held(daemon, kind):
    return process.metrics(daemon)[f'memory_bytes{{class="{kind}"}}']


def ask_set(daemon, name, vertex):
    answer = daemon.ask(name, "distance-to-set", {"set": {"points": [{"vertex": vertex}]}, "points": [{"vertex": 5}]})
    assert answer.status == 200, answer


def bytes_of_meshes_and_fields(sizes):
    verdicts = []
    with harness.Daemon("--landmarks", "0") as daemon:
        for cells in sizes:
            before = held(daemon, "meshes")
            answer = daemon.put(f"t{cells}", harness.sample("terrain", cells=cells))
            faces = answer.json["faces"]
            verdicts.append(compare(f"bytes of a mesh of {faces} faces", MESH_BYTES * faces, held(daemon, "meshes") - before, 0.1))
            before = held(daemon, "fields")
            for vertex in range(4):
                ask_set(daemon, f"t{cells}", 37 * vertex)
            verdicts.append(compare(f"bytes of a field on it ({FIELD_BYTES['terrain']} an edge)", 1.5 * faces * FIELD_BYTES["terrain"],
                                    (held(daemon, "fields") - before) / 4, 0.25))
    return verdicts


def fields_that_stay(budget_mib):
    """Requests many more fields than the budget can hold. Returns the number of fields that stay
    cached."""
    cells, budget = 40, budget_mib << 20
    faces = 2 * cells * cells
    with harness.Daemon("--landmarks", "0", "--memory-budget", str(budget), "--max-body", "4MiB") as daemon:
        daemon.put("t", harness.sample("terrain", cells=cells))
        ask_set(daemon, "t", 0)
        field = held(daemon, "fields")
        for vertex in range(1, int(1.5 * budget / field)):
            ask_set(daemon, "t", vertex)
        stay = process.metrics(daemon)["cache_fields"]
    return [compare(f"fields that stay in a budget of {budget_mib} MiB", (usable(budget) - MESH_BYTES * faces) / field, stay, 0.15)]


def cost_of_a_miss(short):
    """Returns the processor time of loading a mesh that is not in memory, measured with meshes of
    another size. The short form only reports it, because processor time depends on what else the
    machine runs."""
    seconds = {}
    for cells in (60, 120) if short else (60, 120, 240):
        with tempfile.TemporaryDirectory() as place:
            file, times = harness.sample("terrain", cells=cells), 24
            with harness.Daemon("--data-dir", place, "--landmarks", "0") as daemon:
                for number in range(times):
                    daemon.put(f"t{number}", file)
            with harness.Daemon("--data-dir", place, "--landmarks", "0") as daemon:
                before = process.cpu_seconds(daemon)
                for number in range(times):
                    assert daemon.get(f"/v1/meshes/t{number}/distance?from=v:0&to=v:1").status == 200
                seconds[2 * cells * cells] = (process.cpu_seconds(daemon) - before) / times
    least, *others = seconds
    tolerance = math.inf if short else 0.5
    return [compare(f"processor time of loading {faces} faces, by that of {least}", seconds[least] * faces / least, seconds[faces], tolerance, " s")
            for faces in others]


class Meter:
    """Measures the processor seconds of programs between two readings."""

    def __init__(self, *programs):
        self.programs = programs
        self.before = [process.cpu_seconds(program) for program in programs]

    def spent(self):
        return [process.cpu_seconds(program) - before for program, before in zip(self.programs, self.before)]


def load(port, targets, place, connections, rate, seconds):
    """Returns the number of 2xx answers, by gd_load."""
    with open(f"{place}/requests", "wb") as file:
        for target in targets:
            text = f"GET {target} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
            file.write(b"%d\n" % len(text) + text)
    told = json.loads(subprocess.run([harness.PROGRAM.parent / "gd_load", str(port), f"{place}/requests", str(connections), str(rate), "0", str(seconds)],
                                     check=True, stdout=subprocess.PIPE).stdout)
    assert set(told["statuses"]) == {"200"}, told
    return told["fulfilled"]["count"]


def cost_of_a_hit(seconds, count=3):
    """Returns two figures for one node and for three nodes: the cost of an answer from memory at a
    hundredth of the load, and the rate when the machine is saturated."""
    if not shutil.which("haproxy") or not (harness.PROGRAM.parent / "gd_load").exists():
        print("skip capacity: processor time of answers wants haproxy and gd_load")
        return []
    with contextlib.ExitStack() as stack:
        place = stack.enter_context(tempfile.TemporaryDirectory())
        members = [Member("--store", "memory", "--landmarks", "0") for _ in range(count)]
        for member in members:
            stack.callback(member.kill)
        front = stack.enter_context(Front([member.port for member in members], [("balance hash path,field(4,/)", "balance roundrobin")]))
        targets = [f"/v1/meshes/t/distance?from=v:{vertex}&to=v:{40 * vertex + 7}" for vertex in range(1, 21)]
        for member in members:
            member.daemon.put("t", harness.sample("terrain", cells=40))
            for target in targets:
                for _ in range(harness.SEARCHES + 1):
                    member.daemon.get(target)
        cost = {}
        for name, rate in (("light", 1000), ("full", 0)):
            meter = Meter(*(member.daemon for member in members), front)
            answers = load(front.port, targets, place, 32, rate, seconds)
            *of_nodes, of_front = meter.spent()
            cost[name] = (sum(of_nodes) / answers, of_front / answers, answers / seconds)
    light, full = cost["light"], cost["full"]
    return [report("capacity: processor time of a cached distance: nodes, HAProxy", f"reported; the model has {1e6 * Costs().hit:.0f} us",
                   f"{1e6 * light[0]:.0f} + {1e6 * light[1]:.0f} us at {light[2]:.0f}/s, "
                   f"{1e6 * full[0]:.0f} + {1e6 * full[1]:.0f} us at {full[2]:.0f}/s", True)]


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--meshes", type=float)
    for name, standard in (("faces", 20000), ("active", 10000), ("fields", 4), ("rate", 1000), ("hits", 0.99), ("memory", 60), ("cores", 8), ("price", 200)):
        arguments.add_argument(f"--{name}", type=float, default=standard)
    options = arguments.parse_args()
    if options.meshes:
        return print_nodes(options)
    verdicts = bytes_of_meshes_and_fields((40, 80) if options.short else (40, 80, 160, 320))
    verdicts += fields_that_stay(64 if options.short else 256)
    verdicts += cost_of_a_miss(options.short)
    verdicts += cost_of_a_hit(2 if options.short else 6)
    return conclude("capacity", verdicts)


if __name__ == "__main__":
    sys.exit(main())
