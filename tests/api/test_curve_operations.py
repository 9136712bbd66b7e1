"""Tests operations on curves: length, resampling, shortening, closed geodesics, offsets."""
import math
import unittest

from harness import TestCase, sample


def place(x, y, z=0):
    return {"xyz": [x, y, z]}


class CurveOperations(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({
            "grid": sample("grid", columns=20, rows=20),
            "tube": sample("cylinder", radius=1, height=2, sides=24, rings=12),
            "sphere": sample("icosphere", level=3),
        })

    def ask(self, mesh, document, status=200):
        return self.asked(mesh, "curve", document, status)

    def test_length(self):
        corner = {"points": [place(0.2, 0.2), place(0.8, 0.2), place(0.8, 0.6)]}
        answer = self.ask("grid", {"curve": corner, "operation": "length"})
        self.assertAlmostEqual(answer["path"]["length"], 1, 12)
        self.assertEqual(set(answer), {"path"})
        answer = self.ask("grid", {"curve": {**corner, "closed": True}, "operation": "length"})
        self.assertAlmostEqual(answer["path"]["length"], 1 + math.hypot(0.6, 0.4), 12)
        self.assertEqual(answer["path"]["points"][0], answer["path"]["points"][-1])
        self.assertAlmostEqual(self.ask("grid", {"curve": {"boundary": 0}, "operation": "length"})["path"]["length"], 4, 12)

    def test_resample(self):
        corner = {"points": [place(0.2, 0.2), place(0.8, 0.2), place(0.8, 0.6)]}
        answer = self.ask("grid", {"curve": corner, "operation": "resample", "count": 6})
        for i, point in enumerate(answer["points"]):
            s = i / 5
            for a, b in zip(point["xyz"], (0.2 + min(s, 0.6), 0.2 + max(s - 0.6, 0), 0)):
                self.assertAlmostEqual(a, b, 12)
        spline = {"spline": {"points": corner["points"]}}
        self.assertEqual(len(self.ask("grid", {"curve": spline, "operation": "resample", "count": 9})["points"]), 9)

    def test_shorten(self):
        detour = {"points": [place(0.1, 0.5), place(0.4, 0.9), place(0.6, 0.2), place(0.9, 0.5)]}
        answer = self.ask("grid", {"curve": detour, "operation": "shorten"})
        self.assertAlmostEqual(answer["path"]["length"], 0.8, 12)
        self.assertTrue(answer["geodesic"])
        lengths = []
        for rounds in (1, 2, 5, 20, 80):
            wanted = {"curve": detour, "operation": "shorten", "rounds": rounds, "pieces": 8}
            lengths.append(self.ask("grid", wanted)["path"]["length"])
        self.assertEqual(lengths, sorted(lengths, reverse=True))
        self.assertAlmostEqual(lengths[-1], 0.8, 3)

    def test_closed_geodesic(self):
        loop = {"points": [place(math.cos(a), math.sin(a), 1 + 0.4 * math.sin(3 * a)) for a in (0, 1, 2, 3, 4, 5)],
                "closed": True}
        answer = self.ask("tube", {"curve": loop, "operation": "closed-geodesic"})
        self.assertAlmostEqual(answer["path"]["length"], 48 * math.sin(math.pi / 24), 9)
        self.assertTrue(answer["geodesic"])
        self.assertLess(answer["turn"], 1e-9)
        cap = {"points": [{"vertex": 0}, {"vertex": 20}, {"vertex": 50}], "closed": True}
        self.assertIn("shrinks to a point",
                      self.ask("sphere", {"curve": cap, "operation": "closed-geodesic"}, 400)["detail"])

    def test_offset(self):
        segment = {"points": [place(0.3, 0.5), place(0.7, 0.55)]}
        answer = self.ask("grid", {"curve": segment, "operation": "offset", "distance": 0.1, "tolerance": 1e-6})
        self.assertEqual(len(answer["paths"]), 1)
        self.assertTrue(answer["paths"][0]["closed"])
        length = 2 * math.hypot(0.4, 0.05) + 2 * math.pi * 0.1
        self.assertAlmostEqual(answer["paths"][0]["path"]["length"], length, 4)
        answer = self.ask("tube", {"curve": {"boundary": 0}, "operation": "offset", "distance": 0.5})
        self.assertEqual(len(answer["paths"]), 1)
        self.assertAlmostEqual(answer["paths"][0]["path"]["length"], 48 * math.sin(math.pi / 24), 9)
        self.assertEqual(self.ask("grid", {"curve": segment, "operation": "offset", "distance": 9})["paths"], [])

    def test_refusals(self):
        curve = {"points": [place(0.2, 0.2), place(0.8, 0.2)]}
        for document, pointer in (
            ({"curve": curve}, "/operation"),
            ({"curve": curve, "operation": "melt"}, "/operation"),
            ({"operation": "length"}, "/curve"),
            ({"curve": curve, "operation": "length", "count": 3}, "/count"),
            ({"curve": curve, "operation": "resample"}, "/count"),
            ({"curve": curve, "operation": "resample", "count": 1}, "/count"),
            ({"curve": curve, "operation": "shorten", "rounds": 0}, "/rounds"),
            ({"curve": curve, "operation": "shorten", "pieces": 3}, "/pieces"),
            ({"curve": curve, "operation": "offset", "distance": -1}, "/distance"),
            ({"curve": {"points": []}, "operation": "length"}, "/curve/points"),
        ):
            self.assertEqual(self.ask("grid", document, 400)["pointer"], pointer, document)
        self.assertEqual(self.ask("grid", {"curve": curve, "operation": "closed-geodesic"}, 400)["code"], "invalid_request")
        dot = {"points": [place(0.2, 0.2)]}
        self.assertEqual(self.ask("grid", {"curve": dot, "operation": "resample", "count": 3}, 400)["code"],
                         "invalid_request")


if __name__ == "__main__":
    unittest.main()
