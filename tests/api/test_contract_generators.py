"""Runs code generators of other projects on the served contract, and compiles their output
strictly.

The generators are npm packages: `make contract-generators` installs them below the build's
directory. Without these packages or without node, the test is skipped.
"""
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from harness import PROGRAM, TestCase

GENERATORS = PROGRAM.parent / "generators"
SCRIPT = pathlib.Path(__file__).with_name("contract_generate.mjs")
PATIENCE_SECONDS = 300


@unittest.skipUnless(shutil.which("node") and (GENERATORS / "complete").exists(), "needs node and `make contract-generators`")
class Generators(TestCase):
    def generate(self, generator, document):
        """Returns the exit status, the generator's output, and the TypeScript that it made."""
        with tempfile.TemporaryDirectory() as place:
            source, folder = pathlib.Path(place, "openapi.json"), pathlib.Path(place, "made")
            folder.mkdir()
            source.write_text(json.dumps(document))
            done = subprocess.run(["node", SCRIPT, GENERATORS / "node_modules", generator, source, folder], capture_output=True, text=True,
                                  timeout=PATIENCE_SECONDS)
            text = "".join(file.read_text() for file in sorted(folder.rglob("*.ts")))
            return done.returncode, done.stdout + done.stderr, text

    def check(self, generator):
        status, printed, text = self.generate(generator, self.daemon.get("/openapi.json").json)
        self.assertEqual(status, 0, printed)
        self.assertIn("DistanceAnswer", text)

    def test_openapi_typescript(self):
        self.check("openapi-typescript")

    def test_hey_api(self):
        self.check("hey-api")

    def test_orval(self):
        self.check("orval")

    def test_a_fault_is_found(self):
        document = self.daemon.get("/openapi.json").json
        path = "/v1/meshes/{name}/distance"
        document["paths"] = {path: document["paths"][path]}  # the generators are fast on one path
        document["components"]["schemas"]["DistanceAnswer"]["properties"]["from"] = {"$ref": "#/components/schemas/NoSuch"}
        for generator in ("openapi-typescript", "hey-api", "orval"):
            with self.subTest(generator=generator):
                self.assertNotEqual(self.generate(generator, document)[0], 0)
