"""Tests tessellations, which are meshes of parametric surfaces with (u, v) of each vertex."""
import array
import math
import unittest

from harness import SQUARE, form_tag
from nurbs import PI, SADDLE, TORUS, Nurbs, bumps, rational_sphere, rational_torus


class Tessellations(Nurbs):
    surfaces = {"ring": TORUS, "torus": rational_torus(), "sphere": rational_sphere(), "saddle": SADDLE, "bumps": bumps(8, 4, 0.5, 1)}

    def tessellate(self, name, status=201, **document):
        answer = self.post(name, "tessellate", document)
        self.assertEqual(answer.status, status, answer)
        return answer

    def vertices(self, mesh):
        text = self.daemon.get(f"/v1/meshes/{mesh}/content?format=obj").body.decode()
        return [tuple(map(float, row.split()[1:])) for row in text.splitlines() if row.startswith("v ")]

    def test_vertices_have_their_parameters(self):
        for name in self.surfaces:
            with self.subTest(name=name):
                made = self.tessellate(name, mesh=f"{name}-mesh", resolution=[12, 10])
                self.assertEqual(made.headers["Location"], f"/v1/meshes/{name}-mesh")
                self.assertEqual(made.json, self.daemon.get(f"/v1/meshes/{name}-mesh").json)
                self.assertEqual(made.headers["ETag"].strip('"'), made.json["etag"])
                answer = self.daemon.get(f"/v1/meshes/{name}-mesh/parameters")
                told = answer.json
                self.assertEqual(answer.headers["ETag"], form_tag(made.headers["ETag"], "json"))
                self.assertEqual(told["nurbs"], {"name": name, "etag": self.descriptions[name]["etag"]})
                self.assertEqual(len(told["uv"]), made.json["index_count"])
                points = self.ask(name, "evaluate", {"uv": told["uv"]}, "?select=points,xyz")["points"]
                for vertex, point in zip(self.vertices(f"{name}-mesh"), points):
                    self.assert_close(point["xyz"], vertex, 1e-15)

    def test_closed_directions_and_poles(self):
        count = lambda name, m, n: self.tessellate(name, mesh="counted", resolution=[m, n], status=self.status()).json
        self.made = False
        ring = count("ring", 12, 10)
        self.assertEqual((ring["vertices"], ring["faces"], ring["genus"], ring["boundaries"]), (120, 240, 1, []))
        self.assertEqual(self.daemon.get("/v1/meshes/counted/parameters").json["periods"], [2 * PI, 2 * PI])
        ball = count("sphere", 12, 10)
        self.assertEqual((ball["vertices"], ball["faces"], ball["euler_characteristic"]), (12 * 9 + 2, 12 * 18, 2))
        self.assertEqual(self.daemon.get("/v1/meshes/counted/parameters").json["periods"], [1, None])
        sheet = count("saddle", 3, 5)
        self.assertEqual((sheet["vertices"], sheet["faces"]), (24, 30))

    def status(self):
        """The status is 201 the first time, and 200 when the name has a mesh."""
        made, self.made = self.made, True
        return 200 if made else 201

    def test_tolerance(self):
        """Midpoints of edges are within about the tolerance of the surface. With a finer tolerance,
        they are nearer to the surface."""
        counts = []
        for tolerance in (0.1, 0.01, 0.001):
            made = self.tessellate("ring", 201 if tolerance == 0.1 else 200, mesh="fine", tolerance=tolerance).json
            counts.append(made["faces"])
            text = self.daemon.get("/v1/meshes/fine/content?format=obj").body.decode().splitlines()
            vertices = [tuple(map(float, row.split()[1:])) for row in text if row.startswith("v ")]
            faces = [[int(i) - 1 for i in row.split()[1:]] for row in text if row.startswith("f ")]
            worst = 0
            for a, b, c in faces:
                for i, j in ((a, b), (b, c), (c, a)):
                    x, y, z = ((p + q) / 2 for p, q in zip(vertices[i], vertices[j]))
                    worst = max(worst, abs(math.hypot(math.hypot(x, y) - 2, z) - 1))
            self.assertLess(worst, 1.5 * tolerance)
        self.assertLess(counts[0] * 5, counts[1])
        self.assertLess(counts[1] * 5, counts[2])

    def test_the_mesh_is_a_mesh(self):
        """Distances on the mesh converge to the distances on the surface, from above or below. The
        error decreases with the square of the mesh's edge length."""
        self.tessellate("ring", mesh="near", resolution=[160, 80])
        uv = self.daemon.get("/v1/meshes/near/parameters").json["uv"]
        to = min(range(len(uv)), key=lambda i: math.dist(uv[i], [PI / 2, PI / 2]))
        self.assert_close(uv[to], [PI / 2, PI / 2], 1e-12)
        distance = self.daemon.get(f"/v1/meshes/near/distance?from=v:{uv.index([0, 0])}&to=v:{to}").json["distance"]
        self.assertLess(abs(distance / 4.0618928974654 - 1), 2e-3)

    def test_float64(self):
        self.tessellate("bumps", mesh="packed", resolution=[6, 5])
        whole = self.daemon.get("/v1/meshes/packed/parameters").json["uv"]
        packed = array.array("d", self.daemon.get("/v1/meshes/packed/parameters", Accept="application/octet-stream").body)
        self.assertEqual(list(packed), [x for pair in whole for x in pair])
        self.assertEqual(set(self.daemon.get("/v1/meshes/packed/parameters?select=periods").json), {"periods"})

    def test_only_of_tessellations(self):
        self.tessellate("saddle", mesh="taken", resolution=[4, 4])
        self.assertEqual(self.daemon.get("/v1/meshes/taken/parameters").status, 200)
        self.assertEqual(self.daemon.put("taken", SQUARE).status, 200)
        self.assert_problem(self.daemon.get("/v1/meshes/taken/parameters"), 404, "not_found")
        self.assert_problem(self.daemon.get("/v1/meshes/nowhere/parameters"), 404, "not_found")

    def test_invalid_requests(self):
        for pointer, document in (
            ("", {"mesh": "m"}), ("", {"mesh": "m", "tolerance": 1, "resolution": [4, 4]}), ("/mesh", {"tolerance": 1}),
            ("/mesh", {"mesh": 3, "tolerance": 1}), ("/mesh", {"mesh": "a b", "tolerance": 1}), ("/tolerance", {"mesh": "m", "tolerance": 0}),
            ("/tolerance", {"mesh": "m", "tolerance": "fine"}), ("/resolution", {"mesh": "m", "resolution": [2, 5]}),
            ("/resolution", {"mesh": "m", "resolution": 5}), ("/level", {"mesh": "m", "resolution": [5, 5], "level": 1}),
        ):
            with self.subTest(document=document):
                self.assertEqual(self.refusal("saddle", "tessellate", document)["pointer"], pointer)
        self.assert_problem(self.post("saddle", "tessellate", {"mesh": "m", "resolution": [100000, 100000]}), 413, "too_large")
        problem = self.assert_problem(self.post("ring", "tessellate", {"mesh": "m", "tolerance": 1e-12}), 413, "too_large")
        self.assertEqual(problem["pointer"], "/tolerance")
        self.assert_problem(self.daemon.get("/v1/meshes/m"), 404, "not_found")


class Limited(Nurbs):
    surfaces = {"ring": TORUS}
    flags = ("--max-faces", "5000")

    def test_a_tolerance_beyond_max_faces(self):
        problem = self.assert_problem(self.post("ring", "tessellate", {"mesh": "m", "tolerance": 1e-3}), 413, "too_large")
        self.assertEqual((problem["limit"], problem["pointer"]), (5000, "/tolerance"))


if __name__ == "__main__":
    unittest.main()
