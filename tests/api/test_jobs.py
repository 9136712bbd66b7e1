"""Tests jobs: Prefer: respond-async, results, cancelling, expiry, limits, and drain."""
import concurrent.futures
import http.client
import json
import socket
import threading
import time
import unittest

from harness import PATIENCE_SECONDS, SQUARE, TETRAHEDRON, Daemon, sample, wait_until
from jobs import ASYNC, JSON, SANITIZED_SECONDS, Jobs, OneWorker, Watch, big_mesh, pair


class Answers(Jobs):
    """The result of a job equals the direct answer of the operation."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.daemon.put("square", SQUARE)

    def result(self, location):
        job = self.wait(location, "done")
        answer = self.daemon.get(location + "/result")
        self.assertEqual((answer.status, answer.headers["Content-Type"]),
                         (job["response"]["status"], job["response"]["media_type"]))
        self.assertEqual(answer.json, job["result"])
        self.assertEqual(len(answer.body), job["response"]["bytes"])
        for name, value in job["response"]["headers"].items():
            self.assertEqual(answer.headers[name], value)
        return answer

    def test_queries(self):
        for method, path, document in (
                ("GET", "distance?from=v:0&to=v:2", None), ("POST", "distance", pair(0, 2)),
                ("GET", "path?from=v:0&to=v:2&geometry=xyz", None), ("POST", "path?select=path", pair(0, 2)),
                ("GET", "nearest?point=p:0.5,0.25,3", None), ("POST", "nearest", {"point": {"vertex": 1}})):
            path = f"/v1/meshes/square/{path}"
            expected = self.daemon.request(method, path, document and json.dumps(document), JSON if document else {})
            answer = self.result(self.start(path, document, method))
            self.assertEqual((answer.status, answer.body), (200, expected.body), path)
            self.assertEqual(answer.headers["ETag"], expected.headers["ETag"])

    def test_uploads(self):
        answer = self.daemon.put("cube", TETRAHEDRON, Prefer="respond-async")
        self.assertEqual(answer.status, 202)
        result = self.result(answer.headers["Location"])
        self.assertEqual((result.status, result.headers["Location"]), (201, "/v1/meshes/cube"))
        description = self.daemon.get("/v1/meshes/cube")
        self.assertEqual((result.json, result.headers["ETag"]), (description.json, description.headers["ETag"]))
        again = self.daemon.request("POST", "/v1/meshes", TETRAHEDRON, ASYNC)
        self.assertEqual(self.result(again.headers["Location"]).json["sha256"], description.json["sha256"])

    def test_problems(self):
        for path, document, status, code in (
                ("/v1/meshes/nobody/distance", pair(0, 1), 404, "not_found"),
                ("/v1/meshes/square/distance", {"from": 3}, 400, "invalid_request"),
                ("/v1/meshes/square/distance?color=red", pair(0, 1), 400, "invalid_request"),
                ("/v1/meshes/square/distance", pair(0, 99), 400, "invalid_request")):
            location = self.start(path, document)
            job = self.wait(location, "failed")
            self.assertEqual((job["problem"]["status"], job["problem"]["code"]), (status, code))
            self.assertEqual(self.assert_problem(self.daemon.get(location + "/result"), status, code), job["problem"])
        bad = self.daemon.put("bad", b"hello", Prefer="respond-async").headers["Location"]
        self.assertEqual(self.wait(bad, "failed")["problem"]["code"], "invalid_mesh")

    def test_requests_refused_before_the_handler_make_no_job(self):
        self.assert_problem(self.daemon.request("POST", "/v1/nowhere", b"", ASYNC), 404, "not_found")
        self.assert_problem(self.daemon.request("POST", "/v1/meshes/square", b"", ASYNC), 405, "method_not_allowed")
        foreign = {**ASYNC, "Origin": "http://evil.example"}
        self.assert_problem(self.daemon.request("PUT", "/v1/meshes/a", SQUARE, foreign), 403, "forbidden")

    def test_other_operations_ignore_the_preference(self):
        for method, path, status in (("GET", "/v1", 200), ("GET", "/v1/meshes", 200), ("GET", "/v1/meshes/square", 200),
                                     ("GET", "/v1/jobs", 200), ("GET", "/livez", 200)):
            answer = self.daemon.request(method, path, headers=ASYNC)
            self.assertEqual((answer.status, answer.headers["Preference-Applied"]), (status, None))

    def test_other_preferences(self):
        path = "/v1/meshes/square/distance?from=v:0&to=v:2"
        for value in ("return=minimal", "wait=10", "respond-async=no", 'a="respond-async"', ""):
            self.assertEqual(self.daemon.get(path, Prefer=value).status, 200, value)
        for value in ("Respond-Async", "wait=10, respond-async", "respond-async; a=b", "a=b , respond-async"):
            self.assertEqual(self.daemon.get(path, Prefer=value).status, 202, value)

    def test_the_reader_of_the_result_chooses_its_compression(self):
        location = self.start("/v1/meshes/square/distance", pair(0, 2), **{"Accept-Encoding": "gzip"})
        self.wait(location, "done")
        answer = self.daemon.get(location + "/result")
        self.assertIsNone(answer.headers["Content-Encoding"])
        upload = self.daemon.put("long", sample("icosphere", level=3), Prefer="respond-async", Accept_Encoding="gzip")
        location = upload.headers["Location"]
        self.wait(location, "done")
        self.assertIn("bounding_box", self.daemon.get(location + "/result").json)

    def test_conditions(self):
        upload = self.daemon.put("square", SQUARE, Prefer="respond-async", If_None_Match="*")
        self.assertEqual(self.wait(upload.headers["Location"], "failed")["problem"]["code"], "precondition_failed")
        location = self.start("/v1/meshes/square/distance?from=v:0&to=v:1", method="GET")
        tag = self.wait(location, "done")["response"]["headers"]["ETag"]
        self.assertEqual(self.daemon.get(location + "/result", If_None_Match=tag).status, 304)

    def test_a_job_as_a_resource(self):
        location = self.start("/v1/meshes/square/distance", pair(0, 2))
        job = self.wait(location, "done")
        self.assertEqual((job["progress"], job["request"]), (1, "POST /v1/meshes/square/distance"))
        self.assertRegex(job["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assert_problem(self.daemon.get(location + "?verbose"), 400, "invalid_request")
        self.assert_problem(self.daemon.get(location, Accept="image/png"), 406, "not_acceptable")
        self.assertEqual(self.daemon.request("HEAD", location).status, 200)
        self.cancel(location)
        for suffix in ("", "/result", "/events"):
            self.assert_problem(self.daemon.get(location + suffix), 404, "not_found")
        self.assert_problem(self.daemon.request("DELETE", location), 404, "not_found")
        for name in ("x", "0" * 24, "f" * 24, "%00", "a" * 300):
            self.assertIn(self.daemon.get(f"/v1/jobs/{name}").status, (400, 404))

    def test_list(self):
        started = [self.start("/v1/meshes/square/distance", pair(0, 2)) for _ in range(5)]
        for location in started:
            self.wait(location, "done")
        seen, after = [], ""
        while after is not None:
            page = self.daemon.get(f"/v1/jobs?limit=2{after and '&after=' + after}").json
            self.assertLessEqual(len(page["jobs"]), 2)
            seen += page["jobs"]
            after = page["next"]
        self.assertEqual([f"/v1/jobs/{job['id']}" for job in seen][-5:], started)
        self.assertEqual([job["id"] for job in seen], sorted(job["id"] for job in seen))
        self.assertNotIn("result", seen[-1])
        self.assert_problem(self.daemon.get("/v1/jobs?limit=0"), 400, "invalid_request")

    def test_metrics(self):
        before = self.ended("done")
        self.wait(self.start("/v1/meshes/square/distance", pair(0, 2)), "done")
        self.assertEqual(self.ended("done"), before + 1)
        self.assertIn('geodesicd_jobs{state="running"} 0\n', self.daemon.get("/metrics").body.decode())
        wait_until(lambda: self.daemon.metric("requests_deferred") == 0)

    def ended(self, state):
        for line in self.daemon.get("/metrics").body.decode().splitlines():
            if line.startswith(f'geodesicd_jobs_ended_total{{state="{state}"}}'):
                return int(line.split()[1])
        raise KeyError(state)


class Work(OneWorker):
    def seconds_until_idle(self):
        started = time.monotonic()
        while self.daemon.metric("workers_busy"):
            pass
        return time.monotonic() - started

    def test_progress_means_something_and_never_falls(self):
        location = self.start_field(100)
        seen = []
        while (job := self.daemon.get(location).json)["state"] in ("queued", "running"):
            seen.append(job["progress"])
            self.assertNotIn("result", job)
            time.sleep(0.005)
        self.assertEqual((job["state"], job["progress"]), ("done", 1))
        self.assertEqual(seen, sorted(seen))
        self.assertGreater(len([part for part in set(seen) if 0.05 < part < 0.95]), 5, seen)

    def test_progress_of_an_upload(self):
        location = self.daemon.put("other", big_mesh(), "?weld=0", Prefer="respond-async").headers["Location"]
        seen = []
        while (job := self.daemon.get(location).json)["state"] in ("queued", "running"):
            seen.append(job["progress"])
        self.assertEqual(job["response"]["status"], 201, job)
        self.assertEqual(seen, sorted(seen))
        self.assertGreater(max(seen), 0.2, seen)
        self.daemon.request("DELETE", "/v1/meshes/other")

    def test_cancel_frees_the_worker_within_50_ms(self):
        took = []
        for source in range(200, 205):
            location = self.start_field(source)
            self.wait(location, "running")
            while self.daemon.get(location).json["progress"] < 0.02:
                pass
            self.cancel(location)
            took.append(self.seconds_until_idle())
            self.assertEqual(self.daemon.get(location).json["state"], "cancelled")
        self.assertLess(sorted(took)[2], 0.05, took)
        self.assert_problem(self.daemon.get(location + "/result"), 409, "conflict")
        self.cancel(location)
        self.assert_problem(self.daemon.get(location), 404, "not_found")

    def test_cancelling_a_waiting_job(self):
        running = self.start_field(300)
        self.wait(running, "running")
        queued = self.start("/v1/meshes/big/distance", pair(301, 5000))
        self.assertEqual(self.daemon.get(queued).json["state"], "queued")
        self.assert_problem(self.daemon.get(queued + "/result"), 409, "conflict")
        self.cancel(queued)
        self.assertEqual(self.daemon.get(queued).json["state"], "cancelled")
        while self.daemon.metric("queue_depth"):
            pass
        self.assertEqual(self.daemon.get(running).json["state"], "running", "too fast to watch")
        self.cancel(running)

    def test_two_jobs_share_one_build(self):
        builds, waits = self.daemon.metric("cache_builds_total"), self.daemon.metric("cache_waits_total")
        first = self.start_field(400)
        wait_until(lambda: self.daemon.metric("cache_builds_total") > builds)
        # more jobs than the queue holds
        others = [self.start("/v1/meshes/big/distance", pair(400, target)) for target in range(5)]
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            direct = pool.submit(self.daemon.ask, "big", "distance", pair(400, 159600))
            result = self.wait(first, "done")["result"]
            self.assertEqual(direct.result().json, result)
        for other in others:
            self.wait(other, "done")
        self.assertEqual(self.daemon.metric("cache_builds_total") - builds, 1)
        self.assertEqual(self.daemon.metric("cache_waits_total") - waits, 6)

    def test_a_cancelled_build_continues_for_waiting_requests(self):
        builds = self.daemon.metric("cache_builds_total")
        first = self.start_field(500)
        self.wait(first, "running")
        second = self.start("/v1/meshes/big/distance", pair(500, 7))
        self.cancel(first)
        self.assertEqual(self.daemon.get(first).json["state"], "cancelled")
        self.wait(second, "done")
        self.assertEqual(self.daemon.metric("cache_builds_total") - builds, 1)
        self.assertEqual(self.daemon.get(first).json["state"], "cancelled")

    def test_deadlines(self):
        location = self.start("/v1/meshes/big/distance?timeout_ms=3", pair(600, 159000))
        self.assertEqual(self.wait(location, "failed")["problem"]["code"], "deadline_exceeded")
        running = self.start_field(601)
        self.wait(running, "running")
        waiting = self.start("/v1/meshes/big/distance?timeout_ms=20", pair(602, 159000))
        self.assertEqual(self.wait(waiting, "failed")["problem"]["code"], "deadline_exceeded")
        self.assertEqual(self.daemon.get(running).json["state"], "running", "too fast to watch")
        self.cancel(running)

    def test_a_full_queue_refuses_at_once(self):
        running = self.start_field(700)
        self.wait(running, "running")
        waiting = [self.start("/v1/meshes/big/distance", pair(701 + i, 5000)) for i in range(2)]
        before = len(self.daemon.get("/v1/jobs").json["jobs"])
        refused = self.daemon.request("POST", "/v1/meshes/big/distance", json.dumps(pair(710, 5000)), {**ASYNC, **JSON})
        self.assert_problem(refused, 503, "overloaded")
        self.assertGreaterEqual(int(refused.headers["Retry-After"]), 1)
        self.assertEqual(len(self.daemon.get("/v1/jobs").json["jobs"]), before)
        for location in (running, *waiting):
            self.cancel(location)

    def test_a_job_continues_when_its_client_disconnects(self):
        self.daemon.ask_often("big", "v:800")
        body = json.dumps(pair(800, 5000)).encode()
        head = (b"POST /v1/meshes/big/distance HTTP/1.1\r\nHost: localhost\r\nPrefer: respond-async\r\n"
                b"Content-Type: application/json\r\nContent-Length: %d\r\n\r\n" % len(body))
        with socket.create_connection(("127.0.0.1", self.daemon.port)) as connection:
            connection.sendall(head + body)
            self.assertTrue(connection.recv(4096).startswith(b"HTTP/1.1 202 "))
        job = self.daemon.get("/v1/jobs").json["jobs"][-1]
        self.wait(f"/v1/jobs/{job['id']}", "done")


class Waiting(OneWorker):
    """Tests GET with ?wait=."""

    def ask(self, location, seconds):
        since = time.monotonic()
        answer = self.daemon.get(f"{location}?wait={seconds}")
        self.assertEqual(answer.status, 200, answer)
        return answer.json["state"], time.monotonic() - since

    def test_the_answer_comes_with_the_end(self):
        location = self.start_field(0)
        job = self.daemon.get(location + "?wait=60").json
        self.assertEqual((job["state"], job["progress"]), ("done", 1))
        self.assertIn("distance", job["result"])
        state, seconds = self.ask(location, 60)
        self.assertEqual(state, "done")
        self.assertLess(seconds, SANITIZED_SECONDS)

    def test_the_answer_comes_when_the_time_is_over(self):
        locations = [self.start_field(1), self.start_field(2)]  # one runs, one is queued
        with concurrent.futures.ThreadPoolExecutor(40) as pool:
            told = list(pool.map(lambda turn: self.ask(locations[turn % 2], 1), range(40)))
            for turn, (state, seconds) in enumerate(told):
                self.assertIn(state, ("queued", "running", "done"))
                if state != "done":
                    self.assertGreater(seconds, 0.9)
            for location in locations:
                self.wait(location, "done")
            for source in (3, 4):
                self.daemon.ask_often("big", f"v:{source}")
            locations = [self.start("/v1/meshes/big/distance", pair(source, 160000 - source)) for source in (3, 4)]
            waiting = [pool.submit(self.ask, location, 60) for location in locations]
            time.sleep(0.05)
            since = time.monotonic()
            self.assertEqual(self.daemon.get("/v1/meshes/square/nearest?point=v:0").status, 200)
            for location in reversed(locations):
                self.cancel(location)
            self.assertEqual([each.result()[0] for each in waiting], ["cancelled", "cancelled"])
            self.assertLess(time.monotonic() - since, SANITIZED_SECONDS)

    def test_parameters(self):
        location = self.start("/v1/meshes/square/distance", pair(0, 2))
        for query in ("wait=61", "wait=-1", "wait=", "wait=1.5", "wait=1&wait=2"):
            self.assert_problem(self.daemon.get(f"{location}?{query}"), 400, "invalid_request")
        self.assert_problem(self.daemon.get("/v1/jobs/0123456789abcdef01234567?wait=1"), 404, "not_found")


class Expiry(Jobs):
    flags = ("--job-ttl-s", "1", "--max-jobs", "5", "--memory-budget", "16MiB", "--max-body", "8MiB")

    def test_ended_jobs_expire(self):
        self.daemon.put("square", SQUARE)
        location = self.start("/v1/meshes/square/distance", pair(0, 2))
        self.wait(location, "done")
        time.sleep(1.05)
        self.assert_problem(self.daemon.get(location), 404, "not_found")
        # the memory of its answer is also freed
        wait_until(lambda: b'class="jobs"} 0\n' in self.daemon.get("/metrics").body, 5)

    def test_the_oldest_jobs_are_removed_from_a_full_table(self):
        self.daemon.put("square", SQUARE)
        started = []
        for _ in range(8):
            started.append(self.start("/v1/meshes/square/distance", pair(0, 2)))
            self.wait(started[-1], "done")
        listed = [f"/v1/jobs/{job['id']}" for job in self.daemon.get("/v1/jobs").json["jobs"]]
        self.assertLessEqual(len(listed), 5)
        self.assertEqual(listed, started[-len(listed):])


class Restart(Jobs):
    def test_jobs_do_not_outlive_the_daemon(self):
        with Daemon() as daemon:
            daemon.put("square", SQUARE)
            location = self.start("/v1/meshes/square/distance", pair(0, 2), daemon=daemon)
            self.wait(location, "done", daemon)
        with Daemon() as daemon:
            self.assert_problem(daemon.get(location), 404, "not_found")
            self.assertEqual(daemon.get("/v1/jobs").json, {"jobs": [], "next": None})


class Drain(Jobs):
    flags = ()

    def busy(self, *flags):
        """Starts a daemon with a running job, a waiting job, an open connection, and an event
        stream of the first job."""
        daemon = Daemon("--workers", "1", "--landmarks", "0", *flags)
        daemon.put("big", sample("terrain", cells=256, amplitude=1))
        daemon.ask_often("big", "v:0")
        running = self.start("/v1/meshes/big/distance", pair(0, 60000), daemon=daemon)
        self.wait(running, "running", daemon)
        queued = self.start("/v1/meshes/big/distance", pair(1, 60000), daemon=daemon)
        connection = daemon.connect()
        self.assertEqual(daemon.request("GET", "/livez", connection=connection).status, 200)
        return daemon, running, queued, connection, Watch(daemon, running)

    def test_running_jobs_are_finished_and_waiting_ones_refused(self):
        daemon, running, queued, connection, watch = self.busy("--drain-ms", str(PATIENCE_SECONDS * 1000))
        daemon.terminate()
        events = list(watch.events)
        self.assertNotIn("done", [event for event, _ in events], "too fast to watch")
        watch.close()
        self.assertEqual(daemon.stop(), 0)
        ended = {line["job"]: (line["state"], line.get("code")) for line in daemon.log if line["event"] == "job"}
        self.assertEqual(ended[running.rpartition("/")[2]], ("done", None))
        self.assertEqual(ended[queued.rpartition("/")[2]], ("failed", "draining"))
        connection.close()

    def test_jobs_beyond_the_drain_time_are_cancelled(self):
        daemon, running, _, connection, watch = self.busy("--drain-ms", "10")
        self.assertEqual(daemon.stop(), 0)
        ended = {line["job"]: (line["state"], line.get("code")) for line in daemon.log if line["event"] == "job"}
        self.assertEqual(ended[running.rpartition("/")[2]], ("failed", "draining"))
        watch.close()
        connection.close()

    def test_waiting_clients_are_answered(self):
        daemon, running, queued, connection, watch = self.busy("--drain-ms", str(PATIENCE_SECONDS * 1000))
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            waiting = [pool.submit(daemon.get, location + "?wait=60") for location in (running, queued)]
            time.sleep(0.3)
            since = time.monotonic()
            daemon.terminate()
            for each in waiting:
                self.assertEqual(each.result().status, 200)
        self.assertLess(time.monotonic() - since, PATIENCE_SECONDS)
        watch.close()
        self.assertEqual(daemon.stop(), 0)
        connection.close()

    def test_new_jobs_are_refused_during_a_drain(self):
        daemon, _, _, connection, watch = self.busy()
        daemon.terminate()
        while "draining" not in [line["event"] for line in daemon.log]:
            time.sleep(0.001)
        list(watch.events)  # the stream ends when the daemon begins to refuse jobs
        answer = daemon.request("GET", "/v1/meshes/big/nearest?point=v:0", headers=ASYNC, connection=connection)
        self.assert_problem(answer, 503, "draining")
        watch.close()
        daemon.stop()


class Crowd(Jobs):
    """Runs jobs, cancels and watchers simultaneously, so that sanitizers can detect data races."""

    flags = ("--workers", "2", "--max-jobs", "40", "--job-ttl-s", "1", "--landmarks", "0")

    def test_many_clients_start_read_cancel_and_watch_jobs(self):
        self.daemon.put("ball", sample("icosphere", level=4))
        stop = time.monotonic() + 3
        failures = []

        def client(number):
            try:
                for turn in range(10000):
                    if time.monotonic() > stop:
                        return
                    self.one_turn(number * 10000 + turn)
            except (AssertionError, OSError, http.client.HTTPException, KeyError) as failure:
                failures.append(failure)

        threads = [threading.Thread(target=client, args=(number,)) for number in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        while self.daemon.metric("requests_deferred") or self.daemon.metric("event_streams"):
            time.sleep(0.01)

    def one_turn(self, number):
        source, target = number * 7919 % 2562, number * 104729 % 2562
        answer = self.daemon.request("POST", "/v1/meshes/ball/path", json.dumps(pair(source % 20, target)), {**ASYNC, **JSON})
        self.assertIn(answer.status, (202, 503), answer)
        if answer.status == 503:
            return
        location = answer.headers["Location"]
        if number % 3 == 0:
            watch = Watch(self.daemon, location)
            if number % 2 == 0 and watch.response.status == 200:
                next(watch.events, None)
            watch.close()
        if number % 4 == 0:
            self.assertIn(self.daemon.request("DELETE", location).status, (204, 404))
        self.assertIn(self.daemon.get(location).status, (200, 404))
        self.assertIn(self.daemon.get(location + "/result").status, (200, 404, 409))
        self.assertEqual(self.daemon.get("/v1/jobs?limit=3").status, 200)


if __name__ == "__main__":
    unittest.main()
