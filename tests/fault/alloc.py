#!/usr/bin/env python3
"""Makes allocations fail in the daemon (alloc_preload.c), during one request of each route. Each
call path (stack of return addresses) to an allocation of the daemon, of its libraries or of libc
fails once alone, and once together with all later allocations. The answer must be a problem (507,
503), the correct answer, or a closed connection. Afterwards the daemon still runs, answers the same
request correctly, and holds no more memory than before.

    tests/fault/alloc.py [--short] [--only WORD]

--short: call paths that have failed in one request do not fail again in others. After the first
DENSE trials of a request, only every STEP-th new call path fails.
"""
import argparse
import contextlib
import ctypes
import json
import mmap
import os
import pathlib
import re
import socket
import sys
import tempfile
import time

from common import GONE, Shimmed, build_shim, check
from figures import conclude, report
from harness import TETRAHEDRON

FINE, FRESH, LASTING = 0, 1, 2
REFUSED = {503: ("overloaded", "draining", "store_unavailable"), 507: ("insufficient_memory", "insufficient_storage")}
PATIENCE_SECONDS = 20
# largest number of trials of a request; more trials would mean that call paths never end
MOST_TRIALS = 3000
DENSE, STEP = 30, 6
# members that differ between two answers to the same request
VOLATILE = re.compile(rb'"(?:elapsed_ms|age_s|uptime_s|requested_at|created|created_at|started_at|finished_at|expires_at|id|job|trace_id|build_ms)":'
                      rb'\s*(?:"[^"]*"|[-+.0-9eE]+)')
# the etags of a derived mesh and of its source differ in each trial
ETAG = re.compile(rb'"etag":"[^"]*"')
QUERIES = {"/v1/meshes/{name}/distance": "?from=v:0&to=e:1-2:0.5", "/v1/meshes/{name}/path": "?from=v:0&to=e:1-2:0.5",
           **{f"/v1/{kind}/{{name}}/nearest": "?point=p:0.2,0.1,-0.5" for kind in ("meshes", "nurbs", "subdivisions")},
           "/v1/nurbs/{name}/path": "?from=0.1,0.1&to=0.9,0.6",
           **{f"/v1/subdivisions/{{name}}/{query}": "?from=f:0:0.25,0.25&to=f:1:0.5,0.5&level=2" for query in ("distance", "path")},
           "/v1/meshes/{name}/fields/{id}/isolines": "?levels=0.25,0.5&arcs=true",
           "/v1/meshes/{name}/fields/{id}/cut-locus": "?min_angle=0.1&members=segments",
           "/v1/meshes/{name}/fields/{id}/wedges": "?edge=0-1",
           **{f"/v1/meshes/{{name}}/picture.{form}": "?source=v:0&from=v:0&to=v:2&isolines=2&size=64x48" for form in ("png", "svg")}}
# requests that use a mesh of a low level, which is built quickly
COARSE = ("/v1/subdivisions/{name}/distance", "/v1/subdivisions/{name}/path")
# figures of surfaces that take a second with the distances on 40,000 triangles; figures of meshes
# have these layers too
SMOOTH_FIGURES = ("/v1/nurbs/{name}/picture", "/v1/subdivisions/{name}/picture")
JOBS = (("put", "/v1/meshes/{name}"), ("post", "/v1/meshes/{name}/fields"), ("post", "/v1/meshes/{name}/cut"), ("post", "/v1/meshes/{name}/voronoi"))
# requests whose answers depend on the daemon's state
UNSTABLE = ("/metrics", "/v1", "/v1/jobs", "/v1/jobs/{job}", "/v1/jobs/{job}/events", "/v1/batches", "/v1/batches/{batch}")


class Stacks(ctypes.Structure):
    """Mirrors struct stacks of stacks.h."""

    _fields_ = [("count", ctypes.c_uint32), ("padding", ctypes.c_uint32), ("keys", ctypes.c_uint64 * (1 << 16))]


class Control(ctypes.Structure):
    """Mirrors struct control of alloc_preload.c."""

    _fields_ = [("order", ctypes.c_uint32), ("failures", ctypes.c_uint32), ("blocks", ctypes.c_int64),
                ("step", ctypes.c_uint32), ("padding", ctypes.c_uint32), ("stacks", Stacks), ("sites", Stacks)]

    def forget(self):
        ctypes.memset(ctypes.byref(self.stacks), 0, ctypes.sizeof(self.stacks))


def open_control(path):
    path.write_bytes(bytes(ctypes.sizeof(Control)))
    with open(path, "r+b") as file:
        return Control.from_buffer(mmap.mmap(file.fileno(), 0))


# --- requests -----------------------------------------------------------------------------------


def resolved(document, item):
    while "$ref" in item:
        place = document
        for part in item["$ref"][2:].split("/"):
            place = place[part]
        item = place
    return item


def example(document, operation):
    """Returns content type and body of the contract's example for an operation."""
    if "requestBody" not in operation:
        return None, None
    content = resolved(document, operation["requestBody"])["content"]
    kind = next(kind for kind in content if "json" in kind)
    shown = content[kind].get("example") or resolved(document, next(iter(content[kind]["examples"].values())))["value"]
    return kind, (shown if isinstance(shown, str) else json.dumps(shown)).encode()


class Request:
    """The contract's example request for one operation."""

    def __init__(self, document, method, path, operation, is_async=False):
        self.method, self.path, self.is_async = method.upper(), path, is_async
        self.kind, self.body = example(document, operation)
        if path in COARSE and self.body:
            self.body = self.body[:-1] + b', "level": 2}'
        if path in SMOOTH_FIGURES and self.body:
            figure = json.loads(self.body)
            figure["layers"] = [layer for layer in figure["layers"] if not layer.keys() & {"field", "isolines"}]
            self.body = json.dumps(figure).encode()

    def __str__(self):
        return f"{self.method} {self.path}" + (", as a job" if self.is_async else "")

    @property
    def is_change(self):
        """Returns whether the request changes the state that a second request finds."""
        return self.method in ("PUT", "DELETE") or self.path in ("/v1/meshes", "/v1/nurbs", "/v1/subdivisions", "/v1/batches") and self.method == "POST" or (
            self.path.rpartition("/")[2] in ("cut", "tessellate", "discretize", "derive", "fields"))

    @property
    def headers(self):
        return ({"Content-Type": self.kind} if self.kind else {}) | ({"Prefer": "respond-async"} if self.is_async else {})


def all_requests(document):
    """Returns one request for each operation. An upload, a change and a query are also returned as
    jobs."""
    operations = [(method, path, operation) for path, item in document["paths"].items() for method, operation in item.items()
                  if method in ("get", "put", "post", "delete")]
    return [Request(document, *each) for each in operations] + [Request(document, *each, is_async=True) for each in operations if each[:2] in JOBS]


# --- the daemon ---------------------------------------------------------------------------------


class Scene:
    """A daemon and the surfaces of the requests. The surfaces are created again before each trial,
    so that no answer comes from a cache."""

    def __init__(self, place, library):
        control = place / "control"
        self.control = open_control(control)
        self.folder = place / "data"
        self.daemon = Shimmed(self.folder, library=library, environment={"ALLOC_CONTROL": str(control)})
        self.document = self.daemon.get("/openapi.json").json
        self.bodies = {(each.method, each.path): each.body for each in all_requests(self.document)}
        self.number = 0

    def must(self, method, path, body=None, headers=None, statuses=(200, 201, 202, 204)):
        answer = self.daemon.request(method, path, body, headers or {})
        assert answer.status in statuses, (method, path, answer)
        return answer

    def clear(self):
        for job in self.must("GET", "/v1/jobs").json["jobs"]:
            assert self.job_ends(f"/v1/jobs/{job['id']}")
            self.must("DELETE", f"/v1/jobs/{job['id']}")
        for batch in self.must("GET", "/v1/batches").json["batches"]:
            while self.must("DELETE", f"/v1/batches/{batch['id']}", statuses=(204, 404)).status == 204:
                pass  # the first DELETE cancels a job, the second removes it
        for kind in ("meshes", "nurbs", "subdivisions"):
            for item in self.must("GET", f"/v1/{kind}").json[kind]:
                self.must("DELETE", f"/v1/{kind}/{item['name']}")

    def put_surface(self, kind, name):
        self.must("PUT", f"/v1/{kind}/{name}", self.bodies["PUT", f"/v1/{kind}/{{name}}"], {"Content-Type": "application/json"})

    def prepare(self, request):
        """Creates what the request needs and removes what it creates; returns its path."""
        self.number += 1
        self.clear()
        path, target, names = request.path, request.path, {"meshes": "tetrahedron", "nurbs": "sheet", "subdivisions": "cube"}
        kind = (path.split("/") + ["", ""])[2]
        if kind in ("nurbs", "subdivisions") and "{name}" in path and request.method != "PUT":
            self.put_surface(kind, names[kind])
        if path == "/v1/batches" or path.startswith("/v1/meshes/{name}") and request.method != "PUT":
            self.must("PUT", "/v1/meshes/tetrahedron", TETRAHEDRON + b"#" + str(self.number).encode())
        if path.endswith("/parameters"):
            self.put_surface("nurbs", "sheet")
            self.must("POST", "/v1/nurbs/sheet/tessellate", b'{"mesh": "m", "resolution": [4, 4]}', {"Content-Type": "application/json"})
            names["meshes"] = "m"
        if path.endswith("/places"):
            self.put_surface("subdivisions", "cube")
            self.must("POST", "/v1/subdivisions/cube/discretize", b'{"mesh": "m", "level": 1}', {"Content-Type": "application/json"})
            names["meshes"] = "m"
        if path.endswith("/origins"):
            self.must("POST", "/v1/meshes/tetrahedron/derive", b'{"mesh": "m", "operations": [{"operation": "components"}]}',
                      {"Content-Type": "application/json"})
            names["meshes"] = "m"
        if "{id}" in path:
            made = self.must("POST", "/v1/meshes/tetrahedron/fields", b'{"set": {"points": [{"vertex": 0}]}}',
                             {"Content-Type": "application/json"})
            target = target.replace("{id}", made.json["id"])
        if "{batch}" in path:
            target = target.replace("{batch}", self.finished_batch())
        if "{job}" in path:
            target = target.replace("{job}", self.finished_job())
        return target.replace("{name}", names.get(kind, "")) + (QUERIES.get(path, "") if request.method == "GET" else "")

    def finished_batch(self):
        self.must("PUT", "/v1/meshes/tetrahedron", TETRAHEDRON + b"#" + str(self.number).encode())
        made = self.must("POST", "/v1/batches", self.bodies["POST", "/v1/batches"], {"Content-Type": "application/json"})
        while self.must("GET", made.headers["Location"]).json["state"] == "running":
            time.sleep(0.001)
        return made.json["id"]

    def finished_job(self):
        self.must("PUT", "/v1/meshes/tetrahedron", TETRAHEDRON + b"#" + str(self.number).encode())
        made = self.must("POST", "/v1/meshes/tetrahedron/fields", b'{"set": {"points": [{"vertex": 0}]}}',
                         {"Content-Type": "application/json", "Prefer": "respond-async"})
        job = made.headers["Location"].rpartition("/")[2]
        while self.must("GET", f"/v1/jobs/{job}").json["state"] in ("queued", "running"):
            time.sleep(0.001)
        return job

    def ask(self, request, path):
        """Returns the answer, or None if the connection was closed without an answer."""
        try:
            return self.daemon.request(request.method, path, request.body, request.headers)
        except GONE as reason:
            if isinstance(reason, (TimeoutError, socket.timeout)):
                raise
            return None

    def job_ends(self, location):
        """Returns whether the job ends in any state while memory fails."""
        until = time.monotonic() + PATIENCE_SECONDS
        while time.monotonic() < until:
            with contextlib.suppress(*GONE):
                answer = self.daemon.get(location)
                if answer.status == 200 and answer.json["state"] not in ("queued", "running"):
                    return True
            time.sleep(0.001)
        return False

    def settled_blocks(self):
        """Returns the number of held blocks, after the library has released ended connections."""
        time.sleep(0.005)
        return self.control.blocks

    @property
    def is_alive(self):
        try:
            return self.daemon.get("/livez").status == 200
        except GONE:
            self.daemon.process.wait(10)
            return False


# --- trials -------------------------------------------------------------------------------------


class Tally:
    def __init__(self):
        self.trials = self.refused = self.closed = self.crashes = self.leaks = 0
        self.wrong = []


def essence(request, answer):
    if request.path in UNSTABLE or request.is_async:
        return answer.status
    body = VOLATILE.sub(b"", answer.body)
    return answer.status, ETAG.sub(b"", body) if request.path.endswith("/derive") else body


def is_refusal(answer):
    """Returns whether the answer is a problem with a detail sentence, and with a code for lacking
    resources."""
    if answer.status not in REFUSED:
        return False
    document = answer.json
    return document["status"] == answer.status and document["code"] in REFUSED[answer.status]


def lines_fit(got, right):
    """Compares a stream of answers, each of which may be refused."""
    got, right = got.body.splitlines(), right.body.splitlines()
    return len(got) == len(right) and all(a == b or json.loads(a).get("status") in REFUSED for a, b in zip(got, right))


def judge(request, answer, right, tally):
    if answer is None:
        tally.closed += 1
    elif is_refusal(answer):
        tally.refused += 1
    elif essence(request, answer) != essence(request, right):
        if request.kind != "application/x-ndjson" or not lines_fit(answer, right):
            return f"{answer}, not {right}"
    return None


def try_once(scene, request, order, tally):
    """Runs one trial. A trial in which no allocation fails is judged too, but not counted."""
    path = scene.prepare(request)
    scene.control.failures = 0
    scene.control.order = order
    answer = scene.ask(request, path)
    if answer is not None and answer.status == 202 and scene.control.order == FRESH and not scene.job_ends(answer.headers["Location"]):
        tally.wrong.append(f"{request}: the job does not end")
    scene.control.order = FINE
    failed = scene.control.failures > 0
    if not scene.is_alive:
        return
    right = scene.ask(request, scene.prepare(request) if request.is_change else path)
    # after a failed field build the daemon waits a second before it tries again
    if right is not None and is_refusal(right):
        right = scene.ask(request, scene.prepare(request))
    tally.trials += failed
    if right is None or right.status >= 400:
        tally.wrong.append(f"{request}, after the trial: {right}")
    elif fault := judge(request, answer, right, tally):
        tally.wrong.append(f"{request}: {fault}")


def sweep(scene, request, is_short, tally):
    """Runs trials until a trial reaches no new call path, first with single failures, and then with
    lasting failures."""
    for order in (FRESH, LASTING):
        known = bytes(scene.control.stacks)
        for trial in range(MOST_TRIALS):
            reached = scene.control.stacks.count
            scene.control.step = STEP if is_short and trial >= DENSE else 1
            try_once(scene, request, order, tally)
            if scene.control.stacks.count == reached or not scene.is_alive:
                break
        if order == FRESH:
            ctypes.memmove(ctypes.byref(scene.control.stacks), known, len(known))


def held(scene, request):
    """Returns the number of blocks that are held after the request was answered several times."""
    for _ in range(3):
        scene.ask(request, scene.prepare(request))
    scene.clear()
    return min(scene.settled_blocks() for _ in range(8))


def try_request(scene, request, is_short, tally):
    """Sweeps once, and repeats the sweep as long as each sweep leaves more blocks. A cache grows
    only once, but a leak grows every time."""
    known, before = bytes(scene.control.stacks), held(scene, request)
    for _ in range(3):
        ctypes.memmove(ctypes.byref(scene.control.stacks), known, len(known))
        sweep(scene, request, is_short, tally)
        if not scene.is_alive or (after := held(scene, request)) <= before:
            return
        before = after
    tally.leaks += 1
    tally.wrong.append(f"{request}: more blocks are held after each sweep")


def run(place, library, requests, is_short, tally):
    scene = Scene(place, library)
    for request in [each for each in all_requests(scene.document) if requests in str(each)]:
        trials = tally.trials
        try_request(scene, request, is_short, tally)
        print(f"{request}: {tally.trials - trials} failures", file=sys.stderr, flush=True)
        if not scene.is_alive:
            tally.crashes += 1
            tally.wrong.append(f"{request}: the daemon ended with {scene.daemon.stop()}")
            scene = Scene(place, library)
        if not is_short:
            scene.control.forget()
    finish(scene, tally)
    return scene.control.sites.count


def finish(scene, tally):
    if scene.daemon.metric("connections") > 1:
        tally.wrong.append(f"{scene.daemon.metric('connections')} connections are left")
    if (status := scene.daemon.stop()) != 0:
        tally.wrong.append(f"exit status {status}")
    if (result := check(scene.folder)).returncode:
        tally.wrong.append(result.stdout)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--short", action="store_true")
    arguments.add_argument("--only", default="")
    options = arguments.parse_args()
    tally = Tally()
    # in memory, because the disk is not under test
    memory = "/dev/shm" if os.path.isdir("/dev/shm") else None
    with tempfile.TemporaryDirectory(dir=memory) as text:
        place = pathlib.Path(text).resolve()
        sites = run(place, build_shim("alloc_preload", place), options.only, options.short, tally)
    for fault in tally.wrong[:20]:
        print(f"wrong: {fault}")
    measured = (f"{sites} call sites, {tally.trials} failures ({tally.refused} refused, {tally.closed} connections closed), {tally.crashes} crashes, "
                f"{tally.leaks} leaks, {len(tally.wrong)} wrong answers")
    return conclude("alloc", [report("allocation failures in the daemon, every route", "0 crashes, 0 leaks, 0 wrong answers", measured,
                                     sites and not (tally.wrong or tally.crashes or tally.leaks))])


if __name__ == "__main__":
    sys.exit(main())
