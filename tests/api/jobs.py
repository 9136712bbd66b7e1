"""Helpers of the tests of jobs. They start, await, cancel and watch jobs. `OneWorker` has a daemon
with one worker, and a mesh that keeps the worker busy."""
import json
import time

from harness import PATIENCE_SECONDS, SQUARE, TestCase, sample, wait_until

ASYNC = {"Prefer": "respond-async"}
JSON = {"Content-Type": "application/json"}
SANITIZED_SECONDS = 2  # an answer within this time counts as immediate under sanitizers


def big_mesh():
    """Returns a mesh on which one field takes seconds."""
    return sample("terrain", cells=400, amplitude=1)


def pair(source, target):
    return {"from": {"vertex": source}, "to": {"vertex": target}}


class Jobs(TestCase):
    """Helpers of tests about jobs."""

    def start(self, path, document=None, method="POST", daemon=None, **headers):
        """Starts a job; returns its location."""
        body = None if document is None else json.dumps(document)
        kind = JSON if document is not None else {}
        answer = (daemon or self.daemon).request(method, path, body, {**ASYNC, **kind, **headers})
        self.assertEqual(answer.status, 202, answer)
        self.assertEqual(answer.headers["Preference-Applied"], "respond-async")
        location = answer.headers["Location"]
        self.assertEqual(location, f"/v1/jobs/{answer.json['id']}")
        return location

    def start_field(self, source, name="big", daemon=None):
        """Starts the slowest job: the query for which the daemon builds the field of a source."""
        (daemon or self.daemon).ask_often(name, f"v:{source}")
        return self.start(f"/v1/meshes/{name}/distance", pair(source, 160000 - source), daemon=daemon)

    def wait(self, location, state, daemon=None):
        until = time.monotonic() + PATIENCE_SECONDS
        while (job := (daemon or self.daemon).get(location).json)["state"] != state:
            self.assertLess(time.monotonic(), until, job)
            self.assertIn(job["state"], ("queued", "running"), job)
            time.sleep(0.002)
        return job

    def cancel(self, location):
        answer = self.daemon.request("DELETE", location)
        self.assertEqual((answer.status, answer.body), (204, b""))


class OneWorker(Jobs):
    """Runs long jobs on the only worker."""

    flags = ("--workers", "1", "--queue-length", "2", "--landmarks", "0")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        assert cls.daemon.put("big", big_mesh()).status == 201
        assert cls.daemon.put("square", SQUARE).status == 201

    def tearDown(self):
        self.wait_until_idle()
        for job in self.daemon.get("/v1/jobs").json["jobs"]:
            self.daemon.request("DELETE", f"/v1/jobs/{job['id']}")

    def wait_until_idle(self):
        wait_until(lambda: self.daemon.metric("requests_deferred") == 0)


def events_of(response):
    """Yields (event, data) of each message of a stream when the message arrives. Skips comments."""
    event = data = None
    for line in response:
        line = line.decode().rstrip("\n")
        if line.startswith("event: "):
            event = line[7:]
        elif line.startswith("data: "):
            data = json.loads(line[6:])
        elif not line and data is not None:
            yield event, data
            event = data = None


class Watch:
    """An open stream of a job's events."""

    def __init__(self, daemon, location):
        self.connection = daemon.connect()
        self.connection.request("GET", location + "/events")
        self.response = self.connection.getresponse()
        self.events = events_of(self.response)

    def close(self):
        self.response.close()
        self.connection.close()
