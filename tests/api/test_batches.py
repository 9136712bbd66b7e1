"""Tests batches, which run one query for many sources, item by item. tests/cluster/test_spread.py
tests several daemons that share a database."""
import json
import pathlib
import tempfile
import threading
import time
import unittest

from harness import PATIENCE_SECONDS, TETRAHEDRON, Daemon, TestCase, sample


def begin(node, document):
    return node.request("POST", "/v1/batches", json.dumps(document), {"Content-Type": "application/json"})


def results(node, id, limit=1000):
    """Returns all answers, page by page."""
    found, after = [], ""
    while True:
        page = node.get(f"/v1/batches/{id}/results?limit={limit}{after}")
        assert page.status == 200, page
        found += page.json["results"]
        if page.json["next"] is None:
            return found
        after = f"&after={page.json['next']}"


def follow(node, id, cursor=0, limit=100, seconds=30):
    """Reads all answers page by page, in the order of their arrival. Returns (items, cursors)."""
    found, cursors = [], []
    while cursor is not None:
        page = node.get(f"/v1/batches/{id}/results?cursor={cursor}&limit={limit}&wait={seconds}").json
        found += page["results"]
        cursors.append(cursor)
        cursor = page["next"]
    assert page["state"] in ("done", "cancelled"), page
    return found, cursors


def wait(node, id, seconds=PATIENCE_SECONDS):
    """Waits until the batch has ended. Fails if no item ends within `seconds`."""
    done, since = -1, 0
    while (told := node.get(f"/v1/batches/{id}").json)["state"] == "running":
        if told["done"] > done:
            done, since = told["done"], time.monotonic()
        if time.monotonic() - since > seconds:
            raise TimeoutError(told)
        time.sleep(0.02)
    return told


class Alone:
    """Tests a single daemon with any kind of store. `self.daemon` is the daemon."""

    def test_all_pairs(self):
        vertices = [0, 5, 17, 100, 41]
        self.assertEqual(self.daemon.put("sphere", sample("icosphere", level=3)).status, 201)
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": vertices})
        self.assertEqual(begun.status, 201, begun)
        self.assertEqual(begun.headers["Location"], f"/v1/batches/{begun.json['id']}")
        told = wait(self.daemon, begun.json["id"])
        self.assertEqual((told["state"], told["items"], told["done"], told["failed"], told["progress"]), ("done", 5, 5, 0, 1))
        points = [{"vertex": vertex} for vertex in vertices]
        matrix = self.daemon.ask("sphere", "matrix", {"sources": points, "targets": points}).json["distances"]
        found = results(self.daemon, told["id"], limit=2)
        self.assertEqual([(one["item"], one["vertex"], one["mesh"], one["status"]) for one in found],
                         [(i, vertex, "sphere", 200) for i, vertex in enumerate(vertices)])
        for row, one in zip(matrix, found):
            for a, b in zip(row, one["answer"]["distances"][0]):
                self.assertAlmostEqual(a, b, delta=1e-12)
        self.assertIn(told["id"], [batch["id"] for batch in self.daemon.get("/v1/batches").json["batches"]])
        self.assertEqual(self.daemon.request("DELETE", f"/v1/batches/{told['id']}").status, 204)
        self.assertEqual(self.daemon.get(f"/v1/batches/{told['id']}").status, 404)

    def test_answers_are_followed_as_they_come(self):
        self.assertIn(self.daemon.put("sphere", sample("icosphere", level=4)).status, (200, 201))
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(150))})
        found, cursors = follow(self.daemon, begun.json["id"], limit=7)
        self.assertEqual(sorted(one["item"] for one in found), list(range(150)))
        again, _ = follow(self.daemon, begun.json["id"], limit=1000)
        self.assertEqual([one["item"] for one in again], [one["item"] for one in found])
        rest, _ = follow(self.daemon, begun.json["id"], cursor=cursors[-1])
        self.assertEqual(rest, found[int(cursors[-1]):])
        page = self.daemon.get(f"/v1/batches/{begun.json['id']}/results?limit=2").json
        self.assertEqual(([one["item"] for one in page["results"]], page["state"], page["next"]), ([0, 1], "done", "1"))

    def test_requests_wait_for_answers(self):
        self.assertIn(self.daemon.put("large", sample("icosphere", level=6)).status, (200, 201))
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "large", "vertices": list(range(3000))})
        path = f"/v1/batches/{begun.json['id']}"
        page = self.daemon.get(f"{path}/results?cursor=0&wait=30").json
        self.assertTrue(page["results"])
        self.assertEqual((page["state"], page["next"]), ("running", str(len(page["results"]))))
        since = time.monotonic()
        page = self.daemon.get(f"{path}/results?cursor=3000&wait=1").json
        self.assertEqual((page["results"], page["state"], page["next"]), ([], "running", "3000"))
        self.assertEqual(self.daemon.get(f"{path}?wait=1").json["state"], "running")
        self.assertGreater(time.monotonic() - since, 1.9)
        told = []
        waiting = [threading.Thread(target=lambda target=target: told.append(self.daemon.get(target).json["state"]))
                   for target in (f"{path}?wait=60", f"{path}/results?cursor=3000&wait=60")]
        for thread in waiting:
            thread.start()
        time.sleep(0.2)
        self.assertEqual(self.daemon.request("DELETE", path).status, 204)
        since = time.monotonic()
        for thread in waiting:
            thread.join()
        self.assertEqual(told, ["cancelled", "cancelled"])
        self.assertLess(time.monotonic() - since, 20)
        self.assertIsNone(self.daemon.get(f"{path}/results?cursor=3000").json["next"])
        self.assertEqual(self.daemon.request("DELETE", path).status, 204)

    def test_pages_stay_within_the_largest_answer(self):
        with Daemon("--max-answer", "64KiB") as daemon:
            self.assertEqual(daemon.put("ball", sample("icosphere", level=3)).status, 201)
            begun = begin(daemon, {"query": "all-pairs", "mesh": "ball", "vertices": list(range(100))})
            wait(daemon, begun.json["id"])
            self.assertEqual([one["item"] for one in results(daemon, begun.json["id"])], list(range(100)))

    def test_parameters_of_waiting(self):
        for target, parameter in (("/results?cursor=x", "cursor"), ("/results?cursor=-1", "cursor"), ("/results?wait=1", "wait"), ("/results?cursor=0&after=1", "after"),
                                  ("/results?cursor=0&wait=61", "wait"), ("?wait=61", "wait"), ("?wait=", "wait"), ("?cursor=0", "cursor"), ("/results?after=x", "after")):
            answer = self.daemon.get(f"/v1/batches/0123456789abcdef01234567{target}")
            self.assertEqual((answer.status, answer.json["code"], answer.json["parameter"]), (400, "invalid_request", parameter), target)

    def test_fields_of_meshes(self):
        names = ["a", "b", "missing"]
        for name in names[:2]:
            self.assertIn(self.daemon.put(name, TETRAHEDRON).status, (200, 201))
        begun = begin(self.daemon, {"query": "fields", "meshes": names, "set": {"points": [{"vertex": 0}]}})
        told = wait(self.daemon, begun.json["id"])
        self.assertEqual((told["done"], told["failed"]), (3, 1))
        found = results(self.daemon, told["id"])
        self.assertEqual([(one["mesh"], one["status"]) for one in found], [("a", 201), ("b", 201), ("missing", 404)])
        self.assertEqual(found[2]["problem"]["code"], "not_found")
        field = found[0]["answer"]["id"]
        self.assertEqual(self.daemon.get(f"/v1/meshes/a/fields/{field}").status, 200)

    def test_replacing_the_mesh_fails_the_remaining_items(self):
        self.assertIn(self.daemon.put("changes", sample("icosphere", level=5)).status, (200, 201))
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "changes", "vertices": list(range(2000))})
        self.assertEqual(self.daemon.put("changes", TETRAHEDRON).status, 200)
        told = wait(self.daemon, begun.json["id"])
        self.assertGreater(told["failed"], 0)
        self.assertEqual({one["problem"]["code"] for one in results(self.daemon, told["id"]) if one["status"] != 200}, {"precondition_failed"})

    def test_cancelling(self):
        self.assertIn(self.daemon.put("large", sample("icosphere", level=6)).status, (200, 201))
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "large", "vertices": list(range(3000))})
        path = f"/v1/batches/{begun.json['id']}"
        self.assertEqual(self.daemon.request("DELETE", path).status, 204)
        told = self.daemon.get(path).json
        self.assertEqual(told["state"], "cancelled")
        time.sleep(1)
        self.assertLessEqual(self.daemon.get(path).json["done"], told["done"] + 2)
        self.assertEqual(self.daemon.request("DELETE", path).status, 204)
        self.assertEqual(self.daemon.get(path).status, 404)

    def test_invalid_requests_are_refused(self):
        for document, status, code, pointer in (
                ({"query": "all-pairs", "mesh": "nobody", "vertices": [0]}, 404, "not_found", None),
                ({"query": "all-pairs", "mesh": "a b", "vertices": [0]}, 400, "invalid_request", "/mesh"),
                ({"query": "all-pairs", "mesh": "a", "vertices": []}, 400, "invalid_request", "/vertices"),
                ({"query": "all-pairs", "mesh": "a", "vertices": [1.5]}, 400, "invalid_request", "/vertices/0"),
                ({"query": "all-pairs", "mesh": "a", "vertices": [0], "more": 1}, 400, "invalid_request", "/more"),
                ({"query": "fields", "meshes": ["a"]}, 400, "invalid_request", None),
                ({"query": "distance"}, 400, "invalid_request", "/query"),
                ([], 400, "invalid_request", "")):
            answer = begin(self.daemon, document)
            self.assertEqual((answer.status, answer.json["code"]), (status, code), (document, answer))
            if pointer is not None:
                self.assertEqual(answer.json["pointer"], pointer)
        for path in ("/v1/batches/0123456789abcdef01234567", "/v1/batches/x", "/v1/batches/x/results"):
            self.assertEqual(self.daemon.get(path).status, 404)
        self.assertEqual(self.daemon.request("PUT", "/v1/batches").status, 405)


class InMemory(Alone, TestCase):
    def test_there_are_a_thousand_at_most(self):
        document = {"query": "fields", "meshes": ["nobody"], "set": {"points": [{"vertex": 0}]}}
        with Daemon() as daemon:
            ids = [begin(daemon, document).json["id"] for _ in range(1000)]
            refused = begin(daemon, document)
            self.assertEqual((refused.status, refused.json["code"], refused.json["limit"]), (409, "conflict", 1000))
            self.assertIsNone(refused.headers["Retry-After"])
            wait(daemon, ids[0])
            self.assertEqual(daemon.request("DELETE", f"/v1/batches/{ids[0]}").status, 204)
            self.assertEqual(begin(daemon, document).status, 201)


class InAFolder(Alone, unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.daemon = self.start()

    def start(self):
        return Daemon("--data-dir", str(pathlib.Path(self.place.name) / "data"))

    def tearDown(self):
        self.assertEqual(self.daemon.stop(), 0)
        self.place.cleanup()

    def test_a_batch_continues_after_a_crash(self):
        self.assertEqual(self.daemon.put("sphere", sample("icosphere", level=4)).status, 201)
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(300))})
        path = f"/v1/batches/{begun.json['id']}"
        page = self.daemon.get(f"{path}/results?cursor=0&wait=60").json
        done = self.daemon.get(path).json["done"]
        self.daemon.process.kill()
        self.daemon.process.wait()
        self.daemon = self.start()
        self.assertGreaterEqual(self.daemon.get(path).json["done"], done)
        told = wait(self.daemon, begun.json["id"])
        self.assertEqual((told["done"], told["failed"]), (300, 0))
        rest, _ = follow(self.daemon, begun.json["id"], page["next"])
        self.assertEqual(sorted(one["item"] for one in page["results"] + rest), list(range(300)))

    def test_a_stopping_daemon_answers_waiting_clients(self):
        self.assertEqual(self.daemon.put("large", sample("icosphere", level=6)).status, 201)
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "large", "vertices": list(range(3000))})
        told = []
        waiting = threading.Thread(target=lambda: told.append(self.daemon.get(f"/v1/batches/{begun.json['id']}?wait=50")))
        waiting.start()
        time.sleep(0.5)
        since = time.monotonic()
        self.assertEqual(self.daemon.stop(), 0)
        waiting.join()
        self.assertLess(time.monotonic() - since, 5)
        self.assertEqual((told[0].status, told[0].json["state"]), (200, "running"))
        self.daemon = self.start()
        self.assertEqual(self.daemon.request("DELETE", f"/v1/batches/{begun.json['id']}").status, 204)

    def test_a_batch_continues_after_a_restart(self):
        self.assertEqual(self.daemon.put("sphere", sample("icosphere", level=4)).status, 201)
        begun = begin(self.daemon, {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(200))})
        self.assertEqual(self.daemon.stop(), 0)
        self.daemon = self.start()
        # the stopped daemon has given its running items back, so the next daemon need not wait
        # until their leases expire
        told = wait(self.daemon, begun.json["id"], 10)
        self.assertEqual((told["done"], told["failed"]), (200, 0))
