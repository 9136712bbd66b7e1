#include "shapes.h"

#include "gd/locate.h"
#include "mesh/topology.h"
#include "tests/samples/random.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"

static enum gd_status shoot(const struct gd_mesh *mesh, struct gd_vec3 origin,
                            struct gd_vec3 direction, struct gd_point *out)
{
    return gd_locate_first_hit(mesh, origin, direction, out, NULL);
}

/* Intersects the ray with each triangle. Returns the distance of the first hit, or INFINITY if
 * there is no hit. */
static double brute_force(const struct gd_polygons *polygons, struct gd_vec3 o, struct gd_vec3 d)
{
    double best = INFINITY;
    for (uint32_t f = 0; f < polygons->polygon_count; f++) {
        struct gd_vec3 p[3];
        for (int k = 0; k < 3; k++) {
            const double *c = polygons->positions[polygons->corners[3 * f + k]];
            p[k] = (struct gd_vec3){c[0], c[1], c[2]};
        }
        struct gd_vec3 u = gd_vec3_sub(p[1], p[0]), v = gd_vec3_sub(p[2], p[0]),
                       h = gd_vec3_cross(d, v), s = gd_vec3_sub(o, p[0]);
        double det = gd_vec3_dot(u, h), a = gd_vec3_dot(s, h) / det;
        struct gd_vec3 q = gd_vec3_cross(s, u);
        double b = gd_vec3_dot(d, q) / det, t = gd_vec3_dot(v, q) / det;
        if (a >= 0 && b >= 0 && a + b <= 1 && t >= 0) best = fmin(best, t);
    }
    return best;
}

static void agrees_with_brute_force(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_torus(24, 12, 3, 1, &polygons), GD_OK);
    sample_jitter(&polygons, 0.1, 1);
    struct gd_mesh *mesh = build(&polygons);
    struct rng rng = {5};
    uint32_t hits = 0;
    for (int i = 0; i < 2000; i++) {
        struct gd_vec3 o = {rng_between(&rng, -5, 5), rng_between(&rng, -5, 5),
                            rng_between(&rng, -5, 5)};
        struct gd_vec3 d = {rng_between(&rng, -1, 1), rng_between(&rng, -1, 1),
                            rng_between(&rng, -1, 1)};
        struct gd_point point;
        double t = brute_force(&polygons, o, d);
        assert_int_equal(shoot(mesh, o, d, &point), t < INFINITY ? GD_OK : GD_NOT_ON_SURFACE);
        if (t == INFINITY) continue;
        expect_near(gd_vec3_distance(gd_point_position(mesh, &point), gd_vec3_along(o, t, d)), 0,
                    1e-12);
        hits++;
    }
    assert_true(hits > 300);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* From inside a closed surface every ray hits, also at vertices and on edges. */
static void no_ray_slips_out_of_a_closed_surface(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_icosphere(3, 1.0, &polygons), GD_OK);
    sample_move(&polygons, 0.1, 3);
    struct gd_mesh *mesh = build(&polygons);
    struct rng rng = {6};
    for (uint32_t c = 0; c < 3 * polygons.polygon_count; c++) {
        uint32_t a = polygons.corners[c], b = polygons.corners[c % 3 == 2 ? c - 2 : c + 1];
        struct gd_vec3 p = gd_mesh_position(mesh, (struct gd_vertex){a}),
                       q = gd_mesh_position(mesh, (struct gd_vertex){b});
        struct gd_vec3 o = {rng_between(&rng, -0.2, 0.2), rng_between(&rng, -0.2, 0.2),
                            rng_between(&rng, -0.2, 0.2)};
        struct gd_vec3 on_edge = gd_vec3_along(p, rng_unit(&rng), gd_vec3_sub(q, p));
        struct gd_point point;
        assert_int_equal(shoot(mesh, o, gd_vec3_sub(p, o), &point), GD_OK);
        expect_near(gd_vec3_distance(gd_point_position(mesh, &point), p), 0, 1e-14);
        assert_int_equal(shoot(mesh, o, gd_vec3_sub(on_edge, o), &point), GD_OK);
        expect_near(gd_vec3_distance(gd_point_position(mesh, &point), on_edge), 0, 1e-14);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void a_hit_on_a_vertex_or_an_edge_is_that_vertex_or_edge(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_grid(4, 4, 4, 4, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    struct gd_vec3 down = {0, 0, -1};
    for (int x = 0; x <= 8; x++) {
        for (int y = 0; y <= 8; y++) {
            struct gd_point point;
            struct gd_point_description d;
            assert_int_equal(shoot(mesh, (struct gd_vec3){x / 2.0, y / 2.0, 7}, down, &point),
                             GD_OK);
            gd_point_describe(mesh, &point, &d);
            assert_true(d.xyz.x == x / 2.0 && d.xyz.y == y / 2.0 && d.xyz.z == 0);
            assert_int_equal(d.kind, x % 2 == 0 && y % 2 == 0 ? GD_POINT_VERTEX : GD_POINT_EDGE);
        }
    }
    struct gd_point point;
    assert_int_equal(shoot(mesh, (struct gd_vec3){4.0000001, 2, 7}, down, &point),
                     GD_NOT_ON_SURFACE);
    assert_int_equal(shoot(mesh, (struct gd_vec3){2, 2, -7}, down, &point), GD_NOT_ON_SURFACE);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A ray in the plane of a flat sheet hits the border of the sheet. A ray that starts on the sheet
 * hits it at its start. */
static void a_sheet_can_be_hit_edge_on(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    assert_int_equal(sample_grid(4, 4, 4, 4, &polygons), GD_OK);
    struct gd_mesh *mesh = build(&polygons);
    const struct {
        struct gd_vec3 origin, direction, expected;
    } rays[] = {
        {{-3, 1.25, 0}, {1, 0, 0}, {0, 1.25, 0}}, {{-3, 1, 0}, {2, 0, 0}, {0, 1, 0}},
        {{1.2, 9, 0}, {0, -3, 0}, {1.2, 4, 0}},   {{1.25, 1.75, 0}, {1, 0, 0}, {1.25, 1.75, 0}},
        {{1.5, 2, 0}, {-1, 0, 0}, {1.5, 2, 0}},   {{-1, -1, 0}, {1, 1, 0}, {0, 0, 0}},
    };
    for (uint32_t i = 0; i < COUNT(rays); i++) {
        struct gd_point point;
        assert_int_equal(shoot(mesh, rays[i].origin, rays[i].direction, &point), GD_OK);
        expect_near(gd_vec3_distance(gd_point_position(mesh, &point), rays[i].expected), 0, 1e-15);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void the_first_hit_is_found_from_either_side(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point point;
    assert_int_equal(
        shoot(mesh, (struct gd_vec3){0.3, 0.6, 5}, (struct gd_vec3){0, 0, -0.001}, &point), GD_OK);
    assert_true(gd_point_position(mesh, &point).z == 1);
    assert_int_equal(
        shoot(mesh, (struct gd_vec3){0.3, 0.6, 0.5}, (struct gd_vec3){0, 0, -1e200}, &point),
        GD_OK);
    assert_true(gd_point_position(mesh, &point).z == 0);
    assert_int_equal(
        shoot(mesh, (struct gd_vec3){0.3, 0.6, 1}, (struct gd_vec3){0, 0, 1e-300}, &point), GD_OK);
    assert_true(gd_point_position(mesh, &point).z == 1); /* the ray starts there */
    gd_mesh_release(mesh);
}

static void invalid_rays_are_refused(void **state)
{
    (void)state;
    struct gd_polygons polygons = cube();
    struct gd_mesh *mesh = build(&polygons);
    struct gd_point point;
    struct gd_vec3 o = {0, 0, 5}, d = {0, 0, -1}, zero = {0, 0, 0}, nan = {0, NAN, 0},
                   infinite = {INFINITY, 0, 0};
    assert_int_equal(shoot(mesh, o, zero, &point), GD_INVALID_ARGUMENT);
    assert_int_equal(shoot(mesh, nan, d, &point), GD_INVALID_ARGUMENT);
    assert_int_equal(shoot(mesh, o, infinite, &point), GD_INVALID_ARGUMENT);
    assert_int_equal(shoot(mesh, (struct gd_vec3){0, 0, 1e300}, d, &point), GD_NOT_ON_SURFACE);
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_brute_force),
        cmocka_unit_test(no_ray_slips_out_of_a_closed_surface),
        cmocka_unit_test(a_hit_on_a_vertex_or_an_edge_is_that_vertex_or_edge),
        cmocka_unit_test(a_sheet_can_be_hit_edge_on),
        cmocka_unit_test(the_first_hit_is_found_from_either_side),
        cmocka_unit_test(invalid_rays_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
