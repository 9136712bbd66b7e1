#include "tests/support/test.h"

#include <math.h>

#include "gd/direction.h"
#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

enum { POINTS = 400 };

static struct gd_vec3 unit_between(struct gd_vec3 from, struct gd_vec3 to)
{
    struct gd_vec3 way = gd_vec3_sub(to, from);
    return gd_vec3_scale(way, 1 / gd_vec3_length(way));
}

/* In a plane the gradient points away from the source, at vertices, on edges and in faces. */
static void in_the_plane(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(7, 5, 3, 2, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct rng rng = {1};
    double worst = 0;
    for (int s = 0; s < 12; s++) {
        struct gd_seed seed = {.point = test_point(mesh, test_random_place(&polygons, &rng))};
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        for (int k = 0; k < POINTS; k++) {
            struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
            if (gd_point_equal(&point, &seed.point)) continue;
            struct gd_vec3 gradient, expected = unit_between(gd_point_position(mesh, &seed.point),
                                                             gd_point_position(mesh, &point));
            check_ok(gd_field_gradient(field, &point, &gradient), NULL);
            worst = fmax(worst, gd_vec3_distance(gradient, expected));
        }
        gd_field_release(field);
    }
    print_message("# gradients in the plane: worst error %.1e\n", worst);
    assert_true(worst < 1e-12);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* On any surface, the first segment of the path from a point runs opposite to the gradient at this
 * point. */
static void paths_start_against_the_gradient(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {14, 0.8, 3}}, {"saddle", {1, 0.6, 5, 6}},
                    {"obstacles", {5, 1, 3}},  {"genus2", {3, 0.03}},
                    {"tangle", {150, 11}},     {"cylinder", {0.1, 3, 16, 5}}};
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct rng rng = {s};
        struct gd_seed seeds[2] = {
            {.point = test_point(mesh, test_random_place(&polygons, &rng))},
            {.point = test_point(mesh, test_random_place(&polygons, &rng)), .offset = 0.1}};
        struct gd_field *field = test_field(mesh, seeds, 2, 0);
        double worst = 0;
        uint32_t asked = 0;
        for (int k = 0; k < POINTS; k++) {
            struct gd_point point = test_point(mesh, test_random_place(&polygons, &rng));
            struct gd_vec3 gradient;
            struct gd_path path;
            enum gd_status status = gd_field_gradient(field, &point, &gradient);
            if (status) { /* the point is a seed or on another component */
                assert_int_equal(status, isinf(test_distance(field, &point)) ? GD_NOT_ON_SURFACE
                                                                             : GD_INVALID_ARGUMENT);
                continue;
            }
            check_ok(gd_field_path(field, &point, &path), NULL);
            assert_true(fabs(gd_vec3_length(gradient) - 1) < 1e-14);
            struct gd_vec3 here = gd_point_position(mesh, &path.points[0]),
                           next = gd_point_position(mesh, &path.points[1]);
            if (gd_vec3_distance(here, next) > 1e-4)
                worst = fmax(worst, gd_vec3_distance(gradient, unit_between(next, here)));
            asked++;
            gd_path_free(&path);
        }
        print_message("# %s: %u gradients, worst error %.1e\n", surfaces[s].name, asked, worst);
        assert_true(worst < 1e-6 && asked > 100);
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void points_without_a_gradient(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons two = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&two);
    const struct test_place places[3] = {
        {0, {1, 0, 0}}, {0, {0.5, 0.5, 0}}, {0, {0.5, 0.25, 0.25}}};
    struct gd_point far = test_point(mesh, (struct test_place){0, {0, 0, 1}}),
                    apart = test_point(mesh, (struct test_place){1, {0.2, 0.3, 0.5}});
    for (int i = 0; i < 3; i++) {
        struct gd_seed seed = {.point = test_point(mesh, places[i])};
        struct gd_field *whole = test_field(mesh, &seed, 1, 0),
                        *partial = test_field(mesh, &seed, 1, 0.25);
        struct gd_vec3 gradient = {7, 7, 7};
        assert_int_equal(gd_field_gradient(whole, &seed.point, &gradient), GD_INVALID_ARGUMENT);
        assert_int_equal(gd_field_gradient(whole, &apart, &gradient), GD_NOT_ON_SURFACE);
        assert_int_equal(gd_field_gradient(partial, &far, &gradient), GD_BEYOND_REACH);
        assert_true(gradient.x == 7 && gradient.y == 7 && gradient.z == 7);
        check_ok(gd_field_gradient(whole, &far, &gradient), NULL);
        gd_field_release(whole);
        gd_field_release(partial);
    }
    gd_mesh_release(mesh);
}

/* On a curve along an edge there is no gradient, whether the edge is inside or on the boundary. */
static void no_gradient_on_a_curve(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(2, 2, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    uint32_t faces = gd_mesh_summary(mesh)->faces;
    for (uint32_t i = 0; i < 3 * faces; i++) {
        double at[4][3] = {{0}};
        for (int k = 0; k < 4; k++) {
            at[k][i % 3] = 0.2 + 0.2 * k;
            at[k][(i + 1) % 3] = 0.8 - 0.2 * k;
        }
        struct gd_point point[4];
        for (int k = 0; k < 4; k++)
            point[k] = test_point(mesh, (struct test_place){i / 3, {at[k][0], at[k][1], at[k][2]}});
        struct gd_seed seeds[3] = {
            {.point = point[0], .offset = 0.25},
            {.point = point[0], .end = point[3], .is_segment = true, .offset = 0.25},
            {.point = point[3], .offset = 0.25}};
        struct gd_field *field = test_field(mesh, seeds, 3, 0);
        for (int k = 0; k < 4; k++) {
            struct gd_vec3 gradient;
            assert_true(test_distance(field, &point[k]) == 0.25);
            assert_int_equal(gd_field_gradient(field, &point[k], &gradient), GD_INVALID_ARGUMENT);
        }
        gd_field_release(field);
    }
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* A path bends at a boundary vertex by a small angle, and ends on the boundary close behind it. The
 * direction of its last leg must not lead over the boundary. */
static void directions_stay_inside_the_boundary(void **state)
{
    (void)state;
    struct rng rng = {5};
    for (int s = 0; s < POINTS; s++) {
        double turn = 6 * rng_unit(&rng), positions[5][3] = {{0}};
        for (int k = 0; k < 4; k++) {
            positions[k + 1][0] = cos(turn + k * M_PI / 2);
            positions[k + 1][1] = sin(turn + k * M_PI / 2);
        }
        uint32_t corners[9] = {0, 1, 2, 0, 2, 3, 0, 3, 4};
        struct gd_polygons fan = {
            .positions = positions, .position_count = 5, .polygon_count = 3, .corners = corners};
        struct gd_mesh *mesh = test_mesh(&fan);
        double bend = pow(10, -5 * rng_unit(&rng)), r = 0.5 * rng_unit(&rng),
               t = pow(10, -4 - 8 * rng_unit(&rng));
        struct test_place from = {0, {1 - r, r * bend, r - r * bend}}, to = {2, {1 - t, 0, t}};
        struct gd_seed seed = {.point = test_point(mesh, from)};
        struct gd_point point = test_point(mesh, to);
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        struct gd_vec3 gradient;
        struct gd_direction back;
        check_ok(gd_field_gradient(field, &point, &gradient), NULL);
        check_ok(gd_direction_along(mesh, &point, gd_vec3_scale(gradient, -1), &back, NULL), NULL);
        gd_field_release(field);
        gd_mesh_release(mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(in_the_plane),
        cmocka_unit_test(paths_start_against_the_gradient),
        cmocka_unit_test(points_without_a_gradient),
        cmocka_unit_test(no_gradient_on_a_curve),
        cmocka_unit_test(directions_stay_inside_the_boundary),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
