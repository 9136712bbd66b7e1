"""Lints the contract by a linter of another project.

The linter is an npm package: `make contract-generators` installs it below the build's directory.
Without this package or without node, the test is skipped.
"""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import contract
from harness import PROGRAM

LINTER = PROGRAM.parent / "generators"
SCRIPT = pathlib.Path(__file__).with_name("contract_lint.mjs")


@unittest.skipUnless(shutil.which("node") and (LINTER / "complete").exists(), "needs node and `make contract-generators`")
class Lint(unittest.TestCase):
    def lint(self, document):
        done = subprocess.run(["node", SCRIPT, LINTER / "node_modules", document], capture_output=True, text=True, timeout=120, check=True)
        return done.stdout

    def test_no_fault_is_found(self):
        self.assertEqual(self.lint(contract.DOCUMENT), "")

    def test_a_fault_is_found(self):
        """The fault is an unquoted description with a comma in a flow mapping. YAML ends the
        description at the comma."""
        text = contract.DOCUMENT.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as place:
            wrong = pathlib.Path(place) / "openapi.yaml"
            wrong.write_text(text.replace("{description: 'The field is deleted, and its memory is free.'}", "{description: The field is deleted, and its memory is free.}"))
            self.assertIn("and its memory is free", self.lint(wrong))
