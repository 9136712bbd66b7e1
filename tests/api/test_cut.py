"""Tests cuts: the pieces as meshes, their maps, selections, names, refused cuts, and durability."""
import json
import random
import time
import unittest

from harness import SQUARE, TETRAHEDRON, TWO_TRIANGLES, Folder, TestCase, sample
from test_access import Keyed, digest, key_of, line

TIP = {"points": [{"edge": [0, 3], "t": 0.5}, {"edge": [1, 3], "t": 0.5}, {"edge": [2, 3], "t": 0.5}], "closed": True}


def square(low, high):
    """Returns a closed curve in the unit square."""
    corners = [(low, low), (high, low), (high, high), (low, high)]
    return {"points": [{"xyz": [x, y, 0], "max_snap": 1e-9} for x, y in corners], "closed": True}


def vertices(mesh):
    """Returns the positions of a mesh's OBJ file."""
    return [tuple(map(float, line.split()[1:])) for line in mesh.decode().splitlines() if line.startswith("v ")]


class Cut(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({
            "tetrahedron": TETRAHEDRON,
            "square": SQUARE,
            "apart": TWO_TRIANGLES,
            "grid": sample("grid", columns=10, rows=10),
            "torus": sample("torus"),
            "cylinder": sample("cylinder"),
            "terrain": sample("terrain", cells=24, amplitude=1),
            "a" * 127: SQUARE,
        })

    def cut(self, mesh, curve, options="", status=200, **more):
        answer = self.daemon.ask(mesh, f"cut{options}", {"curve": curve, **more})
        self.assertEqual(answer.status, status, answer)
        return answer.json

    def describe(self, name):
        answer = self.daemon.get(f"/v1/meshes/{name}")
        self.assertEqual(answer.status, 200, answer)
        return answer.json

    def refusal(self, mesh, document, code="invalid_request", status=400):
        return self.assert_problem(self.daemon.ask(mesh, "cut", document), status, code)

    # --- pieces ----------------------------------------------------------------------------------

    def test_the_example(self):
        operation = self.daemon.get("/openapi.json").json["paths"]["/v1/meshes/{name}/cut"]["post"]
        request = operation["requestBody"]["content"]["application/json"]["example"]
        example = operation["responses"]["200"]["content"]["application/json"]["example"]
        answer = self.cut("tetrahedron", **request)
        areas = [[piece.pop("area") for piece in told["pieces"]] for told in (answer, example)]
        self.assertEqual(answer, example)
        for given, told in zip(*areas):
            self.assertAlmostEqual(given, told, 12)

    def test_pieces_are_meshes(self):
        answer = self.cut("grid", square(0.15, 0.65), names=["frame", "window"])
        self.assertTrue(answer["separates"])
        self.assertEqual([piece["name"] for piece in answer["pieces"]], ["frame", "window"])
        parent = vertices(self.daemon.get("/v1/meshes/grid/content?format=obj").body)
        for piece, area, boundaries in zip(answer["pieces"], (0.75, 0.25), (2, 1)):
            description = self.describe(piece["name"])
            self.assertAlmostEqual(piece["area"], area, 12)
            self.assertAlmostEqual(description["area"], area, 12)
            self.assertEqual((description["index_count"], description["vertices"], description["faces"]),
                             (piece["vertices"], piece["vertices"], piece["faces"]))
            self.assertEqual((len(description["boundaries"]), description["components"]), (boundaries, 1))
            self.assertEqual((len(piece["vertex_map"]), len(piece["face_map"])), (piece["vertices"], piece["faces"]))
            self.assertEqual(piece["face_map"], sorted(piece["face_map"]))
            own = vertices(self.daemon.get(f"/v1/meshes/{piece['name']}/content?format=obj").body)
            for index, (position, origin) in enumerate(zip(own, piece["vertex_map"])):
                if origin is not None:
                    self.assertEqual(position, parent[origin], index)
        faces = set(answer["pieces"][0]["face_map"]) | set(answer["pieces"][1]["face_map"])
        self.assertEqual(faces, set(range(200)))

    def test_pieces_answer_queries(self):
        """No distance on a piece is shorter than the distance on the whole mesh. In the piece with
        the hole, distances between opposite sides of the hole are longer."""
        [frame] = self.cut("grid", square(0.15, 0.65), inside={"vertex": 0}, names=["holed"])["pieces"]
        ask = lambda name, a, b: self.daemon.get(f"/v1/meshes/{name}/distance?from={a}&to={b}").json["distance"]
        across = ask("holed", "p:0.1,0.4,0", "p:0.7,0.4,0")
        self.assertAlmostEqual(across, 2 * (0.05**2 + 0.25**2) ** 0.5 + 0.5, 9)
        self.assertAlmostEqual(ask("grid", "p:0.1,0.4,0", "p:0.7,0.4,0"), 0.6, 9)
        chance = random.Random(5)
        old = [i for i, origin in enumerate(frame["vertex_map"]) if origin is not None]
        for _ in range(50):
            a, b = chance.choice(old), chance.choice(old)
            whole = ask("grid", f"v:{frame['vertex_map'][a]}", f"v:{frame['vertex_map'][b]}")
            self.assertGreaterEqual(ask("holed", f"v:{a}", f"v:{b}"), whole * (1 - 1e-9))

    def test_a_loop_that_separates_nothing(self):
        ring = [{"xyz": [1 + 0.4 * x, 0, 0.4 * z]} for x, z in ((1, 0), (0, 1), (-1, 0), (0, -1))]
        answer = self.cut("torus", {"points": ring, "closed": True}, names=["tube"])
        self.assertFalse(answer["separates"])
        self.assertEqual(len(answer["pieces"]), 1)
        tube = self.describe("tube")
        self.assertEqual((tube["euler_characteristic"], tube["genus"], len(tube["boundaries"])), (0, 0, 2))
        self.assertAlmostEqual(tube["area"], self.meshes["torus"]["area"], 9)

    def test_from_boundary_to_boundary(self):
        answer = self.cut("grid", {"points": [{"xyz": [0.33, 0, 0]}, {"xyz": [0.33, 1, 0]}]}, names=["left", "right"])
        self.assertEqual(sorted(round(piece["area"], 12) for piece in answer["pieces"]), [0.33, 0.67])
        answer = self.cut("cylinder", {"points": [{"xyz": [1, 0.1, 0]}, {"xyz": [1, 0.1, 9]}]}, names=["sheet"])
        self.assertFalse(answer["separates"])
        self.assertEqual(self.describe("sheet")["euler_characteristic"], 1)

    def test_crossing_itself(self):
        corners = [(0.2, 0.2), (0.8, 0.8), (0.8, 0.2), (0.2, 0.8)]
        eight = {"points": [{"xyz": [x, y, 0]} for x, y in corners], "closed": True}
        answer = self.cut("grid", eight, select_only=True)
        self.assertEqual([round(piece["area"], 12) for piece in answer["pieces"]], [0.82, 0.09, 0.09])

    def test_along_vertices(self):
        ring = {"vertices": [12, 13, 24, 23], "closed": True}
        answer = self.cut("grid", ring, names=["around", "cell"])
        self.assertEqual(answer["pieces"][1]["vertex_map"], [12, 13, 23, 24])
        self.assertEqual(answer["largest_shift"], 0)

    def test_other_components_are_pieces(self):
        corner = {"points": [{"edge": [0, 1], "t": 0.5}, {"edge": [0, 2], "t": 0.5}]}
        answer = self.cut("apart", corner, names=["one", "two", "three"])
        self.assertEqual([piece["vertex_map"] for piece in answer["pieces"]], [[0, None, None], [1, 2, None, None], [3, 4, 5]]
                         if answer["pieces"][0]["faces"] == 1 else [[1, 2, None, None], [0, None, None], [3, 4, 5]])

    # --- selections ------------------------------------------------------------------------------

    def test_selections_make_no_meshes(self):
        names = {mesh["name"] for mesh in self.daemon.get("/v1/meshes?limit=1000").json["meshes"]}
        answer = self.cut("grid", square(0.2, 0.6), select_only=True)
        self.assertEqual([sorted(piece) for piece in answer["pieces"]], [["area", "face_map", "faces"]] * 2)
        self.assertEqual(sorted(answer["pieces"][0]["face_map"] + answer["pieces"][1]["face_map"]), list(range(200)))
        self.assertEqual(answer["pieces"][1]["faces"], 32)
        inside = self.cut("grid", square(0.2, 0.6), select_only=True, inside={"xyz": [0.4, 0.4, 0]})
        self.assertEqual(inside["pieces"], answer["pieces"][1:])
        self.assertTrue(inside["separates"])
        self.assertEqual({mesh["name"] for mesh in self.daemon.get("/v1/meshes?limit=1000").json["meshes"]}, names)

    def test_a_point_on_the_curve(self):
        on = {"xyz": [0.2, 0.4, 0]}
        self.assertIn("inside", self.refusal("grid", {"curve": square(0.2, 0.6), "inside": on})["detail"])

    def test_fields(self):
        curve = square(0.2, 0.6)
        self.assertEqual(self.cut("grid", curve, "?select=separates", select_only=True), {"separates": True})
        areas = self.cut("grid", curve, "?select=area", select_only=True)
        self.assertEqual([list(piece) for piece in areas["pieces"]], [["area"], ["area"]])
        pieces = self.cut("grid", curve, "?select=pieces", names=["b1", "b2"])
        self.assertEqual(list(pieces), ["pieces"])
        self.assertEqual(list(pieces["pieces"][0]), ["name", "vertices", "faces", "area", "vertex_map", "face_map"])

    # --- names -----------------------------------------------------------------------------------

    def test_names(self):
        self.daemon.put("mine", sample("grid", columns=4, rows=4))
        answer = self.cut("mine", square(0.25, 0.5))
        self.assertEqual([piece["name"] for piece in answer["pieces"]], ["mine-1", "mine-2"])
        # the repeated request changes nothing
        self.assertEqual(self.cut("mine", square(0.25, 0.5)), answer)
        problem = self.refusal("mine", {"curve": square(0.25, 0.75)}, "conflict", 409)
        self.assertIn("mine-1", problem["detail"])
        self.assertAlmostEqual(self.describe("mine-2")["area"], 0.0625, 12)
        # meshes of the requested names are replaced, as by PUT
        answer = self.cut("mine", square(0.25, 0.75), names=["mine-2", "mine"])
        self.assertAlmostEqual(self.describe("mine")["area"], 0.25, 12)
        self.assertAlmostEqual(self.describe("mine-2")["area"], 0.75, 12)

    def test_invalid_names(self):
        curve = square(0.25, 0.5)
        for names, pointer in ((["one"], "/names"), (["a", "b", "c"], "/names"), ([], "/names"), ("ab", "/names"),
                               (["a", "b/c"], "/names/1"), (["a", 3], "/names/1"), (["a"] * 65, "/names")):
            with self.subTest(names=names):
                self.assertEqual(self.refusal("grid", {"curve": curve, "names": names})["pointer"], pointer)
        self.refusal("grid", {"curve": curve, "names": ["same", "same"]})
        self.refusal("grid", {"curve": curve, "names": ["a", "b"], "select_only": True})
        self.refusal("a" * 127, {"curve": square(0.25, 0.5)})
        self.assertEqual(self.daemon.get("/v1/meshes/same").status, 404)

    def test_more_pieces_than_names(self):
        """A cut into 65 pieces exceeds the limit. The same cut is accepted if the request selects
        one piece."""
        triangles = [f"v {3 * i} 0 0\nv {3 * i + 1} 0 0\nv {3 * i} 1 0\nf -3 -2 -1\n" for i in range(64)]
        self.daemon.put("many", "".join(triangles).encode())
        corner = {"points": [{"edge": [0, 1], "t": 0.5}, {"edge": [0, 2], "t": 0.5}]}
        self.assertEqual(self.refusal("many", {"curve": corner}, "too_large", 413)["limit"], 64)
        self.assertEqual(len(self.cut("many", corner, inside={"vertex": 0})["pieces"]), 1)
        self.assertEqual(len(self.cut("many", corner, select_only=True)["pieces"]), 65)

    # --- refusals --------------------------------------------------------------------------------

    def test_invalid_curves(self):
        point = {"vertex": 0}
        cases = [
            ("grid", {}, "/curve"),
            ("grid", {"points": [point], "vertices": [1]}, "/curve"),
            ("grid", {"points": []}, "/curve/points"),
            ("grid", {"points": {}}, "/curve/points"),
            ("grid", {"points": [{"vertex": 500}, point]}, "/curve/points/0"),
            ("grid", {"points": [point], "closed": 1}, "/curve/closed"),
            ("grid", {"points": [point], "open": True}, "/curve/open"),
            ("grid", {"vertices": []}, "/curve/vertices"),
            ("grid", {"vertices": [1, -1]}, "/curve/vertices/1"),
            ("grid", {"vertices": [0, 5]}, "/curve"),
            ("grid", {"vertices": [0, 500]}, "/curve"),
            ("grid", {"boundary": 1}, "/curve"),
            ("grid", {"boundary": "all"}, "/curve/boundary"),
            ("grid", {"boundary": 0, "closed": True}, "/curve/closed"),
            ("grid", {"spline": {"points": [point]}}, "/curve/spline/points"),
            ("apart", {"points": [{"vertex": 0}, {"vertex": 4}]}, "/curve"),
            ("grid", [], "/curve"),
        ]
        for mesh, curve, pointer in cases:
            with self.subTest(curve=curve):
                self.assertEqual(self.refusal(mesh, {"curve": curve})["pointer"], pointer)
        self.assertEqual(self.refusal("grid", {})["pointer"], "/curve")
        self.refusal("grid", {"curve": {"points": [point] * 4097}}, "too_large", 413)

    def test_curves_that_cut_nothing(self):
        inner, rim = {"xyz": [0.33, 0.4, 0]}, {"xyz": [0.33, 0, 0]}
        for curve, word in (({"boundary": 0}, "nothing"), ({"points": [inner, rim], "closed": True}, "nothing"),
                            ({"points": [inner, rim]}, "first point"), ({"points": [rim, inner]}, "last point")):
            with self.subTest(curve=curve):
                self.assertIn(word, self.refusal("grid", {"curve": curve})["detail"])

    def test_invalid_requests(self):
        curve = square(0.2, 0.6)
        self.assertEqual(self.refusal("grid", {"curve": curve, "inside": {"vertex": 500}})["pointer"], "/inside")
        self.assertEqual(self.refusal("grid", {"curve": curve, "select_only": "yes"})["pointer"], "/select_only")
        self.assertEqual(self.refusal("grid", {"curve": curve, "along": 1})["pointer"], "/along")
        self.assertEqual(self.daemon.ask("nowhere", "cut", {"curve": curve}).status, 404)
        self.assertEqual(self.daemon.get("/v1/meshes/grid/cut").status, 405)
        stale = {"Content-Type": "application/json", "If-Match": '"stale"'}
        self.assertEqual(self.daemon.request("POST", "/v1/meshes/grid/cut", "{}", stale).status, 412)

    # --- jobs ------------------------------------------------------------------------------------

    def test_as_a_job(self):
        headers = {"Content-Type": "application/json", "Prefer": "respond-async"}
        body = '{"curve": {"points": [{"vertex": 60}, {"vertex": 500}, {"vertex": 320}], "closed": true}}'
        accepted = self.daemon.request("POST", "/v1/meshes/terrain/cut", body, headers)
        self.assertEqual(self.daemon.ended(accepted)["state"], "done")
        areas = [self.describe(f"terrain-{i}")["area"] for i in (1, 2)]
        self.assertAlmostEqual(sum(areas), self.meshes["terrain"]["area"], 9)


class Narrow(TestCase):
    flags = ("--memory-budget", "24MiB", "--max-body", "4MiB", "--landmarks", "0")

    def test_over_the_budget(self):
        """A cut that exceeds the memory budget is refused and creates no mesh."""
        self.assertEqual(self.daemon.put("grid", sample("grid", columns=126, rows=126)).status, 201)
        before = self.daemon.get("/v1/meshes").json
        answer = self.daemon.ask("grid", "cut", {"curve": square(0.2, 0.6)})
        self.assert_problem(answer, 507, "insufficient_memory")
        names = lambda page: [mesh["name"] for mesh in page["meshes"]]
        self.assertEqual(names(self.daemon.get("/v1/meshes").json), names(before))


class Roles(Keyed):
    keys = (line("reader") + line("writer", "role=write") +
            f"stranger sha256:{digest(key_of('stranger'))} tenant=another role=write\n")

    def test_a_cut_makes_meshes(self):
        """A cut needs a key that may write, and the pieces belong to the key's tenant."""
        body = json.dumps({"curve": square(0.2, 0.6)})
        self.assertEqual(self.ask("PUT", "/v1/meshes/square", "writer", SQUARE).status, 201)
        self.assert_problem(self.ask("POST", "/v1/meshes/square/cut", "reader", body), 403, "forbidden")
        self.assertEqual(self.ask("POST", "/v1/meshes/square/cut", "writer", body).status, 200)
        self.assertEqual(self.ask("GET", "/v1/meshes/square-2", "reader").status, 200)
        self.assertEqual(self.ask("GET", "/v1/meshes/square-2", "stranger").status, 404)
        self.assertEqual(self.ask("POST", "/v1/meshes/square/cut", "stranger", body).status, 404)


class Durable(Folder):
    def test_pieces_survive_a_restart(self):
        with self.start() as daemon:
            daemon.put("grid", sample("grid", columns=10, rows=10))
            answer = daemon.ask("grid", "cut", {"curve": square(0.15, 0.65), "names": ["frame", "window"]})
            self.assertEqual(answer.status, 200, answer)
            files = [daemon.get(f"/v1/meshes/{name}/content?format=ply").body for name in ("frame", "window")]
        with self.start() as daemon:
            for name, file, piece in zip(("frame", "window"), files, answer.json["pieces"]):
                self.assertEqual(daemon.get(f"/v1/meshes/{name}/content?format=ply").body, file)
                self.assertEqual(daemon.get(f"/v1/meshes/{name}").json["faces"], piece["faces"])
            distance = daemon.get("/v1/meshes/frame/distance?from=p:0.1,0.4,0&to=p:0.7,0.4,0").json["distance"]
            self.assertAlmostEqual(distance, 2 * (0.05**2 + 0.25**2) ** 0.5 + 0.5, 9)


if __name__ == "__main__":
    unittest.main()
