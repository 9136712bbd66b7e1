/* Tests Voronoi diagrams whose members are curves and boundaries. These members consist of points
 * and segments. */
#include "tests/support/diagram.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/voronoi.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"

static const double promise = 1e-9;
/* the tolerance of polylines, and the largest permitted error of their lengths at ties */
static const double fine = 1e-6;

static void free_diagram(struct diagram *diagram, struct member_set *set)
{
    diagram_free(diagram);
    member_set_free(set);
}

/* --- closed forms in the plane ---------------------------------------------------------------- */

static struct gd_mesh *square(uint32_t cells, double size)
{
    struct gd_polygons polygons;
    check_ok(sample_grid(cells, cells, size, size, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

/* A straight segment of the plane. */
struct way {
    double x0, y0, x1, y1;
};

static void put_way(struct member_set *set, const struct gd_mesh *mesh, struct way way, double size)
{
    member_set_put_path(set, mesh, test_point_near(mesh, way.x0 * size, way.y0 * size, 0),
                        test_point_near(mesh, way.x1 * size, way.y1 * size, 0));
}

static double distance_to(struct way way, double x, double y)
{
    double dx = way.x1 - way.x0, dy = way.y1 - way.y0, square = dx * dx + dy * dy,
           part = square > 0 ? ((x - way.x0) * dx + (y - way.y0) * dy) / square : 0;
    part = fmin(fmax(part, 0), 1);
    return hypot(x - way.x0 - part * dx, y - way.y0 - part * dy);
}

/* Checks that each vertex of each bisector is equidistant from its two segments. */
static void check_ways(const struct diagram *diagram, const struct way *ways, double size)
{
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++) {
        const struct gd_bisector *b = &diagram->voronoi.bisectors[i];
        for (uint32_t k = 0; k < b->point_count; k++) {
            struct gd_vec3 at = gd_point_position(diagram->mesh, &b->points[k]);
            double first = distance_to(ways[b->members[0]], at.x / size, at.y / size),
                   second = distance_to(ways[b->members[1]], at.x / size, at.y / size);
            assert_true(fabs(first - second) < promise);
        }
    }
}

static void put_member(struct member_set *set, const struct gd_mesh *mesh, struct way way,
                       double size)
{
    if (way.x0 == way.x1 && way.y0 == way.y1)
        member_set_put_point(set, test_point_near(mesh, way.x0 * size, way.y0 * size, 0), 0);
    else
        put_way(set, mesh, way, size);
}

/* Counts the bisectors that have a length. Ties may leave tiny loops where a bisector runs along
 * edges, or where two segments share an end. */
static uint32_t count_bisectors(const struct diagram *diagram)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < diagram->voronoi.bisector_count; i++)
        count += diagram->voronoi.bisectors[i].length > fine * diagram->size;
    return count;
}

static struct diagram check_plane(const struct gd_mesh *mesh, struct member_set *set,
                                  const struct way *ways, uint32_t count, double size)
{
    *set = (struct member_set){0};
    for (uint32_t i = 0; i < count; i++) put_member(set, mesh, ways[i], size);
    struct diagram diagram = diagram_of(mesh, set, fine * size);
    check_diagram(&diagram);
    check_ways(&diagram, ways, size);
    return diagram;
}

/* Returns half the length of y = x^2 between -x and x. */
static double parabola(double x)
{
    return 0.5 * x * sqrt(1 + 4 * x * x) + 0.25 * asinh(2 * x);
}

/* Tests the number of bisectors of two segments and the total length of the bisectors. */
static void two_segments_in_the_plane(void **state)
{
    (void)state;
    const struct {
        struct way ways[2];
        uint32_t bisectors;
        double length; /* 0 if not checked */
    } cases[] = {
        {{{0.5, 0.75, 0.5, 0.75}, {0, 0.25, 1, 0.25}}, 1, 2 * parabola(0.5)},
        {{{0, 0.2, 1, 0.2}, {0, 0.7, 1, 0.7}}, 1, 1},
        /* the segments run along edges, like the bisector */
        {{{0, 0.25, 1, 0.25}, {0, 0.75, 1, 0.75}}, 1, 1},
        {{{0, 0, 1, 0}, {0, 0, 0, 1}}, 1, M_SQRT2}, /* the segments have a common corner */
        {{{0, 0.5, 1, 0.5}, {0.5, 0, 0.5, 1}}, 2, 2 * M_SQRT2},
        {{{0.1, 0.1, 0.9, 0.2}, {0.2, 0.6, 0.8, 0.9}}, 1, 0},
        {{{0.3, 0.41, 0.7, 0.43}, {0.55, 0.37, 0.52, 0.83}}, 2, 0},
        /* one segment ends on the other segment */
        {{{0.3, 0.3, 0.7, 0.3}, {0.5, 0.3, 0.5, 0.8}}, 1, 0},
        {{{0.3, 0.3, 0.7, 0.3}, {0.7, 0.3, 0.7, 0.8}},
         1,
         0}, /* the segments have a common end, beyond which points are equidistant */
        {{{0.5, 0.5, 0.5, 0.5}, {0.2, 0.5, 0.8, 0.5}}, 0, 0},
        {{{0.47, 0.31, 0.47, 0.31}, {0.2, 0.31, 0.8, 0.31}}, 0, 0},
        {{{0.2, 0.5, 0.8, 0.5}, {0.5, 0.5, 0.5, 0.5}}, 0, 0}, /* a point on a segment has no cell */
        {{{0.2, 0.31, 0.8, 0.53}, {0.2, 0.31, 0.8, 0.53}}, 0, 0}, /* a copy has no cell */
    };
    static const double sizes[] = {1, 1e-6, 1e6};
    for (uint32_t cells = 1; cells <= 8; cells++) {
        for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
            struct gd_mesh *mesh = square(cells, sizes[n]);
            for (size_t s = 0; s < sizeof cases / sizeof *cases; s++) {
                struct member_set set;
                struct diagram diagram = check_plane(mesh, &set, cases[s].ways, 2, sizes[n]);
                assert_int_equal(count_bisectors(&diagram), cases[s].bisectors);
                if (cases[s].length > 0)
                    check_close(diagram_length(&diagram), cases[s].length * sizes[n], fine);
                free_diagram(&diagram, &set);
            }
            gd_mesh_release(mesh);
        }
    }
}

/* The bisectors of a triangle's sides meet in the incentre. The bisectors of a square's sides meet
 * in the square's centre. */
static void sides_of_polygons(void **state)
{
    (void)state;
    static const struct way triangle[] = {{0.1, 0.2, 0.9, 0.2},
                                          {0.9, 0.2, 0.1, 0.8},
                                          {0.1, 0.8, 0.1, 0.2}},
                            sides[] = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
    for (uint32_t cells = 1; cells <= 8; cells++) {
        struct gd_mesh *mesh = square(cells, 1);
        struct member_set set;
        struct diagram diagram = check_plane(mesh, &set, triangle, 3, 1);
        struct gd_point centre = test_point_near(mesh, 0.3, 0.4, 0);
        assert_int_equal(diagram_ends_at(&diagram, &centre), 3);
        free_diagram(&diagram, &set);
        diagram = check_plane(mesh, &set, sides, 4, 1);
        centre = test_point_near(mesh, 0.5, 0.5, 0);
        assert_true(diagram_ends_at(&diagram, &centre) >= 4);
        check_close(diagram_length(&diagram), 2 * M_SQRT2, fine);
        free_diagram(&diagram, &set);
        gd_mesh_release(mesh);
    }
}

/* Between a square's boundary and its centre lie four pieces of parabolas. There is no bisector
 * between the sides, which are one member. */
static void a_boundary_and_a_point(void **state)
{
    (void)state;
    static const struct way sides[] = {{0, 0, 1, 0}, {1, 0, 1, 1}, {1, 1, 0, 1}, {0, 1, 0, 0}};
    for (uint32_t cells = 1; cells <= 8; cells++) {
        struct gd_mesh *mesh = square(cells, 1);
        struct member_set set = {0};
        for (int i = 0; i < 4; i++) {
            put_way(&set, mesh, sides[i], 1);
            if (i) member_set_join(&set);
        }
        member_set_put_point(&set, test_point_near(mesh, 0.5, 0.5, 0), 0);
        struct diagram diagram = diagram_of(mesh, &set, fine);
        check_diagram(&diagram);
        assert_int_equal(diagram.voronoi.bisector_count, 1);
        assert_true(diagram.voronoi.bisectors[0].closed);
        check_close(diagram_length(&diagram), 8 * parabola(0.5 * (M_SQRT2 - 1)), fine);
        free_diagram(&diagram, &set);
        gd_mesh_release(mesh);
    }
}

/* --- members and seeds ------------------------------------------------------------------------ */

/* Seeds of the same member have no bisector. Member numbers may be unused. Too large member numbers
 * are rejected. */
static void members_by_seed(void **state)
{
    (void)state;
    struct gd_mesh *mesh = square(5, 1);
    struct gd_seed seeds[3] = {{.point = test_point_near(mesh, 0.2, 0.5, 0)},
                               {.point = test_point_near(mesh, 0.8, 0.5, 0)},
                               {.point = test_point_near(mesh, 0.5, 0.9, 0)}};
    struct gd_field *field;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = seeds, .seed_count = 3}, NULL,
                            &field, NULL),
             NULL);
    struct gd_voronoi voronoi;
    check_ok(gd_voronoi_trace(field, (const uint32_t[]){1, 1, 1}, fine, NULL, &voronoi), NULL);
    assert_int_equal(voronoi.bisector_count, 0);
    gd_voronoi_free(&voronoi);
    check_ok(gd_voronoi_trace(field, (const uint32_t[]){2, 2, 0}, fine, NULL, &voronoi), NULL);
    assert_true(voronoi.bisector_count >= 1);
    for (uint32_t i = 0; i < voronoi.bisector_count; i++) {
        assert_int_equal(voronoi.bisectors[i].members[0], 0);
        assert_int_equal(voronoi.bisectors[i].members[1], 2);
    }
    gd_voronoi_free(&voronoi);
    uint32_t labels[36] = {77};
    const uint32_t beyond[] = {0, 1, 3};
    assert_int_equal(gd_voronoi_trace(field, beyond, fine, NULL, &voronoi), GD_INVALID_ARGUMENT);
    assert_int_equal(gd_voronoi_labels(field, beyond, labels), GD_INVALID_ARGUMENT);
    assert_int_equal(labels[0], 77);
    check_ok(gd_voronoi_labels(field, (const uint32_t[]){2, 2, 0}, labels), NULL);
    for (int i = 0; i < 36; i++) assert_true(labels[i] == 0 || labels[i] == 2);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* --- any surface ------------------------------------------------------------------------------ */

/* Appends a segment within a random face, along one of its edges, or from a corner. */
static void put_random_segment(struct member_set *set, const struct gd_mesh *mesh,
                               const struct gd_polygons *polygons, double offset, struct rng *rng)
{
    struct gd_point ends[2];
    uint32_t face = rng_below(rng, polygons->polygon_count);
    for (int end = 0; end < 2; end++) {
        struct test_place place = {.face = face};
        double sum = 0;
        uint32_t zeros = rng_below(rng, 3), first = rng_below(rng, 3);
        for (uint32_t k = 0; k < 3; k++)
            place.weight[(first + k) % 3] = k < zeros ? 0 : 0.01 + rng_unit(rng);
        for (int k = 0; k < 3; k++) sum += place.weight[k];
        for (int k = 0; k < 3; k++) place.weight[k] /= sum;
        ends[end] = test_point(mesh, place);
    }
    if (gd_point_equal(&ends[0], &ends[1]))
        member_set_put_point(set, ends[0], offset);
    else
        member_set_put_curve(set, ends, 2, false, offset);
}

static void put_random_member(struct member_set *set, const struct gd_mesh *mesh,
                              const struct gd_polygons *polygons, double offset, struct rng *rng)
{
    struct gd_point from = test_point(mesh, test_random_place(polygons, rng)),
                    to = test_point(mesh, test_random_place(polygons, rng));
    switch (rng_below(rng, 4)) {
    case 0:
        member_set_put_point(set, from, offset);
        break;
    case 1:
        member_set_put_path(set, mesh, from, to);
        break;
    case 2:
        put_random_segment(set, mesh, polygons, offset, rng);
        break;
    case 3: /* two points */
        put_random_segment(set, mesh, polygons, offset, rng);
        member_set_put_point(set, from, offset);
        member_set_join(set);
        break;
    }
}

static uint32_t check_random_members(const struct gd_mesh *mesh, const struct gd_polygons *polygons,
                                     uint64_t trial)
{
    struct rng rng = {trial};
    struct member_set set = {0};
    uint32_t count = 2 + rng_below(&rng, 7);
    for (uint32_t i = 0; i < count; i++)
        put_random_member(&set, mesh, polygons, trial % 2 ? rng_between(&rng, 0, 0.1) : 0, &rng);
    struct diagram diagram = diagram_of(mesh, &set, 1e-3);
    check_diagram(&diagram);
    uint32_t bisectors = diagram.voronoi.bisector_count;
    diagram_free(&diagram);
    member_set_free(&set);
    return bisectors;
}

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
        struct gd_polygons polygons;
        struct gd_mesh *mesh = test_sample(surfaces[s].name, surfaces[s].values, &polygons);
        for (uint64_t trial = 0; trial < 12; trial += TEST_STRIDE)
            bisectors += check_random_members(mesh, &polygons, s + 100 * trial);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    assert_true(bisectors * TEST_STRIDE > 400);
}

static void random_members_on_shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"spot", "fandisk"};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        struct gd_polygons polygons = test_shared_polygons(names[n]);
        struct gd_mesh *mesh = test_mesh(&polygons);
        assert_true(check_random_members(mesh, &polygons, 2 * n) > 0);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_segments_in_the_plane),
        cmocka_unit_test(sides_of_polygons),
        cmocka_unit_test(a_boundary_and_a_point),
        cmocka_unit_test(members_by_seed),
        cmocka_unit_test(random_members_on_many_surfaces),
        cmocka_unit_test(random_members_on_shared_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
