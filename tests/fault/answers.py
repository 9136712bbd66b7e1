#!/usr/bin/env python3
"""Tests answers in memory. Clients request large answers of every kind and do not read them. Other
clients request many lists simultaneously. Resident memory stays within the budget plus 10 % and 64
MiB. /livez and small queries are always answered. Each large answer is accepted or refused with
507, and unread answers are released.

    tests/fault/answers.py [--budget MIB] [--clients N] [--only KIND] [--short]

--short: a small budget, small surfaces, and no bound on /livez, which a busy machine could spoil.
"""
import argparse
import contextlib
import json
import socket
import struct
import sys
import tempfile
import threading
import time

import mix
import process
from common import GONE, Daemon
from figures import conclude, quantile, report
from harness import sample, wait_until

MIB = 1 << 20
SLACK = 64 * MIB
LISTS = 20
LIVEZ_MS = 50
CUT_SECONDS = 45  # the timeout of 30 seconds in libmicrohttpd, and a margin
# kinds of requests that --short omits, because they take long while other tests run
LONG = ("spline", "picture", "voronoi", "evaluate", "exp", "queries", "derived file", "preview", "limit trace", "figure", "cut locus",
        "moving object")
JSON = {"Content-Type": "application/json"}
FLAGS = ("--max-body", "16MiB", "--workers", "2", "--http-threads", "2", "--landmarks", "0")


def loose_triangles(count):
    """Returns a binary STL file of triangles that do not touch each other. Each triangle therefore
    has its own boundary loop."""
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, 2 * i, 0, 0, 2 * i + 1, 0, 0, 2 * i, 1, 0, 0) for i in range(count))
    return b"\0" * 80 + struct.pack("<I", count) + triangles


class Watch(threading.Thread):
    """Measures the largest resident memory, and how long /livez takes, until it is stopped."""

    def __init__(self, daemon):
        super().__init__()
        self.target_daemon, self.most, self.seconds, self.failures, self.stopped = daemon, 0, [], 0, threading.Event()

    def run(self):
        while not self.stopped.wait(0.01):
            self.most = max(self.most, process.resident(self.target_daemon))
            began = time.monotonic()
            try:
                if self.target_daemon.get("/livez").status != 200:
                    self.failures += 1
            except GONE:
                self.failures += 1
            self.seconds.append(time.monotonic() - began)


@contextlib.contextmanager
def watched(daemon):
    watch = Watch(daemon)
    watch.start()
    try:
        yield watch
    finally:
        watch.stopped.set()
        watch.join()


def ask_unread(daemon, request):
    """Sends the request; returns the connection. The kernel buffers little of the answer."""
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.settimeout(60)
    connection.connect(("127.0.0.1", daemon.port))
    try:
        connection.sendall(mix.encode(request))
    # the daemon refused the request before it read the body
    except (BrokenPipeError, ConnectionResetError):
        connection.close()
    return connection


def await_answers(daemon):
    """Waits until no request waits for a worker or runs."""
    calm = 0
    while calm < 3:
        calm = 0 if daemon.metric("requests_deferred") else calm + 1
        time.sleep(0.05)


def status_of(connection):
    if connection.fileno() < 0:
        return "507"
    with contextlib.suppress(OSError):
        return connection.recv(12).decode().rpartition(" ")[2]
    return "cut"


def ask_small(daemon):
    """Sends queries as another client. Returns the number of queries that get no answer."""
    asked = [daemon.get("/v1/meshes/ring/distance?from=v:0&to=v:500"), daemon.get("/v1/meshes/ring/path?from=v:3&to=v:77"),
             daemon.ask("ring", "matrix", {"sources": in_ring(4), "targets": in_ring(4)})]
    return sum(answer.status != 200 for answer in asked)


def held_by_answers(daemon):
    return process.metrics(daemon).get('memory_bytes{class="answers"}', 0)


class Trial:
    """A daemon and the measurements of it."""

    def __init__(self, daemon, budget, options):
        self.daemon, self.budget, self.options, self.held = daemon, budget, options, []
        self.empty = process.resident(daemon)

    def judge(self, kind, watch, note, is_clean=True):
        grown, bound = watch.most - self.empty, 1.1 * self.budget + SLACK
        p99 = 1000 * quantile(watch.seconds, 0.99)
        asked = f"{bound / MIB:.0f} MiB; /livez " + ("never fails" if self.options.short else f"p99 <= {LIVEZ_MS} ms")
        is_served = not watch.failures and (self.options.short or p99 <= LIVEZ_MS)
        self.held.append(report(f"memory: {kind}", asked, f"{grown / MIB:.0f} MiB of a budget of {self.budget / MIB:.0f}; /livez p99 {p99:.1f} ms of "
                                f"{len(watch.seconds)}, {watch.failures} failed; {note}", grown <= bound and is_served and is_clean))

    def let_go(self, connections):
        for connection in connections:
            connection.close()
        wait_until(lambda: held_by_answers(self.daemon) < MIB)

    def unread(self, kind, request):
        with watched(self.daemon) as watch:
            connections = [ask_unread(self.daemon, request) for _ in range(self.options.clients)]
            await_answers(self.daemon)
            held, streams = held_by_answers(self.daemon), self.daemon.metric("answer_streams")
            failed = ask_small(self.daemon)
            time.sleep(self.options.dwell)
            statuses = [status_of(connection) for connection in connections]
            self.let_go(connections)
            time.sleep(self.options.dwell)
        counts = ", ".join(f"{statuses.count(status)} x {status}" for status in sorted(set(statuses)))
        self.judge(f"{len(connections)} unread answers of {kind}", watch,
                   f"{counts}; {held / MIB:.0f} MiB of answers, {streams:.0f} streams; {failed} small queries failed",
                   set(statuses) <= {"200", "507"} and not failed)


# --- requests ----------------------------------------------------------------------------------


def post(kind, path, document):
    return mix.Request(kind, "POST", f"/v1/{path}", json.dumps(document).encode(), JSON)


def get(kind, path, **headers):
    return mix.Request(kind, "GET", f"/v1/{path}", None, headers)


def in_ring(count):
    """Returns vertices around the small torus, so that a curve through them closes."""
    return [{"vertex": i} for i in range(0, 48, 48 // count)]


def requests(daemon, size):
    """Returns requests whose answers have about `size` bytes, or fewer if their kind does not allow
    so many."""
    points = size // 60
    rows = int((size / 19) ** 0.5)
    those = [{"vertex": i % 24} for i in range(rows)]  # few different points need few fields
    fine = daemon.ask("fine", "fields", {"set": {"points": [{"vertex": 0}, {"vertex": 700}]}}).json["id"]
    yield post("trace", "meshes/ring/trace", {"start": {"vertex": 0}, "fan": 8, "length": 1e6, "step_limit": min(100000, points // 8)})
    yield post("curve", "meshes/ring/curve", {"curve": {"points": in_ring(4), "closed": True}, "operation": "resample", "count": min(100000, points // 8)})
    yield post("spline", "meshes/ring/spline", {"points": in_ring(24), "samples": min(1000, points // 40), "frames": True})
    yield post("matrix", "meshes/ring/matrix", {"sources": those, "targets": those})
    yield get("isolines", f"meshes/fine/fields/{fine}/isolines?count={max(1, min(500, size // 200000))}")
    yield get("values", f"meshes/fine/fields/{fine}/values")
    yield get("values", f"meshes/fine/fields/{fine}/values", Accept="application/octet-stream")
    yield get("values", f"meshes/fine/fields/{fine}/values", **{"Accept-Encoding": "gzip"})
    yield get("values", f"meshes/fine/fields/{fine}/values?format=ply")
    yield post("voronoi", "meshes/fine/voronoi", {"set": {"points": [{"vertex": 97 * i} for i in range(20)]}})
    yield get("wedges", f"meshes/fine/fields/{fine}/wedges?edge=0-1")
    yield get("picture", f"meshes/fine/picture.png?source=v:0&size=800x800")
    yield get("picture", f"meshes/fine/picture.svg?source=v:0&size=800x800")
    for name in ("obj", "ply", "gltf"):
        yield get("content", f"meshes/fine/content?format={name}")
    yield from more_requests(daemon, size, fine)
    yield from figure_requests(points)


def more_requests(daemon, size, field):
    """Returns requests for lists of points, for arrays in binary form, and about other surfaces."""
    many = [{"vertex": i % 1000} for i in range(min(100000, size // 100))]
    vectors = [{"direction": {"angle": 0.1 * i}, "length": 30} for i in range(size // 40000)]
    places = [{"face": i % 6, "uv": [0.25, i / 10000]} for i in range(min(10000, size // 400))]
    yield post("pairs", "meshes/ring/pairs", {"from": [{"vertex": 0}], "to": many})
    yield post("pairs", "meshes/ring/pairs?format=npz", {"from": [{"vertex": 0}], "to": many})
    yield post("nearest-points", "meshes/ring/nearest-points", {"points": many})
    yield post("evaluate", f"meshes/fine/fields/{field}/evaluate?geometry=full", {"points": many[: size // 20000], "gradient": True, "path": True})
    yield post("exp", "meshes/ring/exp", {"start": {"vertex": 0}, "vectors": vectors})
    yield post("log", "meshes/ring/log", {"from": {"vertex": 0}, "to": "all"})
    lines = b"".join(json.dumps({"query": "path", "from": {"vertex": 0}, "to": point}).encode() + b"\n" for point in many[:1000])
    yield mix.Request("queries", "POST", "/v1/meshes/ring/queries?geometry=full", lines, {"Content-Type": "application/x-ndjson"})
    yield post("derived file", "meshes/fine/derive", {"format": "obj", "operations": [{"operation": "components", "keep": 1}]})
    wait_until(lambda: daemon.get("/v1/meshes/fine/preview?faces=20000&format=ply").status == 200)
    yield get("preview", "meshes/fine/preview?faces=20000&format=ply")
    daemon.ask("fine", "derive", {"mesh": "derived", "operations": [{"operation": "components", "keep": 1}]})
    yield get("origins", "meshes/derived/origins")
    yield get("origins", "meshes/derived/origins?format=npy")
    for surface in mix.surfaces(4, 1, 4):
        if surface.collection != "meshes":
            daemon.request("PUT", f"/v1/{surface.collection}/{surface.name}", surface.body)
    yield post("limit evaluate", "subdivisions/cube/evaluate", {"points": places})
    yield post("limit trace", "subdivisions/cube/trace", {"start": places[0], "fan": 60, "length": 100, "level": 5})
    yield post("NURBS evaluate", "nurbs/donut/evaluate", {"uv": [[i / 10000, 0.5] for i in range(len(places))]})


def figure_requests(points):
    """Returns requests for figures, cut loci and the file of a spline."""
    shared = {"points": [{"vertex": 97 * i} for i in range(20)]}
    layers = [{"field": shared}, {"isolines": {"count": 40}}, {"voronoi": {"set": shared}}, {"cut_locus": {"set": {"points": [{"vertex": 0}]}}}]
    for name in ("png", "svg", "glb"):
        yield post("figure", f"meshes/fine/picture?format={name}", {"layers": layers, "width": 800, "height": 800})
    traces = [{"trace": {"start": {"face": 0, "uv": [0.25, 0.5]}, "fan": 60, "length": 20}}]
    field = [{"field": {"points": [{"face": 0, "uv": [0.25, 0.5]}]}}, {"isolines": {"count": 40}}, {"control_net": {}}]
    yield post("figure", "subdivisions/cube/picture?format=svg", {"layers": traces + field})
    square = [{"xyz": [x, y, 0], "max_snap": 9} for x, y in ((0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8))]
    yield post("figure", "meshes/fine/picture?format=svg", {"layers": [{"cut": {"curve": {"points": square, "closed": True}}}]})
    yield post("figure", "nurbs/donut/picture?format=svg", {"layers": [{"isoparametric": {"u": 200, "v": 200}}]})
    yield post("cut locus", "meshes/fine/cut-locus", {"set": {"points": [{"vertex": 0}]}})
    yield post("cut locus", "meshes/fine/cut-locus?format=glb", {"set": {"points": [{"vertex": 0}]}})
    yield post("moving object", "meshes/ring/spline?format=glb", {"points": in_ring(24), "samples": min(1000, points // 40), "frames": True})


def try_answers(trial, cells):
    daemon = trial.daemon
    daemon.put("fine", sample("terrain", cells=cells, amplitude=1))
    for request in requests(daemon, trial.budget // 6):
        is_left_out = trial.options.short and (request.kind in LONG or "gltf" in request.path or "octet-stream" in request.headers.get("Accept", ""))
        if trial.options.only in request.kind and not is_left_out:
            name = request.kind + (f" ({', '.join(request.headers.values())})" if request.method == "GET" and request.headers else "")
            trial.unread(name + (f" ({request.path.partition('format=')[2]})" if "format=" in request.path else ""), request)


def try_kept(trial):
    """Tests saved results of jobs, and pages of a batch's answers."""
    daemon = trial.daemon
    count = int((trial.budget / 24 / 19) ** 0.5)
    those = [{"vertex": i % 24} for i in range(count)]
    accepted = daemon.ask("ring", "matrix", {"sources": those, "targets": those}, {"Prefer": "respond-async"})
    job = daemon.ended(accepted)["id"]
    trial.unread("a job's result", get("jobs", f"jobs/{job}/result"))
    trial.unread("a job with its result", get("jobs", f"jobs/{job}"))
    begun = daemon.request("POST", "/v1/batches", json.dumps({"query": "all-pairs", "mesh": "ring", "vertices": list(range(400))}), JSON).json["id"]
    wait_until(lambda: daemon.get(f"/v1/batches/{begun}").json["state"] == "done")
    trial.unread("a batch's results", get("batches", f"batches/{begun}/results?limit=1000"))


def try_lists(trial, meshes, triangles):
    """Tests meshes with very many boundaries: their descriptions, simultaneous lists, and /livez
    while clients send requests continuously."""
    daemon, body = trial.daemon, loose_triangles(triangles)
    with watched(daemon) as watch:
        statuses = [daemon.put(f"loose{number}", body).status for number in range(meshes)]
    listed = len(daemon.get("/v1/meshes?limit=1000").json["meshes"])
    trial.judge(f"{meshes} uploads of {triangles} loose triangles", watch, f"{statuses.count(201)} taken; {listed} on the first page")
    trial.unread("lists", get("list", "meshes?limit=1000"))
    with watched(daemon) as watch:
        crowd = [threading.Thread(target=ask_often, args=(daemon, "/v1/meshes?limit=1000", trial.options.rounds)) for _ in range(LISTS)]
        for each in crowd:
            each.start()
        for each in crowd:
            each.join()
    trial.judge(f"{LISTS} clients that pipeline lists", watch, f"{trial.options.rounds} lists each")


def ask_often(daemon, path, count):
    """Sends all requests at once, then reads all answers."""
    with socket.create_connection(("127.0.0.1", daemon.port), timeout=60) as connection:
        asked = f"GET {path} HTTP/1.1\r\nHost: localhost\r\n"
        connection.sendall((f"{asked}\r\n" * (count - 1) + f"{asked}Connection: close\r\n\r\n").encode())
        while connection.recv(1 << 20):
            pass


def try_cut(trial, cells):
    """Checks that unread answers are released after a while, although the clients stay."""
    daemon = trial.daemon
    daemon.put("fine", sample("terrain", cells=cells, amplitude=1))
    connections = [ask_unread(daemon, get("content", "meshes/fine/content?format=obj")) for _ in range(trial.options.clients)]
    await_answers(daemon)
    began, held = time.monotonic(), held_by_answers(daemon)
    with contextlib.suppress(TimeoutError):
        wait_until(lambda: held_by_answers(daemon) < MIB, CUT_SECONDS)
    seconds = time.monotonic() - began
    trial.held.append(report("memory: answers that are not read", f"cut in {CUT_SECONDS} s", f"{held / MIB:.0f} MiB gone after {seconds:.0f} s", seconds < CUT_SECONDS))
    for connection in connections:
        connection.close()


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--budget", type=int, default=256)
    arguments.add_argument("--clients", type=int, default=30)
    arguments.add_argument("--rounds", type=int, default=50, help="lists of each client")
    arguments.add_argument("--dwell", type=float, default=2, help="seconds that answers stay unread, and that /livez is watched afterwards")
    arguments.add_argument("--only", default="")
    arguments.add_argument("--short", action="store_true")
    options = arguments.parse_args()
    if options.short:
        options.budget, options.rounds, options.dwell = 64, 3, 0
    budget, held = options.budget * MIB, []
    cells = 60 if options.short else 200
    trials = [(try_answers, cells), (try_kept,), (try_lists, *((40, 4000) if options.short else (300, 20000)))]
    trials += [] if options.short or options.only else [(try_cut, cells)]
    for attempt, *sizes in trials:
        if options.only and attempt is not try_answers and options.only not in attempt.__name__:
            continue
        with tempfile.TemporaryDirectory() as place, Daemon("--data-dir", place, "--memory-budget", str(budget), *FLAGS) as daemon:
            daemon.put("ring", sample("torus", columns=48, rows=24))
            trial = Trial(daemon, budget, options)
            attempt(trial, *sizes)
            held += trial.held
    return conclude("answers", held)


if __name__ == "__main__":
    sys.exit(main())
