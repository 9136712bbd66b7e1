/* Tests the laws of the metric on surfaces without known distances. Also tests changes of a mesh
 * that preserve distances. */
#include <math.h>
#include <stdlib.h>

#include "gd/field.h"
#include "tests/samples/samples.h"
#include "tests/samples/transform.h"
#include "tests/support/laws.h"

static const double promise = 1e-9;

enum { PAIRS = 8 };

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {
    {"icosphere", {3, 1}},     {"torus", {36, 18, 1, 0.4}},    {"terrain", {30, 0.2, 7}},
    {"terrain", {12, 2, 8}},   {"genus2", {4, 0.03}},          {"saddle", {1, 0.6, 5, 9}},
    {"obstacles", {8, 1, 3}},  {"cylinder", {0.05, 3, 24, 5}}, {"tangle", {200, 11}},
    {"box", {1, 1, 0.001, 6}},
};

enum { SURFACES = sizeof surfaces / sizeof *surfaces };

static struct gd_polygons generate(int i)
{
    const struct sample *sample = sample_find(surfaces[i].name);
    assert_non_null(sample);
    struct gd_polygons polygons;
    assert_int_equal(sample->generate(surfaces[i].values, &polygons), GD_OK);
    return polygons;
}

static void test_metric(void **state)
{
    (void)state;
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {(uint64_t)i};
        struct gd_polygons polygons = generate(i);
        struct gd_mesh *mesh = test_mesh(&polygons);
        double worst = 0, worst_path = 0;
        for (int k = 0; k < PAIRS; k++) {
            struct gd_point p = test_point(mesh, test_random_place(&polygons, &rng));
            struct gd_point q = test_point(mesh, test_random_place(&polygons, &rng));
            struct gd_point r = test_point(mesh, test_random_place(&polygons, &rng));
            worst = fmax(worst, law_metric(mesh, p, q, r));
            if (isfinite(law_distance(mesh, p, q)))
                worst_path = fmax(worst_path, law_path(mesh, &polygons, p, q));
            law_lipschitz(mesh, &polygons, p);
        }
        print_message("# %s: symmetric to %.2g, paths to %.2g\n", surfaces[i].name, worst,
                      worst_path);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* On steep surfaces, the distance of a vertex may fall several times during the propagation, and
 * the vertex emits windows each time. Stored wedges must not block newer windows. Distances between
 * all vertices must be the same in both directions. */
static void test_steep(void **state)
{
    (void)state;
    /* each row has cells, amplitude and seed */
    static const double steep[][3] = {{8, 20, 1}, {12, 30, 2}, {16, 30, 3}, {20, 10, 5}};
    for (size_t i = 0; i < sizeof steep / sizeof *steep; i++) {
        struct gd_polygons polygons;
        assert_int_equal(
            sample_terrain((uint32_t)steep[i][0], steep[i][1], (uint64_t)steep[i][2], &polygons),
            GD_OK);
        struct gd_mesh *mesh = test_mesh(&polygons);
        uint32_t count = polygons.position_count;
        double *distance = calloc((size_t)count * count, sizeof *distance), worst = 0;
        assert_non_null(distance);
        for (uint32_t v = 0; v < count; v++) {
            struct gd_seed seed = {.offset = 0};
            struct gd_field *field = NULL;
            check_ok(gd_point_at_vertex(mesh, (struct gd_vertex){v}, &seed.point, NULL), NULL);
            check_ok(gd_field_build(mesh,
                                    &(struct gd_field_request){.seeds = &seed, .seed_count = 1},
                                    NULL, &field, NULL),
                     NULL);
            gd_field_vertex_distances(field, distance + (size_t)v * count);
            gd_field_release(field);
        }
        for (uint32_t a = 0; a < count; a++)
            for (uint32_t b = 0; b < a; b++)
                worst = fmax(worst, check_close(distance[(size_t)a * count + b],
                                                distance[(size_t)b * count + a], promise));
        print_message("# terrain of amplitude %g, all %u pairs of vertices: symmetric to %.2g\n",
                      steep[i][1], count * (count - 1) / 2, worst);
        free(distance);
        gd_mesh_release(mesh);
        gd_polygons_free(&polygons);
    }
}

/* Pairs of points and the distances between them. */
struct pairs {
    struct test_place from[PAIRS], to[PAIRS];
    double distance[PAIRS];
};

static struct pairs measure(const struct gd_polygons *polygons, struct rng *rng)
{
    struct pairs pairs;
    struct gd_mesh *mesh = test_mesh(polygons);
    for (int k = 0; k < PAIRS; k++) {
        pairs.from[k] = test_random_place(polygons, rng);
        pairs.to[k] = test_random_place(polygons, rng);
        pairs.distance[k] =
            law_distance(mesh, test_point(mesh, pairs.from[k]), test_point(mesh, pairs.to[k]));
    }
    gd_mesh_release(mesh);
    return pairs;
}

/* Checks that the pairs' distances on a changed mesh are `factor` times as long. */
static double measure_again(const struct gd_polygons *polygons, const struct pairs *pairs,
                            double factor, double tolerance)
{
    double worst = 0;
    struct gd_mesh *mesh = test_mesh(polygons);
    for (int k = 0; k < PAIRS; k++) {
        double distance =
            law_distance(mesh, test_point(mesh, pairs->from[k]), test_point(mesh, pairs->to[k]));
        worst = fmax(worst, check_close(distance, factor * pairs->distance[k], tolerance));
    }
    gd_mesh_release(mesh);
    return worst;
}

static void test_rigid_motion(void **state)
{
    (void)state;
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {100 + (uint64_t)i};
        struct gd_polygons polygons = generate(i);
        struct pairs pairs = measure(&polygons, &rng);
        sample_move(&polygons, 3, rng_next(&rng));
        double worst = measure_again(&polygons, &pairs, 1, promise);
        print_message("# %s, moved: worst error %.2g\n", surfaces[i].name, worst);
        gd_polygons_free(&polygons);
    }
}

static void test_scale(void **state)
{
    (void)state;
    static const double factors[] = {1e-6, 1.0 / 3, 1e6, 1e-100, 1e100};
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {200 + (uint64_t)i};
        struct gd_polygons polygons = generate(i);
        struct pairs pairs = measure(&polygons, &rng);
        double worst = 0, total = 1;
        for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
            sample_scale(&polygons, factors[k] / total, factors[k] / total, factors[k] / total);
            total = factors[k];
            worst = fmax(worst, measure_again(&polygons, &pairs, total, promise));
        }
        print_message("# %s, scaled by 1e-100 to 1e100: worst error %.2g\n", surfaces[i].name,
                      worst);
        gd_polygons_free(&polygons);
    }
}

/* Returns the same point in the renumbered mesh. */
static struct test_place renumbered(const struct gd_polygons *before,
                                    const struct gd_polygons *after, struct test_place place,
                                    const uint32_t *vertex_map, const uint32_t *face_map)
{
    struct test_place moved = {.face = face_map[place.face]};
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t j = 0; j < 3; j++)
            if (after->corners[3 * moved.face + j] ==
                vertex_map[before->corners[3 * place.face + k]])
                moved.weight[j] = place.weight[k];
    return moved;
}

static void test_renumbering_and_orientation(void **state)
{
    (void)state;
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {300 + (uint64_t)i};
        struct gd_polygons before = generate(i), after = generate(i);
        struct pairs pairs = measure(&before, &rng);
        uint32_t *vertex_map = calloc(before.position_count, sizeof *vertex_map);
        uint32_t *face_map = calloc(before.polygon_count, sizeof *face_map);
        assert_true(vertex_map && face_map);
        assert_int_equal(sample_renumber(&after, rng_next(&rng), vertex_map, face_map), GD_OK);
        sample_flip_faces(&after, 0.5, rng_next(&rng));
        for (int k = 0; k < PAIRS; k++) {
            pairs.from[k] = renumbered(&before, &after, pairs.from[k], vertex_map, face_map);
            pairs.to[k] = renumbered(&before, &after, pairs.to[k], vertex_map, face_map);
        }
        double worst = measure_again(&after, &pairs, 1, promise);
        print_message("# %s, renumbered and turned over: worst error %.2g\n", surfaces[i].name,
                      worst);
        free(vertex_map);
        free(face_map);
        gd_polygons_free(&before);
        gd_polygons_free(&after);
    }
}

/* Returns the same point after sample_subdivide. */
static struct test_place in_quarter(struct test_place place)
{
    const double *w = place.weight;
    for (uint32_t k = 0; k < 3; k++)
        if (w[k] >= 0.5)
            return (struct test_place){4 * place.face + k,
                                       {2 * w[k] - 1, 2 * w[(k + 1) % 3], 2 * w[(k + 2) % 3]}};
    return (struct test_place){4 * place.face + 3, {1 - 2 * w[2], 1 - 2 * w[0], 1 - 2 * w[1]}};
}

static void test_subdivision_of_flat_faces(void **state)
{
    (void)state;
    for (int i = 0; i < SURFACES; i++) {
        struct rng rng = {400 + (uint64_t)i};
        struct gd_polygons polygons = generate(i);
        struct pairs pairs = measure(&polygons, &rng);
        assert_int_equal(sample_subdivide(&polygons), GD_OK);
        for (int k = 0; k < PAIRS; k++)
            pairs.from[k] = in_quarter(pairs.from[k]), pairs.to[k] = in_quarter(pairs.to[k]);
        double worst = measure_again(&polygons, &pairs, 1, 1e-12);
        print_message("# %s, subdivided: worst error %.2g\n", surfaces[i].name, worst);
        gd_polygons_free(&polygons);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_metric),
        cmocka_unit_test(test_steep),
        cmocka_unit_test(test_rigid_motion),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_renumbering_and_orientation),
        cmocka_unit_test(test_subdivision_of_flat_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
