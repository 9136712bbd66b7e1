"""Tests vectors between points: `log` and its inverse, the log map, transport, and means."""
import json
import math
import random
import unittest

from harness import SQUARE, TETRAHEDRON, TWO_TRIANGLES, TestCase, sample


def random_point(chance, faces):
    weights = [chance.expovariate(1) for _ in range(3)]
    return {"face": chance.randrange(faces), "barycentric": [weight / sum(weights) for weight in weights]}


class Vectors(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({
            "square": SQUARE,
            "tetrahedron": TETRAHEDRON,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=12, rows=12),
            "terrain": sample("terrain", cells=24, amplitude=1),
            "torus": sample("torus"),
            "ball": sample("icosphere", level=2),
            "loose": b"v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nf 1 3 4\n",
        })

    # --- log -------------------------------------------------------------------------------------

    def test_exp_of_log(self):
        for mesh in ("terrain", "torus", "grid"):
            chance = random.Random(mesh)
            faces = self.meshes[mesh]["faces"]
            start = random_point(chance, faces)
            targets = [random_point(chance, faces) for _ in range(20)]
            places = [self.asked(mesh, "nearest", {"point": target})["xyz"] for target in targets]
            vectors = self.asked(mesh, "log", {"from": start, "to": targets})["vectors"]
            few = self.asked(mesh, "log", {"from": start, "to": targets[:3]})["vectors"]
            for vector, other in zip(vectors, few):
                self.assertAlmostEqual(vector["length"], other["length"], 12)
                self.assertAlmostEqual(vector["direction"]["angle"], other["direction"]["angle"], 9)
            distances = self.asked(mesh, "matrix", {"sources": [start], "targets": targets})["distances"][0]
            answer = self.asked(mesh, "exp?geometry=none", {"start": start, "vectors": vectors})
            for vector, distance, point, place in zip(vectors, distances, answer["points"], places):
                self.assertAlmostEqual(vector["length"], distance, 12)
                self.assert_place(point["xyz"], place, 9)

    def test_first_vector_only(self):
        chance = random.Random(5)
        start, faces = random_point(chance, 1000), self.meshes["terrain"]["faces"]
        targets = [random_point(chance, faces) for _ in range(40)]
        whole = self.asked("terrain", "log", {"from": start, "to": targets})["vectors"]
        first = self.asked("terrain", "log", {"from": start, "to": targets, "first_vector_only": True})["vectors"]
        bent = 0
        for a, b in zip(whole, first):
            self.assertEqual(a["direction"], b["direction"])
            self.assertNotIn("segments", b)
            self.assertAlmostEqual(b["length"], a["segments"][0]["length"] if "segments" in a else a["length"], 12)
            if "segments" in a:
                bent += 1
                self.assertAlmostEqual(sum(part["length"] for part in a["segments"]), a["length"], 12)
        self.assertGreater(bent, 3)

    def test_to_all(self):
        answer = self.asked("grid", "log", {"from": {"xyz": [0.41, 0.37, 0]}, "to": "all"})
        content = self.daemon.get("/v1/meshes/grid/content?format=obj").body.decode()
        positions = [tuple(map(float, line.split()[1:])) for line in content.splitlines() if line.startswith("v ")]
        x, y, _ = answer["from"]["xyz"]
        self.assertEqual(len(answer["vectors"]), len(positions))
        for vector, position in zip(answer["vectors"], positions):
            dx, dy = position[0] - x, position[1] - y
            self.assertAlmostEqual(vector["length"], math.hypot(dx, dy), 12)
            self.assert_place(vector["direction"]["xyz"], [dx / vector["length"], dy / vector["length"], 0])

    def test_no_vectors(self):
        nowhere = {"direction": None, "length": None, "reason": "no_path"}
        zero = {"direction": None, "length": 0}
        answer = self.asked("apart", "log", {"from": {"vertex": 0}, "to": [{"vertex": 3}, {"vertex": 0}]})
        self.assertEqual(answer["vectors"], [nowhere, zero])
        answer = self.asked("apart", "log?select=vectors", {"from": {"vertex": 0}, "to": "all"})
        self.assertEqual(list(answer), ["vectors"])
        self.assertEqual([answer["vectors"][i] for i in (0, 3, 4, 5)], [zero] + [nowhere] * 3)
        answer = self.asked("loose", "log", {"from": {"vertex": 0}, "to": "all"})
        self.assertIsNone(answer["vectors"][1])
        self.assertEqual(answer["vectors"][2]["length"], 1)

    def test_log_refusals(self):
        for document, pointer in [({"to": "all"}, "/from"), ({"from": {"vertex": 0}}, "/to"),
                                  ({"from": {"vertex": 0}, "to": "some"}, "/to"), ({"from": {"vertex": 0}, "to": []}, "/to"),
                                  ({"from": {"vertex": 0}, "to": [1]}, "/to/0"),
                                  ({"from": {"vertex": 99}, "to": "all"}, "/from"),
                                  ({"from": {"vertex": 0}, "to": "all", "first_vector_only": 1}, "/first_vector_only")]:
            self.assertEqual(self.asked("square", "log", document, 400)["pointer"], pointer, document)

    def test_the_cut_locus(self):
        """Between the poles of a ball, several paths are equally short. The answers of vectors and
        means report this. A point next to the second pole has only one shortest path. The direction
        of this path jumps if the point moves across the pole."""
        pole, antipode = {"xyz": [0, 0, 1]}, {"xyz": [0, 0, -1]}
        beside = [{"xyz": [x, y, -1]} for x, y in ((0.1, 0.03), (-0.1, -0.02))]
        [vector, *others] = self.asked("ball", "log", {"from": pole, "to": [antipode, *beside]})["vectors"]
        self.assertTrue(vector["cut_locus"])
        self.assertTrue(all("cut_locus" not in other for other in others))
        self.assertGreater(math.dist(*(other["direction"]["xyz"] for other in others)), 1)
        from_field = self.asked("ball", "log", {"from": pole, "to": [antipode] * 9 + beside})["vectors"]
        self.assertTrue(all(other["cut_locus"] for other in from_field[:9]))
        self.assertNotIn("cut_locus", from_field[9])
        self.assertTrue(self.asked("ball", "mean", {"points": [pole, antipode]})["cut_locus"])
        self.assertFalse(self.asked("ball", "mean", {"points": [pole, {"xyz": [1, 0.2, 0.3]}]})["cut_locus"])

    # --- what log answers ------------------------------------------------------------------------

    def vectors_of_log(self):
        """Returns (mesh, start, targets, vectors). Some vectors belong to paths that bend at
        vertices, lie on a cut locus, or have length 0. Some targets have no vector, because no path
        leads to them or because they are vertices without faces."""
        chance = random.Random(8)
        faces = self.meshes["terrain"]["faces"]
        starts = [("terrain", random_point(chance, faces), [random_point(chance, faces) for _ in range(30)]),
                  ("ball", {"xyz": [0, 0, 1]}, [{"xyz": [0, 0, -1]}, {"xyz": [0, 0, 1]}, {"xyz": [1, 0, 0]}]),
                  ("apart", {"vertex": 0}, [{"vertex": 1}, {"vertex": 0}, {"vertex": 3}]),
                  ("loose", {"vertex": 0}, "all"), ("apart", {"vertex": 1}, "all"), ("ball", {"vertex": 5}, "all")]
        for mesh, start, targets in starts:
            for query in ("log", "log?select=vectors"):
                for first_only in (False, True):
                    document = {"from": start, "to": targets, "first_vector_only": first_only}
                    vectors = self.asked(mesh, query, document)["vectors"]
                    yield mesh, start, targets, vectors, first_only

    def test_exp_accepts_vectors_of_log(self):
        seen = set()
        for mesh, start, targets, vectors, first_only in self.vectors_of_log():
            seen.update(*(vector or {"null"} for vector in vectors))
            answer = self.asked(mesh, "exp", {"start": start, "vectors": vectors})
            if targets == "all":
                targets = [{"vertex": i} for i in range(len(vectors))]
            for vector, traced, point, path, target in zip(vectors, answer["vectors"], answer["points"], answer["paths"], targets):
                if vector is None or vector["length"] is None:
                    self.assertEqual(traced, {"direction": None, "length": None, "reason": "no_path"})
                    self.assertEqual([point, path], [None, None])
                    continue
                self.assertEqual(traced["direction"] is None, vector["direction"] is None)
                self.assertAlmostEqual(traced["length"], vector["length"], 12)
                if not first_only:
                    self.assert_place(point["xyz"], self.asked(mesh, "nearest", {"point": target})["xyz"], 8)
        self.assertLessEqual({"direction", "length", "segments", "cut_locus", "reason", "null"}, seen)

    def test_transport_accepts_vectors_of_log(self):
        for mesh, start, _, vectors, _ in self.vectors_of_log():
            document = {"from": start, "to": start, "vectors": vectors}
            moved = self.asked(mesh, "transport", document)["vectors"]
            for vector, other in zip(vectors, moved):
                if vector is None or vector["length"] is None:
                    self.assertEqual(other, {"direction": None, "length": None, "reason": "no_path"})
                    continue
                self.assertEqual(other["direction"] is None, vector["direction"] is None)
                self.assertAlmostEqual(other["length"], vector["length"], 12)
                if vector["direction"]:
                    self.assert_place(other["direction"]["xyz"], vector["direction"]["xyz"], 9)
            existing = [vector for vector in vectors if vector and vector["length"] is not None]
            document = {"vectors": existing, "combine": [1 / len(existing)] * len(existing)}
            [sum_there] = self.asked(mesh, "transport", {**document, "from": start, "to": start})["vectors"]
            [sum_here] = self.asked(mesh, "exp", {**document, "start": start})["vectors"]
            self.assertAlmostEqual(sum_here["length"], sum_there["length"], 12)

    def test_splines_accept_vectors_of_log(self):
        [cut, zero, *_] = self.asked("ball", "log", {"from": {"xyz": [0, 0, 1]}, "to": [{"xyz": [0, 0, -1]}, {"xyz": [0, 0, 1]}]})["vectors"]
        points = [{"xyz": [0, 0, 1]}, {"xyz": [0.5, 0, 0.8]}]
        for tangent in (cut, zero):
            answer = self.asked("ball", "spline", {"points": points, "tangents": [tangent, None]})
            self.assertAlmostEqual(answer["joints"][0]["tangent"]["length"], tangent["length"], 12)

    def test_vectors_that_log_does_not_return(self):
        zero = {"direction": None, "length": 0}
        nowhere = {"direction": None, "length": None, "reason": "no_path"}
        for vector, pointer in [({"direction": None, "length": 1}, "/vectors/0/direction"), ({"direction": 0, "length": None}, "/vectors/0/length"),
                                ({**zero, "cut_locus": 1}, "/vectors/0/cut_locus"), ({**zero, "reason": 1}, "/vectors/0/reason"),
                                ({**zero, "cut": True}, "/vectors/0/cut"), ({"segments": [zero]}, "/vectors/0/segments/0")]:
            for operation, ends in (("exp", {"start": {"vertex": 0}}), ("transport", {"from": {"vertex": 0}, "to": {"vertex": 1}})):
                self.assertEqual(self.asked("square", operation, {**ends, "vectors": [vector]}, 400)["pointer"], pointer, vector)
        for vector in (nowhere, None):
            document = {"start": {"vertex": 0}, "vectors": [zero, vector], "combine": [1, 0]}
            self.assertEqual(self.asked("square", "exp", document, 400)["pointer"], "/vectors/1")

    # --- transport -------------------------------------------------------------------------------

    def test_the_plane_turns_nothing(self):
        answer = self.asked("grid", "transport", {"from": {"xyz": [0.2, 0.3, 0]}, "to": {"xyz": [0.8, 0.71, 0]},
                                                "vectors": [{"direction": [1, 2, 0], "length": 3},
                                                            {"direction": [-1, 0.5, 0], "length": 0}]})
        self.assertAlmostEqual(answer["distance"], math.hypot(0.6, 0.41), 12)
        for vector, (x, y), length in zip(answer["vectors"], ((1, 2), (-1, 0.5)), (3, 0)):
            norm = math.hypot(x, y)
            self.assert_place(vector["direction"]["xyz"], [x / norm, y / norm, 0])
            self.assertEqual(vector["length"], length)

    def test_around_a_corner(self):
        """Transport around the right-angled corner of the tetrahedron turns a vector by the
        corner's angle defect, pi/2."""
        corners = [{"face": face, "barycentric": weights} for face, weights in
                   ((0, [0.8, 0.1, 0.1]), (2, [0.8, 0.1, 0.1]), (1, [0.8, 0.1, 0.1]))]
        vector = start = {"direction": 0.3, "length": 1}
        for i in range(3):
            document = {"from": corners[i], "to": corners[(i + 1) % 3], "vectors": [vector]}
            [vector] = self.asked("tetrahedron", "transport", document)["vectors"]
        turned = vector["direction"]["angle"] - start["direction"]
        self.assertAlmostEqual(abs(math.remainder(turned, 2 * math.pi)), math.pi / 2, 12)

    def test_sums_at_a_point(self):
        document = {"from": {"xyz": [0.4, 0.5, 0]}, "to": {"xyz": [0.4, 0.5, 0]}, "combine": [1, 1],
                    "vectors": [{"direction": [1, 0, 0], "length": 3}, {"direction": [0, 1, 0], "length": 4}]}
        answer = self.asked("grid", "transport", document)
        self.assertEqual(answer["distance"], 0)
        [vector] = answer["vectors"]
        self.assertAlmostEqual(vector["length"], 5, 12)
        self.assert_place(vector["direction"]["xyz"], [0.6, 0.8, 0])

    def test_off_the_surface(self):
        document = {"from": {"xyz": [0.5, 0.5, 0]}, "to": {"edge": [0, 1], "t": 0.5},
                    "vectors": [{"direction": [0, -1, 0], "length": 1}]}
        [vector] = self.asked("square", "transport", document)["vectors"]
        self.assert_place(vector["direction"]["xyz"], [0, -1, 0])
        document["to"] = {"vertex": 0}
        [vector] = self.asked("square", "transport", document)["vectors"]
        self.assert_place(vector["direction"]["xyz"], [0, -1, 0])

    def test_points_without_a_path(self):
        document = {"from": {"vertex": 0}, "to": {"vertex": 3}, "vectors": [{"direction": 0, "length": 1}]}
        answer = self.asked("apart", "transport?select=distance,vectors", document)
        self.assertEqual(answer, {"distance": None, "reason": "no_path", "vectors": None})

    def test_transport_refusals(self):
        vector = {"direction": 0.1, "length": 1}
        good = {"from": {"vertex": 0}, "to": {"vertex": 1}, "vectors": [vector]}
        for change, pointer in [({"from": None}, "/from"), ({"to": None}, "/to"), ({"vectors": None}, "/vectors"),
                                ({"vectors": [{"segments": [vector, vector]}]}, "/vectors"), ({"combine": []}, "/combine")]:
            document = {name: value for name, value in {**good, **change}.items() if value is not None}
            self.assertEqual(self.asked("square", "transport", document, 400)["pointer"], pointer, change)
        self.asked("square", "transport", {**good, "vectors": [{"direction": 3, "length": 1}]}, 422)

    # --- mean ------------------------------------------------------------------------------------

    def test_means_in_the_plane(self):
        points = [{"xyz": [0.1, 0.2, 0]}, {"xyz": [0.9, 0.3, 0]}, {"xyz": [0.4, 0.8, 0]}]
        for method in ("karcher", "one_step"):
            answer = self.asked("grid", "mean", {"points": points, "weights": [1, 2, 1], "method": method})
            self.assert_place(answer["point"]["xyz"], [(0.1 + 1.8 + 0.4) / 4, (0.2 + 0.6 + 0.8) / 4, 0])
            self.assertTrue(answer["converged"])
            self.assertLess(answer["residual"], 1e-12)

    def test_the_order_of_points_does_not_matter(self):
        chance = random.Random(3)
        points = [random_point(chance, self.meshes["terrain"]["faces"]) for _ in range(5)]
        answers = [self.asked("terrain", "mean", {"points": chance.sample(points, 5)}) for _ in range(4)]
        for answer in answers:
            self.assert_place(answer["point"]["xyz"], answers[0]["point"]["xyz"], 9)
            self.assertLess(answer["residual"], 1e-10 * answer["spread"])

    def test_mean_fields_and_refusals(self):
        point = {"vertex": 0}
        self.assertEqual(self.asked("square", "mean?select=converged", {"points": [point]}), {"converged": True})
        for document, pointer in [({}, "/points"), ({"points": []}, "/points"), ({"points": [point], "weights": [-1]}, "/weights"),
                                  ({"points": [point], "weights": [0]}, "/weights"), ({"points": [point], "weights": [1, 2]}, "/weights"),
                                  ({"points": [point], "method": "best"}, "/method")]:
            self.assertEqual(self.asked("square", "mean", document, 400)["pointer"], pointer, document)
        problem = self.asked("apart", "mean", {"points": [point, {"vertex": 4}]}, 400)
        self.assertIn("component", problem["detail"])
        self.assertEqual(self.asked("square", "mean", {"points": [point] * 1001}, 413)["limit"], 1000)

    def test_a_job(self):
        chance = random.Random(9)
        points = [random_point(chance, self.meshes["torus"]["faces"]) for _ in range(6)]
        headers = {"Content-Type": "application/json", "Prefer": "respond-async"}
        answer = self.daemon.request("POST", "/v1/meshes/torus/mean", json.dumps({"points": points}), headers)
        self.assertEqual(answer.status, 202)
        while (job := self.daemon.get(answer.headers["Location"]).json)["state"] in ("queued", "running"):
            pass
        self.assertEqual(job["state"], "done")
        self.assertTrue(job["result"]["converged"])


if __name__ == "__main__":
    unittest.main()
