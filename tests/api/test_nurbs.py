"""Tests NURBS and other parametric surfaces: the resource, evaluation, durability and access."""
import json
import math
import random
import unittest

from harness import SQUARE, Folder, form_tag
from nurbs import CIRCLE_KNOTS, JSON, PI, SADDLE, TORUS, Nurbs, bumps, rational_sphere, rational_torus, revolution, torus_at
from test_access import Keyed, digest, key_of, line


class Resource(Nurbs):
    surfaces = {"torus": rational_torus(), "ring": TORUS, "sphere": rational_sphere(), "bumps": bumps(8, 4, 0.5, 1)}

    def test_the_examples_of_the_contract(self):
        paths = self.daemon.get("/openapi.json").json
        body = paths["components"]["requestBodies"]["NurbsFile"]["content"]["application/json"]["examples"]
        for name, example in body.items():
            self.assertIn(self.put(f"example-{name}", example["value"]).status, (200, 201))
        told = paths["components"]["examples"]["Sheet"]["value"]
        found = self.daemon.get("/v1/nurbs/example-sheet").json
        for key in ("sha256", "created", "etag", "memory_bytes", "name"):
            told.pop(key), found.pop(key)
        self.assertEqual(found, told)
        for query in ("evaluate", "nearest", "geodesic", "point-curve-distance", "curve-distance"):
            operation = paths["paths"][f"/v1/nurbs/{{name}}/{query}"]["post"]
            shown = operation["requestBody"]["content"]["application/json"]
            request = shown.get("example") or next(iter(shown["examples"].values()))["value"]
            answer = self.ask("example-sheet", query, request)
            told = operation["responses"]["200"]["content"]["application/json"].get("example")
            if query == "evaluate":
                for key, value in told["points"][0].items():
                    pairs = zip(value, answer["points"][0][key]) if isinstance(value, list) else [(value, answer["points"][0][key])]
                    for a, b in pairs:
                        self.assertAlmostEqual(a, b, 12, key)
            elif told:
                self.assertEqual(set(answer), set(told))

    def test_descriptions(self):
        torus, ring, sphere, open_ = (self.descriptions[name] for name in ("torus", "ring", "sphere", "bumps"))
        self.assertEqual((torus["shape"], torus["degree"], torus["control_points"], torus["rational"]), ("nurbs", [2, 2], [9, 9], True))
        self.assertEqual((ring["shape"], "degree" in ring, open_["rational"]), ("torus", False, False))
        for direction in "uv":
            self.assertEqual((torus["domain"][direction]["closed"], torus["domain"][direction]["pieces"]), (True, 4))
            self.assertEqual((ring["domain"][direction]["range"], ring["domain"][direction]["pieces"]), ([0, 2 * PI], 1))
            self.assertFalse(open_["domain"][direction]["closed"])
        self.assertEqual((sphere["domain"]["v"]["pole_low"], sphere["domain"]["v"]["pole_high"], sphere["domain"]["u"]["closed"]), (True,) * 3)
        self.assertTrue(all(d["geodesics"] and d["seeding_faces"] > 1000 for d in (torus, ring, sphere, open_)))

    def test_upload_describe_list_delete(self):
        created = self.put("life", SADDLE)
        self.assertEqual((created.status, created.headers["Location"]), (201, "/v1/nurbs/life"))
        again = self.put("life", SADDLE)
        self.assertEqual((again.status, again.headers["ETag"]), (200, created.headers["ETag"]))
        replaced = self.put("life", bumps(5, 5, 0.1, 2))
        self.assertEqual(replaced.status, 200)
        self.assertNotEqual(replaced.headers["ETag"], created.headers["ETag"])
        self.assertEqual(self.put("life", SADDLE, If_None_Match="*").status, 412)
        self.assertEqual(self.daemon.get("/v1/nurbs/life", If_None_Match=replaced.headers["ETag"]).status, 304)
        self.assertEqual(self.daemon.request("HEAD", "/v1/nurbs/life").headers["ETag"], replaced.headers["ETag"])
        names = [surface["name"] for surface in self.daemon.get("/v1/nurbs?limit=1000").json["nurbs"]]
        self.assertEqual(names, sorted(names))
        self.assertLessEqual({"life", "torus", "ring"}, set(names))
        self.assertEqual(self.daemon.request("DELETE", "/v1/nurbs/life").status, 204)
        self.assert_problem(self.daemon.get("/v1/nurbs/life"), 404, "not_found")
        self.assertIn("NURBS", self.assert_problem(self.post("life", "evaluate", {"uv": [[0, 0]]}), 404, "not_found")["detail"])

    def test_kinds_have_separate_names(self):
        self.assertEqual(self.daemon.put("torus", SQUARE).status, 201)
        self.assertEqual(self.daemon.get("/v1/nurbs/torus").json["shape"], "nurbs")
        self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/torus").status, 204)
        self.assertEqual(self.daemon.get("/v1/nurbs/torus").status, 200)

    def test_a_name_made_from_the_content(self):
        body = json.dumps(bumps(6, 5, 0.2, 9))
        answer = self.daemon.request("POST", "/v1/nurbs", body)
        self.assertEqual(answer.status, 201, answer)
        self.assertEqual(answer.headers["Location"], f"/v1/nurbs/{answer.json['sha256'][:32]}")
        self.assertEqual(self.daemon.request("POST", "/v1/nurbs", body).status, 200)

    def test_conventions(self):
        """The torus is the same surface if its knots or weights follow the conventions of other
        programs."""
        canonical = rational_torus()
        flat = [[(point, weight) for point, weight in zip(*rows)] for rows in zip(canonical["controlPoints"], canonical["weights"])]
        multiplied = [[[weight * x for x in point] for point, weight in row] for row in flat]
        less = {"knotsU": CIRCLE_KNOTS[1:-1], "knotsV": CIRCLE_KNOTS[1:-1]}
        joined = lambda rows: [[[*point, weight] for point, (_, weight) in zip(a, b)] for a, b in zip(rows, flat)]
        bare = {key: value for key, value in canonical.items() if key != "weights"}
        forms = {
            "three": {**bare, "controlPoints": joined(canonical["controlPoints"]), "convention": "three"},
            "verb": {**canonical, "controlPoints": multiplied, "convention": "verb"},
            "rhino": {**bare, **less, "controlPoints": joined(multiplied), "convention": "rhino"},
        }
        places = {"uv": [[0.3, 0.7], [0.1, 0.9], [0.25, 0.5]]}
        expected = self.ask("torus", "evaluate", places)["points"]
        for name, form in forms.items():
            for options, body in (("", form), (f"?convention={name}", {k: v for k, v in form.items() if k != "convention"})):
                answer = self.put(f"as-{name}", body, options)
                self.assertIn(answer.status, (200, 201), answer)
                self.assertEqual((answer.json["convention"], answer.json["domain"]), (name, self.descriptions["torus"]["domain"]))
                for found, point in zip(self.ask(f"as-{name}", "evaluate", places)["points"], expected):
                    self.assert_close(found["xyz"], point["xyz"], 1e-14)
                    self.assert_close(found["duv"], point["duv"], 1e-11)
        clash = self.put("clash", {**canonical, "convention": "verb"}, "?convention=rhino")
        self.assertEqual(self.assert_problem(clash, 400, "invalid_request")["pointer"], "/convention")

    def test_refused_by_name(self):
        good = bumps(5, 5, 0.1, 3)
        spoil = lambda **changes: {**good, **changes}
        ones = [[1] * 5 for _ in range(5)]
        knots = good["knotsU"]
        far = json.loads(json.dumps(good["controlPoints"]))
        far[2][2][0] = 1e300
        for reason, body in {
            "decreasing_knots": spoil(knotsU=knots[:5] + [-1] + knots[6:]),
            "weight": spoil(weights=[[1] * 5] * 4 + [[1, 1, 1, 1, 0]]),
            "knot_count": spoil(knotsV=knots + [1]),
            "knot_multiplicity": {**bumps(8, 5, 0.1, 3), "knotsU": [0, 0, 0, 0, 0.5, 0.5, 0.5, 0.5, 1, 1, 1, 1]},
            "degree": spoil(degreeU=0),
            "control_count": spoil(degreeV=5),
            "empty_domain": spoil(knotsU=[0] * 9),
            "extent": spoil(controlPoints=far),
            "trimmed": spoil(trimmingLoops=[]),
        }.items():
            with self.subTest(reason=reason):
                problem = self.assert_problem(self.put("refused", body), 422, "invalid_mesh")
                self.assertEqual(problem["reason"], reason)
        self.assertEqual(self.put("weighed", spoil(weights=ones)).json["rational"], False)

    def test_unreadable_files(self):
        good = bumps(4, 4, 0.1, 3)
        points = good["controlPoints"]
        for pointer, body in (
            ("", b""), ("", b"{"), ("", b"\xff\x00"), ("", b"[]"), ("", SQUARE), ("/degreeU", {}), ("/colour", {**good, "colour": 1}),
            ("/degreeU", {**good, "degreeU": -1}), ("/degreeV", {**good, "degreeV": 2.5}), ("/knotsU", {**good, "knotsU": 3}),
            ("/knotsV/2", {**good, "knotsV": [0, 0, "x", 0, 1, 1, 1, 1]}), ("/controlPoints", {**good, "controlPoints": []}),
            ("/controlPoints/2", {**good, "controlPoints": points[:2] + [points[2][:3]] + points[3:]}),
            ("/controlPoints/1/0", {**good, "controlPoints": points[:1] + [[[0, 0]] + points[1][1:]] + points[2:]}),
            ("/controlPoints/3/3", {**good, "controlPoints": points[:3] + [points[3][:3] + [[0, 0, 0, 1]]]}),
            ("/weights", {**good, "weights": [[1]]}), ("/weights/1", {**good, "weights": [[1, 1, 1, 1], [1, 1, None, 1]] + [[1] * 4] * 2}),
            ("/convention", {**good, "convention": "nurbs++"}), ("/parametric", {"parametric": {}}),
            ("/parametric/cube", {"parametric": {"cube": {}}}), ("/parametric/torus/minor", {"parametric": {"torus": {"major": 1}}}),
            ("/parametric/torus", {"parametric": {"torus": {"major": 1, "minor": 2}}}), ("/degreeU", {"parametric": {}, "degreeU": 1}),
            ("/parametric/helicoid", {"parametric": {"helicoid": {"pitch": 0, "u": [0, 1], "v": [0, 1]}}}),
            ("/parametric/helicoid/u", {"parametric": {"helicoid": {"pitch": 1, "u": [0], "v": [0, 1]}}}),
            ("/parametric/graph/coefficients", {"parametric": {"graph": {"coefficients": [[1], []], "u": [0, 1], "v": [0, 1]}}}),
            ("/parametric/graph", {"parametric": {"graph": {"coefficients": [[1]], "u": [1, 1], "v": [0, 1]}}}),
            ("/parametric/revolution/knots", {"parametric": {"revolution": {"degree": 1, "knots": [0, 1], "control_points": [[1, 0], [1, 1]]}}}),
            ("/parametric/revolution", revolution([1, 0], [-1, 1])),
        ):
            with self.subTest(body=str(body)[:80]):
                problem = self.assert_problem(self.put("unread", body), 400, "invalid_request")
                self.assertEqual(problem["pointer"], pointer)
        self.assertEqual(self.assert_problem(self.put("unread", TORUS, "?convention=verb"), 400, "invalid_request")["parameter"], "convention")
        self.assertEqual(self.assert_problem(self.put("unread", SADDLE, "?weld=1"), 400, "invalid_request")["parameter"], "weld")
        self.assert_problem(self.daemon.get("/v1/nurbs/unread"), 404, "not_found")

    def test_without_a_tessellation(self):
        """A surface that collapses to a line in a part of its domain can be evaluated. Paths on
        this surface are refused with the reason."""
        folded = {"degreeU": 1, "degreeV": 1, "knotsU": [0, 0, 1, 2, 2], "knotsV": [0, 0, 1, 1],
                  "controlPoints": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]], [[1, 0, 0], [1, 1, 0]]]}
        answer = self.put("folded", folded)
        self.assertEqual((answer.status, answer.json["geodesics"], "seeding_faces" in answer.json), (201, False, False), answer)
        self.assertEqual(self.ask("folded", "evaluate", {"uv": [[0.5, 0.5]]})["points"][0]["xyz"], [0.5, 0.5, 0])
        problem = self.refusal("folded", "geodesic", {"from": [0, 0], "to": [1, 1]}, 422, "invalid_mesh")
        self.assertEqual(problem["reason"], answer.json["reason"])


class Evaluation(Nurbs):
    surfaces = {"torus": rational_torus(), "ring": TORUS, "sphere": rational_sphere(), "saddle": SADDLE, "bumps": bumps(8, 4, 0.5, 1),
                "hills": bumps(8, 8, 3, 5)}

    def test_the_rational_torus(self):
        [point] = self.ask("torus", "evaluate", {"uv": [[0.3, 0.7]]})["points"]
        self.assert_close(point["xyz"], [-0.501298420681, 1.630882459688, -0.955863246107])
        self.assert_close(point["du"], [-10.179771947727, -3.129044383289, 0], 1e-11)
        self.assert_close(point["dv"], [-1.752994636132, 5.703046500942, -1.833938738906], 1e-11)
        self.assert_close(point["duv"], [-35.597729586211, -10.941981450229, 0], 1e-11)
        [point] = self.ask("sphere", "evaluate", {"uv": [[0.3, 0.7]]})["points"]
        self.assert_close(point["xyz"], [-0.239111804612, 0.777906396586, 0.581108581115])
        self.assert_near(point["gaussian_curvature"], 1, 1e-12)
        self.assert_near(abs(point["mean_curvature"]), 1, 1e-12)

    def test_the_torus(self):
        chance = random.Random(1)
        places = [[chance.uniform(-9, 9), chance.uniform(-9, 9)] for _ in range(3000)]
        points = self.ask("ring", "evaluate", {"uv": places})["points"]
        self.assertEqual(len(points), 3000)
        for (u, v), point in zip(places, points):
            self.assert_close(point["xyz"], torus_at(u, v), 1e-14)
            self.assert_close(point["normal"], [math.cos(v) * math.cos(u), math.cos(v) * math.sin(u), math.sin(v)], 1e-13)
            self.assert_near(point["gaussian_curvature"], math.cos(v) / (2 + math.cos(v)), 1e-12)

    def test_derivatives_agree_with_positions(self):
        h = 1e-5
        for name in ("torus", "bumps"):
            u, v = 0.31, 0.62
            steps = [[u, v], [u + h, v], [u - h, v], [u, v + h], [u, v - h]]
            x, ahead, behind, above, below = self.ask(name, "evaluate", {"uv": steps})["points"]
            for key, second, plus, minus in (("du", "duu", ahead, behind), ("dv", "dvv", above, below)):
                for k in range(3):
                    self.assertAlmostEqual((plus["xyz"][k] - minus["xyz"][k]) / (2 * h), x[key][k], 6)
                    self.assertAlmostEqual((plus[key][k] - minus[key][k]) / (2 * h), x[second][k], 5)
            for k in range(3):
                self.assertAlmostEqual((above["du"][k] - below["du"][k]) / (2 * h), x["duv"][k], 5)

    def test_at_a_pole(self):
        [point] = self.ask("sphere", "evaluate", {"uv": [[0.3, 1]]})["points"]
        self.assertEqual((point["normal"], point["gaussian_curvature"], point["mean_curvature"]), (None, None, None))
        self.assert_close(point["xyz"], [0, 0, 1], 1e-15)

    def test_fields(self):
        answer = self.ask("saddle", "evaluate", {"uv": [[0, 0], [1, 1]]}, "?select=points,xyz,du")
        self.assertEqual(answer, {"points": [{"xyz": [0, 0, 0], "du": [1, 0, 0]}, {"xyz": [1, 1, 1], "du": [1, 0, 1]}]})
        self.assertEqual(self.ask("saddle", "evaluate", {"uv": [[0, 0], [1, 1]]}, "?select=xyz,du"), answer)
        self.assertEqual(self.ask("saddle", "evaluate", {"uv": [[1, 0]]}, "?select=points"), self.ask("saddle", "evaluate", {"uv": [[1, 0]]}))

    def test_invalid_places(self):
        problem = self.refusal("saddle", "evaluate", {"uv": [[0, 0], [0.5, 1.5]]}, 422, "point_not_on_surface")
        self.assertEqual(problem["pointer"], "/uv/1")
        for pointer, document in (("/uv", {}), ("/uv", {"uv": []}), ("/uv/1", {"uv": [[0, 0], [1]]}), ("/uv/0", {"uv": [["a", 0]]}),
                                  ("/u", {"uv": [[0, 0]], "u": 1})):
            self.assertEqual(self.refusal("saddle", "evaluate", document)["pointer"], pointer)

    def test_nearest(self):
        """Tests that the answer is the globally nearest point. For random points the distance to
        the torus has a closed form."""
        chance = random.Random(2)
        for _ in range(60):
            x, y, z = (chance.uniform(-4, 4) for _ in range(3))
            expected = abs(math.hypot(math.hypot(x, y) - 2, z) - 1)
            for name in ("torus", "ring"):
                foot = self.ask(name, "nearest", {"xyz": [x, y, z]})
                self.assert_near(foot["distance"], expected, 1e-12)
                [point] = self.ask(name, "evaluate", {"uv": [foot["uv"]]})["points"]
                self.assert_close(point["xyz"], foot["xyz"], 1e-12)
        self.assertEqual(self.refusal("ring", "nearest", {"xyz": [1, 2]})["pointer"], "/xyz")
        for point in ({"xyz": [0.5, 0.25, 1]}, "p:0.5,0.25,1"):
            self.assertEqual(self.ask("ring", "nearest", {"point": point}), self.ask("ring", "nearest", {"xyz": [0.5, 0.25, 1]}))
        self.assertEqual(self.daemon.get("/v1/nurbs/ring/nearest?point=p:0.5,0.25,1").json, self.ask("ring", "nearest", {"xyz": [0.5, 0.25, 1]}))
        for query, status in (("", 400), ("?point=v:0", 400), ("?point=p:1,2", 400), ("?point=p:1,2,3&xyz=1", 400), ("?point=p:1,2,3&select=distance", 200)):
            self.assertEqual(self.daemon.get("/v1/nurbs/ring/nearest" + query).status, status, query)
        distance = self.ask("ring", "nearest", {"xyz": [4, 0, 0]})["distance"]
        for most, status in ((distance, 200), (distance * (1 - 1e-15), 422), (0, 422), (-1, 400)):
            document = {"point": {"xyz": [4, 0, 0], "max_snap": most}}
            answer = self.daemon.request("POST", "/v1/nurbs/ring/nearest", json.dumps(document), {"Content-Type": "application/json"})
            self.assertEqual(answer.status, status, answer)
            if status == 422:
                self.assertEqual((answer.json["code"], answer.json["pointer"]), ("point_not_on_surface", "/point"))
        for point in ("v:0", "p:1,2", {"vertex": 0}, 7):
            self.assertEqual(self.refusal("ring", "nearest", {"point": point})["pointer"], "/point", point)
        self.assertEqual(self.refusal("ring", "nearest", {"point": "p:0,0,0", "xyz": [0, 0, 0]})["pointer"], "/xyz")

    def test_nearest_of_several(self):
        """Above hills and valleys, the distance has several local minima. The answer must be the
        global minimum, so no sample of the surface may be nearer."""
        samples = [[i / 60, j / 60] for i in range(61) for j in range(61)]
        points = [point["xyz"] for point in self.ask("hills", "evaluate", {"uv": samples}, "?select=points,xyz")["points"]]
        chance = random.Random(4)
        for _ in range(30):
            xyz = [chance.uniform(0, 7), chance.uniform(0, 7), chance.uniform(3, 9)]
            found = self.ask("hills", "nearest", {"xyz": xyz})["distance"]
            least = min(math.dist(xyz, point) for point in points)
            self.assertLessEqual(found, least + 1e-12)
            self.assertLess(least - found, 0.1)


class Narrow(Nurbs):
    flags = ("--memory-budget", "24MiB", "--max-body", "8MiB")

    def test_over_the_budget(self):
        """A surface that exceeds the memory budget is refused and is not stored."""
        self.assertEqual(self.put("small", bumps(8, 4, 0.5, 1)).status, 201)
        self.assert_problem(self.put("large", bumps(250, 250, 0.1, 1)), 507, "insufficient_memory")
        self.assert_problem(self.post("small", "tessellate", {"mesh": "fine", "resolution": [700, 700]}), 507, "insufficient_memory")
        self.assertEqual([surface["name"] for surface in self.daemon.get("/v1/nurbs").json["nurbs"]], ["small"])
        self.assertEqual(self.daemon.get("/v1/meshes").json["meshes"], [])
        self.daemon.wait_for_flight()
        self.ask("small", "geodesic", {"from": [0.1, 0.1], "to": [0.9, 0.9]})


class Roles(Keyed):
    keys = (line("reader") + line("writer", "role=write") +
            f"stranger sha256:{digest(key_of('stranger'))} tenant=another role=write\n")

    def test_rights_of_keys(self):
        tessellate = json.dumps({"mesh": "made", "resolution": [4, 4]})
        geodesic = json.dumps({"from": [0, 0], "to": [1, 1]})
        self.assert_problem(self.ask("PUT", "/v1/nurbs/saddle", "reader", json.dumps(SADDLE)), 403, "forbidden")
        self.assertEqual(self.ask("PUT", "/v1/nurbs/saddle", "writer", json.dumps(SADDLE)).status, 201)
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/tessellate", "reader", tessellate), 403, "forbidden")
        self.assertEqual(self.ask("POST", "/v1/nurbs/saddle/geodesic", "reader", geodesic).status, 200)
        self.assertEqual(self.ask("POST", "/v1/nurbs/saddle/tessellate", "writer", tessellate).status, 201)
        self.assertEqual(self.ask("GET", "/v1/meshes/made/parameters", "reader").status, 200)
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/geodesic", None, geodesic), 401, "unauthorized")
        self.assert_problem(self.ask("POST", "/v1/nurbs/saddle/geodesic", "stranger", geodesic), 404, "not_found")
        self.assert_problem(self.ask("GET", "/v1/meshes/made/parameters", "stranger"), 404, "not_found")


class Durable(Folder):
    def test_surfaces_and_places_survive_a_restart(self):
        multiplied = rational_torus()
        multiplied["controlPoints"] = [[[w * x for x in point] for point, w in zip(*rows)]
                                       for rows in zip(multiplied["controlPoints"], multiplied["weights"])]
        question = json.dumps({"from": [0, 0], "to": [0.25, 0.25]})
        with self.start() as daemon:
            created = daemon.request("PUT", "/v1/nurbs/torus?convention=verb", json.dumps(multiplied))
            self.assertEqual(created.status, 201, created)
            made = daemon.request("POST", "/v1/nurbs/torus/tessellate", json.dumps({"mesh": "tube", "resolution": [9, 7]}), JSON)
            self.assertEqual(made.status, 201, made)
            places = daemon.get("/v1/meshes/tube/parameters").json
            length = daemon.request("POST", "/v1/nurbs/torus/geodesic", question, JSON).json["length"]
            told = [surface for surface in daemon.get("/v1/nurbs").json["nurbs"]]
        with self.start() as daemon:
            self.assertEqual(daemon.get("/v1/nurbs").json["nurbs"], told)
            self.assertEqual(daemon.get("/v1/meshes/tube/parameters").json, places)
            answer = daemon.request("POST", "/v1/nurbs/torus/geodesic", question, JSON)
            self.assertEqual((answer.json["length"], answer.headers["ETag"]), (length, form_tag(created.headers["ETag"], "json")))
            self.assertEqual(daemon.request("PUT", "/v1/nurbs/torus?convention=verb", json.dumps(multiplied)).status, 200)
            self.assertEqual(daemon.request("DELETE", "/v1/nurbs/torus").status, 204)
            self.assertEqual(daemon.get("/v1/meshes/tube/parameters").json, places)


if __name__ == "__main__":
    unittest.main()
