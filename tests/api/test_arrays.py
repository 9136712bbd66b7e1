"""Answers as arrays of bytes have the numbers of the JSON answers."""
import io
import json
import math
import struct
import unittest
import zipfile

import arrays
from harness import TWO_TRIANGLES, Daemon, TestCase, sample

BALL = {"set": {"points": [{"vertex": 0}, {"vertex": 9}]}}


class Forms(TestCase):
    flags = ("--workers", "2", "--landmarks", "0")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=4))
        cls.daemon.put("apart", TWO_TRIANGLES)
        cls.field = cls.daemon.ask("ball", "fields", BALL).json["id"]
        cls.apart = cls.daemon.ask("apart", "fields", {"set": {"points": ["v:0"]}}).json["id"]

    def forms(self, method, target, body=None, surfaces="meshes"):
        """Returns the answer as JSON and in each of its forms."""
        headers = {"Content-Type": "application/json"} if body is not None else {}
        body = None if body is None else json.dumps(body)
        mark = "&" if "?" in target else "?"
        answers = {}
        for form in ("json", "f64", "f32", "npy", "npz"):
            answer = self.daemon.request(method, f"/v1/{surfaces}/{target}{mark}format={form}", body, headers)
            self.assertEqual(answer.status, 200, (target, form, answer))
            answers[form] = answer
        self.assertEqual(len({answer.headers["ETag"] for answer in answers.values()}), 5)
        f64, f32 = arrays.read(answers["f64"].body), arrays.read(answers["f32"].body)
        self.assertEqual(list(f64), list(f32))
        with zipfile.ZipFile(io.BytesIO(answers["npz"].body)) as archive:
            self.assertIsNone(archive.testzip())
            self.assertEqual(archive.namelist(), [name + ".npy" for name in f64])
            for name, (columns, numbers) in f64.items():
                shape, again = arrays.read_npy(archive.read(name + ".npy"))
                self.assertEqual((shape[1:], len(again)), ((columns,) if columns else (), len(numbers)))
                self.assert_same(again, numbers, 0)
                self.assert_same(f32[name][1], numbers, 1e-6)
        self.assert_same(arrays.read_npy(answers["npy"].body)[1], next(iter(f64.values()))[1], 0)
        return answers["json"].json, {name: self.rows(*each) for name, each in f64.items()}

    @staticmethod
    def rows(columns, numbers):
        return [tuple(numbers[i:i + columns]) for i in range(0, len(numbers), columns)] if columns else numbers

    def assert_same(self, a, b, slack):
        self.assertEqual(len(a), len(b))
        for x, y in zip(a, b):
            self.assertTrue(x == y or math.isnan(x) and math.isnan(y) or abs(x - y) <= slack * max(1, abs(y)), (x, y))

    def assert_nulls(self, found, wanted):
        self.assertEqual([None if math.isnan(value) else value for value in found], wanted)

    def assert_lines(self, found, lines):
        self.assertEqual(len(found["first"]), len(lines) + 1)
        for i, line in enumerate(lines):
            points = found["points"][found["first"][i]:found["first"][i + 1]]
            self.assertEqual(points, [tuple(point) for point in line["points"]])
            self.assertAlmostEqual(found["length"][i], line["length"], 3)

    def test_matrix(self):
        body = {"sources": [{"vertex": 0}, {"vertex": 1}], "targets": [{"vertex": 1}, {"vertex": 2}, {"vertex": 3}]}
        for mesh in ("ball", "apart"):
            # a distance from a field and a distance from a search can differ by rounding
            for source in body["sources"]:
                self.daemon.ask(mesh, "fields", {"set": {"points": [source]}})
            answer, found = self.forms("POST", mesh + "/matrix", body)
            self.assert_nulls([value for row in found["distances"] for value in row], sum(answer["distances"], []))

    def test_values(self):
        answer, found = self.forms("GET", f"ball/fields/{self.field}/values")
        self.assertEqual(found, {"values": answer["values"]})

    def test_evaluation(self):
        points = [{"vertex": 5}, {"xyz": [1, 0.5, 0]}]
        answer, found = self.forms("POST", f"ball/fields/{self.field}/evaluate", {"points": points, "path": True, "gradient": True})
        self.assertEqual(found["distance"], [result["distance"] for result in answer["results"]])
        self.assertEqual(found["member"], [result["nearest"]["index"] for result in answer["results"]])
        self.assertEqual(found["nearest"], [tuple(result["nearest"]["point"]["xyz"]) for result in answer["results"]])
        answer, found = self.forms("POST", "apart/distance-to-set", {"set": {"points": [{"vertex": 0}]}, "points": [{"vertex": 1}, {"vertex": 4}]})
        self.assert_nulls(found["distance"], [result["distance"] for result in answer["results"]])
        self.assertEqual(found["member"], [0, 0xFFFFFFFF])

    def test_paths_and_gradients(self):
        body = {"points": [{"vertex": 5}, {"xyz": [1, 0.5, 0]}, {"vertex": 0}], "path": True, "gradient": True}
        answer, found = self.forms("POST", f"ball/fields/{self.field}/evaluate?geometry=xyz", body)
        self.assert_paths(found, answer["results"])
        for row, result in zip(found["gradient"], answer["results"], strict=True):
            self.assert_nulls(row, result["gradient"]["xyz"] if result.get("gradient") else [None] * 3)
        body = {"set": {"points": [{"vertex": 0}]}, "points": [{"vertex": 1}, {"vertex": 4}], "path": True}
        answer, found = self.forms("POST", "apart/distance-to-set?geometry=xyz", body)
        self.assert_paths(found, answer["results"])
        self.assertNotIn("gradient", found)

    def assert_paths(self, found, results):
        self.assertEqual(len(found["first"]), len(results) + 1)
        for i, result in enumerate(results):
            points = found["points"][found["first"][i]:found["first"][i + 1]]
            self.assertEqual(points, [tuple(point) for point in result["path"]["points"]] if result.get("path") else [])

    def test_vectors(self):
        for to in (["v:5", "v:0", {"xyz": [1, 0.5, 0]}], "all"):
            answer, found = self.forms("POST", "ball/log", {"from": "v:0", "to": to})
            self.assert_vectors(found, answer["vectors"])
            if to != "all":
                self.assertEqual(found["cut_locus"], [int(vector.get("cut_locus", False)) for vector in answer["vectors"]])
        answer, found = self.forms("POST", "apart/log", {"from": "v:0", "to": ["v:1", "v:4"]})
        self.assert_vectors(found, answer["vectors"])
        vectors = [{"direction": 1, "length": 0.5}, {"direction": None, "length": 0}]
        answer, found = self.forms("POST", "ball/transport", {"from": "v:0", "to": "v:9", "vectors": vectors})
        self.assert_vectors(found, answer["vectors"])
        self.assertEqual(found["distance"], [answer["distance"]])
        _, found = self.forms("POST", "apart/transport", {"from": "v:0", "to": "v:4", "vectors": vectors})
        self.assertEqual(found["direction"], [])
        self.assert_nulls(found["distance"], [None])

    def assert_vectors(self, found, vectors):
        nothing = {"direction": None, "length": None}
        vectors = [vector or nothing for vector in vectors]
        directions = [vector["direction"] or {"xyz": [None] * 3, "angle": None} for vector in vectors]
        self.assert_nulls(found["length"], [vector["length"] for vector in vectors])
        self.assert_nulls(found["angle"], [direction["angle"] for direction in directions])
        for row, direction in zip(found["direction"], directions, strict=True):
            self.assert_nulls(row, direction["xyz"])

    def test_cuts(self):
        curve = {"points": ["v:0", "v:9", "v:30"], "closed": True}
        for select_only in (False, True):
            answer, found = self.forms("POST", "ball/cut", {"curve": curve, "select_only": select_only})
            self.assertEqual(found["area"], [piece["area"] for piece in answer["pieces"]])
            for name, first in (("vertex_map", "vertex_first"), ("face_map", "face_first")):
                if select_only and name == "vertex_map":
                    self.assertNotIn(name, found)
                    continue
                for i, piece in enumerate(answer["pieces"]):
                    self.assertEqual(found[name][found[first][i]:found[first][i + 1]], [0xFFFFFFFF if x is None else x for x in piece[name]])
                self.assertEqual(found[first][-1], len(found[name]))

    def test_isolines(self):
        answer, found = self.forms("GET", f"ball/fields/{self.field}/isolines?count=7")
        lines = [line for level in answer["isolines"] for line in level["lines"]]
        self.assert_lines(found, lines)
        self.assertEqual(found["level"], [level["level"] for level in answer["isolines"] for line in level["lines"]])
        _, found = self.forms("GET", f"ball/fields/{self.field}/isolines?levels=100")
        self.assertEqual(found, {"points": [], "first": [0], "level": [], "length": []})

    def test_voronoi(self):
        answer, found = self.forms("POST", "ball/voronoi", BALL)
        self.assertEqual(found["labels"], answer["labels"])
        self.assert_lines(found, answer["bisectors"])
        self.assertEqual(found["members"], [tuple(each["members"]) for each in answer["bisectors"]])
        self.assertEqual(list(self.forms("POST", "ball/voronoi?fields=labels", BALL)[1]), ["labels"])

    def test_traces(self):
        answer, found = self.forms("POST", "ball/trace?geometry=xyz", {"start": {"vertex": 3}, "fan": 36, "length": 1})
        self.assert_lines(found, answer["paths"])

    def test_path(self):
        answer, found = self.forms("GET", "ball/path?from=v:0&to=v:100&geometry=xyz")
        self.assertEqual(found["points"], [tuple(point) for point in answer["path"]["points"]])
        self.assertEqual(found["distance"], [answer["distance"]])
        _, found = self.forms("GET", "apart/path?from=v:0&to=v:4")
        self.assertEqual((found["points"], found["first"]), ([], [0]))
        self.assert_nulls(found["distance"], [None])

    def test_farthest_points(self):
        answer, found = self.forms("POST", "ball/farthest-points?geometry=xyz", {"count": 5, "start": "v:3"})
        self.assertEqual((found["points"], found["first"]), ([tuple(point) for point in answer["points"]], [0, 5]))
        self.assert_nulls(found["radii"], answer["radii"])

    def test_splines(self):
        body = {"points": ["v:0", "v:9", "v:30"], "samples": 4, "frames": True}
        answer, found = self.forms("POST", "ball/spline?geometry=xyz", body)
        self.assertEqual(found["points"], [tuple(point) for point in answer["path"]["points"]])
        self.assertEqual(found["parameters"], answer["parameters"])
        order = ("xyz", "tangent", "normal", "binormal")
        self.assertEqual(found["frames"], [(f["parameter"], *[x for name in order for x in f[name]], f["speed"]) for f in answer["frames"]])
        self.assertNotIn("frames", self.forms("POST", "ball/spline", {**body, "frames": False})[1])

    def test_curves(self):
        curve = {"points": ["v:0", "v:9", "v:30"], "closed": True}
        answer, found = self.forms("POST", "ball/curve?geometry=xyz", {"operation": "resample", "curve": curve, "count": 6})
        self.assertEqual(found["points"], [tuple(point) for point in answer["path"]["points"]])
        self.assertEqual(found["points"][0], found["points"][-1])
        self.assertEqual(found["resampled"], [tuple(point["xyz"]) for point in answer["points"]])
        answer, found = self.forms("POST", "ball/curve?geometry=xyz", {"operation": "offset", "curve": curve, "distance": 0.1})
        self.assertEqual(len(found["first"]), len(answer["paths"]) + 1)
        self.assertEqual(found["points"], [tuple(point) for line in answer["paths"] for point in line["path"]["points"]])
        for measure in ("min", "hausdorff"):
            body = {"a": curve, "b": {"points": ["v:100", "v:90"]}, "measure": measure}
            answer, found = self.forms("POST", "ball/curve-distance?geometry=xyz", body)
            self.assertEqual(found["points"], [tuple(point) for point in answer["path"]["points"]])
            self.assertEqual(found["distance"], [answer["distance"]])

    def test_smooth_surfaces(self):
        self.daemon.request("PUT", "/v1/nurbs/torus", json.dumps({"parametric": {"torus": {"major": 2, "minor": 1}}}))
        self.daemon.request("PUT", "/v1/subdivisions/cube", sample("box", cells=1), {"Content-Type": "model/obj"})
        places = {"uv": [[0.1, 0.2], [3, 0.5]]}
        self.check_jets(*self.forms("POST", "torus/evaluate", places, "nurbs"), ("gaussian_curvature", "mean_curvature"))
        places = {"points": [{"face": 0, "uv": [0.5, 0.25]}, {"face": 3, "uv": [0, 0]}]}
        self.check_jets(*self.forms("POST", "cube/evaluate", places, "subdivisions"), None)
        body = {"from": places["points"][0], "to": places["points"][1]}
        answer, found = self.forms("POST", "cube/path?geometry=xyz", body, "subdivisions")
        self.assertEqual(found["points"], [tuple(point) for point in answer["path"]["points"]])
        self.assertEqual((found["first"], found["distance"]), ([0, len(found["points"])], [answer["distance"]]))

        for smooth in (False, True):
            body = {"start": places["points"][0], "fan": 20, "length": 1.5, "smooth": smooth}
            answer, found = self.forms("POST", "cube/trace?geometry=xyz", body, "subdivisions")
            self.assert_lines(found, answer["paths"])
        line = {"polyline": [[3, 0.5], [4, 1]]}
        for name, body in (
            ("path", {"from": [0, 0], "to": [3, 0.5], "samples": 5, "all_minima": True}),
            ("point-curve-distance", {"point": [0, 0], "curve": line, "samples": 4}),
            ("curve-distance", {"a": {"polyline": [[0, 0], [1, 0.2]]}, "b": line}),
            ("path", {"from": [0, 0], "to": [0, 0]}),
        ):
            answer, found = self.forms("POST", f"torus/{name}", body, "nurbs")
            self.check_geodesics(found, [answer, *answer.get("minima", [])[1:]])

    def check_geodesics(self, found, paths):
        self.assertEqual(found["length"], [path["length"] for path in paths])
        for name, first, read in (
            ("points", "first", lambda path: [tuple(point["xyz"]) for point in path["points"]]),
            ("uv", "first", lambda path: [tuple(point["uv"]) for point in path["points"]]),
            ("knots", "knots_first", lambda path: path["knots"]),
            ("control_points", "control_points_first", lambda path: [tuple(uv) for uv in path["control_points"]]),
        ):
            for i, path in enumerate(paths):
                self.assertEqual(found[name][found[first][i]:found[first][i + 1]], read(path), name)
            self.assertEqual((len(found[first]), found[first][-1]), (len(paths) + 1, len(found[name])))

    def check_jets(self, answer, found, curvatures):
        for name in ("xyz", "normal", "du", "dv", "duu", "duv", "dvv"):
            for row, jet in zip(found[name], answer["points"], strict=True):
                self.assert_nulls(row, jet[name] or [None] * 3)
        for row, jet in zip(found["curvatures"], answer["points"], strict=True):
            self.assert_nulls(row, [jet[name] for name in curvatures] if curvatures else jet["curvatures"] or [None] * 2)

    def test_bytes_without_a_head(self):
        answer = self.daemon.request("GET", f"/v1/meshes/apart/fields/{self.apart}/values", headers={"Accept": "application/octet-stream"})
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "application/octet-stream"))
        values = self.daemon.request("GET", f"/v1/meshes/apart/fields/{self.apart}/values").json["values"]
        found = struct.unpack(f"<{len(values)}d", answer.body)
        self.assert_nulls(found, values)
        self.assertIn(None, values)

    def test_wedges_of_all_edges_cover_the_edges(self):
        self.daemon.put("box", sample("box", cells=4))
        faces = self.daemon.request("GET", "/v1/meshes/box").json["faces"]
        points = [{"face": 7, "barycentric": [0.5, 0.25, 0.25]}, {"vertex": 3}]
        for member in points:
            field = self.daemon.ask("box", "fields", {"set": {"points": [member]}}).json["id"]
            target = f"/v1/meshes/box/fields/{field}/wedges"
            container = arrays.read(self.daemon.request("GET", target + "?format=f64").body)
            self.assertEqual(list(container), ["wedges", "sources", "edges", "first"])
            found = {name: self.rows(*each) for name, each in container.items()}
            first, edges = found["first"], found["edges"]
            self.assertEqual((len(edges), len(set(edges)), len(first)), (faces * 3 // 2, len(edges), len(edges) + 1))
            self.assertEqual((first[0], first[-1]), (0, len(found["wedges"])))
            asked, distances = [], []
            for edge, begin, end in zip(edges, first, first[1:]):
                wedges = found["wedges"][begin:end]
                self.assertTrue(wedges, edge)
                length = wedges[-1][1]
                self.assertEqual(wedges[0][0], 0)
                for before, behind in zip(wedges, wedges[1:]):
                    self.assertLessEqual(abs(before[1] - behind[0]), 1e-15)
                for b0, b1, d0, d1, sigma in wedges:
                    self.assertLess(b0, b1)
                    if b1 - b0 > 1e-6 * length:
                        x = (d0 * d0 - d1 * d1 + (b1 - b0) ** 2) / (2 * (b1 - b0))
                        away = math.hypot((b1 - b0) / 2 - x, math.sqrt(max(0, d0 * d0 - x * x)))
                        asked.append({"edge": list(edge), "t": (b0 + b1) / 2 / length})
                        distances.append(sigma + away)
            answer = self.daemon.ask("box", f"fields/{field}/evaluate", {"points": asked}).json
            for result, distance in zip(answer["results"], distances):
                self.assertLessEqual(abs(result["distance"] - distance), 1e-12)
            self.check_wedges_as_json(target, found)
            a, b = edges[9]
            _, one = self.forms("GET", f"box/fields/{field}/wedges?edge={b}-{a}")
            self.assertEqual((one["edges"], one["wedges"]), ([(a, b)], found["wedges"][first[9]:first[10]]))
            self.assertEqual((one["first"], one["sources"]), ([0, first[10] - first[9]], found["sources"][first[9]:first[10]]))
            answer = self.daemon.request("GET", target)
            self.assertEqual(self.assert_problem(answer, 400, "invalid_request")["parameter"], "edge")

    def check_wedges_as_json(self, target, found):
        for i in range(0, len(found["edges"]), 17):
            a, b = found["edges"][i]
            wedges = self.daemon.request("GET", f"{target}?edge={a}-{b}").json["wedges"]
            rows = range(found["first"][i], found["first"][i + 1])
            self.assertEqual([found["wedges"][k] for k in rows], [(w["b0"], w["b1"], w["d0"], w["d1"], w["sigma"]) for w in wedges])
            self.assertEqual(
                [found["sources"][k] for k in rows],
                [(w["source"].get("vertex", w["source"].get("member")), w["tau"] + 4 * ("vertex" in w["source"])) for w in wedges],
            )

    def test_points_of_lines_are_coordinates_unless_geometry_is_full(self):
        target = f"/v1/meshes/ball/fields/{self.field}/isolines?count=1"
        for more, kind in (("", list), ("&geometry=xyz", list), ("&geometry=full", dict)):
            lines = self.daemon.request("GET", target + more).json["isolines"][0]["lines"]
            self.assertIs(type(lines[0]["points"][0]), kind)
            bisectors = self.daemon.ask("ball", "voronoi" + more.replace("&", "?"), BALL).json["bisectors"]
            self.assertIs(type(bisectors[0]["points"][0]), kind)

    def test_large_ones_stream_and_end_at_the_limit(self):
        self.daemon.put("fine", sample("terrain", cells=500))
        field = self.daemon.ask("fine", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]
        target = f"/v1/meshes/fine/fields/{field}/values?format="
        values = self.daemon.request("GET", target + "json").json["values"]
        for form, size in (("f64", 8), ("f32", 4)):
            columns, found = arrays.read(self.daemon.request("GET", target + form).body)["values"]
            self.assertEqual(columns, 0)
            self.assert_same(found, values, 0 if size == 8 else 1e-6)
        with Daemon("--max-answer", "100000") as small:
            for level, status in ((5, 200), (6, 507)):
                small.put(f"ball{level}", sample("icosphere", level=level))
                field = small.ask(f"ball{level}", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]
                for form in ("f64", "npy", "npz"):
                    answer = small.request("GET", f"/v1/meshes/ball{level}/fields/{field}/values?format={form}")
                    self.assertEqual(answer.status, status, (form, answer))


if __name__ == "__main__":
    unittest.main()
