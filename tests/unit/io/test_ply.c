#include "tests/unit/io/reading.h"

#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"

#define ASCII     "ply\nformat ascii 1.0\n"
#define LITTLE    "ply\nformat binary_little_endian 1.0\n"
#define BIG       "ply\nformat binary_big_endian 1.0\n"
#define XYZ(type) "property " type " x\nproperty " type " y\nproperty " type " z\n"
#define VERTEX    "element vertex 3\n" XYZ("float")
#define FACE      "element face 1\nproperty list uchar int vertex_indices\n"
#define END       "end_header\n"
#define HEADER    ASCII VERTEX FACE END /* "end_header" is line 10 */
#define POSITIONS "0 0 0\n1 0 0\n0 1 0\n"

/* Binary numbers: four zero bytes, and the float 1 in either byte order. */
#define O4               "\0\0\0\0"
#define LITTLE_ONE       "\0\0\x80\x3f"
#define BIG_ONE          "\x3f\x80\0\0"
#define LITTLE_POSITIONS O4 O4 O4 LITTLE_ONE O4 O4 O4 LITTLE_ONE O4
#define BIG_POSITIONS    O4 O4 O4 BIG_ONE O4 O4 O4 BIG_ONE O4
#define LITTLE_TRIANGLE  "\3" O4 "\1\0\0\0\2\0\0\0"
#define BIG_TRIANGLE     "\3" O4 "\0\0\0\1\0\0\0\2"

static const struct good_input good[] = {
    {BYTES(HEADER POSITIONS "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES(HEADER POSITIONS "3 0 1 2"), TRIANGLE_MESH},
    {BYTES("ply\nformat ascii 1.0\ncomment end_header\nobj_info x\n" VERTEX FACE END POSITIONS
           "3 0 1 2\n"),
     TRIANGLE_MESH},
    {BYTES("ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\nproperty float "
           "y\r\nproperty float z\r\n"
           "element face 1\r\nproperty list uchar int vertex_index\r\nend_header\r\n0 0 0\r\n1 0 "
           "0\r\n0 1 0\r\n3 0 1 "
           "2\r\n"),
     TRIANGLE_MESH},
    {BYTES(ASCII FACE VERTEX END "3 0 1 2\n" POSITIONS), TRIANGLE_MESH},
    {BYTES(ASCII "element vertex 3\nproperty int8 nx\n" XYZ(
         "float64") "property list uint8 float32 w\nproperty uint8 red\n" FACE END
                    "7 0 0 0 2 nan 0x 255\n8 1 0 0 0 1\n-9 0 1 0 1 1 0\n\n3 0 1 2\n"),
     TRIANGLE_MESH},
    {BYTES(ASCII "element camera 1\nproperty float fov\nproperty list int int k\n" VERTEX
                 "element edge 2\nproperty int a\n"
                 "element nothing 4000000000\n" FACE "property uchar flag\n" END
                 "1.5 3 1 2 3\n" POSITIONS "4\n5\n3 0 1 2 9\n"),
     TRIANGLE_MESH},
    {BYTES(ASCII VERTEX "element face 2\nproperty list ushort uint vertex_index\n" END POSITIONS
                        "4 0 1 2 1\n3 2 1 0\n"),
     "0 0 0; 1 0 0; 0 1 0 | 0 1 2 1; 2 1 0"},
    {BYTES(ASCII
           "element vertex 3\nproperty double z\nproperty double x\nproperty double y\n" FACE END
           "0 0 0\n0.1 16777217 1e-320\n0 0 1\n3 0 1 2\n"),
     "0 0 0; 16777217 9.9998886718268301e-321 0.10000000000000001; 0 1 0 | 0 1 2"},
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS LITTLE_TRIANGLE), TRIANGLE_MESH},
    {BYTES(BIG VERTEX FACE END BIG_POSITIONS BIG_TRIANGLE), TRIANGLE_MESH},
    {BYTES(LITTLE FACE VERTEX END LITTLE_TRIANGLE LITTLE_POSITIONS), TRIANGLE_MESH},
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS LITTLE_TRIANGLE "trailing bytes"),
     TRIANGLE_MESH},
    {BYTES("ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\rproperty "
           "uchar y\rproperty uchar "
           "z\r"
           "element face 1\rproperty list uchar uchar "
           "vertex_indices\rend_header\r\n\0\0\1\0\0\0\1\0\3\0\1\2"),
     "10 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {BYTES(LITTLE "element vertex 3\n" XYZ("char") FACE END
           "\xff\0\x80\1\0\0\0\1\0" LITTLE_TRIANGLE),
     "-1 0 -128; 1 0 0; 0 1 0 | 0 1 2"},
    {BYTES(BIG "element vertex 3\n" XYZ("short") FACE END
           "\xff\xfe\0\0\0\0\1\0\0\0\0\0\0\0\0\1\0\0" BIG_TRIANGLE),
     "-2 0 0; 256 0 0; 0 1 0 | 0 1 2"},
    {BYTES(BIG "element vertex 3\n" XYZ("uint16") FACE END
           "\xff\xfe\0\0\0\0\1\0\0\0\0\0\0\0\0\1\0\0" BIG_TRIANGLE),
     "65534 0 0; 256 0 0; 0 1 0 | 0 1 2"},
    {BYTES(LITTLE "element vertex 3\n" XYZ("int") FACE END
           "\xfd\xff\xff\xff" O4 O4 O4 O4 O4 O4 O4 O4 LITTLE_TRIANGLE),
     "-3 0 0; 0 0 0; 0 0 0 | 0 1 2"},
    {BYTES(LITTLE "element vertex 3\n" XYZ("uint32") FACE END
           "\xfd\xff\xff\xff" O4 O4 O4 O4 O4 O4 O4 O4 LITTLE_TRIANGLE),
     "4294967293 0 0; 0 0 0; 0 0 0 | 0 1 2"},
    {BYTES(BIG "element vertex 3\n" XYZ("double") FACE END
           "\x41\x70\0\0\x10\0\0\0" O4 O4 O4 O4 O4 O4 O4 O4 O4 O4 O4 O4 O4 O4
           "\x3f\xf0\0\0" O4 BIG_TRIANGLE),
     "16777217 0 0; 0 0 0; 0 0 1 | 0 1 2"},
    {BYTES(LITTLE "element vertex 3\nproperty list ushort short w\n" XYZ("float") FACE END
           "\2\0zzzz" O4 O4 O4 "\0\0" LITTLE_ONE O4 O4 "\1\0zz" O4 LITTLE_ONE O4 LITTLE_TRIANGLE),
     TRIANGLE_MESH},
};

#define STRIPS "element tristrips 1\nproperty list int int vertex_indices\n"
#define SQUARE "element vertex 4\n" XYZ("float")

static const struct good_input good_strips[] = {
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES(ASCII SQUARE STRIPS END POSITIONS "1 1 0\n4 0 1 2 3\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 2; 2 1 3"},
    {BYTES(ASCII SQUARE STRIPS END POSITIONS "1 1 0\n9 0 1 2 -1 -1 1 3 2 -1\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 2; 1 3 2"},
    {BYTES(ASCII SQUARE STRIPS END POSITIONS "1 1 0\n8 0 1 2 2 1 1 3 2\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 2; 3 1 2"},
    {BYTES(LITTLE VERTEX STRIPS END LITTLE_POSITIONS
           "\4\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\xff\xff\xff\xff"),
     TRIANGLE_MESH},
};

static const struct bad_input bad_strips[] = {
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "3 0 1 3\n"), GD_INDEX, 13, "vertex 3"},
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "3 0 1 -2\n"), GD_INDEX, 13, "vertex -2"},
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "3 0 1.5 2\n"), GD_SYNTAX, 13, "1.5"},
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "3 0 nan 2\n"), GD_SYNTAX, 13, NULL},
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "2 0 1\n"), GD_EMPTY, 0, "no faces"},
    {BYTES(ASCII VERTEX STRIPS END POSITIONS "5 0 1 2\n"), GD_SYNTAX, 13, "the line ends"},
};

static const struct skipped_input skipped[] = {
    {BYTES(ASCII "Created by a program\n" VERTEX FACE END POSITIONS "3 0 1 2\n"), TRIANGLE_MESH, 1,
     3},
    {BYTES(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 1 1\n"), TRIANGLE_MESH, 1, 13},
    {BYTES(ASCII VERTEX "element face 3\nproperty list uchar int vertex_index\n" END POSITIONS
                        "2 0 1\n3 0 1 2\n0\n"),
     TRIANGLE_MESH, 2, 13},
    {BYTES(LITTLE VERTEX
           "element face 2\nproperty list uchar int vertex_index\n" END LITTLE_POSITIONS
           "\2" O4 O4 LITTLE_TRIANGLE),
     TRIANGLE_MESH, 1, 203},
    {BYTES(LITTLE VERTEX
           "element face 9\nproperty list uchar int vertex_index\n" END LITTLE_POSITIONS
           "\0\0\0\0" LITTLE_TRIANGLE "\0\0\0\0"),
     TRIANGLE_MESH, 8, 203},
};

static const struct bad_input bad_headers[] = {
    {BYTES("plx\n"), GD_SYNTAX, 1, "the word ply"},
    {BYTES("ply"), GD_SYNTAX, 1, NULL},
    {BYTES("ply\n"), GD_TRUNCATED, 2, NULL},
    {BYTES("ply\nend_header\n"), GD_SYNTAX, 2, "no format"},
    {BYTES("ply\nformat text 1.0\nend_header\n"), GD_SYNTAX, 2, "found 'text'"},
    {BYTES("ply\nformat ascii 2.0\nend_header\n"), GD_UNSUPPORTED, 2, "version 1.0"},
    {BYTES(ASCII VERTEX FACE), GD_TRUNCATED, 9, NULL},
    {BYTES(ASCII "colour red\n" END), GD_SYNTAX, 3, "found 'colour'"},
    {BYTES(ASCII "property float x\n" END), GD_SYNTAX, 3, "before the first element"},
    {BYTES(ASCII "element vertex\n" END), GD_SYNTAX, 3, NULL},
    {BYTES(ASCII "element vertex -1\n" END), GD_SYNTAX, 3, "negative"},
    {BYTES(ASCII "element vertex many\n" END), GD_SYNTAX, 3, "'many'"},
    {BYTES(ASCII VERTEX VERTEX END), GD_SYNTAX, 7, "twice"},
    {BYTES(ASCII "element vertex 3\nproperty half x\n" END), GD_SYNTAX, 4, "'half'"},
    {BYTES(ASCII "element vertex 3\nproperty float\n" END), GD_SYNTAX, 4, "the name of a property"},
    {BYTES(ASCII "element vertex 3\nproperty list uchar vertex_indices\n" END), GD_SYNTAX, 4, NULL},
    {BYTES(ASCII "element face 1\nproperty list float int vertex_indices\n" END), GD_SYNTAX, 4,
     "whole numbers"},
    {BYTES(ASCII "element vertex 3\nproperty float x\nproperty float y\n" FACE END POSITIONS
                 "3 0 1 2\n"),
     GD_SYNTAX, 8, "x, y and z"},
    {BYTES(ASCII "element vertex 3\nproperty float x\n" XYZ("float") FACE END POSITIONS
           "3 0 1 2\n"),
     GD_SYNTAX, 10, "once each"},
    {BYTES(ASCII VERTEX "element face 1\nproperty int vertex_indices\n" END POSITIONS "3 0 1 2\n"),
     GD_SYNTAX, 9, "vertex_indices"},
    {BYTES(ASCII VERTEX "element face 1\nproperty list uchar int corners\n" END POSITIONS
                        "3 0 1 2\n"),
     GD_SYNTAX, 9, NULL},
    {BYTES(ASCII VERTEX "element tristrips 1\nproperty list int int corners\n" END POSITIONS
                        "3 0 1 2\n"),
     GD_SYNTAX, 9, "triangle strips"},
    {BYTES(ASCII VERTEX END POSITIONS), GD_EMPTY, 0, "no faces"},
    {BYTES(ASCII VERTEX "element face 0\nproperty list uchar int vertex_indices\n" END POSITIONS),
     GD_EMPTY, 0, NULL},
    {BYTES(ASCII FACE END "3 0 1 2\n"), GD_INDEX, 6, "only 0"},
    {BYTES(ASCII "element vertex 4000000000\n" XYZ("float") FACE END POSITIONS "3 0 1 2\n"),
     GD_TRUNCATED, 10, "26 bytes"},
    {BYTES(ASCII VERTEX
           "element face 4000000000\nproperty list uchar int vertex_indices\n" END POSITIONS
           "3 0 1 2\n"),
     GD_TRUNCATED, 10, NULL},
    {BYTES(LITTLE "element vertex 4000000000\n" XYZ("char") FACE END "abcdef"), GD_TRUNCATED, 0,
     "6 bytes"},
    {BYTES(LITTLE "element vertex 99999999999999999999999\n" XYZ("double") FACE END "abcdef"),
     GD_TRUNCATED, 0, NULL},
    {BYTES(LITTLE "element vertex 768614336404564651\n" XYZ("double") FACE END "abcdef"),
     GD_TRUNCATED, 0, NULL},
    {BYTES(LITTLE "element x 4000000000\nproperty list uchar int y\n" VERTEX FACE END "abcdef"),
     GD_TRUNCATED, 0, NULL},
};

static const struct bad_input bad_text[] = {
    {BYTES(HEADER "0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), GD_SYNTAX, 10, "the line ends"},
    {BYTES(HEADER "0 0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), GD_SYNTAX, 10,
     "found '0' where the end of the line"},
    {BYTES(HEADER "0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"), GD_SYNTAX, 11, "'x'"},
    {BYTES(HEADER "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n"), GD_NON_FINITE, 11, "vertex 1"},
    {BYTES(HEADER "0 0 0\n1 1e400 0\n0 1 0\n3 0 1 2\n"), GD_NON_FINITE, 11, NULL},
    {BYTES(HEADER POSITIONS "2 0 1\n"), GD_SYNTAX, 13, "2 corners"},
    {BYTES(HEADER POSITIONS "3 0 1\n"), GD_SYNTAX, 13, "the line ends"},
    {BYTES(HEADER "0 0 0\n1 0 0\n0 1 0,5\n3 0 1 2\n"), GD_SYNTAX, 12, "0,5"},
    {BYTES(HEADER POSITIONS "3 0 1 3\n"), GD_INDEX, 13, "vertex 3"},
    {BYTES(HEADER POSITIONS "3 0 1 -1\n"), GD_INDEX, 13, "vertex -1"},
    {BYTES(HEADER POSITIONS "3 0 1 1.5\n"), GD_SYNTAX, 13, "1.5"},
    {BYTES(HEADER POSITIONS "3 0 1 nan\n"), GD_SYNTAX, 13, NULL},
    {BYTES(HEADER POSITIONS "3 0 1 1e99\n"), GD_INDEX, 13, NULL},
    {BYTES(HEADER POSITIONS "-3 0 1 2\n"), GD_SYNTAX, 13, "length of a list is -3"},
    {BYTES(HEADER POSITIONS "2.5 0 1 2\n"), GD_SYNTAX, 13, "2.5"},
    {BYTES(HEADER POSITIONS "nan 0 1 2\n"), GD_SYNTAX, 13, NULL},
    {BYTES(HEADER POSITIONS "5000000000 0 1 2\n"), GD_SYNTAX, 13, NULL},
    {BYTES(HEADER POSITIONS "4 0 1 2"), GD_TRUNCATED, 13, NULL},
};

static const struct bad_input bad_binary[] = {
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS "\4" O4 O4 O4), GD_TRUNCATED, 0,
     "within a record"},
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS "\2" O4 O4 O4), GD_SYNTAX, 0, "2 corners"},
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS "\3" O4 O4 "\3\0\0\0"), GD_INDEX, 0,
     "byte 205: a face refers to vertex 3"},
    {BYTES(LITTLE VERTEX FACE END LITTLE_POSITIONS "\3" O4 O4 "\xff\xff\xff\xff"), GD_INDEX, 0,
     "vertex -1"},
    {BYTES(LITTLE VERTEX FACE END "\0\0\xc0\x7f" O4 O4 O4 O4 O4 O4 O4 O4 LITTLE_TRIANGLE),
     GD_NON_FINITE, 0, "vertex 0"},
    {BYTES(LITTLE VERTEX FACE "property list int int y\n" END LITTLE_POSITIONS LITTLE_TRIANGLE
                              "\xff\xff\xff\x7f"),
     GD_TRUNCATED, 0, NULL},
    {BYTES(LITTLE VERTEX FACE "property list int int y\n" END LITTLE_POSITIONS LITTLE_TRIANGLE
                              "\xff\xff\xff\xff"),
     GD_SYNTAX, 0, "-1"},
};

static void reads_good_input(void **state)
{
    (void)state;
    check_good(GD_FORMAT_PLY, good, COUNT_OF(good));
}

static void refuses_bad_headers(void **state)
{
    (void)state;
    check_bad(GD_FORMAT_PLY, bad_headers, COUNT_OF(bad_headers));
}

static void refuses_bad_text(void **state)
{
    (void)state;
    check_bad(GD_FORMAT_PLY, bad_text, COUNT_OF(bad_text));
}

static void refuses_bad_binary(void **state)
{
    (void)state;
    check_bad(GD_FORMAT_PLY, bad_binary, COUNT_OF(bad_binary));
}

static void survives_truncation(void **state)
{
    (void)state;
    check_truncations(GD_FORMAT_PLY, good, COUNT_OF(good));
    check_truncations(GD_FORMAT_PLY, good_strips, COUNT_OF(good_strips));
}

static void reads_strips(void **state)
{
    (void)state;
    check_good(GD_FORMAT_PLY, good_strips, COUNT_OF(good_strips));
    check_bad(GD_FORMAT_PLY, bad_strips, COUNT_OF(bad_strips));
}

static void skips_ignored_content(void **state)
{
    (void)state;
    check_skipped(GD_FORMAT_PLY, skipped, COUNT_OF(skipped));
}

/* Reads a file whose header repeats `line` `count` times after its first element. */
static enum gd_status read_repeated(const char *line, int count)
{
    char *text = NULL;
    size_t size;
    FILE *stream = open_memstream(&text, &size);
    fputs(ASCII "element thing 0\n", stream);
    for (int i = 0; i < count; i++) fputs(line, stream);
    fputs(VERTEX FACE END POSITIONS "3 0 1 2\n", stream);
    fclose(stream);
    struct gd_polygons polygons = {0};
    enum gd_status status = read_copy(text, size, GD_FORMAT_PLY, NULL, &polygons, NULL);
    gd_polygons_free(&polygons);
    free(text);
    return status;
}

static void bounds_the_header(void **state)
{
    (void)state;
    assert_int_equal(read_repeated("property int a\n", 508), GD_OK);
    assert_int_equal(read_repeated("property int a\n", 509), GD_UNSUPPORTED);
    assert_int_equal(read_repeated("element thing 0\n", 29), GD_OK);
    assert_int_equal(read_repeated("element thing 0\n", 30), GD_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_good_input),    cmocka_unit_test(refuses_bad_headers),
        cmocka_unit_test(refuses_bad_text),    cmocka_unit_test(refuses_bad_binary),
        cmocka_unit_test(survives_truncation), cmocka_unit_test(bounds_the_header),
        cmocka_unit_test(reads_strips),        cmocka_unit_test(skips_ignored_content),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
