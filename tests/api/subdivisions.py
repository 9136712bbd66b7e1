"""Helpers of the tests of subdivision surfaces: control meshes, known values, and a daemon that has
the surfaces."""
import json
import math

from harness import SQUARE, TestCase

# the cube [-1,1]^3; face 0 is z = 1 and starts at (-,-)
CUBE = (b"v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        b"f 5 6 8 7\nf 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n")
CUBE_USD = {"points": [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], "faceVertexCounts": [4] * 6,
            "faceVertexIndices": [4, 5, 7, 6, 0, 2, 3, 1, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]}
OCTAHEDRON = (b"v 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
              b"f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n")
PRISM = b"v 1 0 0\nv 0 1 0\nv -1 -1 0\nv 1 0 2\nv 0 1 2\nv -1 -1 2\nf 3 2 1\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n"
TWO_QUADS = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nf 1 2 3 4\nf 5 6 7 8\n"
MIDDLE = {"face": 0, "uv": [0.5, 0.5]}
MIRROR = 5.344803240448  # length of the closed geodesic of the smoothed cube in the plane y = 0
# length of the closed geodesic in the plane x = y, which passes through four vertices of valence 3
DIAGONAL = 5.384418260817


class Subdivisions(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, body, options in [("cube", CUBE, ""), ("loop", OCTAHEDRON, "?scheme=loop"), ("prism", PRISM, ""),
                                    ("sheet", SQUARE.replace(b"f 1 2 3\nf 1 3 4", b"f 1 2 3 4"), ""),
                                    ("pair", TWO_QUADS, "")]:
            answer = cls.put(name, body, options)
            assert answer.status == 201, answer

    @classmethod
    def put(cls, name, body, options="", **headers):
        if isinstance(body, dict):
            body, headers = json.dumps(body), {"Content-Type": "application/json", **headers}
        return cls.daemon.request("PUT", f"/v1/subdivisions/{name}{options}", body, headers)

    def ask(self, name, query, document, status=200, **headers):
        answer = self.daemon.request("POST", f"/v1/subdivisions/{name}/{query}", json.dumps(document),
                                     {"Content-Type": "application/json", **headers})
        self.assertEqual(answer.status, status, answer)
        return answer.json if answer.body else None

    def assert_near(self, actual, expected, absolute=1e-12):
        self.assertLess(math.dist(actual, expected), absolute, (actual, expected))
