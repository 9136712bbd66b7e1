/* Computes fields of sources very close to vertices, and compares them with the solver by naive
 * windows. The targets are vertices, points inside faces, and points close to the same vertex. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gd/locate.h"
#include "gd/query.h"
#include "tests/support/exact_run.h"

enum { FIELDS = 6, PLACES = 24, NEAR = 6, SETS_MOST = 5 };

static const double SNAP = 1e-14;     /* edge lengths; the engine moves a point by at most this */
static const double ROUNDING = 1e-11; /* permitted relative difference of two compared distances */

static struct gd_field *build_field(struct exact_unit *unit)
{
    struct gd_field *field = NULL;
    struct gd_field_request request = {.seeds = unit->seeds, .seed_count = unit->seed_count};
    enum gd_status status = gd_field_build(unit->scene->mesh, &request, NULL, &field, NULL);
    if (status) exact_failure(unit, "gd_field_build", status, &unit->seeds[0].point);
    return field;
}

static void compare_at(struct exact_unit *unit, struct exact_truth *truth,
                       const struct gd_field *field, struct gd_point point)
{
    double distance = NAN;
    enum gd_status status = gd_field_distance(field, &point, &distance);
    if (status)
        exact_failure(unit, "gd_field_distance", status, &point);
    else
        exact_answer(unit, truth, &point, distance);
}

static struct gd_point vertex_point(const struct exact_scene *scene, uint32_t index)
{
    struct gd_point point = {0};
    if (gd_point_at_vertex(scene->mesh, (struct gd_vertex){index}, &point, NULL)) abort();
    return point;
}

/* Checks the field of seeds close to `vertex` at all vertices, at random points and close to
 * `vertex`. */
static void check_field(struct exact_scene *scene, uint32_t vertex, const struct gd_seed *seeds,
                        uint32_t count, struct exact_tally *tally)
{
    struct exact_unit unit = {.scene = scene, .seeds = seeds, .seed_count = count};
    struct exact_truth truth;
    exact_truth_open(scene, seeds, count, INFINITY, &truth);
    struct gd_field *field = build_field(&unit);
    for (uint32_t v = 0; field && v < scene->polygons.position_count; v++)
        compare_at(&unit, &truth, field, vertex_point(scene, v));
    for (int i = 0; field && i < PLACES; i++) compare_at(&unit, &truth, field, exact_random(scene));
    for (int i = 0; field && i < NEAR; i++)
        compare_at(&unit, &truth, field, exact_beside_vertex(scene, vertex, -15, -1));
    gd_field_release(field);
    exact_truth_close(&truth);
    exact_conclude(&unit, tally);
}

/* Uses random sources on ordinary surfaces, which test both solvers. */
static void general_position(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_GRADED), number, &scene);
    for (int i = 0; i < FIELDS; i++) {
        struct gd_seed seed = {.point = exact_random(&scene)};
        struct exact_unit unit = {.scene = &scene, .seeds = &seed, .seed_count = 1};
        struct exact_truth truth;
        exact_truth_open(&scene, &seed, 1, INFINITY, &truth);
        struct gd_field *field = build_field(&unit);
        for (uint32_t v = 0; field && v < scene.polygons.position_count; v++)
            compare_at(&unit, &truth, field, vertex_point(&scene, v));
        for (int k = 0; field && k < PLACES; k++)
            compare_at(&unit, &truth, field, exact_random(&scene));
        gd_field_release(field);
        exact_truth_close(&truth);
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

static void one_source(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < FIELDS; i++) {
        uint32_t vertex = exact_random_vertex(&scene);
        struct gd_seed seed = {.point = exact_beside_vertex(&scene, vertex, -15, -9)};
        check_field(&scene, vertex, &seed, 1, tally);
    }
    exact_scene_close(&scene);
}

static void several_sources(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < FIELDS; i++) {
        uint32_t vertex = exact_random_vertex(&scene),
                 count = 2 + rng_below(&scene.rng, SETS_MOST - 1);
        bool has_offsets = rng_below(&scene.rng, 4) == 0;
        struct gd_seed seeds[SETS_MOST] = {0};
        for (uint32_t k = 0; k < count; k++) {
            seeds[k].point = exact_beside_vertex(&scene, vertex, -15, -12);
            if (has_offsets) seeds[k].offset = 1e-12 * scene.mean_edge * rng_unit(&scene.rng);
        }
        check_field(&scene, vertex, seeds, count, tally);
    }
    exact_scene_close(&scene);
}

/* --- vertices written with few digits --------------------------------------------------------- */

static double rounded(double x, int digits)
{
    char text[64];
    snprintf(text, sizeof text, "%.*g", digits, x);
    return strtod(text, NULL);
}

/* Checks the law |d(s, x) - d(v, x)| <= |sv|, and both distances, for a source s close to a vertex
 * v. */
static void check_law(struct exact_unit *unit, struct exact_truth *truth,
                      const struct gd_field *beside, const struct gd_field *vertex,
                      struct gd_point point, double apart)
{
    double ds = NAN, dv = NAN;
    enum gd_status status = gd_field_distance(beside, &point, &ds);
    if (!status) status = gd_field_distance(vertex, &point, &dv);
    if (status) {
        exact_failure(unit, "gd_field_distance", status, &point);
        return;
    }
    exact_law(unit, &point, ds, dv, fabs(ds - dv) / (apart * (1 + EXACT_PROMISE) + ROUNDING * dv));
    exact_answer(unit, truth, &point, ds);
}

static void check_rounded(struct exact_scene *scene, uint32_t index, const struct gd_seed *seed,
                          struct exact_tally *tally)
{
    struct gd_seed at_vertex = {.point = vertex_point(scene, index)};
    struct exact_unit unit = {.scene = scene, .seeds = seed, .seed_count = 1}, other = unit;
    other.seeds = &at_vertex;
    struct exact_truth truth;
    exact_truth_open(scene, seed, 1, INFINITY, &truth);
    struct gd_field *beside = build_field(&unit), *vertex = build_field(&other);
    double apart = exact_distance(&truth, &at_vertex.point);
    if (!vertex) unit.failure = other.failure;
    for (uint32_t v = 0; beside && vertex && v < scene->polygons.position_count; v++)
        check_law(&unit, &truth, beside, vertex, vertex_point(scene, v), apart);
    for (int i = 0; beside && vertex && i < PLACES; i++)
        check_law(&unit, &truth, beside, vertex, exact_random(scene), apart);
    gd_field_release(beside);
    gd_field_release(vertex);
    exact_truth_close(&truth);
    exact_conclude(&unit, tally);
}

static void rounded_vertices(uint64_t number, struct exact_tally *tally)
{
    static const double offsets[3] = {0, 1e2, 1e4};
    uint32_t turn = (uint32_t)(number / 4 % 3);
    enum exact_kind kind = (enum exact_kind)(number % EXACT_KINDS);
    struct exact_scene scene;
    /* far from the origin the small faces of this kind would degenerate */
    if (kind == EXACT_GRADED) turn = 0;
    exact_scene_open_at(kind, number, offsets[turn], &scene);
    for (int i = 0; i < FIELDS; i++) {
        uint32_t vertex = exact_random_vertex(&scene);
        const double *p = scene.polygons.positions[vertex];
        int digits = 13 + i % 3;
        struct gd_vec3 xyz = {rounded(p[0], digits), rounded(p[1], digits), rounded(p[2], digits)};
        struct gd_seed seed = {0};
        enum gd_status status = gd_locate_nearest(scene.mesh, xyz, -1, &seed.point, NULL);
        if (status) abort();
        check_rounded(&scene, vertex, &seed, tally);
    }
    exact_scene_close(&scene);
}

/* --- snapping --------------------------------------------------------------------------------- */

/* If a point is given by weights, the engine must move it by at most 1e-14 edge lengths. */
static void check_weights(struct exact_scene *scene, struct exact_tally *tally)
{
    struct rng *rng = &scene->rng;
    struct naive_point wanted = {.face = rng_below(rng, scene->polygons.polygon_count)};
    uint32_t k = rng_below(rng, 3);
    const uint32_t *corner = &scene->polygons.corners[3 * wanted.face];
    double apart = pow(10, rng_between(rng, -17, -12)), part = rng_unit(rng), edge = 0;
    wanted.weight[k] = 1 - apart;
    wanted.weight[(k + 1) % 3] = apart * part;
    wanted.weight[(k + 2) % 3] = apart * (1 - part);
    for (uint32_t i = 0; i < 3; i++)
        edge =
            fmax(edge, gd_vec3_distance(
                           gd_mesh_position(scene->mesh, (struct gd_vertex){corner[i]}),
                           gd_mesh_position(scene->mesh, (struct gd_vertex){corner[(i + 1) % 3]})));
    struct gd_seed seed = {0};
    struct exact_unit unit = {.scene = scene, .seeds = &seed, .seed_count = 1};
    if (gd_point_in_face(scene->mesh, (struct gd_face){wanted.face}, wanted.weight, &seed.point,
                         NULL))
        abort();
    struct exact_truth truth;
    exact_truth_open(scene, &seed, 1, 0, &truth);
    double moved = (double)naive_field_distance(truth.field, &wanted);
    exact_law(&unit, &seed.point, moved, SNAP * edge, moved / (1.01 * SNAP * edge));
    exact_truth_close(&truth);
    exact_conclude(&unit, tally);
}

/* Checks that the engine replaces a position by the nearest surface point, up to 1e-14 edge lengths
 * and the rounding of the coordinates. The reported distance must be the distance between the
 * position and this point. */
static void check_position(struct exact_scene *scene, struct exact_tally *tally)
{
    uint32_t index = exact_random_vertex(scene);
    struct gd_vec3 vertex = gd_mesh_position(scene->mesh, (struct gd_vertex){index});
    double apart = scene->mean_edge * pow(10, rng_between(&scene->rng, -17, -10));
    double rounding = 4e-15 * (fabs(vertex.x) + fabs(vertex.y) + fabs(vertex.z)), offset[3];
    for (int i = 0; i < 3; i++) offset[i] = apart * rng_between(&scene->rng, -1, 1);
    struct gd_vec3 xyz = gd_vec3_add(vertex, (struct gd_vec3){offset[0], offset[1], offset[2]});
    struct gd_seed seed = {0};
    struct exact_unit unit = {.scene = scene, .seeds = &seed, .seed_count = 1};
    if (gd_locate_nearest(scene->mesh, xyz, -1, &seed.point, NULL)) abort();
    double moved = gd_vec3_distance(xyz, gd_point_position(scene->mesh, &seed.point));
    double allowed = gd_vec3_distance(xyz, vertex) + SNAP * scene->mean_edge + rounding;
    double reported = gd_locate_distance(scene->mesh, xyz, &seed.point);
    exact_law(&unit, &seed.point, moved, allowed, moved / allowed);
    exact_law(&unit, &seed.point, reported, moved,
              fabs(reported - moved) / (rounding + 1e-14 * moved));
    exact_conclude(&unit, tally);
}

static void snaps(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    for (int i = 0; i < PLACES; i++) {
        check_weights(&scene, tally);
        check_position(&scene, tally);
    }
    exact_scene_close(&scene);
}

/* --- short distances -------------------------------------------------------------------------- */

static void compare_pair(struct exact_unit *unit, struct exact_truth *truth,
                         const struct gd_point *from, const struct gd_point *to,
                         const struct gd_point *target)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status =
        gd_pair_solve(unit->scene->mesh,
                      &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                      NULL, &answer, NULL);
    if (status) {
        exact_failure(unit, "gd_pair_solve", status, target);
        return;
    }
    exact_answer(unit, truth, target, answer.distance);
    exact_answer(unit, truth, target, answer.path.length);
    gd_pair_answer_free(&answer);
}

/* Uses a source close to a vertex. The targets are the vertex and points equally close to the
 * vertex. */
static void check_short_distances(enum exact_kind kind, uint64_t number, double least, double most,
                                  struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open(kind, number, &scene);
    for (int i = 0; i < FIELDS; i++) {
        uint32_t vertex = exact_random_vertex(&scene);
        double size = rng_between(&scene.rng, least, most);
        struct gd_seed seed = {.point = exact_beside_vertex(&scene, vertex, size, size + 0.3)};
        struct exact_unit unit = {.scene = &scene, .seeds = &seed, .seed_count = 1};
        struct exact_truth truth;
        exact_truth_open(&scene, &seed, 1, INFINITY, &truth);
        struct gd_field *field = build_field(&unit);
        for (int k = 0; k < NEAR; k++) {
            struct gd_point target = k ? exact_beside_vertex(&scene, vertex, size - 1, size + 0.3)
                                       : vertex_point(&scene, vertex);
            if (field) compare_at(&unit, &truth, field, target);
            compare_pair(&unit, &truth, &seed.point, &target, &target);
            compare_pair(&unit, &truth, &target, &seed.point, &target);
        }
        gd_field_release(field);
        exact_truth_close(&truth);
        exact_conclude(&unit, tally);
    }
    exact_scene_close(&scene);
}

static void short_distances(uint64_t number, struct exact_tally *tally)
{
    check_short_distances((enum exact_kind)(number % EXACT_KINDS), number, -14, -3, tally);
}

/* In these faces, the points are beside several edges at once, and the rounding errors of positions
 * are relative to the long edges. */
static void needles(uint64_t number, struct exact_tally *tally)
{
    check_short_distances(EXACT_NEEDLES, number, -9, -5, tally);
}

/* --- tubes ------------------------------------------------------------------------------------ */

static void thin_tubes(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open(EXACT_TUBE, number, &scene);
    for (int i = 0; i < FIELDS; i++) {
        struct gd_seed seed = {.point = exact_random(&scene)};
        check_field(&scene, exact_random_vertex(&scene), &seed, 1, tally);
    }
    exact_scene_close(&scene);
}

static const struct exact_section sections[] = {
    {"general_position", "fields with one source anywhere", general_position, 300, 20000,
     EXACT_HOLDS},
    {"one_source", "fields with one source 1e-15 to 1e-9 edge lengths from a vertex", one_source,
     600, 100000, EXACT_HOLDS},
    {"several_sources", "fields of 2 to 5 sources within 1e-12 of a vertex", several_sources, 150,
     5000, EXACT_HOLDS},
    {"rounded_vertices", "vertices written with 13 to 15 digits, up to 1e4 mesh sizes away",
     rounded_vertices, 300, 20000, EXACT_HOLDS},
    {"short_distances", "distances between points 1e-14 to 1e-3 edge lengths from a vertex",
     short_distances, 300, 20000, EXACT_HOLDS},
    {"needles", "distances beside vertices of faces 1e4 to 3e5 times as long as wide", needles, 600,
     20000, EXACT_HOLDS},
    {"snaps", "points move by at most 1e-14 edge lengths, as is reported", snaps, 1000, 100000,
     EXACT_HOLDS},
    {"thin_tubes", "fields on tubes down to 5e-9 of their length thin", thin_tubes, 24, 5000,
     EXACT_MAY_FAIL},
};

int main(int argc, char **argv)
{
    return exact_main(argc, argv, sections, sizeof sections / sizeof *sections);
}
