#include "tests/unit/io/reader_tests.h"

#define VERTICES      "0 0 0\n1 0 0\n0 1 0\n"
#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"

static const struct good_input good[] = {
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2"), TRIANGLE_MESH},
    {BYTES("OFF 3 1 3\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n"), TRIANGLE_MESH},
    {BYTES("OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r"), TRIANGLE_MESH},
    {BYTES("\xEF\xBB\xBFOFF\n3 1 0\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("# before\nOFF # keyword\n# between\n3 1 0 # counts\n\n0 0 0 # a\n1 0 0\n\n# c\n0 1 "
           "0\n3 0 1 2 # face\n"),
     TRIANGLE_MESH},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2 255 0 0\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2 0.5 0.5 0.5 1\n"), TRIANGLE_MESH},
    {BYTES("COFF\n3 1 0\n0 0 0 1 2 3 4\n1 0 0 1 2 3\n0 1 0 1 2 3 4\n3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES(
         "CNOFF\n3 1 0\n0 0 0 0 0 1 1 1 1 1\n1 0 0 0 0 1 1 1 1 1\n0 1 0 0 0 1 1 1 1 1\n3 0 1 2\n"),
     TRIANGLE_MESH},
    {BYTES("STOFF\n3 1 0\n0 0 0 0 1\n1 0 0 0 1\n0 1 0 0 1\n3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("STCNOFF\n3 1 0\n0 0 0 0 1\n1 0 0 0 1\n0 1 0 0 1\n3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n4 1 0\n" VERTICES "1 1 0\n4 0 1 3 2\n"), "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 3 2"},
    {BYTES("OFF\n4 1 0\n" VERTICES "1 1 0\n4 0\n\n1 # one\n3 \n2 \n\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 3 2"},
    {BYTES(" \t\n  OFF3 1 0 # counts\n" VERTICES "3 0 1\n2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2\nwhat follows is not read\n"), TRIANGLE_MESH},
    /* the number of edges on its own line, or missing */
    {BYTES("OFF\n3\n1\n0\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1 # counts\n\n # edges\n 3 # here\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1\n" VERTICES "3 0 1 2\n"), TRIANGLE_MESH},
    {BYTES("OFF\n3 1 0\n0.1 16777217 -0\n1e-320 0 0\n0 1 0\n3 2 1 0\n"),
     "0.10000000000000001 16777217 -0; 9.9998886718268301e-321 0 0; 0 1 0 | 2 1 0"},
};

static const struct bad_input bad[] = {
    {BYTES("OF\n3 1 0\n"), GD_SYNTAX, 1, "OFF"},
    {BYTES("off\n3 1 0\n" VERTICES "3 0 1 2\n"), GD_SYNTAX, 1, NULL},
    {BYTES("3 1 0\n" VERTICES "3 0 1 2\n"), GD_SYNTAX, 1, "keyword OFF"},
    {BYTES("# only a comment\n"), GD_TRUNCATED, 2, NULL},
    {BYTES("OFF"), GD_TRUNCATED, 1, NULL},
    {BYTES("OFF BINARY\n3 1 0\n"), GD_UNSUPPORTED, 1, "binary OFF"},
    {BYTES("COFF BINARY\n3 1 0\n"), GD_UNSUPPORTED, 1, "binary OFF"},
    {BYTES("4OFF\n3 1 0\n"), GD_UNSUPPORTED, 1, "three dimensions"},
    {BYTES("nOFF\n3\n3 1 0\n"), GD_UNSUPPORTED, 1, NULL},
    {BYTES("OFF\n3\n"), GD_TRUNCATED, 3, NULL},
    {BYTES("OFF\nthree 1 0\n"), GD_SYNTAX, 2, "'three'"},
    {BYTES("OFF\n3.0 1 0\n" VERTICES "3 0 1 2\n"), GD_SYNTAX, 2, NULL},
    {BYTES("OFF\n-3 1 0\n" VERTICES "3 0 1 2\n"), GD_SYNTAX, 2, "negative"},
    {BYTES("OFF\n4000000000 1 0\n" VERTICES "3 0 1 2\n"), GD_TRUNCATED, 2, "4000000000 vertices"},
    {BYTES("OFF\n3 4000000000 0\n" VERTICES "3 0 1 2\n"), GD_TRUNCATED, 2, "26 bytes follow"},
    {BYTES("OFF\n99999999999999999999 1 0\n" VERTICES "3 0 1 2\n"), GD_TRUNCATED, 2, NULL},
    {BYTES("OFF\n3074457345618258603 1 0\n" VERTICES "3 0 1 2\n"), GD_TRUNCATED, 2, NULL},
    {BYTES("OFF\n4 2 0\n" VERTICES "0\n"), GD_TRUNCATED, 2, NULL},
    {BYTES("OFF\n4 1 0\n" VERTICES "3 0 1 2\n"), GD_TRUNCATED, 7, "the input ends"},
    {BYTES("OFF\n3 0 0\n" VERTICES), GD_EMPTY, 0, NULL},
    {BYTES("OFF\n0 0 0\n"), GD_EMPTY, 0, NULL},
    {BYTES("OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), GD_SYNTAX, 3, "the line ends"},
    {BYTES("OFF\n3 1 0\n0 0 z\n1 0 0\n0 1 0\n3 0 1 2\n"), GD_SYNTAX, 3, "'z'"},
    {BYTES("OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"), GD_NON_FINITE, 3, "vertex 0"},
    {BYTES("OFF\n3 1 0\n0 0 0\n1 0 1e309\n0 1 0\n3 0 1 2\n"), GD_NON_FINITE, 4, "vertex 1"},
    {BYTES("OFF\n3 1 0\n" VERTICES "2 0 1\n"), GD_SYNTAX, 6, "2 corners"},
    {BYTES("OFF\n3 1 0\n" VERTICES "-3 0 1 2\n"), GD_SYNTAX, 6, "0 corners"},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 2.5\n"), GD_SYNTAX, 6, "2.5"},
    {BYTES("OFF\n3 1 0\n" VERTICES "4 0 1 2\n"), GD_TRUNCATED, 7, "the input ends"},
    {BYTES("OFF\n4 2 0\n" VERTICES "1 1 0\n4 0 1 2\n3 0 1 2\n"), GD_SYNTAX, 8,
     "the end of a face that began on another line"},
    {BYTES("OFFSET\n3 1 0\n" VERTICES "3 0 1 2\n"), GD_SYNTAX, 1, NULL},
    {BYTES("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 -1.#IND00\n3 0 1 2\n"), GD_NON_FINITE, 5,
     "'-1.#IND00' is not a finite number"},
    {BYTES("OFF\n3 1 0\n" VERTICES "9000000000000000000 0 1 2\n"), GD_TRUNCATED, 7, NULL},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 3\n"), GD_INDEX, 6,
     "vertex 3, but there are only 3, counted from 0"},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 -1\n"), GD_INDEX, 6, "vertex -1"},
    {BYTES("OFF\n3 1 0\n" VERTICES "3 0 1 4294967296\n"), GD_INDEX, 6, NULL},
};

static const struct skipped_input skipped[] = {
    {BYTES("OFF\n3 2 0\n" VERTICES "2 0 1\n3 0 1 2\n"), TRIANGLE_MESH, 1, 6},
    {BYTES("OFF\n3 4 0\n" VERTICES "0\n0\n3 0 1 2\n0"), TRIANGLE_MESH, 3, 6},
};

static void skips_ignored_content(void **state)
{
    (void)state;
    check_skipped(GD_FORMAT_OFF, skipped, COUNT_OF(skipped));
}

int main(void)
{
    struct reader reader = {GD_FORMAT_OFF, good, COUNT_OF(good), bad, COUNT_OF(bad)};
    const struct CMUnitTest tests[] = {READER_TESTS(&reader),
                                       cmocka_unit_test(skips_ignored_content)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
