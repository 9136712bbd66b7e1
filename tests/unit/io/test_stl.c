#include "tests/unit/io/reader_tests.h"

#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"

#define FACET(a, b, c)                                                                             \
    "facet normal 0 0 1\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet"  \
    "\n"
#define TRIANGLE FACET("0 0 0", "1 0 0", "0 1 0")

#define SPACES_20       "                    "
#define HEADER_80       SPACES_20 SPACES_20 SPACES_20 SPACES_20
#define SOLID_80        "solid of binary kind" SPACES_20 SPACES_20 SPACES_20
#define O4              "\0\0\0\0"
#define ONE             "\0\0\x80\x3f"
#define MINUS_ZERO      "\0\0\0\x80"
#define NORMAL          O4 O4 ONE
#define CORNERS         O4 O4 O4 ONE O4 O4 O4 ONE O4
#define BINARY_TRIANGLE NORMAL CORNERS "\0\0"

static const struct good_input good[] = {
    {BYTES("solid\n" TRIANGLE "endsolid\n"), TRIANGLE_MESH},
    {BYTES("solid a name with words\n" TRIANGLE "endsolid a name with words\n"), TRIANGLE_MESH},
    {BYTES("solid\n" TRIANGLE "endsolid"), TRIANGLE_MESH},
    {BYTES("\n \tSOLID x\nFacet Normal nan -nan(ind) 0\nOUTER LOOP\nVERTEX 0 0 0\n  vertex +1 0 "
           "0\nVertex 0 1.0E0 "
           "0\nEndLoop\n"
           "endFacet\nEndSolid\n"),
     TRIANGLE_MESH},
    {BYTES("solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
           "endfacet endsolid\n"),
     TRIANGLE_MESH},
    {BYTES("\xEF\xBB\xBFsolid\r\nfacet normal 0 0 1\r\nouter loop\r\nvertex 0 0 0\r\nvertex 1 0 "
           "0\r\nvertex 0 1 "
           "0\r\nendloop\r\n"
           "endfacet\r\nendsolid\r\n"),
     TRIANGLE_MESH},
    {BYTES("solid a\n" TRIANGLE
           "endsolid a\nsolid b\n" FACET("1 0 0", "1 1 0", "0 1 0") "endsolid b\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 2; 1 3 2"},
    {BYTES("solid\n" FACET("0 0 0", "1 0 0", "0 1 -0")
               FACET("-0 1 0", "0 -0 0.0", "16777217 0.1 0") "endsolid\n"),
     "0 0 0; 1 0 0; 0 1 -0; 16777217 0.10000000000000001 0 | 0 1 2; 2 0 3"},
    {BYTES("solid\n" FACET("0 0 0", "0 0 5e-324", "0 0 1e-323") "endsolid\n"),
     "0 0 0; 0 0 4.9406564584124654e-324; 0 0 9.8813129168249309e-324 | 0 1 2"},
    {BYTES(HEADER_80 "\1\0\0\0" BINARY_TRIANGLE), TRIANGLE_MESH},
    {BYTES(SOLID_80 "\1\0\0\0" BINARY_TRIANGLE), TRIANGLE_MESH},
    {BYTES(HEADER_80 "\1\0\0\0" BINARY_TRIANGLE "trailing"), TRIANGLE_MESH},
    {BYTES(SOLID_80 "\1\0\0\0" BINARY_TRIANGLE "trailing"), TRIANGLE_MESH}, /* NULs in the count */
    {BYTES(HEADER_80 "\2\0\0\0" BINARY_TRIANGLE NORMAL MINUS_ZERO ONE MINUS_ZERO
                     "\xcd\xcc\xcc\x3d" O4 O4 ONE O4 O4 "ab"),
     "0 0 0; 1 0 0; 0 1 0; 0.10000000149011612 0 0 | 0 1 2; 2 3 1"},
};

static const struct bad_input bad[] = {
    {BYTES("hello"), GD_TRUNCATED, 5, "neither"},
    {BYTES(HEADER_80), GD_TRUNCATED, 80, NULL},
    {BYTES(HEADER_80 O4), GD_EMPTY, 0, NULL},
    {BYTES(HEADER_80 "\2\0\0\0" BINARY_TRIANGLE), GD_TRUNCATED, 80,
     "2 triangles are declared, but only 50 bytes follow"},
    {BYTES(HEADER_80 "\xff\xff\xff\xff" BINARY_TRIANGLE), GD_TRUNCATED, 80, "4294967295 triangles"},
    {BYTES(SOLID_80 "\2\0\0\0" BINARY_TRIANGLE), GD_TRUNCATED, 80, NULL},
    {BYTES(HEADER_80 "\1\0\0\0" NORMAL "\0\0\x80\x7f" O4 O4 ONE O4 O4 O4 ONE O4 "\0\0"),
     GD_NON_FINITE, 84, "byte 84"},
    {BYTES(HEADER_80 "\1\0\0\0" NORMAL "\0\0\xc0\xff" O4 O4 ONE O4 O4 O4 ONE O4 "\0\0"),
     GD_NON_FINITE, 84, NULL},
    {BYTES("solid"), GD_TRUNCATED, 1, NULL},
    {BYTES("solid\nendsolid\n"), GD_EMPTY, 0, NULL},
    {BYTES("solid\n" TRIANGLE), GD_TRUNCATED, 9, "facet or endsolid"},
    {BYTES("solid\n" TRIANGLE "endsolid\nsomething\n"), GD_SYNTAX, 10,
     "found 'something' where solid"},
    {BYTES("solid\ntriangle\nendsolid\n"), GD_SYNTAX, 2, "'triangle'"},
    {BYTES("solid\nfacet normal 0 0 1\nvertex 0 0 0\n"), GD_SYNTAX, 3, "outer"},
    {BYTES("solid\nfacet normal 0 0 1\nouter\nvertex 0 0 0\n"), GD_SYNTAX, 4, "loop"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n"), GD_SYNTAX, 4,
     "the line ends"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 a\nvertex 1 0 0\n"), GD_SYNTAX, 4,
     "'a'"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0x1\nvertex 1 0 0\n"), GD_SYNTAX, 4,
     NULL},
    {BYTES("solid\n" FACET("0 0 0", "nan 0 0", "0 1 0") "endsolid\n"), GD_NON_FINITE, 5, NULL},
    {BYTES("solid\n" FACET("0 0 0", "1 -inf 0", "0 1 0") "endsolid\n"), GD_NON_FINITE, 5, NULL},
    {BYTES("solid\n" FACET("0 0 0", "1 0 0", "0 1 1e999") "endsolid\n"), GD_NON_FINITE, 6, NULL},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 "
           "0\nendloop\nendfacet\nendsolid\n"),
     GD_SYNTAX, 6, "vertex"},
    {BYTES("solid\n" FACET("0 0 0", "1 0 0", "0 1 0\nvertex 1 1 0") "endsolid\n"), GD_SYNTAX, 7,
     "endloop"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
           "0\nendfacet\nendsolid\n"),
     GD_SYNTAX, 7, "endloop"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
           "0\nendloop\nendsolid\n"),
     GD_SYNTAX, 8, "endfacet"},
    {BYTES("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0 1\nvertex 1 0 0\n"), GD_SYNTAX, 4,
     "found '1'"},
};

int main(void)
{
    struct reader reader = {GD_FORMAT_STL, good, COUNT_OF(good), bad, COUNT_OF(bad)};
    const struct CMUnitTest tests[] = {READER_TESTS(&reader)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
