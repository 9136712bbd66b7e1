"""Tests the Python client: with numpy's arrays, for asyncio, in notebooks, its types, and its
wheel. A part is skipped if its module is missing."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

import scenario
from harness import SQUARE, TestCase, sample

PACKAGE = scenario.CLIENTS / "python"


def python_with(module):
    """Returns an interpreter that has the module: this one, or the system's."""
    for program in (sys.executable, "/usr/bin/python3"):
        if shutil.which(program) and subprocess.run([program, "-c", f"import {module}"], stderr=subprocess.DEVNULL).returncode == 0:
            return program
    raise unittest.SkipTest(f"no python3 here has {module}")


class Scripts(TestCase):
    def run_script(self, script, module="json", hidden=()):
        text = f"""
import sys
sys.path.insert(0, {str(PACKAGE)!r})
for name in {hidden!r}:
    sys.modules[name] = None
import geodesicd
client = geodesicd.Client("http://{self.daemon.address}")
{script}"""
        done = subprocess.run([python_with(module), "-B", "-"], input=text, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout


class Arrays(Scripts):
    def test_numpy(self):
        self.run_script("""
import numpy
V, F = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], numpy.float32), numpy.array([[0, 1, 2], [0, 2, 3]])
mesh = client.upload("arrays", (V, F))
assert (mesh.describe()["vertices"], mesh.describe()["faces"]) == (4, 2)
vertices, faces = mesh.arrays()
assert (vertices == V).all() and (faces == F).all()
vertices += 1
faces[0, 0] = 2
near = lambda a, b: numpy.allclose(a, b, rtol=0, atol=1e-12)
assert near(mesh.distance(V[0], V[2]), 2**.5) and near(mesh.distance(F[0, 0], numpy.uint8(2)), 2**.5)
matrix = mesh.matrix(numpy.array([0, 1]), V)
assert near(matrix, [[0, 1, 2**.5, 1], [1, 0, 1, 2**.5]])
matrix *= 2
assert near(mesh.matrix(V[:1], [2, "v:3"]), [[2**.5, 1]])
assert near(mesh.pairs(numpy.array([0, 0]), numpy.array([1, 2])), [1, 2**.5]) and near(mesh.pairs(V[:1], V), [0, 1, 2**.5, 1])
field = mesh.field(numpy.array([0, 1]))
values = field.values()
values -= 1
assert near(values, [-1, -1, 0, 0]) and near(field.distances(V[2:]), [1, 1])
assert mesh.field(V[:2]).values().tolist() == mesh.field([0, 1]).values().tolist()
assert near(mesh.field(V[0]).values(), mesh.field(0).values())
lines = field.isoline_arrays(count=3)
assert sorted(set(lines["level"])) == [line["level"] for line in field.isolines(count=3)]
assert lines["first"][-1] == len(lines["points"]) and lines["points"].shape[1] == 3
lines["points"][:] = 0
assert len(field.isolines(numpy.array([0.5]))) == 1
assert "points" not in field.isolines(count=2, geometry="none")[0]["lines"][0]
assert len(field.isolines(0.5)) == 1
mask = numpy.array([False, False, True, False])
assert near(mesh.field(mask).values(), mesh.field(2).values())
assert near(mesh.pairs(mask, [0]), [2**.5]) and near(mesh.pairs(V[2], [0, 1]), [2**.5, 1])
assert mesh.field([0.5, 0, 1]).describe()["members"] == mesh.field(range(1)).describe()["members"] == 1
for wrong, error in (([-1], ValueError), ([2**32], ValueError), (["v:1"], TypeError)):
    try:
        mesh.pairs(wrong, [0])
        assert False, wrong
    except error:
        pass
assert client.upload("arrays", [V, F]).distance(0, 1) == 1
for wrong in ((V[:, :2], F), (V, F.astype(float)), (V, F + 2)):
    try:
        client.upload("wrong", wrong)
        assert False, wrong
    except ValueError:
        pass
for wrong in (V[:, :2], V[0, :2], numpy.array([0.5])):
    try:
        mesh.matrix(wrong, [0])
        assert False, wrong
    except ValueError:
        pass
quads = client.upload("quads", (V, numpy.array([[0, 1, 2, 3]], numpy.uint16)))
assert quads.describe()["faces"] == 2
""", "numpy")

    def test_documents(self):
        """Runs the blocks of geodesicd in the page that compares packages."""
        page = (scenario.CLIENTS.parent / "server/doc/guide/python.md").read_text()
        blocks = [block for block in re.findall(r"```python\n(.*?)```", page, re.S) if re.search(r"\bmesh\b", block)]
        self.assertEqual(len(blocks), 5)
        self.run_script("""
import numpy
V, F = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.]]), numpy.array([[0, 1, 2], [0, 2, 3]])
""" + "".join(blocks).replace("Client()", f'Client("http://{self.daemon.address}")') + """
assert (distances.shape, matrix.shape, len(path.points)) == ((4,), (2, 4), 2)
""", "numpy")

    def test_without_numpy(self):
        self.run_script("""
import array
mesh = client.upload("lists", ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
vertices, faces = mesh.arrays()
assert (list(vertices), list(faces)) == ([0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2])
assert [list(row) for row in mesh.matrix(array.array("I", [0]), array.array("d", [1, 0, 0, 0, 1, 0]))] == [[1, 1]]
mesh.field(0).values()[0] = 5
""", hidden=("numpy",))


class Waiting(Scripts):
    def test_progress_and_batches(self):
        self.daemon.put("square", SQUARE)
        for hidden in ((), ("tqdm", "tqdm.auto")):
            printed = self.run_script("""
mesh = client.mesh("square")
assert mesh.field(0, progress=True).max
batch = client.create_batch({"query": "all-pairs", "mesh": "square", "vertices": [0, 1]}).wait(progress=True)
assert batch["state"] == "done" and batch.refresh()["done"] == 2
assert len(list(batch.results())) == len(list(batch.results(wait=True))) == 2
batch.delete()
""", "json" if hidden else "tqdm", hidden)
            self.assertEqual("100 %" in printed, not hidden, printed)

    def test_asyncio(self):
        self.daemon.put("sphere", sample("icosphere", level=4))
        self.run_script(f"""
import asyncio
async def main():
    seen = []
    async with geodesicd.AsyncClient("http://{self.daemon.address}") as client:
        sphere = client.mesh("sphere")
        distances = await asyncio.gather(*(sphere.distance(0, i) for i in range(1, 40)))
        for i, distance in enumerate(distances):
            assert abs(distance - geodesicd.Client(client.transport.url).mesh("sphere").distance(0, i + 1)) < 1e-12
        loop = asyncio.get_running_loop()
        field = await sphere.field(0, progress=lambda part: seen.append((part, asyncio.get_running_loop() is loop)))
        assert field.max > 2 and len(await field.values()) == 2562 and field.mesh.name == "sphere"
        assert "sphere" in [mesh["name"] async for mesh in client.meshes()]
        batch = await client.create_batch({{"query": "all-pairs", "mesh": "sphere", "vertices": [0, 1]}})
        assert len([item async for item in batch.results(wait=True)]) == 2
        assert (await batch.wait())["state"] == "done"
        try:
            await client.mesh("nobody").describe()
            assert False
        except geodesicd.NotFound:
            pass
    await asyncio.sleep(0)
    assert seen[-1] == (1, True)
asyncio.run(main())
""")


class Notebooks(Scripts):
    SHOWN = """
mesh = client.mesh("square")
field, path = mesh.field(0), mesh.path(0, 2)
"""

    def setUp(self):
        self.daemon.put("square", SQUARE)

    def test_pictures_of_the_daemon(self):
        self.run_script(self.SHOWN + """
assert mesh._repr_html_().startswith('<figure><img alt="square: 2 faces" src="data:image/png;base64,iVBOR')
assert field._repr_html_() != mesh._repr_html_()
pictures = [mesh.show(), field.show(), mesh.show(path=path)]
assert len(set(pictures)) == 3 and all(picture._repr_png_()[:4] == b"\\x89PNG" for picture in pictures)
""", hidden=("pyvista", "plotly", "plotly.graph_objects"))

    def test_plotly(self):
        self.run_script(self.SHOWN + """
figure = mesh.show(field, path)
surface, line = figure.data
assert (surface.type, line.type) == ("mesh3d", "scatter3d") and list(surface.intensity) == field.values().tolist()
assert (len(surface.x), len(surface.i), len(line.x)) == (4, 2, len(path.points))
""", "plotly", hidden=("pyvista",))

    def test_pyvista(self):
        self.run_script("""
import types
class Plotter:
    def __init__(self): self.made = []
    def add_mesh(self, surface, scalars, cmap): self.made += [surface, scalars]
    def add_lines(self, points, color, connected): self.made.append(points)
    def show(self): return self.made
sys.modules["pyvista"] = types.SimpleNamespace(Plotter=Plotter, PolyData=lambda vertices, faces: (vertices, faces))
""" + self.SHOWN + """
(vertices, faces), scalars, points = mesh.show(field, path)
assert faces.tolist() == [3, 0, 1, 2, 3, 0, 2, 3] and scalars.tolist() == field.values().tolist() and points.shape[1] == 3
""", "numpy")


class Package(unittest.TestCase):
    def test_types(self):
        made = subprocess.run([PACKAGE / "generate.py"], check=True, stdout=subprocess.PIPE, text=True).stdout
        self.assertEqual((PACKAGE / "geodesicd" / "answers.py").read_text(), made, "run clients/python/generate.py > clients/python/geodesicd/answers.py")
        if not shutil.which("mypy"):
            raise unittest.SkipTest("mypy is not installed")
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program.py"
            program.write_text('import geodesicd\nmesh = geodesicd.Client().mesh("a")\narea: float = mesh.describe()["area"]\nmesh.describe()["aera"]\n')
            done = subprocess.run(["mypy", "--strict", "--cache-dir", folder, PACKAGE / "geodesicd", program], stdout=subprocess.PIPE, text=True)
        self.assertEqual([line for line in done.stdout.splitlines() if "error:" in line and "aera" not in line], [])
        self.assertIn("aera", done.stdout)

    def test_wheel(self):
        """Builds the wheel offline, as `pip wheel` does; installs it as a folder of files."""
        python = python_with("setuptools, wheel")
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            shutil.copytree(PACKAGE, place / "source", ignore=shutil.ignore_patterns("__pycache__"))
            for made in ("sdist", "wheel"):
                script = f"import setuptools.build_meta as backend, sys; backend.build_{made}(sys.argv[1])"
                done = subprocess.run([python, "-c", script, place], cwd=place / "source", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                self.assertEqual(done.returncode, 0, done.stdout)
            [wheel] = place.glob("*.whl")
            with zipfile.ZipFile(wheel) as archive:
                names = archive.namelist()
                [licence] = [name for name in names if name.endswith("LICENSE")]
                self.assertEqual(archive.read(licence), (scenario.CLIENTS.parent / "LICENSE").read_bytes())
                [metadata] = [archive.read(name).decode() for name in names if name.endswith("METADATA")]
                archive.extractall(place / "installed")
            self.assertIn("geodesicd/py.typed", names)
            for member in ("Name: geodesicd", "License: MIT", "Requires-Python: >=3.9", "Classifier: Typing :: Typed", "Description-Content-Type: text/markdown"):
                self.assertIn(member + "\n", metadata)
            self.assertEqual({name.partition("/")[2] for name in names if name.startswith("geodesicd/")},
                             {path.name for path in (PACKAGE / "geodesicd").iterdir() if path.is_file()})
            code = "import geodesicd; print(geodesicd.__version__)"
            subprocess.run([sys.executable, "-B", "-c", code], cwd=place / "installed", check=True, stdout=subprocess.DEVNULL)
            self.assertTrue(list(place.glob("*.tar.gz")))


if __name__ == "__main__":
    unittest.main()
