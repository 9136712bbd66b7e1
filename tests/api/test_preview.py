"""Tests previews, which are simplified meshes for display. The daemon makes them in idle time and
keeps them."""
import json
import struct
import time

from harness import TETRAHEDRON, Folder, TestCase, sample, wait_until

FACES = 2000


def ply(data):
    """Returns the vertices and faces of a binary PLY file. Supports only the form that the daemon
    writes."""
    head, _, body = data.partition(b"end_header\n")
    counts = {line.split()[1]: int(line.split()[2]) for line in head.decode().splitlines() if line.startswith("element")}
    vertices = [struct.unpack_from("<3d", body, 24 * i) for i in range(counts["vertex"])]
    at = 24 * counts["vertex"]
    faces = [struct.unpack_from("<3I", body, at + 13 * i + 1) for i in range(counts["face"])]
    return vertices, faces


def preview(daemon, name, query=f"faces={FACES}", **headers):
    """Repeats the request until the preview exists; asserts that the reported progress never
    decreases."""
    told = 0
    for _ in range(1200):
        answer = daemon.get(f"/v1/meshes/{name}/preview?{query}", **headers)
        if answer.status != 202:
            return answer
        assert answer.headers["Retry-After"] == "1"
        assert told <= answer.json["progress"] <= 1, (told, answer)
        told = answer.json["progress"]
        time.sleep(0.05)
    raise AssertionError("the preview does not come")


class Preview(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.meshes = cls.put_all({"terrain": sample("terrain", cells=64), "sphere": sample("icosphere", level=5), "small": TETRAHEDRON})

    def test_of_a_large_mesh(self):
        answer = preview(self.daemon, "terrain", f"faces={FACES}&format=ply")
        vertices, faces = ply(answer.body)
        original = {tuple(map(float, line.split()[1:])) for line in
                    self.daemon.get("/v1/meshes/terrain/content?format=obj").body.decode().splitlines() if line.startswith("v ")}
        self.assertLessEqual(set(vertices), original)
        self.assertIn(len(faces), (FACES - 1, FACES))
        self.assertEqual(int(answer.headers["Geodesic-Faces"]), len(faces))
        distance = float(answer.headers["Geodesic-Largest-Distance"])
        self.assertTrue(0 < distance < 0.1, distance)
        derived = self.daemon.ask("terrain", "derive", {"mesh": "thin", "operations": [{"operation": "simplify", "faces": FACES}]}).json
        self.assertEqual(derived["derived_from"]["largest_distance"], distance)

    def test_the_preview_of_a_small_mesh_is_the_mesh(self):
        answer = self.daemon.get("/v1/meshes/small/preview?format=ply")
        self.assertEqual((answer.status, answer.headers["Geodesic-Faces"], answer.headers["Geodesic-Largest-Distance"]), (200, "4", "0"))
        self.assertEqual(answer.body, self.daemon.get("/v1/meshes/small/content?format=ply").body)

    def test_formats_and_tags(self):
        glb = preview(self.daemon, "sphere")
        self.assertEqual((glb.headers["Content-Type"], glb.body[:4]), ("model/gltf-binary", b"glTF"))
        by_accept = preview(self.daemon, "sphere", Accept="application/x-ply")
        self.assertTrue(by_accept.body.startswith(b"ply\n"))
        self.assertNotEqual(glb.headers["ETag"], by_accept.headers["ETag"])
        self.assertEqual(self.daemon.get(f"/v1/meshes/sphere/preview?faces={FACES}", If_None_Match=glb.headers["ETag"]).status, 304)
        other = preview(self.daemon, "sphere", "faces=1000")
        self.assertIn(other.headers["Geodesic-Faces"], ("999", "1000"))
        self.assertNotEqual(other.headers["ETag"], glb.headers["ETag"])

    def test_a_preview_is_counted_and_deleted_with_its_mesh(self):
        self.daemon.put("gone", sample("icosphere", level=5))
        before = self.daemon.metric('memory_bytes{class="previews"}')
        preview(self.daemon, "gone")
        self.assertGreater(self.daemon.metric('memory_bytes{class="previews"}'), before + 12 * FACES)
        self.daemon.request("DELETE", "/v1/meshes/gone")
        wait_until(lambda: self.daemon.metric('memory_bytes{class="previews"}') == before)

    def test_refusals(self):
        for query in ("faces=10", "faces=2000000", "faces=x", "format=obj", "colour=red"):
            self.assert_problem(self.daemon.get(f"/v1/meshes/sphere/preview?{query}"), 400, "invalid_request")
        self.assert_problem(self.daemon.get("/v1/meshes/nowhere/preview"), 404, "not_found")
        self.assert_problem(self.daemon.get("/v1/meshes/small/preview", Accept="text/html"), 406, "not_acceptable")

    def test_a_large_upload_gets_a_preview(self):
        self.daemon.put("large", sample("icosphere", level=7))
        wait_until(lambda: self.daemon.metric("workers_background") == 1)
        self.daemon.request("DELETE", "/v1/meshes/large")
        wait_until(lambda: self.daemon.metric("workers_background") == 0)


class Kept(Folder):
    def test_a_restart_keeps_previews(self):
        with self.start() as daemon:
            daemon.put("sphere", sample("icosphere", level=5))
            before = preview(daemon, "sphere")
        with self.start() as daemon:
            daemon.put("busy", sample("icosphere", level=5))
            began = time.monotonic()
            after = preview(daemon, "sphere")
            self.assertEqual((after.body, after.headers["Geodesic-Largest-Distance"]), (before.body, before.headers["Geodesic-Largest-Distance"]))
            self.assertLess(time.monotonic() - began, 30)
            self.assertEqual(len(list((self.folder / "fields").glob("*/*.preview"))), 1)

    def test_little_memory(self):
        with self.start("--memory-budget", "32M", "--max-body", "4M") as daemon:
            daemon.put("sphere", sample("icosphere", level=5))
            answer = preview(daemon, "sphere")
            self.assertIn(answer.status, (200, 507))
            if answer.status == 507:
                self.assertEqual(answer.json["code"], "insufficient_memory")
