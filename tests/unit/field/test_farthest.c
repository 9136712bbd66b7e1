#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "gd/curve.h"
#include "gd/field.h"
#include "gd/locate.h"
#include "tests/samples/samples.h"
#include "tests/samples/zoo.h"
#include "tests/support/field.h"
#include "tests/support/watch.h"

static const double promise = 1e-9;

static struct gd_point point_at(const struct gd_mesh *mesh, double x, double y, double z)
{
    struct gd_point point;
    check_ok(gd_locate_nearest(mesh, (struct gd_vec3){x, y, z}, 1e-9, &point, NULL), NULL);
    return point;
}

/* Returns the position of the farthest point. Checks that the field has the same distance there. */
static struct gd_vec3 farthest(const struct gd_field *field, struct gd_point *point,
                               double *distance)
{
    double again;
    check_ok(gd_field_farthest(field, NULL, point, distance), NULL);
    check_ok(gd_field_distance(field, point, &again), NULL);
    assert_true(again == *distance);
    return gd_point_position(gd_field_mesh(field), point);
}

/* From the middle of a cube's face the farthest point is the middle of the opposite face. Paths
 * across each of the four other faces have equal length. */
static void farthest_on_a_cube(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 4; cells++) {
        struct gd_polygons polygons;
        check_ok(sample_box((double[3]){1, 1, 1}, (uint32_t[3]){cells, cells, cells}, &polygons),
                 NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_seed seed = {.point = point_at(mesh, 0.5, 0.5, 1)};
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        struct gd_point point;
        double distance;
        struct gd_vec3 at = farthest(field, &point, &distance);
        check_close(distance, 2, promise);
        assert_true(gd_vec3_distance(at, (struct gd_vec3){0.5, 0.5, 0}) < 1e-8);
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Kotani's ant: on a box of 1 x 1 x 2 the farthest point from a corner is not the opposite corner.
 * It lies a quarter of the far square's diagonal away from that corner. */
static void farthest_on_the_box_1_1_2(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 3; cells++) {
        struct gd_polygons polygons;
        check_ok(sample_box((double[3]){1, 1, 2}, (uint32_t[3]){cells, cells, cells}, &polygons),
                 NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_seed seed = {.point = point_at(mesh, 0, 0, 0)};
        struct gd_field *field = test_field(mesh, &seed, 1, 0);
        struct gd_point point;
        double distance;
        struct gd_vec3 at = farthest(field, &point, &distance);
        check_close(distance, sqrt(130) / 4, promise);
        assert_true(gd_vec3_distance(at, (struct gd_vec3){0.75, 0.75, 2}) < 1e-8);
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* The farthest point of a square is a corner for one seed, a point of the boundary for two seeds,
 * and an inner point for four seeds. */
static void farthest_in_a_square(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    check_ok(sample_grid(3, 2, 1, 1, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    struct gd_seed seeds[4] = {{.point = point_at(mesh, 0.3, 0.45, 0)}};
    struct gd_point point;
    double distance;
    struct gd_field *field = test_field(mesh, seeds, 1, 0);
    struct gd_vec3 at = farthest(field, &point, &distance);
    assert_int_equal(point.kind, GD_POINT_VERTEX);
    check_close(distance, hypot(0.7, 0.55), 1e-14);
    assert_true(gd_vec3_distance(at, (struct gd_vec3){1, 1, 0}) == 0);
    gd_field_release(field);

    seeds[0].point = point_at(mesh, 0, 0.1, 0);
    seeds[1].point = point_at(mesh, 1, 0.1, 0);
    field = test_field(mesh, seeds, 2, 0);
    at = farthest(field, &point, &distance);
    assert_int_equal(point.kind, GD_POINT_EDGE);
    check_close(distance, hypot(0.5, 0.9), promise);
    assert_true(gd_vec3_distance(at, (struct gd_vec3){0.5, 1, 0}) < promise);
    gd_field_release(field);

    const double corner[4][2] = {{0, 0}, {1, 0.05}, {0.9, 1}, {0, 1}};
    for (int i = 0; i < 4; i++)
        seeds[i] = (struct gd_seed){.point = point_at(mesh, corner[i][0], corner[i][1], 0),
                                    .offset = 0.01 * i};
    field = test_field(mesh, seeds, 4, 0);
    at = farthest(field, &point, &distance);
    assert_int_equal(point.kind, GD_POINT_FACE);
    int nearest = 0;
    for (int i = 0; i < 4; i++) {
        double d = seeds[i].offset + hypot(at.x - corner[i][0], at.y - corner[i][1]);
        assert_true(d > distance * (1 - 1e-12));
        nearest += d < distance * (1 + 1e-12);
    }
    assert_int_equal(nearest, 3);
    gd_field_release(field);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* --- segments --------------------------------------------------------------------------------- */

/* Returns the field of all boundaries as curves. The offset of each curve exceeds the offset of the
 * curve before it by `more`. */
static struct gd_field *field_of_boundaries(const struct gd_mesh *mesh, double more)
{
    struct gd_seed *seeds = NULL;
    uint32_t count = 0;
    for (uint32_t loop = 0; loop < gd_mesh_summary(mesh)->boundaries; loop++) {
        struct gd_curve_request request = {.kind = GD_CURVE_BOUNDARY, .boundary = loop};
        struct gd_curve curve;
        check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
        seeds = realloc(seeds, sizeof *seeds * (count + gd_curve_seed_count(&curve)));
        assert_non_null(seeds);
        gd_curve_seeds(&curve, loop * more, seeds + count);
        count += gd_curve_seed_count(&curve);
        gd_curve_free(&curve);
    }
    struct gd_field *field = test_field(mesh, seeds, count, 0);
    free(seeds);
    return field;
}

/* The points farthest from a rectangle's boundary form a ridge. In a triangle the incentre is
 * farthest. */
static void farthest_from_a_boundary(void **state)
{
    (void)state;
    static const uint32_t cells[][2] = {{1, 1}, {2, 2}, {3, 2}, {5, 3}, {4, 7}, {9, 9}};
    static const double scales[] = {1e-6, 1, 1e6};
    struct gd_point point;
    double distance;
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        double scale = scales[i % 3];
        struct gd_polygons polygons;
        check_ok(sample_grid(cells[i][0], cells[i][1], 3 * scale, 2 * scale, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_field *field = field_of_boundaries(mesh, 0);
        struct gd_vec3 at = farthest(field, &point, &distance);
        check_close(distance, scale, 1e-12);
        check_close(at.y, scale, promise);
        assert_true(at.x > scale * (1 - promise) && at.x < scale * (2 + promise));
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    double positions[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
    uint32_t corners[3] = {0, 1, 2};
    struct gd_polygons one = {
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&one);
    struct gd_field *field = field_of_boundaries(mesh, 0);
    struct gd_vec3 at = farthest(field, &point, &distance);
    check_close(distance, 1, 1e-14);
    assert_true(gd_vec3_distance(at, (struct gd_vec3){1, 1, 0}) < 1e-13);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Between the two boundaries of a cylinder, the ridge is a closed curve without nodes. */
static void farthest_on_a_cylinder(void **state)
{
    (void)state;
    struct rng rng = {21};
    for (uint32_t sides = 3; sides <= 12; sides++) {
        double height = rng_between(&rng, 1, 3), more = rng_between(&rng, 0, 0.5);
        struct gd_polygons polygons;
        check_ok(
            sample_cylinder(rng_between(&rng, 0.3, 1), height, sides, 1 + sides % 4, &polygons),
            NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_field *field = field_of_boundaries(mesh, more);
        struct gd_point point;
        double distance;
        struct gd_vec3 at = farthest(field, &point, &distance);
        check_close(distance, 0.5 * (height + more), 1e-14);
        assert_true(fabs(fabs(at.z - 0.5 * height) - 0.5 * more) < promise);
        gd_field_release(field);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Appends seeds for the straight line from a to b. The line follows grid lines of a square of side
 * 8, which has `cells` cells along each side. Returns the new number of seeds. */
static uint32_t put_border(const struct gd_mesh *mesh, struct gd_vec3 a, struct gd_vec3 b,
                           uint32_t cells, struct gd_seed *seeds, uint32_t count)
{
    struct gd_vec3 step = gd_vec3_scale(gd_vec3_sub(b, a), 1.0 / cells);
    seeds[count++] = (struct gd_seed){.point = point_at(mesh, a.x, a.y, 0)};
    for (uint32_t i = 1; i <= cells; i++) {
        struct gd_vec3 end = gd_vec3_along(a, i, step);
        seeds[count] = (struct gd_seed){.point = seeds[count - 1].point, .is_segment = true};
        seeds[count++].end = point_at(mesh, end.x, end.y, 0);
        seeds[count] = (struct gd_seed){.point = seeds[count - 1].end};
        count++;
    }
    return count;
}

static void check_place(const struct gd_mesh *mesh, const struct gd_seed *seeds, uint32_t count,
                        double distance, struct gd_vec3 expected)
{
    struct gd_field *field = test_field(mesh, seeds, count, 0);
    struct gd_point point;
    double most;
    struct gd_vec3 at = farthest(field, &point, &most);
    check_close(most, distance, 1e-12);
    assert_true(gd_vec3_distance(at, expected) < promise);
    gd_field_release(field);
}

/* Returns the point turned about the square's centre by `quarters` quarter turns. */
static struct gd_vec3 turned(double x, double y, int quarters)
{
    for (; quarters > 0; quarters--) {
        double left = 8 - y;
        y = x;
        x = left;
    }
    return (struct gd_vec3){x, y, 0};
}

static void check_borders(const struct gd_mesh *mesh, uint32_t cells, int quarters)
{
    struct gd_vec3 corner[4] = {turned(0, 0, quarters), turned(8, 0, quarters),
                                turned(8, 8, quarters), turned(0, 8, quarters)},
                   beside = turned(8, 6, quarters);
    struct gd_seed seeds[64];
    uint32_t count = put_border(mesh, corner[0], corner[1], cells, seeds, 0);
    for (int i = 2; i < 4; i++)
        seeds[count++] = (struct gd_seed){.point = point_at(mesh, corner[i].x, corner[i].y, 0)};
    check_place(mesh, seeds, count, 5, turned(4, 5, quarters)); /* r = y, r^2 = 16 + (8 - y)^2 */
    count = put_border(mesh, corner[3], corner[0], cells, seeds, count);
    double r = 8 * (2 - M_SQRT2); /* x = y = sqrt(2) (8 - x) */
    check_place(mesh, seeds, count, r, turned(r, r, quarters));
    count = put_border(mesh, corner[3], corner[0], cells, seeds, 0);
    seeds[count++] = (struct gd_seed){.point = point_at(mesh, beside.x, beside.y, 0)};
    check_place(mesh, seeds, count, 6.25, turned(6.25, 0, quarters)); /* x^2 = (8 - x)^2 + 36 */
}

/* The farthest point has the same distance from two points and a segment, or from a point and two
 * segments. Or it lies on the boundary, at the same distance from a point and a segment. The test
 * uses one cell and many cells. */
static void between_points_and_segments(void **state)
{
    (void)state;
    for (uint32_t cells = 1; cells <= 9; cells += 4) {
        struct gd_polygons polygons;
        check_ok(sample_grid(cells, cells, 8, 8, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        for (int quarters = 0; quarters < 4; quarters++) check_borders(mesh, cells, quarters);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* --- the pillow: a unit square with a front and a back ---------------------------------------- */

static double over_pillow(const double p[3], const double q[3])
{
    if (p[2] == q[2]) return hypot(p[0] - q[0], p[1] - q[1]);
    double best = INFINITY;
    for (int axis = 0; axis < 2; axis++) {
        double along = p[!axis] - q[!axis];
        best = fmin(best, hypot(p[axis] + q[axis], along));
        best = fmin(best, hypot(2 - p[axis] - q[axis], along));
    }
    return best;
}

/* Finds the largest distance by search on successively finer grids. */
static double greatest_over_pillow(const double seed[2][3])
{
    double best = 0;
    for (int side = -1; side <= 1; side += 2) {
        double x = 0.5, y = 0.5, reach = 0.5, top = 0;
        for (int round = 0; round < 26; round++) {
            int steps = round ? 10 : 400;
            double bx = x, by = y;
            for (int i = -steps; i <= steps; i++) {
                for (int k = -steps; k <= steps; k++) {
                    double p[3] = {fmin(fmax(x + reach * i / steps, 0), 1),
                                   fmin(fmax(y + reach * k / steps, 0), 1), side};
                    double d = fmin(over_pillow(seed[0], p), over_pillow(seed[1], p));
                    if (d <= top) continue;
                    top = d;
                    bx = p[0];
                    by = p[1];
                }
            }
            x = bx;
            y = by;
            reach = round ? 0.4 * reach : 0.01;
        }
        best = fmax(best, top);
    }
    return best;
}

/* Interpolates the chart coordinates of a point in a face. */
static void in_chart(const struct zoo_shape *shape, const struct test_place *place, double out[3])
{
    double z = 0;
    out[0] = out[1] = 0;
    for (int k = 0; k < 3; k++) {
        const double *chart = shape->chart[shape->mesh.corners[3 * place->face + (uint32_t)k]];
        out[0] += place->weight[k] * chart[0];
        out[1] += place->weight[k] * chart[1];
        z += place->weight[k] * chart[2];
    }
    out[2] = z > 0 ? 1 : -1;
}

static void farthest_on_a_pillow(void **state)
{
    (void)state;
    struct rng rng = {9};
    uint32_t inside = 0;
    for (int round = 0; round < 12; round++) {
        struct zoo_shape shape;
        check_ok(zoo_pillow((double[]){1, 1, 1 + round % 3}, &shape), NULL);
        struct gd_mesh *mesh = test_mesh(&shape.mesh);
        struct gd_seed seeds[2] = {0};
        double chart[2][3];
        for (int i = 0; i < 2; i++) {
            struct test_place place = {.face = rng_below(&rng, shape.mesh.polygon_count),
                                       .weight = {0.3, 0.25, 0.45}};
            seeds[i].point = test_point(mesh, place);
            in_chart(&shape, &place, chart[i]);
        }
        struct gd_field *field = test_field(mesh, seeds, 2, 0);
        struct gd_point point;
        double distance;
        farthest(field, &point, &distance);
        check_close(distance, greatest_over_pillow(chart), 1e-8);
        inside += point.kind == GD_POINT_FACE;
        gd_field_release(field);
        gd_mesh_release(mesh);
        zoo_shape_free(&shape);
    }
    print_message("# pillows: %u of 12 farthest points inside a face\n", inside);
    assert_true(inside > 0);
}

/* --- any surface ------------------------------------------------------------------------------ */

/* Checks that no random point is farther than the farthest point. Some of the random points are
 * close to the farthest point. Counts the kind of the farthest point in `kinds`. */
static void check_farthest(const struct gd_field *field, const struct gd_polygons *polygons,
                           struct rng *rng, uint32_t kinds[3])
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    struct gd_point point;
    double distance;
    farthest(field, &point, &distance);
    kinds[point.kind]++;
    struct gd_point_description d;
    gd_point_describe(mesh, &point, &d);
    for (int k = 0; k < 20000; k++) {
        struct test_place place = test_random_place(polygons, rng);
        /* the point lies in a face of the farthest point, close to the farthest point */
        if (k % 2) {
            double near = pow(10, -1 - rng_between(rng, 0, 6));
            place = (struct test_place){.face = d.face.index};
            double toward[3] = {rng_between(rng, 0, 1), rng_between(rng, 0, 1),
                                rng_between(rng, 0, 1)};
            for (int i = 0; i < 3; i++)
                place.weight[i] = (1 - near) * d.barycentric[i] +
                                  near * toward[i] / (toward[0] + toward[1] + toward[2]);
        }
        double other;
        struct gd_point q = test_point(mesh, place);
        check_ok(gd_field_distance(field, &q, &other), NULL);
        assert_true(isinf(other) || other <= distance * (1 + 1e-12));
    }
}

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"icosphere", {2, 1}}, {"torus", {20, 10, 1, 0.4}}, {"terrain", {10, 0.3, 7}},
                {"genus2", {2, 0.03}}, {"saddle", {1, 0.6, 5, 6}},  {"cylinder", {0.1, 3, 16, 5}},
                {"tangle", {200, 11}}, {"tetrahedron", {1, 2}}};

static void farthest_on_any_surface(void **state)
{
    (void)state;
    for (size_t s = 0; s < sizeof surfaces / sizeof *surfaces; s++) {
        struct gd_polygons polygons;
        check_ok(sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct rng rng = {s};
        uint32_t kinds[3] = {0};
        for (int round = 0; round < 8; round++) {
            struct gd_seed seeds[3] = {0};
            for (int i = 0; i < 3; i++)
                seeds[i].point = test_point(mesh, test_random_place(&polygons, &rng));
            struct gd_field *field = test_field(mesh, seeds, round % 2 ? 3 : 1, 0);
            check_farthest(field, &polygons, &rng, kinds);
            gd_field_release(field);
        }
        print_message("# %s: farthest points %u vertices, %u on edges, %u in faces\n",
                      surfaces[s].name, kinds[GD_POINT_VERTEX], kinds[GD_POINT_EDGE],
                      kinds[GD_POINT_FACE]);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Seeds are the boundaries of sample surfaces and of random surfaces. Closed surfaces are
 * skipped. */
static void farthest_from_boundaries(void **state)
{
    (void)state;
    struct rng rng = {77};
    uint32_t kinds[3] = {0}, count = sizeof surfaces / sizeof *surfaces;
    for (uint32_t s = 0; s < count + 24; s++) {
        struct gd_polygons polygons;
        check_ok(s < count ? sample_find(surfaces[s].name)->generate(surfaces[s].values, &polygons)
                           : sample_tangle(40 + 5 * s, s, &polygons),
                 NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        if (gd_mesh_summary(mesh)->boundaries) {
            struct gd_field *field = field_of_boundaries(mesh, 0);
            check_farthest(field, &polygons, &rng, kinds);
            gd_field_release(field);
        }
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    print_message("# farthest from boundaries: %u vertices, %u on edges, %u in faces\n",
                  kinds[GD_POINT_VERTEX], kinds[GD_POINT_EDGE], kinds[GD_POINT_FACE]);
    assert_true(kinds[GD_POINT_FACE] > 0);
}

static bool count_calls(void *user, double fraction)
{
    (void)fraction;
    ++*(uint32_t *)user;
    return true;
}

/* Seeds on a lattice of squares in a right triangle, which is one face. The farthest point is the
 * middle of a square. The call checks its control all the time, although there is only one face. */
static void farthest_from_many_seeds_in_a_face(void **state)
{
    (void)state;
    enum { STEPS = 16, SEEDS = (STEPS + 1) * (STEPS + 2) / 2 };
    double positions[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[3] = {0, 1, 2}, count = 0, calls = 0;
    struct gd_polygons one = {
        .positions = positions, .position_count = 3, .polygon_count = 1, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&one);
    struct gd_seed seeds[SEEDS] = {0};
    for (int i = 0; i <= STEPS; i++)
        for (int j = 0; i + j <= STEPS; j++)
            seeds[count++].point = test_point(
                mesh, (struct test_place){
                          0, {1 - (double)(i + j) / STEPS, (double)i / STEPS, (double)j / STEPS}});
    struct gd_field *field = test_field(mesh, seeds, SEEDS, 0);
    struct gd_point point;
    double distance;
    farthest(field, &point, &distance);
    check_close(distance, sqrt(0.5) / STEPS, promise);
    struct gd_control control = {.progress = count_calls, .user = &calls};
    check_ok(gd_field_farthest(field, &control, &point, &distance), NULL);
    assert_true(calls > 10);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

/* Thousands of seeds in one of two faces. The call checks its control while it selects the sources,
 * and joins the arcs that they cover: without that it would take minutes. */
static void farthest_from_thousands_of_seeds_in_a_face(void **state)
{
    (void)state;
    enum { SEEDS = 4000 };
    static struct gd_seed seeds[SEEDS];
    double positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 0, 2, 3}, calls = 0;
    struct gd_polygons two = {
        .positions = positions, .position_count = 4, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&two);
    struct rng rng = {7};
    double nearest = 2; /* distance of a seed from (0, 1, 0), the farthest point */
    for (int i = 0; i < SEEDS; i++) {
        double u = rng_unit(&rng), v = rng_unit(&rng), x = fmax(u, v), y = fmin(u, v);
        struct test_place place = {0, {1 - x, x - y, y}};
        nearest = fmin(nearest, hypot(x, 1 - y));
        seeds[i] = (struct gd_seed){.point = test_point(mesh, place)};
    }
    struct gd_field *field = test_field(mesh, seeds, SEEDS, 0);
    struct gd_point point;
    double distance;
    struct gd_control control = {.progress = count_calls, .user = &calls};
    check_ok(gd_field_farthest(field, &control, &point, &distance), NULL);
    check_close(distance, nearest, promise);
    assert_true(calls > SEEDS / 100);
    gd_field_release(field);
    gd_mesh_release(mesh);
}

static void other_components_and_refusals(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {50, 0, 0}, {60, 0, 0}, {50, 10, 0}};
    uint32_t corners[6] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons two = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    struct gd_mesh *mesh = test_mesh(&two);
    struct gd_seed seeds[2] = {{.point = test_point(mesh, (struct test_place){0, {1, 0, 0}})},
                               {.point = test_point(mesh, (struct test_place){0, {0, 1, 0}})}};
    struct gd_field *field = test_field(mesh, seeds, 1, 0),
                    *partial = test_field(mesh, seeds, 1, 0.5),
                    *pair = test_field(mesh, seeds, 2, 0);
    struct gd_point point = {.element = 7};
    double distance = 7;
    assert_int_equal(gd_field_farthest(partial, NULL, &point, &distance), GD_BEYOND_REACH);
    struct gd_control cancel = {.progress = test_cancel};
    assert_int_equal(gd_field_farthest(pair, &cancel, &point, &distance), GD_CANCELLED);
    assert_true(distance == 7 && point.element == 7);
    check_ok(gd_field_farthest(field, NULL, &point, &distance), NULL);
    assert_true(distance == 1);
    gd_field_release(field);
    gd_field_release(partial);
    gd_field_release(pair);
    gd_mesh_release(mesh);
}

/* A field with a radius returns the farthest point if its reach covers the surface. Otherwise it
 * returns GD_BEYOND_REACH. */
static void farthest_in_partial_fields(void **state)
{
    (void)state;
    struct rng rng = {31};
    uint32_t told = 0, refused = 0;
    for (uint32_t n = 0; n < 60; n++) {
        struct gd_polygons polygons;
        check_ok(sample_tangle(60, 200 + n, &polygons), NULL);
        struct gd_mesh *mesh = test_mesh(&polygons);
        struct gd_seed seeds[2] = {
            {.point = test_point(mesh, test_random_place(&polygons, &rng))},
            {.point = test_point(mesh, test_random_place(&polygons, &rng)), .offset = 0.2}};
        struct gd_field *whole = test_field(mesh, seeds, 2, 0), *part, *view;
        struct gd_point point, again = {0};
        double distance, same;
        farthest(whole, &point, &distance);
        for (int k = 0; k < 5; k++) {
            double radius = distance * (0.01 + 0.99 * k) +
                            (k == 4 ? gd_mesh_summary(mesh)->edge_length.max : 0);
            part = test_field(mesh, seeds, 2, radius);
            enum gd_status status = gd_field_farthest(part, NULL, &again, &same);
            check_ok(gd_field_within(whole, radius, &view), NULL);
            assert_int_equal(gd_field_farthest(view, NULL, &again, &same), status);
            if (k == 0) assert_int_equal(status, GD_BEYOND_REACH);
            if (k == 4) check_ok(status, NULL);
            if (!status) check_close(same, distance, 1e-14);
            told += !status;
            refused += status == GD_BEYOND_REACH;
            gd_field_release(part);
            gd_field_release(view);
        }
        gd_field_release(whole);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
    assert_int_equal(told + refused, 300);
    assert_true(told > 100 && refused > 60);
}

/* A seed whose offset exceeds the field's radius may lie on a component of its own. */
static void farthest_with_late_seeds(void **state)
{
    (void)state;
    double positions[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {50, 0, 0}, {60, 0, 0}, {50, 10, 0}};
    uint32_t corners[6] = {0, 1, 2, 3, 4, 5};
    struct gd_polygons two = {
        .positions = positions, .position_count = 6, .polygon_count = 2, .corners = corners};
    static const struct test_place late[] = {
        {1, {1, 0, 0}}, {1, {0.5, 0.5, 0}}, {1, {0.2, 0.3, 0.5}}};
    struct gd_mesh *mesh = test_mesh(&two);
    for (size_t i = 0; i < sizeof late / sizeof *late; i++) {
        struct gd_seed seeds[2] = {{.point = test_point(mesh, (struct test_place){0, {1, 0, 0}})},
                                   {.point = test_point(mesh, late[i]), .offset = 4}};
        struct gd_field *both = test_field(mesh, seeds, 2, 3), *one = test_field(mesh, seeds, 1, 3);
        struct gd_point point;
        double distance;
        assert_int_equal(gd_field_farthest(both, NULL, &point, &distance), GD_BEYOND_REACH);
        check_ok(gd_field_farthest(one, NULL, &point, &distance), NULL);
        assert_true(distance == 1);
        gd_field_release(both);
        gd_field_release(one);
    }
    gd_mesh_release(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(farthest_on_a_cube),
        cmocka_unit_test(farthest_on_the_box_1_1_2),
        cmocka_unit_test(farthest_in_a_square),
        cmocka_unit_test(farthest_on_a_pillow),
        cmocka_unit_test(farthest_from_a_boundary),
        cmocka_unit_test(farthest_on_a_cylinder),
        cmocka_unit_test(between_points_and_segments),
        cmocka_unit_test(farthest_from_boundaries),
        cmocka_unit_test(farthest_on_any_surface),
        cmocka_unit_test(farthest_in_partial_fields),
        cmocka_unit_test(farthest_with_late_seeds),
        cmocka_unit_test(farthest_from_many_seeds_in_a_face),
        cmocka_unit_test(farthest_from_thousands_of_seeds_in_a_face),
        cmocka_unit_test(other_components_and_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
