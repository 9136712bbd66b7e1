/* Reproduces Figure 1 of "Geodesic Hermite splines on triangular meshes": Hermite curves in space
 * that are projected onto the surface (to the nearest point, and along two view directions),
 * compared with splines on the surface. If a curve is sampled more finely, the widest gap between
 * samples shrinks, unless the curve is discontinuous. The gaps of projected curves do not shrink. A
 * projection along a direction may also miss the surface. Splines on the surface have neither
 * defect. */
#include <math.h>
#include <stdlib.h>

#include "gd/locate.h"
#include "gd/spline.h"
#include "tests/samples/samples.h"
#include "tests/support/shared.h"
#include "tests/support/test.h"

enum { POINTS = 4, COARSE = 200, FINE = 3200, FINER = FINE / COARSE };

struct scene {
    const char *name;
    struct gd_mesh *mesh;
    struct gd_point points[POINTS];
    struct gd_spline spline;
};

static struct scene scene_of(const char *name, struct gd_mesh *mesh, const double places[POINTS][3])
{
    struct scene scene = {.name = name, .mesh = mesh};
    for (int i = 0; i < POINTS; i++)
        check_ok(gd_locate_nearest(mesh, (struct gd_vec3){places[i][0], places[i][1], places[i][2]},
                                   -1, &scene.points[i], NULL),
                 NULL);
    struct gd_spline_request request = {.points = scene.points, .count = POINTS, .alpha = 0.5};
    check_ok(gd_spline_build(mesh, &request, NULL, &scene.spline, NULL), NULL);
    return scene;
}

static struct gd_mesh *sample_of(const char *name, const double *values)
{
    struct gd_polygons polygons;
    check_ok(sample_find(name)->generate(values, &polygons), NULL);
    struct gd_mesh *mesh = test_mesh(&polygons);
    gd_polygons_free(&polygons);
    return mesh;
}

static void scene_free(struct scene *scene)
{
    gd_spline_free(&scene->spline);
    gd_mesh_release(scene->mesh);
}

/* --- the curve in space ----------------------------------------------------------------------- */

/* Returns the Catmull-Rom tangent at point i for centripetal parameters; at the ends returns the
 * tangent of a natural spline. */
static struct gd_vec3 tangent(const struct gd_vec3 *p, const double *u, int i)
{
    if (i > 0 && i + 1 < POINTS)
        return gd_vec3_scale(gd_vec3_sub(p[i + 1], p[i - 1]), 1 / (u[i + 1] - u[i - 1]));
    int other = i ? i - 1 : 1;
    struct gd_vec3 slope = gd_vec3_scale(gd_vec3_sub(p[other], p[i]), 1 / (u[other] - u[i]));
    return gd_vec3_along(gd_vec3_scale(slope, 1.5), -0.5, tangent(p, u, other));
}

/* Returns the point of segment `i` at t in [0, 1]. */
static struct gd_vec3 in_space(const struct scene *scene, int i, double t)
{
    struct gd_vec3 p[POINTS];
    double u[POINTS] = {0};
    for (int k = 0; k < POINTS; k++) p[k] = gd_point_position(scene->mesh, &scene->points[k]);
    for (int k = 1; k < POINTS; k++) u[k] = u[k - 1] + sqrt(gd_vec3_distance(p[k], p[k - 1]));
    double t2 = t * t, t3 = t2 * t, span = u[i + 1] - u[i];
    struct gd_vec3 at = gd_vec3_scale(p[i], 2 * t3 - 3 * t2 + 1);
    at = gd_vec3_along(at, (t3 - 2 * t2 + t) * span, tangent(p, u, i));
    at = gd_vec3_along(at, 3 * t2 - 2 * t3, p[i + 1]);
    return gd_vec3_along(at, (t3 - t2) * span, tangent(p, u, i + 1));
}

/* --- gaps ------------------------------------------------------------------------------------- */

/* Defects of a projected curve: the widest gap between consecutive samples, the number of samples
 * that miss the surface, and the largest distance from a point that the curve should pass
 * through. */
struct gaps {
    double widest;
    uint32_t missed;
    double beside;
};

typedef bool projection(const struct gd_mesh *mesh, struct gd_vec3 from, const void *user,
                        struct gd_vec3 *out);

static bool to_nearest(const struct gd_mesh *mesh, struct gd_vec3 from, const void *user,
                       struct gd_vec3 *out)
{
    struct gd_point point;
    (void)user;
    check_ok(gd_locate_nearest(mesh, from, -1, &point, NULL), NULL);
    *out = gd_point_position(mesh, &point);
    return true;
}

/* Projects along the view direction: finds the first hit of the ray through `from`. */
static bool along_view(const struct gd_mesh *mesh, struct gd_vec3 from, const void *user,
                       struct gd_vec3 *out)
{
    const struct gd_vec3 *view = user;
    struct gd_point point;
    double far = 10 * gd_vec3_distance(gd_mesh_summary(mesh)->min, gd_mesh_summary(mesh)->max);
    struct gd_vec3 eye = gd_vec3_along(from, -far, *view);
    if (gd_locate_first_hit(mesh, eye, *view, &point, NULL)) return false;
    *out = gd_point_position(mesh, &point);
    return true;
}

static struct gaps project(const struct scene *scene, uint32_t count, projection *onto,
                           const void *user)
{
    struct gaps gaps = {0};
    struct gd_vec3 last = {0}, here;
    bool has_last = false;
    for (int i = 0; i + 1 < POINTS; i++) {
        for (uint32_t k = 0; k <= count; k++) {
            bool is_there = onto(scene->mesh, in_space(scene, i, (double)k / count), user, &here);
            if (is_there && has_last) gaps.widest = fmax(gaps.widest, gd_vec3_distance(last, here));
            gaps.missed += !is_there;
            if (is_there && k % count == 0)
                gaps.beside =
                    fmax(gaps.beside, gd_vec3_distance(here, in_space(scene, i, k / count)));
            has_last = is_there;
            last = here;
        }
    }
    return gaps;
}

static double widest_of_ours(const struct scene *scene, uint32_t count)
{
    struct gd_spline_line line;
    double widest = 0;
    check_ok(gd_spline_sample(
                 scene->mesh,
                 &(struct gd_spline_sampling){.spline = &scene->spline, .per_segment = count}, NULL,
                 &line, NULL),
             NULL);
    for (uint32_t i = 0; i + 1 < line.count; i++)
        widest = fmax(widest,
                      gd_vec3_distance(gd_point_position(scene->mesh, &line.places[i].point),
                                       gd_point_position(scene->mesh, &line.places[i + 1].point)));
    for (int i = 0; i < POINTS; i++)
        assert_true(gd_point_equal(&line.places[(uint32_t)i * count].point, &scene->points[i]));
    gd_spline_line_free(&line);
    return widest;
}

/* --- the figure ------------------------------------------------------------------------------- */

/* Checks that with FINER times as many samples the spline's gaps shrink by the factor FINER, while
 * the projection to nearest points keeps wide gaps. Also checks that a projection along a view
 * direction misses the surface, has wide gaps, or hits a part in front of the points. */
static void check(struct scene *scene)
{
    static const struct gd_vec3 views[2] = {{0.6, 0, -0.8}, {0, 0.8, -0.6}};
    double coarse = widest_of_ours(scene, COARSE), fine = widest_of_ours(scene, FINE);
    struct gaps nearest = project(scene, FINE, to_nearest, NULL), seen[2];
    for (int i = 0; i < 2; i++) seen[i] = project(scene, FINE, along_view, &views[i]);
    print_message(
        "# %s, %d places: widest gap on the surface %.1e, projected to the nearest points %.1e\n",
        scene->name, (FINE + 1) * (POINTS - 1), fine, nearest.widest);
    for (int i = 0; i < 2; i++)
        print_message(
            "#     along a view %.1e, %u places met nothing, points are passed by at %.1e\n",
            seen[i].widest, seen[i].missed, seen[i].beside);
    assert_true(fine < 1.1 * coarse / FINER);
    assert_true(nearest.widest > 20 * fine);
    for (int i = 0; i < 2; i++)
        assert_true(seen[i].missed || fmax(seen[i].widest, seen[i].beside) > 20 * fine);
    scene_free(scene);
}

/* Uses points around the rim of a thin plate, from face to face. The curve in space crosses the
 * plate. */
static void thin_plate(void **state)
{
    (void)state;
    static const double places[POINTS][3] = {
        {0.2, 0.5, 0.05}, {0.7, 0.4, 0.05}, {0.7, 0.6, 0}, {0.2, 0.3, 0}};
    struct scene scene = scene_of(
        "thin plate", sample_of("box", (double[SAMPLE_PARAMETERS]){1, 1, 0.05, 16}), places);
    check(&scene);
}

/* Uses points around the hole of a torus. The curve in space crosses the hole. */
static void torus(void **state)
{
    (void)state;
    static const double places[POINTS][3] = {
        {1.4, 0, 0}, {0, 0.6, 0}, {-0.6, 0.01, 0}, {0.05, -0.6, 0.02}};
    struct scene scene =
        scene_of("torus", sample_of("torus", (double[SAMPLE_PARAMETERS]){64, 32, 1, 0.4}), places);
    check(&scene);
}

/* Uses points from ear to ear and down the back of the bunny model. */
static void bunny(void **state)
{
    (void)state;
    static const double places[POINTS][3] = {
        {-0.02, 0.19, 0.01}, {-0.09, 0.18, -0.02}, {0.06, 0.05, 0.02}, {-0.03, 0.04, -0.06}};
    struct scene scene = scene_of("bunny", test_shared_mesh("stanford-bunny"), places);
    check(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(thin_plate), cmocka_unit_test(torus),
                                       cmocka_unit_test(bunny)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
