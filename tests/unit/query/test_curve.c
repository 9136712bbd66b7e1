#include "gd/curve.h"

#include <math.h>
#include <string.h>

#include "gd/locate.h"
#include "gd/query.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

static enum gd_status resolve(const struct gd_mesh *mesh, struct gd_curve_request request,
                              struct gd_curve *out, struct gd_detail *detail)
{
    return gd_curve_resolve(mesh, &request, NULL, out, detail);
}

static double distance(const struct gd_mesh *mesh, struct gd_point p, struct gd_point q)
{
    struct gd_pair_answer answer;
    check_ok(
        gd_pair_solve(mesh, &(struct gd_pair_request){.from = &p, .to = &q}, NULL, &answer, NULL),
        NULL);
    return answer.distance;
}

/* The curve passes through its points in order. Its length is the sum of the distances between
 * consecutive points. */
static void joined_by_shortest_paths(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){12, 0.8, 3}, NULL);
    for (int closed = 0; closed < 2; closed++) {
        const struct gd_point points[] = {test_vertex(mesh, 5), test_vertex(mesh, 140),
                                          test_vertex(mesh, 31), test_vertex(mesh, 31),
                                          test_vertex(mesh, 90)};
        double length = distance(mesh, points[0], points[1]) +
                        distance(mesh, points[1], points[2]) +
                        distance(mesh, points[3], points[4]) +
                        (closed ? distance(mesh, points[4], points[0]) : 0);
        struct gd_curve curve;
        check_ok(resolve(mesh,
                         (struct gd_curve_request){.closed = closed, .count = 5, .points = points},
                         &curve, NULL),
                 NULL);
        assert_int_equal(curve.closed, closed);
        check_close(gd_curve_length(mesh, &curve), length, 1e-9);
        uint32_t next = 0;
        for (uint32_t i = 0; i < curve.count; i++) {
            while (next < 5 && gd_point_equal(&curve.points[i], &points[next])) next++;
            if (i) assert_false(gd_point_equal(&curve.points[i], &curve.points[i - 1]));
        }
        assert_int_equal(next, 5);
        assert_true(closed != gd_point_equal(&curve.points[curve.count - 1], &points[4]));
        gd_curve_free(&curve);
    }
    gd_mesh_release(mesh);
}

/* Points of one face are joined by straight segments without a search, however close they are. */
static void within_a_face(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("tetrahedron", (double[SAMPLE_PARAMETERS]){1, 0}, NULL);
    const double weights[][3] = {
        {0.5, 0.25, 0.25}, {0.5, 0.25 + 1e-14, 0.25 - 1e-14}, {1, 0, 0}, {0, 0.5, 0.5}};
    struct gd_point points[4];
    struct gd_curve curve;
    for (int i = 0; i < 4; i++)
        check_ok(gd_point_in_face(mesh, (struct gd_face){0}, weights[i], &points[i], NULL), NULL);
    check_ok(resolve(mesh, (struct gd_curve_request){.closed = true, .count = 4, .points = points},
                     &curve, NULL),
             NULL);
    assert_int_equal(curve.count, 4);
    for (uint32_t i = 0; i < 4; i++) assert_true(gd_point_equal(&curve.points[i], &points[i]));
    gd_curve_free(&curve);
    gd_mesh_release(mesh);
}

static void along_edges(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("grid", (double[SAMPLE_PARAMETERS]){2, 2, 1, 1}, NULL);
    static const struct gd_vertex chain[] = {{0}, {1}, {1}, {4}, {3}, {0}};
    struct gd_curve curve;
    for (int closed = 0; closed < 2; closed++) {
        check_ok(
            resolve(mesh,
                    (struct gd_curve_request){
                        .kind = GD_CURVE_VERTICES, .closed = closed, .count = 6, .vertices = chain},
                    &curve, NULL),
            NULL);
        assert_int_equal(curve.count, closed ? 4 : 5);
        check_close(gd_curve_length(mesh, &curve), 2, 1e-12);
        gd_curve_free(&curve);
    }
    gd_mesh_release(mesh);
}

static void round_boundaries(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 7, 3}, NULL);
    for (uint32_t loop = 0; loop < 2; loop++) {
        struct gd_curve curve;
        check_ok(resolve(mesh,
                         (struct gd_curve_request){.kind = GD_CURVE_BOUNDARY, .boundary = loop},
                         &curve, NULL),
                 NULL);
        struct gd_boundary boundary = gd_mesh_boundary(mesh, loop);
        assert_true(curve.closed);
        assert_int_equal(curve.count, boundary.vertices);
        check_close(gd_curve_length(mesh, &curve), boundary.length, 1e-12);
        struct gd_vec3 p = gd_point_position(mesh, &curve.points[0]),
                       q = gd_point_position(mesh, &curve.points[1]);
        /* the surface is on the left: counter-clockwise at the bottom, clockwise at the top */
        double turn = p.x * q.y - p.y * q.x;
        assert_true(p.z < 1 ? turn > 0 : turn < 0);
        gd_curve_free(&curve);
    }
    gd_mesh_release(mesh);
}

static void refusals(void **state)
{
    (void)state;
    struct gd_mesh *grid = test_sample("grid", (double[SAMPLE_PARAMETERS]){2, 2, 1, 1}, NULL);
    struct gd_curve curve = {.count = 7};
    struct gd_detail detail = {0};
    static const struct gd_vertex apart[] = {{0}, {8}}, beyond[] = {{0}, {9}};
    const struct gd_curve_request wrong[] = {
        {.kind = GD_CURVE_POINTS},
        {.kind = GD_CURVE_VERTICES},
        {.kind = GD_CURVE_VERTICES, .count = 2, .vertices = apart},
        {.kind = GD_CURVE_VERTICES, .count = 2, .vertices = beyond},
        {.kind = GD_CURVE_BOUNDARY, .boundary = 1},
    };
    static const enum gd_status expected[] = {GD_INVALID_ARGUMENT, GD_INVALID_ARGUMENT,
                                              GD_NO_SUCH_EDGE, GD_OUT_OF_RANGE, GD_OUT_OF_RANGE};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        detail.text[0] = '\0';
        assert_int_equal(resolve(grid, wrong[i], &curve, &detail), expected[i]);
        assert_true(strlen(detail.text) > 20);
        assert_int_equal(curve.count, 7);
    }
    gd_mesh_release(grid);
}

static void components_are_not_joined(void **state)
{
    (void)state;
    double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[] = {0, 1, 2, 3, 4, 5};
    struct gd_mesh *mesh = test_mesh(&(struct gd_polygons){
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners});
    const struct gd_point points[] = {test_vertex(mesh, 0), test_vertex(mesh, 1),
                                      test_vertex(mesh, 4)};
    struct gd_curve curve;
    struct gd_detail detail = {0};
    assert_int_equal(
        resolve(mesh, (struct gd_curve_request){.count = 3, .points = points}, &curve, &detail),
        GD_INVALID_ARGUMENT);
    assert_non_null(strstr(detail.text, "points 1 and 2"));
    gd_mesh_release(mesh);
}

static void budgets(void **state)
{
    (void)state;
    struct gd_mesh *mesh = test_sample("terrain", (double[SAMPLE_PARAMETERS]){20, 0.8, 3}, NULL);
    const struct gd_point points[] = {test_vertex(mesh, 0), test_vertex(mesh, 440)};
    const struct gd_curve_request request = {.count = 2, .points = points};
    bool is_done = false;
    for (size_t budget = 64; !is_done; budget *= 2) {
        const struct gd_control control = {.budget_bytes = budget};
        struct gd_curve curve;
        enum gd_status status = gd_curve_resolve(mesh, &request, &control, &curve, NULL);
        is_done = status == GD_OK;
        assert_true(is_done || status == GD_BUDGET);
        if (is_done) gd_curve_free(&curve);
    }
    gd_mesh_release(mesh);
}

/* A square that begins at a corner or in the middle of a side has four parts, on any mesh. An open
 * curve has one part more than it has inner corners. A point is one part. */
static void parts_between_corners(void **state)
{
    (void)state;
    static const double at[][2] = {{0.2, 0.5}, {0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}};
    for (uint32_t cells = 1; cells <= 6; cells++) {
        const double values[SAMPLE_PARAMETERS] = {cells, cells, 1, 1};
        struct gd_mesh *mesh = test_sample("grid", values, NULL);
        struct gd_point points[5];
        for (int i = 0; i < 5; i++) points[i] = test_point_near(mesh, at[i][0], at[i][1], 0);
        for (uint32_t c = 0; c < 3; c++) {
            const struct gd_curve_request request = {
                .closed = c < 2, .count = 5 - (c == 1), .points = points + (c == 1)};
            struct gd_curve curve;
            check_ok(resolve(mesh, request, &curve, NULL), NULL);
            uint32_t count = gd_curve_seed_count(&curve), part[1 << 10];
            struct gd_seed seeds[1 << 10] = {{.point = points[0]}};
            assert_true(count < (1 << 10));
            gd_curve_seeds(&curve, 0, seeds + 1);
            assert_int_equal(gd_curve_parts(mesh, seeds, count + 1, 1e-6, part), 5);
            assert_int_equal(part[0], 0);
            assert_int_equal(part[1], 1);
            assert_int_equal(part[count], c == 0 ? 1 : 4);
            for (uint32_t i = 1; i < count; i++)
                assert_true(part[i + 1] == part[i] || part[i + 1] == part[i] + 1 || c == 0);
            gd_curve_free(&curve);
        }
        gd_mesh_release(mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_between_corners),
        cmocka_unit_test(joined_by_shortest_paths),
        cmocka_unit_test(within_a_face),
        cmocka_unit_test(along_edges),
        cmocka_unit_test(round_boundaries),
        cmocka_unit_test(refusals),
        cmocka_unit_test(components_are_not_joined),
        cmocka_unit_test(budgets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
