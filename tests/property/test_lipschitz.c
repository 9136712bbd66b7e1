/* Tests Lipschitz continuity, which is Property 4 of Y.-J. Liu, "Exact geodesic metric in
 * 2-manifold triangle meshes using edge-based data structures": for any set A, |d_A(x) - d_A(y)| <=
 * d(x, y). Sets are random points and a curve, with offsets. The law is tested at random points
 * inside faces, on every mesh of a folder (tests/support/shared.h).
 *
 * With offsets, d_A(x) is the minimum of offset + d(x, member) over the members. Each of these
 * functions obeys the law, so their minimum obeys it, too. */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gd/curve.h"
#include "gd/query.h"
#include "tests/support/shared.h"
#include "tests/support/test.h"

static const double promise = 1e-9;

enum {
    SETS = 2,
    MOST_MEMBERS = 12,
    /* number of pairs within one face, where the length of the straight segment bounds d(x, y)
       best */
    PAIRS_IN_A_FACE = 400,
    PAIRS = 12, /* number of pairs of arbitrary points, with d(x, y) from a search */
    PATH_LENGTH = 4096,
    NAME_LENGTH = 256
};

/* --- points and sets -------------------------------------------------------------------------- */

static struct gd_face random_face(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_face face;
    do face.index = rng_below(rng, gd_mesh_summary(mesh)->face_index_count);
    while (!gd_mesh_has_face(mesh, face));
    return face;
}

/* Returns a point in the interior of the face, with all weights at least 1/21. */
static struct gd_point random_point(const struct gd_mesh *mesh, struct gd_face face,
                                    struct rng *rng)
{
    double weight[3], sum = 0;
    struct gd_point point;
    for (int k = 0; k < 3; k++) sum += weight[k] = rng_between(rng, 0.1, 1);
    for (int k = 0; k < 3; k++) weight[k] /= sum;
    check_ok(gd_point_in_face(mesh, face, weight, &point, NULL), NULL);
    assert_int_equal(point.kind, GD_POINT_FACE);
    return point;
}

/* Returns the shortest path between two random points, or the first point alone if they are on
 * different components. */
static struct gd_curve random_curve(const struct gd_mesh *mesh, struct rng *rng)
{
    struct gd_point ends[2];
    for (int i = 0; i < 2; i++) ends[i] = random_point(mesh, random_face(mesh, rng), rng);
    bool joined = gd_point_component(mesh, &ends[0]) == gd_point_component(mesh, &ends[1]);
    struct gd_curve_request request = {
        .kind = GD_CURVE_POINTS, .points = ends, .count = joined ? 2 : 1};
    struct gd_curve curve;
    check_ok(gd_curve_resolve(mesh, &request, NULL, &curve, NULL), NULL);
    return curve;
}

static struct gd_field *random_set(const struct gd_mesh *mesh, struct rng *rng)
{
    const struct gd_mesh_summary *summary = gd_mesh_summary(mesh);
    double diagonal = gd_vec3_distance(summary->min, summary->max);
    struct gd_curve curve = random_curve(mesh, rng);
    uint32_t points = rng_below(rng, MOST_MEMBERS), count = points + gd_curve_seed_count(&curve);
    struct gd_seed *seeds = calloc(count, sizeof *seeds);
    struct gd_field_request request = {.seeds = seeds, .seed_count = count};
    struct gd_field *field = NULL;
    struct gd_detail detail = {0};
    assert_non_null(seeds);
    for (uint32_t i = 0; i < points; i++) {
        seeds[i].point = random_point(mesh, random_face(mesh, rng), rng);
        seeds[i].offset = rng_below(rng, 2) ? rng_between(rng, 0, 0.1 * diagonal) : 0;
    }
    gd_curve_seeds(&curve, rng_between(rng, 0, 0.05 * diagonal), seeds + points);
    check_ok(gd_field_build(mesh, &request, NULL, &field, &detail), &detail);
    gd_curve_free(&curve);
    free(seeds);
    return field;
}

/* --- the law ---------------------------------------------------------------------------------- */

struct tally {
    /* `nearly_equal` is the number of pairs at which the law holds almost with equality */
    uint32_t pairs, nearly_equal;
    double worst; /* largest violation relative to the distances */
};

/* Checks the law. `apart` is d(x, y) or an upper bound of it. */
static void check_pair(const struct gd_field *field, const struct gd_point *x,
                       const struct gd_point *y, double apart, struct tally *tally)
{
    double at_x, at_y;
    check_ok(gd_field_distance(field, x, &at_x), NULL);
    check_ok(gd_field_distance(field, y, &at_y), NULL);
    if (isinf(at_x) || isinf(at_y)) {
        /* if one point is reached and the other is not, they are on different components */
        assert_true(isinf(apart) || (isinf(at_x) && isinf(at_y)));
        return;
    }
    double change = fabs(at_x - at_y), broken = (change - apart) / fmax(fmax(at_x, at_y), apart);
    tally->pairs++;
    tally->nearly_equal += change > 0.999 * apart;
    tally->worst = fmax(tally->worst, broken);
    if (broken > promise)
        fail_msg("the distance to the set changes from %.17g to %.17g, over %.17g", at_x, at_y,
                 apart);
}

static void check_within_faces(const struct gd_field *field, struct rng *rng, struct tally *tally)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    for (int i = 0; i < PAIRS_IN_A_FACE; i++) {
        struct gd_face face = random_face(mesh, rng);
        struct gd_point x = random_point(mesh, face, rng), y = random_point(mesh, face, rng);
        double apart = gd_vec3_distance(gd_point_position(mesh, &x), gd_point_position(mesh, &y));
        check_pair(field, &x, &y, apart, tally);
    }
}

static void check_anywhere(const struct gd_field *field, struct rng *rng, struct tally *tally)
{
    const struct gd_mesh *mesh = gd_field_mesh(field);
    for (int i = 0; i < PAIRS; i++) {
        struct gd_point x = random_point(mesh, random_face(mesh, rng), rng),
                        y = random_point(mesh, random_face(mesh, rng), rng);
        struct gd_pair_answer answer;
        check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &x, .to = &y}, NULL, &answer,
                               NULL),
                 NULL);
        check_pair(field, &x, &y, answer.distance, tally);
    }
}

static void check_mesh(const char *name, const struct gd_mesh *mesh)
{
    struct rng rng = {gd_mesh_summary(mesh)->faces};
    struct tally near = {0}, far = {0};
    for (int i = 0; i < SETS; i++) {
        struct gd_field *field = random_set(mesh, &rng);
        check_within_faces(field, &rng, &near);
        check_anywhere(field, &rng, &far);
        gd_field_release(field);
    }
    print_message(
        "# %s: %u pairs in a face (%u sharp), broken by %.1e at most; %u anywhere, by %.1e\n", name,
        near.pairs, near.nearly_equal, near.worst, far.pairs, far.worst);
    assert_true(near.pairs > 0 && near.nearly_equal > 0 && far.pairs > 0);
}

static void distances_to_sets_are_lipschitz(void **state)
{
    (void)state;
    char folder[PATH_LENGTH];
    int count = 0;
    snprintf(folder, sizeof folder, "%s/meshes", test_shared_folder());
    DIR *listing = opendir(folder);
    if (!listing) {
        print_message("# skipped: there is no folder %s\n", folder);
        skip();
    }
    for (struct dirent *entry; (entry = readdir(listing));) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || strcmp(dot, ".obj") != 0) continue;
        char name[NAME_LENGTH];
        snprintf(name, sizeof name, "%.*s", (int)(dot - entry->d_name), entry->d_name);
        struct gd_mesh *mesh = test_shared_mesh(name);
        check_mesh(name, mesh);
        gd_mesh_release(mesh);
        count++;
    }
    closedir(listing);
    assert_true(count > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(distances_to_sets_are_lipschitz)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
