/* The global minimum on random pairs of points: never longer than the way on a dense mesh allows, and a geodesic by the differential equation. */
#include "tests/unit/nurbs/surfaces.h"

#include <stdio.h>

#include "gd/geodesic_like.h"
#include "gd/query.h"
#include "tests/unit/nurbs/shooting.h"

enum { DENSE_FACES = 40000 };

/* Pairs on each surface: a short form here; NURBS_PAIRS=125 makes the thousand of the issue. */
static int pair_count(void)
{
    const char *wanted = getenv("NURBS_PAIRS");
    return wanted ? atoi(wanted) : 12;
}

struct place {
    double at[2];
};

static struct place random_place(const struct gd_parametric *surface, struct rng *rng)
{
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    return (struct place){{rng_between(rng, u->low, u->high), rng_between(rng, v->low, v->high)}};
}

static double dense_distance(const struct gd_tessellation *dense, struct place a, struct place b)
{
    struct gd_point from, to;
    struct gd_pair_answer answer;
    check_ok(gd_tessellation_point(dense, a.at[0], a.at[1], &from, NULL), NULL);
    check_ok(gd_tessellation_point(dense, b.at[0], b.at[1], &to, NULL), NULL);
    check_ok(gd_pair_solve(gd_tessellation_mesh(dense), &from, &to, false, NULL, NULL, &answer, NULL), NULL);
    return answer.distance;
}

/* The differential equation is integrated to 1e-13 a step, which paths that diverge make up to some ten thousand times larger. */
static const double equation = 3e-9;

/* Two splines of different degrees have nothing in common but the surface. */
static const double two_degrees = 2e-11;

static double quintic_length(const struct gd_tessellation *coarse, struct gd_domain_curve *from,
                             struct gd_domain_curve *to)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    const struct gd_geodesic_options options = {.degree = 5, .tolerance = 1e-12};
    enum gd_status status = gd_geodesic_solve(coarse, from, to, &options, NULL, &found, &detail);
    check_ok(status, &detail);
    double length = found.items[0].length;
    gd_geodesics_free(&found);
    return length;
}

/* The length by shooting along the path; NAN where the path follows a border or passes a pole. */
static double shot_length(const struct gd_parametric *surface, const struct gd_geodesic *path)
{
    double places[65][2], angle, length = path->length;
    if (path->warnings & (GD_GEODESIC_BOUNDARY_CONTACT | GD_GEODESIC_THROUGH_POLE)) return NAN;
    check_ok(gd_geodesic_sample(surface, path, 65, places, NULL), NULL);
    struct gd_geodesic_piece first = path->pieces[0];
    angle = shooting_angle(surface, first.points[0], first.points[1]);
    return shoot_at(surface, places[0], places[64], &angle, &length) ? length : NAN;
}

static void check_surface(struct gd_parametric *surface, const char *name, uint64_t seed)
{
    struct gd_tessellation *coarse, *dense;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &coarse, NULL), NULL);
    check_ok(
        gd_tessellation_build(surface, &(struct gd_tessellation_options){.faces = DENSE_FACES}, NULL, &dense, NULL),
        NULL);
    struct rng rng = {seed};
    int pairs = pair_count(), shot = 0;
    double worst = 0, time = 0;
    for (int i = 0; i < pairs; i++) {
        struct place a = random_place(surface, &rng), b = random_place(surface, &rng);
        struct gd_domain_curve *from = point_at(surface, a.at[0], a.at[1]), *to = point_at(surface, b.at[0], b.at[1]);
        struct gd_geodesics found;
        struct gd_detail detail = {0};
        uint64_t begin = gd_now_ns();
        check_ok(gd_geodesic_solve(coarse, from, to, NULL, NULL, &found, &detail), &detail);
        time += 1e-6 * (double)(gd_now_ns() - begin);
        const struct gd_geodesic *path = &found.items[0];
        double mesh = dense_distance(dense, a, b), ode = shot_length(surface, path);
        double quintic = quintic_length(coarse, from, to);
        bool good = path->is_minimum && !(path->warnings & GD_GEODESIC_NOT_CONVERGED) &&
                    fabs(path->length - mesh) < 3e-3 * mesh && !(fabs(path->length - ode) > equation * path->length) &&
                    (fabs(path->length - quintic) <= two_degrees * path->length ||
                     path->warnings & GD_GEODESIC_BOUNDARY_CONTACT);
        if (!good)
            print_error("%s: (%.17g, %.17g) to (%.17g, %.17g): %.15g, mesh %.15g, shot %.15g, quintic %.15g, minimum "
                        "%d, warnings %u\n",
                        name, a.at[0], a.at[1], b.at[0], b.at[1], path->length, mesh, ode, quintic, path->is_minimum,
                        path->warnings);
        assert_true(good || getenv("NURBS_GO_ON"));
        if (isfinite(ode)) {
            shot++;
            worst = fmax(worst, fabs(path->length - ode) / ode);
        }
        gd_geodesics_free(&found);
        gd_domain_curve_release(from);
        gd_domain_curve_release(to);
    }
    print_message("%s: %d pairs, %d shot, worst %.1e, %.1f ms each\n", name, pairs, shot, worst, time / pairs);
    assert_true(shot >= pairs / 2);
    gd_tessellation_release(coarse);
    gd_tessellation_release(dense);
    gd_parametric_release(surface);
}

static void random_pairs_on_eight_surfaces(void **state)
{
    (void)state;
    check_surface(torus(2, 1), "torus", 1);
    check_surface(nurbs_torus(2, 0.6, 1, 0), "rational torus", 2);
    check_surface(nurbs_sphere(), "sphere", 3);
    check_surface(nurbs_bumps(8, 4, 0.7, 11), "bumps 8 x 4", 4);
    check_surface(nurbs_bumps(12, 12, 1.2, 13), "bumps 12 x 12", 5);
    check_surface(vase(), "vase", 6);
    check_surface(helicoid(), "helicoid", 7);
    check_surface(bilinear(), "bilinear", 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_pairs_on_eight_surfaces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
