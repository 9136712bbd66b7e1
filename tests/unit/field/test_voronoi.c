#include "tests/support/diagram.h"

#include <math.h>
#include <stdlib.h>

#include "tests/samples/samples.h"
#include "tests/support/field.h"
#include "tests/support/two_threads.h"
#include "tests/support/watch.h"

static const double promise = 1e-9;

enum { SEEDS_MOST = 12 };

/* Returns the diagram in which each seed is a member. */
static struct diagram diagram_of_seeds(const struct gd_mesh *mesh, struct member_set *set,
                                       const struct gd_seed *seeds, uint32_t count,
                                       double tolerance)
{
    *set = (struct member_set){0};
    for (uint32_t i = 0; i < count; i++) member_set_put_point(set, seeds[i].point, seeds[i].offset);
    return diagram_of(mesh, set, tolerance);
}

static void free_diagram(struct diagram *diagram, struct member_set *set)
{
    diagram_free(diagram);
    member_set_free(set);
}

/* --- closed forms ----------------------------------------------------------------------------- */

static struct gd_mesh *square(uint32_t cells)
{
    struct gd_polygons polygons;
    check_ok(sample_grid(cells, cells, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* The bisector of two points of a plane is their perpendicular bisector, which is the line x = 1/2
 * or an inclined line. */
static void two_points_in_the_plane(void **state)
{
    (void)state;
    static const double places[][4] = {
        {0.2, 0.5, 0.8, 0.5},   {0.25, 0.5, 0.75, 0.5}, {0.31, 0.4, 0.69, 0.4},
        {0.0, 0.0, 1.0, 0.0},   {0.0, 0.0, 1.0, 1.0},   {0.5, 0.2, 0.5, 0.8},
        {0.1, 0.23, 0.7, 0.91}, {0.45, 0.5, 0.55, 0.5}, {0.499, 0.501, 0.501, 0.499}};
    for (uint32_t cells = 1; cells <= 8; cells++) {
        struct gd_mesh *mesh = square(cells);
        for (size_t s = 0; s < sizeof places / sizeof *places; s++) {
            const double *p = places[s];
            struct gd_seed seeds[2] = {{.point = test_point_near(mesh, p[0], p[1], 0)},
                                       {.point = test_point_near(mesh, p[2], p[3], 0)}};
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 2, 1e-3);
            check_diagram(&diagram);
            assert_int_equal(diagram.voronoi.bisector_count, 1);
            const struct gd_bisector *b = &diagram.voronoi.bisectors[0];
            for (uint32_t i = 0; i < b->point_count; i++) {
                struct gd_vec3 at = gd_point_position(mesh, &b->points[i]);
                double off = (at.x - 0.5 * (p[0] + p[2])) * (p[2] - p[0]) +
                             (at.y - 0.5 * (p[1] + p[3])) * (p[3] - p[1]);
                assert_true(fabs(off) < promise * hypot(p[2] - p[0], p[3] - p[1]));
            }
            if (s < 4 || s == 5) check_close(b->length, 1, promise);
            if (s == 4 || s == 8) check_close(b->length, sqrt(2), promise);
            free_diagram(&diagram, &set);
        }
        gd_mesh_release(mesh);
    }
}

/* Three cells meet at the circumcentre. */
static void three_points_in_the_plane(void **state)
{
    (void)state;
    static const double places[][8] = {{0.2, 0.2, 0.8, 0.2, 0.5, 0.8, 0.5, 0.425},
                                       {0.25, 0.25, 0.75, 0.25, 0.25, 0.75, 0.5, 0.5},
                                       {0.1, 0.5, 0.5, 0.9, 0.9, 0.5, 0.5, 0.5}};
    for (uint32_t cells = 1; cells <= 7; cells++) {
        struct gd_mesh *mesh = square(cells);
        for (size_t s = 0; s < sizeof places / sizeof *places; s++) {
            const double *p = places[s];
            struct gd_seed seeds[3] = {{.point = test_point_near(mesh, p[0], p[1], 0)},
                                       {.point = test_point_near(mesh, p[2], p[3], 0)},
                                       {.point = test_point_near(mesh, p[4], p[5], 0)}};
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 3, 1e-3);
            check_diagram(&diagram);
            assert_int_equal(diagram.voronoi.bisector_count, 3);
            struct gd_point centre = test_point_near(mesh, p[6], p[7], 0);
            assert_int_equal(diagram_ends_at(&diagram, &centre), 3);
            free_diagram(&diagram, &set);
        }
        gd_mesh_release(mesh);
    }
}

/* Four cells meet in the middle of a square. The middle lies in a face, on an edge or at a
 * vertex. */
static void four_corners_meet_in_the_middle(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 8; cells++) {
        struct gd_mesh *mesh = square(cells);
        for (int inset = 0; inset < 2; inset++) {
            double low = 0.25 * inset, high = 1 - low;
            struct gd_seed seeds[4] = {{.point = test_point_near(mesh, low, low, 0)},
                                       {.point = test_point_near(mesh, high, low, 0)},
                                       {.point = test_point_near(mesh, high, high, 0)},
                                       {.point = test_point_near(mesh, low, high, 0)}};
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 4, 1e-3);
            check_diagram(&diagram);
            check_close(diagram_length(&diagram), 2, 1e-7);
            free_diagram(&diagram, &set);
        }
        gd_mesh_release(mesh);
    }
}

/* If the members have different offsets, the bisector is a branch of a hyperbola. A member whose
 * offset is at least the distance between the seeds has no cell. */
static void offsets_bend_the_bisector(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 6; cells++) {
        struct gd_mesh *mesh = square(cells);
        for (int step = 0; step < 6; step++) {
            double offset = 0.11 * step;
            struct gd_seed seeds[2] = {
                {.point = test_point_near(mesh, 0.25, 0.5, 0), .offset = 0},
                {.point = test_point_near(mesh, 0.75, 0.5, 0), .offset = offset}};
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 2, 1e-5);
            if (offset < 0.5) check_diagram(&diagram);
            assert_int_equal(diagram.voronoi.bisector_count, offset < 0.5);
            for (uint32_t i = 0; offset < 0.5 && i < diagram.voronoi.bisectors[0].point_count;
                 i++) {
                struct gd_vec3 at =
                    gd_point_position(mesh, &diagram.voronoi.bisectors[0].points[i]);
                check_close(hypot(at.x - 0.25, at.y - 0.5), hypot(at.x - 0.75, at.y - 0.5) + offset,
                            promise);
            }
            free_diagram(&diagram, &set);
        }
        gd_mesh_release(mesh);
    }
}

/* Uses two opposite points of a surface that is symmetric about the plane between them. The
 * bisector lies in that plane. */
static void opposite_points_of_symmetric_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS], seeds[6], normal[3], through, length;
    } cases[] = {
        {"box", {1, 1, 1, 1}, {0.5, 0.5, 0, 0.5, 0.5, 1}, {0, 0, 1}, 0.5, 4},
        {"box", {1, 1, 1, 2}, {0.5, 0.5, 0, 0.5, 0.5, 1}, {0, 0, 1}, 0.5, 4},
        {"box", {1, 1, 1, 3}, {0, 0.5, 0.5, 1, 0.5, 0.5}, {1, 0, 0}, 0.5, 4},
        {"box", {1, 2, 3, 4}, {0.5, 1, 0, 0.5, 1, 3}, {0, 0, 1}, 1.5, 6},
        {"icosphere", {3, 1}, {0, 0, -2, 0, 0, 2}, {0, 0, 1}, 0, 0},
        {"icosphere", {2, 1}, {0, -2, 0, 0, 2, 0}, {0, 1, 0}, 0, 0},
    };
    for (size_t s = 0; s < sizeof cases / sizeof *cases; s++) {
        struct gd_polygons polygons;
        struct gd_mesh *mesh = test_sample(cases[s].name, cases[s].values, &polygons);
        const double *p = cases[s].seeds, *n = cases[s].normal;
        struct gd_seed seeds[2] = {{.point = test_point_near(mesh, p[0], p[1], p[2])},
                                   {.point = test_point_near(mesh, p[3], p[4], p[5])}};
        struct member_set set;
        struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 2, 1e-3);
        check_diagram(&diagram);
        assert_int_equal(diagram.voronoi.bisector_count, 1);
        const struct gd_bisector *b = &diagram.voronoi.bisectors[0];
        assert_true(b->closed);
        for (uint32_t i = 0; i < b->point_count; i++) {
            struct gd_vec3 at = gd_point_position(mesh, &b->points[i]);
            assert_true(fabs(at.x * n[0] + at.y * n[1] + at.z * n[2] - cases[s].through) < promise);
        }
        if (cases[s].length > 0) check_close(b->length, cases[s].length, promise);
        free_diagram(&diagram, &set);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* --- any surface ------------------------------------------------------------------------------ */

static void random_members_on_many_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {14, 0.8, 3}}, {"saddle", {1, 0.6, 6, 6}},
                    {"obstacles", {5, 1, 3}},  {"torus", {20, 10, 1, 0.4}},
                    {"tangle", {150, 11}},     {"cylinder", {0.1, 3, 16, 5}},
                    {"icosphere", {3, 1}},     {"genus2", {4, 0.2}},
                    {"tangle", {300, 5}},      {"tetrahedron", {1, 2}}};
    uint32_t bisectors = 0;
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        for (uint64_t trial = 0; trial < 6; trial++) {
            struct gd_polygons polygons;
            struct gd_mesh *mesh = test_sample(surfaces[s].name, surfaces[s].values, &polygons);
            struct rng rng = {s + 100 * trial};
            uint32_t count = 2 + rng_below(&rng, SEEDS_MOST - 1);
            struct gd_seed seeds[SEEDS_MOST] = {0};
            for (uint32_t i = 0; i < count; i++) {
                seeds[i].point = test_point(mesh, test_random_place(&polygons, &rng));
                seeds[i].offset = trial % 2 ? rng_between(&rng, 0, 0.1) : 0;
            }
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, count, 1e-3);
            check_diagram(&diagram);
            bisectors += diagram.voronoi.bisector_count;
            free_diagram(&diagram, &set);
            gd_mesh_release(mesh);
            gd_polygons_free(&polygons);
        }
    }
    assert_true(bisectors > 200);
}

/* --- what is omitted or refused --------------------------------------------------------------- */

static void members_without_a_region(void **state)
{
    (void)state;
    struct gd_mesh *mesh = square(4);
    struct gd_point left = test_point_near(mesh, 0.2, 0.4, 0),
                    right = test_point_near(mesh, 0.8, 0.4, 0);
    struct gd_seed seeds[5] = {{.point = left, .offset = 0.1},
                               {.point = left},
                               {.point = left},
                               {.point = right},
                               {.point = right}};
    struct member_set set;
    struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, 5, 1e-3);
    check_diagram(&diagram);
    assert_int_equal(diagram.voronoi.bisector_count, 1);
    assert_int_equal(diagram.voronoi.bisectors[0].members[0], 1);
    assert_int_equal(diagram.voronoi.bisectors[0].members[1], 3);
    free_diagram(&diagram, &set);
    diagram = diagram_of_seeds(mesh, &set, seeds, 3, 1e-3);
    check_diagram(&diagram);
    assert_int_equal(diagram.voronoi.bisector_count, 0);
    free_diagram(&diagram, &set);
    gd_mesh_release(mesh);
}

/* Paths to points behind the apex of a saddle bend at the apex. If the apex is equidistant from two
 * members, these points are equidistant, too. The diagram assigns each of them to one of the two
 * members. */
static void ties_behind_a_saddle(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh =
        test_sample("saddle", (const double[SAMPLE_PARAMETERS]){1, 0.6, 6, 6}, &polygons);
    for (uint32_t other = 1; other < 6; other++) {
        struct gd_seed seeds[3] = {0};
        double angle = other * M_PI / 3;
        seeds[0].point = test_point_near(mesh, 0.5, 0, 0.3);
        seeds[1].point =
            test_point_near(mesh, 0.5 * cos(angle), 0.5 * sin(angle), other % 2 ? -0.3 : 0.3);
        seeds[2].point = test_point_near(mesh, -0.3, -0.7, 0);
        for (uint32_t count = 2; count <= 3; count++) {
            struct member_set set;
            struct diagram diagram = diagram_of_seeds(mesh, &set, seeds, count, 1e-3);
            check_diagram(&diagram);
            assert_true(diagram.voronoi.bisector_count > 0);
            free_diagram(&diagram, &set);
        }
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static bool count_calls(void *user, double fraction)
{
    (void)fraction;
    ++*(uint32_t *)user;
    return true;
}

/* The work in one face is cubic in its seeds, so the control is checked within the face. */
static void many_seeds_in_a_face(void **state)
{
    (void)state;
    enum { SEEDS = 80 };
    double positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[3] = {0, 1, 2}, calls = 0;
    struct gd_polygons one = {
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&one);
    struct gd_seed seeds[SEEDS] = {0};
    struct rng rng = {7};
    for (int i = 0; i < SEEDS; i++)
        seeds[i].point = test_point(mesh, test_random_place(&one, &rng));
    struct gd_field *field = test_field(mesh, seeds, SEEDS, 0);
    struct gd_control control = {.progress = count_calls, .user = &calls};
    struct gd_voronoi voronoi;
    check_ok(gd_voronoi_trace(field, NULL, 1e-2, &control, &voronoi), NULL);
    assert_true(calls > 20);
    gd_voronoi_free(&voronoi);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* The mesh has several slices of edges. */
static void two_threads_trace_the_same(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("icosphere", (double[SAMPLE_PARAMETERS]){6, 1}, NULL);
    const struct gd_control both = {.executor = &two_threads};
    struct gd_seed seeds[6] = {0};
    for (int i = 0; i < 6; i++) seeds[i].point = test_point_near(mesh, sin(i), cos(i), 0.3 * i - 1);
    struct gd_field *field;
    const struct gd_field_request request = {.seeds = seeds, .seed_count = 6};
    check_ok(gd_field_build(mesh, &request, NULL, &field, NULL), NULL);
    struct gd_voronoi one, two;
    check_ok(gd_voronoi_trace(field, NULL, 1e-3, NULL, &one), NULL);
    check_ok(gd_voronoi_trace(field, NULL, 1e-3, &both, &two), NULL);
    assert_int_equal(one.bisector_count, two.bisector_count);
    for (uint32_t i = 0; i < one.bisector_count; i++) {
        const struct gd_bisector *a = &one.bisectors[i], *b = &two.bisectors[i];
        assert_int_equal(a->point_count, b->point_count);
        assert_memory_equal(a->points, b->points, a->point_count * sizeof *a->points);
    }
    assert_true(one.bisector_count > 5);
    gd_voronoi_free(&one);
    gd_voronoi_free(&two);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh =
        test_sample("terrain", (const double[SAMPLE_PARAMETERS]){40, 0.5, 1}, &polygons);
    struct gd_seed seeds[3] = {{.point = test_point_near(mesh, 0.1, 0.1, 0)},
                               {.point = test_point_near(mesh, 0.9, 0.2, 0), .offset = 0.05},
                               {.point = test_point_near(mesh, 0.5, 0.9, 0)}};
    struct gd_field *field = test_field(mesh, seeds, 3, 0),
                    *partial = test_field(mesh, seeds, 3, 0.1);
    struct gd_voronoi voronoi = {.bisector_count = 77};
    assert_int_equal(gd_voronoi_trace(field, NULL, 0, NULL, &voronoi), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_voronoi_trace(field, NULL, NAN, NULL, &voronoi), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_voronoi_trace(partial, NULL, 1, NULL, &voronoi), GD_BEYOND_REACH);
    struct test_watch watch = {.most = 3};
    struct gd_control control = {.progress = test_watch, .user = &watch};
    assert_int_equal(gd_voronoi_trace(field, NULL, 1e-3, &control, &voronoi), GD_CANCELLED);
    struct gd_control poor = {.budget_bytes = 64};
    assert_int_equal(gd_voronoi_trace(field, NULL, 1e-3, &poor, &voronoi), GD_BUDGET);
    watch = (struct test_watch){0};
    struct gd_control tight = {.budget_bytes = 4 << 20, .progress = test_watch, .user = &watch};
    /* the points alone exceed the budget */
    assert_int_equal(gd_voronoi_trace(field, NULL, 1e-15, &tight, &voronoi), GD_BUDGET);
    assert_true(watch.last >= 0.9);
    assert_int_equal(voronoi.bisector_count, 77);
    watch = (struct test_watch){0};
    check_ok(gd_voronoi_trace(field, NULL, 1e-3, &control, &voronoi), NULL);
    gd_voronoi_free(&voronoi);
    gd_voronoi_free(NULL);
    uint32_t labels[4096], known = 0, count = gd_mesh_summary(mesh)->index_count;
    check_ok(gd_voronoi_labels(partial, NULL, labels), NULL);
    for (uint32_t i = 0; i < count; i++) known += labels[i] != UINT32_MAX;
    assert_true(known > 10 && known < count / 2);
    gd_field_release(field);
    gd_field_release(partial);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_points_in_the_plane),
        cmocka_unit_test(three_points_in_the_plane),
        cmocka_unit_test(four_corners_meet_in_the_middle),
        cmocka_unit_test(offsets_bend_the_bisector),
        cmocka_unit_test(opposite_points_of_symmetric_surfaces),
        cmocka_unit_test(random_members_on_many_surfaces),
        cmocka_unit_test(members_without_a_region),
        cmocka_unit_test(ties_behind_a_saddle),
        cmocka_unit_test(many_seeds_in_a_face),
        cmocka_unit_test(two_threads_trace_the_same),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
