#include "query/taut_path.h"

#include <math.h>

#include "gd/query.h"
#include "query/landmarks.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { PAIRS = 60 };

/* The maximum and the mean of the relative excess of the taut paths' lengths over the distances. */
struct excess {
    double most, sum;
};

/* Checks that the taut path is at least as long as the distance, and at most as long as the path
 * from which it was made. */
static void check_pair(const struct gd_mesh *mesh, const struct gd_landmarks *landmarks,
                       struct gd_point from, struct gd_point to, struct excess *excess)
{
    struct gd__guide guide = {0};
    struct gd_pair_answer answer;
    double upper, length;
    check_ok(gd_pair_solve(mesh, &(struct gd_pair_request){.from = &from, .to = &to}, NULL, &answer,
                           NULL),
             NULL);
    gd__landmarks_offer(landmarks, mesh, &guide);
    check_ok(gd__guide_aim(&guide, mesh, &from, &to, NULL, &upper), NULL);
    check_ok(gd__taut_path_length(&guide, &from, &to, NULL, &length), NULL);
    double exact = answer.distance / mesh->unit, more = exact > 0 ? length / exact - 1 : 0;
    assert_true(length >= exact * (1 - 1e-12) && length <= upper);
    excess->most = fmax(excess->most, more);
    excess->sum += more / PAIRS;
    gd__guide_clean(&guide);
    gd__guide_destroy(&guide);
}

static struct gd_mesh *sample_of(const char *name, struct gd_polygons *polygons)
{
    double values[SAMPLE_PARAMETERS];
    for (int i = 0; i < SAMPLE_PARAMETERS; i++) values[i] = sample_find(name)->parameters[i].value;
    return test_sample(name, values, polygons);
}

static void check_surface(const char *name, double mean)
{
    struct gd_polygons polygons;
    struct gd_mesh *mesh = sample_of(name, &polygons);
    struct gd_landmarks *landmarks;
    struct rng rng = {4};
    check_ok(gd_landmarks_build(mesh, 6, NULL, &landmarks), NULL);
    for (int guided = 0; guided < 2; guided++) {
        struct excess excess = {0};
        for (int i = 0; i < PAIRS; i++) {
            struct gd_point from = test_point(mesh, test_random_place(&polygons, &rng)),
                            to = test_point(mesh, test_random_place(&polygons, &rng));
            check_pair(mesh, guided ? landmarks : NULL, from, to, &excess);
        }
        print_message("# %s: longer by %.2e in the mean, %.2e at most\n", name, excess.sum,
                      excess.most);
        assert_true(excess.sum < mean);
    }
    gd_landmarks_release(landmarks);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

static void lengths_are_upper_bounds(void **state)
{
    (void)state;
    check_surface("torus", 1e-2);
    check_surface("terrain", 1e-2);
    check_surface("box", 1e-2);
    check_surface("tangle", 1e-1);
    check_surface("obstacles", 1e-1);
}

/* Tests a path within one face, and a path from a point to itself. */
static void trivial_paths(void **state)
{
    (void)state;
    struct gd_polygons polygons;
    struct gd_mesh *mesh = sample_of("grid", &polygons);
    struct rng rng = {5};
    struct excess excess = {0};
    for (int i = 0; i < PAIRS; i++) {
        struct test_place place = test_random_place(&polygons, &rng);
        struct gd_point point = test_point(mesh, place);
        check_pair(mesh, NULL, point, point, &excess);
        uint32_t corner = mesh->origin[mesh->face_side[0][i % 3]];
        struct gd_point vertex = {.kind = GD_POINT_VERTEX, .element = corner};
        check_pair(mesh, NULL, vertex, (struct gd_point){GD_POINT_FACE, 0, {0.2, 0.3, 0.5}},
                   &excess);
    }
    assert_true(excess.most < 1e-12);
    gd_mesh_release(mesh);
    gd_polygons_free(&polygons);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_are_upper_bounds),
        cmocka_unit_test(trivial_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
