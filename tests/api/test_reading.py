"""Tests files that need repair=split: the lines that the reader skips, and the faces that it
cuts."""
import struct
import zlib

from harness import TestCase

SQUARE_WITH_A_HOLE = b"".join(b"v %d %d 0\n" % place for place in ((0, 0), (3, 0), (3, 3), (0, 3), (1, 1), (1, 2), (2, 2), (2, 1)))


class Reading(TestCase):
    def upload(self, file, query="?repair=split"):
        return self.daemon.put("file", file, query)

    def repaired(self, file):
        answer = self.upload(file)
        self.assertIn(answer.status, (200, 201), answer)
        return answer.json

    def test_lines_skipped_of_obj(self):
        file = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\nf 1 2 3\nf 2\n"
        self.assert_problem(self.upload(file, ""), 422, "invalid_mesh")
        made = self.repaired(file)
        self.assertEqual((made["faces"], made["repair"]["lines_skipped"], made["repair"]["first"]["lines_skipped"]), (1, 2, [4, 6]))

    def test_lines_skipped_of_ply(self):
        file = b"""ply
format ascii 1.0
created by hand
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0 17
1 0 0
0 1 0
3 0 1 2
"""
        self.assert_problem(self.upload(file, ""), 422, "invalid_mesh")
        made = self.repaired(file)
        self.assertEqual((made["repair"]["lines_skipped"], made["repair"]["first"]["lines_skipped"]), (2, [3, 11]))

    def test_first_lines_are_eight(self):
        made = self.repaired(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + b"f 1 2\n" * 20)
        self.assertEqual((made["repair"]["lines_skipped"], made["repair"]["first"]["lines_skipped"]), (20, list(range(5, 13))))

    def test_nothing_is_skipped_of_a_good_file(self):
        made = self.repaired(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.assertEqual((made["repair"]["lines_skipped"], made["repair"]["faces_cut"]), (0, 0))

    def test_faces_cut(self):
        """A bridge joins the hole of a square to its border, so two corners occur twice."""
        file = SQUARE_WITH_A_HOLE + b"f 1 2 3 4 1 5 6 7 8 5\n"
        problem = self.assert_problem(self.upload(file, ""), 422, "invalid_mesh")
        self.assertIn("repair=split", problem["detail"])
        made = self.repaired(file)
        self.assertEqual((made["repair"]["faces_cut"], made["area"], made["faces"], made["boundary_count"]), (1, 8, 8, 2))
        self.assertEqual(made["repair"]["first"]["faces_cut"][0][0], 0)

    def test_repairs_stay_in_the_description(self):
        made = self.repaired(SQUARE_WITH_A_HOLE + b"f 1 2 3 4 1 5 6 7 8 5\n")
        self.assertEqual(self.daemon.get("/v1/meshes/file").json["repair"], made["repair"])

    def test_zip64(self):
        """A 3MF package has its sizes in extra fields, as streaming exporters write them."""
        core = b'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"'
        mesh = b'<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/></vertices>' \
               b'<triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>'
        text = b'<model unit="millimeter" ' + core + b'><resources><object id="1" type="model">' + mesh + b'</object></resources>' \
               b'<build><item objectid="1"/></build></model>'
        name, packed = b"3D/3dmodel.model", zlib.compress(text)[2:-4]
        extra = struct.pack("<HHQQ", 1, 16, len(text), len(packed))
        common = struct.pack("<HHHHHIIIHH", 45, 8, 8, 0, 0, zlib.crc32(text), 0xFFFFFFFF, 0xFFFFFFFF, len(name), len(extra))
        local = b"PK\3\4" + common + name + extra + packed
        central = b"PK\1\2" + struct.pack("<H", 45) + common + struct.pack("<HHHII", 0, 0, 0, 0, 0) + name + extra
        end = b"PK\5\6" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local), 0)
        self.assertEqual(self.upload(local + central + end, "").json["faces"], 1)
