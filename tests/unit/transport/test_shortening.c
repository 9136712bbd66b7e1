/* Compares shortened curves with closed forms and with shortest paths. */
#include "tests/unit/transport/curves.h"

#include <string.h>

#include "gd/query.h"
#include "gd/shortening.h"

static struct gd_shortening shorten(const struct gd_mesh *mesh, const struct gd_curve *curve,
                                    uint32_t rounds)
{
    struct gd_shortening shortening;
    struct gd_detail detail = {0};
    check_ok(gd_curve_shorten(mesh, &(struct gd_shortening_request){curve, rounds, 0}, NULL,
                              &shortening, &detail),
             &detail);
    return shortening;
}

static double distance_between(const struct gd_mesh *mesh, const struct gd_point *p,
                               const struct gd_point *q)
{
    struct gd_pair_answer answer;
    check_ok(
        gd_pair_solve(mesh, &(struct gd_pair_request){.from = p, .to = q}, NULL, &answer, NULL),
        NULL);
    return answer.distance;
}

/* In a plane any detour becomes the straight segment. */
static void detours_in_the_plane(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){30, 20, 3, 2});
    struct rng rng = {1};
    for (int i = 0; i < 200; i++) {
        struct gd_point points[6];
        uint32_t count = 2 + rng_below(&rng, 5);
        for (uint32_t k = 0; k < count; k++)
            points[k] = test_point(plane.mesh, test_random_place(&plane.polygons, &rng));
        struct gd_curve curve = curve_through(plane.mesh, points, count, false);
        struct gd_shortening shortening = shorten(plane.mesh, &curve, 0);
        double straight = gd_vec3_distance(gd_point_position(plane.mesh, &points[0]),
                                           gd_point_position(plane.mesh, &points[count - 1]));
        expect_near(gd_curve_length(plane.mesh, &shortening.curve), straight, 1e-12);
        check_curve(plane.mesh, &shortening.curve, 3);
        assert_true(shortening.is_geodesic);
        gd_shortening_free(&shortening);
        gd_curve_free(&curve);
    }
    surface_free(&plane);
}

/* On any surface a shortened curve is at least as long as the distance and at most as long as
 * before. Shortening it again does not change its length. */
static void detours_on_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double values[SAMPLE_PARAMETERS];
    } surfaces[] = {{"terrain", {24, 0.5, 3}},
                    {"icosphere", {3, 1}},
                    {"genus2", {4, 0.03}},
                    {"saddle", {1, 0.9, 12, 4}}};
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        int shortest = 0;
        for (int i = 0; i < 60; i++) {
            struct gd_point points[3];
            for (int k = 0; k < 3; k++)
                points[k] = test_point(surface.mesh, test_random_place(&surface.polygons, &rng));
            struct gd_curve curve = curve_through(surface.mesh, points, 3, false);
            struct gd_shortening once = shorten(surface.mesh, &curve, 0),
                                 twice = shorten(surface.mesh, &once.curve, 0);
            double before = gd_curve_length(surface.mesh, &curve),
                   after = gd_curve_length(surface.mesh, &once.curve),
                   distance = distance_between(surface.mesh, &points[0], &points[2]);
            assert_true(after <= before * (1 + 1e-12));
            assert_true(after >= distance * (1 - 1e-9));
            check_close(gd_curve_length(surface.mesh, &twice.curve), after, 1e-9);
            check_curve(surface.mesh, &once.curve, 1);
            shortest += after <= distance * (1 + 1e-9);
            gd_shortening_free(&once);
            gd_shortening_free(&twice);
            gd_curve_free(&curve);
        }
        assert_true(shortest >= 10); /* this holds for most curves on a disc */
        surface_free(&surface);
    }
}

/* A wavy curve around a prism becomes a closed geodesic of the prism's perimeter. */
static void closed_geodesics(void **state)
{
    (void)state;
    struct surface tube = surface_of("cylinder", (double[SAMPLE_PARAMETERS]){1, 2, 24, 12});
    struct gd_point points[6];
    for (int i = 0; i < 6; i++)
        points[i] = nearest(tube.mesh, cos(2 * M_PI * i / 6), sin(2 * M_PI * i / 6),
                            1 + 0.4 * sin(5.0 * i));
    struct gd_curve curve = curve_through(tube.mesh, points, 6, true);
    struct gd_shortening shortening = shorten(tube.mesh, &curve, 0);
    check_close(gd_curve_length(tube.mesh, &shortening.curve), 48 * sin(M_PI / 24), 1e-9);
    assert_true(shortening.is_geodesic && shortening.curve.closed);
    check_curve(tube.mesh, &shortening.curve, 1);
    gd_shortening_free(&shortening);
    /* if the number of rounds is given, Birkhoff's method runs; it converges more slowly, so the
     * length is still above the limit */
    shortening = shorten(tube.mesh, &curve, 100);
    double length = gd_curve_length(tube.mesh, &shortening.curve);
    assert_true(length > 48 * sin(M_PI / 24) && length < 48.2 * sin(M_PI / 24));
    assert_int_equal(shortening.rounds, 100);
    gd_shortening_free(&shortening);
    gd_curve_free(&curve);
    surface_free(&tube);
}

/* A loop that shrinks to a point is refused. */
static void loops_that_shrink_to_points(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){30, 20, 3, 2});
    struct gd_point points[3] = {nearest(plane.mesh, 1, 1, 0), nearest(plane.mesh, 2, 1, 0),
                                 nearest(plane.mesh, 1.4, 1.8, 0)};
    struct gd_curve curve = curve_through(plane.mesh, points, 3, true);
    struct gd_shortening shortening;
    struct gd_detail detail = {0};
    assert_int_equal(gd_curve_shorten(plane.mesh, &(struct gd_shortening_request){&curve, 0, 0},
                                      NULL, &shortening, &detail),
                     GD_INVALID_ARGUMENT);
    assert_non_null(strstr(detail.text, "shrinks to a point"));
    double before = gd_curve_length(plane.mesh, &curve), length;
    for (uint32_t rounds = 1; rounds < 20; rounds++, before = length) {
        shortening = shorten(plane.mesh, &curve, rounds);
        length = gd_curve_length(plane.mesh, &shortening.curve);
        assert_true(length < before);
        gd_shortening_free(&shortening);
    }
    gd_curve_free(&curve);
    surface_free(&plane);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(detours_in_the_plane), cmocka_unit_test(detours_on_surfaces),
        cmocka_unit_test(closed_geodesics), cmocka_unit_test(loops_that_shrink_to_points)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
