"""Tests the short text that describes a surface. The client sets it at the upload and changes it by
PATCH; the store keeps it."""
import json
import shutil
import signal

from harness import SQUARE, TETRAHEDRON, TestCase, sample
from nurbs import SADDLE
from stored import Stored

TEXT = "Scan of the left hand – número 7 ✋"
QUOTED = "Scan%20of%20the%20left%20hand%20%E2%80%93%20n%C3%BAmero%207%20%E2%9C%8B"


def change(daemon, text, path="/v1/meshes/m", **headers):
    body = {} if text is ... else {"description": text}
    headers = {"Content-Type": "application/json", **{name.replace("_", "-"): value for name, value in headers.items()}}
    return daemon.request("PATCH", path, json.dumps(body), headers)


class Descriptions(TestCase):
    def setUp(self):
        self.daemon.request("DELETE", "/v1/meshes/m")

    def test_an_upload_sets_keeps_and_removes_the_text(self):
        self.assertNotIn("description", self.daemon.put("m", SQUARE).json)
        self.assertEqual(self.daemon.put("m", SQUARE, f"?description={QUOTED}").json["description"], TEXT)
        for body in (SQUARE, TETRAHEDRON):
            self.assertEqual(self.daemon.put("m", body).json["description"], TEXT)
        listed = self.daemon.get("/v1/meshes?prefix=m").json["meshes"]
        self.assertEqual([mesh["description"] for mesh in listed], [TEXT])
        self.assertNotIn("description", self.daemon.put("m", TETRAHEDRON, "?description=").json)
        self.assertEqual(self.daemon.put("n", SQUARE, "?description=new&weld=0").json["description"], "new")

    def test_every_kind_has_a_description(self):
        cube = {"points": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]}
        for kind, document in (("nurbs", SADDLE), ("subdivisions", cube)):
            path = f"/v1/{kind}/one"
            made = self.daemon.request("PUT", f"{path}?description=first", json.dumps(document), {"Content-Type": "application/json"})
            self.assertEqual((made.status, made.json["description"]), (201, "first"), made)
            self.assertEqual(change(self.daemon, "second", path).json["description"], "second")
            self.assertEqual(self.daemon.get(f"/v1/{kind}").json[kind][0]["description"], "second")

    def test_a_change_keeps_fields_and_etags(self):
        first = self.daemon.put("m", sample("torus"), "?description=a")
        field = self.daemon.ask("m", "fields", {"set": {"points": [{"vertex": 0}]}}).json["id"]
        answer = change(self.daemon, "b")
        self.assertEqual((answer.status, answer.json["description"], answer.json["etag"]), (200, "b", first.json["etag"]))
        self.assertNotEqual(answer.headers["ETag"], first.headers["ETag"])
        self.assertEqual(self.daemon.get(f"/v1/meshes/m/fields/{field}").status, 200)
        distance = self.daemon.get("/v1/meshes/m/distance?from=v:0&to=v:9", If_Match=first.headers["ETag"])
        self.assertEqual(distance.status, 200)
        self.assertNotIn("description", change(self.daemon, None).json)
        self.assertEqual(change(self.daemon, ...).status, 200)

    def test_conditions_know_the_text(self):
        etag = self.daemon.put("m", SQUARE).headers["ETag"]
        first = change(self.daemon, "first", If_Match=etag).headers["ETag"]
        self.assertEqual(self.daemon.get("/v1/meshes/m", If_None_Match=etag).status, 200)
        self.assertEqual(self.daemon.get("/v1/meshes/m", If_None_Match=first).status, 304)
        second = change(self.daemon, "second", If_Match=first).headers["ETag"]
        self.assert_problem(change(self.daemon, "third", If_Match=first), 412, "precondition_failed")
        self.assert_problem(self.daemon.request("DELETE", "/v1/meshes/m", headers={"If-Match": first}), 412, "precondition_failed")
        self.assert_problem(change(self.daemon, "third", If_None_Match="*"), 412, "precondition_failed")
        self.assertEqual(change(self.daemon, "third", If_Match=f'"x", {second}').status, 200)
        self.assertEqual(change(self.daemon, "third", If_Match=etag).status, 200)
        self.assert_problem(self.daemon.put("m", SQUARE, "?description=fourth", If_Match=second), 412, "precondition_failed")
        bare = change(self.daemon, "").headers["ETag"]
        self.assertEqual(bare, etag)
        self.assert_problem(change(self.daemon, "fifth", If_Match=second), 412, "precondition_failed")

    def test_invalid_descriptions(self):
        self.daemon.put("m", SQUARE)
        for text in ("a\nb", "\x7f", "x" * 201, "\u20ac" * 201, 7, ["a"]):
            answer = change(self.daemon, text)
            self.assert_problem(answer, 400, "invalid_request")
            self.assertEqual(answer.json["pointer"], "/description")
        self.assertEqual(change(self.daemon, "\u20ac" * 200).status, 200)
        for text in ("a%0Ab", "%ff", "x" * 201):
            answer = self.daemon.put("m", SQUARE, f"?description={text}")
            self.assert_problem(answer, 400, "invalid_request")
            self.assertEqual(answer.json["parameter"], "description")
        other = self.daemon.request("PATCH", "/v1/meshes/m", '{"name": "n"}', {"Content-Type": "application/json"})
        self.assert_problem(other, 400, "invalid_request")
        self.assert_problem(change(self.daemon, "a", "/v1/meshes/nobody"), 404, "not_found")
        self.assert_problem(self.daemon.request("PATCH", "/v1/meshes/m", "{}", {"Content-Type": "text/plain"}), 415, "unsupported_media_type")


class Kept(Stored):
    def texts(self, daemon):
        return {mesh["name"]: mesh.get("description") for mesh in daemon.get("/v1/meshes").json["meshes"]}

    def test_kills_backup_and_damage(self):
        expected = {"m": "changed", "n": TEXT, "o": None}
        with self.start() as daemon:
            daemon.put("m", SQUARE, "?description=first")
            daemon.put("n", SQUARE, f"?description={QUOTED}")
            daemon.put("o", TETRAHEDRON, "?description=gone")
            change(daemon, "changed")
            change(daemon, None, "/v1/meshes/o")
            daemon.process.send_signal(signal.SIGKILL)
            daemon.process.wait()
        with self.start() as daemon:
            self.assertEqual(self.texts(daemon), expected)
            self.assertEqual(daemon.get("/v1/meshes/m/distance?from=v:0&to=v:2").status, 200)
            self.assertEqual(self.texts(daemon), expected)
        self.assertEqual(self.tool("--check-store").returncode, 0)
        copy, restored = f"{self.folder}.copy", f"{self.folder}.restored"
        self.addCleanup(shutil.rmtree, copy, True)
        self.addCleanup(shutil.rmtree, restored, True)
        self.assertEqual(self.tool("--backup", copy).returncode, 0)
        self.assertEqual(self.tool("--restore", copy, folder=restored).returncode, 0)
        for name in list(self.folder.glob("geodesicd.db*")):
            name.unlink()
        with self.start() as daemon:
            self.assertEqual(self.texts(daemon), expected)
        shutil.rmtree(self.folder)
        shutil.move(restored, self.folder)
        with self.start() as daemon:
            self.assertEqual(self.texts(daemon), expected)
