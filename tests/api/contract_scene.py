"""The requests of the contract's examples, for each operation, and the surfaces that they use.

A new operation needs no change here if the examples of its parameters and its body work on the
surfaces of `Scene.fill`: the mesh `tetrahedron`, the control mesh `cube`, the NURBS surface
`sheet`, the meshes that the examples of `tessellate` make from them, a field and a job. The tables
below hold the exceptions.
"""
import json
import typing
import urllib.parse

from harness import header_fields, wait_until

JSON = {"Content-Type": "application/json"}
FIELD = b'{"set": {"points": [{"vertex": 0}]}}'


class Ask(typing.NamedTuple):
    """A request. If `body` is None, the request has neither a body nor a Content-Length."""

    method: str
    target: str
    body: bytes | None
    headers: dict

    def plus(self, body=None, query="", **headers):
        """Returns a copy with changed headers, an extended query string, or another body. The
        keyword `If_Match` stands for the header If-Match; the value None removes a header."""
        sign = "&" if "?" in self.target else "?"
        merged = {name: value for name, value in {**self.headers, **header_fields(headers)}.items() if value is not None}
        return Ask(self.method, self.target + (sign + query if query else ""), self.body if body is None else body, merged)


def send(daemon, ask):
    """Sends a request. http.client's `request` would add a Content-Length to each POST."""
    if ask.body is not None or ask.method not in ("POST", "PUT", "PATCH"):
        return daemon.request(ask.method, ask.target, ask.body, ask.headers)
    return daemon.request_bare(ask.method, ask.target, ask.headers)


class Scene:
    """A daemon with all surfaces that the contract's requests use."""

    def __init__(self, daemon, contract, **headers):
        self.daemon, self.contract, self.headers = daemon, contract, headers
        self.by_name = {each.name: each for each in contract.operations}
        self.field = self.job = self.batch = ""
        self.filled = None  # `changes` of the daemon after fill

    def must(self, method, path, body=None, headers=None):
        answer = self.daemon.request(method, path, body, {**self.headers, **(headers or {})})
        assert answer.status in (200, 201, 202, 204), (method, path, answer)
        return answer

    def shown_body(self, name):
        return next(iter(self.by_name[name].examples(self.contract.document)))[1]

    def put_surfaces(self):
        for put in ("put_mesh", "put_nurbs", "put_subdivision"):
            self.must("PUT", self.path(self.by_name[put]), self.shown_body(put), JSON)

    def fill(self):
        """Creates all surfaces, the field and the job. May be called again: existing surfaces stay
        unchanged, and if no request has changed anything, nothing is sent."""
        if self.filled == self.daemon.changes:
            return self
        self.put_surfaces()
        for operation in ("post_nurbs_tessellate", "post_subdivision_tessellate", "post_derive"):
            self.must("POST", self.path(self.by_name[operation]), self.shown_body(operation), JSON)
        self.field = self.must("POST", self.path(self.by_name["create_field"]), FIELD, JSON).json["id"]
        self.job = self.finished_job()
        # deletes the previous batch first, because the daemon permits at most a thousand batches
        self.daemon.request("DELETE", f"/v1/batches/{self.batch or 'none'}", headers=self.headers)
        self.batch = self.end_of_job(self.must("POST", "/v1/batches", self.shown_body("create_batch"), JSON))
        self.filled = self.daemon.changes
        return self

    def pretend(self):
        """Sets the ids of the field and the job as for a restarted daemon, which still has its
        surfaces, but no fields and jobs."""
        self.field, self.job, self.batch, self.filled = "0" * 32, "0" * 24, "0" * 24, None
        return self

    def start_job(self, target, document):
        return self.must("POST", target, dumps(document), {**JSON, "Prefer": "respond-async"}).json["id"]

    def finished_job(self):
        target = self.path(self.by_name["post_distance"])
        return self.end_of_job(self.must("POST", target, self.shown_body("post_distance"), {**JSON, "Prefer": "respond-async"}))

    def end_of_job(self, accepted):
        """Waits for a job or a batch to end and returns its id."""
        job = wait_until(lambda: (job := self.must("GET", accepted.headers["Location"]).json)["state"] not in ("queued", "running") and job)
        return job["id"]

    def path(self, operation):
        """Returns the operation's path, with the examples of its parameters."""
        path = operation.path
        for parameter in operation.parameters:
            if parameter["in"] != "path":
                continue
            name = parameter["name"]
            value = {"id": self.field, "job": self.job, "batch": self.batch}.get(name) or parameter["example"]
            path = path.replace("{" + name + "}", value)
        return path

    def query(self, operation, optional):
        shown = [each for each in operation.parameters if each["in"] == "query" and "example" in each]
        needed = [each for each in shown if each.get("required")]
        return urllib.parse.urlencode([(each["name"], query_text(each["example"])) for each in (shown if optional else needed or shown)], safe=":,")

    def ask(self, operation, example=None, optional=True):
        """Returns the documented request. `example` is one of its bodies; None selects the first
        body. If `optional`, the request has all parameters with an example, not only the required
        parameters."""
        query = self.query(operation, optional)
        kind, body = example or next(iter(operation.examples(self.contract.document)), (None, None))
        headers = {**self.headers, **({"Content-Type": kind} if kind else {})}
        return Ask(operation.method.upper(), self.path(operation) + ("?" + query if query else ""), body, headers)

    def asks(self, operation):
        """Yields all documented requests of the operation."""
        for example in list(operation.examples(self.contract.document)) or [None]:
            yield self.ask(operation, example)


def query_text(value):
    return {True: "true", False: "false"}.get(value, value) if isinstance(value, bool) else value


def points_replaced(value, replacement):
    """Returns the JSON value with every point of a mesh replaced."""
    if isinstance(value, dict):
        if value.keys() in ({"vertex"}, {"edge", "t"}, {"face", "barycentric"}, {"xyz", "max_snap"}):
            return replacement
        if "vertices" in value and "faces" not in value:
            return {"points": [replacement]}
        return {key: points_replaced(item, replacement) for key, item in value.items()}
    if isinstance(value, list):
        return [points_replaced(item, replacement) for item in value]
    return value


def dumps(value):
    return json.dumps(value).encode()
