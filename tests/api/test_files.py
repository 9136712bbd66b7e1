"""Tests answers as files for other programs: fields as PLY, GLB and CSV; paths as OBJ, GLB, CSV and
SVG; other lines as OBJ, GLB and CSV; and glTF in both directions. Also runs other programs
that read these files."""
import csv
import io
import json
import math
import pathlib
import shutil
import struct
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree
import zipfile

from arrays import read as read_arrays
from harness import PROGRAM, SQUARE, TWO_TRIANGLES, TestCase, sample

PEERS = PROGRAM.parent / "peers"
SCRIPT = pathlib.Path(__file__).with_name("gltf_peers.mjs")
SVG = "{http://www.w3.org/2000/svg}"
KINDS = {"ply": "application/x-ply", "glb": "model/gltf-binary", "csv": "text/csv", "obj": "model/obj", "svg": "image/svg+xml"}


def read_glb(body):
    """Returns the glTF document, and the numbers of each accessor as a flat list. Asserts the rules
    of the GLB container."""
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", body)
    assert (magic, version, length, kind) == (b"glTF", 2, len(body), b"JSON") and size % 4 == 0, body[:20]
    document, rest = json.loads(body[20:20 + size]), body[20 + size:]
    assert struct.unpack_from("<I4s", rest) == (len(rest) - 8, b"BIN\0") and len(rest) % 4 == 0
    binary, lists = rest[8:], []
    assert document["buffers"] == [{"byteLength": len(binary)}]
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        letter = {5123: "H", 5125: "I", 5126: "f"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        count = accessor["count"] * width
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        assert begin % 4 == 0 and begin + struct.calcsize(f"<{count}{letter}") <= view["byteOffset"] + view["byteLength"]
        lists.append(struct.unpack_from(f"<{count}{letter}", binary, begin))
        if "min" in accessor:
            assert accessor["min"] == [min(lists[-1][axis::width]) for axis in range(width)]
            assert accessor["max"] == [max(lists[-1][axis::width]) for axis in range(width)]
    return document, lists


class Files(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.put_all({"square": SQUARE, "torus": sample("torus", columns=12, rows=7), "apart": TWO_TRIANGLES})

    def get_file(self, path, form, **headers):
        answer = self.daemon.get(path + ("&" if "?" in path else "?") + f"format={form}", **headers)
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, KINDS[form]), answer)
        self.assertIn(f'.{form}"', answer.headers["Content-Disposition"])
        self.assertEqual(answer.headers["Vary"].split(",")[0], "Accept")
        return answer.body

    def values_of(self, mesh, **document):
        made = self.daemon.ask(mesh, "fields", {"set": {"points": [{"vertex": 0}]}, **document}).json
        path = f"/v1/meshes/{mesh}/fields/{made['id']}/values"
        return path, self.daemon.get(path).json["values"]


class Fields(Files):
    def test_rows_of_csv(self):
        path, values = self.values_of("torus", max_distance=0.7)
        rows = list(csv.reader(io.StringIO(self.get_file(path, "csv").decode(), newline="")))
        self.assertEqual(rows[0], ["vertex", "x", "y", "z", "distance"])
        self.assertEqual([int(row[0]) for row in rows[1:]], list(range(len(values))))
        self.assertEqual([float(row[4]) if row[4] else None for row in rows[1:]], values)
        self.assertIn(None, values)

    def test_ply_has_the_distance_at_each_vertex(self):
        path, values = self.values_of("torus")
        body = self.get_file(path, "ply")
        header, rest = body.split(b"end_header\n", 1)
        self.assertIn(b"property double z\nproperty double distance\n", header)
        self.assertEqual([struct.unpack_from("<4d", rest, 32 * i)[3] for i in range(len(values))], values)
        self.assertEqual(self.daemon.put("as-ply", body).json["area"], self.daemon.get("/v1/meshes/torus").json["area"])

    def test_glb_has_colours(self):
        path, values = self.values_of("torus")
        document, (places, corners, colours, distances) = read_glb(self.get_file(path, "glb"))
        primitive = document["meshes"][0]["primitives"][0]
        self.assertEqual(primitive["attributes"], {"POSITION": 0, "COLOR_0": 2, "_DISTANCE": 3})
        for value, distance in zip(values, distances):
            self.assertAlmostEqual(value, distance, 6)
        nearest, farthest = values.index(0), values.index(max(values))
        light = [sum(colours[4 * i:4 * i + 3]) for i in (nearest, farthest)]
        self.assertLess(light[0], light[1])
        self.assertEqual((len(places), len(corners)), (3 * len(values), 3 * self.daemon.get("/v1/meshes/torus").json["faces"]))

    def test_by_accept(self):
        path, values = self.values_of("square")
        self.assertEqual(self.daemon.get(path, Accept="text/csv").headers["Content-Type"], "text/csv")
        self.assertEqual(self.daemon.get(path, Accept="*/*").json["values"], values)
        self.assertEqual(self.daemon.get(path, Accept="application/json, model/gltf-binary").json["values"], values)
        self.assertEqual(len(self.daemon.get(path, Accept="application/octet-stream").body), 8 * len(values))
        self.assert_problem(self.daemon.get(path, Accept="image/png"), 406, "not_acceptable")
        problem = self.assert_problem(self.daemon.get(path + "?format=svg"), 400, "invalid_request")
        self.assertEqual(problem["parameter"], "format")


class Paths(Files):
    QUESTION = "/v1/meshes/torus/path?from=v:3&to=f:50:0.2,0.3,0.5"

    def path(self):
        return self.daemon.get(self.QUESTION + "&geometry=xyz").json["path"]

    def test_obj_has_a_line(self):
        path = self.path()
        lines = self.get_file(self.QUESTION, "obj").decode().splitlines()
        self.assertEqual([[float(word) for word in line.split()[1:]] for line in lines if line[0] == "v"], path["points"])
        self.assertEqual(lines[-1], "l " + " ".join(str(i + 1) for i in range(len(path["points"]))))
        both = self.get_file(self.QUESTION + "&mesh=true", "obj")
        again = self.daemon.put("with-line", both).json
        self.assertEqual(again["faces"], self.daemon.get("/v1/meshes/torus").json["faces"])

    def test_csv_has_the_length_along_the_path(self):
        path = self.path()
        rows = list(csv.DictReader(io.StringIO(self.get_file(self.QUESTION, "csv").decode(), newline="")))
        self.assertEqual([[float(row[axis]) for axis in "xyz"] for row in rows], path["points"])
        self.assertAlmostEqual(float(rows[-1]["along"]), path["length"], 12)

    def test_glb_has_a_strip_of_lines(self):
        path = self.path()
        document, lists = read_glb(self.get_file(self.QUESTION, "glb"))
        self.assertEqual([p["mode"] for p in document["meshes"][0]["primitives"]], [3])
        origin = document["nodes"][0]["translation"]
        for i, point in enumerate(path["points"]):
            for axis in range(3):
                self.assertAlmostEqual(origin[axis] + lists[0][3 * i + axis], point[axis], 6)
        document, lists = read_glb(self.get_file(self.QUESTION + "&mesh=true", "glb"))
        self.assertEqual([p.get("mode", 4) for p in document["meshes"][0]["primitives"]], [4, 3])

    def test_svg_is_the_strip_laid_flat(self):
        """In the coordinates of the SVG file the line is as long as the path. The line is straight
        where the path passes through no vertex."""
        path = self.path()
        drawing = xml.etree.ElementTree.fromstring(self.get_file(self.QUESTION, "svg"))
        group = drawing.find(f"{SVG}g")
        points = [tuple(map(float, pair.split(","))) for pair in group.find(f"{SVG}polyline").get("points").split()]
        self.assertEqual(len(points), len(path["points"]))
        self.assertAlmostEqual(sum(math.dist(a, b) for a, b in zip(points, points[1:])), path["length"], 12)
        self.assertEqual(points[0], (0, 0))
        self.assertAlmostEqual(points[-1][1], 0, 12)
        faces = group.find(f"{SVG}path").get("d").count("M")
        self.assertGreaterEqual(faces, len(points) - 1)
        self.assertIn("unit of the mesh", "".join(drawing.itertext()))

    def test_by_post_and_via_other_points(self):
        document = {"from": {"vertex": 0}, "to": {"vertex": 40}, "via": [{"face": 9, "barycentric": [0.3, 0.3, 0.4]}]}
        for form in ("obj", "glb", "csv", "svg"):
            answer = self.daemon.request("POST", f"/v1/meshes/torus/path?format={form}", json.dumps(document), {"Content-Type": "application/json"})
            self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, KINDS[form]), answer)
        answer = self.daemon.get("/v1/meshes/torus/path?from=v:5&to=v:5&format=svg")
        self.assertEqual(answer.status, 200, answer)

    def test_unavailable_formats(self):
        answer = self.daemon.get("/v1/meshes/apart/path?from=v:0&to=v:5&format=obj")
        self.assertIn("no path", self.assert_problem(answer, 406, "not_acceptable")["detail"])
        for more, name in (("&format=ply", "format"), ("&format=csv&mesh=true", "mesh"), ("&mesh=true", "mesh"), ("&format=glb&mesh=yes", "mesh")):
            problem = self.assert_problem(self.daemon.get(self.QUESTION + more), 400, "invalid_request")
            self.assertEqual(problem["parameter"], name)
        self.assert_problem(self.daemon.get("/v1/meshes/torus/distance?from=v:0&to=v:1&format=csv"), 400, "invalid_request")


class Isolines(Files):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        made = cls.daemon.ask("torus", "fields", {"set": {"points": [{"vertex": 0}]}, "max_distance": 2}).json
        cls.path = f"/v1/meshes/torus/fields/{made['id']}/isolines"
        cls.question = cls.path + "?levels=1.5,0.25&tolerance=0.01"
        isolines = cls.daemon.get(cls.question + "&geometry=xyz").json["isolines"]
        cls.lines = [line for isoline in isolines for line in isoline["lines"]]
        cls.levels = [isoline["level"] for isoline in isolines for line in isoline["lines"]]
        assert len(cls.lines) > 1 and {line["closed"] for line in cls.lines} == {True}

    def points(self):
        return [point for line in self.lines for point in line["points"]]

    def test_obj_has_each_line(self):
        rows = [row.split() for row in self.get_file(self.question, "obj").decode().splitlines()]
        self.assertEqual([list(map(float, row[1:])) for row in rows if row[0] == "v"], self.points())
        self.assertEqual([len(row) - 1 for row in rows if row[0] == "l"], [len(line["points"]) for line in self.lines])
        self.assertEqual([row[1] for row in rows if row[0] == "g"], ["level_1.5", "level_0.25"])
        again = self.daemon.put("with-isolines", self.get_file(self.question + "&mesh=true", "obj")).json
        self.assertEqual(again["faces"], self.daemon.get("/v1/meshes/torus").json["faces"])

    def test_csv_has_the_number_of_the_line(self):
        rows = list(csv.DictReader(io.StringIO(self.get_file(self.question, "csv").decode(), newline="")))
        self.assertEqual([[float(row[axis]) for axis in "xyz"] for row in rows], self.points())
        for index, line in enumerate(self.lines):
            mine = [row for row in rows if int(row["line"]) == index]
            self.assertEqual({float(row["level"]) for row in mine}, {self.levels[index]})
            self.assertAlmostEqual(float(mine[-1]["along"]), sum(map(math.dist, line["points"], line["points"][1:])), 12)
            self.assertAlmostEqual(float(mine[-1]["along"]), line["length"], delta=0.02 * line["length"])

    def test_glb_has_a_strip_for_each(self):
        primitives = read_glb(self.get_file(self.question, "glb"))[0]["meshes"][0]["primitives"]
        self.assertEqual([primitive["mode"] for primitive in primitives], [3] * len(self.lines))
        self.assertEqual([primitive["extras"]["level"] for primitive in primitives], self.levels)

    def test_by_post_accept_and_as_a_job(self):
        document, known = json.dumps({"levels": [1.5, 0.25], "tolerance": 0.01}), self.get_file(self.question, "csv")
        headers = {"Content-Type": "application/json", "Accept": "text/csv"}
        self.assertEqual(self.daemon.request("POST", self.path, document, headers).body, known)
        accepted = self.daemon.request("POST", self.path, document, {**headers, "Prefer": "respond-async"})
        self.assertEqual(self.daemon.ended(accepted)["state"], "done")
        self.assertEqual(self.daemon.get(accepted.headers["Location"] + "/result").body, known)

    def test_a_file_always_has_polylines(self):
        self.assertEqual(self.get_file(self.question + "&arcs=true&geometry=none", "csv"), self.get_file(self.question, "csv"))

    def test_unavailable_formats(self):
        answer = self.daemon.get(self.path + "?levels=0&format=glb")
        self.assertIn("no lines", self.assert_problem(answer, 406, "not_acceptable")["detail"])
        for more, name in (("&format=svg", "format"), ("&format=csv&mesh=true", "mesh")):
            self.assertEqual(self.assert_problem(self.daemon.get(self.question + more), 400, "invalid_request")["parameter"], name)
        fine = self.daemon.get(self.path + "?count=1000&tolerance=1e-12&format=obj")
        self.assertEqual(self.assert_problem(fine, 413, "too_large")["limit"], 500000)


def rotated(q, v):
    """Returns the vector rotated by a quaternion x, y, z, w."""
    x, y, z, w = q
    twice = [2 * c for c in (y * v[2] - z * v[1], z * v[0] - x * v[2], x * v[1] - y * v[0])]
    return [v[0] + w * twice[0] + y * twice[2] - z * twice[1], v[1] + w * twice[1] + z * twice[0] - x * twice[2],
            v[2] + w * twice[2] + x * twice[1] - y * twice[0]]


class Motion:
    """The animation of a GLB, read by the rules of glTF: times, places in space, quaternions."""

    def __init__(self, body):
        document, lists = read_glb(body)
        [animation] = document["animations"]
        samplers = {}
        for channel in animation["channels"]:
            target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
            assert document["nodes"][target["node"]]["name"] == "object" and sampler["interpolation"] == "LINEAR"
            assert {"min", "max"} <= document["accessors"][sampler["input"]].keys()
            samplers[target["path"]] = sampler
            self.node = target["node"]
        self.times = lists[samplers["translation"]["input"]]
        [parent] = [node for node in document["nodes"] if self.node in node.get("children", ())]
        places, turns = (lists[samplers[path]["output"]] for path in ("translation", "rotation"))
        self.places = [[a + b for a, b in zip(parent["translation"], places[i:i + 3])] for i in range(0, len(places), 3)]
        self.rotations = [turns[i:i + 4] for i in range(0, len(turns), 4)]
        assert len(self.times) == len(self.places) == len(self.rotations)
        assert all(document["bufferViews"][document["accessors"][s["output"]]["bufferView"]].get("target") is None for s in samplers.values())
        self.axes = lists[document["meshes"][document["nodes"][self.node]["mesh"]]["primitives"][0]["attributes"]["POSITION"]]


class Splines(Files):
    """Tests splines as files. With frames, a GLB has an object that moves along the curve."""

    QUESTION = "/v1/meshes/torus/spline"
    BODY = {"points": [{"vertex": 0}, {"vertex": 17}, {"vertex": 40}, {"vertex": 63}], "samples": 8}

    def file(self, form, body=None, mesh="torus", more=""):
        answer = self.daemon.ask(mesh, f"spline?format={form}{more}", body or self.BODY)
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, KINDS[form]), answer)
        return answer.body

    def test_each_form_has_the_curve(self):
        path = self.asked("torus", "spline?geometry=xyz", self.BODY)["path"]
        for body in (self.BODY, {**self.BODY, "frames": True}):
            rows = list(csv.DictReader(io.StringIO(self.file("csv", body).decode(), newline="")))
            self.assertEqual([[float(row[axis]) for axis in "xyz"] for row in rows], path["points"])
            self.assertAlmostEqual(float(rows[-1]["along"]), path["length"], 12)
            rows = [row.split() for row in self.file("obj", body).decode().splitlines()]
            self.assertEqual([list(map(float, row[1:])) for row in rows if row[0] == "v"], path["points"])
        document, lists = read_glb(self.file("glb"))
        self.assertEqual((len(document["nodes"]), len(lists[0])), (1, 3 * len(path["points"])))
        self.assertNotIn("animations", document)
        self.assert_problem(self.daemon.ask("torus", "spline?format=svg", self.BODY), 400, "invalid_request")

    def test_the_object_has_the_frames(self):
        """Tests files without and with the mesh. The daemon reads the mesh of the second file,
        although the file also has an object."""
        body = {**self.BODY, "frames": True}
        frames = self.asked("torus", "spline", body)["frames"]
        for more in ("", "&mesh=true"):
            glb = self.file("glb", body, more=more)
            motion = Motion(glb)
            self.assertEqual(len(motion.times), len(frames))
            for frame, place, q in zip(frames, motion.places, motion.rotations):
                self.assert_place(place, frame["xyz"], 6)
                self.assertAlmostEqual(math.hypot(*q), 1, 6)
                for axis, name in (((0, 0, 1), "tangent"), ((0, 1, 0), "normal"), ((1, 0, 0), "binormal")):
                    self.assert_place(rotated(q, axis), frame[name], 6)
            for p, q in zip(motion.rotations, motion.rotations[1:]):
                self.assertGreaterEqual(sum(a * b for a, b in zip(p, q)), 0)
        self.assertEqual(self.daemon.put("again", glb).json["faces"], self.daemon.get("/v1/meshes/torus").json["faces"])

    def test_time_is_in_proportion_to_length(self):
        body = {**self.BODY, "frames": True}
        rows = list(csv.DictReader(io.StringIO(self.file("csv", body).decode(), newline="")))
        along = {tuple(float(row[axis]) for axis in "xyz"): float(row["along"]) for row in rows}
        frames, length = self.asked("torus", "spline", body)["frames"], float(rows[-1]["along"])
        times = Motion(self.file("glb", body)).times
        for frame, time in zip(frames, times):
            self.assertAlmostEqual(time, 10 * along[tuple(frame["xyz"])] / length, 5)
        self.assertEqual((times[0], times[-1]), (0, 10))
        self.assertEqual(list(times), sorted(set(times)))

    def test_equal_places_are_one_key(self):
        body = {"points": self.BODY["points"], "at": [0, 0, 0.5, 0.5, 0.5, 1], "frames": True}
        self.assertEqual(len(Motion(self.file("glb", body)).times), 3)
        self.assertNotIn("animations", read_glb(self.file("glb", {**body, "at": [0.5]}))[0])

    def test_a_great_circle_turns_evenly(self):
        """The frames of a closed spline along the equator of a fine sphere turn about the sphere's
        axis. The angle is proportional to the time, with an error of at most the angle between
        faces."""
        self.put_all({"ball": sample("icosphere", level=5)})
        points = [{"xyz": [math.cos(a), math.sin(a), 0]} for a in (0.1 + math.pi * i / 4 for i in range(8))]
        body = {"points": points, "closed": True, "samples": 16, "speed": "constant", "frames": True}
        motion = Motion(self.file("glb", body, "ball"))
        self.assertEqual(len(motion.times), 129)
        for time, place, q in zip(motion.times, motion.places, motion.rotations):
            angle = 0.1 + 2 * math.pi * time / 10
            self.assertLess(math.dist(place, (math.cos(angle), math.sin(angle), 0)), 0.01)
            self.assertLess(math.dist(rotated(q, (0, 0, 1)), (-math.sin(angle), math.cos(angle), 0)), 0.05)
            self.assertLess(math.dist(rotated(q, (0, 1, 0)), (math.cos(angle), math.sin(angle), 0)), 0.05)
        self.assertAlmostEqual(max(motion.axes) / (2 * math.pi), 0.05, 3)

    def test_memory_is_given_back(self):
        self.file("glb", {**self.BODY, "frames": True})
        self.daemon.wait_for_flight()


class Lines(Files):
    """Tests traces, vectors, Voronoi diagrams, and paths on smooth surfaces as files. A file has
    the same lines as the answer as arrays."""

    CUBE = ("v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
            "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n").encode()
    QUESTIONS = [("meshes", "torus", "trace", {"start": {"vertex": 0}, "fan": 3, "length": 1}),
                 ("meshes", "torus", "exp", {"start": {"vertex": 0}, "vectors": [{"direction": 0, "length": 0.5}, {"direction": 2, "length": 1}]}),
                 ("meshes", "torus", "voronoi", {"set": {"points": [{"vertex": 0}, {"vertex": 40}]}}),
                 ("subdivisions", "cube", "path", {"from": {"face": 0, "uv": [0.2, 0.3]}, "to": {"face": 1, "uv": [0.5, 0.5]}, "level": 3}),
                 ("subdivisions", "cube", "trace", {"start": {"face": 0, "uv": [0.2, 0.3]}, "fan": 3, "length": 1}),
                 ("nurbs", "ring", "path", {"from": [0, 0.3], "to": [1, 0.5], "all_minima": True}),
                 ("nurbs", "ring", "point-curve-distance", {"point": [0, 0.3], "curve": {"polyline": [[1, 0.5], [1, 1]]}}),
                 ("nurbs", "ring", "curve-distance", {"a": {"polyline": [[0, 0.3], [0, 0.6]]}, "b": {"polyline": [[1, 0.5], [1, 1]]}})]

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        ring = json.dumps({"parametric": {"torus": {"major": 3, "minor": 1}}}).encode()
        for kind, name, body in (("subdivisions", "cube", cls.CUBE), ("nurbs", "ring", ring)):
            assert cls.daemon.request("PUT", f"/v1/{kind}/{name}", body, {"Content-Type": "application/json"} if kind == "nurbs" else {}).status == 201

    def ask(self, kind, name, query, body, form):
        return self.daemon.request("POST", f"/v1/{kind}/{name}/{query}?format={form}", json.dumps(body).encode(), {"Content-Type": "application/json"})

    def lines(self, *question):
        """Returns the points of each line, from the answer as arrays."""
        listed = read_arrays(self.ask(*question, "f64").body)
        numbers, first = listed["points"][1], listed["first"][1]
        return [[numbers[3 * i:3 * i + 3] for i in range(a, b)] for a, b in zip(first, first[1:])]

    def test_each_form_has_the_lines(self):
        for question in self.QUESTIONS:
            with self.subTest(question[:3]):
                lines = self.lines(*question)
                self.assertTrue(lines and all(len(line) > 1 for line in lines))
                files = {form: self.ask(*question, form) for form in ("obj", "csv", "glb")}
                for form, answer in files.items():
                    self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, KINDS[form]), answer)
                rows = [row.split() for row in files["obj"].body.decode().splitlines()]
                places = [list(map(float, row[1:])) for row in rows if row[0] == "v"]
                self.assertEqual([[places[int(i) - 1] for i in row[1:]] for row in rows if row[0] == "l"], lines)
                table = list(csv.DictReader(io.StringIO(files["csv"].body.decode(), newline="")))
                self.assertEqual([[float(row[axis]) for axis in "xyz"] for row in table], [p for line in lines for p in line])
                self.assertEqual([int(row["line"]) for row in table], [i for i, line in enumerate(lines) for _ in line])
                document, _ = read_glb(files["glb"].body)
                self.assertEqual(len(document["meshes"][0]["primitives"]), len(lines))

    def test_with_the_mesh(self):
        body = self.QUESTIONS[0][3]
        glb = self.ask("meshes", "torus", "trace", body, "glb&mesh=true").body
        self.assertEqual(self.daemon.put("again", glb).json["faces"], self.daemon.get("/v1/meshes/torus").json["faces"])
        self.assert_problem(self.ask("meshes", "torus", "trace", body, "csv&mesh=true"), 400, "invalid_request")
        self.assert_problem(self.ask(*self.QUESTIONS[3], "obj&mesh=true"), 400, "invalid_request")

    def test_an_answer_without_lines_is_no_file(self):
        self.assert_problem(self.ask(*self.QUESTIONS[2], "obj&select=labels"), 406, "not_acceptable")
        without_path = {"start": "v:0", "vectors": [None]}
        self.assert_problem(self.ask("meshes", "torus", "exp", without_path, "obj"), 406, "not_acceptable")

    def test_memory_is_given_back(self):
        for question in self.QUESTIONS:
            self.ask(*question, "obj")
        self.daemon.wait_for_flight()


class Gltf(Files):
    def test_compressed_and_split_files_are_refused_by_name(self):
        document = {"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}
        for change, words in (({}, "Draco"), ({"extensionsRequired": [], "buffers": [{"byteLength": 1, "uri": "a.bin"}],
                               "bufferViews": [{"buffer": 0, "byteLength": 1}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                               "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}]}, "another file, 'a.bin'")):
            answer = self.daemon.put("refused", json.dumps({**document, **change}).encode(), Content_Type="model/gltf+json")
            problem = self.assert_problem(answer, 422, "invalid_mesh")
            self.assertEqual(problem["reason"], "unsupported")
            self.assertIn(words, problem["detail"])

    def test_a_mesh_in_many_places_is_counted_as_often(self):
        """A small file whose instances exceed the daemon's limits is refused before they are
        built."""
        body = self.daemon.get("/v1/meshes/torus/content?format=gltf").json
        body["nodes"] = [{"mesh": 0, "translation": [10 * i, 0, 0]} for i in range(300)]
        body["scenes"] = [{"nodes": list(range(300))}]
        made = self.daemon.put("many", json.dumps(body).encode()).json
        self.assertEqual((made["components"], made["faces"]), (300, 300 * self.daemon.get("/v1/meshes/torus").json["faces"]))
        body["accessors"][0]["count"] = 4000000000
        del body["accessors"][0]["bufferView"]
        self.assertIn(self.daemon.put("much", json.dumps(body).encode()).status, (413, 422, 507))


@unittest.skipUnless((PEERS / "node_modules" / "gltf-validator").exists() and shutil.which("node"),
                     "without node, and gltf-validator and three from npm (make nurbs-peers), no other program reads our GLB")
class Others(Files):
    LAYERS = [{"field": {"points": [{"vertex": 0}]}}, {"isolines": {"count": 3}}, {"path": {"from": {"vertex": 0}, "to": {"vertex": 40}}, "label": "way"},
              {"trace": {"start": {"vertex": 3}, "fan": 4, "length": 1}}, {"points": [{"vertex": 0}, {"vertex": 40}], "labels": ["a", "b"]}]

    def test_other_programs_read_the_files(self):
        path, values = self.values_of("torus")
        files = {"mesh": self.daemon.get("/v1/meshes/torus/content?format=glb").body, "field": self.get_file(path, "glb"),
                 "path": self.get_file(Paths.QUESTION, "glb"), "both": self.get_file(Paths.QUESTION + "&mesh=true", "glb"),
                 "isolines": self.get_file(path.replace("values", "isolines") + "?count=2&mesh=true", "glb"),
                 **{f"motion{more}": self.daemon.ask("torus", f"spline?format=glb{more}", {**Splines.BODY, "frames": True}).body for more in ("", "&mesh=true")},
                 "figure": self.daemon.ask("torus", "picture?format=glb", {"layers": self.LAYERS}).body}
        with tempfile.TemporaryDirectory() as folder:
            for name, body in files.items():
                (pathlib.Path(folder) / name).write_bytes(body)
            done = subprocess.run(["node", SCRIPT, PEERS, *(f"{folder}/{name}" for name in files)], stdout=subprocess.PIPE, text=True, timeout=60)
        reports = dict(zip(files, map(json.loads, done.stdout.splitlines())))
        self.assertEqual(len(reports), len(files), done.stdout)
        for name, report in reports.items():
            self.assertEqual((report["errors"], report["warnings"]), (0, 0), (name, report["messages"]))
        self.assertEqual([[o["type"] for o in report["objects"]] for report in reports.values()], [
            ["Mesh"], ["Mesh"], ["Line"], ["Mesh", "Line"], ["Mesh", "Line", "Line", "Line"], ["Line", "LineSegments"], ["Mesh", "Line", "LineSegments"],
            ["Mesh", "LineSegments", "LineSegments", "LineSegments", "Points"]])
        mesh = reports["mesh"]["objects"][0]
        sent = [line.split()[1:] for line in sample("torus", columns=12, rows=7).decode().splitlines() if line.startswith("v ")]
        for i, position in enumerate(sent):
            for axis in range(3):
                self.assertAlmostEqual(mesh["places"][3 * i + axis] + mesh["translation"][axis], float(position[axis]), 6)
        for value, distance in zip(values, reports["field"]["objects"][0]["distances"]):
            self.assertAlmostEqual(value, distance, 6)
        self.assertEqual(reports["field"]["objects"][0]["colours"], len(values))
        motion = Motion(files["motion"])
        places, rotations = reports["motion"]["tracks"]
        self.assertEqual((places["name"], rotations["name"]), ("object.position", "object.quaternion"))
        self.assertEqual((places["times"], rotations["times"]), (list(motion.times), list(motion.times)))
        self.assertEqual(rotations["values"], [c for q in motion.rotations for c in q])


CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
TRIANGLE = ('<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
            '<vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/>'
            '</triangles></mesh>')


def package(model, **others):
    """Returns a 3MF package of that model part and other files."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", model)
        for name, text in others.items():
            archive.writestr(name, text)
    return out.getvalue()


def model(resources, build='<item objectid="1"/>', before=""):
    return (f'{before}<model xmlns="{CORE}"><resources>{resources}</resources>'
            f"<build>{build}</build></model>")


ONE = model(f'<object id="1">{TRIANGLE}</object>')


class Packages(Files):
    """3MF: supported content, and malicious archives."""

    def refused(self, body, status, code, says):
        problem = self.assert_problem(self.daemon.put("harm", body), status, code)
        self.assertIn(says, problem["detail"])

    def test_a_package_is_a_mesh(self):
        for headers, options in (
                ({}, ""), ({"Content_Type": "model/3mf"}, ""), ({}, "?format=3mf")):
            made = self.daemon.put("printed", package(ONE), options, **headers)
            self.assertIn(made.status, (200, 201), made)
            self.assertEqual(made.json["area"], 0.5)
        self.assertEqual(self.daemon.get("/v1/meshes/printed/content?format=3mf").status, 400)

    def test_undeclared_prefixes(self):
        for text in (ONE.replace("<resources>", "<resources><m:colorgroup m:id='4'/>"),
                     ONE.replace("<", "<c:").replace("<c:/", "</c:").replace("xmlns=", "xmlns:c=")):
            self.assertIn(self.daemon.put("prefixed", package(text)).status, (200, 201))

    def test_entities_are_refused(self):
        laughs = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 10))
        for inner in (f'<!ENTITY e0 "ha">{laughs}', '<!ENTITY e9 SYSTEM "file:///etc/passwd">'):
            body = package(model("&e9;", before=f"<!DOCTYPE model [{inner}]>"))
            self.refused(body, 422, "invalid_mesh", "document type")

    def test_bombs_are_refused(self):
        blanks = package(ONE + " " * (64 << 20))
        self.assertLess(len(blanks), 1 << 17)
        self.refused(blanks, 413, "too_large", "at most 256 times")
        twice = ('<object id="%d"><components><component objectid="%d"/><component objectid="%d"/>'
                 "</components></object>")
        pairs = "".join(twice % (i, i - 1, i - 1) for i in range(2, 40))
        chain = f'<object id="1">{TRIANGLE}</object>{pairs}'
        many = package(model(chain, '<item objectid="39"/>'))
        self.refused(many, 413, "too_large", "triangles")
        names = "".join(f"<a{i}/>" for i in range(500000))
        self.refused(package(model(names)), 413, "too_large", "names of elements")
        long = "".join(map(str, range(40000)))
        self.refused(package(model(f'<a b="{long}"/>')), 422, "invalid_mesh", "tag")

    def test_paths_stay_in_the_package(self):
        rels = ('<Relationships '
                'xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                '<Relationship Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" '
                'Target="%s" Id="a"/></Relationships>')
        for target in ("/etc/passwd", "../../etc/passwd", "file:///etc/passwd"):
            body = package(ONE, **{"_rels/.rels": rels % target})
            self.refused(body, 422, "invalid_mesh", "lacks the part")

    def test_damage_is_found(self):
        body = bytearray(package(ONE))
        at = body.index(b"3D/3dmodel.model") + 40
        body[at] ^= 0x55
        self.assert_problem(self.daemon.put("harm", bytes(body)), 422, "invalid_mesh")
        self.refused(bytes(body[:-30]), 422, "invalid_mesh", "truncated")


if __name__ == "__main__":
    unittest.main()
