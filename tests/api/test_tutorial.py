"""Runs the tutorial's commands, and opens its page in a browser, where the page must draw the
map."""
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import unittest

from harness import PROGRAM

TUTORIAL = pathlib.Path(__file__).resolve().parents[2] / "server/doc/guide/tutorial.md"
# `make setup-test` unpacks this browser
UNPACKED = str(TUTORIAL.parents[3] / "build/chromium/usr/lib/chromium/chromium-headless-shell")
BROWSERS = (UNPACKED, "chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
PREAMBLE = 'set -euo pipefail; curl() { command curl --silent --show-error --fail-with-body --max-time 60 "$@"; echo; }\n'
BROWSE = ["--headless", "--no-sandbox", "--disable-gpu", "--timeout=60000", "--virtual-time-budget=60000", "--dump-dom"]


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)


class Tutorial(unittest.TestCase):
    """The commands run in one shell, which ends with its daemon and its web server."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.daemon, self.web = free_ports(2)
        (self.folder / "build").symlink_to(PROGRAM.parent)
        page, = blocks("html")
        (self.folder / "map.html").write_text(self.adapted(page), encoding="utf-8")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def adapted(self, text):
        """Returns the text with free ports instead of 8080 and 8000."""
        text = text.replace("build/geodesicd", f"build/geodesicd --listen 127.0.0.1:{self.daemon}")
        return text.replace("localhost:8080", f"localhost:{self.daemon}").replace("8000", str(self.web))

    def browse(self):
        """Returns a command that prints the document once its scripts are done."""
        browser = next(filter(None, map(shutil.which, BROWSERS)), None)
        if not browser:
            return "true"
        profile = f"--user-data-dir={self.folder / 'profile'}"
        return " ".join([browser, *BROWSE, profile, f"http://localhost:{self.web}/map.html", "2>browser.log"])

    def test_commands_and_page(self):
        script = PREAMBLE + "trap 'kill $(jobs -p)' EXIT\n" + self.adapted("\n".join(blocks("sh"))) + f"\nsleep 1\n{self.browse()}\n"
        done = subprocess.run(["bash", "-c", script], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=240,
                              env={**os.environ, "GEODESICD_LOG_LEVEL": "error"})
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])
        self.assertIn('{"status":"ok"}', done.stdout)
        self.assertIn('"vertices":4608,"faces":9216', done.stdout)
        if "map.html" in self.browse():
            self.assertRegex(done.stdout, r"Source: vertex 0\. Greatest distance: [1-9]\d*\.\d{4}\.")


if __name__ == "__main__":
    unittest.main()
