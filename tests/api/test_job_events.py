"""Tests the server-sent events of jobs: their content, and clients that disconnect."""
import time
import unittest

from harness import wait_until
from jobs import SANITIZED_SECONDS, OneWorker, Watch, pair


class Events(OneWorker):
    def test_events(self):
        location = self.start_field(900)
        watch = Watch(self.daemon, location)
        self.assertEqual((watch.response.status, watch.response.headers["Content-Type"]), (200, "text/event-stream"))
        events = list(watch.events)  # the stream ends with the job
        self.assertEqual([event for event, _ in events], ["progress"] * (len(events) - 1) + ["done"])
        self.assertGreater(len(events), 3)
        parts = [data["progress"] for _, data in events]
        self.assertEqual((parts, parts[-1]), (sorted(parts), 1))
        self.assertEqual(events[-1][1]["state"], "done")
        self.assertEqual(events[-1][1]["response"]["status"], 200)
        watch.close()

    def test_events_of_a_cancelled_job(self):
        location = self.start_field(910)
        watch = Watch(self.daemon, location)
        self.assertEqual(next(watch.events)[0], "progress")
        self.cancel(location)
        started = time.monotonic()
        *_, (event, data) = watch.events
        self.assertLess(time.monotonic() - started, SANITIZED_SECONDS)
        self.assertEqual((event, data["state"]), ("done", "cancelled"))
        watch.close()

    def test_events_of_a_job_that_has_ended(self):
        location = self.start("/v1/meshes/square/distance", pair(0, 99))
        self.wait(location, "failed")
        watch = Watch(self.daemon, location)
        ((event, data),) = watch.events
        self.assertEqual((event, data["state"], data["problem"]["status"]), ("done", "failed", 400))
        watch.close()
        self.assertEqual(self.daemon.get(location + "/events", Last_Event_ID="done").status, 204)
        self.assert_problem(self.daemon.get(location + "/events", Accept="application/json"), 406, "not_acceptable")

    def test_a_stream_may_be_followed_by_another_request(self):
        location = self.start("/v1/meshes/square/distance", pair(0, 2))
        connection = self.daemon.connect()
        for path in (location + "/events", "/livez", location + "/events", location):
            self.assertEqual(self.daemon.request("GET", path, connection=connection).status, 200)
        connection.close()

    def test_many_watchers_of_which_some_disconnect(self):
        location = self.start_field(920)
        watches = [Watch(self.daemon, location) for _ in range(200)]
        self.assertEqual(self.daemon.wait_for("event_streams", 200), 200)
        for watch in watches[:100]:
            watch.close()
        # streams of clients that have left are closed
        wait_until(lambda: self.daemon.metric("event_streams") <= 100, 5)
        self.cancel(location)
        for watch in watches[100:]:
            *_, (event, data) = watch.events
            self.assertEqual((event, data["state"]), ("done", "cancelled"))
            watch.close()
        while self.daemon.metric("event_streams"):
            time.sleep(0.001)

    def test_a_watcher_that_disconnects_during_silence(self):
        """A waiting job sends no events, so the daemon must detect by itself that the clients of
        its stream have disconnected."""
        self.daemon.ask_often("big", "v:927")
        running = self.start_field(925)
        next_one = self.start("/v1/meshes/big/distance", pair(927, 5001))
        self.wait(running, "running")
        queued = self.start("/v1/meshes/big/distance", pair(926, 5000))
        stays, goes = Watch(self.daemon, queued), Watch(self.daemon, queued)
        next(stays.events)
        goes.close()
        # streams of clients that have left are closed
        wait_until(lambda: self.daemon.metric("event_streams") <= 1, 5)
        self.cancel(queued)
        *_, (event, data) = stays.events
        self.assertEqual((event, data["state"]), ("done", "cancelled"))
        stays.close()
        self.cancel(next_one)
        self.cancel(running)

    def test_watchers_keep_no_http_thread(self):
        running = self.start_field(930)
        watches = [Watch(self.daemon, running) for _ in range(50)]
        started = time.monotonic()
        for _ in range(100):
            self.assertEqual(self.daemon.get("/livez").status, 200)
        self.assertLess(time.monotonic() - started, SANITIZED_SECONDS)
        self.cancel(running)
        for watch in watches:
            watch.close()


if __name__ == "__main__":
    unittest.main()
