"""Tests bulk queries, which have many pairs or many points in one request. Each answer equals the
answer to a single query."""
import gzip
import json
import math
import random
import unittest

import arrays
from harness import TWO_TRIANGLES, Daemon, TestCase, sample

BYTES = {"Content-Type": "application/octet-stream"}


def vertices(*numbers):
    return [{"vertex": number} for number in numbers]


class Bulk(TestCase):
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("ball", sample("icosphere", level=4))
        cls.daemon.put("apart", TWO_TRIANGLES)

    def bulk(self, mesh, name, form="f64", **given):
        answer = self.daemon.request("POST", f"/v1/meshes/{mesh}/{name}?format={form}", arrays.write(**given), BYTES)
        self.assertEqual(answer.status, 200, answer)
        return answer.json if form == "json" else {key: numbers for key, (_, numbers) in arrays.read(answer.body).items()}

    def alone(self, mesh, a, b):
        return self.daemon.ask(mesh, "distance?fields=distance", {"from": a, "to": b}).json["distance"]

    def assert_near(self, found, wanted):
        self.assertEqual(len(found), len(wanted))
        for a, b in zip(found, wanted):
            self.assertTrue((a is None or math.isnan(a)) if b is None else abs(a - b) <= 1e-12 * max(1, b), (a, b))

    # --- pairs -----------------------------------------------------------------------------------

    def test_pairs_of_all_kinds(self):
        chance = random.Random(1)
        points = [chance.choice([{"vertex": chance.randrange(2000)}, {"face": chance.randrange(5000), "barycentric": [0.5, 0.25, 0.25]},
                                 {"xyz": [chance.uniform(-1, 1) for _ in range(3)]}]) for _ in range(30)]
        a, b = points[:15], points[15:]
        answer = self.daemon.ask("ball", "pairs", {"from": a, "to": b})
        self.assertEqual(answer.status, 200, answer)
        self.assert_near(answer.json["distances"], [self.alone("ball", *pair) for pair in zip(a, b)])
        for one, many in (("from", "to"), ("to", "from")):
            answer = self.daemon.ask("ball", "pairs", {one: [{"vertex": 5}], many: b})
            self.assert_near(answer.json["distances"], [self.alone("ball", {"vertex": 5}, point) for point in b])

    def test_large_texts(self):
        """A large request in plain form is read without a parsed JSON document. Answers and errors
        are the same as with a document."""
        chance = random.Random(7)
        self.daemon.ask("ball", "fields", {"set": {"points": [{"vertex": 5}]}})
        points = [chance.choice([{"vertex": chance.randrange(2000)}, {"face": chance.randrange(5000), "barycentric": [0.5, 0.25, 0.25]},
                                 {"xyz": [chance.uniform(-1, 1) for _ in range(3)]}]) for _ in range(40_000)]
        whole = {"from": [{"vertex": 5}], "to": points}
        plain = self.daemon.ask("ball", "pairs", whole)
        other = self.daemon.ask("ball", "pairs", {**whole, "from": ["v:5"]})
        self.assertEqual((plain.status, other.status), (200, 200), (plain, other))
        self.assertEqual(plain.body, other.body)
        self.assertEqual(self.daemon.ask("ball", "pairs", dict(reversed(whole.items()))).body, plain.body)
        plain = self.daemon.ask("ball", "nearest-points", {"points": points})
        other = self.daemon.ask("ball", "nearest-points", {"points": ["v:%d" % point["vertex"] if "vertex" in point else point for point in points]})
        self.assertEqual((plain.status, plain.body), (200, other.body))
        for place, point, status in ((0, {"vertex": 9999}, 400), (39_999, {"face": 1, "barycentric": [1, 1, 1]}, 422), (20_000, {"vertex": -1}, 400)):
            broken = points[:place] + [point] + points[place + 1:]
            refused = self.daemon.ask("ball", "pairs", {"from": [{"vertex": 5}], "to": broken})
            self.assertEqual((refused.status, refused.json["pointer"][:len(f"/to/{place}")]), (status, f"/to/{place}"))
        refused = self.daemon.ask("ball", "pairs", {"from": points[:2], "to": points})
        self.assertEqual((refused.status, refused.json["pointer"]), (400, "/to"))

    def test_list_of_pairs(self):
        pairs = [["v:0", "f:7:0.5,0.25,0.25"], [{"xyz": [0, 0, 2]}, "p:1,0,0"], [{"vertex": 3}, {"vertex": 3}]]
        answer = self.daemon.ask("ball", "pairs", {"pairs": pairs})
        self.assertEqual(answer.status, 200, answer)
        self.assert_near(answer.json["distances"], [self.alone("ball", *pair) for pair in pairs])
        binary = self.daemon.ask("ball", "pairs?format=f64", {"pairs": pairs})
        self.assertEqual(list(arrays.read(binary.body)["distances"][1]), answer.json["distances"])
        for body, pointer in (({"pairs": []}, "/pairs"), ({"pairs": {}}, "/pairs"), ({"pairs": None}, "/pairs"),
                              ({"pairs": [["v:0", "v:1"], ["v:0"]]}, "/pairs/1"), ({"pairs": ["v:0"]}, "/pairs/0"),
                              ({"pairs": [["v:0", "v:1", "v:2"]]}, "/pairs/0"), ({"pairs": [["v:0", "v:99999"]]}, "/pairs/0/1"),
                              ({"pairs": [["v:0", 7]]}, "/pairs/0/1"), ({"pairs": pairs, "from": ["v:0"]}, "/pairs")):
            refused = self.daemon.ask("ball", "pairs", body)
            self.assertEqual((refused.status, refused.json["pointer"]), (400, pointer), (body, refused))

    def test_groups(self):
        """Tests few and many pairs that share one point, with and without the field of this point.
        The shared point is the first or the second point of the pairs."""
        chance = random.Random(2)
        self.daemon.ask("ball", "fields", {"set": {"points": [{"vertex": 3}]}})
        rows = [3] * 40 + [4] * 20 + [5] * 3 + [6]
        columns = [chance.randrange(2562) for _ in rows]
        pairs = list(zip(rows, columns))
        chance.shuffle(pairs)
        wanted = [self.alone("ball", {"vertex": a}, {"vertex": b}) for a, b in pairs]
        a, b = [pair[0] for pair in pairs], [pair[1] for pair in pairs]
        for first, second in ((a, b), (b, a)):
            found = self.bulk("ball", "pairs", **{"from": ("I", 0, first), "to": ("I", 0, second)})
            self.assert_near(found["distances"], wanted)

    def test_arrays_of_each_spelling(self):
        xyz = [0.1, 0.2, 1, 1, 0, 0, -1, 0.5, 0.5]
        objects = [{"xyz": xyz[i:i + 3]} for i in (0, 3, 6)]
        wanted = [self.alone("ball", {"vertex": 9}, point) for point in objects]
        for given in ({"to": ("d", 3, xyz)}, {"from": ("I", 0, [9]), "to": ("d", 3, xyz)}):
            given.setdefault("from", ("I", 0, [9, 9, 9]))
            self.assert_near(self.bulk("ball", "pairs", **given)["distances"], wanted)
            self.assert_near(self.bulk("ball", "pairs", "json", **given)["distances"], wanted)
        narrow = self.bulk("ball", "pairs", **{"from": ("I", 0, [9]), "to": ("f", 3, xyz)})["distances"]
        self.assertTrue(all(abs(a - b) < 1e-6 for a, b in zip(narrow, wanted)))
        place = {"to_face": ("I", 0, [7, 8]), "to_barycentric": ("d", 3, [0.5, 0.25, 0.25, 0, 0.5, 0.5])}
        found = self.bulk("ball", "pairs", **{"from": ("I", 0, [9])}, **place)["distances"]
        objects = [{"face": 7, "barycentric": [0.5, 0.25, 0.25]}, {"face": 8, "barycentric": [0, 0.5, 0.5]}]
        self.assert_near(found, [self.alone("ball", {"vertex": 9}, point) for point in objects])

    def test_no_path(self):
        found = self.bulk("apart", "pairs", **{"from": ("I", 0, [0, 0]), "to": ("I", 0, [1, 4])})["distances"]
        self.assert_near(found, [self.alone("apart", {"vertex": 0}, {"vertex": 1}), None])
        answer = self.daemon.ask("apart", "pairs", {"from": vertices(0, 0), "to": vertices(1, 4)})
        self.assert_near(answer.json["distances"], found[:1] + [None])

    def test_invalid_requests_are_refused(self):
        good = {"from": ("I", 0, [0]), "to": ("I", 0, [1])}
        def refused(body, status=400):
            answer = self.daemon.request("POST", "/v1/meshes/ball/pairs", body, BYTES)
            self.assertEqual(answer.status, status, (body[:80], answer))
            return answer.json
        whole = arrays.write(**good)
        for size in range(0, len(whole), 5):
            refused(whole[:size])
        for change in ((0, b"X"), (8, b"\2"), (12, b"\x99"), (12, b"\3"), (16, b"X"), (48, b"\4"), (52, b"\1"), (56, b"\2"), (64, b"\1"), (71, b"\x99"), (72, b"\1")):
            refused(whole[:change[0]] + change[1] + whole[change[0] + 1:])
        refused(arrays.write(**{"from": ("I", 0, [0, 1]), "to": ("I", 0, [1, 2, 3])}))
        refused(arrays.write(**{"from": ("d", 2, [0, 1]), "to": ("I", 0, [1])}))
        refused(arrays.write(**{"from": ("I", 0, []), "to": ("I", 0, [1])}))
        refused(arrays.write(**good, to_face=("I", 0, [1])))
        refused(arrays.write(**{"from": ("I", 0, [0])}))
        problem = refused(arrays.write(**{"from": ("I", 0, [0]), "to": ("I", 0, [1, 99999999, 2])}))
        self.assertEqual(problem["pointer"], "/to/1")
        refused(arrays.write(**{"from": ("I", 0, [0]), "to": ("d", 3, [math.nan, 0, 0])}))
        self.assertEqual(self.daemon.ask("ball", "pairs", {"from": vertices(0), "to": vertices(1, -1)}).status, 400)
        self.assertEqual(self.daemon.request("POST", "/v1/meshes/ball/matrix", whole, BYTES).status, 415)
        self.assertEqual(self.daemon.request("POST", "/v1/meshes/ball/pairs", whole, {"Content-Type": "text/plain"}).status, 415)

    def test_many_pairs_in_pieces(self):
        """All workers compute the answers to many pairs in pieces. Answers may be compressed. The
        limits of the daemon still hold."""
        count, chance = 100000, random.Random(3)
        self.daemon.ask("ball", "fields", {"set": {"points": [{"vertex": 0}]}})
        to = [chance.randrange(2562) for _ in range(count)]
        body = arrays.write(**{"from": ("I", 0, [0]), "to": ("I", 0, to)})
        field = self.daemon.ask("ball", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]
        values = self.daemon.get(f"/v1/meshes/ball/fields/{field}/values").json["values"]
        for body, headers in ((body, BYTES), (gzip.compress(body), {**BYTES, "Content-Encoding": "gzip"})):
            answer = self.daemon.request("POST", "/v1/meshes/ball/pairs?format=f64", body, headers)
            self.assert_near(arrays.read(answer.body)["distances"][1], [values[vertex] for vertex in to])
        answer = self.daemon.request("POST", "/v1/meshes/ball/pairs?format=f64&timeout_ms=1", arrays.write(
            **{"from": ("I", 0, list(range(2000))), "to": ("I", 0, list(range(2000, 0, -1)))}), BYTES)
        self.assert_problem(answer, 504, "deadline_exceeded")
        with Daemon("--memory-budget", "24MiB", "--max-body", "8MiB", "--landmarks", "0") as small:
            small.put("ball", sample("icosphere", level=3))
            answer = small.request("POST", "/v1/meshes/ball/pairs", arrays.write(
                **{"from": ("I", 0, [0]), "to": ("I", 0, [1] * 1000000)}), BYTES)
            self.assertEqual(answer.status, 507, answer)
            small.wait_for_flight()

    # --- nearest points --------------------------------------------------------------------------

    def test_nearest_points(self):
        chance = random.Random(4)
        xyz = [chance.uniform(-1, 1) for _ in range(60)]
        objects = [{"xyz": xyz[i:i + 3]} for i in range(0, 60, 3)]
        alone = [self.daemon.ask("ball", "nearest", {"point": point}).json for point in objects]
        asked = self.daemon.ask("ball", "nearest-points", {"points": objects})
        self.assertEqual(asked.status, 200, asked)
        wanted = {"faces": [point["face"] for point in alone], "barycentric": [point["barycentric"] for point in alone],
                  "xyz": [point["xyz"] for point in alone], "snap_distances": [point["snap_distance"] for point in alone]}
        self.assertEqual(asked.json, wanted)
        found = self.bulk("ball", "nearest-points", points=("d", 3, xyz))
        for name, values in wanted.items():
            self.assertEqual(found[name], sum(values, []) if isinstance(values[0], list) else values)
        self.assertEqual(self.bulk("ball", "nearest-points", "json", points=("d", 3, xyz)), wanted)
        found = self.bulk("ball", "nearest-points", points=("I", 0, [4, 5]))
        self.assertTrue(all(math.isnan(each) for each in found["snap_distances"]))
        answer = self.daemon.ask("ball", "nearest-points?select=faces", {"points": objects})
        self.assertEqual(answer.json, {"faces": wanted["faces"]})


if __name__ == "__main__":
    unittest.main()
