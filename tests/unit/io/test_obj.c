#include "tests/support/two_threads.h"
#include "tests/unit/io/reader_tests.h"

#define TRIANGLE      "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define TRIANGLE_MESH "0 0 0; 1 0 0; 0 1 0 | 0 1 2"

static const struct good_input good[] = {
    {BYTES(TRIANGLE "f 1 2 3\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f 1 2 3"), TRIANGLE_MESH},
    {BYTES("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n"), TRIANGLE_MESH},
    {BYTES("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r"), TRIANGLE_MESH},
    {BYTES("\xEF\xBB\xBF" TRIANGLE "f 1 2 3\n"), TRIANGLE_MESH},
    {BYTES("# comment\n\n  \t\n" TRIANGLE "# f 9 9 9\nf 1 2 3 # the only one\n"), TRIANGLE_MESH},
    {BYTES("mtllib /no/such/file.mtl\no x\ng y\ns off\nusemtl z\nunknown words 1 2\n" TRIANGLE
           "vt 0 0\nvn 0 0 1\nl 1 2\nf 1 2 3\n"),
     TRIANGLE_MESH},
    {BYTES(TRIANGLE "f 1/1 2/2 3/3\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f 1//1 2//1 3//1\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f 1/4/1 2/-5/1 3/6/-1\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f -3 -2 -1\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f -3//-3 -2//-2 -1//-1\n"), TRIANGLE_MESH},
    {BYTES("f 1 2 3\n" TRIANGLE), TRIANGLE_MESH},
    {BYTES("v 0 0 0 1.0\nv 1 0 0 255 0 0\nv 0 1 0 0.5 0.5 0.5 1\nf 1 2 3\n"), TRIANGLE_MESH},
    {BYTES("v 0 \\\n0 0\nv 1 0\\\r\n 0\nv 0 1 0\nf\\\n1 2 \\\n  3\n"), TRIANGLE_MESH},
    {BYTES(TRIANGLE "f 1\\\n 2/4\\\r\n\t3\\\r\n"), TRIANGLE_MESH},
    {BYTES("g a \\\nv 9 9 9\n" TRIANGLE "f 1 2 3\n"), TRIANGLE_MESH},
    {BYTES("# a path C:\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), TRIANGLE_MESH},
    {BYTES("\tv\t0 0 0\n v 1 0 0\nv 0 1 0\nf  1  2  3  \n"), TRIANGLE_MESH},
    {BYTES("v +0 0. .0\nv 1e0 0e5 -0\nv 0 10.0E-1 0\nf 1 2 3\n"), "0 0 0; 1 0 -0; 0 1 0 | 0 1 2"},
    {BYTES(TRIANGLE "v 1 1 0\nf 1 2 4 3\n"), "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 3 2"},
    {BYTES(TRIANGLE "v 1 1 0\nf 1 2 3\nf 2 4 3 1\nf 1 2 4\n"),
     "0 0 0; 1 0 0; 0 1 0; 1 1 0 | 0 1 2; 1 3 2 0; 0 1 3"},
    /* degenerate faces are left to the mesh builder, which refuses them */
    {BYTES(TRIANGLE "f 1 1 1\n"), "0 0 0; 1 0 0; 0 1 0 | 0 0 0"},
    {BYTES("v 16777217 0.1 1e-320\nv 1.7976931348623157e308 123456789012345678901234567890 "
           "1e-400\nv 0 1 0\nf 1 2 3\n"),
     "16777217 0.10000000000000001 9.9998886718268301e-321; 1.7976931348623157e+308 "
     "1.2345678901234568e+29 0; 0 1 0 | "
     "0 1 2"},
};

static const struct skipped_input skipped[] = {
    {BYTES(TRIANGLE "f\nf 1 2 3\nf 1// 2//\n"), TRIANGLE_MESH, 2, 4},
};

static void skips_ignored_content(void **state)
{
    (void)state;
    check_skipped(GD_FORMAT_OBJ, skipped, COUNT_OF(skipped));
}

static const struct bad_input bad[] = {
    {BYTES("v 1.#INF 0 0\n"), GD_NON_FINITE, 1, "'1.#INF' is not a finite number"},
    {BYTES("v 0 0 0\nv 0 0 -1.#QNAN\n"), GD_NON_FINITE, 2, "'-1.#QNAN'"},
    {BYTES("v 0 0 1.#\n"), GD_NON_FINITE, 1, NULL},
    {BYTES("# nothing\n"), GD_EMPTY, 0, "no faces"},
    {BYTES(TRIANGLE), GD_EMPTY, 0, "no faces"},
    {BYTES("\0\0\0\0"), GD_EMPTY, 0, NULL},
    {BYTES("v 0 0\nf 1 1 1\n"), GD_SYNTAX, 1, "line 1: the line ends where a number should be"},
    {BYTES("v 0 0 0\nv 1 0 x\n"), GD_SYNTAX, 2, "found 'x'"},
    {BYTES("v 0 0 1"
           "\0"
           "\n"),
     GD_EMPTY, 0, NULL},
    {BYTES("v 0 0"), GD_TRUNCATED, 1, NULL},
    {BYTES("v\n"), GD_SYNTAX, 1, NULL},
    {BYTES("v 0x1p3 0 0\n"), GD_SYNTAX, 1, "found '0x1p3'"},
    {BYTES("v 1,5 0 0\n"), GD_SYNTAX, 1, "'1,5'"},
    {BYTES("v 0 0 1,5\n"), GD_SYNTAX, 1, "'1,5'"},
    {BYTES("v 1.5.2 0 0\n"), GD_SYNTAX, 1, "1.5.2"},
    {BYTES("v 1e 0 0\n"), GD_SYNTAX, 1, NULL},
    {BYTES("v +-1 0 0\n"), GD_SYNTAX, 1, NULL},
    {BYTES("v 0 nan 0\n"), GD_NON_FINITE, 1, "vertex 1"},
    {BYTES("v 0 0 0\nv 0 -Inf 0\n"), GD_NON_FINITE, 2, "vertex 2"},
    {BYTES("v 0 0 1e999\n"), GD_NON_FINITE, 1, NULL},
    {BYTES("v 0 0 -1.8e308\n"), GD_NON_FINITE, 1, NULL},
    {BYTES(TRIANGLE "f\n"), GD_SYNTAX, 4, "0 corners"},
    {BYTES(TRIANGLE "f 1 2\n"), GD_SYNTAX, 4,
     "line 4: a face has 2 corners; it needs at least three"},
    {BYTES(TRIANGLE "f 1 2 3.5\n"), GD_SYNTAX, 4, "3.5"},
    {BYTES(TRIANGLE "f 1 2 a\n"), GD_SYNTAX, 4, "'a'"},
    {BYTES(TRIANGLE "f 1 2/x 3\n"), GD_SYNTAX, 4, "'x'"},
    {BYTES(TRIANGLE "f 1 2 3x\n"), GD_SYNTAX, 4, NULL},
    {BYTES(TRIANGLE "f /1 2 3\n"), GD_SYNTAX, 4, NULL},
    {BYTES(TRIANGLE "f 0 1 2\n"), GD_INDEX, 4, "vertex 0"},
    {BYTES(TRIANGLE "f 1 2 4\n"), GD_INDEX, 4,
     "line 4: a face refers to vertex 4, but there are only 3"},
    {BYTES(TRIANGLE "\n\n# x\r\nf 1 2 9\nf 1 2 3\n"), GD_INDEX, 7, "vertex 9"},
    {BYTES("f 1 2 3\nv 0 0 0\nv 1 0 0\n"), GD_INDEX, 1, "vertex 3"},
    {BYTES(TRIANGLE "f 1 2 -4\n"), GD_INDEX, 4, "vertex -4"},
    {BYTES("f -1 -2 -3\n" TRIANGLE), GD_INDEX, 1, NULL},
    {BYTES(TRIANGLE "f 1 2 4294967296\n"), GD_INDEX, 4, "vertex 4294967296"},
    {BYTES(TRIANGLE "f 1 2 4294967298\n"), GD_INDEX, 4, NULL},
    {BYTES(TRIANGLE "f 1 2 18446744073709551617\n"), GD_INDEX, 4, NULL},
    {BYTES(TRIANGLE "f 1 2 -99999999999999999999\n"), GD_INDEX, 4, NULL},
    {BYTES(TRIANGLE "f 1 2 \\\n\\\n9\n"), GD_INDEX, 6, NULL},
};

/* --- two threads ------------------------------------------------------------------------------ */

#define LINES 200000 /* of each kind; the text has about 12 MB and is read in parts */

/* Returns a long text, which the caller frees. `extra` is inserted in the middle of the faces. */
static char *long_text(const char *extra, size_t *size)
{
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    assert_non_null(stream);
    for (unsigned i = 0; i < LINES; i++)
        if (i % 100 == 7)
            fprintf(stream, "# comment \\\nv \\\r\n  %u 1 \\\n 2\n", i);
        else
            fprintf(stream, "v %u.25 %u -1.0625e-3\n", i, i % 77);
    for (unsigned i = 0; i < LINES; i++) {
        if (i == LINES / 2) fprintf(stream, "%s", extra);
        fprintf(stream, "f %u/1/1 \\\n %u/2/2 %u/3/3%s\n", i % (LINES - 9) + 1, i / 2 + 1, i + 1,
                i % 1000 == 999 ? " 5" : "");
    }
    fclose(stream);
    return text;
}

struct reading {
    enum gd_status status;
    struct gd_polygons polygons;
    struct gd_detail detail;
    struct gd_mended skipped;
};

static struct reading read_long(const char *text, size_t size, struct gd_read_options options,
                                const struct gd_executor *executor)
{
    struct reading reading = {0};
    const struct gd_control control = {.executor = executor};
    options.format = GD_FORMAT_OBJ;
    options.control = &control;
    if (options.skipped) options.skipped = &reading.skipped;
    reading.status = gd_read_polygons(text, size, &options, &reading.polygons, &reading.detail);
    return reading;
}

static void check_equal(const struct gd_polygons *a, const struct gd_polygons *b)
{
    assert_int_equal(a->position_count, b->position_count);
    assert_int_equal(a->polygon_count, b->polygon_count);
    assert_memory_equal(a->positions, b->positions, a->position_count * sizeof *a->positions);
    assert_memory_equal(a->corners, b->corners, gd_polygons_corner_count(a) * sizeof *a->corners);
    assert_int_equal(a->first == NULL, b->first == NULL);
    if (a->first)
        assert_memory_equal(a->first, b->first, (a->polygon_count + 1) * sizeof *a->first);
}

/* Two threads read the same polygons and report the same errors as one thread. */
static void two_threads_read_the_same(void **state)
{
    struct gd_mended wanted;
    const struct {
        const char *extra;
        enum gd_status status;
        struct gd_read_options options;
    } cases[] = {
        {"", GD_OK, {0}},
        {"f -1 -2 -3\n", GD_OK, {0}},
        {"f 1 2\n", GD_OK, {.skipped = &wanted}},
        {"f 1 2\n", GD_SYNTAX, {0}},
        {"v 1 x 2\n", GD_SYNTAX, {0}},
        {"v 1 1e999 2\n", GD_NON_FINITE, {0}},
        {"f 1 2 9999999\n", GD_INDEX, {0}},
        {"f 1 2 -9999999\n", GD_INDEX, {0}},
        {"", GD_TOO_LARGE, {.max_faces = LINES - 5}},
        {"v 1 2 3\n", GD_TOO_LARGE, {.max_vertices = LINES}},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        size_t size;
        char *text = long_text(cases[i].extra, &size);
        struct reading one = read_long(text, size, cases[i].options, NULL);
        struct reading two = read_long(text, size, cases[i].options, &two_threads);
        assert_int_equal(one.status, cases[i].status);
        assert_int_equal(two.status, cases[i].status);
        assert_string_equal(one.detail.text, two.detail.text);
        assert_memory_equal(&one.skipped, &two.skipped, sizeof one.skipped);
        if (!one.status) check_equal(&one.polygons, &two.polygons);
        gd_polygons_free(&one.polygons);
        gd_polygons_free(&two.polygons);
        free(text);
    }
}

struct reports {
    unsigned count, stop_at;
    double last;
    pthread_t caller;
};

static bool note_report(void *user, double fraction)
{
    struct reports *reports = user;
    assert_true(pthread_equal(pthread_self(), reports->caller));
    assert_true(fraction >= reports->last && fraction <= 1);
    reports->last = fraction;
    return ++reports->count != reports->stop_at;
}

/* The reader reports progress on the calling thread. The progress never decreases, even if the
 * reader reads a part of the text again, beginning at an error. The reader stops at the report that
 * cancels it. */
static void two_threads_report_and_end(void **state)
{
    size_t size;
    char *text = long_text("f -1 -2 -3\n", &size);
    (void)state;
    for (unsigned stop_at = 0; stop_at < 20; stop_at++) {
        struct reports reports = {.stop_at = stop_at, .caller = pthread_self()};
        struct gd_control control = {
            .progress = note_report, .user = &reports, .executor = &two_threads};
        struct gd_polygons polygons = {0};
        enum gd_status status = gd_read_polygons(
            text, size, &(struct gd_read_options){.control = &control}, &polygons, NULL);
        assert_int_equal(status, stop_at ? GD_CANCELLED : GD_OK);
        if (stop_at) assert_int_equal(reports.count, stop_at);
        gd_polygons_free(&polygons);
    }
    free(text);
}

int main(void)
{
    struct reader reader = {GD_FORMAT_OBJ, good, COUNT_OF(good), bad, COUNT_OF(bad)};
    const struct CMUnitTest tests[] = {
        READER_TESTS(&reader), cmocka_unit_test(skips_ignored_content),
        cmocka_unit_test(two_threads_read_the_same), cmocka_unit_test(two_threads_report_and_end)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
