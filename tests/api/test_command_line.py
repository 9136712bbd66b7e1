"""Tests the command-line client: the scenario, its output, and its shell completion."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import scenario
from harness import SQUARE, TestCase

PROGRAM = scenario.CLIENTS / "cli" / "geodesic"


class CommandLine(TestCase):
    def geodesic(self, *arguments, status=0, **options):
        environment = {**os.environ, "GEODESICD_URL": "http://" + self.daemon.address}
        done = subprocess.run([PROGRAM, *map(str, arguments)], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60, **options)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr if status else done.stdout

    def upload(self, name, text):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            with open(path, "w") as file:
                file.write(text)
            return self.geodesic("upload", path)

    def run_step(self, step):
        status = 1 if "problem" in step else 0
        if "upload" in step:
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, step["upload"])
                arrays = step.get("arrays", {"vertices": [], "faces": []})
                rows = [("v", *row) for row in arrays["vertices"]] + [("f", *(corner + 1 for corner in row)) for row in arrays["faces"]]
                with open(path, "w") as file:
                    file.write(step.get("file") or "".join(" ".join(map(str, row)) + "\n" for row in rows))
                edits = [word for edit, number in step.get("edits", {}).items() for word in (f"--{edit}", number)]
                return self.geodesic("upload", path, "--json", *edits, status=status)
        if "delete" in step:
            return self.geodesic("delete", step["delete"]) or "null"
        if "derive" in step:
            return self.geodesic("derive", "scenario", step["derive"], *map(json.dumps, step["operations"]), "--json", status=status)
        if "split" in step:
            printed = self.geodesic("derive", "scenario", step["split"], *map(json.dumps, step["operations"]), "--split", "--json")
            return json.dumps(json.loads(printed)["meshes"])
        if "preview" in step:
            return json.dumps(self.geodesic("preview", step["preview"], "--faces", step["faces"], errors="replace")[:4])
        if step.get("call") == "matrix":
            return self.geodesic("matrix", step["mesh"], *step["sources"], "--targets", *step["targets"], "--json", status=status)
        if step.get("call") == "field":
            rows = self.geodesic("field", step["mesh"], *step["sources"]).splitlines()[1:]
            return json.dumps([float(row.split(",")[1]) for row in rows])
        return self.geodesic("query", "scenario", step["query"], "-", status=status, input=json.dumps(step["body"]))

    def test_scenario(self):
        for step in scenario.STEPS:
            with self.subTest(step=step):
                printed = self.run_step(step)
                if "problem" in step:
                    self.assertRegex(printed, r"^geodesic: \w[^{}]*\n$")
                else:
                    scenario.check(self, json.loads(printed), step.get("expect"))

    def test_the_output_of_each_command(self):
        self.assertIn("faces: 2", self.upload("square.obj", SQUARE.decode()))
        self.assertRegex(self.geodesic("list"), r"name +vertices +faces.*\n(.*\n)*square +4 +2 ")
        self.assertEqual(self.geodesic("distance", "square", "v:0", "v:2"), "1.4142135623730951\n")
        self.assertEqual(self.geodesic("distance", "square", 1, "v:3", "--via", "0"), "2\n")
        self.assertEqual(self.geodesic("path", "square", "v:0", "v:1"), "0 0 0\n1 0 0\n")
        self.assertEqual(self.geodesic("path", "square", "v:0", "v:1", "--obj"), "v 0 0 0\nv 1 0 0\nl 1 2\n")
        self.assertEqual(len(self.geodesic("path", "square", "v:0", "v:2", "--format", "csv").splitlines()), 3)
        self.assertEqual(len(self.geodesic("field", "square", "v:0", "--format", "csv").splitlines()), 5)
        self.assertEqual(self.geodesic("field", "square", "v:0", "v:1"), "vertex,distance\n0,0.0\n1,0.0\n2,1.0\n3,1.0\n")
        self.assertRegex(self.geodesic("matrix", "square", "v:0", "v:1"), r"^ +v:0 +v:1\nv:0 +0.0 +1.0\nv:1 +1.0 +0.0\n$")
        self.assertIn("vertex: 2", self.geodesic("nearest", "square", "p:2,2,0"))
        self.assertIn("f 1 2 3", self.geodesic("download", "square"))
        self.assertIn("state", self.geodesic("jobs"))

    def test_pictures_are_files(self):
        self.upload("drawn.obj", SQUARE.decode())
        with tempfile.TemporaryDirectory() as folder:
            for name, begins in (("a.png", b"\x89PNG"), ("a.svg", b"<svg ")):
                path = os.path.join(folder, name)
                self.geodesic("picture", "drawn", path, "--source", "v:0", "--from", "v:0", "--to", "v:2", "--via", "v:1", "--size", "90x60")
                with open(path, "rb") as file:
                    self.assertTrue(file.read().startswith(begins))
            for name, begins in (("a.png", b"\x89PNG"), ("a.svg", b"<svg "), ("a.glb", b"glTF")):
                path = os.path.join(folder, name)
                self.geodesic("figure", "drawn", path, '{"layers": [{"points": [{"vertex": 0}]}], "width": 90, "height": 60}')
                with open(path, "rb") as file:
                    self.assertTrue(file.read().startswith(begins))
        self.assertIn("/layers/0", self.geodesic("figure", "drawn", "-", '{"layers": [{"points": []}]}', status=1))
        self.assertIn("WIDTH", self.geodesic("picture", "--help"))
        self.assertIn("geodesic: ", self.geodesic("picture", "drawn", "-", "--view", "nowhere", status=1))
        self.assertEqual(json.loads(self.geodesic("show", "square", "--json"))["faces"], 2)

    def test_mistakes(self):
        self.upload("square.obj", SQUARE.decode())
        self.assertIn("there is no vertex 9", self.geodesic("distance", "square", "v:0", "v:9", status=1))
        for arguments, told in ((("distance", "square", "w:0", "v:9"), "write v:12"), (("distance", "square", 0, 1, 2), "unrecognized arguments: 2"),
                                (("distance", "square"), "required: from, to"), (("nearest", "square", 0, "--nonsense"), "unrecognized arguments: --nonsense")):
            printed = self.geodesic(*arguments, status=2)
            self.assertTrue(printed.startswith(f"usage: geodesic {arguments[0]} "), printed)
            self.assertIn(told, printed)
        self.assertIn("No such file", self.geodesic("upload", "/there/is/none", status=1))
        self.assertIn("is not JSON", self.geodesic("query", "square", "distance", "{", status=1))
        self.assertIn("usage", self.geodesic("nonsense", status=2))

    def test_lists_by_prefix(self):
        for name in ("a-1", "a-2", "b-1"):
            self.daemon.put(name, SQUARE)
        self.assertEqual([mesh["name"] for mesh in json.loads(self.geodesic("list", "--json", "--prefix", "a-"))], ["a-1", "a-2"])

    def test_batches(self):
        self.upload("square.obj", SQUARE.decode())
        body = json.dumps({"query": "all-pairs", "mesh": "square", "vertices": [0, 1, 2]})
        id = json.loads(self.geodesic("batch", body, "--json"))["id"]
        items = [json.loads(line) for line in self.geodesic("results", id, "--wait").splitlines()]
        self.assertEqual(sorted(item["item"] for item in items), [0, 1, 2])
        self.assertEqual(json.loads(self.geodesic("wait", id, "--json"))["state"], "done")
        self.assertIn(id, self.geodesic("batches"))
        job = self.daemon.request("POST", "/v1/meshes/square/distance", '{"from": {"vertex": 0}, "to": {"vertex": 2}}', {"Prefer": "respond-async"}).json["id"]
        self.assertIn('state: "done"', self.geodesic("wait", job))
        self.assertIn("no batch", self.geodesic("wait", "0" * 24, status=1))

    def test_completion(self):
        self.upload("square.obj", SQUARE.decode())
        script = 'source "$1"; COMP_WORDS=("${@:2}"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _geodesic; printf "%s\\n" "${COMPREPLY[@]}"'

        def complete(*words):
            environment = {**os.environ, "GEODESICD_URL": "http://" + self.daemon.address}
            return subprocess.run(["bash", "-c", script, "bash", PROGRAM.with_suffix(".bash"), PROGRAM, *words], env=environment, check=True,
                                  stdout=subprocess.PIPE, text=True).stdout.split()

        self.assertEqual(complete("di"), ["distance"])
        self.assertEqual(complete("distance", "sq"), ["square"])
        self.assertIn("--via", complete("path", "--"))

    def complete_by(self, shell, script, *words):
        if not shutil.which(shell):
            raise unittest.SkipTest(f"{shell} is not installed")
        environment = {**os.environ, "GEODESICD_URL": "http://" + self.daemon.address, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        done = subprocess.run([shell, "-c", script, *words], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout.split()

    def test_completion_of_fish(self):
        self.upload("square.obj", SQUARE.decode())

        def complete(line):
            return self.complete_by("fish", f"source {PROGRAM}.fish; complete -C '{line}' | string split -f 1 \\t; true")

        self.assertEqual(complete("geodesic di"), ["distance"])
        self.assertEqual(complete("geodesic --url http://nobody distance sq"), [])
        self.assertEqual(complete("geodesic distance sq"), ["square"])
        self.assertIn("--via", complete("geodesic path --"))
        self.assertIn("geodesic.fish", "".join(complete(f"geodesic upload {PROGRAM.parent}/")))

    def test_completion_of_zsh(self):
        self.upload("square.obj", SQUARE.decode())
        script = "compadd() { shift; print -l -- $@ }; _files() { print files }; words=($@); CURRENT=$#; source " + f"{PROGRAM}.zsh"

        def complete(*words):
            return self.complete_by("zsh", script, "zsh", PROGRAM, *words)

        self.assertIn("distance", complete("di"))
        self.assertIn("square", complete("distance", "sq"))
        self.assertIn("--via", complete("path", "--"))
        self.assertEqual(complete("upload", ""), ["files"])
        self.assertEqual(complete("jobs", ""), [])

    def test_manual(self):
        manual = subprocess.run([PROGRAM.parent / "manual.py", PROGRAM], check=True, stdout=subprocess.PIPE, text=True).stdout
        for line in ("split: separate the mesh where it is not manifold.", "Direction towards the viewer: auto, front,",
                     "Targets of the distances (default: the sources).", "A point: 12 or v:12"):
            self.assertIn("\n" + line.replace("-", "\\-"), manual)


if __name__ == "__main__":
    unittest.main()
