"""Answers as arrays of bytes: the numbers of the JSON answers."""
import io
import json
import math
import unittest
import zipfile

import arrays
from harness import TWO_TRIANGLES, Daemon, TestCase, sample

BALL = {"set": {"points": [{"vertex": 0}, {"vertex": 9}]}}


class Forms(TestCase):
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=4))
        cls.daemon.put("apart", TWO_TRIANGLES)
        cls.field = cls.daemon.ask("ball", "fields", BALL).json["id"]

    def forms(self, method, target, body=None):
        """The answer as JSON, and as each of its forms."""
        headers = {"Content-Type": "application/json"} if body is not None else {}
        body = None if body is None else json.dumps(body)
        mark = "&" if "?" in target else "?"
        answers = {}
        for form in ("json", "f64", "f32", "npy", "npz"):
            answer = self.daemon.request(method, f"/v1/meshes/{target}{mark}format={form}", body, headers)
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
            for source in body["sources"]:  # a field's distance can differ from a search's by a rounding
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

    def test_lines_have_bare_points_unless_full_ones_are_asked_for(self):
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
