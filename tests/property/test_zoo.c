/* Tests degenerate shapes. Distances must equal a closed form or the distances of the brute-force
 * solver up to 1e-9, or the engine must reject the mesh. */
#include "tests/samples/zoo.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/query.h"
#include "tests/oracle/closed_forms.h"
#include "tests/oracle/unfold.h"
#include "tests/support/laws.h"

static const double promise = 1e-9;

enum {
    SOURCES = 8,
    TARGETS = 40,
    PATHS = 10,
    PAIRS = 3,
    MAX_VALUES = 4,
    MAX_PLACES = SOURCES + TARGETS
};

/* Returns the distance of two points in the chart, which is the unfolded surface. `values` are the
 * parameters of the shape. */
typedef double closed_form(const double *values, const double p[3], const double q[3]);

/* --- closed forms ----------------------------------------------------------------------------- */

static double plane(const double *values, const double p[3], const double q[3])
{
    (void)values;
    return hypot(p[0] - q[0], p[1] - q[1]);
}

/* A path from the front of the pillow to its back crosses one of the four rims. The length of the
 * path is the distance to the point's reflection in this rim. */
static double pillow(const double *values, const double p[3], const double q[3])
{
    double best = INFINITY;
    if (p[2] * q[2] >= 0) return plane(values, p, q);
    for (int axis = 0; axis < 2; axis++) {
        double along = p[!axis] - q[!axis];
        best = fmin(best, hypot(p[axis] + q[axis], along));
        best = fmin(best, hypot(2 * values[axis] - p[axis] - q[axis], along));
    }
    return best;
}

static double tube(const double *values, const double p[3], const double q[3])
{
    return closed_form_prism(values[0], (uint32_t)values[2], p, q);
}

static double fan(const double *values, const double p[3], const double q[3])
{
    struct closed_form_fan form = {
        values[0], values[1], {values[2], -values[2]}, (uint32_t)values[3]};
    return closed_form_fan(&form, p, q);
}

/* --- the table -------------------------------------------------------------------------------- */

struct animal {
    const char *name;
    zoo_maker *make;
    double values[MAX_VALUES];
    closed_form *distance; /* the closed form, or NULL to compare with the brute-force solver */
};

struct refused {
    const char *name;
    zoo_maker *make;
    double values[MAX_VALUES];
    enum gd_status status;
};

static const struct refused refusals[] = {
    {"edge of length zero", zoo_twin_vertices, {0}, GD_DEGENERATE_FACE},
    {"repeated corner", zoo_repeated_corner, {0}, GD_DEGENERATE_FACE},
    {"three corners on a line", zoo_cap, {0}, GD_DEGENERATE_FACE},
    {"height of 9e-8", zoo_cap, {9e-8}, GD_DEGENERATE_FACE},
    {"box without height", zoo_box, {1, 1, 0}, GD_DEGENERATE_FACE},
    {"box of height 9e-8", zoo_box, {1, 1, 9e-8}, GD_DEGENERATE_FACE},
    {"tube 1e4 long, radius 1e-4", zoo_tube, {1e-4, 1e4, 3, 1}, GD_DEGENERATE_FACE},
    {"duplicate face", zoo_duplicate_face, {0}, GD_DUPLICATE_FACE},
    {"duplicate face, turned over", zoo_duplicate_face, {1}, GD_DUPLICATE_FACE},
    {"three faces at an edge", zoo_three_at_edge, {0}, GD_NON_MANIFOLD_EDGE},
    {"two fans at a vertex", zoo_bow_tie, {0}, GD_NON_MANIFOLD_VERTEX},
    {"Moebius band", zoo_moebius, {12}, GD_NON_ORIENTABLE},
    {"not a number", zoo_not_finite, {NAN}, GD_NON_FINITE},
    {"infinite", zoo_not_finite, {-INFINITY}, GD_NON_FINITE},
    {"scale 1e160", zoo_tangle, {1, 24, 1e160, 0}, GD_EXTENT},
    {"scale 1e-160", zoo_tangle, {1, 24, 1e-160, 0}, GD_EXTENT},
    {"parts of scale 1 and 1e-80", zoo_assembly, {1, 1e-80}, GD_EXTENT},
};

static const struct animal animals[] = {
    {"cap of height 2e-7", zoo_cap, {2e-7}, plane},
    {"cap of height 1e-6", zoo_cap, {1e-6}, plane},
    {"cap of height 1e-3", zoo_cap, {1e-3}, plane},
    {"needles 10,000:1", zoo_needles, {12, 12, 12e4, 0}, plane},
    {"needles 10,000:1, slanted", zoo_needles, {12, 12, 12e4, 3333}, plane},
    {"needles 1:10,000, slanted", zoo_needles, {12, 12, 12e-4, 0.3e-4}, plane},
    {"needles 1,000,000:1", zoo_needles, {4, 8, 4e6, 0}, plane},
    {"wheel of 1,000 spokes", zoo_wheel, {1000, 0}, plane},
    {"wheel of 20,000 spokes", zoo_wheel, {20000, 0}, plane},
    {"wheel of 1,000 spokes, hub near the rim", zoo_wheel, {1000, 0.99999}, plane},
    {"accordion", zoo_accordion, {12, 6, 12, 3}, plane},
    {"accordion, each column folded", zoo_accordion, {12, 6, 12, 11}, plane},
    {"accordion 1:30,000", zoo_accordion, {12, 6, 12.0 / 30000, 5}, plane},
    {"accordion 30,000:1", zoo_accordion, {12, 6, 12 * 30000.0, 5}, plane},
    {"pillow", zoo_pillow, {3, 2, 6}, pillow},
    {"pillow 10,000:1", zoo_pillow, {1e4, 1, 6}, pillow},
    {"tube 1e4 long, radius 1", zoo_tube, {1, 1e4, 8, 1}, tube},
    {"tube 1e4 long, radius 1e-2", zoo_tube, {1e-2, 1e4, 6, 1}, tube},
    {"tube 1e4 long, radius 1e-3", zoo_tube, {1e-3, 1e4, 5, 1}, tube},
    {"tube 1e4 long, radius 1e-3, 3 sides", zoo_tube, {1e-3, 1e4, 3, 1}, tube},
    {"tube 1e4 long, radius 1, 40 rings", zoo_tube, {1, 1e4, 64, 40}, tube},
    {"cone of angle 1e-2", zoo_fan, {5e-3, 1, 0, 8}, fan},
    {"cone of angle 1e-4", zoo_fan, {5e-5, 1, 0, 8}, fan},
    {"cone of angle 1e-6", zoo_fan, {5e-7, 1, 0, 8}, fan},
    {"cone of 4,096 faces", zoo_fan, {1, 1, 0, 4096}, fan},
    {"saddle of 20 pi", zoo_fan, {1, 0, 0.99383, 40}, fan},
    {"saddle of 200 pi", zoo_fan, {1, 0, 0.99994, 400}, fan},
    {"saddle of 2,000 faces", zoo_fan, {1, 0, 0.001, 2000}, fan},
    {"box of height 2.2e-7", zoo_box, {1, 1, 2.2e-7}, NULL},
    {"box of height 1e-6", zoo_box, {1, 1, 1e-6}, NULL},
    {"box 1 x 1e-3 x 1e-6", zoo_box, {1, 1e-3, 1e-6}, NULL},
    {"octahedron 1:1:1e4", zoo_octahedron, {1, 1, 1e4}, NULL},
    {"octahedron 1:1:1e-6", zoo_octahedron, {1, 1, 1e-6}, NULL},
    {"octahedron 1:1e3:1e6", zoo_octahedron, {1, 1e3, 1e6}, NULL},
    {"partly folded grid", zoo_crumpled, {1, 1, 5, 5}, NULL},
    {"partly folded grid, 30,000:1", zoo_crumpled, {2, 30000, 5, 5}, NULL},
    {"partly folded grid, 1:30,000", zoo_crumpled, {3, 1.0 / 30000, 5, 5}, NULL},
    {"scale 1e-40", zoo_tangle, {3, 40, 1e-40, 0}, NULL},
    {"scale 1e-20", zoo_tangle, {4, 40, 1e-20, 0}, NULL},
    {"scale 1e20", zoo_tangle, {5, 40, 1e20, 0}, NULL},
    {"scale 1e40", zoo_tangle, {6, 40, 1e40, 0}, NULL},
    {"offset 1e7", zoo_tangle, {7, 40, 1, 1e7}, NULL},
    {"offset 1e12", zoo_tangle, {8, 40, 1, 1e12}, NULL},
    {"parts of scale 1 and 1e-6", zoo_assembly, {9, 1e-6}, NULL},
    {"parts of scale 1 and 1e-40", zoo_assembly, {10, 1e-40}, NULL},
    {"spike of 1e4", zoo_spike, {5, 1e4}, NULL},
    {"spike of 1e6", zoo_spike, {5, 1e6}, NULL},
};

enum { REFUSALS = sizeof refusals / sizeof *refusals, ANIMALS = sizeof animals / sizeof *animals };

/* --- refused ---------------------------------------------------------------------------------- */

static void test_refused(void **state)
{
    (void)state;
    for (int i = 0; i < REFUSALS; i++) {
        struct zoo_shape shape = {0};
        assert_int_equal(refusals[i].make(refusals[i].values, &shape), GD_OK);
        struct gd_mesh *mesh = NULL;
        struct gd_detail detail = {0};
        enum gd_status status = gd_mesh_build(&shape.mesh, NULL, NULL, &mesh, &detail);
        if (status != refusals[i].status)
            print_error("%s: %s, not %s\n", refusals[i].name, gd_status_name(status),
                        gd_status_name(refusals[i].status));
        assert_int_equal(status, refusals[i].status);
        assert_null(mesh);
        assert_true(detail.text[0] != '\0');
        zoo_shape_free(&shape);
    }
    print_message("# %d shapes refused by name\n", REFUSALS);
}

/* --- answered --------------------------------------------------------------------------------- */

/* Points on a shape. The sources come first, beginning with the shape's centre. */
struct places {
    struct test_place at[MAX_PLACES];
};

static struct test_place place_at_vertex(const struct gd_polygons *mesh, uint32_t vertex)
{
    uint32_t slot = 0;
    while (mesh->corners[slot] != vertex) slot++;
    struct test_place place = {.face = slot / 3};
    place.weight[slot % 3] = 1;
    return place;
}

static struct places choose_places(const struct zoo_shape *shape, struct rng *rng)
{
    struct places places;
    places.at[0] = place_at_vertex(&shape->mesh, shape->centre);
    for (int i = 1; i < MAX_PLACES; i++) places.at[i] = test_random_place(&shape->mesh, rng);
    places.at[SOURCES].face = places.at[1].face; /* a target in the face of a source */
    return places;
}

/* distance[s][t] is the distance from source s to target t. */
struct answers {
    double distance[SOURCES][TARGETS];
};

static void chart_position(const struct zoo_shape *shape, struct test_place place, double out[3])
{
    struct gd_polygons chart = shape->mesh;
    if (shape->chart) chart.positions = shape->chart;
    test_place_position(&chart, place, out);
}

static void ask_closed_form(const struct animal *animal, const struct zoo_shape *shape,
                            const struct places *places, struct answers *out)
{
    for (int s = 0; s < SOURCES; s++) {
        double from[3], to[3];
        chart_position(shape, places->at[s], from);
        for (int t = 0; t < TARGETS; t++) {
            chart_position(shape, places->at[SOURCES + t], to);
            out->distance[s][t] = animal->distance(animal->values, from, to);
        }
    }
}

/* Moves the shape to the origin. There, rounding errors of positions on edges and in faces are
 * relative to the shape's size. */
static struct unfold_mesh *unfold_about_origin(const struct zoo_shape *shape)
{
    const struct gd_polygons *polygons = &shape->mesh;
    double(*positions)[3] = calloc(polygons->position_count, sizeof *positions);
    assert_non_null(positions);
    for (uint32_t v = 0; v < polygons->position_count; v++)
        for (int axis = 0; axis < 3; axis++)
            positions[v][axis] = polygons->positions[v][axis] - shape->offset;
    struct unfold_mesh *mesh =
        unfold_create((const double(*)[3])positions, polygons->position_count, polygons->corners,
                      polygons->polygon_count, MAX_PLACES);
    free(positions);
    assert_non_null(mesh);
    return mesh;
}

static void ask_brute_force(const struct zoo_shape *shape, const struct places *places,
                            struct answers *out)
{
    struct unfold_mesh *mesh = unfold_about_origin(shape);
    long double *distance = calloc(shape->mesh.position_count + MAX_PLACES, sizeof *distance);
    assert_non_null(distance);
    uint32_t vertex[MAX_PLACES];
    for (int i = 0; i < MAX_PLACES; i++)
        vertex[i] = unfold_insert(mesh, places->at[i].face, places->at[i].weight);
    for (int s = 0; s < SOURCES; s++) {
        unfold_distances(mesh, vertex[s], distance);
        for (int t = 0; t < TARGETS; t++)
            out->distance[s][t] = (double)distance[vertex[SOURCES + t]];
    }
    free(distance);
    unfold_free(mesh);
}

static double check_path(const struct gd_field *field, struct gd_point target, double expected)
{
    struct gd_path path = {0};
    check_ok(gd_field_path(field, &target, &path), NULL);
    double error = check_close(path.length, expected, promise);
    gd_path_free(&path);
    return error;
}

static double check_pair(const struct gd_mesh *mesh, struct gd_point source, struct gd_point target,
                         double expected)
{
    struct gd_pair_answer answer = {0};
    check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &source, .to = &target}, NULL,
                           &answer, NULL),
             NULL);
    double error = check_close(answer.distance, expected, promise);
    gd_pair_answer_free(&answer);
    return error;
}

static double check_source(const struct gd_mesh *mesh, const struct places *places, int source,
                           const double *expected)
{
    struct gd_seed seed = {.point = test_point(mesh, places->at[source])};
    struct gd_field *field = NULL;
    double worst = 0;
    check_ok(gd_field_build(mesh, &(struct gd_field_request){.seeds = &seed, .seed_count = 1}, NULL,
                            &field, NULL),
             NULL);
    for (int t = 0; t < TARGETS; t++) {
        struct gd_point target = test_point(mesh, places->at[SOURCES + t]);
        double distance = NAN;
        check_ok(gd_field_distance(field, &target, &distance), NULL);
        worst = fmax(worst, check_close(distance, expected[t], promise));
        if (t < PATHS && isfinite(expected[t]))
            worst = fmax(worst, check_path(field, target, expected[t]));
        if (t < PAIRS) worst = fmax(worst, check_pair(mesh, seed.point, target, expected[t]));
    }
    gd_field_release(field);
    return worst;
}

static void check_animal(const struct animal *animal, uint64_t seed)
{
    struct rng rng = {seed};
    struct zoo_shape shape = {0};
    struct answers *expected = calloc(1, sizeof *expected);
    assert_non_null(expected);
    assert_int_equal(animal->make(animal->values, &shape), GD_OK);
    struct places places = choose_places(&shape, &rng);
    if (animal->distance)
        ask_closed_form(animal, &shape, &places, expected);
    else
        ask_brute_force(&shape, &places, expected);
    struct gd_mesh *mesh = test_mesh(&shape.mesh);
    double worst = 0;
    for (int s = 0; s < SOURCES; s++)
        worst = fmax(worst, check_source(mesh, &places, s, expected->distance[s]));
    law_lipschitz(mesh, &shape.mesh, test_point(mesh, places.at[0]));
    print_message("# %s, %u faces, against %s: worst error %.2g\n", animal->name,
                  shape.mesh.polygon_count, animal->distance ? "a closed form" : "brute force",
                  worst);
    gd_mesh_release(mesh);
    free(expected);
    zoo_shape_free(&shape);
}

static void test_answered(void **state)
{
    (void)state;
    for (int i = 0; i < ANIMALS; i++) check_animal(&animals[i], (uint64_t)i);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
