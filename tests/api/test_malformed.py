"""Malformed input gets a 4xx with a code and a sentence, and the daemon continues. There is one
table for each kind of input. Each row of a table is one case."""
import json
import struct
import unittest

from harness import SQUARE, TestCase

ROOT = "/v1/meshes"
JSON = {"Content-Type": "application/json"}
FORM = {"Content-Type": "application/x-www-form-urlencoded"}  # the Content-Type of curl -d


def stl(count, triangles):
    return bytes(80) + struct.pack("<I", count) + triangles * struct.pack("<12fH", *range(12), 0)


PLY = b"ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n" \
      b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"

THREE = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"  # vertices
BOW_TIE = THREE + b"v -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\n"
MOEBIUS = THREE + b"v 1 1 0\nv 1 1 1\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n"
STRIP = [b"v %d %d 0\n" % (i, i % 2) for i in range(11)] + [b"f %d %d %d\n" % (i, i + 1, i + 2) for i in range(1, 10)]
NINE_FACES = b"".join(STRIP)

# Each row has the name, the bytes, and the reason of invalid_mesh. The reason None accepts any
# reason.
FILES = [
    ("nothing", b"", "empty"),
    ("a word", b"hello", "unrecognized"),
    ("zeros", bytes(200), "unrecognized"),
    ("a picture", b"\x89PNG\r\n\x1a\n" + bytes(100), "unrecognized"),
    ("a web page", b"<!doctype html><p>no mesh</p>", "unrecognized"),
    ("no faces", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "empty"),
    ("index beyond the vertices", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "index"),
    ("index zero", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "index"),
    ("index before the first", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -9 1 2\n", "index"),
    ("huge index", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", None),
    ("not a number", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "non_finite"),
    ("infinity", b"v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "non_finite"),
    ("a number beyond doubles", b"v 0 0 1e999\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", None),
    ("coordinates too large to square", b"v 0 0 0\nv 1e200 0 0\nv 0 1e200 0\nf 1 2 3\n", "extent"),
    ("letters for numbers", b"v a b c\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "syntax"),
    ("two coordinates", b"v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "syntax"),
    ("face of two corners", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", None),
    ("face that repeats a vertex", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n", "degenerate_face"),
    ("two vertices in one place", b"v 0 0 0\nv 0 0 0\nv 0 1 0\nf 1 2 3\n", "degenerate_face"),
    ("the same face twice", SQUARE + b"f 1 2 3\n", "duplicate_face"),
    ("three faces at an edge", SQUARE + b"v 0 0 1\nf 1 3 5\n", "non_manifold_edge"),
    ("two fans at a vertex", BOW_TIE, "non_manifold_vertex"),
    ("a Moebius strip", MOEBIUS, "non_orientable"),
    ("STL that ends early", stl(1000, 3), None),
    ("STL of no triangles", stl(0, 0), None),
    ("STL with an absurd count", stl(0xFFFFFFFF, 1), None),
    ("ASCII STL that ends early", b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "truncated"),
    ("OFF with an absurd count", b"OFF\n4000000000 1 0\n0 0 0\n", None),
    ("OFF that ends early", b"OFF\n3 1 0\n0 0 0\n1 0 0\n", "truncated"),
    ("OFF with negative counts", b"OFF\n-3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "syntax"),
    ("PLY that ends early", PLY % (3, 1) + b"0 0 0\n1 0 0\n", "truncated"),
    ("PLY with an absurd count", PLY % (4000000000, 1), None),
    ("PLY without a header's end", b"ply\nformat ascii 1.0\nelement vertex 3\n", None),
    ("PLY of an unknown format", b"ply\nformat ebcdic 1.0\nelement vertex 0\nend_header\n", None),
    ("JSON without faces", b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]]}', None),
    ("JSON that ends early", b'{"vertices": [[0,0,0],[1,0', None),
    ("JSON with an index beyond the vertices", b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,7]]}', "index"),
    ("JSON with two coordinates", b'{"vertices": [[0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]}', None),
]

FORM = {"Content-Type": "multipart/form-data; boundary=x"}
DISTANCE = f"{ROOT}/square/distance"
NEAREST = f"{ROOT}/square/nearest"
PAIR = {"from": {"vertex": 0}, "to": {"vertex": 2}}


def pair(**changes):
    return json.dumps({**PAIR, **changes})


INVALID = 400, "invalid_request"
ABSENT = 404, "not_found"
METHOD = 405, "method_not_allowed"
UNACCEPTABLE = 406, "not_acceptable"
TOO_LARGE = 413, "too_large"
MEDIA_TYPE = 415, "unsupported_media_type"
OFF_SURFACE = 422, "point_not_on_surface"

# Each row has the name, method, path, body, headers, status and code.
REQUESTS = [
    ("unknown path", "GET", "/v2", None, {}, *ABSENT),
    ("path with two slashes", "GET", "//v1/meshes", None, {}, *ABSENT),
    ("path with a slash at its end", "GET", ROOT + "/", None, {}, *ABSENT),
    ("path that climbs", "GET", "/v1/../etc/passwd", None, {}, *ABSENT),
    ("encoded slash in a name", "GET", ROOT + "/a%2Fb", None, {}, *INVALID),
    ("encoded NUL", "GET", ROOT + "/a%00b", None, {}, *INVALID),
    ("broken escape in the path", "GET", ROOT + "/a%2", None, {}, *INVALID),
    ("broken escape in the query string", "GET", DISTANCE + "?from=%zz", None, {}, *INVALID),
    ("encoded line break", "GET", ROOT + "/a%0d%0aX:%20y", None, {}, *INVALID),
    ("unknown method", "BREW", ROOT, None, {}, *METHOD),
    ("method that the resource lacks", "DELETE", ROOT, None, {}, *METHOD),
    ("POST to a mesh", "POST", ROOT + "/square", b"", {}, *METHOD),
    ("name that starts with a dot", "PUT", ROOT + "/.hidden", SQUARE, {}, *INVALID),
    ("name with a space", "PUT", ROOT + "/a%20b", SQUARE, {}, *INVALID),
    ("name of 129 characters", "PUT", ROOT + "/" + "n" * 129, SQUARE, {}, *INVALID),
    ("mesh in a form", "PUT", ROOT + "/x", b"--x--", FORM, *MEDIA_TYPE),
    ("new mesh in a form", "POST", ROOT, b"--x--", FORM, *MEDIA_TYPE),
    ("surface in a form", "PUT", "/v1/nurbs/x", b"--x--", FORM, *MEDIA_TYPE),
    ("unknown upload option", "PUT", ROOT + "/x?colour=red", SQUARE, {}, *INVALID),
    ("unknown format", "PUT", ROOT + "/x?format=dwg", SQUARE, {}, *INVALID),
    ("option with an unknown word", "PUT", ROOT + "/x?triangulate=maybe", SQUARE, {}, *INVALID),
    ("option that stands twice", "PUT", ROOT + "/x?format=obj&format=ply", SQUARE, {}, *INVALID),
    ("upload that declares too much", "PUT", ROOT + "/x", bytes(70000), {}, *TOO_LARGE),
    ("mesh with too many faces", "PUT", ROOT + "/x", NINE_FACES, {}, *TOO_LARGE),
    ("description as text", "GET", ROOT + "/square", None, {"Accept": "text/plain"}, *UNACCEPTABLE),
    ("description with JSON refused", "GET", ROOT + "/square", None, {"Accept": "application/json;q=0"}, *UNACCEPTABLE),
    ("limit of zero", "GET", ROOT + "?limit=0", None, {}, *INVALID),
    ("limit that is not a number", "GET", ROOT + "?limit=many", None, {}, *INVALID),
    ("unknown parameter of a list", "GET", ROOT + "?page=2", None, {}, *INVALID),
    ("unknown parameter of the service", "GET", "/v1?x=1", None, {}, *INVALID),
    *((f"unknown parameter of {path}", "GET", path + "?x=1", None, {}, *INVALID) for path in ("/livez", "/readyz", "/metrics", "/openapi.json")),
    ("missing point", "GET", DISTANCE + "?from=v:0", None, {}, *INVALID),
    ("point without a form", "GET", DISTANCE + "?from=0&to=v:1", None, {}, *INVALID),
    ("point with rubbish behind it", "GET", DISTANCE + "?from=v:0x&to=v:1", None, {}, *INVALID),
    ("vertex of minus one", "GET", DISTANCE + "?from=v:-1&to=v:1", None, {}, *INVALID),
    ("vertex beyond 32 bits", "GET", DISTANCE + "?from=v:4294967296&to=v:1", None, {}, *INVALID),
    ("coordinates that are not finite", "GET", DISTANCE + "?from=p:nan,0,0&to=v:1", None, {}, *INVALID),
    ("unknown parameter", "GET", DISTANCE + "?from=v:0&to=v:1&via=v:2&why=", None, {}, *INVALID),
    ("unknown member", "GET", DISTANCE + "?from=v:0&to=v:1&select=speed", None, {}, *INVALID),
    ("unknown geometry", "GET", DISTANCE + "?from=v:0&to=v:1&geometry=round", None, {}, *INVALID),
    ("timeout of zero", "GET", DISTANCE + "?from=v:0&to=v:1&timeout_ms=0", None, {}, *INVALID),
    ("33 parameters", "GET", DISTANCE + "?" + "&".join(f"a{i}=1" for i in range(33)), None, {}, *INVALID),
    ("body with a GET", "GET", DISTANCE + "?from=v:0&to=v:1", b"{}", {}, *INVALID),
    ("form instead of JSON", "POST", DISTANCE, pair(), FORM, *MEDIA_TYPE),
    ("empty body", "POST", DISTANCE, b"", JSON, *INVALID),
    ("JSON that ends early", "POST", DISTANCE, pair()[:-3], JSON, *INVALID),
    ("JSON with something behind it", "POST", DISTANCE, pair() + "x", JSON, *INVALID),
    ("an array", "POST", DISTANCE, "[]", JSON, *INVALID),
    ("member that stands twice", "POST", DISTANCE, '{"to":{"vertex":0},' + pair()[1:], JSON, *INVALID),
    ("unknown member", "POST", DISTANCE, pair(colour="red"), JSON, *INVALID),
    ("vertex as text", "POST", DISTANCE, pair(to={"vertex": "2"}), JSON, *INVALID),
    ("vertex and a half", "POST", DISTANCE, pair(to={"vertex": 2.5}), JSON, *INVALID),
    ("point of two forms", "POST", DISTANCE, pair(to={"vertex": 2, "xyz": [0, 0, 0]}), JSON, *INVALID),
    ("point of no form", "POST", DISTANCE, pair(to={}), JSON, *INVALID),
    ("barycentrics of sum two", "POST", DISTANCE, pair(to={"face": 0, "barycentric": [1, 1, 0]}), JSON, *OFF_SURFACE),
    ("negative barycentric", "POST", DISTANCE, pair(to={"face": 0, "barycentric": [-1, 1, 1]}), JSON, *OFF_SURFACE),
    ("t beyond the edge", "POST", DISTANCE, pair(to={"edge": [0, 1], "t": 1.5}), JSON, *OFF_SURFACE),
    ("edge that is none", "POST", DISTANCE, pair(to={"edge": [1, 3], "t": 0.5}), JSON, *INVALID),
    ("number beyond doubles", "POST", DISTANCE, '{"from":{"vertex":0},"to":{"xyz":[1e999,0,0]}}', JSON, *INVALID),
    ("ray to nowhere", "POST", NEAREST, '{"point":{"ray":{"origin":[0,0,1],"direction":[0,0,0]}}}', JSON, *INVALID),
    ("NUL in JSON", "POST", DISTANCE, '{"from":{"vertex":0},"to":{"vertex":2},"\\u0000":1}', JSON, *INVALID),
    ("bytes that are not UTF-8", "POST", DISTANCE, b'{"from":{"vertex":0},"\xff":1}', JSON, *INVALID),
    ("deep nesting", "POST", DISTANCE, "[" * 5000 + "]" * 5000, JSON, *INVALID),
]

PUT = b"PUT /v1/meshes/raw HTTP/1.1\r\nHost: localhost\r\n"
OLD_PUT = b"PUT /v1/meshes/raw HTTP/1.0\r\nHost: localhost\r\n"
GET = b"GET /v1 HTTP/1.1\r\n"

# Requests that a client library would not send. Each row has the name, the bytes, and the status.
# Status 0 means that the daemon closes the connection without an answer.
RAW = [
    ("both lengths", PUT + b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("two Content-Lengths", PUT + b"Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello", 400),
    ("the same Content-Length twice", PUT + b"Content-Length: 5\r\nContent-Length: 5\r\n\r\nhello", 400),
    ("a list of Content-Lengths", PUT + b"Content-Length: 5, 5\r\n\r\nhello", 400),
    ("a signed Content-Length", PUT + b"Content-Length: +5\r\n\r\nhello", 400),
    ("a negative Content-Length", PUT + b"Content-Length: -5\r\n\r\nhello", 400),
    ("a hexadecimal Content-Length", PUT + b"Content-Length: 0x5\r\n\r\nhello", 400),
    ("a Content-Length beyond 64 bits", PUT + b"Content-Length: 99999999999999999999\r\n\r\nhello", (400, 413)),
    ("an unknown coding", PUT + b"Transfer-Encoding: gzip\r\n\r\nhello", 400),
    ("chunked and more", PUT + b"Transfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n", 400),
    ("chunked in HTTP/1.0", OLD_PUT + b"Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
    ("an upload of no length", PUT + b"\r\n", 411),
    ("no Host", GET + b"\r\n", 400),
    ("two Hosts", GET + b"Host: localhost\r\nHost: localhost\r\n\r\n", 400),
    ("an absolute target elsewhere", b"GET http://example.com/v1 HTTP/1.1\r\nHost: localhost\r\n\r\n", 403),
    ("65 headers", GET + b"Host: localhost\r\n" + b"".join(b"X-%d: y\r\n" % i for i in range(64)) + b"\r\n", 400),
    ("a request line without a version", b"GET\r\n\r\n", (400, 0)),
    ("a header line without a colon", GET + b"Host: localhost\r\nrubbish\r\n\r\n", 400),
]


class Malformed(TestCase):
    flags = ("--max-body", "64KiB", "--max-faces", "8")

    def setUp(self):
        self.assertIn(self.daemon.put("square", SQUARE).status, (200, 201))

    def tearDown(self):
        self.assertEqual(self.daemon.get("/livez").status, 200)

    def test_files(self):
        for name, content, reason in FILES:
            with self.subTest(name):
                problem = self.assert_problem(self.daemon.put("bad", content), 422, "invalid_mesh")
                if reason:
                    self.assertEqual(problem["reason"], reason)
        self.assert_problem(self.daemon.get(f"{ROOT}/bad"), 404, "not_found")

    def test_a_problem_names_the_remedy(self):
        crowded = SQUARE + b"v 0 0 1\nf 1 3 5\n"
        doubled, flat, short = SQUARE + b"f 1 2 3\n", SQUARE + b"v 0.5 0 0\nf 2 1 5\n", SQUARE + b"v 0 0 0\nf 1 2 5\n"
        for query, file, remedy in (("", crowded, "?repair=split"), ("", BOW_TIE, "?repair=split"), ("?weld=0", crowded, "?repair=split"),
                                    ("", doubled, "?repair=split"), ("", flat, "?repair=split"), ("", short, "?repair=split")):
            problem = self.assert_problem(self.daemon.put("bad", file, query), 422, "invalid_mesh")
            self.assertIn(remedy, problem["detail"])
            self.assertEqual(self.daemon.put("mended", file, (query or "?") + "&repair=split").status // 100, 2)
        form = self.daemon.request("PUT", f"{ROOT}/bad", b"--x--", FORM)
        self.assertIn(f"curl -X PUT --data-binary @FILE http://HOST{ROOT}/bad", form.json["detail"])
        odd = self.daemon.request("PUT", f"{ROOT}/a;b", b"--x--", FORM)
        self.assertNotIn(";b", odd.json["detail"])

    def test_requests(self):
        for name, method, path, body, headers, status, code in REQUESTS:
            with self.subTest(name):
                self.assert_problem(self.daemon.request(method, path, body, headers), status, code)

    def test_raw(self):
        for name, text, status in RAW:
            with self.subTest(name):
                received = self.daemon.raw(text, shut=True)
                expected = status if isinstance(status, tuple) else (status,)
                self.assertIn(int(received[9:12] or 0), expected, received)
                self.assertLessEqual(received.count(b"X-Request-Id"), 1, received)

    def test_nothing_is_smuggled(self):
        """The daemon never reads the bytes after an ambiguous request as a request."""
        hidden = b"GET /v1/meshes/smuggled HTTP/1.1\r\nHost: localhost\r\n\r\n"
        both = b"Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"
        twice = b"Content-Length: 0\r\nContent-Length: 60\r\n\r\n"
        for framing in (both, twice):
            self.assertEqual(self.daemon.raw(PUT + framing + hidden).count(b"HTTP/1.1 "), 1)
        refused = b"GET /v1 HTTP/1.1\r\nHost: evil.example\r\nContent-Length: %d\r\n\r\n" % len(hidden)
        self.assertEqual(self.daemon.raw(refused + hidden).count(b"X-Request-Id"), 1)
        self.assertFalse([line for line in self.daemon.log if "smuggled" in line.get("path", "")])

    def test_chunks_past_the_limit(self):
        chunks = (bytes(1000) for _ in range(100))
        self.assert_problem(self.daemon.put("chunked", chunks), 413, "too_large")

    def test_long_headers(self):
        received = self.daemon.raw(GET + b"Host: localhost\r\nX-Long: " + b"y" * 300000 + b"\r\n\r\n")
        self.assertIn(received[9:12], (b"400", b"431", b""), received[:200])


if __name__ == "__main__":
    unittest.main()
