#include "tests/unit/io/reader_tests.h"

#define VERTICES      "\"vertices\":[[0,0,0],[1,0,0],[0,1,0]]"
#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"

/* A document with three vertices and this face list, which begins at byte 47. */
#define WITH_FACES(faces) BYTES("{" VERTICES ", \"faces\":" faces "}")

/* A document with this first coordinate, which begins at byte 14. */
#define WITH_X(x) BYTES("{\"vertices\":[[" x ",0,0],[1,0,0],[0,1,0]],\"faces\":[[0,1,2]]}")

static const struct good_input good[] = {
    {WITH_FACES("[[0,1,2]]"), TRIANGLE_MESH},
    {BYTES("{\"faces\":[[0,1,2]]," VERTICES "}"), TRIANGLE_MESH},
    {BYTES(" {\n\t\"vertices\" : [ [ 0 , 0 , 0 ] ,\r\n [1,0,0], [0,1,0] ] , \"faces\" : [ [ 0 , 1 "
           ", 2 ] ] }\n \t\r"),
     TRIANGLE_MESH},
    {BYTES("\xEF\xBB\xBF{" VERTICES ",\"faces\":[[0,1,2]]}"), TRIANGLE_MESH},
    {WITH_FACES("[[0,1.0,20e-1]]"), TRIANGLE_MESH},
    {WITH_FACES("[[0,1,2],[2,1,0,1],[0,2,1]]"), "0 0 0; 1 0 0; 0 1 0 | 0 1 2; 2 1 0 1; 0 2 1"},
    {WITH_X("16777217"), "16777217 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {WITH_X("-1.5E+2"), "-150 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {WITH_X("0.1"), "0.10000000000000001 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {WITH_X("1e-999"), "0 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {WITH_X("-0"), "-0 0 0; 1 0 0; 0 1 0 | 0 1 2"},
    {BYTES("{\"\\u0076\\u0065rtices\":[[0,0,0],[1,0,0],[0,1,0]],\"\\u0066ac\\u0065\\u0073\":[[0,1,"
           "2]]}"),
     TRIANGLE_MESH},
};

static const struct bad_input bad[] = {
    {BYTES("[]"), GD_SYNTAX, 0, "'{'"},
    {BYTES("{"), GD_TRUNCATED, 1, NULL},
    {BYTES("{}"), GD_SYNTAX, 2, "the key \"vertices\" is missing"},
    {BYTES("{" VERTICES "}"), GD_SYNTAX, 0, "the key \"faces\" is missing"},
    {BYTES("{" VERTICES ",}"), GD_SYNTAX, 0, "a key"},
    {BYTES("{" VERTICES "," VERTICES "}"), GD_SYNTAX, 0, "\"vertices\" appears twice; remove"},
    {BYTES("{" VERTICES ",\"\\u0076ertices\":[]}"), GD_SYNTAX, 0, "appears twice"},
    {BYTES("{\"\\u0066a\\u0063\":[]}"), GD_SYNTAX, 1, "unknown key"},
    {BYTES("{\"\\U0066aces\":[]}"), GD_SYNTAX, 1, "unknown key"},
    {BYTES("{\"face\\u007\":[]}"), GD_SYNTAX, 1, "unknown key"},
    {BYTES("{\"faces\\u0000\":[]}"), GD_SYNTAX, 1, "unknown key"},
    {BYTES("{\"colour\":[]}"), GD_SYNTAX, 1, "unknown key \"colour\""},
    {BYTES("{\"\xC3\xA4\":[]}"), GD_SYNTAX, 1,
     "unknown key \"?"
     "?\""},
    {BYTES("{\"a\\\"b\":[]}"), GD_SYNTAX, 1, "unknown key \"a\\\"b\""},
    {BYTES("{\"a\nb\":[]}"), GD_SYNTAX, 3, NULL},
    {BYTES("{\"vertices"), GD_TRUNCATED, 0, NULL},
    {BYTES("{\"a\\"), GD_TRUNCATED, 4, NULL},
    {BYTES("{vertices:[]}"), GD_SYNTAX, 1, "a key"},
    {BYTES("{\"vertices\" []}"), GD_SYNTAX, 12, "':'"},
    {BYTES("{\"vertices\":{}}"), GD_SYNTAX, 12, "'['"},
    {BYTES("{\"vertices\":null}"), GD_SYNTAX, 12, "null"},
    {BYTES("{\"vertices\":[[0,0]],\"faces\":[]}"), GD_SYNTAX, 17, "','"},
    {BYTES("{\"vertices\":[[0,0,0,0]],\"faces\":[]}"), GD_SYNTAX, 19, "']'"},
    {BYTES("{\"vertices\":[[0,0,0],],\"faces\":[]}"), GD_SYNTAX, 21, NULL},
    {BYTES("{\"vertices\":[0,0,0],\"faces\":[]}"), GD_SYNTAX, 13, NULL},
    {BYTES("{\"vertices\":[],\"faces\":[]}"), GD_EMPTY, 0, NULL},
    {WITH_FACES("[]"), GD_EMPTY, 0, NULL},
    {WITH_FACES("[[]]"), GD_SYNTAX, 48, "0 corners"},
    {WITH_FACES("[[0,1]]"), GD_SYNTAX, 48, "2 corners"},
    {WITH_FACES("[[0,1,1.5]]"), GD_SYNTAX, 53, "1.5"},
    {WITH_FACES("[[0,1,3]]"), GD_INDEX, 53, "vertex 3"},
    {WITH_FACES("[[0,1,-1]]"), GD_INDEX, 53, "vertex -1"},
    {WITH_FACES("[[0,1,1e300]]"), GD_INDEX, 53, NULL},
    {WITH_FACES("[[0,1,1e999]]"), GD_INDEX, 53, NULL},
    {WITH_FACES("[[0,1,\"2\"]]"), GD_SYNTAX, 53, "a JSON number"},
    {WITH_FACES("[[0,1,[2]]]"), GD_SYNTAX, 53, NULL},
    {WITH_FACES("[[[[[[[[[[[[[[[["), GD_SYNTAX, 49, NULL},
    {BYTES("{\"faces\":[[0,1,3]]," VERTICES "}"), GD_INDEX, 15, "only 3"},
    {BYTES("{" VERTICES ", \"faces\":[[0,1,2]]} x"), GD_SYNTAX, 0, "the end of the input"},
    {BYTES("{" VERTICES ", \"faces\":[[0,1,2]]}\0"), GD_SYNTAX, 0, "the end of the input"},
    {BYTES("{\0" VERTICES ", \"faces\":[[0,1,2]]}"), GD_SYNTAX, 1, NULL},
    {WITH_X("1e999"), GD_NON_FINITE, 13, "vertex 0"},
    {WITH_X("NaN"), GD_SYNTAX, 14, "NaN"},
    {WITH_X("Infinity"), GD_SYNTAX, 14, NULL},
    {WITH_X("+1"), GD_SYNTAX, 14, NULL},
    {WITH_X("01"), GD_SYNTAX, 14, NULL},
    {WITH_X(".5"), GD_SYNTAX, 14, NULL},
    {WITH_X("5."), GD_SYNTAX, 14, NULL},
    {WITH_X("1e"), GD_SYNTAX, 14, NULL},
    {WITH_X("-"), GD_SYNTAX, 14, NULL},
    {WITH_X("0x10"), GD_SYNTAX, 15, NULL},
    {WITH_X("\v1"), GD_SYNTAX, 14, NULL},
    {WITH_X("1\0"), GD_SYNTAX, 15, NULL},
};

static void prefixes_are_truncated(void **state)
{
    (void)state; /* no proper prefix is a valid document, except before trailing spaces */
    for (size_t size = 1; size < good[0].size; size++) {
        struct gd_polygons polygons;
        assert_int_equal(read_copy(good[0].bytes, size, GD_FORMAT_JSON, NULL, &polygons, NULL),
                         GD_TRUNCATED);
    }
}

int main(void)
{
    struct reader reader = {GD_FORMAT_JSON, good, COUNT_OF(good), bad, COUNT_OF(bad)};
    const struct CMUnitTest tests[] = {READER_TESTS(&reader),
                                       cmocka_unit_test(prefixes_are_truncated)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
