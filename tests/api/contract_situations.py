"""States of a daemon and changes of a request that cause the problems that the contract documents.

Each situation is tried on every operation that it concerns. A function `try_...` starts a daemon in
some state; a change turns a valid request into a wrong one. The problems are recorded by operation.
test_contract_problems.py compares them with the documented ones.
"""
import collections
import contextlib
import http.client
import json
import pathlib
import re
import resource
import sys
import tempfile
import threading
import time

import contract
from contract_scene import JSON, Ask, Scene, dumps, points_replaced, send
from harness import PROGRAM, TETRAHEDRON, Answer, Daemon, sample, wait_until
from nurbs import bumps
from test_access import bearer, line

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "fault"))

from alloc import FINE, FRESH, open_control  # noqa: E402
from common import Shimmed, build_shim  # noqa: E402

FEW_SECONDS = 60
LATE = (504, "deadline_exceeded")
# largest number of repetitions of a hundred simultaneous requests; they end when a request misses
# its deadline
ROUNDS = 50


def documented(operation):
    """Yields (status, code) of each documented problem. HEAD has no body, so its code is
    omitted."""
    for status, codes in operation.codes.items():
        for code in codes:
            yield status, code


class Situations:
    """Records the problems `seen` for each operation, and the `faults`."""

    def __init__(self):
        self.contract = contract.load()
        self.seen, self.faults = collections.defaultdict(set), []

    def note(self, operation, ask, answer):
        self.faults += self.contract.faults(ask.method, ask.target, answer)
        if answer.status < 400:
            self.seen[operation.name].add((answer.status, ""))
        elif operation.method == "head":
            self.seen[operation.name].update((answer.status, code) for code in operation.codes.get(answer.status, ()))
        else:
            self.seen[operation.name].add((answer.status, answer.json["code"]))

    def try_all(self, daemon, scene, change, operations=None):
        """Changes the documented request of each operation and sends it. `change` returns one Ask,
        several Asks, or None if it does not concern the operation."""
        for operation in operations or self.contract.operations:
            changed = change(scene, operation, scene.ask(operation))
            for ask in [changed] if isinstance(changed, Ask) else changed or ():
                self.note(operation, ask, send(daemon, ask))

    def missing(self):
        for operation in self.contract.operations:
            for pair in sorted(set(documented(operation)) - self.seen[operation.name]):
                yield operation, *pair


# --- changes of a valid request -----------------------------------------------------------------


def as_it_is(scene, operation, ask):
    scene.fill()
    return ask


def twice(scene, operation, ask):
    """Uploads a new surface, and then uploads the same surface again."""
    if operation.success != 200 or operation.response(201) is None:
        return None
    for kind in ("meshes", "nurbs", "subdivisions"):
        for item in scene.must("GET", f"/v1/{kind}").json[kind]:
            scene.must("DELETE", f"/v1/{kind}/{item['name']}")
    if not is_upload(operation):
        scene.put_surfaces()
    return [ask, ask]


def absent(scene, operation, ask):
    """Replaces names and ids by absent ones."""
    if "{id}" in operation.path:
        return [ask._replace(target=ask.target.replace(scene.field, "0" * 32)), ask._replace(target=ask.target.replace(scene.field, "x"))]
    if "{job}" in operation.path:
        return ask._replace(target=ask.target.replace(scene.job, "0" * 24))
    if "{batch}" in operation.path:
        return ask._replace(target=ask.target.replace(scene.batch, "0" * 24))
    if operation.name == "create_batch":
        return ask.plus(ask.body.replace(b"tetrahedron", b"no-such"))
    if "{name}" in operation.path and not is_upload(operation):
        parts = ask.target.split("/")
        name, mark, query = parts[3].partition("?")
        return ask._replace(target="/".join([*parts[:3], "no-such" + mark + query, *parts[4:]]))
    return None


def oversized(scene, operation, ask):
    """Announces a body that is never sent."""
    return ask.plus(Content_Length=str(1 << 50))._replace(body=None) if operation.body else None


def misplaced(scene, operation, ask):
    """Replaces points by points that are not on the surface."""
    if not operation.body:
        target = ask.target.replace("v:0", "f:0:2,2,2").replace("p:0.2,0.1,-0.5", "f:0:2,2,2")
        # changes a point of a subdivision surface, or parameters of a NURBS surface
        if target == ask.target:
            target = re.sub("from=[^&]*", "from=f:0:2,2" if "/subdivisions/" in target else "from=9,9", target)
        return ask._replace(target=target)
    if is_upload(operation):
        return [ask.plus(b"nothing of the kind"), ask.plus(dumps({**json.loads(ask.body), "knotsU": [1, 0, 0, 1]})), ask.plus(b"")]
    if ask.headers["Content-Type"] != JSON["Content-Type"]:
        return None
    whole = json.loads(ask.body)
    return [ask.plus(dumps(points_replaced(whole, {"xyz": [9, 9, 9], "max_snap": 1e-3}))), ask.plus(dumps(moved(whole)))]


def moved(value):
    """Moves parameters outside of any domain."""
    if isinstance(value, dict):
        return {key: [9, 9] if key in ("uv", "a", "b", "point", "from", "to") and numbers(item) else moved(item) for key, item in value.items()}
    if numbers(value) and len(value) == 2:
        return [9, 9]
    return [moved(item) for item in value] if isinstance(value, list) else value


def numbers(value):
    return isinstance(value, list) and value != [] and all(isinstance(item, (int, float)) for item in value)


PLAIN = {
    "as it is": as_it_is,
    "uploads": twice,
    "another parameter": lambda scene, operation, ask: ask.plus(query="no_such=1"),
    "a foreign host": lambda scene, operation, ask: ask.plus(Host="evil.example"),
    "nothing of that name": absent,
    "a media type that there is not": lambda scene, operation, ask: ask.plus(Accept="image/x-nothing"),
    "no body": lambda scene, operation, ask: ask._replace(body=None) if operation.body else None,
    "a body that is not expected": lambda scene, operation, ask: None if operation.body else ask.plus(b"{}"),
    "another version": lambda scene, operation, ask: ask.plus(If_Match='"00000000000000000000000000000000"'),
    "not this version": lambda scene, operation, ask: ask.plus(If_None_Match="*"),
    "a body that is too large": oversized,
    "a coding that there is not": lambda scene, operation, ask: ask.plus(Content_Encoding="br") if operation.body else None,
    "a body of another kind": lambda scene, operation, ask: ask.plus(Content_Type="text/nonsense") if operation.body else None,
    "as a job": lambda scene, operation, ask: ask.plus(Prefer="respond-async"),
    "places outside": misplaced,
    "a level that is too fine": lambda scene, operation, ask: ask.plus(query="level=12") if any(each["name"] == "level" for each in operation.parameters) else None,
    "a picture that is too large": lambda scene, operation, ask: instead(scene, operation, "size", "4096x4096"),
}


# --- states of the daemon -----------------------------------------------------------------------


def asking(scene, operation, ask):
    """Returns only requests that change neither surfaces nor jobs."""
    return None if operation.method == "delete" or is_upload(operation) or operation.path.startswith("/v1/jobs") else ask


def uploading(scene, operation, ask):
    """Uploads something large."""
    return ask.plus(large(operation)) if is_upload(operation) else None


def is_upload(operation):
    """Returns whether the operation uploads a surface."""
    return operation.name.startswith(("put_", "create_")) and operation.name not in ("create_field", "create_batch")


def large(operation):
    if "nurbs" in operation.path:
        return dumps(bumps(250, 250, 0.1, 1))
    return sample("icosphere", level=5 if "subdivisions" in operation.path else 6)


def removing(scene, operation, ask):
    return ask if operation.method == "delete" else None


def try_plain(found):
    with Daemon() as daemon:
        scene = Scene(daemon, found.contract)
        for change in PLAIN.values():
            for operation in found.contract.operations:
                scene.fill()
                found.try_all(daemon, scene, change, [operation])
        try_conflicts(found, daemon, scene)
        try_degenerate(found, daemon, scene)
        scene.fill()
        for number in range(1100):  # more fields than a mesh's catalogue remembers
            scene.must("POST", "/v1/meshes/tetrahedron/fields", dumps({"set": {"points": [{"edge": [0, 1], "t": number / 2000}]}}), JSON)
        found.try_all(daemon, scene, lambda scene, operation, ask: ask if "{id}" in operation.path else instead(scene, operation, "field", scene.field))


def instead(scene, operation, name, value):
    """Returns the request with only that parameter, or None if the operation lacks the
    parameter."""
    has = any(parameter["name"] == name for parameter in operation.parameters)
    return scene.ask(operation)._replace(target=f"{scene.path(operation)}?{name}={value}") if has else None


def try_conflicts(found, daemon, scene):
    """Provokes conflicts and rare statuses: reads the result of a running job, reads the result of
    an upload (201), and names a piece after the mesh that is cut."""
    result, cut, events, isolines, locus = (scene.by_name[name] for name in ("get_job_result", "post_cut", "get_job_events", "get_isolines", "get_cut_locus"))
    scene.fill()
    daemon.put("tetrahedron-1", TETRAHEDRON)
    unnamed = {key: value for key, value in json.loads(scene.ask(cut).body).items() if key != "names"}
    found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(dumps(unnamed)), [cut])
    found.try_all(daemon, scene, lambda scene, operation, ask: ask._replace(target=scene.path(operation) + "?count=1000&tolerance=1e-9"), [isolines])
    daemon.put("ball", sample("icosphere", level=5))
    preview = scene.by_name["get_preview"]
    found.try_all(daemon, scene, lambda scene, operation, ask: ask._replace(target="/v1/meshes/ball/preview?faces=1000"), [preview])
    field = daemon.ask("ball", "fields", {"set": {"points": [{"face": 77, "barycentric": [0.2, 0.3, 0.5]}]}}).json["id"]
    found.try_all(daemon, scene, lambda scene, operation, ask: ask._replace(target=f"/v1/meshes/ball/fields/{field}/cut-locus"), [locus])
    hog = scene.start_job("/v1/meshes/ball/farthest-points", {"count": 10000})
    found.try_all(daemon, scene, lambda scene, operation, ask: ask._replace(target=f"/v1/jobs/{hog}/result"), [result])
    scene.must("DELETE", f"/v1/jobs/{hog}")
    scene.must("DELETE", "/v1/meshes/tetrahedron")
    put = scene.ask(scene.by_name["put_mesh"])
    scene.job = scene.end_of_job(send(daemon, put.plus(Prefer="respond-async")))
    found.try_all(daemon, scene, lambda scene, operation, ask: ask, [result])
    found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(Last_Event_ID="done"), [events])


def try_degenerate(found, daemon, scene):
    """Tries surfaces that can be evaluated but have parts without area. The subdivision surface
    consists of five squares and a line, the NURBS surface of a square and a line."""
    squares = [[[3 * i + x, y, 0] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))] for i in range(5)] + [[[x, 9, 0] for x in range(4)]]
    control = {"points": sum(squares, []), "faceVertexCounts": [4] * 6, "faceVertexIndices": list(range(24))}
    strips = {"degreeU": 1, "degreeV": 1, "knotsU": [0, 0, 1, 2, 2], "knotsV": [0, 0, 1, 1],
              "controlPoints": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]], [[1, 0, 0], [1, 1, 0]]]}
    for kind, name, document in (("subdivisions", "cube", control), ("nurbs", "sheet", strips)):
        scene.must("PUT", f"/v1/{kind}/{name}", dumps(document), JSON)
        found.try_all(daemon, scene, lambda scene, operation, ask: ask if f"/{kind}/{{name}}/" in operation.path else None)


def try_crowd(found):
    """Creates the maximum number of batches, and then one more."""
    with Daemon() as daemon:
        scene = Scene(daemon, found.contract).fill()
        found.try_all(daemon, scene, lambda scene, operation, ask: [ask] * 1000, [scene.by_name["create_batch"]])


def try_keys(found, place):
    """Sends requests without a key, with a read key, and beyond the rate of a key."""
    keys = pathlib.Path(place) / "keys"
    keys.write_text(line("writer", "role=write") + line("reader") + line("hasty", "role=write rate=1"))
    with Daemon("--keys", str(keys)) as daemon:
        scene = Scene(daemon, found.contract, **bearer("writer")).fill()
        found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(Authorization=None))
        found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(**bearer("reader")))
        scene.fill()
        hasty = bearer("hasty")
        for _ in range(3):
            daemon.request("GET", "/v1", headers=hasty)
        found.try_all(daemon, scene, lambda scene, operation, ask: [ask.plus(**hasty), ask.plus(**hasty)])


@contextlib.contextmanager
def hogged(daemon, count):
    """Keeps the only worker and its queue busy with requests. Waits until the worker runs the first
    request. Until then this request occupies a place in the queue, and the second request needs
    that place."""
    assert daemon.put("ball", sample("icosphere", level=5)).status in (200, 201)
    connections = [daemon.connect() for _ in range(count)]
    for number, connection in enumerate(connections):
        connection.request("POST", "/v1/meshes/ball/farthest-points", dumps({"count": 10000 - number}), JSON)
        wait_until(lambda: daemon.metric("requests_deferred") == number + 1 and daemon.metric("queue_depth") == number)
    yield
    for connection in connections:
        connection.close()


def store_large(place):
    """Makes a data folder that contains large surfaces with the names that the requests use.
    `sheet` is the largest surface and has the most recorded uses."""
    folder, ball = pathlib.Path(place) / "data", sample("icosphere", level=6)
    with Daemon("--data-dir", str(folder)) as daemon:
        for name in ("tetrahedron", "sheet-mesh", "cube-mesh"):
            assert daemon.put(name, ball).status == 201
        assert daemon.request("PUT", "/v1/subdivisions/cube?scheme=loop", sample("icosphere", level=5)).status == 201
        assert daemon.request("PUT", "/v1/nurbs/sheet", dumps(bumps(250, 250, 0.1, 1)), JSON).status == 201
        derivation = {"mesh": "tetrahedron-edited", "operations": [{"operation": "components", "keep": 1}]}
        assert daemon.request("POST", "/v1/meshes/tetrahedron/derive", dumps(derivation), JSON).status == 201
        for _ in range(500):
            assert daemon.request("POST", "/v1/nurbs/sheet/evaluate", b'{"uv": [[0, 0]]}', JSON).status == 200
    return folder


# After a start the daemon loads the most used surfaces without a request, until a surface would
# take a third of the memory. Here the first surface takes that much.
ASLEEP = ("--memory-budget", "140MiB", "--max-body", "64MiB", "--landmarks", "0")


def try_overload(found, folder):
    with Daemon("--data-dir", str(folder), "--workers", "1", "--queue-length", "1", *ASLEEP) as daemon:
        scene = Scene(daemon, found.contract).pretend()
        ended = dumps({"query": "fields", "meshes": ["no-such"], "set": {"points": [{"vertex": 0}]}})
        scene.batch = scene.end_of_job(scene.must("POST", "/v1/batches", ended, JSON))
        with hogged(daemon, 2):
            found.try_all(daemon, scene, lambda scene, operation, ask: asking(scene, operation, ask) or uploading(scene, operation, ask))
            found.try_all(daemon, scene, lambda scene, operation, ask: ask if operation.name == "delete_batch" else None)


def await_calm(daemon, threads):
    """Waits until a second passes in which no request arrives and no thread receives an answer."""
    seen = []
    while len(seen) < 5 or len(set(seen[-5:])) > 1:
        seen.append((daemon.metric("requests_deferred"), sum(thread.is_alive() for thread in threads)))
        time.sleep(0.25)


def try_drain(found, folder):
    """Sends all requests. They are still queued when the time limit of the drain ends."""
    with Daemon("--data-dir", str(folder), "--workers", "1", "--drain-ms", "100", *ASLEEP) as daemon:
        scene = Scene(daemon, found.contract).pretend()
        answers = []
        with contextlib.suppress(OSError), hogged(daemon, 1):
            def ask(operation):
                request = scene.ask(operation)
                with contextlib.suppress(OSError):
                    answers.append((operation, request, send(daemon, request)))
            threads = [threading.Thread(target=ask, args=[operation]) for operation in found.contract.operations if operation.method != "delete"]
            for thread in threads:
                thread.start()
            await_calm(daemon, threads)
            daemon.terminate()
            for thread in threads:
                thread.join(FEW_SECONDS)
        for each in answers:
            found.note(*each)


def try_waits(found, folder):
    """Sends a request that waits for a job. The deadline of the request ends before the job. On a
    busy machine the job may end before the request arrives."""
    with Daemon("--data-dir", str(folder), "--workers", "1", "--timeout-ms", "1", *ASLEEP) as daemon:
        scene = Scene(daemon, found.contract).pretend()
        for _ in range(ROUNDS):
            started = daemon.request("POST", "/v1/meshes/tetrahedron/farthest-points", dumps({"count": 10000}), {**JSON, "Prefer": "respond-async"})
            if started.status == 202:
                scene.job = started.json["id"]
                found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(query="wait=1"), [scene.by_name["get_job"]])
            if LATE in found.seen["get_job"]:
                break


def try_haste(found, folder):
    """Sends requests that take many milliseconds, with a deadline of one millisecond."""
    with Daemon("--data-dir", str(folder), "--timeout-ms", "1", *ASLEEP) as daemon:
        scene = Scene(daemon, found.contract).pretend()
        found.try_all(daemon, scene, asking)
        found.try_all(daemon, scene, uploading)
        # batches are in a database, which is read within the millisecond
        for operation in [each for each in found.contract.operations if "batches" in each.path]:
            asks = [scene.ask(operation)] * 100
            for _ in range(ROUNDS):
                for ask, answer in zip(asks, all_at_once(daemon, asks)):
                    found.note(operation, ask, answer)
                if set(documented(operation)) & {LATE} <= found.seen[operation.name]:
                    break


def try_scarcity(found, folder):
    with Daemon("--data-dir", str(folder), "--memory-budget", "16MiB", "--max-body", "16MiB", "--landmarks", "0") as daemon:
        scene = Scene(daemon, found.contract).pretend()
        found.try_all(daemon, scene, asking)
        found.try_all(daemon, scene, uploading)


def try_damage(found, folder):
    for path in folder.glob("objects/*/*"):
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)
    with Daemon("--data-dir", str(folder)) as daemon:
        found.try_all(daemon, Scene(daemon, found.contract).pretend(), asking)


def try_refusing_store(found, folder):
    """Makes writes of the store fail: files may have at most ten bytes."""
    with Daemon("--data-dir", str(folder)) as daemon:
        scene = Scene(daemon, found.contract).fill()
        resource.prlimit(daemon.process.pid, resource.RLIMIT_FSIZE, (10, 10))
        for change in (uploading, removing, asking):
            found.try_all(daemon, scene, change)
        found.try_all(daemon, scene, lambda scene, operation, ask: ask.plus(ask.body.replace(b"-mesh", b"-other").replace(b"base", b"bottom").replace(b"-edited", b"-other"))
                      if operation.name in ("post_cut", "post_derive", "post_nurbs_tessellate", "post_subdivision_tessellate", "post_subdivision_discretize") else None)


def try_late_changes(found, place):
    """Sends many changes at once. They are so many that the store's writer cannot begin the last
    one within a millisecond."""
    operations = [each for method in ("patch", "delete") for each in found.contract.operations
                  if each.method == method and (each.path, "put") in found.contract.by_place]
    surfaces = {operation.path for operation in operations}
    names = [f"n{number}" for number in range(100)]
    folder = pathlib.Path(place) / "many"
    with Daemon("--data-dir", str(folder)) as daemon:
        scene = Scene(daemon, found.contract)
        for path in surfaces:
            for name in names:
                put = found.contract.by_place[path, "put"]
                scene.must("PUT", path.replace("{name}", name), scene.shown_body(put.name), JSON)
    with Daemon("--data-dir", str(folder), "--timeout-ms", "1") as daemon:
        try_late_lists(found, daemon)
        change = {"patch": (b'{"description": "late"}', JSON), "delete": (None, {})}
        for operation in operations:
            method, content = operation.method.upper(), change[operation.method]
            asks = [Ask(method, operation.path.replace("{name}", name), *content) for name in names]
            for ask, answer in zip(asks, all_at_once(daemon, asks)):
                found.note(operation, ask, answer)


def try_late_lists(found, daemon):
    """Sends many list requests at once. They are so many that the lister's thread cannot begin the
    last one within a millisecond."""
    for _ in range(100):
        daemon.request("POST", "/v1/meshes/n0/farthest-points", b'{"count": 2}', {**JSON, "Prefer": "respond-async"})
    for name in ("list_meshes", "list_nurbs", "list_subdivisions", "list_jobs"):
        operation = next(each for each in found.contract.operations if each.name == name)
        asks = [Ask("GET", operation.path, None, {})] * 100
        for _ in range(ROUNDS):
            for ask, answer in zip(asks, all_at_once(daemon, asks)):
                found.note(operation, ask, answer)
            if LATE in found.seen[operation.name]:
                break


def all_at_once(daemon, asks):
    """Sends all requests before it reads the first answer. Returns the answers."""
    connections = [daemon.connect() for _ in asks]
    for connection in connections:
        connection.connect()
    for connection, ask in zip(connections, asks):
        connection.request(ask.method, ask.target, ask.body, ask.headers)
    for connection in connections:
        response = connection.getresponse()
        yield Answer(response.status, response.headers, response.read())
        connection.close()


def try_failing_memory(found, place):
    """Makes each allocation of a request fail once, until all operations have reported the failures
    that they document."""
    library = build_shim("alloc_preload", place)
    file = pathlib.Path(place) / "control"
    control = open_control(file)
    with Shimmed(pathlib.Path(place) / "failing", library=library, environment={"ALLOC_CONTROL": str(file)}) as daemon:
        scene = Scene(daemon, found.contract).fill()
        for operation in [each for each in found.contract.operations if (507, "insufficient_memory") in set(documented(each)) - found.seen[each.name]]:
            fail_in_turn(found, daemon, control, operation, scene.ask(operation))


def fail_in_turn(found, daemon, control, operation, ask):
    control.forget()
    for _ in range(500):
        control.failures, control.order = 0, FRESH
        with contextlib.suppress(OSError, http.client.HTTPException):
            found.note(operation, ask, send(daemon, ask))
        if not control.failures or (507, "insufficient_memory") in found.seen[operation.name]:
            break
    control.order = FINE
