"""The contract, proto/openapi.yaml: makes its requests, and checks answers against it.

An answer is right if its status, media type, problem code, headers and body are documented for its
operation, and if no required member is missing. The contract allows undocumented members in
answers, but here such a member is a fault. A required member may be missing only if `select` in the
request can omit it. Needs Debian's python3-yaml and python3-jsonschema.
"""
import functools
import gzip
import json
import pathlib
import re
import sys
import urllib.parse

import yaml

DOCUMENT = pathlib.Path(__file__).resolve().parents[2] / "proto" / "openapi.yaml"
sys.path.append(str(DOCUMENT.parent))
import members  # noqa: E402

METHODS = ("get", "head", "put", "post", "patch", "delete")
JSON_TYPES = ("application/json", "application/problem+json")
PROBLEM = {"$ref": "#/components/schemas/Problem"}
# Headers that any answer may have. The contract documents all other headers.
COMMON_HEADERS = {"cache-control", "connection", "content-encoding", "content-length", "content-security-policy", "content-type",
                  "cross-origin-resource-policy", "date", "deprecation", "link", "referrer-policy", "strict-transport-security", "transfer-encoding", "vary",
                  "x-content-type-options", "x-request-id"}
PAGE_HEADERS = ("access-control-",)  # headers of answers to pages whose origin is in --cors-origin
# Codes of the problems for requests that match no operation, by status.
NOWHERE = {400: "invalid_request", 401: "unauthorized", 403: "forbidden", 404: "not_found", 405: "method_not_allowed", 429: "rate_limited"}
NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")  # a number in a header
THIN = 8  # a quick check covers this number of items of each long array
THIN_BYTES = 1 << 20  # larger bodies are not checked in a quick check


def resolved(document, item):
    """Returns the item that a reference within the document stands for."""
    while isinstance(item, dict) and "$ref" in item:
        node = document
        for part in item["$ref"][2:].split("/"):
            node = node[part.replace("~1", "/").replace("~0", "~")]
        item = node
    return item


def thinned(value):
    """Returns the value with a sample of the items of each long array, so that a check takes little
    time."""
    if isinstance(value, dict):
        return {key: thinned(item) for key, item in value.items()}
    if isinstance(value, list):
        return [thinned(item) for item in value[:: -(-len(value) // THIN) or 1]]
    return value


def checked(node, optional):
    """Returns a copy of a schema. In the copy, objects allow no undocumented members, and do not
    require the members that `optional` names."""
    if isinstance(node, list):
        return [checked(item, optional) for item in node]
    if not isinstance(node, dict):
        return node
    copy = {key: checked(value, optional) for key, value in node.items()}
    if isinstance(node.get("properties"), dict) and "type" in node:
        copy.setdefault("additionalProperties", False)
        copy["required"] = [name for name in node.get("required", ()) if name not in optional]
    return copy


def shown(document, content):
    """Yields the values of the examples that a media type or a parameter has in the contract."""
    if "example" in content:
        return [content["example"]]
    return [resolved(document, example)["value"] for example in content.get("examples", {}).values()]


class Operation:
    """A method of a path. `codes` are the problems of each status; the responses' descriptions name
    them between backticks."""

    def __init__(self, document, path, method, item, operation):
        self.path, self.method, self.name = path, method, operation["operationId"]
        self.tags = operation["tags"]
        self.parameters = [resolved(document, each) for each in (*item.get("parameters", ()), *operation.get("parameters", ()))]
        self.body = resolved(document, operation.get("requestBody"))
        self.responses = {status: resolved(document, response) for status, response in operation["responses"].items()}
        self.security = operation.get("security")
        known = document["components"]["schemas"]["Problem"]["properties"]["code"]["enum"]
        self.codes = {int(status): [word for word in re.findall(r"`(\w+)`", response["description"]) if word in known]
                      for status, response in self.responses.items() if status.isdigit() and int(status) >= 400}

    def __repr__(self):
        return f"{self.method.upper()} {self.path}"

    def response(self, status):
        return self.responses.get(str(status)) or self.responses.get("default")

    @property
    def success(self):
        """Returns the first status that is neither a problem nor a job."""
        return min(int(status) for status in self.responses if status.isdigit() and status[0] == "2" and status != "202")

    def words(self, name):
        """Returns the allowed words of a query parameter, or of the items of its list."""
        schemas = [parameter["schema"] for parameter in self.parameters if parameter["in"] == "query" and parameter["name"] == name]
        return [word for schema in schemas for word in schema.get("items", schema).get("enum", ())]

    def left_out(self, target):
        """Returns the names of the members that the answer may lack because of `select`. Each line
        of a body of `queries` has its own `select`."""
        return tuple(self.words("select")) if re.search(r"(?:^|&)(?:select|fields)=", target.partition("?")[2]) else ()

    def examples(self, document):
        """Yields (media type, bytes) of each example of a request body."""
        for kind, content in (self.body or {}).get("content", {}).items():
            for value in shown(document, content):
                yield kind, (value if isinstance(value, str) else json.dumps(value)).encode()


class Contract:
    def __init__(self, document):
        self.document = document
        self.operations = [Operation(document, path, method, item, item[method])
                           for path, item in document["paths"].items() for method in METHODS if method in item]
        # paths with few parameters come first, so that a path with a literal name is found before a
        # path with a parameter in its place
        self.paths = sorted({each.path for each in self.operations}, key=lambda path: path.count("{"))
        self.patterns = [(path, re.compile(re.sub(r"\{\w+\}", "[^/]+", path))) for path in self.paths]
        self.by_place = {(each.path, each.method): each for each in self.operations}
        self.names_of_fields = tuple(sorted({word for each in self.operations for word in each.words("select")}))
        self.schemas, self.roots = {}, {}

    def operation(self, method, target):
        """Returns the operation of a request, or None. HEAD matches the operations of GET."""
        path = urllib.parse.unquote(target.partition("?")[0])
        found = next((each for each, pattern in self.patterns if pattern.fullmatch(path)), None)
        method = method.lower()
        return self.by_place.get((found, method)) or (self.by_place.get((found, "get")) if method == "head" else None)

    def invalid(self, value, schema, place, optional=()):
        """Yields the faults of a value. `optional` are the names of members that may be missing."""
        from jsonschema import exceptions
        key = json.dumps(schema, sort_keys=True) + " ".join(optional)
        if key not in self.schemas:
            self.schemas[key] = self.root(optional).evolve(schema=checked(schema, optional))
        error = exceptions.best_match(self.schemas[key].iter_errors(value))
        if error:
            where = "/".join(str(part) for part in error.absolute_path)
            yield f"{place}: at /{where} {error.message[:300]}"

    def root(self, optional):
        """Returns a validator that has all schemas of the contract. A validator that evolves from
        it resolves references in them; a copy of all schemas for each validator takes seconds."""
        from jsonschema import Draft202012Validator
        if optional not in self.roots:
            schemas = {"components": {"schemas": self.document["components"]["schemas"]}}
            self.roots[optional] = Draft202012Validator(checked(schemas, optional))
        return self.roots[optional]

    def faults(self, method, target, answer, is_thin=False):
        """Yields sentences, each of which describes a difference between an answer and the
        contract."""
        operation = self.operation(method, target)
        place = f"{method} {target[:120]} -> {answer.status}"
        if operation is None:
            return list(self.faults_of_nowhere(method, answer, place))
        response = operation.response(answer.status)
        if response is None:
            return [f"{place}: {operation.name} does not document that status ({answer.body[:200]!r})"]
        return [*self.faults_of_headers(response, answer, place), *self.faults_of_body(operation, response, method, target, answer, place, is_thin)]

    def shown_answers(self, operation, answer):
        """Returns the example documents that the contract has for such an answer."""
        content = operation.response(answer.status).get("content", {}).get("application/json", {})
        return shown(self.document, content) if answer.headers.get("Content-Type") == "application/json" else []

    def faults_of_examples(self, operation):
        """Checks that the examples of an operation match its schemas."""
        for parameter in operation.parameters:
            for value in shown(self.document, parameter):
                yield from self.invalid(value, parameter["schema"], f"{operation}: the example of {parameter['name']}")
        for place, item in [("request", operation.body or {}), *operation.responses.items()]:
            for kind, content in item.get("content", {}).items():
                # examples of NDJSON lines, one of which is wrong
                for value in shown(self.document, content) if "contentSchema" not in content.get("schema", {}) else ():
                    yield from self.invalid(value, content["schema"], f"{operation}: the example of {place}, {kind}")

    def faults_of_nowhere(self, method, answer, place):
        if answer.status < 400:
            if answer.status not in (200, 204, 304):
                yield f"{place}: no path of the contract, and an answer"
        elif method != "HEAD":
            yield from self.invalid(answer.json, PROBLEM, place)
            if answer.json.get("code") != NOWHERE.get(answer.status):
                yield f"{place}: no path of the contract answers {answer.json.get('code')}"

    def faults_of_headers(self, response, answer, place):
        documented = {name.lower(): resolved(self.document, header) for name, header in response.get("headers", {}).items()}
        sent = {name.lower(): value for name, value in answer.headers.items()}
        for name in sent:
            if name not in documented and name not in COMMON_HEADERS and not name.startswith(PAGE_HEADERS):
                yield f"{place}: the header {name} is not documented"
        for name, header in documented.items():
            if name not in sent:
                if header.get("required", True):
                    yield f"{place}: the header {name} is missing"
                continue
            kind = {"integer": int, "number": float}.get(header["schema"].get("type"))
            value = kind(sent[name]) if kind and NUMBER.fullmatch(sent[name]) else sent[name]
            yield from self.invalid(value, header["schema"], f"{place}: header {name}")

    def faults_of_body(self, operation, response, method, target, answer, place, is_thin):
        if method == "HEAD" or answer.status in (204, 304) or "content" not in response:
            if answer.body:
                yield f"{place}: a body where none is documented ({answer.body[:100]!r})"
            return
        kind = (answer.headers.get("Content-Type") or "").partition(";")[0]
        content = response["content"].get(kind, response["content"].get("*/*"))
        if content is None:
            yield f"{place}: {kind} is not documented, {', '.join(response['content'])} is"
            return
        yield from self.faults_of_content(operation, content.get("schema", {}), kind, target, answer, place, is_thin)

    def faults_of_content(self, operation, schema, kind, target, answer, place, is_thin):
        body = gzip.decompress(answer.body) if answer.headers.get("Content-Encoding") == "gzip" else answer.body
        if is_thin and len(body) > THIN_BYTES:
            return
        optional = operation.left_out(target)
        if kind in JSON_TYPES:
            values = [json.loads(body)]
        elif kind == "application/x-ndjson":
            values, schema = [json.loads(line) for line in body.splitlines()], schema["contentSchema"]
            optional = self.names_of_fields
        elif kind.startswith("text/"):
            values = [body.decode()]
        else:
            return
        for value in thinned(values) if is_thin else values:
            yield from self.invalid(value, schema, place, optional)
        if kind == "application/problem+json":
            yield from self.faults_of_problem(operation, values[0], answer, place)
        elif schema == {"$ref": "#/components/schemas/Job"}:
            yield from self.faults_of_job(values[0], place)

    def faults_of_problem(self, operation, problem, answer, place):
        if problem["status"] != answer.status:
            yield f"{place}: the problem says {problem['status']}"
        documented = operation.codes.get(answer.status)
        if documented is not None and problem["code"] not in documented:
            yield f"{place}: {operation.name} documents {documented}, not {problem['code']} ({problem['detail']})"

    def faults_of_job(self, job, place):
        """Checks that the result of a job is an answer that the contract documents for the
        operation."""
        if "result" not in job or "response" not in job:
            return
        operation = self.operation(*job["request"].split(" ", 1))
        response = operation.response(job["response"]["status"])
        content = (response or {}).get("content", {}).get(job["response"]["media_type"])
        if content is None:
            yield f"{place}: {operation.name} does not document the job's {job['response']['status']} {job['response']['media_type']}"
        elif job["response"]["media_type"] in JSON_TYPES:
            # a job's `request` lacks the query string
            yield from self.invalid(thinned(job["result"]), content["schema"], f"{place}, the job's result", tuple(operation.words("select")))


@functools.cache
def load():
    with open(DOCUMENT, encoding="utf-8") as file:
        return Contract(members.expand(yaml.load(file, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))))
