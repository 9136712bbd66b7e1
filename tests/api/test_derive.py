"""Tests meshes that are made by edits: operations, origins, descriptions, files, refused edits, and
durability."""
import math
import struct
import time

from harness import TETRAHEDRON, TWO_TRIANGLES, Folder, TestCase, sample
from test_cut import vertices

SIMPLIFY = {"operation": "simplify", "faces": 100}


def faces(mesh):
    """Returns the corners of an OBJ file's triangles."""
    return [tuple(int(word.split("/")[0]) - 1 for word in line.split()[1:]) for line in mesh.decode().splitlines() if line.startswith("f ")]


class Derive(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({"sphere": sample("icosphere", level=3), "terrain": sample("terrain", cells=24),
                                  "apart": TWO_TRIANGLES, "tetrahedron": TETRAHEDRON,
                                  "tube": sample("cylinder", sides=20, rings=5)})

    def derive(self, mesh, *operations, name="made", status=201):
        self.daemon.request("DELETE", f"/v1/meshes/{name}")
        return self.asked(mesh, "derive", {"mesh": name, "operations": list(operations)}, status)

    def content(self, name):
        return self.daemon.get(f"/v1/meshes/{name}/content?format=obj").body

    def test_simplify(self):
        made = self.derive("sphere", SIMPLIFY)
        self.assertEqual((made["faces"], made["euler_characteristic"], made["boundary_count"]), (100, 2, 0))
        origin = made["derived_from"]
        self.assertEqual((origin["mesh"], origin["operations"]), ("sphere", [SIMPLIFY]))
        self.assertEqual(f'"{origin["etag"]}"', self.daemon.get("/v1/meshes/sphere").headers["ETag"])
        # the limit is four times the sagitta of an equilateral triangle of that area on the unit
        # sphere, since the triangles are irregular
        self.assertLess(origin["largest_distance"], 4 * (4 * 4 * math.pi / 100 / (3 * math.sqrt(3))) / 2)
        self.assertGreater(origin["largest_distance"], 0.01)

    def test_origins(self):
        self.derive("terrain", SIMPLIFY)
        told = self.daemon.get("/v1/meshes/made/origins").json
        self.assertEqual(told["mesh"]["name"], "terrain")
        original = self.content("terrain")
        positions, corners = vertices(original), faces(original)
        for place, (face, *weights) in zip(vertices(self.content("made")), told["origins"], strict=True):
            at = [sum(w * positions[corner][k] for w, corner in zip(weights, corners[int(face)])) for k in range(3)]
            self.assertEqual(tuple(at), place)
        raw = self.daemon.get("/v1/meshes/made/origins", Accept="application/octet-stream").body
        numbers = struct.unpack(f"<{len(raw) // 8}d", raw)
        self.assertEqual([list(numbers[i:i + 4]) for i in range(0, len(numbers), 4)], told["origins"])
        self.assert_problem(self.daemon.get("/v1/meshes/terrain/origins"), 404, "not_found")

    def test_a_bound_of_the_distance(self):
        bound = 0.01
        made = self.derive("terrain", {"operation": "simplify", "max_distance": bound})
        self.assertLessEqual(made["derived_from"]["largest_distance"], bound)
        self.assertLess(made["faces"], self.daemon.get("/v1/meshes/terrain").json["faces"])

    def test_keep_boundary(self):
        before = self.daemon.get("/v1/meshes/terrain").json["boundaries"]
        made = self.derive("terrain", {**SIMPLIFY, "faces": 300, "keep_boundary": True})
        self.assertEqual(made["boundaries"][0]["vertices"], before[0]["vertices"])
        self.assertEqual(made["derived_from"]["operations"][0]["keep_boundary"], True)

    def test_components(self):
        made = self.derive("apart", {"operation": "components"})
        self.assertEqual((made["faces"], made["components"]), (1, 1))
        self.assertEqual(self.daemon.get("/v1/meshes/made/origins").json["origins"], [[0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        self.assertEqual(self.derive("apart", {"operation": "components", "keep": 5})["components"], 2)
        second = self.derive("apart", {"operation": "components", "skip": 1})
        self.assertEqual(second["derived_from"]["operations"], [{"operation": "components", "keep": 1, "skip": 1}])
        self.assertEqual(self.daemon.get("/v1/meshes/made/origins").json["origins"][0], [1, 1, 0, 0])
        problem = self.assert_problem(self.daemon.ask("apart", "derive", {"mesh": "none", "operations": [{"operation": "components", "skip": 2}]}), 400, "invalid_request")
        self.assertEqual((problem["pointer"], "none of 2 components" in problem["detail"]), ("/operations/0/skip", True))
        body = {"mesh": "none", "operations": [{"operation": "components", "keep": 1}, {"operation": "components", "keep": 1, "skip": 1}]}
        self.assertEqual(self.assert_problem(self.daemon.ask("apart", "derive", body), 400, "invalid_request")["pointer"], "/operations/1/skip")

    def test_fill_smooth_subdivide(self):
        closed = self.derive("tube", {"operation": "fill"})
        self.assertEqual((closed["boundary_count"], closed["euler_characteristic"]), (0, 2))
        self.assertEqual(closed["derived_from"]["operations"], [{"operation": "fill", "max_edges": 1000}])
        left_open = self.derive("tube", {"operation": "fill", "max_edges": 5})
        self.assertEqual(left_open["boundary_count"], 2)
        smooth = self.derive("sphere", {"operation": "smooth", "iterations": 3, "along": "both"})
        self.assertEqual(smooth["derived_from"]["operations"],
                         [{"operation": "smooth", "iterations": 3, "along": "both", "feature_angle": 45}])
        self.assertLess(smooth["area"], self.daemon.get("/v1/meshes/sphere").json["area"])
        for scheme, factor in (("midpoint", 16), ("loop", 16), ("sqrt3", 9)):
            made = self.derive("tetrahedron", {"operation": "subdivide", "scheme": scheme, "levels": 2})
            self.assertEqual((made["faces"], made["euler_characteristic"]), (4 * factor, 2))

    def test_several_operations(self):
        made = self.derive("sphere", {"operation": "components"}, {**SIMPLIFY, "faces": 400}, SIMPLIFY)
        self.assertEqual((made["faces"], len(made["derived_from"]["operations"])), (100, 3))
        at_once = self.derive("sphere", SIMPLIFY, name="once")
        self.assertAlmostEqual(made["area"], at_once["area"], 0)

    def test_files(self):
        for form, begin in (("obj", b"v "), ("ply", b"ply\n"), ("glb", b"glTF")):
            answer = self.daemon.ask("sphere", "derive", {"format": form, "operations": [SIMPLIFY]})
            self.assertEqual(answer.status, 200, answer)
            self.assertTrue(answer.body.startswith(begin), answer.body[:20])
        answer = self.daemon.ask("sphere", "derive", {"format": "obj", "operations": [SIMPLIFY]})
        self.assertEqual(len(faces(answer.body)), 100)

    def test_replaces_as_an_upload_does(self):
        self.derive("sphere", SIMPLIFY)
        again = self.daemon.ask("sphere", "derive", {"mesh": "made", "operations": [SIMPLIFY]})
        self.assertEqual((again.status, again.headers["Location"]), (200, "/v1/meshes/made"))

    def test_a_job(self):
        self.daemon.request("DELETE", "/v1/meshes/later")
        job = self.daemon.ask("sphere", "derive", {"mesh": "later", "operations": [SIMPLIFY]}, {"Prefer": "respond-async"})
        self.assertEqual(job.status, 202)
        while (state := self.daemon.get(job.headers["Location"]).json)["state"] in ("queued", "running"):
            time.sleep(0.05)
        self.assertEqual((state["state"], state["progress"]), ("done", 1))
        self.assertEqual(self.daemon.get("/v1/meshes/later").json["faces"], 100)

    def test_refusals(self):
        good = {"mesh": "bad", "operations": [SIMPLIFY]}
        for document, pointer in (
                ({"operations": [SIMPLIFY]}, ""), ({**good, "format": "obj"}, ""), ({"mesh": "bad"}, "/operations"),
                ({**good, "operations": []}, "/operations"), ({**good, "operations": [SIMPLIFY] * 17}, "/operations"),
                ({**good, "operations": {}}, "/operations"), ({**good, "operations": [7]}, "/operations/0"),
                ({**good, "operations": [{}]}, "/operations/0/operation"),
                ({**good, "operations": [SIMPLIFY, {"operation": "melt"}]}, "/operations/1/operation"),
                ({**good, "operations": [{"operation": "simplify"}]}, "/operations/0"),
                ({**good, "operations": [{**SIMPLIFY, "faces": 3}]}, "/operations/0/faces"),
                ({**good, "operations": [{**SIMPLIFY, "faces": 10.5}]}, "/operations/0/faces"),
                ({**good, "operations": [{**SIMPLIFY, "max_distance": 0}]}, "/operations/0/max_distance"),
                ({**good, "operations": [{**SIMPLIFY, "keep": 1}]}, "/operations/0/keep"),
                ({**good, "operations": [{"operation": "components", "keep": 0}]}, "/operations/0/keep"),
                ({**good, "operations": [{"operation": "fill", "max_edges": 2}]}, "/operations/0/max_edges"),
                ({**good, "operations": [{"operation": "smooth", "iterations": 0}]}, "/operations/0/iterations"),
                ({**good, "operations": [{"operation": "smooth", "along": "x"}]}, "/operations/0/along"),
                ({**good, "operations": [{"operation": "smooth", "feature_angle": 181}]}, "/operations/0/feature_angle"),
                ({**good, "operations": [{"operation": "subdivide", "levels": 7}]}, "/operations/0/levels"),
                ({**good, "operations": [{"operation": "subdivide", "scheme": "butterfly"}]}, "/operations/0/scheme"),
                ({"format": "3mf", "operations": [SIMPLIFY]}, "/format"),
                ({"format": "stp", "operations": [SIMPLIFY]}, "/format"), ({**good, "mesh": "a b"}, "/mesh"),
                ({"format": "obj", "split": True, "operations": [SIMPLIFY]}, "/split"), ({**good, "split": 1}, "/split"),
                ({**good, "split": True, "operations": [SIMPLIFY] * 16}, "/operations"),
                ({**good, "split": True, "mesh": "m" * 126}, "/mesh")):
            with self.subTest(document=document):
                problem = self.assert_problem(self.daemon.ask("sphere", "derive", document), 400, "invalid_request")
                self.assertEqual(problem["pointer"], pointer, problem)
        self.assert_problem(self.daemon.ask("nowhere", "derive", good), 404, "not_found")
        self.assertEqual(self.daemon.get("/v1/meshes/bad").status, 404)


def apart(sizes):
    """Returns an OBJ file of separate right triangles of these sizes."""
    lines = [f"v {10 * i} 0 0\nv {10 * i + size} 0 0\nv {10 * i} {size} 0\nf {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i, size in enumerate(sizes)]
    return "".join(lines).encode()


class Split(TestCase):
    KEEP_ALL = {"operation": "components", "keep": 100}

    def split(self, sizes, *operations, status=201):
        self.daemon.put("whole", apart(sizes))
        return self.asked("whole", "derive", {"mesh": "part", "split": True, "operations": list(operations)}, status)

    def test_each_component_becomes_a_mesh(self):
        sizes = [1, 3, 2]
        parts = self.split(sizes, self.KEEP_ALL)["meshes"]
        self.assertEqual([part["name"] for part in parts], ["part-1", "part-2", "part-3"])
        self.assertEqual([part["area"] for part in parts], [4.5, 2, 0.5])
        whole = self.daemon.get("/v1/meshes/whole")
        for skip, (part, face) in enumerate(zip(parts, [1, 2, 0], strict=True)):
            self.assertEqual(part, self.daemon.get(f"/v1/meshes/{part['name']}").json)
            self.assertEqual(part["derived_from"]["mesh"], "whole")
            self.assertEqual(f'"{part["derived_from"]["etag"]}"', whole.headers["ETag"])
            pick = {"operation": "components", "keep": 1, **({"skip": skip} if skip else {})}
            self.assertEqual(part["derived_from"]["operations"], [self.KEEP_ALL, pick])
            self.assertEqual(part["derived_from"]["largest_distance"], 0)
            origins = self.daemon.get(f"/v1/meshes/{part['name']}/origins").json["origins"]
            self.assertEqual(origins, [[face, 1, 0, 0], [face, 0, 1, 0], [face, 0, 0, 1]])
            # the recorded operations make the same mesh again
            again = self.daemon.ask("whole", "derive", {"mesh": "again", "operations": part["derived_from"]["operations"]}).json
            self.assertEqual((again["sha256"], again["area"]), (part["sha256"], part["area"]))
            self.daemon.request("DELETE", "/v1/meshes/again")
        repeated = self.split(sizes, self.KEEP_ALL, status=200)["meshes"]
        self.assertEqual([part["etag"] for part in repeated], [part["etag"] for part in parts])

    def test_the_number_of_parts_is_bounded(self):
        for mesh in self.daemon.get("/v1/meshes?limit=100").json["meshes"]:
            self.daemon.request("DELETE", f"/v1/meshes/{mesh['name']}")
        self.assertEqual(len(self.split(range(1, 65), self.KEEP_ALL)["meshes"]), 64)
        self.daemon.put("whole", apart(range(1, 66)))
        document = {"mesh": "many", "split": True, "operations": [self.KEEP_ALL]}
        problem = self.assert_problem(self.daemon.ask("whole", "derive", document), 413, "too_large")
        self.assertEqual((problem["limit"], problem["pointer"]), (64, "/split"))
        self.assertIn("65 components", problem["detail"])
        self.assertEqual(self.daemon.get("/v1/meshes/many-1").status, 404)
        some = self.daemon.ask("whole", "derive", {**document, "operations": [{"operation": "components", "keep": 2}]})
        self.assertEqual(len(some.json["meshes"]), 2)

    def test_a_job(self):
        self.daemon.put("whole", apart([1, 2]))
        job = self.daemon.ask("whole", "derive", {"mesh": "later", "split": True, "operations": [self.KEEP_ALL]}, {"Prefer": "respond-async"})
        while (state := self.daemon.get(job.headers["Location"]).json)["state"] in ("queued", "running"):
            time.sleep(0.05)
        self.assertEqual((state["state"], state["progress"]), ("done", 1))
        self.assertEqual([self.daemon.get(f"/v1/meshes/later-{i}").json["area"] for i in (1, 2)], [2, 0.5])


class Upload(TestCase):
    """Tests edits of an upload. The result equals the result of `derive` on the mesh of the same
    file."""
    def upload(self, query, file, name="made", **headers):
        return self.daemon.request("PUT", f"/v1/meshes/{name}?{query}", file, {key.replace("_", "-"): value for key, value in headers.items()})

    def test_an_edited_upload_equals_derive(self):
        file = sample("cylinder", sides=20, rings=5)
        self.daemon.put("tube", file)
        operations = [{"operation": "components", "keep": 1}, {"operation": "fill", "max_edges": 100},
                      {"operation": "smooth", "iterations": 2, "along": "both", "feature_angle": 45},
                      {"operation": "subdivide", "scheme": "loop", "levels": 1}, SIMPLIFY]
        derived = self.asked("tube", "derive", {"mesh": "derived", "operations": operations}, 201)
        made = self.upload("simplify=100&subdivide=1&fill=100&smooth=2&components=1", file)
        self.assertEqual((made.status, made.headers["Location"]), (201, "/v1/meshes/made"))
        for member in ("sha256", "faces", "area", "boundary_count", "euler_characteristic", "bounding_box"):
            self.assertEqual(made.json[member], derived[member], member)
        self.assertEqual((made.json["boundary_count"], made.json["faces"]), (0, 100))
        expected = {member: value for member, value in derived["derived_from"].items() if member != "mesh"}
        self.assertEqual(made.json["derived_from"], expected)
        by_derive, by_upload = (self.daemon.get(f"/v1/meshes/{name}/origins").json for name in ("derived", "made"))
        self.assertEqual(by_upload["origins"], by_derive["origins"])
        self.assertEqual(by_upload["mesh"], {"etag": by_derive["mesh"]["etag"]})
        self.assertEqual(self.daemon.get("/v1/meshes/made").json, made.json)

    def test_the_same_upload_and_another_one(self):
        file = sample("icosphere", level=3)
        first = self.upload("simplify=100&description=thin", file, "again")
        again = self.upload("simplify=100", file, "again")
        self.assertEqual((again.status, again.json), (200, first.json))
        self.assertEqual(again.json["description"], "thin")
        self.assertEqual(self.upload("simplify=100&description=thinner", file, "again").json["description"], "thinner")
        self.assertEqual(self.daemon.get("/v1/meshes/again").json["description"], "thinner")
        other = self.upload("simplify=200", file, "again")
        self.assertEqual((other.status, other.json["faces"], other.json["description"]), (200, 200, "thinner"))
        whole = self.upload("", file, "again")
        self.assertEqual((whole.json["faces"], "derived_from" in whole.json), (1280, False))
        self.assertEqual(other.json["derived_from"]["etag"], whole.json["etag"])

    def test_preconditions(self):
        file = sample("icosphere", level=3)
        tag = self.upload("simplify=100", file, "guarded").headers["ETag"]
        self.assert_problem(self.upload("simplify=200", file, "guarded", If_None_Match="*"), 412, "precondition_failed")
        self.assert_problem(self.upload("simplify=200", file, "guarded", If_Match='"other"'), 412, "precondition_failed")
        self.assertEqual(self.upload("simplify=200", file, "guarded", If_Match=tag).status, 200)

    def test_a_generated_name(self):
        file = sample("icosphere", level=3)
        names = set()
        for query in ("", "?simplify=100", "?simplify=200", "?simplify=100"):
            names.add(self.daemon.request("POST", f"/v1/meshes{query}", file).json["name"])
        self.assertEqual(len(names), 3)

    def test_a_job(self):
        job = self.upload("fill=100&simplify=100", sample("icosphere", level=4), "later", Prefer="respond-async")
        self.assertEqual(job.status, 202)
        while (state := self.daemon.get(job.headers["Location"]).json)["state"] in ("queued", "running"):
            time.sleep(0.05)
        self.assertEqual((state["state"], state["progress"]), ("done", 1))
        self.assertEqual(self.daemon.get("/v1/meshes/later").json["faces"], 100)

    def test_repaired_first(self):
        fan = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"
        problem = self.assert_problem(self.upload("subdivide=1", fan, "fan"), 422, "invalid_mesh")
        self.assertEqual(problem["elements"], [{"edge": [0, 1]}])
        self.assertEqual(self.upload("subdivide=1&repair=split", fan, "fan").json["faces"], 12)

    def test_refusals(self):
        for query in ("simplify=3", "simplify=x", "simplify=", "fill=2", "fill=2001", "components=0", "smooth=1001", "subdivide=7", "subdivide=1&subdivide=1"):
            problem = self.assert_problem(self.upload(query, TETRAHEDRON, "bad"), 400, "invalid_request")
            self.assertEqual(problem["parameter"], query.split("=")[0], problem)
        self.assertEqual(self.daemon.get("/v1/meshes/bad").status, 404)
        self.assert_problem(self.daemon.request("PUT", "/v1/subdivisions/bad?simplify=10", sample("icosphere", level=1)), 400, "invalid_request")

    def test_an_edit_that_fails_names_elements(self):
        # the hole is a slit, because its boundary loop lies on a straight line
        places = ["0 0", "1 0", "1 0", "2 0", "1 1", "1 -1", "-1 0", "3 0", "-1 1"]
        corners = ["1 2 5", "2 4 5", "1 6 3", "3 6 4", "7 1 5", "7 6 1", "8 5 4", "8 4 6", "7 5 9"]
        slit = "".join([f"v {place} 0\n" for place in places] + [f"f {corner}\n" for corner in corners]).encode()
        problem = self.assert_problem(self.upload("fill=4", slit, "slit"), 422, "invalid_mesh")
        self.assertEqual(sorted(element["vertex"] for element in problem["elements"]), [0, 1, 2, 3], problem)
        self.assertEqual(self.daemon.get("/v1/meshes/slit").status, 404)
        self.daemon.put("slit", slit)
        again = self.assert_problem(self.daemon.ask("slit", "derive", {"mesh": "filled", "operations": [{"operation": "fill", "max_edges": 4}]}), 422, "invalid_mesh")
        self.assertEqual(again["elements"], problem["elements"])
        made = self.upload("fill=100", slit, "slit").json  # a hole that is not a slit can be filled
        self.assertEqual((made["boundary_count"], made["boundaries"][0]["vertices"]), (1, 4))


class Kept(Folder):
    def test_an_edited_upload_lasts(self):
        with self.start() as daemon:
            before = daemon.request("PUT", "/v1/meshes/small?simplify=100", sample("icosphere", level=3)).json
            origins = daemon.get("/v1/meshes/small/origins").json
        with self.start() as daemon:
            self.assertEqual(daemon.get("/v1/meshes/small").json["derived_from"], before["derived_from"])
            self.assertEqual(daemon.get("/v1/meshes/small/origins").json, origins)
            again = daemon.request("PUT", "/v1/meshes/small?simplify=100", sample("icosphere", level=3))
            self.assertEqual((again.status, again.json["etag"]), (200, before["etag"]))

    def test_a_derived_mesh_survives_a_restart(self):
        with self.start() as daemon:
            daemon.put("sphere", sample("icosphere", level=3))
            before = daemon.ask("sphere", "derive", {"mesh": "small", "operations": [SIMPLIFY]}).json
            origins = daemon.get("/v1/meshes/small/origins").json
        with self.start() as daemon:
            daemon.request("DELETE", "/v1/meshes/sphere")
            after = daemon.get("/v1/meshes/small").json
            self.assertEqual(after["derived_from"], before["derived_from"])
            self.assertEqual(daemon.get("/v1/meshes/small/origins").json, origins)
            self.assertEqual(daemon.get("/v1/meshes/small").json["derived_from"], before["derived_from"])
