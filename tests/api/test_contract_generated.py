"""Tests the code that is generated from the contract. One change of the contract adds a member to
an answer or a request in all generated code."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import contract
from harness import PROGRAM

ROOT = contract.DOCUMENT.parents[1]
LIBRARIES = [PROGRAM.parent / f"lib{name}.a" for name in ("gd_proto", "geodesic-smooth", "geodesic-tools", "geodesic")]
INCLUDE = ["-I", ROOT / "engine" / "include", "-I", ROOT / "engine", "-I", ROOT]
# A C program that decodes the body of a request of `mean` and prints the result. It then prints a
# selection of the answer's members.
READER = r"""
#include <stdio.h>
#include <string.h>
#include "generated/requests.h"
#include "proto/http/options.h"

int main(int count, char **texts)
{
    struct proto_problem problem = {0};
    struct proto_mean_request request;
    struct proto_options options;
    const struct proto_parameter query[] = {{"select", texts[2]}, {"colour", ""}};
    const struct proto_parameters parameters = {query, 2};
    json_t *document = proto_decode_document(texts[1], strlen(texts[1]), &problem);
    if (count != 3 || !document) return 2;
    if (!proto_mean_request_decode(document, &request, &problem) ||
        !proto_options_parse(&parameters, proto_mean_fields, proto_post_mean_parameters, &options, &problem)) {
        printf("%s%s: %s", problem.pointer, problem.parameter, problem.detail);
        return 1;
    }
    printf("depth %u, skew %d", request.depth, !!(options.fields & PROTO_MEAN_FIELD_SKEW));
    return 0;
}
"""


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def changed(text, schema, line):
    """Returns the contract with one more property in a schema."""
    return re.sub(rf"(\n    {schema}:\n(?:      .*\n)*?      properties:\n)", rf"\g<1>        {line}\n", text, count=1)


class Generated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.place.cleanup)
        cls.folder = pathlib.Path(cls.place.name, "generated")
        cls.folder.mkdir()
        cls.document = pathlib.Path(cls.place.name, "openapi.yaml")
        text = contract.DOCUMENT.read_text(encoding="utf-8")
        text = changed(text, "MeanAnswer", "skew: {type: number, minimum: 0}")
        text = text.replace("      operationId: post_mean\n", "      operationId: post_mean\n      parameters: [{name: colour, in: query, schema: {type: string}}]\n")
        text = changed(text, "BoundaryLoop", "spread: {type: number}").replace("required: [vertices, length]", "required: [vertices, length, spread]")
        text = changed(text, "CurveOfVertices", "depth: {type: integer, minimum: 1, maximum: 9}")
        text = text.replace("        - $ref: '#/components/parameters/Weld'\n", "        - $ref: '#/components/parameters/Weld'\n        - {name: depth, in: query, schema: {type: integer, minimum: 1, maximum: 9}}\n")
        cls.document.write_text(changed(text, "MeanRequest", "depth: {type: integer, minimum: 1, maximum: 9, default: 4}"), encoding="utf-8")
        cls.generate("sources", cls.folder)

    @classmethod
    def generate(cls, mode, *arguments):
        return run(sys.executable, ROOT / "proto" / "generate.py", mode, cls.document, *arguments)

    def test_fields(self):
        self.assertIn("    PROTO_MEAN_FIELD_SKEW = 1 << 0,\n", (self.folder / "fields.h").read_text())
        self.assertIn('proto_mean_fields[] = {\n    "skew",\n', (self.folder / "fields.c").read_text())

    def test_routes(self):
        routes = (self.folder / "routes.c").read_text()
        row = next(line for line in routes.splitlines() if '"post_mean"' in line)
        self.assertIn(".fields = proto_mean_fields, ", row)
        self.assertIn(".parameters = proto_post_mean_parameters, ", row)
        self.assertRegex((self.folder / "parameters.c").read_text(), r'proto_post_mean_parameters\[\] = \{[^}]*"colour", NULL\};')

    def test_objects_of_answers(self):
        self.assertIn('proto_write_key(writer, "spread");\n    proto_write_number(writer, from->spread);\n', (self.folder / "answers.c").read_text())

    def test_forms(self):
        header = (self.folder / "requests.h").read_text()
        self.assertRegex(header, r"struct proto_curve \{\n    enum proto_curve_form form;\n(    .*\n)*    uint32_t depth;\n")
        self.assertRegex((self.folder / "requests.c").read_text(), r"read_curve_of_vertices(.*\n)*?.*proto_take_index\(object, &rules\[DEPTH\], &read->depth\)")

    def test_query_strings(self):
        self.assertRegex((self.folder / "queries.h").read_text(), r"struct proto_create_mesh_query \{\n(    .*\n)*    bool has_depth;\n    uint64_t depth;\n")
        self.assertIn('proto_parameters_integer(parameters, "depth", 1, 9, &query.depth, problem)', (self.folder / "queries.c").read_text())

    def test_documents(self):
        document = json.loads(self.generate("document"))
        self.assertIn("skew", document["components"]["parameters"]["MeanFields"]["schema"]["items"]["enum"])
        self.assertEqual(document["components"]["schemas"]["MeanRequest"]["properties"]["depth"]["default"], 4)
        self.assertFalse(re.search(r'"x-(?!replaced-by|deprecated-since)', json.dumps(document["components"])))

    def test_types(self):
        types = run(sys.executable, ROOT / "clients" / "js" / "generate.py", self.document)
        self.assertRegex(types, r"MeanAnswer = \{\n  skew\?: number;")
        self.assertRegex(types, r"MeanRequest = \{\n  depth\?: number;")

    @unittest.skipUnless(shutil.which("cc") and all(library.exists() for library in LIBRARIES), "needs cc and the libraries")
    def test_checks(self):
        source, program = pathlib.Path(self.place.name, "reader.c"), pathlib.Path(self.place.name, "reader")
        source.write_text(READER)
        run("cc", "-D_GNU_SOURCE", "-I", self.place.name, *INCLUDE, "-o", program, source, *(self.folder / f"{name}.c" for name in ("values", "requests", "fields", "parameters")), *LIBRARIES,
            "-ljansson", "-lstdc++", "-lz", "-lm", "-lminizip", "-lexpat", "-lOpenMeshTools", "-lOpenMeshCore", "-pthread")
        point = '"points": [{"vertex": 1}]'
        for body, fields, expected in (("{%s}" % point, "spread", "depth 4, skew 0"), ('{%s, "depth": 9}' % point, "skew", "depth 9, skew 1"),
                                       ('{%s, "depth": 10}' % point, "skew", "/depth: depth is a whole number from 1 to 9"),
                                       ('{%s, "deep": 1}' % point, "skew", '/deep: the member "deep" is unknown here; check its spelling or leave it out')):
            done = subprocess.run([program, body, fields], stdout=subprocess.PIPE, text=True)
            self.assertEqual(done.stdout, expected)


if __name__ == "__main__":
    unittest.main()
