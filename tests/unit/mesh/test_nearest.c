#include "shapes.h"

#include "gd/locate.h"
#include "mesh/topology.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

/* These functions compute distances from q to the segment ab and to a triangle, by bisection and
 * without the engine's formulas. */
static double segment_distance(struct gd_vec3 q, struct gd_vec3 a, struct gd_vec3 b)
{
    double low = 0, high = 1;
    struct gd_vec3 d = gd_vec3_sub(b, a);
    for (int i = 0; i < 100; i++) {
        double m = (low + high) / 2;
        if (gd_vec3_dot(gd_vec3_sub(gd_vec3_along(a, m, d), q), d) > 0)
            high = m;
        else
            low = m;
    }
    return gd_vec3_distance(q, gd_vec3_along(a, low, d));
}

static double triangle_distance(struct gd_vec3 q, const struct gd_vec3 p[3])
{
    double best = fmin(fmin(segment_distance(q, p[0], p[1]), segment_distance(q, p[1], p[2])),
                       segment_distance(q, p[2], p[0]));
    struct gd_vec3 n = gd_vec3_cross(gd_vec3_sub(p[1], p[0]), gd_vec3_sub(p[2], p[0]));
    double size = gd_vec3_length(n);
    if (size == 0) return best;
    for (int k = 0; k < 3; k++) {
        struct gd_vec3 inward = gd_vec3_cross(n, gd_vec3_sub(p[(k + 1) % 3], p[k]));
        if (gd_vec3_dot(inward, gd_vec3_sub(q, p[k])) < 0) return best;
    }
    return fmin(best, fabs(gd_vec3_dot(n, gd_vec3_sub(q, p[0]))) / size);
}

static double surface_distance(const struct gd_polygons *polygons, struct gd_vec3 q, uint32_t *face)
{
    double best = INFINITY;
    for (uint32_t f = 0; f < polygons->polygon_count; f++) {
        struct gd_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const double *c = polygons->positions[polygons->corners[3 * f + k]];
            p[k] = (struct gd_vec3){c[0], c[1], c[2]};
        }
        double distance = triangle_distance(q, p);
        if (distance >= best) continue;
        best = distance;
        *face = f;
    }
    return best;
}

static struct gd_point nearest(const struct gd_mesh *mesh, struct gd_vec3 q, double *distance)
{
    struct gd_point point;
    assert_int_equal(gd_locate_nearest(mesh, q, -1, &point, NULL), GD_OK);
    if (distance) *distance = gd_locate_distance(mesh, q, &point);
    return point;
}

static void expect_agreement(const struct gd_polygons *polygons, double reach, uint32_t queries,
                             uint64_t seed)
{
    struct gd_mesh *mesh = build(polygons);
    struct rng rng = {seed};
    for (uint32_t i = 0; i < queries; i++) {
        struct gd_vec3 q = {rng_between(&rng, -reach, reach), rng_between(&rng, -reach, reach),
                            rng_between(&rng, -reach, reach)};
        double distance;
        uint32_t face = 0;
        struct gd_point point = nearest(mesh, q, &distance);
        expect_near(distance, surface_distance(polygons, q, &face), 1e-13 * reach);
        expect_near(gd_vec3_distance(gd_point_position(mesh, &point), q), distance, 1e-13 * reach);
    }
    gd_mesh_release(mesh);
}

static void agrees_with_brute_force(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_torus(24, 12, 3, 1, &polygons), GD_OK);
    sample_jitter(&polygons, 0.1, 1);
    expect_agreement(&polygons, 5, 300, 1);
    gd_polygons_free(&polygons);
    for (uint64_t seed = 1; seed <= 60; seed++) { /* some have slivers */
        assert_int_equal(sample_tangle(30, seed, &polygons), GD_OK);
        expect_agreement(&polygons, 3, 30, seed);
        gd_polygons_free(&polygons);
    }
}

static void a_vertex_is_found_at_its_own_position(void **state)
{
    (void)state;
    const double offsets[] = {0, 1e7};
    for (uint32_t i = 0; i < COUNT(offsets); i++) {
        struct gd_polygons polygons;
        assert_int_equal(sample_icosphere(2, 0.7, &polygons), GD_OK);
        for (uint32_t v = 0; v < polygons.position_count; v++)
            polygons.positions[v][1] += offsets[i];
        struct gd_mesh *mesh = build(&polygons);
        for (uint32_t v = 0; v < polygons.position_count; v++) {
            double distance;
            struct gd_point found = nearest(mesh, gd_mesh_position(mesh, (struct gd_vertex){v}),
                                            &distance),
                            expected;
            assert_int_equal(gd_point_at_vertex(mesh, (struct gd_vertex){v}, &expected, NULL),
                             GD_OK);
            assert_true(gd_point_equal(&found, &expected));
            assert_true(distance == 0);
        }
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* The surface point that is nearest to the position of a point is this point. It has the same kind
 * and the same element. */
static void the_point_nearest_to_a_position_is_the_point(void **state)
{
    (void)state;
    const double offsets[] = {0, 1e4};
    for (uint32_t i = 0; i < COUNT(offsets); i++) {
        struct gd_polygons polygons;
        struct rng rng = {8};
        assert_int_equal(sample_icosphere(2, 0.7, &polygons), GD_OK);
        for (uint32_t v = 0; v < polygons.position_count; v++)
            polygons.positions[v][2] += offsets[i];
        struct gd_mesh *mesh = build(&polygons);
        for (uint32_t n = 0; n < 1000; n++) {
            double t = rng_between(&rng, 0.01, 0.99),
                   s = n % 2 ? 0 : rng_between(&rng, 0.01, 0.9) * (1 - t);
            struct gd_point point;
            struct gd_face face = {rng_below(&rng, mesh->face_count)};
            assert_int_equal(
                gd_point_in_face(mesh, face, (double[3]){1 - t - s, t, s}, &point, NULL), GD_OK);
            double distance;
            struct gd_point found = nearest(mesh, gd_point_position(mesh, &point), &distance);
            assert_true(found.kind == point.kind && found.element == point.element);
            for (int k = 0; k < 3; k++)
                expect_near(found.weight[k], point.weight[k], 1e-14 + 1e-14 * offsets[i]);
            expect_near(distance, 0, 1e-15 + 1e-15 * offsets[i]);
        }
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void ties_go_to_the_lowest_face(void **state)
{
    (void)state;
    const double size[3] = {2, 2, 2};
    const uint32_t cells[3] = {2, 2, 2};
    struct gd_polygons polygons;
    assert_int_equal(sample_box(size, cells, &polygons), GD_OK);
    for (uint64_t seed = 0; seed < 20; seed++) {
        assert_int_equal(sample_renumber(&polygons, seed, NULL, NULL), GD_OK);
        struct gd_mesh *mesh = build(&polygons);
        /* the six face centres are equally near */
        struct gd_point point = nearest(mesh, (struct gd_vec3){1, 1, 1}, NULL);
        struct gd_point_description found;
        gd_point_describe(mesh, &point, &found);
        assert_int_equal(found.kind, GD_POINT_VERTEX);
        /* true if a face with a lower number has one of these centres as a corner */
        bool lower_centre = false;
        for (uint32_t c = 0; c < 3 * found.face.index; c++) {
            const double *p = polygons.positions[polygons.corners[c]];
            lower_centre |= fabs(p[0] - 1) + fabs(p[1] - 1) + fabs(p[2] - 1) == 1;
        }
        assert_false(lower_centre);
        gd_mesh_release(mesh);
    }
    gd_polygons_free(&polygons);
}

static void max_snap_bounds_the_distance(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point point;
    struct gd_detail detail = {0};
    struct gd_vec3 q = {0.25, 0.5, 1.5};
    assert_int_equal(gd_locate_nearest(mesh, q, 0.4, &point, &detail), GD_NOT_ON_SURFACE);
    assert_non_null(strstr(detail.text, "0.5"));
    assert_int_equal(gd_locate_nearest(mesh, q, 0.5, &point, &detail), GD_OK);
    assert_true(gd_locate_distance(mesh, q, &point) == 0.5);
    assert_int_equal(gd_locate_nearest(mesh, (struct gd_vec3){0, 0, 0}, 0, &point, NULL), GD_OK);
    assert_int_equal(gd_locate_nearest(mesh, (struct gd_vec3){NAN, 0, 0}, -1, &point, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_locate_nearest(mesh, (struct gd_vec3){0, INFINITY, 0}, -1, &point, NULL),
                     GD_INVALID_ARGUMENT);
    assert_int_equal(gd_locate_nearest(mesh, q, NAN, &point, NULL), GD_INVALID_ARGUMENT);
    gd_mesh_release(mesh);
}

static void far_points_have_a_nearest_point(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    const double far[] = {1e10, 1e80, 1e160, 1e308};
    for (uint32_t i = 0; i < COUNT(far); i++) {
        double distance;
        struct gd_point point = nearest(mesh, (struct gd_vec3){far[i], 0.5, 0.5}, &distance);
        expect_near(distance / far[i], 1, 1e-9);
        expect_near(gd_point_position(mesh, &point).x, i ? 0.5 : 1, i ? 0.5 : 0);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_brute_force),
        cmocka_unit_test(a_vertex_is_found_at_its_own_position),
        cmocka_unit_test(the_point_nearest_to_a_position_is_the_point),
        cmocka_unit_test(ties_go_to_the_lowest_face),
        cmocka_unit_test(max_snap_bounds_the_distance),
        cmocka_unit_test(far_points_have_a_nearest_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
