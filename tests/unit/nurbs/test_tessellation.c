/* Tests of tessellations: topology, vertices on the surface with their parameters, and conversions
 * in both directions. */
#include "tests/unit/nurbs/surfaces.h"

#include "gd/tessellation.h"

static struct gd_tessellation *tessellate(const struct gd_parametric *surface, uint32_t faces,
                                          double deviation)
{
    struct gd_tessellation *tessellation;
    struct gd_detail detail = {0};
    struct gd_tessellation_options options = {.faces = faces, .deviation = deviation};
    check_ok(gd_tessellation_build(surface, &options, NULL, &tessellation, &detail), &detail);
    return tessellation;
}

static void vertices_lie_on_the_surface(const struct gd_tessellation *tessellation)
{
    const struct gd_mesh *mesh = gd_tessellation_mesh(tessellation);
    for (uint32_t i = 0; i < gd_tessellation_polygons(tessellation)->position_count; i++) {
        struct gd_vertex vertex = {i};
        struct gd_jet jet;
        double uv[2];
        gd_tessellation_vertex(tessellation, vertex, uv);
        check_ok(gd_parametric_evaluate(gd_tessellation_surface(tessellation), uv[0], uv[1], &jet),
                 NULL);
        assert_true(gd_vec3_distance(jet.x, gd_mesh_position(mesh, vertex)) <= 1e-13);
    }
}

static void closed_directions_are_welded_and_poles_are_points(void **state)
{
    (void)state;
    struct gd_parametric *surfaces[] = {torus(2, 1),
                                        nurbs_torus(2, 1, 1, 0),
                                        nurbs_sphere(),
                                        nurbs_ruled(1, 0, 1, 2),
                                        nurbs_ruled(1, 0, 0, 2),
                                        nurbs_bumps(8, 4, 0.5, 1)};
    const int64_t euler[] = {0, 0, 2, 0, 1, 1};
    const uint32_t boundaries[] = {0, 0, 0, 2, 1, 1};
    const uint32_t faces[] = {100, 2000, 20000};
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 3; k++) {
            struct gd_tessellation *tessellation = tessellate(surfaces[i], faces[k], 0);
            const struct gd_mesh_summary *summary =
                gd_mesh_summary(gd_tessellation_mesh(tessellation));
            assert_int_equal(summary->euler_characteristic, euler[i]);
            assert_int_equal(summary->boundaries, boundaries[i]);
            assert_int_equal(summary->components, 1);
            assert_true(summary->faces > faces[k] / 2 && summary->faces < 2 * faces[k] + 500);
            vertices_lie_on_the_surface(tessellation);
            gd_tessellation_release(tessellation);
        }
        gd_parametric_release(surfaces[i]);
    }
}

static void parameters_convert_both_ways(void **state)
{
    (void)state;
    struct gd_parametric *surfaces[] = {nurbs_torus(2, 1, 1, 0), nurbs_sphere(),
                                        nurbs_bumps(8, 4, 0.5, 1)};
    struct rng rng = {6};
    for (int i = 0; i < 3; i++) {
        struct gd_tessellation *tessellation = tessellate(surfaces[i], 1000, 0);
        for (int k = 0; k < 2000; k++) {
            double u = rng_unit(&rng), v = rng_unit(&rng), uv[2];
            struct gd_point point;
            struct gd_jet jet;
            check_ok(gd_tessellation_point(tessellation, u, v, &point, NULL), NULL);
            gd_tessellation_parameters(tessellation, &point, uv);
            assert_true(fabs(uv[0] - u) < 1e-12 && fabs(uv[1] - v) < 1e-12);
            check_ok(gd_parametric_evaluate(surfaces[i], u, v, &jet), NULL);
            assert_true(gd_vec3_distance(
                            jet.x, gd_point_position(gd_tessellation_mesh(tessellation), &point)) <
                        0.1);
        }
        struct gd_point point;
        assert_int_equal(gd_tessellation_point(tessellation, NAN, 0, &point, NULL),
                         GD_INVALID_ARGUMENT);
        gd_tessellation_release(tessellation);
        gd_parametric_release(surfaces[i]);
    }
}

/* The middle of an edge is its farthest point from the surface. This distance must be within the
 * deviation. */
static void a_deviation_is_kept(void **state)
{
    (void)state;
    struct gd_parametric *surface = torus(2, 1);
    for (double deviation = 1e-2; deviation > 1e-4; deviation /= 4) {
        struct gd_tessellation *tessellation = tessellate(surface, 100, deviation);
        const struct gd_polygons *polygons = gd_tessellation_polygons(tessellation);
        double most = 0;
        for (uint32_t i = 0; i < 3 * polygons->polygon_count; i++) {
            const double *p = polygons->positions[polygons->corners[i]];
            const double *q = polygons->positions[polygons->corners[i % 3 == 2 ? i - 2 : i + 1]];
            double x = (p[0] + q[0]) / 2, y = (p[1] + q[1]) / 2, z = (p[2] + q[2]) / 2;
            most = fmax(most, fabs(hypot(hypot(x, y) - 2, z) - 1));
        }
        assert_true(most <= 1.1 * deviation && most > 0.1 * deviation);
        gd_tessellation_release(tessellation);
    }
    gd_parametric_release(surface);
}

static void limits_are_kept(void **state)
{
    (void)state;
    struct gd_parametric *surface = torus(2, 1);
    struct gd_tessellation *tessellation = NULL;
    struct gd_control poor = {.budget_bytes = 1000}, late = {.deadline_ns = 1};
    const struct gd_tessellation_options negative = {.deviation = -1}, fine = {.deviation = 1e-9};
    assert_int_equal(gd_tessellation_build(surface, &negative, NULL, &tessellation, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_tessellation_build(surface, &fine, NULL, &tessellation, NULL),
                     GD_TOO_LARGE);
    assert_int_equal(gd_tessellation_build(surface, NULL, &poor, &tessellation, NULL), GD_BUDGET);
    assert_int_equal(gd_tessellation_build(surface, NULL, &late, &tessellation, NULL), GD_DEADLINE);
    assert_null(tessellation);
    gd_parametric_release(surface);
}

/* A tessellation of `faces` triangles is built if max_faces is this number, and refused before any
 * vertex is evaluated if it is less. */
static void check_limit(const struct gd_parametric *surface, struct gd_tessellation_options options,
                        uint32_t faces)
{
    struct gd_tessellation *tessellation;
    options.max_faces = faces;
    check_ok(gd_tessellation_build(surface, &options, NULL, &tessellation, NULL), NULL);
    gd_tessellation_release(tessellation);
    options.max_faces = faces - 1;
    assert_int_equal(gd_tessellation_build(surface, &options, NULL, &tessellation, NULL),
                     GD_TOO_LARGE);
}

/* Steps are even and ignore the knots. Closed directions and poles are joined as usual. */
static void steps_are_as_requested(void **state)
{
    (void)state;
    struct gd_parametric *surfaces[] = {nurbs_torus(2, 1, 1, 0), nurbs_sphere(),
                                        nurbs_bumps(8, 4, 0.5, 1)};
    const uint32_t vertices[] = {7 * 10, 7 * 9 + 2, 8 * 11}, faces[] = {140, 126, 140};
    for (int i = 0; i < 3; i++) {
        struct gd_tessellation *tessellation = NULL;
        const struct gd_tessellation_options wrong[] = {{.steps = {2, 5}},
                                                        {.steps = {5, 0}},
                                                        {.steps = {0, 5}}},
                                             many = {.steps = {1u << 16, 1u << 16}},
                                             right = {.steps = {7, 10}};
        for (int k = 0; k < 3; k++)
            assert_int_equal(
                gd_tessellation_build(surfaces[i], &wrong[k], NULL, &tessellation, NULL),
                GD_INVALID_ARGUMENT);
        assert_int_equal(gd_tessellation_build(surfaces[i], &many, NULL, &tessellation, NULL),
                         GD_TOO_LARGE);
        check_ok(gd_tessellation_build(surfaces[i], &right, NULL, &tessellation, NULL), NULL);
        const struct gd_mesh_summary *summary = gd_mesh_summary(gd_tessellation_mesh(tessellation));
        check_limit(surfaces[i], right, (uint32_t)summary->faces);
        assert_int_equal(summary->vertices, vertices[i]);
        assert_int_equal(summary->faces, faces[i]);
        vertices_lie_on_the_surface(tessellation);
        gd_tessellation_release(tessellation);
        gd_parametric_release(surfaces[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_directions_are_welded_and_poles_are_points),
        cmocka_unit_test(parameters_convert_both_ways),
        cmocka_unit_test(a_deviation_is_kept),
        cmocka_unit_test(limits_are_kept),
        cmocka_unit_test(steps_are_as_requested),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
