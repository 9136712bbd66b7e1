"""Compares evaluation with verb-nurbs, three and rhino3dm. Each of these programs evaluates its own
surface and returns this surface as a file. The programs are npm packages for this test only, which
`make nurbs-peers` installs below the build directory. Without these packages or without node, the
test is skipped."""
import json
import math
import pathlib
import random
import shutil
import subprocess
import unittest

from harness import PROGRAM
from nurbs import Nurbs, bumps, rational_sphere, rational_torus

PEERS = PROGRAM.parent / "peers"
SCRIPT = pathlib.Path(__file__).with_name("nurbs_peers.mjs")
PLACES = 200
NAMES = ("xyz", "du", "dv", "duu", "duv", "dvv")
# largest permitted error, relative to the largest coordinate or derivative of the same kind on the
# surface
PROMISE = 1e-12


def uneven(chance, count, degree, low, high, most):
    """Returns clamped knots at uneven distances, some of them repeated up to `most` times."""
    inner = []
    while len(inner) < count - degree - 1:
        times = min(chance.randint(1, most), count - degree - 1 - len(inner))
        inner += [chance.uniform(low, high)] * times
    return [low] * (degree + 1) + sorted(inner) + [high] * (degree + 1)


def wild(seed, degrees, counts, domain):
    """Returns a surface over a grid, with uneven knots, and weights from 1/4 to 4."""
    chance = random.Random(seed)
    rows, columns = counts
    return {"degreeU": degrees[0], "degreeV": degrees[1],
            "knotsU": uneven(chance, rows, degrees[0], *domain[0], degrees[0]),
            "knotsV": uneven(chance, columns, degrees[1], *domain[1], degrees[1]),
            "controlPoints": [[[i, j, chance.uniform(-2, 2)] for j in range(columns)] for i in range(rows)],
            "weights": [[4 ** chance.uniform(-1, 1) for _ in range(columns)] for _ in range(rows)]}


def surfaces():
    """Yields a name, a surface, and points at which the surface is smooth. No point lies on a knot,
    because programs choose different one-sided derivatives at knots."""
    chance = random.Random(1)
    whole = {"torus": rational_torus(), "sphere": rational_sphere(), "bumps": bumps(9, 7, 1, 2),
             "quadric": wild(3, (2, 2), (6, 5), ((0, 1), (0, 1))), "uneven": wild(4, (3, 2), (9, 8), ((-1.5, 7), (2, 2.25))),
             "high": wild(5, (5, 4), (11, 9), ((0, 3), (-2, 2))), "ruled": wild(6, (1, 3), (5, 10), ((0, 1), (10, 20)))}
    for name, surface in whole.items():
        surface.setdefault("weights", [[1] * len(row) for row in surface["controlPoints"]])
        ranges = [(surface[f"knots{d}"][0], surface[f"knots{d}"][-1]) for d in "UV"]
        surface["uv"] = [[chance.uniform(*r) for r in ranges] for _ in range(PLACES)]
    return whole


@unittest.skipUnless(shutil.which("node") and (PEERS / "complete").exists(), "needs node and `make nurbs-peers`")
class Peers(Nurbs):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ours = surfaces()
        done = subprocess.run(["node", SCRIPT, PEERS / "node_modules"], input=json.dumps({"surfaces": list(cls.ours.values())}), text=True, check=True,
                              stdout=subprocess.PIPE, timeout=60)
        cls.theirs = dict(zip(cls.ours, json.loads(done.stdout.splitlines()[-1])))

    def check_values(self, surface, program):
        peer = self.theirs[surface][program]
        name = f"{surface}-{program}"
        answer = self.put(name, peer["file"], f"?convention={program}")
        self.assertEqual(answer.status, 201, answer)
        points = self.ask(name, "evaluate", {"uv": self.ours[surface]["uv"]})["points"]
        self.assertEqual(len(points), len(peer["values"]))
        worst = 0
        for k in range(len(peer["values"][0])):
            size = max(math.hypot(*row[k]) for row in peer["values"])
            off = max(math.dist(point[NAMES[k]], row[k]) for point, row in zip(points, peer["values"]))
            self.assertLessEqual(off, PROMISE * size, (name, NAMES[k]))
            worst = max(worst, off / size if size else 0)
        return worst

    def check_program(self, program):
        worst = max(self.check_values(surface, program) for surface in self.ours)
        print(f"# {program}: {len(self.ours)} surfaces, {PLACES} places each, largest difference {worst:.1e} of its kind")

    def test_verb(self):
        """Compares positions, first and second derivatives."""
        self.check_program("verb")

    def test_three_js(self):
        self.check_program("three")

    def test_rhino(self):
        self.check_program("rhino")


if __name__ == "__main__":
    unittest.main()
