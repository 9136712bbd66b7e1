"""Query strings of operations as structs, in C, from the contract.

For each operation of QUERIES the generator makes `struct proto_<operation>_query`, and a function
that reads it. Beside a parameter, `x-refusal` is the sentence for a number outside its limits, and
`x-unchecked: true` leaves the limits of an integer to C.
"""
from document import operations, parameters
from members import c_string, snake, upper

QUERIES = ("list_meshes", "create_mesh", "get_mesh_content", "get_isolines", "get_cut_locus", "get_picture_png", "create_nurbs", "create_subdivision", "get_batch_results")
# parameters that all queries share (proto/http/options.h), and `format` of an answer
SKIPPED = {"select", "fields", "geometry", "timeout_ms"}


class Parameter:
    def __init__(self, document, parameter):
        self.name, self.schema, self.refusal = parameter["name"], parameter["schema"], parameter.get("x-refusal")
        self.is_unchecked, self.default = parameter.get("x-unchecked", False), self.schema.get("default")
        self.component = next((name for name, each in document["components"]["parameters"].items() if each is parameter), None)
        self.kind = "choice" if "enum" in self.schema else {"integer": "integer", "boolean": "flag", "number": "number"}.get(self.schema.get("type"), "text")
        if self.kind == "text":
            self.default = None

    @property
    def has_flag(self):
        return self.default is None and self.kind not in ("flag", "text")

    def declarations(self):
        words = f" /* PROTO_{upper(self.component)}_… */" if self.kind == "choice" else ""
        kind = {"choice": "unsigned ", "integer": "uint64_t ", "flag": "bool ", "number": "double ", "text": "const char *"}[self.kind]
        note = " /* borrowed; NULL: not given */" if self.kind == "text" else words
        return [f"bool has_{self.name};"] * self.has_flag + [f"{kind}{self.name};{note}"]

    def statements(self):
        """Returns the statements that set the default and the flag."""
        lines = []
        if self.kind == "text":
            lines.append(f"query.{self.name} = proto_parameters_get(parameters, {c_string(self.name)});")
        elif self.kind == "choice" and self.default is not None:
            lines.append(f"query.{self.name} = PROTO_{upper(self.component)}_{upper(self.default)};")
        elif self.default is not None:
            lines.append(f"query.{self.name} = {str(self.default).lower()};")
        if self.has_flag:
            lines.append(f"query.has_{self.name} = proto_parameters_get(parameters, {c_string(self.name)}) != NULL;")
        return lines

    def call(self):
        """Returns the call that reads the value, or None."""
        start, end = f"proto_parameters_{self.kind}(parameters, {c_string(self.name)}, ", f"&query.{self.name}, problem)"
        if self.kind == "text":
            return None
        if self.kind == "choice":
            return f"{start}proto_{snake(self.component)}_words, {end}"
        if self.kind == "flag":
            return start + end
        least, most = self.schema.get("minimum", 0), self.schema.get("maximum", "INT64_MAX")
        if self.kind == "integer":
            return f"{start}{0 if self.is_unchecked else least}, {0xFFFFFFFF if self.is_unchecked else most}, {end}"
        is_above = "exclusiveMinimum" in self.schema
        rule = f"{{.name = {c_string(self.name)}, .is_above = {str(is_above).lower()}, .least = {self.schema.get('exclusiveMinimum', least)}, .most = INFINITY, .refusal = {c_string(self.refusal)}}}"
        return f"proto_parameters_number(parameters, &(struct proto_rule){rule}, {end}"


def query_strings(document):
    """Yields (operation, parameters) of each operation of QUERIES."""
    for _, item, _, operation in operations(document):
        name = operation["operationId"]
        if name in QUERIES:
            listed = [each for each in parameters(document, item, operation) if each["in"] == "query" and not each.get("deprecated")]
            skipped = SKIPPED | ({"format"} if "queries" in operation["tags"] else set())
            yield name, [Parameter(document, each) for each in listed if each["name"] not in skipped]


def signature(name):
    return f"bool proto_{name}_query_parse(const struct proto_parameters *parameters, struct proto_{name}_query *out,\n    struct proto_problem *problem)"


def query_header(document):
    yield "/* Made by generate.py from openapi.yaml: parameters of query strings. Each function checks only the\n * parameters that it reads. */\n#pragma once\n"
    yield '#include "proto/http/options.h"\n'
    for name, listed in query_strings(document):
        yield f"struct proto_{name}_query {{"
        yield from (f"    {line}" for parameter in listed for line in parameter.declarations())
        yield f"}};\n{signature(name)};\n"


def query_source(document):
    yield '/* Made by generate.py from openapi.yaml. */\n#include "generated/queries.h"\n\n#include <math.h>\n'
    for name, listed in query_strings(document):
        yield f"{signature(name)}\n{{\n    struct proto_{name}_query query = {{0}};"
        yield from (f"    {line}" for parameter in listed for line in parameter.statements())
        calls = " &&\n              ".join(call for call in (parameter.call() for parameter in listed) if call)
        yield f"    bool ok = {calls};\n    if (ok) *out = query;\n    return ok;\n}}\n"
