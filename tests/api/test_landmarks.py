"""Tests landmarks. Landmarks do not change answers. The daemon builds them in idle time and keeps
them across restarts. It evicts landmarks if memory is short, and drops them with their mesh."""
import pathlib
import random
import re
import time
import unittest

from harness import PATIENCE_SECONDS, SQUARE, Daemon, Folder, TestCase, sample, wait_until


def rough():
    """Returns a mesh that is rough enough for landmarks to matter."""
    return sample("terrain", cells=64, amplitude=1)


def random_pairs(faces, count, seed):
    chance = random.Random(seed)
    for _ in range(count):
        yield f"from=f:{chance.randrange(faces)}:0.2,0.3,0.5&to=f:{chance.randrange(faces)}:0.6,0.3,0.1"


class Answers(unittest.TestCase):
    FILES = {"terrain": rough(), "ball": sample("icosphere", level=4), "torus": sample("torus")}

    def ask(self, landmarks):
        bodies = []
        with Daemon("--landmarks", str(landmarks)) as daemon:
            for number, (name, file) in enumerate(self.FILES.items()):
                faces = daemon.put(name, file).json["faces"]
                daemon.get(f"/v1/meshes/{name}/distance?from=v:0&to=v:1")
                if landmarks:
                    daemon.wait_for("landmarks_built_total", number + 1)
                for pair in random_pairs(faces, 40, number):
                    answer = daemon.get(f"/v1/meshes/{name}/path?{pair}")
                    self.assertEqual(answer.status, 200, answer)
                    bodies.append(answer.json)
            self.assertEqual(daemon.metric("landmarks_built_total"), len(self.FILES) if landmarks else 0)
            self.assertEqual(daemon.metric("cache_builds_total"), 0)
        return bodies

    def test_answers_are_the_same_with_and_without_landmarks(self):
        without = self.ask(0)
        for count in (1, 16):
            for plain, guided in zip(without, self.ask(count)):
                self.assertAlmostEqual(plain["distance"], guided["distance"], 12)
                self.assertAlmostEqual(guided["path"]["length"], guided["distance"], 12)


    def test_curves_are_the_same_to_the_last_bit(self):
        """Near the farthest point of a curve, the distance is nearly constant along the curve. The
        smallest difference in rounding would therefore move that point."""
        body = {"a": {"points": ["v:0", "v:9", "v:30"], "closed": True}, "b": {"points": ["v:100", "v:90"]}, "measure": "hausdorff"}
        with Daemon("--landmarks", "16") as daemon:
            daemon.put("ball", self.FILES["ball"])
            before = daemon.ask("ball", "curve-distance", body).json
            daemon.get("/v1/meshes/ball/distance?from=v:0&to=v:1")
            daemon.wait_for("landmarks_built_total", 1)
            for _ in range(3):
                self.assertEqual(daemon.ask("ball", "curve-distance", body).json, before)


class Effort(unittest.TestCase):
    def processor_seconds(self, daemon):
        tasks = pathlib.Path(f"/proc/{daemon.process.pid}/task").iterdir()
        return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) / 1e9

    def search(self, landmarks):
        """Returns the number of windows of searches for distant pairs on a mesh of many hills."""
        with Daemon("--landmarks", str(landmarks), "--workers", "1") as daemon:
            faces = daemon.put("rough", sample("terrain", cells=128, amplitude=1)).json["faces"]
            daemon.get("/v1/meshes/rough/distance?from=v:0&to=v:1")
            if landmarks:
                daemon.wait_for("landmarks_built_total")
            connection, before = daemon.connect(), self.processor_seconds(daemon)
            for pair in random_pairs(faces, 60, 5):
                answer = daemon.request("GET", f"/v1/meshes/rough/distance?{pair}", connection=connection)
                self.assertEqual(answer.status, 200, answer)
            connection.close()
            return self.processor_seconds(daemon) - before

    def test_landmarks_shorten_searches(self):
        """With landmarks, searches need about half the windows. The two numbers would be equal if
        searches did not use landmarks."""
        self.assertLess(self.search(16), 0.75 * self.search(0))


class Life(TestCase):
    flags = ("--workers", "1", "--memory-budget", "64MiB", "--max-body", "8MiB")

    def fill(self, name):
        """Builds more fields of the mesh than the memory budget can hold."""
        faces = self.daemon.put(name, rough()).json["faces"]
        for source in range(0, faces, faces // 20):
            point = f"f:{source}:0.2,0.3,0.5"
            self.daemon.ask_often(name, point)
            self.assertEqual(self.daemon.get(f"/v1/meshes/{name}/distance?from={point}&to=v:0").status, 200)
        self.assertGreater(self.daemon.metric("cache_evictions_total"), 0)

    def test_evicted_landmarks_are_rebuilt(self):
        # the pause between two builds for this mesh is short
        faces = self.daemon.put("flat", sample("grid", columns=40, rows=40)).json["faces"]
        self.daemon.get("/v1/meshes/flat/distance?from=v:0&to=v:9")
        self.daemon.wait_for("landmarks_built_total")
        self.assertRegex(self.daemon.get("/metrics").body.decode(), r'memory_bytes\{class="landmarks"\} [1-9]')
        self.fill("crowd")
        self.assertGreater(self.daemon.metric("landmarks_dropped_total"), 0)
        self.daemon.request("DELETE", "/v1/meshes/crowd")
        self.wait_idle()
        self.assertIn('memory_bytes{class="landmarks"} 0\n', self.daemon.get("/metrics").body.decode())
        built, until = self.daemon.metric("landmarks_built_total"), time.monotonic() + PATIENCE_SECONDS
        for pair in random_pairs(faces, 10000, 1):  # the pause delays the next build
            self.assertEqual(self.daemon.get(f"/v1/meshes/flat/distance?{pair}").status, 200)
            if self.daemon.metric("landmarks_built_total") > built:
                break
            self.assertLess(time.monotonic(), until)
            time.sleep(0.01)
        self.assertRegex(self.daemon.get("/metrics").body.decode(), r'memory_bytes\{class="landmarks"\} [1-9]')

    def wait_idle(self):
        wait_until(lambda: self.daemon.metric("workers_background") == 0)

    def test_requests_do_not_wait_for_landmarks(self):
        """Tests a single worker. Landmarks are built on another thread, so the worker stays
        free."""
        self.daemon.put("slow", sample("terrain", cells=128, amplitude=1))
        built = self.daemon.metric("landmarks_built_total")
        self.daemon.get("/v1/meshes/slow/distance?from=v:0&to=v:1")
        self.daemon.wait_for("workers_background")
        self.daemon.put("square", SQUARE)
        for _ in range(50):
            self.assertEqual(self.daemon.get("/v1/meshes/square/distance?from=v:0&to=v:2").status, 200)
        self.assertEqual(self.daemon.metric("landmarks_built_total"), built, "too fast to watch")

    def test_a_mesh_that_is_deleted_during_the_build(self):
        self.daemon.put("gone", sample("terrain", cells=128, amplitude=1))
        built = self.daemon.metric("landmarks_built_total")
        self.daemon.get("/v1/meshes/gone/distance?from=v:0&to=v:1")
        self.daemon.wait_for("workers_background")
        self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/gone").status, 204)
        self.wait_idle()
        self.assertEqual(self.daemon.metric("landmarks_built_total"), built, "they were built all the same")
        self.daemon.wait_for_flight()


class Waiting(TestCase):
    flags = ("--workers", "2")

    def bytes_of_meshes(self):
        text = self.daemon.get("/metrics").body.decode()
        return int(re.search(r'memory_bytes\{class="meshes"\} (\d+)', text)[1])

    def test_queued_landmarks_hold_no_deleted_mesh(self):
        """Queued landmarks are dropped with their mesh, while those of another mesh keep the
        background thread busy."""
        self.daemon.put("slow", sample("terrain", cells=300, amplitude=1))
        self.daemon.get("/v1/meshes/slow/distance?from=v:0&to=v:1")
        self.daemon.wait_for("workers_background")
        before = self.bytes_of_meshes()
        for rows in range(40, 48):
            self.daemon.put("again", sample("grid", columns=60, rows=rows))
            self.daemon.get("/v1/meshes/again/distance?from=v:0&to=v:9")
        self.daemon.request("DELETE", "/v1/meshes/again")
        self.assertEqual(self.bytes_of_meshes(), before)
        self.assertEqual(self.daemon.metric("workers_background"), 1, "too fast to watch")


class Stored(Folder):
    URL = "/v1/meshes/ball/distance?from=v:7&to=p:0,0,-9"

    def files(self):
        return list(self.folder.glob("fields/*/*.landmarks"))

    def build(self):
        with self.start() as daemon:
            daemon.put("ball", sample("icosphere", level=4))
            daemon.get(self.URL)
            daemon.wait_for("landmarks_built_total")

    def assert_they_come(self, built, loaded, *flags):
        with self.start(*flags) as daemon:
            self.assertEqual(daemon.get(self.URL).status, 200)
            daemon.wait_for("landmarks_built_total" if built else "landmarks_loaded_total")
            self.assertEqual(daemon.metric("landmarks_built_total"), built)
            self.assertEqual(daemon.metric("landmarks_loaded_total"), loaded)

    def test_a_restart_keeps_landmarks(self):
        self.build()
        self.assert_they_come(0, 1)
        self.assert_they_come(0, 1, "--persist-fields")
        self.assert_they_come(0, 1)
        self.assertEqual(len(self.files()), 1)

    def test_another_number_of_landmarks_is_built(self):
        self.build()
        self.assert_they_come(1, 0, "--landmarks", "4")
        self.assert_they_come(0, 1, "--landmarks", "4")
        self.assertEqual(len(self.files()), 1)

    def test_a_damaged_file_is_built_again(self):
        self.build()
        for damage in (lambda data: data[:1000], lambda data: b"", lambda data: data[:-1] + b"\1"):
            [file] = self.files()
            file.write_bytes(damage(file.read_bytes()))
            self.assert_they_come(1, 0)
            self.assert_they_come(0, 1)

    def test_the_file_of_landmarks_is_deleted_with_the_mesh(self):
        self.build()
        with self.start() as daemon:
            daemon.put("twin", sample("icosphere", level=4))
            self.assertEqual(daemon.request("DELETE", "/v1/meshes/ball").status, 204)
            self.assertEqual(len(self.files()), 1, "another name has the same mesh")
            daemon.put("twin", SQUARE)
            self.assertEqual(self.files(), [])

    def test_a_stop_does_not_wait_for_landmarks(self):
        with self.start() as daemon:
            daemon.put("slow", sample("terrain", cells=256, amplitude=1))
            daemon.get("/v1/meshes/slow/distance?from=v:0&to=v:1")
            daemon.wait_for("workers_background")
        self.assertEqual(daemon.log[-1]["event"], "stopped")
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    unittest.main()
