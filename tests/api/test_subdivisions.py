"""Tests subdivision surfaces: the resource, evaluation and discretizations, by closed forms and by
laws. Also tests refusals and memory."""
import json
import math
import struct
import threading
import unittest

from harness import SQUARE, Folder, TestCase
from subdivisions import CUBE, CUBE_USD, MIDDLE, MIRROR, OCTAHEDRON, PRISM, Subdivisions


class Resource(Subdivisions):
    def test_description(self):
        cube = self.daemon.get("/v1/subdivisions/cube").json
        self.assertEqual({key: cube[key] for key in ("name", "scheme", "vertices", "edges", "faces", "crease_edges",
                                                     "corner_vertices", "boundary_edges", "boundaries", "least_level")},
                         {"name": "cube", "scheme": "catmull_clark", "vertices": 8, "edges": 12, "faces": 6,
                          "crease_edges": 0, "corner_vertices": 0, "boundary_edges": 0, "boundaries": 0, "least_level": 0})
        self.assertEqual(cube["extraordinary_vertices"], [{"valence": 3, "count": 8}])
        loop = self.daemon.get("/v1/subdivisions/loop").json
        self.assertEqual((loop["scheme"], loop["extraordinary_vertices"]), ("loop", [{"valence": 4, "count": 6}]))
        sheet = self.daemon.get("/v1/subdivisions/sheet").json
        self.assertEqual((sheet["boundaries"], sheet["boundary_edges"]), (1, 4))
        self.assertEqual(self.daemon.get("/v1/subdivisions/prism").json["least_level"], 1)

    def test_list_replace_delete(self):
        listed = self.daemon.get("/v1/subdivisions?limit=2").json
        self.assertEqual([entry["name"] for entry in listed["subdivisions"]], ["cube", "loop"])
        self.assertEqual(listed["next"], "loop")
        self.assertEqual(self.put("gone", CUBE).status, 201)
        self.assertEqual(self.put("gone", CUBE).status, 200)
        before = self.daemon.get("/v1/subdivisions/gone").json["etag"]
        self.assertEqual(self.put("gone", CUBE.replace(b"v 1 1 1", b"v 2 2 2")).status, 200)
        self.assertNotEqual(self.daemon.get("/v1/subdivisions/gone").json["etag"], before)
        self.assertEqual(self.daemon.request("HEAD", "/v1/subdivisions/gone").status, 200)
        self.assertEqual(self.daemon.request("DELETE", "/v1/subdivisions/gone").status, 204)
        self.assertEqual(self.daemon.get("/v1/subdivisions/gone").status, 404)
        # each kind of surface has its own names
        self.assertEqual(self.daemon.get("/v1/meshes/cube").status, 404)

    def test_post_makes_a_name(self):
        answer = self.daemon.request("POST", "/v1/subdivisions", json.dumps(CUBE_USD), {"Content-Type": "application/json"})
        self.assertEqual(answer.status, 201, answer)
        self.assertEqual(answer.headers["Location"], f"/v1/subdivisions/{answer.json['name']}")
        self.assertEqual(self.daemon.request("DELETE", answer.headers["Location"]).status, 204)

    def test_the_example(self):
        contract = self.daemon.get("/openapi.json").json
        example = contract["components"]["requestBodies"]["SubdivisionFile"]["content"]["application/json"]["examples"]["cube"]
        self.assertEqual(self.put("example", example["value"]).status, 201)
        told = contract["components"]["examples"]["SmoothCube"]["value"]
        found = self.daemon.get("/v1/subdivisions/example").json
        for key in set(told) - {"name", "sha256", "memory_bytes", "created", "etag"}:
            self.assertEqual(found[key], told[key], key)
        self.assertEqual(list(found), list(told))
        for query in ("evaluate", "nearest", "trace", "distance", "path"):
            operation = contract["paths"][f"/v1/subdivisions/{{name}}/{query}"]["post"]
            shown = operation["requestBody"]["content"]["application/json"]
            answer = self.ask("example", query, shown.get("example") or shown["examples"]["bare"]["value"])
            told = operation["responses"]["200"]["content"]["application/json"].get("example")
            if told:
                self.assert_alike(answer, told)
        self.daemon.request("DELETE", "/v1/subdivisions/example")

    def assert_alike(self, answer, told):
        if isinstance(told, dict):
            self.assertEqual(list(answer), list(told))
            for key in told:
                self.assert_alike(answer[key], told[key])
        elif isinstance(told, list):
            self.assertEqual(len(answer), len(told))
            for a, b in zip(answer, told):
                self.assert_alike(a, b)
        else:
            self.assertAlmostEqual(answer, told, 12)

    def test_creases_by_both_formats(self):
        """A cube whose edges are all infinitely sharp stays a cube; tags of OBJ and of USD mean the
        same."""
        edges = [(0, 1), (1, 3), (3, 2), (2, 0), (4, 5), (5, 7), (7, 6), (6, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
        tags = b"".join(b"t crease 2/1/0 %d %d 10\n" % edge for edge in edges)
        self.assertEqual(self.put("sharp-obj", CUBE + tags).status, 201)
        chains = {"creaseIndices": [0, 1, 3, 2, 0, 4, 5, 7, 6, 4, 1, 5, 2, 6, 3, 7], "creaseLengths": [5, 5, 2, 2, 2]}
        # two chains are 0 1 3 2 0 and 4 5 7 6 4; they contain the vertices 0 and 4, but no chain
        # contains the edge from 0 to 4
        chains["creaseIndices"] += [0, 4]
        chains["creaseLengths"] += [2]
        self.assertEqual(self.put("sharp-usd", {**CUBE_USD, **chains, "creaseSharpnesses": [10] * 6}).status, 201)
        each = {**CUBE_USD, **chains, "creaseSharpnesses": [10] * 12}
        self.assertEqual(self.put("sharp-each", each).status, 201)
        for name in ("sharp-obj", "sharp-usd", "sharp-each"):
            self.assertEqual(self.daemon.get(f"/v1/subdivisions/{name}").json["crease_edges"], 12)
            [point] = self.ask(name, "evaluate", {"points": [{"face": 0, "uv": [0.25, 0.75]}]})["points"]
            self.assert_near(point["xyz"], [-0.5, 0.5, 1])
            self.assert_near(point["normal"], [0, 0, 1])
        corner = {**CUBE_USD, "cornerIndices": [7], "cornerSharpnesses": [1.5], "interpolateBoundary": "edgeOnly",
                  "subdivisionScheme": "catmullClark"}
        self.assertEqual(self.put("corner", corner).status, 201)
        self.assertEqual(self.daemon.get("/v1/subdivisions/corner").json["corner_vertices"], 1)
        [point] = self.ask("corner", "evaluate", {"points": [{"face": 0, "uv": [1, 1]}]})["points"]
        # the coordinate is 1/2 without the tag, and 1 if the corner is infinitely sharp
        self.assertGreater(point["xyz"][0], 0.7)
        self.assertTrue(point["singular"])
        for name in ("sharp-obj", "sharp-usd", "sharp-each", "corner"):
            self.daemon.request("DELETE", f"/v1/subdivisions/{name}")

    def test_mesh_json_and_schemes(self):
        faces = [[a - 1 for a in map(int, line.split()[1:])] for line in OCTAHEDRON.split(b"\n") if line.startswith(b"f")]
        vertices = [list(map(float, line.split()[1:])) for line in OCTAHEDRON.split(b"\n") if line.startswith(b"v")]
        self.assertEqual(self.put("plain", {"vertices": vertices, "faces": faces}, "?scheme=loop").status, 201)
        usd = {"points": vertices, "faceVertexCounts": [3] * 8, "faceVertexIndices": sum(faces, []), "subdivisionScheme": "loop"}
        self.assertEqual(self.put("usd", usd).status, 201)
        place = {"points": [{"face": 3, "uv": [0.2, 0.3]}]}
        self.assertEqual(self.ask("plain", "evaluate", place), self.ask("usd", "evaluate", place))
        self.assertEqual(self.ask("loop", "evaluate", place), self.ask("usd", "evaluate", place))
        problem = self.assert_problem(self.put("usd", usd, "?scheme=catmull_clark"), 400, "invalid_request")
        self.assertEqual(problem["pointer"], "/subdivisionScheme")
        for name in ("plain", "usd"):
            self.daemon.request("DELETE", f"/v1/subdivisions/{name}")

    def test_refused_files(self):
        square = SQUARE.replace(b"f 1 2 3\nf 1 3 4", b"f 1 2 3 4")
        for body, options, reason in [
                (b"nonsense", "", "unrecognized"), (CUBE + b"f 1 2 3 4\n", "", "non_manifold_edge"),
                (square + b"f 1 1 2 3\n", "", "degenerate_face"), (CUBE + b"t crease 2/1/0 0 7 1\n", "", "no_such_edge"),
                (CUBE + b"t crease 2/1/0 0 99 1\n", "", "index"), (CUBE + b"t corner 1/1/0 0 -1\n", "", "invalid_argument"),
                (CUBE + b"t crease 2/1/0 0\n", "", "syntax"), (CUBE + b"t hole 1/0/0 1\n", "", "unsupported"),
                (b"v 0 0 0\n" + CUBE.replace(b"f 5 6 8 7", b"f 6 7 9 8") + b"t corner 1/1/0 0 1\n", "", None),
                (CUBE, "?scheme=loop", "not_triangles"), (square + b"t interpolateboundary 1/0/0 0\n", "", "unsupported"),
                ({**CUBE_USD, "faceVertexIndices": [9] * 24}, "", "index"),
                ({**CUBE_USD, "faceVertexCounts": [], "faceVertexIndices": []}, "", "empty"),
                ({**CUBE_USD, "creaseIndices": [0, 7], "creaseLengths": [2], "creaseSharpnesses": [2]}, "", "no_such_edge"),
                ({**CUBE_USD, "cornerIndices": [8], "cornerSharpnesses": [2]}, "", "out_of_range")]:
            answer = self.put("bad", body, options)
            problem = self.assert_problem(answer, 422, "invalid_mesh")
            if reason:
                self.assertEqual(problem["reason"], reason, (body, problem))
        for change, pointer in [({"points": None}, "/points"), ({"points": [[1, 2]]}, "/points/0"), ({"faceVertexCounts": [4] * 5}, "/faceVertexCounts"),
                                ({"faceVertexCounts": [4] * 7}, "/faceVertexCounts"), ({"creaseIndices": [0, 1]}, "/creaseLengths"),
                                ({"creaseIndices": [0, 1], "creaseLengths": [2], "creaseSharpnesses": []}, "/creaseSharpnesses"),
                                ({"creaseIndices": [0], "creaseLengths": [1], "creaseSharpnesses": [1]}, "/creaseLengths/0"),
                                ({"cornerIndices": [1]}, "/cornerSharpnesses"), ({"interpolateBoundary": "some"}, "/interpolateBoundary"),
                                ({"holeIndices": []}, "/holeIndices"), ({"faceVertexIndices": [0.5] * 24}, "/faceVertexIndices/0"),
                                ({"faceVertexIndices": "x"}, "/faceVertexIndices")]:
            document = {key: value for key, value in {**CUBE_USD, **change}.items() if value is not None}
            problem = self.assert_problem(self.put("bad", document), 400, "invalid_request")
            self.assertEqual(problem["pointer"], pointer, (change, problem))
        self.assert_problem(self.put("bad", CUBE, "?scheme=doo_sabin"), 400, "invalid_request")
        self.assert_problem(self.put("bad", CUBE, "?weld=1"), 400, "invalid_request")
        self.assertEqual(self.daemon.get("/v1/subdivisions/bad").status, 404)


class Evaluate(Subdivisions):
    def test_the_cube(self):
        """Compares with values that were computed independently. OpenSubdiv returns the same
        values."""
        points = [((0.5, 0.5), (0, 0, 68 / 81)), ((0.5, 0), (0, -395 / 648, 395 / 648)), ((1, 1), (0.5, 0.5, 0.5)),
                  ((0.25, 0.25), (-0.316157085905, -0.316157085905, 0.728989840535)),
                  ((0.1, 0.2), (-0.470313871571, -0.354383536694, 0.629845143176)),
                  ((0.01, 0.02), (-0.499136625593, -0.492987573699, 0.507727753563))]
        answer = self.ask("cube", "evaluate", {"points": [{"face": 0, "uv": uv} for uv, _ in points]})["points"]
        for (_, xyz), point in zip(points, answer):
            self.assert_near(point["xyz"], xyz, 1e-10)
        self.assertTrue(answer[2]["singular"])
        self.assertEqual((answer[2]["curvatures"], answer[2]["duu"]), (None, None))
        self.assert_near(answer[2]["normal"], [1 / math.sqrt(3)] * 3)
        self.assertNotIn("singular", answer[0])

    def test_derivatives(self):
        step = 1e-5
        for name, face, corner, (u, v) in [("cube", 3, 0, (0.3, 0.8)), ("loop", 5, 0, (0.2, 0.4)), ("prism", 0, 2, (0.6, 0.7))]:
            at = lambda du, dv: {"face": face, "corner": corner, "uv": [u + du, v + dv]}
            asked = [at(0, 0), at(step, 0), at(-step, 0), at(0, step), at(0, -step)]
            here, right, left, up, down = self.ask(name, "evaluate", {"points": asked})["points"]
            for key, a, b in (("du", right, left), ("dv", up, down)):
                self.assert_near([(p - q) / (2 * step) for p, q in zip(a["xyz"], b["xyz"])], here[key], 1e-8)
                second = "duu" if key == "du" else "dvv"
                self.assert_near([(p - q) / (2 * step) for p, q in zip(a[key], b[key])], here[second], 1e-7)
            self.assertAlmostEqual(math.hypot(*here["normal"]), 1, 13)
            self.assertLessEqual(*here["curvatures"])

    def test_many_and_fields(self):
        places = [{"face": i % 6, "uv": [i / 3000, 0.5]} for i in range(3000)]
        answer = self.ask("cube", "evaluate?select=points,xyz", {"points": places})["points"]
        self.assertEqual((len(answer), list(answer[7])), (3000, ["xyz"]))
        self.assertEqual(self.ask("cube", "evaluate?select=xyz", {"points": places}), {"points": answer})
        whole = self.ask("cube", "evaluate", {"points": places[:1]})
        self.assertEqual(self.ask("cube", "evaluate?select=points", {"points": places[:1]}), whole)

    def test_refusals(self):
        for place, status, pointer in [({"face": 6, "uv": [0, 0]}, 400, "/points/1/face"), ({"face": 0, "uv": [1.1, 0]}, 422, "/points/1/uv"),
                                       ({"face": 0, "uv": [0, 0], "corner": 1}, 400, "/points/1/face"), ({"face": 0}, 400, "/points/1/uv"),
                                       ({"face": 0, "uv": [0]}, 400, "/points/1/uv"), ({"face": -1, "uv": [0, 0]}, 400, "/points/1/face"),
                                       ({"face": 0, "uv": [0, 0], "u": 1}, 400, "/points/1/u")]:
            problem = self.ask("cube", "evaluate", {"points": [MIDDLE, place]}, status)
            self.assertEqual(problem["pointer"], pointer, place)
        self.ask("cube", "evaluate", {"points": []}, 400)
        self.ask("cube", "evaluate", {}, 400)
        many = '{"points":[' + '{"face":0,"uv":[0,0]},' * 40000 + '{"face":0,"uv":[0,0]}]}'
        answer = self.daemon.request("POST", "/v1/subdivisions/cube/evaluate", many, {"Content-Type": "application/json"})
        self.assertEqual(self.assert_problem(answer, 413, "too_large")["limit"], 40000)
        self.ask("prism", "evaluate", {"points": [{"face": 0, "uv": [0, 0], "corner": 3}]}, 400)
        self.ask("nobody", "evaluate", {"points": [MIDDLE]}, 404)

    def test_nearest(self):
        foot = self.ask("cube", "nearest", {"xyz": [0, 0, 3]})
        self.assertEqual(foot["face"], 0)
        self.assertAlmostEqual(foot["distance"], 3 - 68 / 81, 12)
        foot = self.ask("loop", "nearest", {"xyz": [0.3, 0.4, 0.5]})
        [point] = self.ask("loop", "evaluate", {"points": [{"face": foot["face"], "uv": foot["uv"]}]})["points"]
        self.assert_near(point["xyz"], foot["xyz"])
        off = [a - b for a, b in zip([0.3, 0.4, 0.5], foot["xyz"])]
        self.assertAlmostEqual(math.hypot(*off), foot["distance"], 12)
        for axis in ("du", "dv"):
            self.assertAlmostEqual(sum(a * b for a, b in zip(off, point[axis])), 0, 10)
        self.assertEqual(self.ask("cube", "nearest", {"xyz": [1, 2]}, 400)["pointer"], "/xyz")
        self.assertEqual(self.daemon.get("/v1/subdivisions/cube/nearest?point=p:0,0,3").json, self.ask("cube", "nearest", {"point": "p:0,0,3"}))
        self.assertEqual(self.ask("cube", "nearest", {"point": {"xyz": [0, 0, 3], "max_snap": 1}}, 422)["pointer"], "/point")

    def test_a_spike(self):
        """Tests a surface that is smooth except at one interior corner. The surface passes through
        this control point and has no normal at this point. A trace can end in the corner but not
        start in it. A path can start and end in the corner."""
        self.assertEqual(self.put("spike", CUBE + b"t corner 1/1/0 4 10\n").status, 201)
        tip, ask = {"face": 0, "uv": [0, 0]}, lambda *question: self.ask("spike", *question)
        [point] = ask("evaluate", {"points": [tip]})["points"]
        self.assertEqual((point["xyz"], point["normal"], point["curvatures"], point["singular"]), ([-1, -1, 1], None, None, True))
        self.assert_near(point["du"], [3 ** -0.5, 3 ** -0.5, -3 ** -0.5])
        self.assertEqual(point["du"], point["dv"])
        foot = ask("nearest", {"xyz": [-2, -2, 2]})
        self.assert_near(foot["xyz"], [-1, -1, 1])
        self.assertAlmostEqual(foot["distance"], math.sqrt(3), 14)
        for smooth in (False, True):
            problem = ask("trace", {"start": tip, "fan": 3, "length": 1, "smooth": smooth}, 400)
            self.assertEqual(problem["pointer"], "/start")
            self.assertIn("spike", problem["detail"])
        [path] = ask("trace", {"start": {"face": 0, "uv": [0.4, 0.4]}, "directions": [[-1, -1, 0]], "length": 3, "smooth": True})["paths"]
        self.assertEqual((path["end_reason"], path["end_direction"]["angle"]), ("singular", None))
        self.assert_near(path["points"][-1]["xyz"], [-1, -1, 1], 1e-9)
        [path] = ask("trace", {"start": {"face": 0, "uv": [0.4, 0.4]}, "directions": [[-1, -1, 0]], "length": 3, "level": 5})["paths"]
        # on the mesh, a vertex rule defines how the line continues
        self.assertEqual(path["end_reason"], "length")
        [path] = ask("trace", {"start": MIDDLE, "directions": [[-1, -1, 0]], "length": 3, "smooth": True})["paths"]
        for places in ({"from": tip, "to": MIDDLE}, {"from": MIDDLE, "to": tip}):
            answer = ask("path", {**places, "level": 6})
            self.assertLess(answer["error_estimate"], 1e-3)
            self.assertLess(abs(answer["distance"] - path["length"]), answer["error_estimate"])
        mesh = ask("tessellate", {"mesh": "spiked", "level": 4}, 201)
        self.assertEqual((mesh["faces"], mesh["boundaries"]), (3072, []))
        nearest = self.daemon.get("/v1/meshes/spiked/nearest?point=p:-2,-2,2").json
        self.assertEqual(nearest["xyz"], [-1, -1, 1])
        self.daemon.request("DELETE", "/v1/meshes/spiked")
        self.daemon.request("DELETE", "/v1/subdivisions/spike")


class Discretize(Subdivisions):
    def test_vertices_lie_on_the_surface_and_have_parameters(self):
        answer = self.daemon.request("POST", "/v1/subdivisions/cube/tessellate", json.dumps({"mesh": "fine", "level": 3}),
                                     {"Content-Type": "application/json"})
        self.assertEqual((answer.status, answer.headers["Location"]), (201, "/v1/meshes/fine"))
        self.assertEqual((answer.json["vertices"], answer.json["faces"], answer.json["genus"]), (386, 768, 0))
        places = self.daemon.get("/v1/meshes/fine/places").json
        cube = self.daemon.get("/v1/subdivisions/cube").json
        self.assertEqual(places["subdivision"], {"name": "cube", "etag": cube["etag"]})
        asked = [{"face": int(face), "corner": int(corner), "uv": uv} for face, corner, *uv in places["places"]]
        found = [point["xyz"] for point in self.ask("cube", "evaluate", {"points": asked})["points"]]
        lines = self.daemon.get("/v1/meshes/fine/content?format=obj").body.decode().splitlines()
        for line, xyz in zip((line for line in lines if line.startswith("v ")), found):
            self.assert_near(list(map(float, line.split()[1:])), xyz, 1e-14)
        binary = self.daemon.get("/v1/meshes/fine/places", Accept="application/octet-stream").body
        self.assertEqual(list(struct.unpack(f"<{4 * 386}d", binary)), [x for place in places["places"] for x in place])
        # queries of meshes work, for example the distance from the middle of the top to the middle
        # of the bottom
        ends = [next(i for i, xyz in enumerate(found) if math.dist(xyz, [0, 0, z * 68 / 81]) < 1e-9) for z in (1, -1)]
        distance = self.daemon.get(f"/v1/meshes/fine/distance?from=v:{ends[0]}&to=v:{ends[1]}").json["distance"]
        self.assertAlmostEqual(distance, MIRROR / 2, 1)
        corner, end = {"vertex": ends[0]}, {"vertex": ends[1]}
        for query, question in [("path", {"from": corner, "to": end}), ("trace", {"start": corner, "fan": 3, "length": 1}), ("log", {"from": corner, "to": [end]}),
                                ("matrix", {"sources": [corner], "targets": [end]}), ("spline", {"points": [corner, {"vertex": 5}, end]})]:
            told = self.daemon.request("POST", f"/v1/meshes/fine/{query}", json.dumps(question), {"Content-Type": "application/json"})
            self.assertEqual(told.status, 200, (query, told))
        again = self.ask("cube", "tessellate", {"mesh": "fine", "level": 3})
        self.assertEqual(again["etag"], answer.json["etag"])
        self.daemon.request("DELETE", "/v1/meshes/fine")

    def test_tolerance(self):
        made = [self.ask("cube", "tessellate", {"mesh": f"near-{i}", "tolerance": 10 ** -i}, 201) for i in (2, 4)]
        self.assertGreater(made[1]["faces"], 30 * made[0]["faces"])
        # adjacent faces with different levels have no cracks between them
        creased = CUBE + b"t crease 5/1/0 4 5 7 6 4 10\nt corner 1/1/0 0 10\n"
        self.assertIn(self.put("uneven", creased).status, (200, 201))
        made.append(self.ask("uneven", "tessellate", {"mesh": "near-3", "tolerance": 3e-3}, 201))
        self.daemon.request("DELETE", "/v1/subdivisions/uneven")
        self.daemon.request("DELETE", "/v1/meshes/near-3")
        for mesh in made:
            self.assertEqual((mesh["boundaries"], mesh["genus"], mesh["components"]), ([], 0, 1))
        for i in (2, 4):
            self.daemon.request("DELETE", f"/v1/meshes/near-{i}")

    def test_refusals(self):
        for document, pointer in [({"mesh": "x"}, ""), ({"mesh": "x", "level": 2, "tolerance": 1}, ""), ({"level": 2}, "/mesh"), ({"mesh": ".x", "level": 1}, "/mesh"),
                                  ({"mesh": "x", "level": 13}, "/level"), ({"mesh": "x", "tolerance": 0}, "/tolerance")]:
            self.assertEqual(self.ask("cube", "tessellate", document, 400)["pointer"], pointer, document)
        self.ask("prism", "discretize", {"mesh": "x", "level": 0}, 400)
        for query, body, pointer in (("tessellate", {"mesh": "x", "tolerance": 1e-14}, "/tolerance"), ("tessellate", {"mesh": "x", "level": 12}, "/level"),
                                     ("levels", {"level": 12}, "/level"), ("distance", {"from": MIDDLE, "to": MIDDLE, "level": 12}, "/level")):
            problem = self.ask("cube", query, body, 413)
            self.assertEqual((problem["code"], problem["pointer"]), ("too_large", pointer))
        self.assertEqual(self.daemon.get("/v1/meshes/x").status, 404)
        self.daemon.put("square", SQUARE)
        self.assert_problem(self.daemon.get("/v1/meshes/square/places"), 404, "not_found")
        self.assert_problem(self.daemon.get("/v1/meshes/square/parameters"), 404, "not_found")


class Kept(TestCase):
    """Discretizations are cached with the surface, within the budget; simultaneous requests share
    one build."""

    flags = ("--memory-budget", "400MiB", "--workers", "4")

    def memory(self):
        for line in self.daemon.get("/metrics").body.decode().splitlines():
            if line.startswith('geodesicd_memory_bytes{class="discretizations"}'):
                return int(line.split()[1])
        raise KeyError

    def trace(self, name, level, **options):
        return self.daemon.request("POST", f"/v1/subdivisions/{name}/trace?geometry=none",
                                   json.dumps({"start": MIDDLE, "fan": 1, "length": 1, "level": level, "stop_at_self_intersection": True,
                                               **options}),
                                   {"Content-Type": "application/json"})

    def test_discretizations_are_cached_shared_and_evicted(self):
        self.daemon.request("PUT", "/v1/subdivisions/a", CUBE)
        self.assertEqual(self.memory(), 0)
        self.assertEqual(self.trace("a", 5).status, 200)
        one = self.memory()
        self.assertGreater(one, 500_000)
        answers = []
        threads = [threading.Thread(target=lambda: answers.append(self.trace("a", 6))) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([answer.status for answer in answers], [200] * 6)
        self.assertEqual(len({answer.body for answer in answers}), 1)
        both = self.memory()
        self.assertLess(both, 6 * one)  # a further level needs four times as much memory
        self.assertEqual(self.trace("a", 6).status, 200)
        self.assertEqual(self.memory(), both)
        # level 7 of each surface needs about 50 MB, so not all levels fit into the budget
        for name in "bcdefgh":
            self.daemon.request("PUT", f"/v1/subdivisions/{name}", CUBE)
            self.assertEqual(self.trace(name, 7).status, 200)
        self.assertLess(self.memory(), 400 << 20)
        self.assert_problem(self.trace("a", 9), 507, "insufficient_memory")
        for name in "abcdefgh":
            self.daemon.request("DELETE", f"/v1/subdivisions/{name}")
        self.assertEqual(self.memory(), 0)

    def test_grids_are_cached_too(self):
        """Most traces need only the positions of the vertices, which take 24 bytes each."""
        self.daemon.request("PUT", "/v1/subdivisions/grid", CUBE)
        before = self.memory()
        for level in (5, 5, 7):
            self.assertEqual(self.trace("grid", level, fan=7, stop_at_self_intersection=False).status, 200)
        positions = 24 * 6 * (33**2 + 129**2)
        self.assertTrue(positions <= self.memory() - before < 1.01 * positions, self.memory() - before)
        self.assertEqual(self.daemon.request("DELETE", "/v1/subdivisions/grid").status, 204)
        self.assertEqual(self.memory(), before)

    def level(self, name, status=200, query="", prefer=None, **document):
        headers = {"Content-Type": "application/json", **({"Prefer": prefer} if prefer else {})}
        answer = self.daemon.request("POST", f"/v1/subdivisions/{name}/levels{query}", json.dumps(document), headers)
        self.assertEqual(answer.status, status, answer)
        return answer

    def test_a_level_is_built_ahead(self):
        """A level is counted and kept as if a query had built it, so that the query builds
        nothing."""
        self.daemon.request("PUT", "/v1/subdivisions/ahead", CUBE)
        before = self.memory()
        made = self.level("ahead", level=5, use="traces").json
        positions = 24 * 6 * 33**2
        self.assertEqual((made["level"], self.memory() - before), (5, made["bytes"]))
        self.assertTrue(positions <= made["bytes"] < 1.01 * positions, made)
        self.assertEqual(self.trace("ahead", 5, stop_at_self_intersection=False).status, 200)
        self.assertEqual(self.memory() - before, made["bytes"])
        both = self.level("ahead", level=5).json
        self.assertEqual(self.memory() - before, both["bytes"])
        self.assertGreater(both["bytes"], made["bytes"] + 500_000)
        self.assertEqual(self.trace("ahead", 5).status, 200)
        self.assertEqual(self.level("ahead", level=5, use="paths").json["bytes"], both["bytes"] - made["bytes"])
        self.assertEqual(self.memory() - before, both["bytes"])
        self.assertEqual(self.level("ahead", use="traces").json["level"], self.daemon.get("/v1/subdivisions/ahead").json["usual_level"])
        self.daemon.request("DELETE", "/v1/subdivisions/ahead")
        self.assertEqual(self.memory(), before)

    def test_a_level_is_built_by_a_job(self):
        self.daemon.request("PUT", "/v1/subdivisions/job", CUBE)
        job = self.level("job", 202, prefer="respond-async", level=6, use="traces").headers["Location"]
        done = self.daemon.get(job + "?wait=60").json
        self.assertEqual((done["state"], done["result"]["level"]), ("done", 6), done)
        self.assertEqual(done["result"]["bytes"], self.level("job", level=6, use="traces").json["bytes"])
        self.daemon.request("DELETE", "/v1/subdivisions/job")

    def test_levels_are_refused(self):
        self.daemon.request("PUT", "/v1/subdivisions/limits", CUBE)
        self.daemon.request("PUT", "/v1/subdivisions/prism", PRISM)
        for name, document, pointer in (("limits", {"level": 13}, "/level"), ("limits", {"level": -1}, "/level"), ("limits", {"use": "fields"}, "/use"),
                                        ("prism", {"level": 0}, "/level"), ("limits", {"mesh": "x"}, "/mesh")):
            self.assertEqual(self.level(name, 400, **document).json["pointer"], pointer, document)
        self.assert_problem(self.level("limits", 507, level=9), 507, "insufficient_memory")
        self.assert_problem(self.level("limits", 504, "?timeout_ms=1", level=8, use="paths"), 504, "deadline_exceeded")
        self.level("nothing", 404)
        for name in ("limits", "prism"):
            self.daemon.request("DELETE", f"/v1/subdivisions/{name}")
        self.assertEqual(self.memory(), 0)

    def test_a_request_that_waits_for_a_build_has_a_deadline(self):
        self.daemon.request("PUT", "/v1/subdivisions/late", CUBE)
        slow = threading.Thread(target=self.trace, args=("late", 8))
        slow.start()
        answer = self.daemon.request("POST", "/v1/subdivisions/late/trace?timeout_ms=20",
                                     json.dumps({"start": MIDDLE, "fan": 1, "length": 1, "level": 8}), {"Content-Type": "application/json"})
        slow.join()
        self.assertIn(answer.status, (200, 504))  # a fast machine can return 200
        self.daemon.request("DELETE", "/v1/subdivisions/late")

    def test_degenerate_surfaces_are_evaluated_without_normals(self):
        """Where control points are collinear or coincide, the surface has no normal: answers
        contain null instead of a number."""
        flat = b"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3 4\n"
        self.assertEqual(self.daemon.request("PUT", "/v1/subdivisions/line", flat).status, 201)
        ask = lambda query, document: self.daemon.request("POST", f"/v1/subdivisions/line/{query}", json.dumps(document), {"Content-Type": "application/json"})
        [point] = ask("evaluate", {"points": [MIDDLE]}).json["points"]
        self.assertAlmostEqual(point["xyz"][0], 1.5, 14)
        self.assertEqual((point["normal"], point["curvatures"]), (None, None))
        for smooth in (False, True):
            problem = self.assert_problem(ask("trace", {"start": MIDDLE, "fan": 3, "length": 1, "smooth": smooth}), 400, "invalid_request")
            self.assertEqual(problem["pointer"], "/start")
            self.assertIn("no tangent plane", problem["detail"])
        for query, document in [("path", {"from": MIDDLE, "to": {"face": 0, "uv": [0, 1]}}), ("discretize", {"mesh": "line", "level": 2})]:
            problem = self.assert_problem(ask(query, document), 422, "invalid_mesh")
            self.assertEqual(problem["reason"], "degenerate_face", (query, problem))


class Stored(Folder):
    def test_a_restart(self):
        headers = {"Content-Type": "application/json"}
        with self.start() as daemon:
            self.assertEqual(daemon.request("PUT", "/v1/subdivisions/cube", CUBE).status, 201)
            self.assertEqual(daemon.request("PUT", "/v1/subdivisions/loop?scheme=loop", OCTAHEDRON).status, 201)
            self.assertEqual(daemon.request("POST", "/v1/subdivisions/cube/tessellate", json.dumps({"mesh": "fine", "level": 2}), headers).status, 201)
            places = daemon.get("/v1/meshes/fine/places").json
            before = [daemon.get(f"/v1/subdivisions/{name}").json for name in ("cube", "loop")]
        with self.start() as daemon:
            self.assertEqual([daemon.get(f"/v1/subdivisions/{name}").json for name in ("cube", "loop")], before)
            self.assertEqual(daemon.get("/v1/meshes/fine/places").json, places)
            answer = daemon.request("POST", "/v1/subdivisions/cube/distance",
                                    json.dumps({"from": MIDDLE, "to": {"face": 5, "uv": [0.5, 0.5]}}), headers)
            self.assertAlmostEqual(answer.json["distance"], MIRROR / 4, 10)


if __name__ == "__main__":
    unittest.main()
