"""Sends queries to a proxy from several clients simultaneously. The expected answers are known
beforehand to the last byte."""
import collections
import http.client
import json
import pathlib
import random
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "fault"))

from common import mesh  # noqa: E402

SEARCHES = 16  # number of queries of a source until its field is built


class Questions:
    """Meshes, pairs of points on each mesh, and the answers of one node. Each pair has two answers,
    from a search and from a field, which may differ in the last digit."""

    def __init__(self, meshes, pairs, seed=1):
        """`meshes` maps each name to (file, number of vertices)"""
        self.meshes, self.allowed = meshes, {}
        chance = random.Random(seed)
        for name, (_, count) in meshes.items():
            for _ in range(pairs):
                source, target = chance.randrange(count), chance.randrange(count)
                self.allowed[f"/v1/meshes/{name}/path?from=v:{source}&to=v:{target}&geometry=xyz"] = set()
        self.paths = list(self.allowed)

    def upload(self, daemon):
        for name, (file, _) in self.meshes.items():
            answer = daemon.put(name, file)
            assert answer.status in (200, 201), answer

    def learn(self, daemon):
        """Records the answers of one node before and after its fields are built."""
        for _ in range(SEARCHES + 2):
            for path in self.paths:
                answer = daemon.get(path)
                assert answer.status == 200, answer
                self.allowed[path].add(answer.body)


class Load:
    """Clients that send queries without a pause, each over its own connection, until `stop`."""

    def __init__(self, port, questions, clients=8, pace=0.0):
        self.port, self.questions, self.clients, self.pace = port, questions, clients, pace
        self.answers, self.wrong, self.failed, self.slowest = collections.Counter(), [], [], 0.0
        self.stopped = threading.Event()
        self.threads = [threading.Thread(target=self.run, args=(seed,), daemon=True) for seed in range(clients)]
        for thread in self.threads:
            thread.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def run(self, seed):
        chance, connection = random.Random(seed), None
        while not self.stopped.wait(self.pace):
            connection = connection or http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
            if not self.ask(connection, chance.choice(self.questions.paths)):
                connection.close()
                connection = None

    def ask(self, connection, path):
        """Sends a query; returns whether the connection can be reused."""
        begun = time.monotonic()
        try:
            connection.request("GET", path)
            response = connection.getresponse()
            body = response.read()
        except (http.client.HTTPException, OSError) as error:
            self.failed.append((path, repr(error)))
            return False
        self.slowest = max(self.slowest, time.monotonic() - begun)
        self.answers[response.status, response.headers.get("X-Served-By")] += 1
        if response.status != 200:
            self.failed.append((path, response.status, body[:200]))
        elif body not in self.questions.allowed[path]:
            self.wrong.append((path, body))
        return not response.will_close

    def stop(self):
        self.stopped.set()
        for thread in self.threads:
            thread.join()

    @property
    def count(self):
        return sum(self.answers.values())

    def told(self):
        return f"{self.count} answers, {len(self.failed)} failed, {len(self.wrong)} wrong, the slowest in {1000 * self.slowest:.0f} ms"


class Uploads:
    """A client that stores one mesh after the other until `stop`, each with an edge of a different
    length. Queries each mesh immediately."""

    def __init__(self, port, prefix):
        self.port, self.prefix = port, prefix
        self.stored, self.refused, self.wrong = {}, [], []
        self.stopped = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stopped.set()
        self.thread.join()

    def ask(self, method, path, body=None):
        """Returns the status and the body. The status 0 means that the connection broke."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.request(method, path, body)
            response = connection.getresponse()
            return response.status, response.read()
        except (http.client.HTTPException, OSError) as error:
            return 0, repr(error)
        finally:
            connection.close()

    def run(self):
        number = 0
        while not self.stopped.is_set():
            number += 1
            name, edge = f"{self.prefix}{number}", 1 + number / 1024
            status, body = self.ask("PUT", f"/v1/meshes/{name}", mesh(edge))
            if status != 201:
                self.refused.append((name, status, body[:120]))
                continue
            self.stored[name] = edge
            self.verify(name, may_be_refused=True)

    def verify(self, name, may_be_refused=False):
        """Verifies the mesh. `may_be_refused` permits a refusal, because the mesh's node may have
        lost the store meanwhile."""
        status, body = self.ask("GET", f"/v1/meshes/{name}/distance?from=v:0&to=v:1")
        if may_be_refused and status == 503:
            return
        if status != 200 or json.loads(body)["distance"] != self.stored[name]:
            self.wrong.append((name, status, body[:120]))

    def verify_all(self):
        for name in self.stored:
            self.verify(name)
        return self

    def told(self):
        return f"{len(self.stored)} acknowledged, {len(self.refused)} refused, {len(self.wrong)} wrong" + "".join(f"; {item}" for item in (self.refused + self.wrong)[:2])
