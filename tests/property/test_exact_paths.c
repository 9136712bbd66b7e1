/* Tests paths into the smallest faces. Also computes the distance of one pair by every operation of
 * the engine, and compares the results. */
#include <math.h>
#include <stdlib.h>

#include "gd/landmarks.h"
#include "gd/query.h"
#include "tests/support/exact_run.h"

enum { SOURCES = 3, TARGETS = 4, LANES_MOST = 24, LANDMARKS = 4 };

/* permitted relative difference between the results of two operations */
static const double ONE_LANE = 1e-12;

static struct gd_field *field_from(struct exact_unit *unit, const struct gd_point *point,
                                   double radius, const struct gd_point *target)
{
    struct gd_field *field = NULL;
    struct gd_seed seed = {.point = *point};
    struct gd_field_request request = {
        .seeds = &seed, .seed_count = 1, .radius = radius, .target = target};
    enum gd_status status = gd_field_build(unit->scene->mesh, &request, NULL, &field, NULL);
    if (status) exact_failure(unit, "gd_field_build", status, point);
    return field;
}

/* --- paths ------------------------------------------------------------------------------------ */

static void answer_path(struct exact_unit *unit, struct exact_truth *truth,
                        const struct gd_point *to, enum gd_status status, struct gd_path *path)
{
    if (status)
        exact_failure(unit, "gd_field_path", status, to);
    else
        exact_answer(unit, truth, to, path->length);
    gd_path_free(path);
}

static void ask_pair(struct exact_unit *unit, struct exact_truth *truth,
                     const struct gd_point *from, const struct gd_point *to,
                     const struct gd_point *target)
{
    struct gd_pair_answer answer = {0};
    enum gd_status status = gd_pair_solve(
        unit->scene->mesh, &(struct gd_pair_request){.from = from, .to = to}, NULL, &answer, NULL);
    if (status)
        exact_failure(unit, "gd_pair_solve, distance", status, target);
    else
        exact_answer(unit, truth, target, answer.distance);
    gd_pair_answer_free(&answer);
    status =
        gd_pair_solve(unit->scene->mesh,
                      &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH},
                      NULL, &answer, NULL);
    if (status)
        exact_failure(unit, "gd_pair_solve, path", status, target);
    else
        exact_answer(unit, truth, target, answer.path.length);
    gd_pair_answer_free(&answer);
}

/* Checks a path by pair search and by fields, in both directions. */
static void check_path(const struct exact_scene *scene, struct exact_truth *truth,
                       const struct gd_field *field, const struct gd_seed *seed, struct gd_point to,
                       struct exact_tally *tally)
{
    struct exact_unit unit = {.scene = scene, .seeds = seed, .seed_count = 1};
    struct gd_path path = {0};
    ask_pair(&unit, truth, &seed->point, &to, &to);
    ask_pair(&unit, truth, &to, &seed->point, &to);
    if (field) answer_path(&unit, truth, &to, gd_field_path(field, &to, &path), &path);
    struct gd_field *back = field_from(&unit, &to, 0, NULL);
    if (back) answer_path(&unit, truth, &to, gd_field_path(back, &seed->point, &path), &path);
    gd_field_release(back);
    exact_conclude(&unit, tally);
}

static void graded_paths(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open(EXACT_GRADED, number, &scene);
    for (int i = 0; i < SOURCES; i++) {
        struct gd_seed seed = {.point = exact_random(&scene)};
        struct exact_unit unit = {.scene = &scene, .seeds = &seed, .seed_count = 1};
        struct gd_field *field = field_from(&unit, &seed.point, 0, NULL);
        struct exact_truth truth;
        exact_truth_open(&scene, &seed, 1, INFINITY, &truth);
        if (!field) exact_conclude(&unit, tally);
        for (int k = 0; k < TARGETS; k++)
            check_path(&scene, &truth, field, &seed, exact_random(&scene), tally);
        exact_truth_close(&truth);
        gd_field_release(field);
    }
    exact_scene_close(&scene);
}

/* In this scene, rounding moves rays past their sources. They must turn back (course_turn). */
static void passed_source(uint64_t number, struct exact_tally *tally)
{
    (void)number;
    graded_paths(728, tally);
}

/* --- one pair, all operations ----------------------------------------------------------------- */

/* The distance of a pair by each operation. */
struct lanes {
    struct exact_unit unit;
    struct gd_point from, to;
    double distance[LANES_MOST];
    uint32_t count;
};

/* Adds the result of a call. `distance` is read after the call that fills it. */
static void add(struct lanes *lanes, const char *call, enum gd_status status,
                const double *distance)
{
    if (status)
        exact_failure(&lanes->unit, call, status, &lanes->to);
    else
        lanes->distance[lanes->count++] = *distance;
}

static void by_search(struct lanes *lanes, const struct gd_point *from, const struct gd_point *to,
                      const struct gd_landmarks *landmarks)
{
    const struct gd_mesh *mesh = lanes->unit.scene->mesh;
    for (enum gd_pair_output output = GD_PAIR_DISTANCE; output <= GD_PAIR_PATH_AND_CUT; output++) {
        struct gd_pair_answer answer = {0};
        enum gd_status status =
            gd_pair_solve(mesh,
                          &(struct gd_pair_request){
                              .from = from, .to = to, .output = output, .landmarks = landmarks},
                          NULL, &answer, NULL);
        add(lanes, "gd_pair_solve", status, &answer.distance);
        if (output != GD_PAIR_DISTANCE && !status)
            add(lanes, "gd_pair_solve", GD_OK, &answer.path.length);
        gd_pair_answer_free(&answer);
    }
}

static void by_partial_fields(struct lanes *lanes, const struct gd_point *from,
                              const struct gd_point *to)
{
    double distance = NAN;
    struct gd_field *aimed = field_from(&lanes->unit, from, 0, to);
    if (aimed)
        add(lanes, "gd_field_distance, target", gd_field_distance(aimed, to, &distance), &distance);
    gd_field_release(aimed);
}

static void by_field(struct lanes *lanes, const struct gd_point *from, const struct gd_point *to)
{
    double distance = NAN;
    uint32_t seed = 0;
    struct gd_path path = {0};
    struct gd_field *field = field_from(&lanes->unit, from, 0, NULL);
    if (!field) return;
    add(lanes, "gd_field_distance", gd_field_distance(field, to, &distance), &distance);
    add(lanes, "gd_field_distances", gd_field_distances(field, to, 1, NULL, &distance), &distance);
    add(lanes, "gd_field_nearest", gd_field_nearest(field, to, &distance, &seed), &distance);
    enum gd_status status = gd_field_path(field, to, &path);
    add(lanes, "gd_field_path", status, &path.length);
    gd_path_free(&path);
    gd_field_release(field);
}

static void by_distances_only(struct lanes *lanes, const struct gd_point *from,
                              const struct gd_point *to)
{
    const struct gd_mesh *mesh = lanes->unit.scene->mesh;
    struct gd_point_description at;
    gd_point_describe(mesh, to, &at);
    if (at.kind != GD_POINT_VERTEX) return;
    double *distance = calloc(gd_mesh_summary(mesh)->index_count, sizeof *distance);
    if (!distance) abort();
    struct gd_seed seed = {.point = *from};
    struct gd_field_request request = {.seeds = &seed, .seed_count = 1};
    enum gd_status status = gd_field_distances_only(mesh, &request, NULL, distance, NULL);
    add(lanes, "gd_field_distances_only", status, &distance[at.vertex.index]);
    free(distance);
}

/* Compares all distances with the first distance (1e-12), and the first distance with the exact
 * distance. */
static void compare(struct lanes *lanes)
{
    for (uint32_t i = 1; i < lanes->count; i++) {
        double error = exact_relative(lanes->distance[i], lanes->distance[0]);
        exact_law(&lanes->unit, &lanes->to, lanes->distance[i], lanes->distance[0],
                  error / ONE_LANE);
    }
    if (lanes->count == 0) return;
    struct exact_truth truth;
    exact_truth_open(lanes->unit.scene, lanes->unit.seeds, 1, INFINITY, &truth);
    exact_answer(&lanes->unit, &truth, &lanes->to, lanes->distance[0]);
    exact_truth_close(&truth);
}

static void check_lanes(const struct exact_scene *scene, const struct gd_landmarks *landmarks,
                        struct gd_point from, struct gd_point to, struct exact_tally *tally)
{
    struct gd_seed seed = {.point = from};
    struct lanes lanes = {
        .unit = {.scene = scene, .seeds = &seed, .seed_count = 1}, .from = from, .to = to};
    by_search(&lanes, &from, &to, NULL);
    by_search(&lanes, &to, &from, landmarks);
    by_field(&lanes, &from, &to);
    by_field(&lanes, &to, &from);
    by_partial_fields(&lanes, &from, &to);
    by_distances_only(&lanes, &from, &to);
    compare(&lanes);
    exact_conclude(&lanes.unit, tally);
}

static struct gd_point any_point(struct exact_scene *scene)
{
    uint32_t kind = rng_below(&scene->rng, 4);
    if (kind == 0) return exact_beside_vertex(scene, exact_random_vertex(scene), -15, -3);
    return kind == 1 ? exact_beside_edge(scene, -15, -3) : exact_random(scene);
}

static void same_in_every_lane(uint64_t number, struct exact_tally *tally)
{
    struct exact_scene scene;
    exact_scene_open((enum exact_kind)(number % EXACT_KINDS), number, &scene);
    struct gd_landmarks *landmarks = NULL;
    if (gd_landmarks_build(scene.mesh, LANDMARKS, NULL, &landmarks)) landmarks = NULL;
    for (int i = 0; i < SOURCES * TARGETS; i++)
        check_lanes(&scene, landmarks, any_point(&scene), any_point(&scene), tally);
    gd_landmarks_release(landmarks);
    exact_scene_close(&scene);
}

static const struct exact_section sections[] = {
    {"passed_source", "paths whose rays pass their source, in one graded patch", passed_source, 12,
     12, EXACT_HOLDS},
    {"graded_paths", "random paths in graded patches, ratios 3 to 100, 5 to 12 rings", graded_paths,
     600, 20000, EXACT_HOLDS},
    {"same_in_every_lane",
     "a pair by search, fields, paths, in bulk, from either end: within 1e-12", same_in_every_lane,
     400, 20000, EXACT_HOLDS},
};

int main(int argc, char **argv)
{
    return exact_main(argc, argv, sections, sizeof sections / sizeof *sections);
}
