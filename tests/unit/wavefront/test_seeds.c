/* Tests seeds on a circle of a plane, as segments and as points. By symmetry many seeds are equally
 * near to points of the grid, up to rounding. Some points are inside a window, others are slightly
 * beyond its end. Each distance equals the closed form, and each path has this length. */
#include "tests/support/test.h"

#include <math.h>

#include "gd/vec.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

enum { CORNERS_MOST = 400, PLACES = 60, TURNS = 60 };

/* A regular polygon in the plane: its corners on the mesh and their positions. */
struct ring {
    struct gd_point point[CORNERS_MOST];
    struct gd_vec3 place[CORNERS_MOST];
    uint32_t count;
};

/* A square of side 8, and its polygons. */
static struct gd_polygons polygons;
static struct gd_mesh *mesh;

static void open_square(uint32_t cells)
{
    check_ok(sample_grid(cells, cells, 8, 8, &polygons), NULL);
    mesh = test_mesh(&polygons);
}

static void close_square(void)
{
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

/* Places the corners on the unit circle around the square's centre. */
static void lay_ring(struct ring *ring, uint32_t count)
{
    ring->count = count;
    for (uint32_t i = 0; i < count; i++) {
        double angle = 2 * M_PI * i / count;
        ring->point[i] = test_point_near(mesh, 4 + cos(angle), 4 + sin(angle), 0);
        ring->place[i] = gd_point_position(mesh, &ring->point[i]);
    }
}

static struct gd_field *field_of_segments(const struct ring *ring)
{
    struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .closed = true, .points = ring->point, .count = ring->count};
    struct gd_curve curve;
    struct gd_detail detail = {0};
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, &detail), &detail);
    struct gd_field *field = test_field_of_curve(mesh, &curve, 0);
    gd_curve_free(&curve);
    return field;
}

static struct gd_field *field_of_points(const struct ring *ring)
{
    struct gd_seed seeds[CORNERS_MOST] = {0};
    for (uint32_t i = 0; i < ring->count; i++) seeds[i].point = ring->point[i];
    return test_field(mesh, seeds, ring->count, 0);
}

static double to_segments(const struct ring *ring, struct gd_vec3 p)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < ring->count; i++)
        least = fmin(
            least, test_distance_to_segment(p, ring->place[i], ring->place[(i + 1) % ring->count]));
    return least;
}

static double to_points(const struct ring *ring, struct gd_vec3 p)
{
    double least = INFINITY;
    for (uint32_t i = 0; i < ring->count; i++)
        least = fmin(least, gd_vec3_distance(p, ring->place[i]));
    return least;
}

/* The seeds on the ring, and the closed form of the distance. */
struct seeding {
    struct gd_field *(*field)(const struct ring *ring);
    double (*distance)(const struct ring *ring, struct gd_vec3 p);
};

static const struct seeding segments = {field_of_segments, to_segments},
                            points = {field_of_points, to_points};

/* Checks distance and path at a point. Returns the distance's error. */
static double check_at(const struct gd_field *field, const struct gd_point *point, double expected)
{
    struct gd_path path;
    double error = fabs(test_distance(field, point) - expected);
    check_ok(gd_field_path(field, point, &path), NULL);
    assert_true(error <= 1e-9 * expected + 1e-14);
    assert_true(fabs(path.length - expected) <= 1e-9 * expected + 1e-14);
    gd_path_free(&path);
    return error;
}

/* Checks all vertices and some random places. Returns the largest error. */
static double check_ring(const struct ring *ring, const struct seeding *seeding, struct rng *rng)
{
    struct gd_field *field = seeding->field(ring);
    double worst = 0;
    for (uint32_t i = 0; i < polygons.position_count + PLACES; i++) {
        struct gd_point point = i < polygons.position_count
                                    ? test_vertex(mesh, i)
                                    : test_point(mesh, test_random_place(&polygons, rng));
        worst = fmax(worst, check_at(field, &point,
                                     seeding->distance(ring, gd_point_position(mesh, &point))));
    }
    gd_field_release(field);
    return worst;
}

static void check_rings(const struct seeding *seeding)
{
    struct rng rng = {8};
    static struct ring ring;
    double worst = 0;
    for (uint32_t cells = 16; cells <= 22; cells++) {
        open_square(cells);
        for (uint32_t count = 36; count <= CORNERS_MOST; count += 56) {
            lay_ring(&ring, count);
            worst = fmax(worst, check_ring(&ring, seeding, &rng));
        }
        close_square();
    }
    print_message("# distances off by %.1e at most\n", worst);
}

static void rings_of_segments(void **state)
{
    (void)state;
    check_rings(&segments);
}

static void rings_of_points(void **state)
{
    (void)state;
    check_rings(&points);
}

/* --- straight curves past a vertex ------------------------------------------------------------ */

/* Opens a square of 8 x 8 cells, rotated about its centre. */
static void open_turned_square(double angle)
{
    check_ok(sample_grid(8, 8, 8, 8, &polygons), NULL);
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        double x = polygons.positions[i][0] - 4, y = polygons.positions[i][1] - 4;
        polygons.positions[i][0] = cos(angle) * x - sin(angle) * y;
        polygons.positions[i][1] = sin(angle) * x + cos(angle) * y;
    }
    mesh = test_mesh(&polygons);
}

/* Returns a line in this direction at the distance `apart` to the left of the central vertex. It
 * bends by no more than the rounding of paths. */
static struct gd_curve line_beside(double angle, double apart)
{
    struct gd_point ends[2];
    for (int i = 0; i < 2; i++) {
        double along = i ? 3.3 : -3.5;
        ends[i] = test_point_near(mesh, along * cos(angle) - apart * sin(angle),
                                  along * sin(angle) + apart * cos(angle), 0);
    }
    struct gd_curve_request request = {.kind = GD_CURVE_POINTS, .points = ends, .count = 2};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    return curve;
}

static double to_curve(const struct gd_curve *curve, struct gd_vec3 p)
{
    double least = INFINITY;
    for (uint32_t i = 0; i + 1 < curve->count; i++)
        least =
            fmin(least, test_distance_to_segment(p, gd_point_position(mesh, &curve->points[i]),
                                                 gd_point_position(mesh, &curve->points[i + 1])));
    return least;
}

/* Returns the largest error at vertices. */
static double check_beside(double angle, double apart)
{
    double worst = 0;
    struct gd_curve curve = line_beside(angle, apart);
    struct gd_field *field = test_field_of_curve(mesh, &curve, 0);
    for (uint32_t i = 0; i < polygons.position_count; i++) {
        struct gd_point vertex = test_vertex(mesh, i);
        worst = fmax(worst,
                     check_at(field, &vertex, to_curve(&curve, gd_point_position(mesh, &vertex))));
    }
    gd_field_release(field);
    gd_curve_free(&curve);
    return worst;
}

/* A point between two segments of a curve emits no windows if the curve is straight there. Vertices
 * close to this point get their distance from the segments. */
static void lines_beside_vertices(void **state)
{
    (void)state;
    double worst = 0;
    for (int turn = 0; turn < TURNS; turn++) {
        double angle = 0.1 * turn;
        open_turned_square(angle);
        for (double apart = 0.4; fabs(apart) > 1e-15; apart /= -7.1)
            worst = fmax(worst, check_beside(angle + turn % 4 * M_PI / 4, apart));
        close_square();
    }
    print_message("# distances off by %.1e at most\n", worst);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rings_of_segments),
                                       cmocka_unit_test(rings_of_points),
                                       cmocka_unit_test(lines_beside_vertices)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
