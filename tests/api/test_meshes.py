"""Tests the resource /v1/meshes: create, replace, list, describe, download, remove."""
import gzip
import hashlib
import json
import math
import re
import socket
import unittest

from harness import SQUARE, TETRAHEDRON, TestCase, sample
from nurbs import TORUS

FORMATS = ("obj", "ply", "off", "stl", "glb", "gltf")
IN_FLOATS = ("stl", "glb", "gltf")


class Put(TestCase):
    def test_the_answer_describes_the_mesh(self):
        answer = self.daemon.put("created", TETRAHEDRON)
        self.assertEqual(answer.status, 201)
        mesh = answer.json
        self.assertEqual(mesh["sha256"], hashlib.sha256(TETRAHEDRON).hexdigest())
        self.assertEqual((mesh["vertices"], mesh["faces"], mesh["edges"], mesh["components"]), (4, 4, 6, 1))
        self.assertEqual((mesh["genus"], mesh["euler_characteristic"], mesh["boundaries"]), (0, 2, []))
        self.assertRegex(mesh["created"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertEqual(answer.headers["ETag"], f'"{mesh["etag"]}"')
        self.assertEqual(answer.headers["Location"], "/v1/meshes/created")

    def test_the_same_bytes_again_change_nothing(self):
        first = self.daemon.put("same", SQUARE)
        self.daemon.ask_often("same", "v:0")
        self.daemon.get("/v1/meshes/same/distance?from=v:0&to=v:2")
        again = self.daemon.put("same", SQUARE)
        self.assertEqual((first.status, again.status), (201, 200))
        self.assertEqual(again.json["fields_cached"], 1)
        self.assertEqual(again.json["created"], first.json["created"])

    def test_other_bytes_replace_and_end_the_fields(self):
        self.daemon.put("replaced", SQUARE)
        self.daemon.ask_often("replaced", "v:0")
        self.daemon.get("/v1/meshes/replaced/distance?from=v:0&to=v:2")
        self.assertEqual(self.daemon.get("/v1/meshes/replaced").json["fields_cached"], 1)
        answer = self.daemon.put("replaced", TETRAHEDRON)
        self.assertEqual((answer.status, answer.json["faces"], answer.json["fields_cached"]), (200, 4, 0))

    def test_other_options_rebuild(self):
        first = self.daemon.put("options", SQUARE)
        second = self.daemon.put("options", SQUARE, "?triangulate=false")
        self.assertEqual(second.status, 200)
        self.assertNotEqual(first.headers["ETag"], second.headers["ETag"])

    def test_a_file_in_chunks(self):
        chunks = (SQUARE[i : i + 7] for i in range(0, len(SQUARE), 7))
        self.assertEqual(self.daemon.put("chunked", chunks).status, 201)

    def test_polygons_are_triangulated_or_refused(self):
        quad = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
        self.assertEqual(self.daemon.put("quad", quad).json["faces"], 2)
        answer = self.daemon.put("refused", quad, "?triangulate=false")
        self.assertEqual(self.assert_problem(answer, 422, "invalid_mesh")["reason"], "not_triangles")

    def test_a_failed_upload_leaves_the_old_mesh(self):
        self.daemon.put("kept", SQUARE)
        self.assertEqual(self.daemon.put("kept", b"v 0 0 0\nf 1 2 3\n").status, 422)
        self.assertEqual(self.daemon.get("/v1/meshes/kept").json["faces"], 2)

    def test_preconditions(self):
        etag = self.daemon.put("guarded", SQUARE).headers["ETag"]
        self.assert_problem(self.daemon.put("guarded", TETRAHEDRON, If_None_Match="*"), 412, "precondition_failed")
        self.assert_problem(self.daemon.put("guarded", TETRAHEDRON, If_Match='"other"'), 412, "precondition_failed")
        self.assert_problem(self.daemon.put("absent", SQUARE, If_Match="*"), 412, "precondition_failed")
        self.assertEqual(self.daemon.put("guarded", TETRAHEDRON, If_Match=etag).status, 200)
        self.assertEqual(self.daemon.put("fresh", SQUARE, If_None_Match="*").status, 201)

    def test_create_only_with_blanks_around_the_star(self):
        self.daemon.put("once", SQUARE)
        for star in ("* ", "*\t", "*  \t"):
            self.assert_problem(self.daemon.put("once", TETRAHEDRON, If_None_Match=star), 412, "precondition_failed")

    def test_preconditions_in_several_lines(self):
        etag = self.daemon.put("lines", SQUARE).headers["ETag"]

        def put(*lines):
            head = "\r\n".join(["PUT /v1/meshes/lines HTTP/1.1", "Host: localhost", f"Content-Length: {len(TETRAHEDRON)}",
                                "Connection: close", *lines, "\r\n"])
            return self.daemon.raw(head.encode() + TETRAHEDRON)[:13]

        self.assertEqual(put('If-None-Match: "x"', f"If-None-Match: {etag}"), b"HTTP/1.1 412 ")
        self.assertEqual(put('If-Match: "x"', 'If-Match: "y"'), b"HTTP/1.1 412 ")
        self.assertEqual(put('If-Match: "x"', f"If-Match: {etag}"), b"HTTP/1.1 200 ")

    def test_expect_continue(self):
        fields = ["Host: localhost", f"Content-Length: {len(SQUARE)}", "Expect: 100-continue", "Connection: close"]
        head = "\r\n".join(["PUT /v1/meshes/expect HTTP/1.1", *fields, "\r\n"])
        with socket.create_connection(("127.0.0.1", self.daemon.port), timeout=20) as connection:
            connection.sendall(head.encode())
            self.assertTrue(connection.recv(4096).startswith(b"HTTP/1.1 100 "))
            connection.sendall(SQUARE)
            self.assertTrue(connection.recv(4096).startswith(b"HTTP/1.1 201 "))


class Repair(TestCase):
    """Tests repairs that need more memory than the uploaded mesh, while the whole budget is
    free."""

    def assert_mended(self, file, options, faces, copies):
        answer = self.daemon.put("mended", file.encode(), options)
        self.assertIn(answer.status, (200, 201), answer)
        self.assertEqual((answer.json["faces"], answer.json["index_count"] - file.count("v ")), (faces, copies))
        self.daemon.wait_for_flight()

    def test_small_meshes_with_defects(self):
        bow_tie = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n"
        crowded = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv -1 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"
        self.assert_mended(bow_tie, "?repair=split", 2, 1)
        self.assert_mended(crowded, "?repair=split", 3, 4)

    def test_three_thousand_faces_at_an_edge(self):
        angles = [6 * page / 3000 for page in range(3000)]
        pages = [f"v {math.cos(angle)} {math.sin(angle)} 0\nf 1 2 {page + 3}\n" for page, angle in enumerate(angles)]
        self.assert_mended("v 0 0 0\nv 0 0 1\n" + "".join(pages), "?repair=split", 3000, 2 * 2999)

    def test_a_welded_soup(self):
        corners = [f"v 0 0 0\nv {i % 97} 1 0\nv {i // 97} 0 1\n" for i in range(9000)]
        faces = [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n" for i in range(9000)]
        self.assert_mended("".join(corners + faces), "?weld=0&repair=split", 9000, 3 * 9000 - 1 - 97 - 93)


class Post(TestCase):
    def test_the_name_comes_from_the_content(self):
        first = self.daemon.request("POST", "/v1/meshes", TETRAHEDRON)
        again = self.daemon.request("POST", "/v1/meshes", TETRAHEDRON)
        self.assertEqual((first.status, again.status), (201, 200))
        self.assertTrue(hashlib.sha256(TETRAHEDRON).hexdigest().startswith(first.json["name"]))
        self.assertEqual(self.daemon.get(first.headers["Location"]).json["name"], first.json["name"])

    def test_json(self):
        mesh = {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "faces": [[0, 1, 2, 3]]}
        answer = self.daemon.request("POST", "/v1/meshes", json.dumps(mesh), {"Content-Type": "application/json"})
        self.assertEqual((answer.status, answer.json["faces"], answer.json["area"]), (201, 2, 1))


class Read(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name in ("a", "b", "c", "d", "e"):
            cls.daemon.put(name, SQUARE)

    def test_describe(self):
        answer = self.daemon.get("/v1/meshes/c")
        self.assertEqual((answer.status, answer.json["name"]), (200, "c"))
        self.assertEqual(answer.json["boundaries"], [{"vertices": 4, "length": 4}])

    def test_head_is_get_without_the_body(self):
        get, head = self.daemon.get("/v1/meshes/c"), self.daemon.request("HEAD", "/v1/meshes/c")
        self.assertEqual((head.status, head.body), (200, b""))
        self.assertEqual(head.headers["Content-Length"], get.headers["Content-Length"])
        self.assertEqual(head.headers["ETag"], get.headers["ETag"])

    def test_not_modified(self):
        etag = self.daemon.get("/v1/meshes/c").headers["ETag"]
        answer = self.daemon.get("/v1/meshes/c", If_None_Match=f'"other", {etag}')
        self.assertEqual((answer.status, answer.body, answer.headers["ETag"]), (304, b"", etag))

    def test_not_modified_of_several_lines(self):
        for path in ("/v1/meshes/c", "/v1/meshes/c/content"):
            etag = self.daemon.get(path).headers["ETag"]
            head = f'GET {path} HTTP/1.1\r\nHost: localhost\r\nIf-None-Match: "x"\r\nIf-None-Match: {etag}\r\n'
            self.assertEqual(self.daemon.raw(f"{head}Connection: close\r\n\r\n".encode())[:13], b"HTTP/1.1 304 ")

    def test_list_by_pages(self):
        names, after = [], ""
        while after is not None:
            page = self.daemon.get(f"/v1/meshes?limit=2{after}").json
            names += [mesh["name"] for mesh in page["meshes"]]
            after = page["next"] and f"&after={page['next']}"
        self.assertEqual(names, ["a", "b", "c", "d", "e"])

    def test_list_after_a_name_that_does_not_exist(self):
        names = [mesh["name"] for mesh in self.daemon.get("/v1/meshes?after=bb").json["meshes"]]
        self.assertEqual(names, ["c", "d", "e"])

    def test_list_by_prefix(self):
        """Lists surfaces of each kind, at once and by pages."""
        for kind, file in (("meshes", TETRAHEDRON), ("subdivisions", TETRAHEDRON), ("nurbs", json.dumps(TORUS).encode())):
            for name in ("x-1", "x-2", "x-3", "xy", "y"):
                self.assertEqual(self.daemon.request("PUT", f"/v1/{kind}/{name}", file, {"Content-Type": "application/octet-stream"}).status, 201)
            for query, expected in (("prefix=x-", ["x-1", "x-2", "x-3"]), ("prefix=x-&after=x-1", ["x-2", "x-3"]), ("prefix=x-2", ["x-2"]),
                                    ("prefix=x-4", []), ("prefix=x&after=c", ["x-1", "x-2", "x-3", "xy"])):
                page = self.daemon.get(f"/v1/{kind}?{query}").json
                self.assertEqual(([each["name"] for each in page[kind]], page["next"]), (expected, None), query)
            page = self.daemon.get(f"/v1/{kind}?prefix=x-&limit=2").json
            self.assertEqual(([each["name"] for each in page[kind]], page["next"]), (["x-1", "x-2"], "x-2"))
            for name in ("x-1", "x-2", "x-3", "xy", "y"):
                self.daemon.request("DELETE", f"/v1/{kind}/{name}")

    def test_unknown_and_odd_names(self):
        for name in ("nobody", "a/b", "%61b"):
            self.assert_problem(self.daemon.get(f"/v1/meshes/{name}"), 404, "not_found")
        self.assertEqual(self.daemon.get("/v1/meshes/%61").json["name"], "a")


class Content(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.file = sample("torus", columns=12, rows=7)
        cls.mesh = cls.daemon.put("torus", cls.file).json

    def test_every_format_comes_back_as_the_same_mesh(self):
        for name in FORMATS:
            answer = self.daemon.get(f"/v1/meshes/torus/content?format={name}")
            self.assertEqual(answer.status, 200, answer)
            again = self.daemon.put(f"again-{name}", answer.body).json
            for key in ("vertices", "faces", "edges", "genus"):
                self.assertEqual(again[key], self.mesh[key], (name, key))
            self.assertAlmostEqual(again["area"], self.mesh["area"], 5 if name in IN_FLOATS else 12)

    def test_doubles_are_kept(self):
        answer = self.daemon.get("/v1/meshes/torus/content?format=obj")
        numbers = re.compile(rb"^v (\S+) (\S+) (\S+)$", re.M)
        sent = [tuple(map(float, match)) for match in numbers.findall(self.file)]
        self.assertEqual([tuple(map(float, match)) for match in numbers.findall(answer.body)], sent)

    def test_formats_with_floats_refuse_sizes_beyond_floats(self):
        for size in (b"1e100", b"1e-100"):
            self.daemon.put("far", SQUARE.replace(b"1", size, 3).replace(b"0 1 0", b"0 %b 0" % size))
            for path in ("content?format=stl", "content?format=glb", "preview?format=glb", "path?from=v:0&to=v:1&format=glb"):
                problem = self.assert_problem(self.daemon.get(f"/v1/meshes/far/{path}"), 406, "not_acceptable")
                self.assertIn("floats", problem["detail"])
            self.assertEqual(self.daemon.get("/v1/meshes/far/content?format=off").status, 200)

    def test_reversed_and_removed_faces(self):
        """Tests the statements of the contract and of the guide."""
        turned = SQUARE.replace(b"f 1 3 4", b"f 3 1 4")
        self.assertEqual(self.daemon.put("turned", turned).json["orientation"]["flipped_faces"], 1)
        self.assertEqual(re.findall(rb"^f .*$", self.daemon.get("/v1/meshes/turned/content").body, re.M), [b"f 1 2 3", b"f 3 4 1"])
        place = self.daemon.get("/v1/meshes/turned/nearest?point=f:1:0.5,0.25,0.25&select=xyz").json["xyz"]
        # the corners in the order of the upload: (1, 1), (0, 0), (0, 1)
        self.assertEqual(place, [0.5, 0.75, 0])
        doubled = SQUARE.replace(b"f 1 3 4", b"f 1 2 3\nf 1 3 4")
        self.assertEqual(self.daemon.put("doubled", doubled, "?repair=split").json["repair"]["duplicate_faces"], 1)
        self.assertEqual(re.findall(rb"^f .*$", self.daemon.get("/v1/meshes/doubled/content").body, re.M), [b"f 1 2 3", b"f 1 3 4"])
        self.assertEqual(self.daemon.get("/v1/meshes/doubled/nearest?point=f:1:1,0,0").status, 400)
        self.assertEqual(self.daemon.get("/v1/meshes/doubled/nearest?point=f:2:1,0,0").status, 200)

    def test_format_by_accept(self):
        answer = self.daemon.get("/v1/meshes/torus/content", Accept="application/x-ply, model/obj;q=0.5")
        self.assertEqual(answer.headers["Content-Type"], "application/x-ply")
        self.assertEqual(answer.headers["Content-Disposition"], 'attachment; filename="torus.ply"')
        self.assert_problem(self.daemon.get("/v1/meshes/torus/content", Accept="text/html"), 406, "not_acceptable")

    def test_accept_in_several_lines(self):
        lines = (("Accept", "text/html"), ("accept", "model/obj;q=0.1"), ("Accept-Encoding", "br"), ("Accept", "application/x-ply"),
                 ("Accept-Encoding", "gzip"))
        connection = self.daemon.connect()
        self.addCleanup(connection.close)
        connection.putrequest("GET", "/v1/meshes/torus/content", skip_accept_encoding=True)
        for line in lines:
            connection.putheader(*line)
        connection.endheaders()
        answer = connection.getresponse()
        self.assertEqual((answer.status, answer.headers["Content-Type"], answer.headers["Content-Encoding"]), (200, "application/x-ply", "gzip"))

    def test_compressed_answers_have_separate_tags(self):
        """Different bytes never have the same strong tag, but both tags identify the mesh."""
        path = "/v1/meshes/torus/content"
        plain, packed = self.daemon.get(path), self.daemon.get(path, Accept_Encoding="gzip")
        self.assertEqual(packed.headers["ETag"], plain.headers["ETag"][:-1] + '-gzip"')
        for answer in (plain, packed):
            tag = answer.headers["ETag"]
            known = self.daemon.get(path, If_None_Match=tag, Accept_Encoding="gzip")
            self.assertEqual((known.status, known.headers["ETag"]), (304, tag))
            self.assertEqual(self.daemon.get("/v1/meshes/torus", If_None_Match=tag).status, 200)
            self.assertEqual(self.daemon.get(path, If_Match=tag).status, 200)
            self.assertEqual(self.daemon.put("torus", self.file, If_Match=tag).status, 200)

    def test_compressed_files(self):
        path = "/v1/meshes/packed/content?format=ply"
        self.daemon.put("packed", sample("icosphere", level=5))
        plain = self.daemon.get(path)
        first, again = (self.daemon.get(path, Accept_Encoding="gzip") for _ in range(2))
        self.assertEqual(gzip.decompress(first.body), plain.body)
        self.assertEqual(again.body, first.body)
        self.assertEqual(*({name: value for name, value in answer.headers.items() if name not in ("X-Request-Id", "Date")} for answer in (first, again)))
        for name, value in (("Content-Encoding", "gzip"), ("Content-Type", "application/x-ply"), ("Content-Disposition", 'attachment; filename="packed.ply"'), ("Content-Length", str(len(first.body)))):
            self.assertEqual(again.headers[name], value)
        self.assertEqual(again.headers["ETag"], plain.headers["ETag"][:-1] + '-gzip"')
        self.assertIn("Accept-Encoding", ", ".join(again.headers.get_all("Vary")))
        head = self.daemon.request("HEAD", path, headers={"Accept-Encoding": "gzip"})
        self.assertEqual((head.status, head.body, head.headers["Content-Length"], head.headers["ETag"]), (200, b"", str(len(first.body)), again.headers["ETag"]))
        self.assertEqual(self.daemon.get(path, Accept_Encoding="gzip", If_None_Match=again.headers["ETag"]).status, 304)
        self.assertEqual(self.daemon.get(path, Accept_Encoding="gzip", If_Match='"other"').status, 412)
        self.assertEqual(self.daemon.get(path).body, plain.body)
        other = self.daemon.get("/v1/meshes/packed/content?format=obj", Accept_Encoding="gzip")
        self.assertEqual(gzip.decompress(other.body), self.daemon.get("/v1/meshes/packed/content?format=obj").body)
        self.daemon.put("packed", sample("icosphere", level=4))
        self.assertNotEqual(gzip.decompress(self.daemon.get(path, Accept_Encoding="gzip").body), plain.body)

    def test_a_browser_on_this_host_gets_uncompressed_answers(self):
        """Browsers always offer gzip, so the daemon must decide by the browser's address."""
        packed = {"Accept_Encoding": "gzip, deflate, br", "Sec_Fetch_Site": "same-origin"}
        for path, is_page in (("/v1/meshes/torus/content", False), ("/", True), ("/openapi.json", True)):
            near = self.daemon.get(path, **packed)
            self.assertEqual((near.status, near.headers["Content-Encoding"]), (200, "gzip" if is_page else None), path)
            self.assertIn("Accept-Encoding", ", ".join(near.headers.get_all("Vary")))
            for header in ("Forwarded", "Via", "X_Forwarded_For", "X_Real_IP"):
                far = self.daemon.get(path, **packed, **{header: "203.0.113.7"})
                self.assertEqual(far.headers["Content-Encoding"], "gzip", (path, header))

    def test_a_304_has_the_vary_header_of_the_answer(self):
        sent = self.daemon.get("/v1/meshes/torus/content")
        known = self.daemon.get("/v1/meshes/torus/content", If_None_Match=sent.headers["ETag"])
        self.assertEqual(known.status, 304)
        self.assertEqual(set(", ".join(known.headers.get_all("Vary")).split(", ")),
                         set(", ".join(sent.headers.get_all("Vary")).split(", ")))
        self.assert_problem(self.daemon.get("/v1/meshes/torus/content", If_Match='"x"', If_None_Match="*"), 412,
                            "precondition_failed")


class Conditions(TestCase):
    def test_the_contract_lists_the_conditions(self):
        """Answers about a mesh have an ETag, so the contract must list the conditions for these
        answers."""
        for path, item in self.daemon.get("/openapi.json").json["paths"].items():
            for method in set(item) & {"get", "head", "put", "post", "patch", "delete"}:
                operation = item[method]
                if not path.startswith("/v1/meshes") or "ETag" not in operation["responses"].get("200", {}).get("headers", {}):
                    continue
                parameters = item.get("parameters", []) + operation.get("parameters", [])
                names = {parameter.get("$ref", "").rpartition("/")[2] for parameter in parameters}
                self.assertLessEqual({"IfMatch", "IfNoneMatch"}, names, (method, path))
                expected = {"304", "412"} if method in ("get", "head") else {"412"}
                self.assertLessEqual(expected, set(operation["responses"]), (method, path))


class Delete(TestCase):
    def test_delete(self):
        self.daemon.put("gone", SQUARE)
        answer = self.daemon.request("DELETE", "/v1/meshes/gone")
        self.assertEqual((answer.status, answer.body), (204, b""))
        self.assert_problem(self.daemon.get("/v1/meshes/gone"), 404, "not_found")
        self.assert_problem(self.daemon.request("DELETE", "/v1/meshes/gone"), 404, "not_found")

    def test_delete_if_match(self):
        etag = self.daemon.put("matched", SQUARE).headers["ETag"]
        other = self.daemon.request("DELETE", "/v1/meshes/matched", headers={"If-Match": '"other"'})
        self.assert_problem(other, 412, "precondition_failed")
        self.assertEqual(self.daemon.request("DELETE", "/v1/meshes/matched", headers={"If-Match": etag}).status, 204)

    def test_memory_is_returned(self):
        self.daemon.put("big", sample("grid", columns=100, rows=100))
        self.daemon.ask_often("big", "v:0")
        self.daemon.get("/v1/meshes/big/distance?from=v:0&to=v:9000")
        self.assertEqual(self.daemon.get("/v1/meshes/big").json["fields_cached"], 1)
        self.daemon.request("DELETE", "/v1/meshes/big")
        while self.daemon.metric("workers_background"):  # its landmarks are being built
            pass
        self.daemon.wait_for_flight()
        text = self.daemon.get("/metrics").body.decode()
        self.assertIn('memory_bytes{class="fields"} 0\n', text)
        self.assertIn('memory_bytes{class="landmarks"} 0\n', text)


if __name__ == "__main__":
    unittest.main()
