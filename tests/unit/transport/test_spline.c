/* Compares splines in a plane with classical splines, and checks laws on any surface. */
#include "tests/unit/transport/lines.h"

#include <pthread.h>
#include <string.h>

#include "gd/frame.h"
#include "gd/query.h"
#include "gd/spline.h"
#include "gd/workspace.h"

enum { POINTS = 5 };

static struct gd_spline build(const struct gd_mesh *mesh, const struct gd_spline_request *request)
{
    struct gd_spline spline;
    struct gd_detail detail = {0};
    check_ok(gd_spline_build(mesh, request, NULL, &spline, &detail), &detail);
    return spline;
}

static struct gd_spline_line sample(const struct gd_mesh *mesh, const struct gd_spline *spline,
                                    struct gd_spline_sampling sampling)
{
    struct gd_spline_line line;
    struct gd_detail detail = {0};
    sampling.spline = spline;
    check_ok(gd_spline_sample(mesh, &sampling, NULL, &line, &detail), &detail);
    return line;
}

static void random_points(const struct surface *surface, struct rng *rng, struct gd_point *out,
                          uint32_t count)
{
    for (uint32_t i = 0; i < count;) {
        out[i] = test_point(surface->mesh, test_random_place(&surface->polygons, rng));
        bool is_apart = gd_point_component(surface->mesh, &out[i]) ==
                        gd_point_component(surface->mesh, &out[0]);
        for (uint32_t k = 0; k < i; k++) is_apart &= !gd_point_equal(&out[i], &out[k]);
        i += is_apart;
    }
}

/* --- the plane -------------------------------------------------------------------------------- */

/* Evaluates the cubic with the end points p[0], p[1] and the tangents m[0], m[1] by Hermite's
 * basis. */
static struct gd_vec3 hermite(const struct gd_vec3 *p, const struct gd_vec3 *m, double span,
                              double t)
{
    double t2 = t * t, t3 = t2 * t;
    struct gd_vec3 at = gd_vec3_scale(p[0], 2 * t3 - 3 * t2 + 1);
    at = gd_vec3_along(at, (t3 - 2 * t2 + t) * span, m[0]);
    at = gd_vec3_along(at, 3 * t2 - 2 * t3, p[1]);
    return gd_vec3_along(at, (t3 - t2) * span, m[1]);
}

static void check_plane(const struct gd_mesh *mesh, const struct gd_point *points, bool closed,
                        double alpha, double tension, enum gd_tangent_rule rule)
{
    struct gd_vec3 p[POINTS + 1], m[POINTS + 1];
    double u[POINTS + 1] = {0};
    uint32_t count = POINTS - !closed;
    for (uint32_t i = 0; i <= POINTS; i++) p[i] = gd_point_position(mesh, &points[i % POINTS]);
    for (uint32_t i = 0; i < POINTS; i++)
        u[i + 1] = u[i] + pow(gd_vec3_distance(p[i], p[i + 1]), alpha);
    for (uint32_t i = 0; i <= count; i++) {
        uint32_t before = i ? i - 1 : POINTS - 1, after = i == count && closed ? 1 : i + 1;
        double span = (i == count && closed ? u[1]
                       : i < POINTS         ? u[i + 1] - u[i]
                                            : 0) +
                      u[before + 1] - u[before];
        if (after > POINTS) continue;
        m[i] = gd_vec3_scale(gd_vec3_sub(p[after], p[before]), (1 - tension) / span);
    }
    if (!closed) {
        m[0] =
            gd_vec3_along(gd_vec3_scale(gd_vec3_sub(p[1], p[0]), 1.5 / (u[1] - u[0])), -0.5, m[1]);
        uint32_t n = POINTS - 1;
        m[n] = gd_vec3_along(gd_vec3_scale(gd_vec3_sub(p[n], p[n - 1]), 1.5 / (u[n] - u[n - 1])),
                             -0.5, m[n - 1]);
    }
    struct gd_spline spline = build(mesh, &(struct gd_spline_request){.points = points,
                                                                      .count = POINTS,
                                                                      .closed = closed,
                                                                      .alpha = alpha,
                                                                      .tension = tension,
                                                                      .tangent_rule = rule});
    struct gd_spline_line line =
        sample(mesh, &spline, (struct gd_spline_sampling){.per_segment = 7});
    assert_int_equal(line.count, 7 * count + 1);
    for (uint32_t i = 0; i < line.count; i++) {
        uint32_t k = i == 7 * count ? count - 1 : i / 7;
        double t = (line.places[i].parameter - u[k]) / (u[k + 1] - u[k]);
        struct gd_vec3 at = hermite(&p[k], &m[k], u[k + 1] - u[k], t);
        expect_place(gd_point_position(mesh, &line.places[i].point), at.x, at.y, at.z, 1e-13);
    }
    gd_spline_line_free(&line);
    gd_spline_free(&spline);
}

static void equals_the_classical_spline_in_the_plane(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){40, 30, 1, 1});
    struct rng rng = {3};
    for (int i = 0; i < 20; i++) {
        struct gd_point points[POINTS];
        for (uint32_t k = 0; k < POINTS; k++)
            points[k] =
                nearest(plane.mesh, rng_between(&rng, 0.4, 0.6), rng_between(&rng, 0.4, 0.6), 0);
        check_plane(plane.mesh, points, i % 2, 0.5 * (i % 3), 0.25 * (i % 4),
                    (enum gd_tangent_rule)(i / 2 % 2));
    }
    surface_free(&plane);
}

/* Returns the angle by which the polyline a-b-c turns at b, in the plane. */
static double plane_turn(struct gd_vec3 a, struct gd_vec3 b, struct gd_vec3 c)
{
    struct gd_vec3 in = gd_vec3_sub(b, a), out = gd_vec3_sub(c, b);
    return fabs(atan2(in.x * out.y - in.y * out.x, in.x * out.x + in.y * out.y));
}

/* If the speed at an end is 0, the curve is tangent to the line from this end to the first control
 * point that differs from the end. */
static void is_tangent_where_the_speed_is_zero(void **state)
{
    (void)state;
    struct surface plane = surface_of("grid", (double[SAMPLE_PARAMETERS]){40, 30, 1, 1});
    struct gd_point points[3] = {nearest(plane.mesh, 0.2, 0.3, 0), nearest(plane.mesh, 0.5, 0.4, 0),
                                 nearest(plane.mesh, 0.6, 0.8, 0)};
    struct gd_vec3 p[3];
    for (int i = 0; i < 3; i++) p[i] = gd_point_position(plane.mesh, &points[i]);
    struct gd_spline_request request = {
        .points = points, .count = 3, .alpha = 1, .tension = 1, .end_rule = GD_END_ZERO};
    for (int closed = 0; closed < 2; closed++) {
        request.closed = closed;
        struct gd_spline polyline = build(plane.mesh, &request);
        expect_near(polyline.knots[1].angle_jump, plane_turn(p[0], p[1], p[2]), 1e-12);
        expect_near(polyline.knots[0].angle_jump, closed ? plane_turn(p[2], p[0], p[1]) : 0, 1e-12);
        expect_near(polyline.knots[2].angle_jump, closed ? plane_turn(p[1], p[2], p[0]) : 0, 1e-12);
        expect_near(polyline.knots[1].speed_jump, 0, 0);
        gd_spline_free(&polyline);
    }
    /* only the middle tangent is 0, so the control points of the neighbours determine the
       tangents */
    request = (struct gd_spline_request){.points = points,
                                         .count = 3,
                                         .tangents = (struct gd_vector[3]){{{0}, 0}},
                                         .is_given = (const bool[3]){false, true, false}};
    struct gd_spline spline = build(plane.mesh, &request);
    struct gd_vec3 before = gd_point_position(plane.mesh, &spline.segments[0].control[1]),
                   behind = gd_point_position(plane.mesh, &spline.segments[1].control[2]);
    expect_near(spline.knots[1].angle_jump, plane_turn(before, p[1], behind), 1e-12);
    struct gd_spline_line line = sample(
        plane.mesh, &spline,
        (struct gd_spline_sampling){.parameters = (double[]){1 - 1e-5, 1, 1 + 1e-5}, .count = 3});
    struct gd_vec3 near[3];
    for (int i = 0; i < 3; i++) near[i] = gd_point_position(plane.mesh, &line.places[i].point);
    expect_near(plane_turn(near[0], near[1], near[2]), spline.knots[1].angle_jump, 1e-3);
    gd_spline_line_free(&line);
    gd_spline_free(&spline);
    surface_free(&plane);
}

/* Checks that the path's length is the sum of the distances between consecutive points. */
static void check_path(const struct gd_mesh *mesh, const struct gd_path *path)
{
    double length = 0;
    for (uint32_t i = 1; i < path->count; i++) {
        struct gd_vec3 a = gd_point_position(mesh, &path->points[i - 1]),
                       b = gd_point_position(mesh, &path->points[i]);
        length += gd_vec3_distance(a, b);
    }
    check_close(path->length, length, 1e-12);
}

/* Returns the point after a fraction of the shortest path between two points. */
static struct gd_point part_way(const struct gd_mesh *mesh, const struct gd_point *from,
                                const struct gd_point *to, double part)
{
    struct gd_pair_answer answer;
    check_ok(gd_pair_solve(
                 mesh,
                 &(struct gd_pair_request){.from = from, .to = to, .output = GD_PAIR_PATH_AND_CUT},
                 NULL, &answer, NULL),
             NULL);
    double left = part * answer.path.length;
    struct gd_vec3 at = gd_point_position(mesh, from);
    for (uint32_t i = 1; i < answer.path.count; i++) {
        struct gd_vec3 a = gd_point_position(mesh, &answer.path.points[i - 1]),
                       b = gd_point_position(mesh, &answer.path.points[i]);
        double length = gd_vec3_distance(a, b), t = length > 0 ? fmin(left / length, 1) : 1;
        at = gd_vec3_along(a, t, gd_vec3_sub(b, a));
        left -= length;
        if (left <= 0) break;
    }
    gd_path_free(&answer.path);
    return nearest(mesh, at.x, at.y, at.z);
}

/* Compares a point of the spline with de Casteljau's construction by six shortest paths. */
static void check_casteljau(const struct gd_mesh *mesh, const struct gd_spline *spline, double part,
                            struct gd_vec3 at, double error)
{
    struct gd_point p[4];
    memcpy(p, spline->segments[0].control, sizeof p);
    for (int level = 3; level > 0; level--)
        for (int i = 0; i < level; i++) p[i] = part_way(mesh, &p[i], &p[i + 1], part);
    struct gd_vec3 expected = gd_point_position(mesh, &p[0]);
    expect_place(at, expected.x, expected.y, expected.z, error);
}

static void equals_de_casteljaus_construction(void **state)
{
    (void)state;
    enum { STEPS = 5 };
    struct surface sphere = surface_of("icosphere", (double[SAMPLE_PARAMETERS]){3, 1});
    struct gd_point points[3] = {nearest(sphere.mesh, 1, 0.1, 0.2),
                                 nearest(sphere.mesh, 0.1, 0.2, 1),
                                 nearest(sphere.mesh, -0.7, 0.9, 0.3)};
    struct gd_spline spline =
        build(sphere.mesh, &(struct gd_spline_request){.points = points, .count = 3, .alpha = 0.5});
    struct gd_spline_sampling sampling = {.per_segment = STEPS,
                                          .evaluation = GD_SPLINE_DE_CASTELJAU};
    struct gd_spline_line line = sample(sphere.mesh, &spline, sampling);
    sampling.evaluation = GD_SPLINE_HALVING;
    struct gd_spline_line halved = sample(sphere.mesh, &spline, sampling);
    double most = 0;
    for (uint32_t i = 0; i < STEPS; i++) {
        struct gd_vec3 at = gd_point_position(sphere.mesh, &line.places[i].point);
        check_casteljau(sphere.mesh, &spline, (double)i / STEPS, at, 1e-9);
        most = fmax(most,
                    gd_vec3_distance(at, gd_point_position(sphere.mesh, &halved.places[i].point)));
    }
    assert_true(most > 1e-4 && most < 2e-2);
    check_path(sphere.mesh, &line.path);
    sampling = (struct gd_spline_sampling){
        .spline = &spline, .even = 4, .evaluation = GD_SPLINE_DE_CASTELJAU};
    struct gd_spline_line none;
    assert_int_equal(gd_spline_sample(sphere.mesh, &sampling, NULL, &none, NULL),
                     GD_INVALID_ARGUMENT);
    gd_spline_line_free(&line);
    gd_spline_line_free(&halved);
    gd_spline_free(&spline);
    surface_free(&sphere);
}

/* --- laws ------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    double values[SAMPLE_PARAMETERS];
} surfaces[] = {{"icosphere", {3, 1}}, {"torus", {36, 24, 1, 0.4}}, {"cylinder", {1, 2, 24, 12}}};

static bool is_clipped(const struct gd_spline *spline)
{
    bool is = false;
    for (uint32_t i = 0; i < spline->count; i++) is |= spline->segments[i].is_clipped;
    return is;
}

/* Checks `along` of each place, which is the length of the path up to this place. From place to
 * place, `along` grows by at least the chord. At the last place, it is the length of the whole
 * path. */
static void check_along(const struct gd_mesh *mesh, const struct gd_spline_line *line)
{
    const struct gd_spline_place *places = line->places;
    assert_true(places[0].along == 0);
    for (uint32_t i = 1; i < line->count; i++) {
        double chord = gd_vec3_distance(gd_point_position(mesh, &places[i - 1].point),
                                        gd_point_position(mesh, &places[i].point));
        assert_true(places[i].along - places[i - 1].along >= chord - 1e-12 * line->path.length);
    }
    assert_true(places[line->count - 1].along == line->path.length);
}

static void check_laws(const struct surface *surface, const struct gd_point *points,
                       struct gd_spline_request request)
{
    const struct gd_mesh *mesh = surface->mesh;
    struct gd_point turned[POINTS];
    request.points = points;
    struct gd_spline spline = build(mesh, &request);
    struct gd_spline_line line =
        sample(mesh, &spline, (struct gd_spline_sampling){.per_segment = 8});
    check_path(mesh, &line.path);
    check_along(mesh, &line);
    for (uint32_t i = 0; i <= spline.count; i++) {
        assert_true(gd_point_equal(&line.places[8 * i].point, &points[i % request.count]));
        if (is_clipped(&spline)) continue;
        expect_near(spline.knots[i].angle_jump, 0, 1e-9);
        expect_near(spline.knots[i].speed_jump, 0, 1e-9);
    }
    for (uint32_t i = 0; i < request.count; i++) turned[i] = points[request.count - 1 - i];
    request.points = turned;
    struct gd_spline back = build(mesh, &request);
    uint32_t shift = request.closed ? 8 * (spline.count - 1) : line.count - 1;
    struct gd_spline_line other =
        sample(mesh, &back, (struct gd_spline_sampling){.per_segment = 8});
    for (uint32_t i = 0; i < line.count; i++) {
        uint32_t k =
            request.closed ? (shift + 8 * spline.count - i) % (8 * spline.count) : shift - i;
        struct gd_vec3 at = gd_point_position(mesh, &other.places[k].point);
        expect_place(gd_point_position(mesh, &line.places[i].point), at.x, at.y, at.z, 1e-9);
    }
    gd_spline_line_free(&line);
    gd_spline_line_free(&other);
    gd_spline_free(&spline);
    gd_spline_free(&back);
}

static void laws_on_surfaces(void **state)
{
    (void)state;
    for (uint32_t s = 0; s < COUNT(surfaces); s++) {
        struct surface surface = surface_of(surfaces[s].name, surfaces[s].values);
        struct rng rng = {s};
        for (int i = 0; i < 40; i++) {
            struct gd_point points[POINTS];
            random_points(&surface, &rng, points, POINTS);
            struct gd_spline_request request = {.count = POINTS,
                                                .closed = i % 2,
                                                .alpha = 0.5 * (i % 3),
                                                .tension = 0.4,
                                                .end_rule = i / 2 % 2};
            if (surfaces[s].name[0] == 'c') request.tension = 0.9;
            check_laws(&surface, points, request);
        }
        surface_free(&surface);
    }
}

/* Checks the laws on meshes of ../shared/meshes. Missing files are skipped. */
static void laws_on_shared_meshes(void **state)
{
    (void)state;
    static const char *const names[] = {"cow",     "fandisk",    "spot",
                                        "suzanne", "rocker-arm", "stanford-bunny"};
    for (uint32_t i = 0; i < COUNT(names); i++) {
        struct surface surface;
        if (!surface_read(names[i], &surface)) continue;
        struct rng rng = {i};
        for (int k = 0; k < 3; k++) {
            struct gd_point points[POINTS];
            random_points(&surface, &rng, points, POINTS);
            check_laws(&surface, points,
                       (struct gd_spline_request){.count = POINTS, .closed = k % 2, .alpha = 0.5});
        }
        surface_free(&surface);
    }
}

/* Scaling the mesh scales the curve. */
static void scaling_the_mesh_scales_the_spline(void **state)
{
    (void)state;
    double length = 0;
    for (int i = 0; i < 3; i++) {
        double scale = i == 0 ? 1 : i == 1 ? 1e-6 : 1e6;
        struct surface sphere = {0};
        check_ok(
            sample_find("icosphere")->generate((double[SAMPLE_PARAMETERS]){3, 1}, &sphere.polygons),
            NULL);
        for (uint32_t v = 0; v < sphere.polygons.position_count; v++)
            for (int k = 0; k < 3; k++) sphere.polygons.positions[v][k] *= scale;
        sphere.mesh = test_mesh(&sphere.polygons);
        struct gd_point points[3] = {vertex(sphere.mesh, 5), vertex(sphere.mesh, 77),
                                     vertex(sphere.mesh, 300)};
        struct gd_spline spline = build(
            sphere.mesh, &(struct gd_spline_request){.points = points, .count = 3, .closed = true});
        struct gd_spline_line line =
            sample(sphere.mesh, &spline, (struct gd_spline_sampling){.even = 30});
        if (i == 0) length = line.path.length;
        /* the length of each step; the step's chord has almost the same length */
        double speed = line.path.length / 30;
        for (uint32_t k = 1; k < line.count; k++)
            check_close(gd_vec3_distance(gd_point_position(sphere.mesh, &line.places[k - 1].point),
                                         gd_point_position(sphere.mesh, &line.places[k].point)),
                        speed, 0.01);
        check_close(line.path.length, length * scale, 1e-9);
        gd_spline_line_free(&line);
        gd_spline_free(&spline);
        surface_free(&sphere);
    }
}

/* With tension 1 the spline is the polyline of shortest paths. A smaller tolerance never reduces
 * the length. */
static void lengths_depend_on_tension_and_tolerance(void **state)
{
    (void)state;
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){36, 24, 1, 0.4});
    struct gd_point points[3] = {vertex(torus.mesh, 3), vertex(torus.mesh, 200),
                                 vertex(torus.mesh, 500)};
    struct gd_spline_request request = {
        .points = points, .count = 3, .tension = 1, .end_rule = GD_END_ZERO};
    struct gd_spline spline = build(torus.mesh, &request);
    struct gd_spline_line line =
        sample(torus.mesh, &spline, (struct gd_spline_sampling){.tolerance = 1e-3});
    check_close(line.path.length, spline.segments[0].distance + spline.segments[1].distance, exact);
    gd_spline_line_free(&line);
    gd_spline_free(&spline);
    request.tension = 0;
    spline = build(torus.mesh, &request);
    double before = 0;
    for (double tolerance = 0.1; tolerance > 1e-6; tolerance /= 10) {
        line = sample(torus.mesh, &spline, (struct gd_spline_sampling){.tolerance = tolerance});
        assert_true(line.path.length >= before * (1 - 1e-6));
        before = line.path.length;
        gd_spline_line_free(&line);
    }
    struct gd_curve curve;
    request.sampling = &(struct gd_spline_sampling){.tolerance = 1e-6};
    check_ok(gd_spline_curve(torus.mesh, &request, NULL, &curve, NULL), NULL);
    check_close(gd_curve_length(torus.mesh, &curve), before, 1e-5);
    gd_curve_free(&curve);
    gd_spline_free(&spline);
    surface_free(&torus);
}

static bool never(void *user, double fraction)
{
    (void)user, (void)fraction;
    return false;
}

/* --- two searches at a time ------------------------------------------------------------------- */

struct task {
    void (*run)(void *context, uint32_t index);
    void *context;
};

static void *do_first(void *user)
{
    struct task *task = user;
    task->run(task->context, 0);
    return NULL;
}

/* Runs the first task on a separate thread and the second task on the caller's thread. */
static void run_on_two(void *user, void (*task)(void *context, uint32_t index), void *context,
                       uint32_t count)
{
    pthread_t thread;
    struct task first = {task, context};
    (void)user;
    assert_int_equal(count, 2);
    assert_int_equal(pthread_create(&thread, NULL, do_first, &first), 0);
    task(context, 1);
    assert_int_equal(pthread_join(thread, NULL), 0);
}

struct listener {
    pthread_t home;
    double heard;
    uint32_t calls, most;
};

static bool listen_to(void *user, double fraction)
{
    struct listener *listener = user;
    assert_true(pthread_equal(listener->home, pthread_self()));
    assert_true(fraction >= listener->heard && fraction <= 1);
    listener->heard = fraction;
    return ++listener->calls < listener->most;
}

static void check_same(const struct gd_spline *a, const struct gd_spline *b)
{
    assert_int_equal(a->count, b->count);
    for (uint32_t i = 0; i < a->count; i++) {
        assert_true(a->segments[i].distance == b->segments[i].distance &&
                    a->segments[i].end == b->segments[i].end);
        for (int k = 0; k < 4; k++)
            assert_true(gd_point_equal(&a->segments[i].control[k], &b->segments[i].control[k]));
        for (int k = 0; k < 3; k++) {
            const struct gd_path *leg = &a->segments[i].arms[k], *other = &b->segments[i].arms[k];
            assert_true(leg->count == other->count && leg->length == other->length);
        }
    }
}

/* With an executor the spline is the same bit for bit. Progress is reported on the caller's thread
 * and never decreases. Cancelling stops both searches. */
static void two_searches_at_a_time_give_the_same_spline(void **state)
{
    (void)state;
    enum { MANY = 9 };
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){60, 40, 1, 0.4});
    struct rng rng = {17};
    struct gd_point points[MANY];
    random_points(&torus, &rng, points, MANY);
    const struct gd_executor executor = {.width = 2, .run = run_on_two};
    struct gd_control control = {.workspace = gd_workspace_create()};
    for (int way = 0; way < 8; way++) {
        struct gd_spline_request request = {.points = points,
                                            .count = MANY,
                                            .closed = way & 1,
                                            .alpha = 0.5,
                                            .tangent_rule =
                                                way & 2 ? GD_TANGENT_PAPER : GD_TANGENT_SYMMETRIC};
        struct gd_spline alone = build(torus.mesh, &request), together;
        struct listener listener = {.home = pthread_self(), .most = UINT32_MAX};
        request.executor = &executor;
        control.progress = listen_to;
        control.user = &listener;
        control.budget_bytes = way & 4 ? (size_t)64 << 20 : 0;
        check_ok(gd_spline_build(torus.mesh, &request, &control, &together, NULL), NULL);
        check_same(&alone, &together);
        gd_spline_free(&together);
        assert_true(listener.calls > 0);
        listener = (struct listener){.home = pthread_self(), .most = 3};
        assert_int_equal(gd_spline_build(torus.mesh, &request, &control, &together, NULL),
                         GD_CANCELLED);
        gd_spline_free(&alone);
    }
    gd_workspace_destroy(control.workspace);
    surface_free(&torus);
}

/* If two given tangents are invalid, the error names the first one. */
static void two_searches_at_a_time_report_the_same_error(void **state)
{
    (void)state;
    enum { MANY = 6 };
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){60, 40, 1, 0.4});
    struct rng rng = {18};
    struct gd_point points[MANY];
    random_points(&torus, &rng, points, MANY);
    struct gd_vector tangents[MANY] = {0};
    const bool is_given[MANY] = {false, false, true, false, true, false};
    tangents[2].length = tangents[4].length = 1e9;
    const struct gd_executor executor = {.width = 2, .run = run_on_two};
    struct gd_spline_request request = {.points = points,
                                        .count = MANY,
                                        .tangents = tangents,
                                        .is_given = is_given,
                                        .executor = &executor};
    struct gd_spline spline;
    struct gd_detail detail = {0};
    assert_int_equal(gd_spline_build(torus.mesh, &request, NULL, &spline, &detail),
                     GD_INVALID_ARGUMENT);
    assert_true(detail.count == 1 && detail.elements[0][0] == 2 && strstr(detail.text, "point 2"));
    surface_free(&torus);
}

/* The smallest budget for one search at a time is enough with an executor too. */
static void two_searches_fit_into_the_budget_of_one(void **state)
{
    (void)state;
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){60, 40, 1, 0.4});
    struct gd_point points[3] = {vertex(torus.mesh, 3), vertex(torus.mesh, 900),
                                 vertex(torus.mesh, 1500)};
    const struct gd_executor executor = {.width = 2, .run = run_on_two};
    struct gd_spline_request request = {.points = points, .count = 3};
    struct gd_control control = {0};
    struct gd_spline spline;
    for (control.budget_bytes = 1024;
         gd_spline_build(torus.mesh, &request, &control, &spline, NULL) == GD_BUDGET;)
        control.budget_bytes += control.budget_bytes / 8;
    gd_spline_free(&spline);
    request.executor = &executor;
    check_ok(gd_spline_build(torus.mesh, &request, &control, &spline, NULL), NULL);
    gd_spline_free(&spline);
    surface_free(&torus);
}

static void refusals(void **state)
{
    (void)state;
    struct surface torus = surface_of("torus", (double[SAMPLE_PARAMETERS]){36, 24, 1, 0.4});
    struct gd_point points[3] = {vertex(torus.mesh, 3), vertex(torus.mesh, 200),
                                 vertex(torus.mesh, 200)};
    struct gd_spline spline;
    struct gd_detail detail = {0};
    struct gd_spline_request request = {.points = points, .count = 3};
    assert_int_equal(gd_spline_build(torus.mesh, &request, NULL, &spline, &detail),
                     GD_INVALID_ARGUMENT);
    assert_true(detail.count == 1 && detail.elements[0][0] == 2);
    request.count = 1;
    assert_int_equal(gd_spline_build(torus.mesh, &request, NULL, &spline, &detail),
                     GD_INVALID_ARGUMENT);
    request.count = 2;
    request.alpha = 1.5;
    assert_int_equal(gd_spline_build(torus.mesh, &request, NULL, &spline, &detail),
                     GD_INVALID_ARGUMENT);
    request.alpha = 0.5;
    const struct gd_control cancel = {.progress = never}, poor = {.budget_bytes = 100};
    assert_int_equal(gd_spline_build(torus.mesh, &request, &poor, &spline, &detail), GD_BUDGET);
    spline = build(torus.mesh, &request);
    struct gd_spline_line line;
    struct gd_spline_sampling sampling = {.spline = &spline, .per_segment = 4};
    assert_int_equal(gd_spline_sample(torus.mesh, &sampling, &cancel, &line, &detail),
                     GD_CANCELLED);
    assert_int_equal(gd_spline_sample(torus.mesh, &sampling, &poor, &line, &detail), GD_BUDGET);
    sampling.spacing = 1;
    assert_int_equal(gd_spline_sample(torus.mesh, &sampling, NULL, &line, &detail),
                     GD_INVALID_ARGUMENT);
    sampling = (struct gd_spline_sampling){.spline = &spline, .spacing = 1e-9};
    assert_int_equal(gd_spline_sample(torus.mesh, &sampling, NULL, &line, &detail), GD_TOO_LARGE);
    sampling = (struct gd_spline_sampling){
        .spline = &spline, .parameters = (double[2]){0.5, 0.1}, .count = 2};
    assert_int_equal(gd_spline_sample(torus.mesh, &sampling, NULL, &line, &detail),
                     GD_INVALID_ARGUMENT);
    gd_spline_free(&spline);
    surface_free(&torus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_the_classical_spline_in_the_plane),
        cmocka_unit_test(is_tangent_where_the_speed_is_zero),
        cmocka_unit_test(equals_de_casteljaus_construction),
        cmocka_unit_test(laws_on_surfaces),
        cmocka_unit_test(laws_on_shared_meshes),
        cmocka_unit_test(scaling_the_mesh_scales_the_spline),
        cmocka_unit_test(lengths_depend_on_tension_and_tolerance),
        cmocka_unit_test(two_searches_at_a_time_give_the_same_spline),
        cmocka_unit_test(two_searches_at_a_time_report_the_same_error),
        cmocka_unit_test(two_searches_fit_into_the_budget_of_one),
        cmocka_unit_test(refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
