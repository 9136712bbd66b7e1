"""Questions asked of a front by several clients at once, whose answers are known beforehand, to the last byte."""
import collections
import http.client
import random
import threading
import time

SEARCHES = 16  # a source that is asked about so often gets its field


class Questions:
    """Meshes, pairs of points on each, and what one node says of them: of a pair that is searched, and of the same from a field, which may differ in the
    last digit."""

    def __init__(self, meshes, pairs, seed=1):
        """`meshes`: name -> (file, number of vertices)."""
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
        """What one node answers at first, and after its fields have been built."""
        for _ in range(SEARCHES + 2):
            for path in self.paths:
                answer = daemon.get(path)
                assert answer.status == 200, answer
                self.allowed[path].add(answer.body)


class Load:
    """Clients that ask without a pause, each over a connection of its own, until `stop`."""

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
        """Whether the connection can be used again."""
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
