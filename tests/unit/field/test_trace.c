/* Tests paths that lead into or past faces that are much smaller than their neighbours. Every path
 * must be found, lie on the surface and be as long as the distance. GD_SCENES: patches of each kind
 * (60). */
#include "tests/support/test.h"

#include <math.h>
#include <stdlib.h>

#include "gd/query.h"
#include "mesh/segment.h"
#include "tests/samples/samples.h"
#include "tests/support/field.h"

enum { SCENES = 60, SOURCES = 8, TARGETS = 25, PAIR_EVERY = 5 };

static const double promise = 1e-9;

/* A kind of patch. `ratio` has the limits of the ratio between the sizes of consecutive rings. The
 * smallest ring is at most `depth` powers of ten smaller than the rim. */
struct kind {
    double ratio[2];
    double depth;
};

static struct gd_polygons random_patch(const struct kind *kind, struct rng *rng)
{
    double ratio = kind->ratio[0] * pow(kind->ratio[1] / kind->ratio[0], rng_unit(rng));
    uint32_t most = (uint32_t)(kind->depth / log10(ratio));
    struct sample_grading grading = {.patches = 1 + rng_below(rng, 2),
                                     .sectors = 4 + rng_below(rng, 6),
                                     .rings = 1 + rng_below(rng, most < 12 ? most : 12),
                                     .ratio = ratio,
                                     .bend = rng_below(rng, 3) ? rng_between(rng, -1, 1) : 0,
                                     .noise = rng_below(rng, 3) ? rng_between(rng, 0, 0.5) : 0};
    struct gd_polygons polygons;
    check_ok(sample_graded(&grading, rng_next(rng), &polygons), NULL);
    return polygons;
}

/* Checks that consecutive points share a face and that the segments' lengths sum to the
 * distance. */
static void check_path(const struct gd_mesh *mesh, const struct gd_path *path, double distance)
{
    double sum = 0;
    for (uint32_t i = 0; i + 1 < path->count; i++) {
        const struct gd_point *a = &path->points[i], *b = a + 1;
        assert_int_not_equal(gd__common_face(mesh, a, b), GD_NONE);
        sum += gd_vec3_distance(gd_point_position(mesh, a), gd_point_position(mesh, b));
    }
    double rounding = 1e-15 * path->count;
    assert_true(fabs(path->length - distance) <= promise * distance + rounding);
    assert_true(fabs(sum - distance) <= promise * distance + rounding);
}

static void check_pair(const struct gd_mesh *mesh, const struct gd_point *from,
                       const struct gd_point *to, double distance)
{
    struct gd_pair_answer answer;
    struct gd_detail detail = {0};
    check_ok(gd_pair_solve(
                 mesh, &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                 NULL, &answer, &detail),
             &detail);
    check_path(mesh, &answer.path, distance);
    gd_pair_answer_free(&answer);
}

/* Checks paths to random targets. If the field has a single seed, checks pair queries too. */
static void check_targets(const struct gd_polygons *polygons, const struct gd_field *field,
                          struct rng *rng)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    struct gd_point seed;
    for (int i = 0; i < TARGETS; i++) {
        struct gd_point target = test_point(mesh, test_random_place(polygons, rng));
        double distance = test_distance(field, &target);
        struct gd_path path;
        check_ok(gd_field_path(field, &target, &path), NULL);
        check_path(mesh, &path, distance);
        gd_path_free(&path);
        if (i % PAIR_EVERY == 0 && gd_field_single_seed(field, &seed))
            check_pair(mesh, &seed, &target, distance);
    }
}

static struct gd_field *random_field(const struct gd_polygons *polygons, const struct gd_mesh *mesh,
                                     bool of_curve, struct rng *rng)
{
    struct test_place place = test_random_place(polygons, rng);
    struct gd_point points[2] = {test_point(mesh, place)};
    struct gd_curve_request request = {.kind = GD_CURVE_POINTS, .points = points, .count = 2};
    struct gd_curve curve;
    if (!of_curve) return test_field_from(mesh, points[0]);
    for (int k = 0; k < 3; k++) place.weight[k] = 0.5 * (place.weight[k] + 1.0 / 3);
    points[1] = test_point(mesh, place);
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    struct gd_field *field = test_field_of_curve(mesh, &curve, 0);
    gd_curve_free(&curve);
    return field;
}

static void check_patches(const struct kind *kind, uint64_t seed)
{
    const char *asked = getenv("GD_SCENES");
    int scenes = asked ? atoi(asked) : SCENES;
    struct rng rng = {seed};
    for (int scene = 0; scene < scenes; scene++) {
        struct gd_polygons polygons = random_patch(kind, &rng);
        struct gd_mesh *mesh = test_mesh(&polygons);
        for (int i = 0; i < SOURCES; i++) {
            struct gd_field *field = random_field(&polygons, mesh, i % 4 == 3, &rng);
            check_targets(&polygons, field, &rng);
            gd_field_release(field);
        }
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

static void paths_through_rings(void **state)
{
    (void)state;
    check_patches(&(struct kind){{3, 100}, 14}, 1);
}

static void paths_through_rings_that_shrink_fast(void **state)
{
    (void)state;
    check_patches(&(struct kind){{1e3, 1e5}, 10}, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(paths_through_rings),
                                       cmocka_unit_test(paths_through_rings_that_shrink_fast)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
