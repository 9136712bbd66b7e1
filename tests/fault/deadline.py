#!/usr/bin/env python3
"""Tests deadlines. Sends expensive queries of every kind on large surfaces, each with a random
deadline that is mostly too short. The overrun is the time from the deadline to the answer. It is
measured by the daemon's log and by the client. An upload cannot name a deadline, so uploads go to
daemons with a short `--timeout-ms`.

    tests/fault/deadline.py [--count N] [--clients N] [--seed N] [--only KIND,KIND] [--short]

--short: small surfaces. The p99.9 of the overrun may be 1 s, because other tests may use the
processors.
"""
import argparse
import collections
import concurrent.futures
import json
import random
import sys
import time

import mix
from common import Daemon
from figures import conclude, quantile, report

KINDS = ["distance", "path", "matrix", "batch", "to_set", "field", "evaluate", "isolines", "values", "voronoi", "farthest", "curve_distance", "trace",
         "exp", "log", "transport", "mean", "spline", "curve", "cut", "content", "picture", "figure", "limit_evaluate", "limit_trace", "limit_path", "discretize",
         "nurbs_evaluate", "nurbs_geodesic", "nurbs_distance", "tessellate"]
LEAST_MS, MOST_MS = 1, 60
ASKED_MS, SHORT_MS = 50, 1000
FLAGS = ("--workers", "2", "--http-threads", "2", "--memory-budget", "1GiB", "--landmarks", "0")

Overrun = collections.namedtuple("Overrun", "kind status deadline_ms daemon_ms client_ms")


class Expensive(mix.Mix):
    """The requests of mix.Mix with larger parameters."""

    def matrix(self, mesh):
        return self.ask("matrix", mesh, "matrix", sources=self.points(mesh, 10), targets=self.points(mesh, 100))

    def evaluate(self, _):
        return self.of_field("evaluate", lambda path: self.post("evaluate", f"{path}/evaluate", {
            "points": self.points(path.split("/")[1], 1000), "gradient": True, "path": True}))

    def isolines(self, _):
        return self.of_field("isolines", lambda path: self.get("isolines", f"{path}/isolines?count=100&arcs=true"))

    def picture(self, mesh):
        return self.get("picture", f"meshes/{mesh}/picture.png?source=v:{self.chance.randint(0, 9)}&isolines=100&size=3840x2160")

    def figure(self, mesh):
        points = self.points(mesh, 3)
        layers = [{"trace": {"start": points[0], "fan": 500, "length": 20}}, {"field": {"points": points}}, {"isolines": {"count": 100}}]
        return self.ask("figure", mesh, "picture", layers=layers, width=3840, height=2160)

    def voronoi(self, mesh):
        return self.ask("voronoi", mesh, "voronoi", set={"points": self.points(mesh, 6), "curves": [{"points": self.points(mesh, 3)}]})

    def farthest(self, mesh):
        return self.ask("farthest", mesh, "farthest-points", count=20)

    def trace(self, mesh):
        return self.ask("trace", mesh, "trace", start=self.point(mesh), fan=500, length=50)

    def exp(self, mesh):
        return self.ask("exp", mesh, "exp", start=self.point(mesh), vectors=[{"direction": self.direction(), "length": 20} for _ in range(300)])

    def log(self, mesh):
        return self.ask("log", mesh, "log", **{"from": self.point(mesh), "to": "all"})

    def transport(self, mesh):
        return self.ask("transport", mesh, "transport", **{"from": self.point(mesh), "to": self.point(mesh),
                                                           "vectors": [{"direction": self.direction(), "length": 1} for _ in range(300)]})

    def mean(self, mesh):
        return self.ask("mean", mesh, "mean", points=self.points(mesh, 6))

    def spline(self, mesh):
        return self.ask("spline", mesh, "spline", points=self.points(mesh, 10), samples=200, frames=True)

    def curve(self, mesh):
        operation = self.chance.choice(({"operation": "resample", "count": 2000}, {"operation": "shorten"}, {"operation": "shorten", "rounds": 200},
                                        {"operation": "offset", "distance": 0.1}))
        return self.ask("curve", mesh, "curve", curve={"points": self.points(mesh, 6), "closed": self.chance.random() < 0.5}, **operation)

    def cut(self, mesh):
        return self.ask("cut", mesh, "cut", curve={"points": self.points(mesh, 3), "closed": True}, select_only=True)

    def limit_evaluate(self, _):
        return self.post("limit_evaluate", "subdivisions/cube/evaluate", {"points": [self.place() for _ in range(5000)]})

    def limit_trace(self, _):
        return self.post("limit_trace", "subdivisions/cube/trace", {"start": self.place(), "fan": 100, "length": 30, "smooth": self.chance.random() < 0.5})

    def limit_path(self, _):
        return self.post("limit_path", "subdivisions/cube/path", {"from": self.place(), "to": self.place(), "level": 6})

    def discretize(self, _):
        return self.post("discretize", "subdivisions/cube/discretize", {"mesh": "limit", "level": self.chance.randint(5, 7)})

    def nurbs_evaluate(self, _):
        return self.post("nurbs_evaluate", "nurbs/donut/evaluate", {"uv": [self.uv() for _ in range(5000)]})

    def nurbs_geodesic(self, _):
        return self.post("nurbs_geodesic", "nurbs/donut/geodesic", {"from": self.uv(), "to": self.uv(), "all_minima": True, "tolerance": 1e-9})

    def tessellate(self, _):
        count = self.chance.randint(100, 500)
        return self.post("tessellate", "nurbs/donut/tessellate", {"mesh": "tiles", "resolution": [count, count]})


def add_parameter(path, text):
    return f"{path}{'&' if '?' in path else '?'}{text}"


class Asker:
    """Sends requests one after the other, and records when the answers arrive."""

    def __init__(self, daemon, number, requests, kinds):
        self.daemon, self.number, self.requests, self.kinds = daemon, number, requests, kinds
        self.asked = {}  # request id: kind, status, deadline, client's milliseconds

    def run(self, count):
        connection = self.daemon.connect()
        for i in range(count):
            request = self.requests.next(self.kinds[i % len(self.kinds)])
            deadline = round(LEAST_MS * (MOST_MS / LEAST_MS) ** self.requests.chance.random())
            mark = f"deadline-{self.number}-{i}"
            path = request.path if request.kind == "content" else add_parameter(request.path, f"timeout_ms={deadline}")
            begun = time.monotonic()
            answer = self.daemon.request(request.method, path, request.body, {**request.headers, "X-Request-Id": mark}, connection)
            if request.kind != "content":
                self.asked[mark] = request.kind, answer.status, deadline, 1000 * (time.monotonic() - begun)
        connection.close()


def collect(daemon, askers):
    """Waits until the log has the last line, and returns the overruns."""
    asked = {mark: what for asker in askers for mark, what in asker.asked.items()}
    until = time.monotonic() + 10
    while True:
        logged = {line["request_id"]: line["ms"] for line in list(daemon.log) if line.get("event") == "request"}
        if asked.keys() <= logged.keys() or time.monotonic() > until:
            break
        time.sleep(0.05)
    return [Overrun(kind, status, deadline, max(0, logged[mark] - deadline), max(0, ms - deadline))
            for mark, (kind, status, deadline, ms) in asked.items()]


def ask_all(options, those, kinds):
    with Daemon(*FLAGS) as daemon:
        faces = mix.upload(daemon, those)
        askers = []
        for number in range(options.clients):
            requests = Expensive(random.Random(f"{options.seed} {number}"), those, faces)
            for mesh in faces:  # creates a field of each mesh for requests about fields
                request = requests.field(mesh)
                requests.learn(request, daemon.request(request.method, request.path, request.body, request.headers))
            askers.append(Asker(daemon, number, requests, kinds[number:] + kinds[:number]))
        with concurrent.futures.ThreadPoolExecutor(options.clients) as pool:
            list(pool.map(lambda asker: asker.run(options.count // options.clients), askers))
        return collect(daemon, askers)


def upload_all(options, those):
    """Measures uploads, which use the deadline of the server."""
    overruns = []
    for deadline in (2, 5, 10, 20, 40):
        with Daemon(*FLAGS, "--timeout-ms", str(deadline)) as daemon:
            asker = Asker(daemon, 0, None, None)
            for i in range(max(1, options.count // 100)):
                surface = those[i % len(those)]
                begun = time.monotonic()
                answer = daemon.request("PUT", f"/v1/{surface.collection}/m{i}", surface.body, {"X-Request-Id": f"upload-{i}"})
                asker.asked[f"upload-{i}"] = "upload", answer.status, deadline, 1000 * (time.monotonic() - begun)
            overruns += collect(daemon, [asker])
    return overruns


def large_all(options):
    """Measures the tessellation of a subdivision surface into three million triangles, with
    deadlines from 50 ms to 2 s. Some deadlines therefore pass in each long step of the
    tessellation."""
    with Daemon(*FLAGS, "--memory-budget", "4GiB", "--max-faces", "4000000") as daemon:
        daemon.request("PUT", "/v1/subdivisions/cube", mix.CUBE)
        asker = Asker(daemon, 0, None, None)
        body = json.dumps({"mesh": "fine", "level": 9})
        for i in range(max(1, options.count // 200)):
            deadline = 50 + 50 * (i % 40)
            begun = time.monotonic()
            answer = daemon.request("POST", f"/v1/subdivisions/cube/discretize?timeout_ms={deadline}", body,
                                    {"Content-Type": "application/json", "X-Request-Id": f"large-{i}"})
            asker.asked[f"large-{i}"] = "large", answer.status, deadline, 1000 * (time.monotonic() - begun)
        return collect(daemon, [asker])


def monotonous_all():
    """Measures uploads of 200 MiB of one character, which readers skip in one loop. The deadline of
    an upload begins when its body has arrived, so only the client's clock is used."""
    overruns, block = [], 1 << 20
    for deadline in (20, 200, 250, 300):
        with Daemon(*FLAGS, "--memory-budget", "4GiB", "--max-body", "256MiB", "--timeout-ms", str(deadline)) as daemon:
            for name in ("obj", "off", "ply", "stl", "json", "gltf"):
                for character in b" 1#":
                    connection = daemon.connect()
                    connection.putrequest("PUT", f"/v1/meshes/same?format={name}")
                    connection.putheader("Content-Length", str(200 * block))
                    connection.endheaders()
                    for _ in range(200):
                        connection.send(bytes([character]) * block)
                    begun = time.monotonic()
                    status = connection.getresponse().status
                    late = max(0, 1000 * (time.monotonic() - begun) - deadline)
                    overruns.append(Overrun("monotonous", status, deadline, late, late))
                    connection.close()
    return overruns


def print_kinds(overruns):
    kinds = collections.defaultdict(list)
    for overrun in overruns:
        kinds[overrun.kind].append(overrun)
    print(f"# {'kind':>15} {'requests':>9} {'late':>6} {'daemon p99':>11} {'daemon max':>11} {'client p99':>11} {'client max':>11}   ms")
    for kind, some in sorted(kinds.items(), key=lambda pair: -max(overrun.daemon_ms for overrun in pair[1])):
        late = sum(overrun.status == 504 for overrun in some)
        daemon, client = [overrun.daemon_ms for overrun in some], [overrun.client_ms for overrun in some]
        print(f"# {kind:>15} {len(some):9} {late:6} {quantile(daemon, 0.99):11.1f} {max(daemon):11.1f} {quantile(client, 0.99):11.1f} {max(client):11.1f}")


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--count", type=int, default=4000)
    arguments.add_argument("--clients", type=int, default=2)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--only", default="")
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    those = mix.surfaces(60, 4, 40) if options.short else mix.surfaces(200, 6, 150)
    kinds = [kind for kind in KINDS if not options.only or kind in options.only.split(",")]
    overruns = ask_all(options, those, kinds)
    if not options.only:
        overruns += upload_all(options, those)
        if not options.short:
            overruns += large_all(options) + monotonous_all()
    print_kinds(overruns)
    late = sum(overrun.status == 504 for overrun in overruns)
    asked = SHORT_MS if options.short else ASKED_MS
    held = []
    for clock in ("daemon", "client"):
        values = [getattr(overrun, f"{clock}_ms") for overrun in overruns]
        measured = quantile(values, 0.999)
        held.append(report(f"deadline overrun p99.9, the {clock}'s clock", f"<= {asked} ms",
                           f"{measured:.1f} ms, at most {max(values):.1f} ms, of {len(overruns)} requests, {late} of them late", measured <= asked))
    wrong = collections.Counter((overrun.kind, overrun.status) for overrun in overruns if overrun.status >= 500 and overrun.status != 504)
    held.append(report("deadlines: other failures", "0", f"{dict(wrong) or 0}", not wrong))
    return conclude("deadline", held)


if __name__ == "__main__":
    sys.exit(main())
