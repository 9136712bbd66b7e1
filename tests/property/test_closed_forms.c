/* Compares the engine with surfaces whose distances have a closed form, and with the plane's
 * visibility graph on the benchmark of Y.-J. Liu, "Exact geodesic metric in 2-manifold triangle
 * meshes using edge-based data structures", section 5.1. */
#include "tests/oracle/closed_forms.h"

#include <math.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/oracle/visibility.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"
#include "tests/support/field.h"

static const double promise = 1e-9;

enum { SOURCES = 12, TARGETS = 60 };

struct surface {
    const char *name;
    struct gd_polygons polygons;
    double (*distance)(const struct surface *surface, const double p[3], const double q[3]);
    double size[3];
    struct closed_form_fan fan;
    uint32_t sides;
};

static double distance_at(const struct gd_field *field, struct gd_point point)
{
    double distance = NAN;
    check_ok(gd_field_distance(field, &point, &distance), NULL);
    return distance;
}

/* Compares random sources and targets at vertices, on edges and in faces. Frees the polygons. */
static void compare(struct surface *surface, uint64_t rng_seed)
{
    struct rng rng = {rng_seed};
    struct gd_mesh *mesh = test_mesh(&surface->polygons);
    double worst = 0;
    for (int i = 0; i < SOURCES; i++) {
        struct test_place source = test_random_place(&surface->polygons, &rng);
        struct gd_field *field = test_field_from(mesh, test_point(mesh, source));
        double from[3], to[3];
        test_place_position(&surface->polygons, source, from);
        for (int k = 0; k < TARGETS; k++) {
            struct test_place target = k ? test_random_place(&surface->polygons, &rng) : source;
            test_place_position(&surface->polygons, target, to);
            double expected = k ? surface->distance(surface, from, to) : 0;
            worst = fmax(worst, check_close(distance_at(field, test_point(mesh, target)), expected,
                                            promise));
        }
        gd_field_release(field);
    }
    print_message("# %s, %u faces: worst error %.2g\n", surface->name,
                  surface->polygons.polygon_count, worst);
    gd_mesh_release(mesh);
    gd_polygons_free(&surface->polygons);
}

static double flat(const struct surface *surface, const double p[3], const double q[3])
{
    (void)surface;
    return hypot(p[0] - q[0], p[1] - q[1]);
}

static void test_grid(void **state)
{
    (void)state;
    static const uint32_t cells[][2] = {{1, 1}, {3, 5}, {40, 25}, {80, 80}};
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        struct surface grid = {.name = "grid", .distance = flat};
        assert_int_equal(sample_grid(cells[i][0], cells[i][1], 2, 1.25, &grid.polygons), GD_OK);
        compare(&grid, i);
    }
}

/* Moves a point exactly into the planes of the box. An interpolated point deviates from these
 * planes by rounding. */
static void snap_to_box(const double size[3], const double x[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = x[k];
        if (fabs(x[k]) < 1e-13 * size[k]) out[k] = 0;
        if (fabs(x[k] - size[k]) < 1e-13 * size[k]) out[k] = size[k];
    }
}

static double on_box(const struct surface *surface, const double p[3], const double q[3])
{
    double a[3], b[3];
    snap_to_box(surface->size, p, a);
    snap_to_box(surface->size, q, b);
    return closed_form_box(surface->size, a, b);
}

static void test_box(void **state)
{
    (void)state;
    static const double sizes[][3] = {{1, 1, 1}, {30, 12, 12}, {1, 0.1, 3}};
    for (uint32_t i = 0; i < 6; i++) {
        struct surface box = {.name = "box", .distance = on_box};
        for (int k = 0; k < 3; k++) box.size[k] = sizes[i % 3][k];
        const uint32_t cells = i < 3 ? 1 : 7;
        assert_int_equal(
            sample_box(box.size, (const uint32_t[3]){cells, cells, cells}, &box.polygons), GD_OK);
        compare(&box, i);
    }
}

static double on_fan(const struct surface *surface, const double p[3], const double q[3])
{
    return closed_form_fan(&surface->fan, p, q);
}

static void test_fans(void **state)
{
    (void)state;
    static const uint32_t shapes[][2] = {{4, 1}, {6, 5}, {32, 10}, {64, 40}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        uint32_t sectors = shapes[i][0], rings = shapes[i][1];
        struct surface cone = {
            .name = "cone", .distance = on_fan, .fan = {1, 0.8, {0, 0}, sectors}};
        struct surface saddle = {
            .name = "saddle", .distance = on_fan, .fan = {1, 0, {0.6, -0.6}, sectors}};
        assert_int_equal(sample_cone(1, 0.8, sectors, rings, &cone.polygons), GD_OK);
        compare(&cone, i);
        assert_int_equal(sample_saddle(1, 0.6, sectors, rings, &saddle.polygons), GD_OK);
        compare(&saddle, i);
    }
}

static double on_prism(const struct surface *surface, const double p[3], const double q[3])
{
    return closed_form_prism(1, surface->sides, p, q);
}

static void test_cylinder(void **state)
{
    (void)state;
    static const uint32_t shapes[][2] = {{3, 1}, {5, 4}, {64, 20}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct surface cylinder = {.name = "cylinder", .distance = on_prism, .sides = shapes[i][0]};
        assert_int_equal(sample_cylinder(1, 4, shapes[i][0], shapes[i][1], &cylinder.polygons),
                         GD_OK);
        compare(&cylinder, i);
    }
}

/* Computes barycentric weights with respect to the four corners. They are linear in the
 * position. */
static void corner_weights(const struct surface *surface, const double p[3], double out[4])
{
    for (int k = 0; k < 4; k++) {
        const double *c = surface->polygons.positions[k];
        out[k] = 0.25 + 0.75 * (p[0] * c[0] + p[1] * c[1] + p[2] * c[2]) /
                            (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    }
}

static double on_tetrahedron(const struct surface *surface, const double p[3], const double q[3])
{
    double a[4], b[4];
    corner_weights(surface, p, a);
    corner_weights(surface, q, b);
    return closed_form_tetrahedron(surface->size[0], a, b);
}

static void test_tetrahedron(void **state)
{
    (void)state;
    for (uint32_t level = 0; level <= 4; level += 2) {
        struct surface tetrahedron = {
            .name = "tetrahedron", .distance = on_tetrahedron, .size = {3}};
        assert_int_equal(sample_tetrahedron(3, level, &tetrahedron.polygons), GD_OK);
        compare(&tetrahedron, level);
    }
}

/* Compares distances from p and q to each other and to points of the ground. */
static void compare_obstacles(const struct sample_obstacles *scene, uint64_t rng_seed)
{
    struct rng rng = {rng_seed};
    const struct gd_polygons *polygons = &scene->mesh;
    const uint32_t ends[2] = {scene->p, scene->q};
    struct visibility_scene plan = {(const double(*)[2])scene->corners, scene->first, scene->count};
    struct gd_mesh *mesh = test_mesh(polygons);
    double *values = calloc(polygons->position_count, sizeof *values), worst = 0;
    assert_non_null(values);
    for (int i = 0; i < 2; i++) {
        struct gd_point source = {0};
        check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){ends[i]}, &source, NULL), NULL);
        struct gd_field *field = test_field_from(mesh, source);
        gd_field_vertex_distances(field, values);
        gd_field_release(field);
        struct visibility *visibility = visibility_create(&plan, polygons->positions[ends[i]]);
        assert_non_null(visibility);
        for (int k = 0; k < 3 * TARGETS; k++) {
            uint32_t vertex = k ? rng_below(&rng, polygons->position_count) : ends[!i];
            if (polygons->positions[vertex][2] != 0) continue;
            double expected = visibility_distance(visibility, polygons->positions[vertex]);
            worst = fmax(worst, check_close(values[vertex], expected, promise));
        }
        visibility_free(visibility);
    }
    print_message("# %u obstacles, %u faces: worst error %.2g\n", scene->count,
                  polygons->polygon_count, worst);
    free(values);
    gd_mesh_release(mesh);
}

static void test_obstacles(void **state)
{
    (void)state;
    static const uint32_t shapes[][2] = {{10, 0}, {10, 1}, {10, 3}, {25, 1},  {25, 2},
                                         {40, 1}, {60, 1}, {80, 0}, {100, 0}, {100, 1}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        struct sample_obstacles scene;
        assert_int_equal(sample_obstacles(shapes[i][0], shapes[i][1], i, &scene), GD_OK);
        compare_obstacles(&scene, i);
        sample_obstacles_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),        cmocka_unit_test(test_box),
        cmocka_unit_test(test_fans),        cmocka_unit_test(test_cylinder),
        cmocka_unit_test(test_tetrahedron), cmocka_unit_test(test_obstacles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
