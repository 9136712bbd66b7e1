/* Tests sources and corners of curves very close to edges and vertices of a plane. Some are closer
 * than windows can resolve. Target points are equally close. Distances must equal Euclidean
 * distances, and paths must have these lengths. GD_SCENES: number of fields of each kind (400). */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "gd/vec.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

enum { SCENES = 400, POINTS_MOST = 4, PLACES = 40, POINT_DIGITS = 8, CURVE_DIGITS = 16 };

/* A rotated square of 8 x 8 cells. In two thirds of the scenes its inner vertices are displaced. */
struct plane {
    struct gd_polygons polygons;
    struct gd_mesh *mesh;
};

static struct plane open_plane(int scene, struct rng *rng)
{
    struct plane plane;
    double angle = 0.0137 * scene, jitter = scene % 3 * 0.2;
    check_ok(sample_grid(8, 8, 8, 8, &plane.polygons), NULL);
    for (uint32_t i = 0; i < plane.polygons.position_count; i++) {
        double *p = plane.polygons.positions[i], x = p[0] - 4, y = p[1] - 4;
        if (hypot(x, y) < 3.5) {
            x += jitter * (rng_unit(rng) - 0.5);
            y += jitter * (rng_unit(rng) - 0.5);
        }
        p[0] = cos(angle) * x - sin(angle) * y;
        p[1] = sin(angle) * x + cos(angle) * y;
    }
    plane.mesh = test_mesh(&plane.polygons);
    return plane;
}

static void close_plane(struct plane *plane)
{
    gd_mesh_release(plane->mesh);
    gd_polygons_free(&plane->polygons);
}

/* Returns a point near a random vertex or edge, at a distance between 10^-digits and 1. */
static struct gd_point beside_something(const struct plane *plane, int digits, struct rng *rng)
{
    uint32_t face = rng_below(rng, plane->polygons.polygon_count), k = rng_below(rng, 3);
    const double *a = plane->polygons.positions[plane->polygons.corners[3 * face + k]],
                 *b = plane->polygons.positions[plane->polygons.corners[3 * face + (k + 1) % 3]];
    double t = rng_below(rng, 3) ? rng_unit(rng) : 0, apart = pow(10, -digits * rng_unit(rng)),
           angle = 2 * M_PI * rng_unit(rng);
    return test_point_near(plane->mesh, a[0] + t * (b[0] - a[0]) + apart * cos(angle),
                           a[1] + t * (b[1] - a[1]) + apart * sin(angle), 0);
}

/* Returns the distance of a position from seeds, which are points or segments. */
static double to_seeds(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                       struct gd_vec3 p)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        struct gd_vec3 a = gd_point_position(mesh, &seeds[i].point);
        least =
            fmin(least, seeds[i].is_segment
                            ? test_distance_to_segment(p, a, gd_point_position(mesh, &seeds[i].end))
                            : gd_vec3_distance(p, a));
    }
    return least;
}

/* Checks distances and path lengths at all vertices and some points close to edges. Returns the
 * largest error. */
static double check_field(const struct plane *plane, const struct gd_seed *seeds, uint32_t count,
                          int digits, struct rng *rng)
{
    struct gd_field *field = test_field(plane->mesh, seeds, count, 0);
    double worst = 0;
    for (uint32_t i = 0; i < plane->polygons.position_count + PLACES; i++) {
        struct gd_point point = i < plane->polygons.position_count
                                    ? test_vertex(plane->mesh, i)
                                    : beside_something(plane, digits, rng);
        double expected =
            to_seeds(plane->mesh, seeds, count, gd_point_position(plane->mesh, &point));
        struct gd_path path;
        check_ok(gd_field_path(field, &point, &path), NULL);
        double error =
            fmax(fabs(test_distance(field, &point) - expected), fabs(path.length - expected));
        assert_true(error <= 1e-9 * expected + 1e-10);
        worst = fmax(worst, error);
        gd_path_free(&path);
    }
    gd_field_release(field);
    return worst;
}

static double check_points(const struct plane *plane, struct rng *rng)
{
    struct gd_seed seeds[POINTS_MOST] = {0};
    uint32_t count = 1 + rng_below(rng, POINTS_MOST);
    for (uint32_t i = 0; i < count; i++)
        seeds[i].point = beside_something(plane, POINT_DIGITS, rng);
    return check_field(plane, seeds, count, POINT_DIGITS, rng);
}

static double check_curve(const struct plane *plane, struct rng *rng)
{
    struct gd_point points[POINTS_MOST];
    uint32_t count = 2 + rng_below(rng, POINTS_MOST - 1);
    for (uint32_t i = 0; i < count; i++) points[i] = beside_something(plane, CURVE_DIGITS, rng);
    struct gd_curve_request request = {.kind = GD_CURVE_POINTS,
                                       .points = points,
                                       .count = count,
                                       .closed = count > 2 && rng_below(rng, 2)};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(plane->mesh, &request, NULL, &curve, NULL), NULL);
    uint32_t seed_count = gd_curve_seed_count(&curve);
    struct gd_seed *seeds = malloc(seed_count * sizeof *seeds);
    assert_non_null(seeds);
    gd_curve_seeds(&curve, 0, seeds);
    double worst = check_field(plane, seeds, seed_count, CURVE_DIGITS, rng);
    free(seeds);
    gd_curve_free(&curve);
    return worst;
}

/* Runs `check`, which returns its largest error, in each plane. */
static void check_planes(double (*check)(const struct plane *plane, struct rng *rng), uint64_t seed)
{
    const char *asked = getenv("GD_SCENES");
    int scenes = asked ? atoi(asked) : SCENES;
    struct rng rng = {seed};
    double worst = 0;
    for (int scene = 0; scene < scenes; scene++) {
        struct plane plane = open_plane(scene, &rng);
        worst = fmax(worst, check(&plane, &rng));
        close_plane(&plane);
    }
    print_message("# %d fields: off by %.1e at most\n", scenes, worst);
}

static void points_beside_something(void **state)
{
    (void)state;
    check_planes(check_points, 5);
}

static void curves_beside_something(void **state)
{
    (void)state;
    check_planes(check_curve, 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_beside_something),
                                       cmocka_unit_test(curves_beside_something)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
