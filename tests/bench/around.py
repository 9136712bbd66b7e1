#!/usr/bin/env python3
"""Measures the daemon's requests other than the build of a field: isolines, Voronoi diagrams,
gradients, files, farthest points, pictures, bulk pairs, matrices, uploads and loading.

usage: tests/bench/around.py [--build DIR] [--runs N] [--workers N] [--only WORD] [--random N]
                             [--kind WORD] [--quick] [--mesh "ARGUMENTS of gd_bench"] [--small "…"]
                             [--upload "…"]

Each row has the time of a request (least and median of the runs), the processor time of the daemon,
its page faults, the size of the answer, and the target. Targets are multiples of the field's time
in gd_bench. The answers are read, but not parsed. Each run uses new data where the daemon could
otherwise answer from its cache. --random N sends N random requests of all kinds
(tests/bench/random_requests.py), one after the other, and reports the slowest of each kind. --quick
measures small meshes, to check that this program works.
"""
import contextlib
import http.client
import json
import pathlib
import random
import statistics
import struct
import subprocess
import sys
import tempfile
import time

import random_requests
from common import SHARED, Checks, Failure, bench_arguments, find_program, machine, number, print_table, record, run_lines, show_progress, write_json
from throughput import START_SECONDS

JSON_TYPE = {"Content-Type": "application/json"}
BYTES_TYPE = {"Content-Type": "application/octet-stream"}
PAIRS = 1_000_000
EVALUATED = 10_000
SLOW_SECONDS = 2
IDLE_SECONDS, QUIET_SECONDS = 60, 1  # longest wait, and the time without work that counts as idle


def usage_of(process):
    """Returns the processor seconds of all threads, and the number of page faults."""
    folder = pathlib.Path(f"/proc/{process.pid}")
    tasks = (folder / "task").iterdir()
    seconds = sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) / 1e9
    return seconds, int((folder / "stat").read_text().rpartition(")")[2].split()[7])


class Daemon:
    """A running geodesicd with two workers, and its requests."""

    def __init__(self, options, folder, *more):
        self.log = pathlib.Path(folder) / "log"
        command = [find_program(options.build / "geodesicd"), "--listen", "127.0.0.1:0", "--landmarks", "0", "--memory-budget", "10GiB", "--timeout-ms", "600000",
                   "--workers", str(options.workers), *more]
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=log)
        self.connection = http.client.HTTPConnection("127.0.0.1", self._wait_for_port(), timeout=600)

    def _wait_for_port(self):
        until = time.monotonic() + START_SECONDS
        while time.monotonic() < until and self.process.poll() is None:
            for line in self.log.read_text().splitlines():
                if '"event":"listening"' in line:
                    return int(json.loads(line)["address"].rpartition(":")[2])
            time.sleep(0.02)
        self.stop()
        raise Failure(f"the daemon did not start: {self.log.read_text()[-300:]}")

    def stop(self):
        self.process.terminate()
        return self.process.wait(60)

    def send(self, method, target, body=None, headers=JSON_TYPE):
        """Returns the answer's status and text."""
        body = json.dumps(body) if isinstance(body, dict) else body
        self.connection.request(method, target, body, headers if body or headers is not JSON_TYPE else {})
        answer = self.connection.getresponse()
        return answer.status, answer.read()

    def ask(self, method, target, body=None, headers=JSON_TYPE):
        status, text = self.send(method, target, body, headers)
        if status >= 300:
            raise Failure(f"{method} {target}: {status} {text[:200]!r}")
        return text

    def wait_until_idle(self):
        """Waits for background work, for example the preview of a new mesh."""
        quiet, until = time.monotonic(), time.monotonic() + IDLE_SECONDS
        before = usage_of(self.process)[0]
        while time.monotonic() < min(quiet + QUIET_SECONDS, until):
            time.sleep(0.1)
            now = usage_of(self.process)[0]
            if now - before > 0.002:
                quiet, before = time.monotonic(), now
        self.connection.close()  # the next request opens it again

    def measure(self, *request):
        """Returns the measurements of one request."""
        seconds, faults = usage_of(self.process)
        begin = time.monotonic()
        size = len(self.ask(*request))
        wall = time.monotonic() - begin
        after = usage_of(self.process)
        return {"wall": wall, "cpu": after[0] - seconds, "faults": after[1] - faults, "bytes": size}


@contextlib.contextmanager
def running(options, folder, *more):
    daemon = Daemon(options, folder, *more)
    try:
        yield daemon
    finally:
        daemon.stop()


class Table:
    """Measures rows and prints them."""

    def __init__(self, options):
        self.options, self.rows = options, []

    def wants(self, name):
        return self.options.only in name

    def add(self, name, target, run):
        """Measures `run`, which takes the number of the run, and returns measurements."""
        if not self.wants(name):
            return
        show_progress(name)
        runs = [run(i) for i in range(self.options.runs)]
        least = min(runs, key=lambda one: one["wall"])
        self.rows.append({"name": name, "target": target, "wall": least["wall"], "median": statistics.median(one["wall"] for one in runs),
                          "cpu": min(one["cpu"] for one in runs), "faults": round(statistics.median(one["faults"] for one in runs)),
                          "bytes": least["bytes"]})

    def print(self):
        show_progress("")
        print_table(["request", "wall s", "median s", "cpu s", "faults", "bytes", "target s", "wall / target"],
                    [[row["name"], *(f"{row[key]:.3f}" for key in ("wall", "median", "cpu")), number(row["faults"]), number(row["bytes"]),
                      f"{row['target']:.3f}" if row["target"] else "-", f"{row['wall'] / row['target']:.2f}" if row["target"] else "-"]
                     for row in self.rows])


# --- the requests -------------------------------------------------------------------------------


def export(options, mesh):
    """Returns the mesh as OBJ."""
    return subprocess.run([find_program(options.build / "gd_bench"), "export", *mesh.split()], check=True, stdout=subprocess.PIPE).stdout


def field_seconds(options, mesh):
    """Returns the engine's time of a field."""
    return run_lines([options.build / "gd_bench", "field", "--runs", 5, *mesh.split()], 300)[0]["field_ms"] / 1e3


def container(arrays):
    """Returns an arrays container of (name, type, columns, bytes)."""
    sizes = {1: 8, 2: 4, 3: 4}
    at = 16 + 64 * len(arrays)
    head = [b"GDARRAYS", struct.pack("<II", 1, len(arrays))]
    body = []
    for name, kind, columns, data in arrays:
        rows = len(data) // sizes[kind] // max(1, columns)
        head.append(struct.pack("<32sIIQQQ", name.encode(), kind, columns, rows, at, len(data)))
        data += bytes(-len(data) % 8)
        body.append(data)
        at += len(data)
    return b"".join(head + body)


def pairs_bodies(source, faces, count):
    """Returns the bodies of a request for distances from a vertex to points in faces: an arrays
    container, and JSON."""
    draw = random.Random(3)
    numbers, indices, points = [], [], []
    for _ in range(count):
        u, v = sorted((draw.randrange(1, 1000), draw.randrange(1, 1000)))
        place = u / 1000, (v - u) / 1000, (1000 - v) / 1000
        indices.append(draw.randrange(faces))
        numbers += place
        points.append({"face": indices[-1], "barycentric": place})
    binary = container([("from", 3, 0, struct.pack("<I", source)), ("to_face", 3, 0, struct.pack(f"<{count}I", *indices)),
                        ("to_barycentric", 1, 3, struct.pack(f"<{len(numbers)}d", *numbers))])
    return binary, json.dumps({"from": [{"vertex": source}], "to": points}).encode()


class Field:
    """A field of a mesh named `name` that the daemon keeps."""

    def __init__(self, daemon, name, source):
        answer = json.loads(daemon.ask("POST", f"/v1/meshes/{name}/fields", {"set": {"points": [{"vertex": source}]}}))
        self.id, self.maximum = answer["id"], answer.get("max_distance") or answer.get("maximum")
        self.path = f"/v1/meshes/{name}/fields/{self.id}"


def measure_new_fields(table, daemon, name, vertices, target):
    """Measures fields that are built and then deleted, as in gd_bench."""
    draw = random.Random(2)

    def run(_):
        body = json.dumps({"set": {"points": [{"vertex": draw.randrange(vertices)}]}})
        result = daemon.measure("POST", f"/v1/meshes/{name}/fields", body)
        identity = json.loads(daemon.ask("POST", f"/v1/meshes/{name}/fields", body))["id"]
        daemon.ask("DELETE", f"/v1/meshes/{name}/fields/{identity}")
        return result

    def run_kept(_):
        return daemon.measure("POST", f"/v1/meshes/{name}/fields", {"set": {"points": [{"vertex": draw.randrange(vertices)}]}})

    table.add(f"field, {name}, deleted", 1.25 * target, run)
    table.add(f"field, {name}, kept", 1.25 * target, run_kept)


def measure_field(table, daemon, described, field_s):
    """Measures the requests that use a cached field of the mesh named `large`."""
    faces, vertices = described["faces"], described["vertices"]
    field = Field(daemon, "large", 0)
    draw = random.Random(4)

    def get(target):
        return lambda _: daemon.measure("GET", target)

    def points(count):
        return [{"vertex": draw.randrange(vertices)} for _ in range(count)]

    table.add("isolines, 10", 0.4, get(f"{field.path}/isolines?count=10"))
    for form in ("f64", "glb"):
        table.add(f"isolines, 10, {form}", field_s, get(f"{field.path}/isolines?count=10&format={form}"))
    binary, text = pairs_bodies(0, faces, 1000 if table.options.quick else PAIRS)
    table.add("pairs, 1M, f64", None, lambda _: daemon.measure("POST", "/v1/meshes/large/pairs?format=f64", binary, BYTES_TYPE))
    table.add("pairs, 1M, json", None, lambda _: daemon.measure("POST", "/v1/meshes/large/pairs", text))
    body = json.dumps({"points": points(EVALUATED), "gradient": True})
    table.add("gradient, 10,000 points", field_s, lambda _: daemon.measure("POST", f"{field.path}/evaluate", body))
    for form in ("json", "float64", "ply", "glb", "csv", "npy"):
        how = {"json": "", "float64": ""}.get(form, f"?format={form}")
        headers = {"Accept": "application/octet-stream"} if form == "float64" else {}
        table.add(f"values, {form}", field_s, lambda _, how=how, headers=headers: daemon.measure("GET", f"{field.path}/values{how}", None, headers))
    for form in ("obj", "ply", "glb", "stl"):
        table.add(f"content, {form}", field_s, get(f"/v1/meshes/large/content?format={form}"))
    table.add("picture of the field", field_s, get(f"/v1/meshes/large/picture.png?field={field.id}"))
    table.add("picture of the mesh", field_s, get("/v1/meshes/large/picture.png"))
    table.add("picture, svg", field_s, get(f"/v1/meshes/large/picture.svg?field={field.id}"))
    sets = points(3)
    body = json.dumps({"set": {"points": sets}})
    if table.wants("voronoi, 3, cached"):
        daemon.ask("POST", "/v1/meshes/large/voronoi", body)
    table.add("voronoi, 3, cached", field_s, lambda _: daemon.measure("POST", "/v1/meshes/large/voronoi", body))
    table.add("voronoi, 3, new", 2 * field_s, lambda _: daemon.measure("POST", "/v1/meshes/large/voronoi", {"set": {"points": points(3)}}))
    table.add("farthest points, 5", 5 * field_s,
              lambda _: daemon.measure("POST", "/v1/meshes/large/farthest-points", {"count": 5, "start": points(1)[0]}))


def measure_matrix(table, daemon, vertices, field_s):
    draw = random.Random(5)
    count = 20 if table.options.quick else 200

    def points():
        return [{"vertex": draw.randrange(vertices)} for _ in range(count)]

    table.add(f"matrix, {count}x{count}", count * field_s / table.options.workers,
              lambda _: daemon.measure("POST", "/v1/meshes/small/matrix?format=f64", {"sources": points(), "targets": points()}))


def measure_store(table, folder, text):
    """Measures uploads into a store on disk, and the first request for a mesh after a restart."""
    store = pathlib.Path(folder) / "store"
    options = table.options
    if table.wants("upload"):
        with running(options, folder, "--data-dir", str(store)) as daemon:
            def upload(i):
                daemon.ask("PUT", "/v1/meshes/other", f"v 0 0 {i}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode(), BYTES_TYPE)
                return daemon.measure("PUT", f"/v1/meshes/upload{i}", text + f"# {i}\n".encode(), BYTES_TYPE)
            table.add("upload, OBJ", 1.0, upload)

    def load(_):
        with running(options, folder, "--data-dir", str(store)) as daemon:
            return daemon.measure("GET", "/v1/meshes/upload0/nearest?point=p:0,0,0")
    if table.wants("load"):
        if not table.wants("upload"):
            with running(options, folder, "--data-dir", str(store)) as daemon:
                daemon.ask("PUT", "/v1/meshes/upload0", text, BYTES_TYPE)
        table.add("load from the store", 0.6, load)


# --- random requests ----------------------------------------------------------------------------


def finished(daemon, target):
    """Waits for the end of a job or batch. Returns its target."""
    while json.loads(daemon.ask("GET", target))["state"] in ("queued", "running"):
        time.sleep(0.02)
    return target


def send_random(daemon, request):
    """Returns the seconds of a request, its processor seconds, its status, and an error's text. For
    a job, the processor seconds include all work until the job ends."""
    before, begin = usage_of(daemon.process)[0], time.monotonic()
    status, text = daemon.send(*request)
    seconds = time.monotonic() - begin
    if "Prefer" in request[-1]:
        status, text = daemon.send("GET", finished(daemon, "/v1/jobs/" + json.loads(text)["id"]) + "/result")
        status = f"job {status}"
    text = "" if str(status).endswith(("200", "201", "202")) else text[:120].decode(errors="replace")
    return seconds, usage_of(daemon.process)[0] - before, status, text


def random_kinds(options, daemon, described):
    """Returns the functions that make random requests, by kind."""
    random_requests.prepare(daemon, options.quick)
    body = {"query": "all-pairs", "mesh": "small", "vertices": [0, 1, 2]}
    batch = finished(daemon, "/v1/batches/" + json.loads(daemon.ask("POST", "/v1/batches", body))["id"])
    body, headers = {"from": {"vertex": 0}, "to": {"vertex": 1}}, {**JSON_TYPE, "Prefer": "respond-async"}
    job = finished(daemon, "/v1/jobs/" + json.loads(daemon.ask("POST", "/v1/meshes/large/path", body, headers))["id"])
    return random_requests.kinds(random_requests.Draw(6, described), Field(daemon, "large", 0).path, job, batch)


def measure_random(options, daemon, described):
    """Sends random requests: at first each kind once. Prints the slowest of each kind."""
    draw = random.Random(6)
    daemon.connection.close()  # the daemon may have closed it while bodies were prepared
    kinds = {name: make for name, make in random_kinds(options, daemon, described).items() if options.kind in name}
    if not options.kind and (missing := random_requests.missing(kinds)):
        raise Failure(f"no random request has the operation {missing[0]}")
    names = [*kinds, *draw.choices(list(kinds), k=max(0, options.random - len(kinds)))]
    draw.shuffle(names)
    measured = {name: [] for name in kinds}
    for i, name in enumerate(names):
        show_progress(f"random request {i + 1} of {len(names)}: {name}")
        measured[name].append(send_random(daemon, kinds[name]()))
    show_progress("")
    print_random(measured)


def print_random(measured):
    """Prints a row for each kind, beginning with the kind that took the most processor time."""
    rows = []
    for name, those in sorted(measured.items(), key=lambda item: -max(one[1] for one in item[1])):
        seconds, cpu, statuses, texts = zip(*those)
        rows.append([name, str(len(those)), *(f"{value:.3f}" for times in (seconds, cpu) for value in (statistics.median(times), max(times))),
                     str(sum(one > SLOW_SECONDS for one in seconds)), " ".join(f"{status} {text}".strip() for status, text in dict(zip(statuses, texts)).items())])
    print_table(["random requests", "count", "median s", "most s", "cpu median s", "cpu most s", "over 2 s", "statuses"], rows)


# --- all of it ----------------------------------------------------------------------------------


def read_options():
    arguments = bench_arguments("requests")
    arguments.add_argument("--runs", type=int, default=5)
    arguments.add_argument("--workers", type=int, default=2)
    arguments.add_argument("--random", type=int, default=0)
    arguments.add_argument("--kind", default="", help="only random requests whose kind has this in it")
    bunny = SHARED / "stanford-bunny.obj"
    arguments.add_argument("--mesh", default=f"--subdivide 2 {bunny}", help="the large mesh: 1.1 million faces")
    arguments.add_argument("--small", default=str(bunny), help="for fields and the matrix")
    arguments.add_argument("--upload", default="--noise 0.2 sample:icosphere,level=8", help="the mesh that is uploaded and loaded")
    return arguments.parse_args()


def measure(options, folder):
    meshes = {"small": options.small, "large": options.mesh}
    seconds = {name: field_seconds(options, mesh) for name, mesh in meshes.items()}
    # before the daemon starts, because it closes idle connections
    texts = {name: export(options, mesh) for name, mesh in meshes.items()}
    table = Table(options)
    print("fields in gd_bench:", ", ".join(f"{name} {one:.3f} s" for name, one in seconds.items()))
    with running(options, folder, "--store", "memory") as daemon:
        described = {name: json.loads(daemon.ask("PUT", f"/v1/meshes/{name}", text, BYTES_TYPE))
                     for name, text in texts.items()}
        daemon.wait_until_idle()
        for name in meshes:
            measure_new_fields(table, daemon, name, described[name]["vertices"], seconds[name])
        measure_matrix(table, daemon, described["small"]["vertices"], seconds["small"])
        measure_field(table, daemon, described["large"], seconds["large"])
        if options.random:
            measure_random(options, daemon, described["large"])
    if table.wants("upload") or table.wants("load"):
        measure_store(table, folder, export(options, options.upload))
    table.print()
    return table.rows


def main():
    options = read_options()
    if options.quick:
        options.runs, options.small, options.mesh, options.upload = 1, "sample:torus", "sample:terrain,cells=20", "sample:icosphere,level=2"
        options.random = options.random or 60
    before = machine()
    with tempfile.TemporaryDirectory(prefix="geodesicd-bench.") as folder:
        if options.quick:
            checks = Checks()
            checks.check("around: every request is answered", lambda: measure(options, folder))
            return checks.status
        rows = measure(options, folder)
    path = options.build / "bench-around.json"
    write_json(path, {"machine": before, "rows": rows})
    print(f"written: {path}; load {before['load'][0]:.1f} at the start, {machine()['load'][0]:.1f} at the end")
    if options.record:
        record("http", before)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        sys.exit(f"{failure}")
