"""Tests the rights of keys. Each role tries each operation of the contract: on data of another key
of the tenant, on data of another tenant, and on data of its own key."""
import json
import unittest

import contract
from contract_scene import FIELD, JSON, Scene, send
from harness import sample, wait_until
from test_access import Keyed, bearer, digest, key_of, line

READERS = ("reader", "watch")  # these keys may only read; all other keys of the tenant may write
KEYS = (line("writer", "role=write") + line("second", "role=write") + line("reader") + line("watch", "role=operator")
        + f"stranger sha256:{digest(key_of('stranger'))} role=write\n")


class Roles(Keyed):
    keys = KEYS
    flags = ("--workers", "2")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.contract = contract.load()
        cls.scene = Scene(cls.daemon, cls.contract, **bearer("writer"))

    def as_key(self, ask, name):
        return send(self.daemon, ask._replace(headers={**ask.headers, **bearer(name)}))

    def listed(self, path, member, *members):
        page = self.ask("GET", f"{path}?limit=1000", "writer").json
        return {item["name" if "name" in item else "id"]: tuple(item.get(each) for each in members) for item in page[member]}

    def possessions(self):
        """Returns the data of the tenant, except the fields and jobs of the key itself."""
        surfaces = {kind: self.listed(f"/v1/{kind}", kind, "etag") for kind in ("meshes", "nurbs", "subdivisions")}
        field = self.ask("GET", f"/v1/meshes/tetrahedron/fields/{self.scene.field}", "writer").status
        job = self.ask("GET", f"/v1/jobs/{self.scene.job}", "writer")
        return surfaces, field, (job.status, job.json.get("state")), self.listed("/v1/batches", "batches", "state", "done")

    def own_operations(self):
        """Returns the published operations with their required roles."""
        published = self.ask("GET", "/openapi.json").json["paths"]
        for operation in self.contract.operations:
            yield operation, published[operation.path][operation.method]["security"]

    def forms(self, operation):
        """Yields the operation's documented requests, immediate and as jobs."""
        for ask in self.scene.asks(operation):
            yield ask
            if "202" in operation.responses:
                yield ask.plus(Prefer="respond-async")

    def test_a_read_key_cannot_change_data_of_other_keys(self):
        refused = 0
        for operation, security in self.own_operations():
            is_change = bool(security) and security[0]["key"] == ["write"] or operation.name == "delete_job"
            self.scene.fill()
            before = self.possessions()
            for name in READERS:
                for ask in self.forms(operation):
                    with self.subTest(operation=operation.name, role=name, headers=ask.headers):
                        answer = self.as_key(ask, name)
                        if is_change:
                            self.assert_problem(answer, 403, "forbidden")
                            refused += 1
                        else:
                            self.assertIn(answer.status, (200, 202, 201, 304), answer)
                        self.assertEqual(self.possessions(), before)
        self.assertGreater(refused, 2 * 15)

    def test_a_stranger_changes_nothing(self):
        """Tests a key of another tenant with the right to write. Its uploads belong to its own
        tenant."""
        for operation, security in self.own_operations():
            if not security or operation.method == "get":
                continue
            self.scene.fill()
            before = self.possessions()
            with self.subTest(operation=operation.name):
                self.as_key(self.scene.ask(operation), "stranger")
                self.assertEqual(self.possessions(), before)

    def test_jobs_by_role_and_owner(self):
        """Tests the status of DELETE for jobs that have ended and for jobs that have not."""
        self.ask("PUT", "/v1/meshes/terrain", "writer", sample("terrain", cells=200, amplitude=1))
        all_pairs = json.dumps({"sources": [{"vertex": 7 * i} for i in range(500)], "targets": [{"vertex": 3}]})
        for owner in ("writer", "reader", "watch"):
            for name in ("reader", "watch", "second", "stranger", "writer"):
                for path, body in (("/v1/meshes/terrain/matrix", all_pairs), ("/v1/meshes/terrain/distance", '{"from": {"vertex": 0}, "to": {"vertex": 2}}')):
                    with self.subTest(owner=owner, role=name, path=path):
                        self.check_delete(path, body, owner, name)
        self.ask("DELETE", "/v1/meshes/terrain", "writer")

    def check_delete(self, path, body, owner, name):
        job = self.ask("POST", path, owner, body, Prefer="respond-async").headers["Location"]
        is_long = path.endswith("matrix")
        ended = ("done", "failed", "cancelled")
        if not is_long:
            wait_until(lambda: self.ask("GET", job, owner).json["state"] in ended)
        asked = 204 if name == owner or name in ("writer", "second") else 404 if name == "stranger" else 403
        self.assertEqual(self.ask("DELETE", job, name).status, asked)
        found = self.ask("GET", job, owner)
        if asked == 204:
            self.assertEqual((found.status, found.json.get("state")), (200, "cancelled") if is_long else (404, None))
        else:
            self.assertEqual(found.status, 200)
            self.assertNotEqual(found.json["state"], "cancelled")
            self.assertEqual(self.ask("DELETE", job, owner).status, 204)

    def test_a_field_is_removed_by_writers_only(self):
        self.ask("PUT", "/v1/meshes/square", "writer", sample("grid", columns=4, rows=4))
        for owner in ("writer", "reader"):
            for name, asked in (("reader", 403), ("watch", 403), ("stranger", 404), ("second", 204)):
                field = self.ask("POST", "/v1/meshes/square/fields", owner, FIELD, **JSON).json["id"]
                self.assertEqual(self.ask("DELETE", f"/v1/meshes/square/fields/{field}", name).status, asked, (owner, name))

    def test_fields_of_a_read_key_do_not_remove_those_of_a_write_key(self):
        self.ask("PUT", "/v1/meshes/grid", "writer", sample("grid", columns=40, rows=40))
        written = self.ask("POST", "/v1/meshes/grid/fields", "writer", FIELD, **JSON).json["id"]
        first = None
        for vertex in range(1, 1027):
            body = json.dumps({"set": {"points": [{"vertex": vertex}]}, "max_distance": 0.01})
            answer = self.ask("POST", "/v1/meshes/grid/fields", "reader", body, **JSON)
            self.assertEqual(answer.status, 201, answer)
            first = first or answer.json["id"]
        self.assertEqual(self.ask("GET", f"/v1/meshes/grid/fields/{first}", "reader").status, 410)
        self.assertEqual(self.ask("GET", f"/v1/meshes/grid/fields/{written}", "writer").status, 200)


if __name__ == "__main__":
    unittest.main()
