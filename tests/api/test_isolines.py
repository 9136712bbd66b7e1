"""Tests isolines of a field. Compares lines and arcs with circles, and checks that every point has
its level's distance. Also tests refused requests and isolines that end early."""
import concurrent.futures
import json
import math
import unittest

from harness import SQUARE, TETRAHEDRON, Daemon, TestCase, sample, wait_until

# a unit square of four triangles around its centre, vertex 4; the second face has the opposite
# orientation in the file
TURNED = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0\nf 1 2 5\nf 3 2 5\nf 3 4 5\nf 4 1 5\n"

# flat except at its apex; a line around the apex is shorter than 2 pi times its level
CONE = {"radius": 1.0, "height": 0.5, "sectors": 7, "rings": 4}


def vertices(*numbers, **more):
    return {"set": {"points": [{"vertex": number} for number in numbers]}, **more}


def subtract(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.hypot(*a) for x in a]


class Obj:
    """The vertices and faces of a mesh file."""

    def __init__(self, text):
        lines = [line.split() for line in text.decode().splitlines()]
        self.positions = [[float(x) for x in line[1:]] for line in lines if line and line[0] == "v"]
        self.faces = [[int(x) - 1 for x in line[1:]] for line in lines if line and line[0] == "f"]

    def place(self, arc, angle, up):
        """Returns the point at an angle of an arc's circle. The vector `up` points to the outer
        side of the face."""
        a, b, c = (self.positions[corner] for corner in self.faces[arc["face"]])
        x = unit(subtract(b, a))
        normal = unit(cross(x, subtract(c, a)))
        if sum(m * n for m, n in zip(normal, up)) < 0:
            normal = [-m for m in normal]
        y = cross(normal, x)
        return [m + arc["radius"] * (math.cos(angle) * u + math.sin(angle) * v) for m, u, v in zip(arc["centre"], x, y)]


class Isolines(TestCase):
    def make(self, mesh, document):
        answer = self.daemon.ask(mesh, "fields", document)
        self.assertIn(answer.status, (200, 201), answer)
        return answer.json

    def ask(self, mesh, field, query):
        geometry = "" if "geometry=" in query else "geometry=full&"
        return self.daemon.get(f"/v1/meshes/{mesh}/fields/{field}/isolines?{geometry}{query}")

    def trace(self, mesh, field, query):
        answer = self.ask(mesh, field, query)
        self.assertEqual(answer.status, 200, answer)
        return answer.json["isolines"]

    def check_distances(self, mesh, field, isolines):
        """Asserts that every point of every line has its level's distance; returns the number of
        points."""
        count = 0
        for isoline in isolines:
            points = [point for line in isoline["lines"] for point in line["points"]]
            named = [{key: value for key, value in point.items() if key != "xyz"} for point in points]
            if not named:
                continue
            answer = self.daemon.ask(mesh, f"fields/{field}/evaluate?select=distance", {"points": named})
            self.assertEqual(answer.status, 200, answer)
            for result in answer.json["results"]:
                self.assertLess(abs(result["distance"] - isoline["level"]), 1e-9 * isoline["level"])
            count += len(named)
        return count


class Lines(Isolines):
    def test_the_example(self):
        self.daemon.put("tetrahedron", TETRAHEDRON)
        field = self.make("tetrahedron", vertices(0))["id"]
        isolines = self.trace("tetrahedron", field, "levels=0.25&arcs=true&geometry=xyz")
        example = self.daemon.get("/openapi.json").json["paths"]["/v1/meshes/{name}/fields/{id}/isolines"]["get"]
        example = example["responses"]["200"]["content"]["application/json"]["example"]["isolines"]
        self.assertEqual(list(isolines[0]), list(example[0]))
        (line,), (told,) = isolines[0]["lines"], example[0]["lines"]
        self.assertEqual(list(line), list(told))
        self.assertEqual(len(line["points"]), len(told["points"]))
        for point, expected in zip(line["points"], told["points"]):
            self.assertLess(math.dist(point, expected), 1e-15)
        for arc, expected in zip(line["arcs"], told["arcs"]):
            self.assertEqual(arc["face"], expected["face"])
            self.assertLess(abs(arc["start"] - expected["start"]) + abs(arc["end"] - expected["end"]), 1e-14)
        self.assertAlmostEqual(line["length"], told["length"], 14)

    def test_circles_in_the_plane(self):
        self.daemon.put("plane", sample("grid", columns=9, rows=9))
        field = self.make("plane", {"set": {"points": [{"xyz": [0.5, 0.5, 0]}]}})["id"]
        levels = [0.003, 0.1, 0.25, 0.4, 0.499]
        isolines = self.trace("plane", field, "arcs=true&levels=" + ",".join(map(str, levels)))
        self.assertEqual([isoline["level"] for isoline in isolines], levels)
        for level, isoline in zip(levels, isolines):
            (line,) = isoline["lines"]
            self.assertTrue(line["closed"])
            self.assertLess(abs(line["length"] / (2 * math.pi * level) - 1), 1e-9)
            self.assertEqual(len(line["points"]), len(line["arcs"]) + 1)
            self.assertEqual(line["points"][0], line["points"][-1])
            for arc in line["arcs"]:
                self.assertLess(math.dist(arc["centre"], [0.5, 0.5, 0]) + abs(arc["radius"] - level), 1e-12)
            self.assertAlmostEqual(sum(arc["end"] - arc["start"] for arc in line["arcs"]), 2 * math.pi, 9)
        self.check_distances("plane", field, isolines)
        corner = self.trace("plane", self.make("plane", vertices(0))["id"], "levels=0.5")[0]["lines"]
        self.assertEqual([line["closed"] for line in corner], [False])
        self.assertLess(abs(corner[0]["length"] / (math.pi / 4) - 1), 1e-9)

    def test_circles_about_the_apex_of_a_cone(self):
        cone = Obj(sample("cone", **CONE))
        self.daemon.put("cone", sample("cone", **CONE))
        apex = len(cone.positions) - 1
        sector = 2 * math.asin(math.sin(math.pi / 7) / math.hypot(1, 0.5))
        field = self.make("cone", vertices(apex))["id"]
        for isoline in self.trace("cone", field, "levels=0.2,0.7&arcs=true"):
            (line,) = isoline["lines"]
            self.assertTrue(line["closed"])
            self.assertLess(abs(line["length"] / (7 * sector * isoline["level"]) - 1), 1e-9)

    def test_points_of_arcs_are_at_the_level(self):
        """Also tests faces with the wrong orientation in the file."""
        terrain = sample("terrain", cells=8, amplitude=0.5)
        meshes = {"turned": (TURNED, vertices(0)), "terrain": (terrain, vertices(20))}
        for name, (body, source) in meshes.items():
            flipped = self.daemon.put(name, body).json["orientation"]["flipped_faces"]
            self.assertEqual(flipped, 1 if name == "turned" else 0)
            mesh = Obj(body)
            field = self.make(name, source)["id"]
            for line in [line for isoline in self.trace(name, field, "count=5&arcs=true") for line in isoline["lines"]]:
                ends = [point["xyz"] for point in line["points"]]
                self.assertEqual(len(ends), len(line["arcs"]) + 1)
                for arc, start, end in zip(line["arcs"], ends, ends[1:]):
                    self.assertTrue(0 <= arc["start"] < 2 * math.pi)
                    self.assertLess(math.dist(mesh.place(arc, arc["start"], [0, 0, 1]), start), 1e-9)
                    self.assertLess(math.dist(mesh.place(arc, arc["end"], [0, 0, 1]), end), 1e-9)
                length = sum(arc["radius"] * (arc["end"] - arc["start"]) for arc in line["arcs"])
                self.assertLess(abs(length / line["length"] - 1), 1e-9)

    def test_every_point_is_at_the_level(self):
        for name, body in {
            "torus": sample("torus"),
            "box": sample("box", cells=3),
            "saddle": sample("saddle"),
        }.items():
            self.daemon.put(name, body)
            field = self.make(name, vertices(0, 9))["id"]
            coarse = self.check_distances(name, field, self.trace(name, field, "count=7&tolerance=0.1"))
            fine = self.check_distances(name, field, self.trace(name, field, "count=7&tolerance=0.00001"))
            self.assertTrue(0 < coarse < fine)

    def test_polylines_keep_the_tolerance(self):
        self.daemon.put("tolerance", SQUARE)
        field = self.make("tolerance", vertices(0))["id"]
        for tolerance in (0.1, 0.01, 0.0001):
            (line,) = self.trace("tolerance", field, f"levels=0.8&tolerance={tolerance}&geometry=xyz")[0]["lines"]
            for a, b in zip(line["points"], line["points"][1:]):
                middle = [(x + y) / 2 for x, y in zip(a, b)]
                self.assertLess(0.8 - math.hypot(*middle), tolerance)
        self.assertGreater(len(line["points"]), 20)
        (default,) = self.trace("tolerance", field, "levels=0.8")[0]["lines"]
        (same,) = self.trace("tolerance", field, f"levels=0.8&tolerance={math.sqrt(2) / 2000}")[0]["lines"]
        self.assertEqual(default, same)
        both = self.trace("tolerance", field, "levels=0.8&tolerance=0.0001&arcs=true&geometry=xyz")[0]["lines"][0]
        self.assertEqual(both["points"], line["points"])
        self.assertTrue(0 < len(both["arcs"]) < 5)

    def test_levels_by_count(self):
        self.daemon.put("count", sample("box", cells=2))
        whole = self.make("count", vertices(0))
        isolines = self.trace("count", whole["id"], "count=4&geometry=none")
        for i, isoline in enumerate(isolines):
            self.assertAlmostEqual(isoline["level"], whole["max"] * (i + 1) / 5, 12)
            self.assertTrue(isoline["lines"])
            for line in isoline["lines"]:
                self.assertEqual(list(line), ["closed", "length"])
        partial = self.make("count", vertices(0, max_distance=0.5))
        levels = [isoline["level"] for isoline in self.trace("count", partial["id"], "count=4")]
        self.assertEqual(levels, [0.1, 0.2, 0.3, 0.4])

    def test_levels_without_lines(self):
        self.daemon.put("none", SQUARE)
        field = self.make("none", vertices(0))["id"]
        self.assertEqual(
            self.trace("none", field, "levels=9,0,1e300"), [{"level": level, "lines": []} for level in (9, 0, 1e300)]
        )

    def test_a_partial_field(self):
        self.daemon.put("ends", sample("box", cells=2))
        whole = self.make("ends", vertices(0))["id"]
        partial = self.make("ends", vertices(0, max_distance=0.75))["id"]
        query = "levels=0.3,0.75&geometry=none"
        for one, other in zip(self.trace("ends", whole, query), self.trace("ends", partial, query)):
            lengths = [sorted(line["length"] for line in isoline["lines"]) for isoline in (one, other)]
            self.assertEqual(len(lengths[0]), len(lengths[1]))
            for a, b in zip(*lengths):
                self.assertAlmostEqual(a, b, 9)
        problem = self.assert_problem(self.ask("ends", partial, "levels=0.3,0.8"), 400, "invalid_request")
        self.assertEqual(problem["parameter"], "levels")
        self.assertIn("max_distance, 0.75", problem["detail"])

    def test_the_body_says_the_same(self):
        self.daemon.put("body", sample("torus"))
        field = self.make("body", vertices(3))["id"]
        for query, document in (
            ("levels=0.5,1.25&arcs=true", {"levels": [0.5, 1.25], "arcs": True}),
            ("count=3&tolerance=0.01", {"count": 3, "tolerance": 0.01}),
        ):
            for geometry in ("full", "xyz"):
                posted = self.daemon.ask("body", f"fields/{field}/isolines?geometry={geometry}", document)
                self.assertEqual((posted.status, posted.body), (200, self.ask("body", field, f"{query}&geometry={geometry}").body))

    def test_many_at_once_get_the_same(self):
        self.daemon.put("crowd", sample("icosphere", level=3))
        field = self.make("crowd", vertices(7))["id"]
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda _: self.ask("crowd", field, "count=5&arcs=true").body, range(24)))
        self.assertEqual(len(set(answers)), 1)
        self.assertEqual(len(json.loads(answers[0])["isolines"]), 5)

    def test_refusals(self):
        self.daemon.put("refusals", SQUARE)
        field = self.make("refusals", vertices(0))["id"]
        for query, parameter in (
            ("", "levels"),
            ("levels=1&count=2", "levels"),
            ("levels=", "levels"),
            ("levels=1,", "levels"),
            ("levels=1,,2", "levels"),
            ("levels=-1", "levels"),
            ("levels=1;2", "levels"),
            ("levels=nan", "levels"),
            ("count=0", "count"),
            ("count=-1", "count"),
            ("count=1.5", "count"),
            ("count=1&tolerance=0", "tolerance"),
            ("count=1&tolerance=x", "tolerance"),
            ("count=1&arcs=yes", "arcs"),
            ("count=1&select=lines", "select"),
            ("count=1&level=1", "level"),
        ):
            problem = self.assert_problem(self.ask("refusals", field, query), 400, "invalid_request")
            self.assertEqual(problem["parameter"], parameter, query)
        for document, pointer in (
            ({}, ""),
            ({"levels": [1], "count": 2}, ""),
            ({"levels": []}, "/levels"),
            ({"levels": 1}, "/levels"),
            ({"levels": [1, "x"]}, "/levels/1"),
            ({"levels": [1, -1]}, "/levels"),
            ({"count": 0}, "/count"),
            ({"count": 1.5}, "/count"),
            ({"count": 1, "tolerance": 0}, "/tolerance"),
            ({"count": 1, "arcs": 1}, "/arcs"),
            ({"count": 1, "level": 1}, "/level"),
        ):
            answer = self.daemon.ask("refusals", f"fields/{field}/isolines", document)
            problem = self.assert_problem(answer, 400, "invalid_request")
            self.assertEqual(problem["pointer"], pointer, document)
        self.assert_problem(self.ask("refusals", "0" * 32, "count=1"), 404, "not_found")

    def test_limits(self):
        self.daemon.put("limits", sample("icosphere", level=5))
        field = self.make("limits", vertices(0))["id"]
        for answer in (
            self.ask("limits", field, "count=1001"),
            self.ask("limits", field, "count=4294967295"),
            self.ask("limits", field, "levels=" + ",".join(["0.5"] * 1001)),
            self.daemon.ask("limits", f"fields/{field}/isolines", {"levels": [1] * 1001}),
            self.daemon.ask("limits", f"fields/{field}/isolines", {"count": 1001}),
        ):
            self.assertEqual(self.assert_problem(answer, 413, "too_large")["limit"], 1000)
        for query in ("levels=1&tolerance=1e-12", "count=1000&arcs=true&geometry=none"):
            self.assertEqual(self.assert_problem(self.ask("limits", field, query), 413, "too_large")["limit"], 500000)

    def test_the_deadline_ends_it(self):
        self.daemon.put("deadline", sample("icosphere", level=6))
        field = self.make("deadline", vertices(0))["id"]
        answer = self.ask("deadline", field, "count=1000&timeout_ms=30")
        self.assert_problem(answer, 504, "deadline_exceeded")
        self.assertEqual(self.ask("deadline", field, "count=2").status, 200)


class Memory(Isolines):
    flags = ("--memory-budget", "24MiB", "--max-body", "8MiB", "--workers", "2", "--landmarks", "0")

    def test_an_answer_without_memory_is_refused_and_holds_no_memory(self):
        self.assertEqual(self.daemon.put("sphere", sample("icosphere", level=4)).status, 201)
        field = self.make("sphere", vertices(0))["id"]
        flight = self.daemon.metric('memory_bytes{class="flight"}')
        answer = self.ask("sphere", field, "count=1&tolerance=1e-10")
        self.assert_problem(answer, 507, "insufficient_memory")
        self.assertEqual(self.ask("sphere", field, "count=3").status, 200)
        self.daemon.wait_for_flight(flight)

    def test_each_level_is_sent_before_the_next_is_written(self):
        """An answer of many levels may be larger than the memory for answers, because the daemon
        sends each level before it writes the next one."""
        self.daemon.put("many", sample("icosphere", level=4))
        field = self.make("many", vertices(0))["id"]
        flight = self.daemon.metric('memory_bytes{class="flight"}')
        answer = self.ask("many", field, "count=40&tolerance=1e-7")
        self.assertEqual((answer.status, answer.headers["Transfer-Encoding"]), (200, "chunked"))
        self.assertEqual(len(answer.json["isolines"]), 40)
        self.assertGreater(len(answer.body), 12 << 20)
        self.assertEqual(answer.headers["ETag"], self.ask("many", field, "count=1").headers["ETag"])
        self.assertEqual(self.ask("many", field, "count=40&tolerance=1e-7").body, answer.body)
        connection = self.daemon.connect()
        connection.request("GET", f"/v1/meshes/many/fields/{field}/isolines?count=40&tolerance=1e-7&geometry=full")
        connection.getresponse().read(1000)
        connection.close()
        self.daemon.wait_for_flight(flight)


class Workers(unittest.TestCase):
    def ask(self, workers):
        """Returns the distances at all vertices, and isolines with their arcs."""
        with Daemon("--workers", str(workers), "--landmarks", "0") as daemon:
            self.assertEqual(daemon.put("terrain", sample("terrain", cells=104)).status, 201)
            field = daemon.ask("terrain", "fields", vertices(5000)).json["id"]
            path = f"/v1/meshes/terrain/fields/{field}"
            answers = [daemon.get(path + query) for query in ("/values?format=npy", "/isolines?count=20&arcs=true&geometry=full")]
            self.assertEqual([answer.status for answer in answers], [200, 200], answers)
            return [answer.body for answer in answers]

    def test_any_number_of_workers_returns_the_same_bits(self):
        alone = self.ask(1)
        for workers in (2, 3):
            self.assertTrue(self.ask(workers) == alone)


if __name__ == "__main__":
    unittest.main()
