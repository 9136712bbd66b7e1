"""Tests the contract's examples against the daemon: each documented request works unchanged, and
gets a documented answer.

A new operation is tested if its parameters and its body have examples. contract_scene.py describes
the surfaces that the examples must use.
"""
import json
import re
import unittest
import urllib.parse

import contract
import generate
from contract_scene import Scene, send
from harness import TestCase

# Members that differ between runs or machines.
VOLATILE = {"created", "build_ms", "bytes", "memory_bytes", "fields_cached", "id", "etag"}
CLOSE = 1e-12
# Operations whose answers differ from their examples, because they contain figures of the daemon, a
# name that the daemon has made, or a state.
NOT_REPEATED = {"get_service", "create_mesh", "create_nurbs", "create_subdivision", "list_jobs", "get_job", "get_readyz"}


def differences(shown, answered, place=""):
    """Yields the places where an answer differs from the contract's example."""
    if isinstance(shown, dict) and isinstance(answered, dict):
        for key in sorted(shown.keys() | answered.keys()):
            if key not in shown or key not in answered:
                yield f"{place}/{key}: only {'in the answer' if key in answered else 'in the contract'}"
            elif key not in VOLATILE:
                yield from differences(shown[key], answered[key], f"{place}/{key}")
    elif isinstance(shown, list) and isinstance(answered, list) and len(shown) == len(answered):
        for index, pair in enumerate(zip(shown, answered)):
            yield from differences(*pair, f"{place}/{index}")
    elif isinstance(shown, (int, float)) and isinstance(answered, (int, float)) and not isinstance(shown, bool):
        if abs(shown - answered) > CLOSE:
            yield f"{place}: {shown} in the contract, {answered} in the answer"
    elif shown != answered:
        yield f"{place}: {str(shown)[:100]} in the contract, {str(answered)[:100]} in the answer"


def objects(node):
    """Yields every object of a JSON document."""
    if isinstance(node, dict):
        yield node
    for item in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from objects(item)


class Examples(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.contract = contract.load()
        cls.scene = Scene(cls.daemon, cls.contract)

    def each(self, check):
        """Checks each operation on a daemon that has all surfaces that the operation needs."""
        for operation in self.contract.operations:
            with self.subTest(operation=operation.name):
                self.scene.fill()
                check(operation)

    def right(self, operation, ask):
        """Returns the answer; asserts that it is a success and as documented."""
        answer = send(self.daemon, ask)
        self.assertIn(answer.status, (200, 201, 204), f"{ask}: {answer}")
        self.assertEqual(self.contract.faults(ask.method, ask.target, answer), [])
        return answer

    def test_every_operation_has_examples_for_a_request(self):
        def check(operation):
            if operation.body:
                self.assertTrue(list(operation.examples(self.contract.document)), f"give the request body of {operation} an example")
            for parameter in operation.parameters:
                if parameter.get("required"):
                    self.assertIn("example", parameter, f"give the parameter {parameter['name']} of {operation} an example")

        self.each(check)

    def test_documented_requests_work(self):
        self.each(lambda operation: [self.right(operation, ask) for ask in self.scene.asks(operation)])

    def test_documented_answers_are_given(self):
        def check(operation):
            if operation.name in NOT_REPEATED or operation.method == "delete":
                return
            answer = self.right(operation, self.scene.ask(operation, optional=False))
            for shown in self.contract.shown_answers(operation, answer):
                self.assertEqual(list(differences(shown, answer.json)), [])

        self.each(check)

    def test_examples_fit(self):
        faults = [fault for operation in self.contract.operations for fault in self.contract.faults_of_examples(operation)]
        self.assertEqual(faults, [])

    def test_every_media_type_can_be_requested(self):
        def check(operation):
            if operation.method in ("delete", "head"):
                return
            for kind in operation.response(operation.success)["content"]:
                if kind != "*/*":
                    answer = self.right(operation, self.scene.ask(operation).plus(Accept=kind))
                    self.assertEqual(answer.headers["Content-Type"].partition(";")[0], kind)

        self.each(check)

    def test_every_field_can_be_selected(self):
        """`select` accepts each listed name and no other name. `geometry` accepts each listed
        word."""
        def check(operation):
            for name in ("select", "geometry"):
                for word in operation.words(name):
                    self.right(operation, self.scene.ask(operation).plus(query=f"{name}={word}"))
                if operation.words(name):
                    ask = self.scene.ask(operation).plus(query=f"{name}=no_such")
                    self.assertEqual(send(self.daemon, ask).status, 400, ask)

        self.each(check)

    def test_booleans_of_queries(self):
        """A parameter that accepts true and false is described as a boolean, and accepts nothing
        else."""
        def check(operation):
            for parameter in operation.parameters:
                name, schema = parameter["name"], parameter["schema"]
                self.assertFalse({"true", "false"} & set(schema.get("enum", ())), name)
                if parameter["in"] != "query" or schema.get("type") != "boolean":
                    continue
                seen.add(name)
                ask = self.scene.ask(operation)
                ask = ask._replace(target="&".join(part for part in re.split("[?&]", ask.target) if not part.startswith(f"{name}=")).replace("&", "?", 1))
                ask = ask.plus(query="format=obj") if name == "mesh" else ask
                for word in ("true", "false"):
                    self.right(operation, ask.plus(query=f"{name}={word}"))
                for word in ("1", "True", "yes", ""):
                    answer = send(self.daemon, ask.plus(query=f"{name}={word}"))
                    self.assertEqual((answer.status, answer.json.get("parameter")), (400, name))

        seen = set()
        self.each(check)
        self.assertGreaterEqual(seen, {"arcs", "edges", "legend", "mesh", "triangulate"})

    def test_indices_have_no_leading_zeros(self):
        """The pattern of a parameter rejects such indices, as the daemon does."""
        def check(operation):
            for parameter in operation.parameters:
                pattern = contract.resolved(self.contract.document, parameter["schema"]).get("pattern", "")
                shown = str(parameter.get("example", ""))
                wrong = re.sub(r"(?<![\d.])\d+(?![\d.])", r"0\g<0>", shown)
                if parameter["in"] != "query" or "[0-9]" not in pattern or wrong == shown:
                    continue
                seen.add(parameter["name"])
                self.assertNotRegex(wrong, pattern)
                ask = self.scene.ask(operation)
                target = ask.target.replace(*(f"{parameter['name']}={urllib.parse.quote(value, safe=':,')}" for value in (shown, wrong)))
                answer = send(self.daemon, ask._replace(target=target))
                self.assertEqual((answer.status, answer.json.get("parameter")), (400, parameter["name"]))

        seen = set()
        self.each(check)
        self.assertGreaterEqual(seen, {"from", "to", "via", "edge", "size"})

    def test_the_daemon_publishes_the_contract(self):
        published = self.daemon.get("/openapi.json").json
        own = generate.published(json.loads(json.dumps(self.contract.document)))
        self.assertEqual(published["components"], own["components"])
        self.assertEqual(published["info"], own["info"])
        for path, item in own["paths"].items():
            for method in contract.METHODS:
                if method in item:
                    item[method]["security"] = published["paths"][path][method].get("security")
        self.assertEqual(published["paths"], own["paths"])


    def test_enumerations_of_strings_hold_strings(self):
        """A YAML 1.1 parser reads the unquoted word `off` as false."""
        schemas = [value for value in objects(self.daemon.get("/openapi.json").json) if value.get("type") == "string" and "enum" in value]
        self.assertEqual([schema for schema in schemas if not all(isinstance(word, str) for word in schema["enum"])], [])
        self.assertTrue(any("off" in schema["enum"] for schema in schemas))

    def test_references_name_components(self):
        """Some code generators reject a reference that leads into a schema."""
        references = {value["$ref"] for value in objects(self.daemon.get("/openapi.json").json) if isinstance(value.get("$ref"), str)}
        self.assertEqual([reference for reference in references if reference.count("/") != 3], [])


class Checker(unittest.TestCase):
    """Tests that the checker detects faults. An answer that agrees with the contract must violate a
    slightly changed copy of the contract."""

    POINT = b'{"face":0,"barycentric":[1,0,0],"xyz":[0,0,0],"vertex":0}'
    ANSWER = b'{"distance":1,"from":' + POINT + b',"to":' + POINT + b"}"
    TARGET = "/v1/meshes/x/distance?from=v:0&to=v:1"

    class Answer:
        status, headers, body = 200, {"Content-Type": "application/json", "ETag": '"x"'}, b""
        json = property(lambda self: json.loads(self.body))

    def faults(self, change=lambda document: None, body=ANSWER, status=200, headers=(), target=TARGET):
        document = json.loads(json.dumps(contract.load().document))
        change(document)
        answer = self.Answer()
        answer.status, answer.body, answer.headers = status, body, {**self.Answer.headers, **dict(headers)}
        return contract.Contract(document).faults("GET", target, answer)

    def test_correct_answers_have_no_fault(self):
        self.assertEqual(self.faults(), [])

    def test_an_undocumented_member_is_a_fault(self):
        self.assertRegex(self.faults(body=self.ANSWER.replace(b'"distance":1', b'"distance":1,"colour":2'))[0], "colour")
        self.assertRegex(self.faults(lambda document: document["components"]["schemas"]["PointAnswer"]["properties"].pop("vertex"))[0], "vertex")

    def test_a_type(self):
        self.assertRegex(self.faults(body=self.ANSWER.replace(b'"distance":1', b'"distance":"1"'))[0], "/distance")

    def test_a_required_member(self):
        """`select` omits members of the answer itself, never members of the points in it."""
        projected = self.TARGET + "&select=distance,from"
        for body in (b'{"distance":1}', b'{"distance":1,"from":' + self.POINT + b"}"):
            self.assertRegex(self.faults(body=body)[0], "required")
            self.assertEqual(self.faults(body=body, target=projected), [])
        self.assertRegex(self.faults(body=b'{"distance":1,"from":{"xyz":[0,0,0]}}', target=projected)[0], "required")

    def test_a_status(self):
        self.assertRegex(self.faults(status=299)[0], "status")

    def test_a_code(self):
        problem = {"type": "urn:geodesicd:problem:conflict", "title": "Conflict", "status": 400, "detail": "x", "code": "conflict"}
        self.assertRegex(self.faults(status=400, body=json.dumps(problem).encode(), headers={"Content-Type": "application/problem+json", "ETag": None}.items())[-1],
                         "conflict")

    def test_headers(self):
        self.assertRegex(self.faults(headers={"X-Colour": "red"}.items())[0], "x-colour")
        self.assertRegex(self.faults(headers={"Content-Type": "text/html"}.items())[0], "text/html")
