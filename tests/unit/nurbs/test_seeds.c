/* Computes shortest paths between random pairs of points. Each path must satisfy the geodesic
 * equation. It must be at most as long as the geodesic that shooting finds near the shortest path
 * on a dense mesh. */
#include "tests/unit/nurbs/surfaces.h"

#include <stdio.h>

#include "gd/geodesic_like.h"
#include "gd/query.h"
#include "tests/unit/nurbs/shooting.h"

enum { DENSE_FACES = 40000 };

/* Number of pairs on each surface. NURBS_PAIRS overrides it; 125 gives a thousand pairs in
 * total. */
static int pair_count(void)
{
    const char *wanted = getenv("NURBS_PAIRS");
    return wanted ? atoi(wanted) : 12 / TEST_STRIDE;
}

struct place {
    double at[2];
};

static struct place random_place(const struct gd_parametric *surface, struct rng *rng)
{
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    return (struct place){{rng_between(rng, u->low, u->high), rng_between(rng, v->low, v->high)}};
}

/* Results of the brute-force method: the path's length on a dense mesh, and the length of the
 * geodesic that shooting finds from this path. */
struct brute {
    double mesh;
    double shot; /* NAN if shooting did not converge, for example near a pole */
};

/* Returns the angle at which a path of the mesh starts. Sets *to to the end, moved by whole periods
 * to follow the path in closed directions. */
static double follow(const struct gd_tessellation *dense, const struct gd_path *path,
                     struct place from, struct place *to)
{
    const struct gd_parametric *surface = gd_tessellation_surface(dense);
    const struct gd_axis *axes[2] = {gd_parametric_axis_u(surface), gd_parametric_axis_v(surface)};
    struct place last = from, early = from;
    for (uint32_t i = 1; i < path->count; i++) {
        struct place next = *to;
        if (i + 1 < path->count) gd_tessellation_parameters(dense, &path->points[i], next.at);
        for (int k = 0; k < 2; k++) {
            double period = axes[k]->high - axes[k]->low;
            if (axes[k]->closed) next.at[k] -= round((next.at[k] - last.at[k]) / period) * period;
        }
        if (i <= 4) early = next;
        last = next;
    }
    *to = last;
    return shooting_angle(surface, from.at, early.at);
}

static struct brute brute_force(const struct gd_tessellation *dense, struct place a, struct place b)
{
    struct gd_point from, to;
    struct gd_pair_answer answer;
    check_ok(gd_tessellation_point(dense, a.at[0], a.at[1], &from, NULL), NULL);
    check_ok(gd_tessellation_point(dense, b.at[0], b.at[1], &to, NULL), NULL);
    check_ok(
        gd_pair_solve(gd_tessellation_mesh(dense),
                      &(struct gd_pair_request){.from = &from, .to = &to, .output = GD_PAIR_PATH},
                      NULL, &answer, NULL),
        NULL);
    struct brute brute = {answer.distance, answer.distance};
    double angle = follow(dense, &answer.path, a, &b);
    if (!shoot_at(gd_tessellation_surface(dense), a.at, b.at, &angle, &brute.shot))
        brute.shot = NAN;
    gd_pair_answer_free(&answer);
    return brute;
}

/* Tolerance of lengths that are computed by integrating the geodesic equation. A step has an error
 * of 1e-15. Where geodesics diverge, this error grows up to some ten thousand times. */
static const double equation = 1e-10;

/* Tolerance between splines of different degrees, which share no intermediate result. */
static const double two_degrees = 2e-11;

static double quintic_length(const struct gd_tessellation *coarse, struct gd_domain_curve *from,
                             struct gd_domain_curve *to)
{
    struct gd_geodesics found;
    struct gd_detail detail = {0};
    const struct gd_geodesic_options options = {.degree = 5, .tolerance = 1e-12};
    enum gd_status status = gd_geodesic_solve(
        coarse, &(struct gd_geodesic_request){.from = from, .to = to, .options = &options}, NULL,
        &found, &detail);
    check_ok(status, &detail);
    double length = found.items[0].length;
    gd_geodesics_free(&found);
    return length;
}

/* Returns the length by shooting along the path. Returns NAN if the path follows a border, passes
 * through a pole or ends in a pole, or if shooting does not converge. */
static double shot_length(const struct gd_parametric *surface, const struct gd_geodesic *path)
{
    double places[65][2], angle, length = path->length;
    if (path->warnings & (GD_GEODESIC_BOUNDARY_CONTACT | GD_GEODESIC_THROUGH_POLE)) return NAN;
    check_ok(gd_geodesic_sample(surface, path, 65, places, NULL), NULL);
    struct gd_geodesic_piece first = path->pieces[0];
    for (int i = 0; i <= 64; i += 64) {
        struct gd_jet end;
        shooting_jet(surface, places[i], &end);
        if (!gd_jet_curvature(&end).regular) return NAN;
    }
    angle = shooting_angle(surface, first.points[0], first.points[1]);
    return shoot_at(surface, places[0], places[64], &angle, &length) ? length : NAN;
}

static void check_surface(struct gd_parametric *surface, const char *name, uint64_t seed)
{
    struct gd_tessellation *coarse, *dense;
    check_ok(gd_tessellation_build(surface, NULL, NULL, &coarse, NULL), NULL);
    check_ok(gd_tessellation_build(surface, &(struct gd_tessellation_options){.faces = DENSE_FACES},
                                   NULL, &dense, NULL),
             NULL);
    struct rng rng = {seed};
    int pairs = pair_count(), shot = 0, same = 0;
    double worst = 0, time = 0;
    for (int i = 0; i < pairs; i++) {
        struct place a = random_place(surface, &rng), b = random_place(surface, &rng);
        struct gd_domain_curve *from = point_at(surface, a.at[0], a.at[1]),
                               *to = point_at(surface, b.at[0], b.at[1]);
        struct gd_geodesics found;
        struct gd_detail detail = {0};
        uint64_t begin = gd_now_ns();
        check_ok(gd_geodesic_solve(coarse, &(struct gd_geodesic_request){.from = from, .to = to},
                                   NULL, &found, &detail),
                 &detail);
        time += 1e-6 * (double)(gd_now_ns() - begin);
        const struct gd_geodesic *path = &found.items[0];
        struct brute brute = brute_force(dense, a, b);
        double ode = shot_length(surface, path), quintic = quintic_length(coarse, from, to);
        bool good = path->is_minimum && !(path->warnings & GD_GEODESIC_NOT_CONVERGED) &&
                    fabs(path->length - brute.mesh) < 3e-3 * brute.mesh &&
                    !(brute.shot > 0 && path->length > brute.shot * (1 + equation)) &&
                    !(fabs(path->length - ode) > equation * path->length) &&
                    (fabs(path->length - quintic) <= two_degrees * path->length ||
                     path->warnings & GD_GEODESIC_BOUNDARY_CONTACT);
        if (!good)
            print_error("%s: (%.17g, %.17g) to (%.17g, %.17g): %.15g, mesh %.15g, shot along it "
                        "%.15g, shot %.15g, "
                        "quintic %.15g, minimum "
                        "%d, warnings %u\n",
                        name, a.at[0], a.at[1], b.at[0], b.at[1], path->length, brute.mesh,
                        brute.shot, ode, quintic, path->is_minimum, path->warnings);
        assert_true(good || getenv("NURBS_GO_ON"));
        same += fabs(brute.shot - path->length) <= equation * path->length;
        if (isfinite(ode)) {
            shot++;
            worst = fmax(worst, fabs(path->length - ode) / ode);
        }
        gd_geodesics_free(&found);
        gd_domain_curve_release(from);
        gd_domain_curve_release(to);
    }
    print_message("%s: %d pairs, %d shot, worst %.1e; %d the geodesic beside the way on the mesh; "
                  "%.1f ms each\n",
                  name, pairs, shot, worst, same, time / pairs);
    assert_true(shot >= pairs / 2 && same >= pairs / 2);
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

/* --- between curves --------------------------------------------------------------------------- */

enum { SAMPLES = 400, CORNERS = 5 };

static const double right = 1e-8; /* permitted error of a right angle at an end */

/* Returns a random point, loop, iso line, B-spline or polyline. */
static struct gd_domain_curve *random_curve(const struct gd_parametric *surface, struct rng *rng)
{
    struct place corners[CORNERS], middle = random_place(surface, rng);
    static const double knots[] = {0, 0, 0, 0, 0.4, 1, 1, 1, 1};
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    double half[2] = {0.5 * (u->high - u->low), 0.5 * (v->high - v->low)},
           low[2] = {u->low, v->low};
    double size = rng_between(rng, 0.1, 0.3); /* relative to half the domain */
    for (int k = 0; k < 2; k++)
        middle.at[k] = low[k] + half[k] + 0.65 * (middle.at[k] - low[k] - half[k]);
    for (int i = 0; i < CORNERS; i++)
        for (int k = 0; k < 2; k++)
            corners[i].at[k] = middle.at[k] + half[k] * rng_between(rng, -size, size);
    struct gd_domain_curve *curve;
    switch ((int)rng_between(rng, 0, 5)) {
    case 0:
        return point_at(surface, middle.at[0], middle.at[1]);
    case 1:
        return loop_at(surface, middle.at[0], middle.at[1], size * half[0], size * half[1]);
    case 2:
        return iso_at(surface, GD_ISO_U, middle.at[0]);
    case 3:
        check_ok(gd_domain_curve_bspline(
                     surface,
                     &(struct gd_domain_bspline){3, knots, (const double(*)[2])corners, CORNERS},
                     NULL, &curve, NULL),
                 NULL);
        return curve;
    default:
        check_ok(gd_domain_curve_polyline(
                     surface, &(struct gd_domain_polyline){(const double(*)[2])corners, CORNERS},
                     NULL, &curve, NULL),
                 NULL);
        return curve;
    }
}

/* Samples a curve. Raises *gap to the largest distance in space between neighbouring samples. */
static uint32_t sample(const struct gd_tessellation *dense, const struct gd_domain_curve *curve,
                       struct gd_seed out[SAMPLES], double *gap)
{
    uint32_t count = gd_domain_curve_is_point(curve) ? 1 : SAMPLES;
    double low, high, at[2];
    struct gd_vec3 before = {0};
    gd_domain_curve_range(curve, &low, &high);
    for (uint32_t i = 0; i < count; i++) {
        struct gd_jet x;
        gd_domain_curve_at(curve, count > 1 ? low + (high - low) * i / (count - 1) : low, at);
        check_ok(gd_parametric_evaluate(gd_domain_curve_surface(curve), at[0], at[1], &x), NULL);
        out[i] = (struct gd_seed){0};
        check_ok(gd_tessellation_point(dense, at[0], at[1], &out[i].point, NULL), NULL);
        if (i) *gap = fmax(*gap, gd_vec3_distance(before, x.x));
        before = x.x;
    }
    return count;
}

/* Returns the smallest distance on a dense mesh between samples of both curves. `*gap` has the same
 * meaning as in `sample`. */
static double sampled_distance(const struct gd_tessellation *dense, const struct gd_domain_curve *a,
                               const struct gd_domain_curve *b, double *gap)
{
    static struct gd_seed from[SAMPLES], to[SAMPLES];
    uint32_t count = sample(dense, b, to, gap);
    struct gd_field_request request = {.seeds = from, .seed_count = sample(dense, a, from, gap)};
    struct gd_field *field;
    double least = INFINITY, distance;
    check_ok(gd_field_build(gd_tessellation_mesh(dense), &request, NULL, &field, NULL), NULL);
    for (uint32_t i = 0; i < count; i++) {
        check_ok(gd_field_distance(field, &to[i].point, &distance), NULL);
        least = fmin(least, distance);
    }
    gd_field_release(field);
    return least;
}

static bool is_good(const struct gd_parametric *surface, const struct gd_geodesic *path,
                    double least, double gap)
{
    if (path->length == 0) return least <= gap;
    if (!path->is_minimum || path->warnings & GD_GEODESIC_NOT_CONVERGED) return false;
    if (path->length > least * (1 + 3e-3) + 0.1 * gap || path->length < least * (1 - 3e-3) - gap)
        return false;
    if (!(path->warnings & GD_GEODESIC_CURVE_CORNER) &&
        (fabs(path->from_angle - M_PI_2) > right || fabs(path->to_angle - M_PI_2) > right))
        return false;
    return !(fabs(path->length - shot_length(surface, path)) > equation * path->length);
}

static void check_curves(struct gd_parametric *surface, const char *name, uint64_t seed)
{
    struct gd_tessellation *coarse, *dense;
    const struct gd_tessellation_options fine = {.faces = DENSE_FACES};
    check_ok(gd_tessellation_build(surface, NULL, NULL, &coarse, NULL), NULL);
    check_ok(gd_tessellation_build(surface, &fine, NULL, &dense, NULL), NULL);
    struct rng rng = {seed};
    int pairs = (pair_count() + 2) / 3, met = 0;
    for (int i = 0; i < pairs; i++) {
        struct gd_domain_curve *from = random_curve(surface, &rng),
                               *to = random_curve(surface, &rng);
        struct gd_geodesics found;
        struct gd_detail detail = {0};
        check_ok(gd_geodesic_solve(coarse, &(struct gd_geodesic_request){.from = from, .to = to},
                                   NULL, &found, &detail),
                 &detail);
        const struct gd_geodesic *path = &found.items[0];
        double gap = 0, least = sampled_distance(dense, from, to, &gap);
        bool good = is_good(surface, path, least, gap);
        met += path->length == 0;
        if (!good)
            print_error("%s, pair %d: %.15g, sampled %.15g (gap %.3g), angles off by %.1e and "
                        "%.1e, minimum %d, "
                        "warnings %u\n",
                        name, i, path->length, least, gap, path->from_angle - M_PI_2,
                        path->to_angle - M_PI_2, path->is_minimum, path->warnings);
        assert_true(good || getenv("NURBS_GO_ON"));
        gd_geodesics_free(&found);
        gd_domain_curve_release(from);
        gd_domain_curve_release(to);
    }
    print_message("%s: %d pairs of curves, %d meet\n", name, pairs, met);
    gd_tessellation_release(coarse);
    gd_tessellation_release(dense);
    gd_parametric_release(surface);
}

static void random_curves_on_eight_surfaces(void **state)
{
    (void)state;
    check_curves(torus(2, 1), "torus", 1);
    check_curves(nurbs_torus(2, 0.6, 1, 0), "rational torus", 2);
    check_curves(nurbs_sphere(), "sphere", 3);
    check_curves(nurbs_bumps(8, 4, 0.7, 11), "bumps 8 x 4", 4);
    check_curves(nurbs_bumps(12, 12, 1.2, 13), "bumps 12 x 12", 5);
    check_curves(vase(), "vase", 6);
    check_curves(helicoid(), "helicoid", 7);
    check_curves(bilinear(), "bilinear", 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_pairs_on_eight_surfaces),
                                       cmocka_unit_test(random_curves_on_eight_surfaces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
