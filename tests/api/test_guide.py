"""The guide's code works as it stands there."""
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from harness import PROGRAM, TestCase

GUIDE = pathlib.Path(__file__).resolve().parents[2] / "server" / "doc" / "guide.md"
SHELL = 'set -euo pipefail; curl() { command curl --silent --show-error --fail-with-body --max-time 60 "$@"; echo >&2; }\n'


class Guide(TestCase):
    def test_the_cookbook(self):
        blocks = re.findall(r"^```sh\n(.*?)^```", GUIDE.read_text(), re.DOTALL | re.MULTILINE)
        self.assertGreater(len(blocks), 7)
        environment = {**os.environ, "G": "http://" + self.daemon.address, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        with tempfile.TemporaryDirectory() as folder:
            for block in blocks:
                with self.subTest(block=block):
                    done = subprocess.run(["bash", "-c", SHELL + block], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                          text=True, timeout=120)
                    self.assertEqual(done.returncode, 0, done.stdout)
                    self.assertNotIn('"status":4', done.stdout)
            self.assertEqual(os.path.getsize(os.path.join(folder, "distances.f64")), 8 * 96 * 48)

    def test_what_it_names_is_there(self):
        root = GUIDE.parents[2]
        for path in re.findall(r"`((?:docker|engine/doc|tests|server)/[\w./-]*)`", GUIDE.read_text()):
            self.assertTrue(list(root.glob(path + "*")) if not path.endswith("/") else (root / path).is_dir(), path)

    def test_what_it_links_is_there(self):
        links = re.findall(r"\]\(([^)#:]+)\)", GUIDE.read_text())
        self.assertGreater(len(links), 3)
        for link in links:
            self.assertTrue((GUIDE.parent / link).is_file(), link)


if __name__ == "__main__":
    unittest.main()
