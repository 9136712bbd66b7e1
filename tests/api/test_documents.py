"""Tests the documents: their commands run, their links resolve, and their tables match the
daemon."""
import html.parser
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest

from harness import PROGRAM, Daemon, TestCase

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "engine/README.md", "server/README.md", "proto/README.md",
             *(f"server/doc/guide/{name}.md" for name in ("README", "tutorial", "how-to", "reference", "explanation", "operating", "comparison", "python")))
PAGES = ("tutorial", "how-to", "reference", "explanation", "operating", "comparison", "python")
SHELL = 'set -euo pipefail; curl() { command curl --silent --show-error --fail-with-body --max-time 60 "$@"; echo >&2; }\n'


def text_of(document):
    return (ROOT / document).read_text(encoding="utf-8")


def shell_blocks(document):
    return re.findall(r"^```sh\n(.*?)^```", text_of(document), re.DOTALL | re.MULTILINE)


class HowTo(TestCase):
    def test_commands(self):
        blocks = shell_blocks("server/doc/guide/how-to.md")
        self.assertGreater(len(blocks), 20)
        environment = {**os.environ, "G": "http://" + self.daemon.address, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        with tempfile.TemporaryDirectory() as folder:
            for block in blocks:
                with self.subTest(block=block):
                    done = subprocess.run(["bash", "-c", SHELL + block], cwd=folder, env=environment, stdout=subprocess.PIPE,
                                          stderr=subprocess.STDOUT, text=True, timeout=120)
                    self.assertEqual(done.returncode, 0, done.stdout)
                    self.assertNotIn('"status":4', done.stdout)
            self.assertEqual(os.path.getsize(os.path.join(folder, "distances.f64")), 8 * 96 * 48)


class Readme(TestCase):
    """The calls of README return what README shows."""

    def test_calls(self):
        block = next(each for each in shell_blocks("README.md") if "curl" in each)
        calls = re.findall(r"^(curl .*)\n# (.*)$", block, re.MULTILINE)
        self.assertEqual(len(calls), 3)
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder) / "build" / "demo" / "genus2.obj"
            mesh.parent.mkdir(parents=True)
            mesh.write_bytes(subprocess.run([PROGRAM.parent / "gd_sample", "genus2"], check=True, stdout=subprocess.PIPE).stdout)
            upload = f"curl -T {mesh} localhost:8080/v1/meshes/demo >/dev/null; "
            for call, shown in calls:
                with self.subTest(call=call):
                    command = SHELL + (upload + call).replace("localhost:8080", self.daemon.address)
                    answer = subprocess.run(["bash", "-c", command], cwd=folder, check=True, stdout=subprocess.PIPE, text=True,
                                            timeout=60).stdout
                    for part in shown.split(" … "):
                        self.assertIn(part.rstrip(" …").rstrip("…"), answer)

    def test_links(self):
        for document in DOCUMENTS:
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text_of(document)):
                self.assertTrue((ROOT / document).parent.joinpath(link).exists(), f"{document}: {link}")


class ClientPages(TestCase):
    """The examples of the clients' pages run, in the order of the page."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.bunny = subprocess.run([PROGRAM.parent / "gd_sample", "icosphere", "level=5"], check=True, stdout=subprocess.PIPE).stdout

    def examples(self, language):
        page = {"python": "clients/python/README.md", "js": "clients/js/README.md"}[language]
        return re.findall(rf"^```{language}\n(.*?)^```", text_of(page), re.DOTALL | re.MULTILINE)

    def run_example(self, command, example, name):
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, "bunny.obj").write_bytes(self.bunny)
            pathlib.Path(folder, name).write_text(example, encoding="utf-8")
            environment = {**os.environ, "GEODESICD_URL": "http://" + self.daemon.address, "PYTHONPATH": str(ROOT / "clients/python")}
            done = subprocess.run([*command, name], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                  text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipUnless(importlib.util.find_spec("numpy"), "needs numpy")
    def test_python(self):
        basic, arrays, asynchronous, batch = self.examples("python")
        given = "import asyncio, numpy\nV, F = bunny.arrays()\nstarts, ends = numpy.arange(10), numpy.arange(10, 20)\n"
        coroutine = "async def calls():\n" + textwrap.indent(asynchronous, "    ") + "asyncio.run(calls())\n"
        self.run_example([sys.executable], basic + given + arrays + coroutine + batch, "example.py")

    @unittest.skipUnless(shutil.which("node"), "needs node")
    def test_javascript(self):
        basic, arrays, batch = [each for each in self.examples("js") if "canvas" not in each]
        arrays = arrays.replace("0, …", "0, 1, 0, 0, 0, 1, 0").replace("2, …", "2")
        given = ('import { readFile } from "node:fs/promises";\n'
                 "const starts = Uint32Array.of(0, 1), ends = Uint32Array.of(2, 3);\n")
        module = (given + basic + arrays + batch).replace('"geodesicd"', repr((ROOT / "clients/js/index.js").as_uri()))
        self.run_example(["node"], module.replace("http://127.0.0.1:8080", "http://" + self.daemon.address), "example.mjs")


class Page(html.parser.HTMLParser):
    """Collects a page's links, its anchors, the cells of its tables, and violations of its
    policy."""

    def __init__(self, text):
        super().__init__()
        self.addresses, self.anchors, self.forbidden, self.codes, self._is_code = [], set(), [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.addresses += [values[name] for name in ("href", "src", "srcset") if name in values]
        self.anchors.update(filter(None, [values.get("id")]))
        self.forbidden += [f"{tag} {name}" for name in values if name == "style" or name.startswith("on")]
        self.forbidden += [tag] if tag in ("style", "script") else []
        self._is_code = tag == "code"

    def handle_data(self, data):
        if self._is_code:
            self.codes.append(data)
        self._is_code = False


class Pages(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.pages = {f"/docs/{name}": Page(cls.daemon.get(f"/docs/{name}").body.decode()) for name in PAGES}

    def test_links_and_anchors(self):
        for path, page in self.pages.items():
            for address in filter(lambda address: "://" not in address, page.addresses):
                place, _, anchor = address.partition("#")
                with self.subTest(page=path, address=address):
                    # without the viewer, / and /docs are other pages
                    self.assertEqual(self.daemon.get(place or path).status, 200)
                    if anchor:
                        self.assertIn(anchor, self.pages[place or path].anchors)

    def test_each_document_is_linked(self):
        for path in self.pages:
            self.assertIn(path, self.daemon.get("/docs").body.decode())
            for other in self.pages:
                self.assertIn(other, self.pages[path].addresses)

    def test_policy(self):
        for path, page in self.pages.items():
            self.assertEqual(page.forbidden, [], path)
            self.assertNotIn("unsafe", self.daemon.get(path).headers["Content-Security-Policy"])

    def test_no_name_is_left_unfilled(self):
        for path in self.pages:
            self.assertNotIn("{{", self.daemon.get(path).body.decode(), path)


class Reference(TestCase):
    """Compares the tables of the page with the daemon that serves it."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.codes = Page(cls.daemon.get("/docs/reference").body.decode()).codes

    def test_flags(self):
        shown = subprocess.run([PROGRAM, "--help"], check=True, stdout=subprocess.PIPE, text=True).stdout
        flags = set(re.findall(r"^  (--[a-z-]+)", shown, re.MULTILINE))
        self.assertGreater(len(flags), 30)
        self.assertEqual(flags - set(self.codes), set())

    def test_problems(self):
        codes = self.daemon.get("/openapi.json").json["components"]["schemas"]["Problem"]["properties"]["code"]["enum"]
        self.assertEqual(set(codes) - set(self.codes), set())

    def test_metrics(self):
        made = subprocess.run([PROGRAM, "keygen", "a", "--role", "operator"], check=True, stdout=subprocess.PIPE, text=True).stdout
        key, line = made.split("\n")[:2]
        with tempfile.TemporaryDirectory() as folder:
            keys = pathlib.Path(folder, "keys")
            keys.write_text(line + "\n", encoding="utf-8")
            keys.chmod(0o600)
            with Daemon("--data-dir", folder + "/data", "--keys", str(keys)) as daemon:
                text = daemon.get("/metrics", Authorization=f"Bearer {key}").body.decode()
        metrics = set(re.findall(r"^# TYPE (\w+)", text, re.MULTILINE))
        self.assertGreater(len(metrics), 40)
        self.assertEqual(metrics, {code for code in self.codes if re.fullmatch(r"geodesicd_[a-z_]+", code)})

    def test_operations(self):
        contract = self.daemon.get("/openapi.json").json["paths"]
        current = {f"{method.upper()} {path}" for path, item in contract.items() for method, operation in item.items()
                   if isinstance(operation, dict) and "operationId" in operation and not operation.get("deprecated")}
        self.assertEqual(current, {code for code in self.codes if re.fullmatch(r"[A-Z]+ /.*", code)})


if __name__ == "__main__":
    unittest.main()
