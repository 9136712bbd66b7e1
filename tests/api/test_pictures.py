"""Tests pictures by a decoder in this file: positions of paths and colours of distances. Also tests
refusals, caching, jobs and limits."""
import base64
import json
import random
import struct
import time
import unittest
import xml.etree.ElementTree as ElementTree
import zlib

from harness import SQUARE, TWO_TRIANGLES, TestCase, sample

# a mesh that looks different from each side
UNLIKE = b"v 0 0 0\nv 1 0.1 0\nv 0.2 2 0\nv 0.1 0.3 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SVG = "{http://www.w3.org/2000/svg}"


class Png:
    """Decodes a PNG file of 8 bits with or without opacity; checks each chunk's checksum."""

    def __init__(self, data):
        assert data[:8] == b"\x89PNG\r\n\x1a\n", data[:20]
        packed, at = b"", 8
        while at < len(data):
            size, kind = struct.unpack(">I4s", data[at : at + 8])
            chunk = data[at + 8 : at + 8 + size]
            assert zlib.crc32(kind + chunk) == struct.unpack(">I", data[at + 8 + size : at + 12 + size])[0], kind
            if kind == b"IHDR":
                self.width, self.height, depth, colours, *rest = struct.unpack(">IIBBBBB", chunk)
                assert (depth, rest) == (8, [0, 0, 0]) and colours in (2, 6), chunk
            packed += chunk if kind == b"IDAT" else b""
            at += 12 + size
        self.channels = 3 if colours == 2 else 4
        self.rows = self.unfilter(zlib.decompress(packed))

    def unfilter(self, raw):
        line, rows, above = self.width * self.channels, [], bytes(self.width * self.channels)
        for y in range(self.height):
            kind, row = raw[y * (line + 1)], bytearray(raw[y * (line + 1) + 1 : (y + 1) * (line + 1)])
            for i in range(line):
                left = row[i - self.channels] if i >= self.channels else 0
                corner = above[i - self.channels] if i >= self.channels else 0
                guess = left + above[i] - corner
                paeth = min((left, above[i], corner), key=lambda x: abs(guess - x))
                row[i] = (row[i] + (0, left, above[i], (left + above[i]) // 2, paeth)[kind]) & 255
            rows.append(bytes(row))
            above = row
        return rows

    def at(self, x, y):
        return tuple(self.rows[y][self.channels * x : self.channels * (x + 1)])


class PictureTests(TestCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.put_all({"square": SQUARE, "unlike": UNLIKE, "two": TWO_TRIANGLES, "sphere": sample("icosphere", level=4)})

    def picture(self, query="", mesh="square", form="png", status=200, **headers):
        answer = self.daemon.request("GET", f"/v1/meshes/{mesh}/picture.{form}{query}", None, headers)
        self.assertEqual(answer.status, status, answer)
        return answer

    def refused(self, query, place, mesh="square", status=400, code="invalid_request"):
        problem = self.picture(query, mesh, status=status).json
        self.assertEqual(problem["code"], code)
        self.assertEqual(problem.get("parameter"), place, problem)
        return problem

    def test_a_square_from_before(self):
        answer = self.picture("?view=front&size=100x60&background=transparent")
        self.assertEqual(answer.headers["Content-Type"], "image/png")
        png = Png(answer.body)
        self.assertEqual((png.width, png.height, png.channels), (100, 60, 4))
        self.assertEqual(png.at(50, 30)[3], 255)
        self.assertEqual(png.at(3, 30)[3], 0)
        area = sum(png.at(x, y)[3] / 255 for x in range(100) for y in range(60))
        self.assertAlmostEqual(area, 48 * 48, delta=2)  # the margin is a tenth of the shorter side

    def test_views_have_names_and_ups(self):
        def seen(query):
            return self.picture(f"?size=64x64&legend=false{query}", "unlike").body

        names = ("front", "back", "left", "right", "top", "bottom", "iso")
        self.assertEqual(len({seen(f"&view={name}") for name in names}), len(names))
        self.assertEqual(seen("&view=front"), seen("&view=0,0,1"))
        self.assertEqual(seen("&view=left"), seen("&view=-5,0,0"))
        self.assertEqual(seen("&view=top"), seen("&view=0,1e-9,0"))
        self.assertEqual(seen("&view=front&up=z"), seen("&view=0,-1,0&up=0,0,3"))
        self.assertEqual(seen("&view=iso"), seen(""))

    def test_a_path_is_drawn_red(self):
        png = Png(self.picture("?from=v:0&to=v:2&view=front&size=120x120&legend=false").body)
        for x in range(35, 85):
            red, green, blue = png.at(x, 119 - x)
            self.assertTrue(red > 150 and green < 60 and blue < 60, (x, png.at(x, 119 - x)))
            self.assertFalse(png.at(x, min(127 - x, 119))[1] < 60)

    def test_distances_are_colours(self):
        by_id = self.asked("square", "fields", {"set": {"points": [{"vertex": 0}]}}, 201)["id"]
        of_source = self.picture("?source=v:0&view=front&size=120x120&legend=false&isolines=0").body
        self.assertEqual(self.picture(f"?field={by_id}&view=front&size=120x120&legend=false&isolines=0").body, of_source)
        png = Png(of_source)
        near, far = png.at(25, 95), png.at(103, 16)
        self.assertGreater(sum(far), sum(near) + 150)  # violet, yellow
        self.assertGreater(near[2], near[1])
        self.assertGreater(far[1], far[2])

    def test_a_partial_field_and_isolines(self):
        field = self.asked("sphere", "fields", {"set": {"points": [{"vertex": 0}]}, "max_distance": 0.8}, 201)["id"]
        png = Png(self.picture(f"?field={field}&isolines=6&size=80x80", "sphere").body)
        self.assertEqual(png.width, 80)

    def test_the_drawing_is_xml_with_lines_and_text(self):
        answer = self.picture("?source=v:0&from=v:0&to=v:9&via=v:4&isolines=5", "sphere", "svg")
        self.assertEqual(answer.headers["Content-Type"], "image/svg+xml")
        self.assertIn("img-src data:", answer.headers["Content-Security-Policy"])
        root = ElementTree.fromstring(answer.body)
        self.assertEqual((root.tag, root.get("width"), root.get("height")), (SVG + "svg", "800", "600"))
        image = root.find(SVG + "image").get("{http://www.w3.org/1999/xlink}href")
        png = Png(base64.b64decode(image.removeprefix("data:image/png;base64,"), validate=True))
        self.assertEqual((png.width, png.height), (800, 600))
        words = [text.text for text in root.iter(SVG + "text")]
        self.assertIn("distance", words)
        length = self.asked("sphere", "path", {"from": {"vertex": 0}, "to": {"vertex": 9}, "via": [{"vertex": 4}]})["path"]["length"]
        told = [float(word.split()[-1]) for word in words if word.startswith("path length")]
        self.assertAlmostEqual(told[0], length, delta=1e-7)
        for path in root.iter(SVG + "path"):
            self.assertRegex(path.get("d"), r"^(M[-0-9.e]+ [-0-9.e]+(L[-0-9.e]+ [-0-9.e]+)*)+$")

    def test_invalid_pictures(self):
        self.refused("?size=800", "size")
        self.refused("?size=15x600", "size")
        self.refused("?size=4097x16", "size")
        self.refused("?size=99999999999999999999x16", "size")
        self.refused("?size=-5x16", "size")
        self.assertEqual(self.refused("?size=4096x4096", "size", status=413, code="too_large")["limit"], 8294400)
        self.refused("?view=under", "view")
        self.refused("?view=0,0,0", "view")
        self.refused("?view=1,2", "view")
        self.refused("?view=1,2,1e999", "view")
        self.refused("?up=0,0,0", "up")
        self.refused("?isolines=101", "isolines")
        self.refused("?edges=yes", "edges")
        self.refused("?background=blue", "background")
        self.refused("?from=v:0", "to")
        self.refused("?to=v:0", "from")
        self.refused("?via=v:0", "from")
        self.refused("?from=v:0&to=v:77", "to")
        self.refused("?source=v:77", "source")
        self.refused("?source=v:0&field=" + 32 * "0", "source")
        self.refused("?field=" + 32 * "0", "field", status=404, code="not_found")
        self.refused("?field=short", "field", status=404, code="not_found")
        self.refused("?select=length", "select")
        self.refused("?geometry=none", "geometry")
        self.assertIn("components", self.refused("?from=v:0&to=v:3", "to", "two")["detail"])
        self.picture(mesh="absent", status=404)
        self.picture(status=406, Accept="application/json")
        self.assertEqual(self.daemon.request("POST", "/v1/meshes/square/picture.png", b"{}", {}).status, 405)

    def test_points_without_a_path_have_no_colour(self):
        png = Png(self.picture("?source=v:0&view=front&size=400x100&legend=false&isolines=0", "two").body)
        self.assertLess(max(png.at(330, 70)) - min(png.at(330, 70)), 16)  # grey

    def test_a_known_etag_gets_304_at_once(self):
        etag = self.picture("?view=top").headers["ETag"]
        self.assertEqual(self.picture("?view=top", status=304, **{"If-None-Match": etag}).body, b"")
        self.picture("?view=top", status=412, **{"If-Match": '"other"'})
        self.picture("?view=nowhere", status=400, **{"If-None-Match": etag})

    def test_equal_requests_get_equal_bytes(self):
        query = "?source=v:3&from=v:3&to=v:40&size=300x200&edges=true&background=dark"
        self.assertEqual(self.picture(query, "sphere").body, self.picture(query, "sphere").body)

    def test_as_a_job(self):
        answer = self.picture("?source=v:5&size=200x100", "sphere", status=202, Prefer="respond-async")
        place = answer.headers["Location"]
        while self.daemon.get(place).json["state"] in ("queued", "running"):
            time.sleep(0.01)
        result = self.daemon.get(place + "/result")
        self.assertEqual((result.status, result.headers["Content-Type"]), (200, "image/png"))
        self.assertEqual(Png(result.body).width, 200)

    def test_png_is_not_packed_twice(self):
        answer = self.picture("?size=400x300", "sphere", **{"Accept-Encoding": "gzip"})
        self.assertNotIn("Content-Encoding", answer.headers)
        answer = self.picture("?size=400x300", "sphere", "svg", **{"Accept-Encoding": "gzip"})
        self.assertEqual(answer.headers["Content-Encoding"], "gzip")

    def test_a_picture_ends_at_its_deadline(self):
        answer = self.picture("?source=v:0&isolines=100&size=3840x2160&timeout_ms=1", "sphere", status=504)
        self.assertEqual(answer.json["code"], "deadline_exceeded")

    def test_any_request_is_a_picture_or_a_sentence(self):
        chance, drawn = random.Random(7), 0
        good = {"source": ["v:1", "f:2:0.2,0.3,0.5"], "from": ["v:1"], "to": ["e:0-1:0.5", "p:0,0,9"], "via": ["v:1;v:2"], "view": ["top", "-1e300,2,1e-300"],
                "up": ["z", "1,1,1"], "size": ["16x16", "90x70", "31x200"], "isolines": ["0", "100"], "edges": ["true"], "legend": ["false"],
                "background": ["dark", "transparent"], "timeout_ms": ["10000"]}
        bad = ["", "0", "nan,0,0", "1x1", "v:1", "f:2:0.2,0.3,0.6", "%00", "%F0%9F%92%A1", "x", ",", "-1", "16x16x16", "1,1,1,1", "yes"]
        for _ in range(300):
            chosen = [*chance.sample(list(good), chance.randint(1, 6)), *chance.choice(((), ("from", "to")))]
            query = "&".join(f"{name}={chance.choice(good[name] if chance.random() < 0.9 else bad)}" for name in sorted(set(chosen) | {"size"}))
            form = chance.choice(("png", "svg"))
            answer = self.daemon.request("GET", f"/v1/meshes/unlike/picture.{form}?{query}", None, {})
            self.assertIn(answer.status, (200, 400, 422), (query, answer))
            drawn += answer.status == 200
            if answer.status == 200 and form == "png":
                Png(answer.body)
            elif answer.status == 200:
                ElementTree.fromstring(answer.body)
            else:
                self.assertTrue(json.loads(answer.body)["detail"])
        self.assertGreater(drawn, 60)


if __name__ == "__main__":
    unittest.main()
