"""Tests batches on several daemons, while daemons and the database fail and recover."""
import concurrent.futures
import time

from cluster import Relay
from harness import SQUARE, sample, wait_until
from jobs import ASYNC, big_mesh
from test_batches import begin, follow, results, wait
from test_nodes import LONG, Shared, setUpModule  # noqa: F401  (skips without PostgreSQL)


class Spread(Shared):
    def test_one_of_three_daemons_dies(self):
        nodes = [self.start("--workers", "1") for _ in range(3)]
        count = 2000 if LONG else 400
        self.assertEqual(nodes[0].put("sphere", sample("icosphere", level=4)).status, 201)
        begun = begin(nodes[1], {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(count))})
        self.assertEqual(begun.status, 201, begun)
        nodes[0].wait_until(lambda node: node.get(f"/v1/batches/{begun.json['id']}").json["done"] > count // 10)
        nodes[2].kill()
        # no answer is skipped while two daemons write answers
        followed, _ = follow(nodes[0], begun.json["id"], limit=50)
        self.assertEqual(sorted(one["item"] for one in followed), list(range(count)))
        told = wait(nodes[0], begun.json["id"], 90)
        self.assertEqual((told["state"], told["done"], told["failed"]), ("done", count, 0))
        found = results(nodes[1], told["id"])
        # every item occurs once, and the items are in order
        self.assertEqual([one["item"] for one in found], list(range(count)))
        shares = [node.metric("batch_items_answered_total") for node in nodes[:2]]
        print(f"# {count} items over three daemons, one killed: every answer once; the two others gave {shares}")
        self.assertGreater(min(shares), 0)
        for i in range(0, count, 7):
            for j in range(0, count, 11):
                self.assertAlmostEqual(found[i]["answer"]["distances"][0][j], found[j]["answer"]["distances"][0][i], delta=1e-12)

    def test_a_wait_for_a_job_ends_while_the_network_is_silent(self):
        """A request that reads a batch blocks for the database. A wait for a job does not."""
        relay = Relay(self.database.port)
        self.addCleanup(relay.close)
        node = self.start("--workers", "2", "--landmarks", "0", port=relay.port)
        self.assertEqual(node.put("big", big_mesh()).status, 201)
        batch = begin(node, {"query": "all-pairs", "mesh": "big", "vertices": [0]}).json["id"]
        wait(node, batch)
        job = node.ask("big", "fields", {"set": {"points": [{"vertex": 5}]}}, ASYNC).headers["Location"]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            waiting = pool.submit(node.get, f"{job}?wait=60")
            wait_until(lambda: node.metric("requests_deferred") >= 2)
            relay.hold()
            reading = pool.submit(node.get, f"/v1/batches/{batch}")
            wait_until(lambda: node.metric("requests_deferred") >= 3)
            self.assertEqual(node.request("DELETE", job).status, 204)
            self.assertEqual(waiting.result().json["state"], "cancelled")
            self.assertFalse(reading.done())
            relay.mend()

    def test_a_batch_that_may_exist(self):
        """The response names no time for a repetition, which could add a second batch."""
        relay = Relay(self.database.port)
        self.addCleanup(relay.close)
        node = self.start("--landmarks", "0", port=relay.port)
        self.assertEqual(node.put("square", SQUARE).status, 201)
        document = {"query": "all-pairs", "mesh": "square", "vertices": [0]}
        self.database.query("CREATE FUNCTION public.nap() RETURNS trigger LANGUAGE plpgsql AS 'BEGIN PERFORM pg_sleep(0.5); RETURN NEW; END'")
        self.addCleanup(self.database.query, "DROP FUNCTION public.nap() CASCADE")
        self.database.query("CREATE TRIGGER nap BEFORE INSERT ON geodesicd.batches FOR EACH ROW EXECUTE FUNCTION public.nap()")
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            adding = pool.submit(begin, node, document)
            wait_until(lambda: self.database.query("SELECT count(*) FROM pg_stat_activity WHERE wait_event = 'PgSleep'") == "1")
            relay.refuse()
            answer = adding.result()
        self.assertEqual((answer.status, answer.json["code"], answer.headers["Retry-After"]), (503, "store_unavailable", None))

    def test_the_database_stops_and_returns(self):
        nodes = [self.start(), self.start()]
        self.assertEqual(nodes[0].put("sphere", sample("icosphere", level=4)).status, 201)
        begun = begin(nodes[1], {"query": "all-pairs", "mesh": "sphere", "vertices": list(range(300))})
        time.sleep(0.3)
        self.database.stop()
        time.sleep(1)
        self.assertEqual(nodes[0].get(f"/v1/batches/{begun.json['id']}").status, 503)
        self.database.start()
        for node in nodes:
            node.wait_until(lambda node: node.get("/v1/batches").status == 200, 10)
        told = wait(nodes[0], begun.json["id"], 90)
        self.assertEqual((told["done"], told["failed"]), (300, 0))
