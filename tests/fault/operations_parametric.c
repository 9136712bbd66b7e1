/* Parametric surfaces: NURBS and others, tessellations, curves in their domains, geodesic-like
 * curves. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/space_distance.h"
#include "tests/unit/nurbs/surfaces.h"

#include "gd/geodesic_like.h"

static struct gd_parametric *tube, *sphere, *sheet, *plate;
static struct gd_tessellation *on_tube, *on_sphere, *on_sheet, *on_plate;
static struct gd_domain_curve *tube_a, *tube_b, *tube_loop, *sphere_a, *sphere_b, *sheet_a,
    *sheet_b, *plate_a, *plate_b;
static struct gd_geodesics found;

static struct gd_tessellation *tessellate(const struct gd_parametric *surface)
{
    struct gd_tessellation *made;
    check_ok(gd_tessellation_build(surface, &(struct gd_tessellation_options){.faces = 300}, NULL,
                                   &made, NULL),
             NULL);
    return made;
}

/* Cuts a hole with two round and two straight sides into the sheet. */
static enum gd_status trim_sheet(void *out)
{
    static const double left[][2] = {{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.6}},
                        right[][2] = {{0.7, 0.6}, {0.5, 0.9}, {0.3, 0.6}, {0.3, 0.3}};
    static const double knots[] = {0, 0, 0, 0.5, 1, 1, 1};
    const struct gd_trim_curve curves[] = {
        {.degree = 1, .count = 3, .points = left},
        {.degree = 2, .count = 4, .points = right, .knots = knots}};
    const struct gd_trim_loop loop = {curves, 2};
    return gd_parametric_trim(sheet, &(struct gd_trims){&loop, 1, false}, NULL, out, NULL);
}

static void open_surfaces(void)
{
    tube = nurbs_torus(2, 0.7, 1, 0);
    sphere = nurbs_sphere();
    sheet = nurbs_bumps(6, 6, 0.6, 3);
    on_tube = tessellate(tube);
    on_sphere = tessellate(sphere);
    on_sheet = tessellate(sheet);
    tube_a = point_at(tube, 0.1, 0.2);
    tube_b = point_at(tube, 0.6, 0.7);
    tube_loop = iso_at(tube, GD_ISO_U, 0.4);
    sphere_a = point_at(sphere, 0.1, 0.1);
    sphere_b = point_at(sphere, 0.55, 0.8);
    check_ok(trim_sheet(&plate), NULL);
    on_plate = tessellate(plate);
    plate_a = point_at(plate, 0.1, 0.4);
    plate_b = point_at(plate, 0.9, 0.5);
    sheet_a = point_at(sheet, 0.05, 0.1);
    sheet_b = point_at(sheet, 0.9, 0.8);
    check_ok(gd_geodesic_solve(on_tube, &(struct gd_geodesic_request){.from = tube_a, .to = tube_b},
                               NULL, &found, NULL),
             NULL);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_surface(struct digest *digest, const void *out)
{
    const struct gd_parametric *surface = *(struct gd_parametric *const *)out;
    struct gd_jet jet = {0};
    const struct gd_axis *u = gd_parametric_axis_u(surface), *v = gd_parametric_axis_v(surface);
    enum gd_status status = gd_parametric_evaluate(surface, 0.3 * u->low + 0.7 * u->high,
                                                   0.6 * v->low + 0.4 * v->high, &jet);
    digest_number(digest, status);
    digest_bytes(digest, &jet, sizeof jet);
    digest_number(digest, gd_parametric_size(surface));
}

static void discard_surface(void *out)
{
    gd_parametric_release(*(struct gd_parametric **)out);
}

static void digest_tessellation(struct digest *digest, const void *out)
{
    digest_mesh(digest, gd_tessellation_mesh(*(struct gd_tessellation *const *)out));
}

static void discard_tessellation(void *out)
{
    gd_tessellation_release(*(struct gd_tessellation **)out);
}

static void digest_domain_curve(struct digest *digest, const void *out)
{
    const struct gd_domain_curve *curve = *(struct gd_domain_curve *const *)out;
    double low, high, uv[2];
    gd_domain_curve_range(curve, &low, &high);
    gd_domain_curve_at(curve, 0.4 * low + 0.6 * high, uv);
    digest_bytes(digest, uv, sizeof uv);
}

static void discard_domain_curve(void *out)
{
    gd_domain_curve_release(*(struct gd_domain_curve **)out);
}

static void digest_geodesics(struct digest *digest, const void *out)
{
    const struct gd_geodesics *geodesics = out;
    for (uint32_t i = 0; i < geodesics->count; i++) {
        const struct gd_geodesic *item = &geodesics->items[i];
        digest_number(digest, item->length);
        for (uint32_t k = 0; k < item->piece_count; k++)
            digest_bytes(digest, item->pieces[k].points,
                         item->pieces[k].count * sizeof *item->pieces[k].points);
    }
}

static void discard_geodesics(void *out)
{
    gd_geodesics_free(out);
}

static void digest_foot(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, sizeof(struct gd_parametric_closest));
}

static void digest_space_foot(struct digest *digest, const void *out)
{
    digest_number(digest, ((const struct gd_space_closest *)out)->distance);
}

enum { SAMPLED = 9 };

static void digest_places(struct digest *digest, const void *out)
{
    digest_bytes(digest, out, SAMPLED * sizeof(double[2]));
}

static const struct answer a_surface = {sizeof(struct gd_parametric *), digest_surface,
                                        discard_surface};
static const struct answer a_tessellation = {sizeof(struct gd_tessellation *), digest_tessellation,
                                             discard_tessellation};
static const struct answer a_domain_curve = {sizeof(struct gd_domain_curve *), digest_domain_curve,
                                             discard_domain_curve};
static const struct answer geodesics = {sizeof(struct gd_geodesics), digest_geodesics,
                                        discard_geodesics};
static const struct answer a_foot = {sizeof(struct gd_parametric_closest), digest_foot, NULL};
static const struct answer a_space_foot = {sizeof(struct gd_space_closest), digest_space_foot,
                                           NULL};
static const struct answer some_places = {SAMPLED * sizeof(double[2]), digest_places, NULL};

/* --- calls ------------------------------------------------------------------------------------ */

static enum gd_status create_nurbs(void *out)
{
    static const double knots[] = {0, 0, 0, 0.5, 1, 1, 1}, ends[] = {0, 0, 1, 1};
    static const double points[8][3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 1}, {1, 1, 1},
                                        {2, 0, 0}, {2, 1, 0}, {3, 0, 1}, {3, 1, 1}};
    struct gd_detail detail = {0};
    return gd_nurbs_create(&(struct gd_nurbs_data){.degree_u = 2,
                                                   .degree_v = 1,
                                                   .count_u = 4,
                                                   .count_v = 2,
                                                   .knots_u = knots,
                                                   .knots_v = ends,
                                                   .knot_count_u = 7,
                                                   .knot_count_v = 4,
                                                   .points = points},
                           out, &detail);
}

static enum gd_status create_torus(void *out)
{
    return gd_parametric_torus(2, 0.5, out, NULL);
}

static enum gd_status create_helicoid(void *out)
{
    return gd_parametric_helicoid(1, (const double[2]){0, 3}, (const double[2]){0.5, 2}, out, NULL);
}

static enum gd_status create_graph(void *out)
{
    return gd_parametric_graph(&(struct gd_graph){1, 1, (const double[4]){0, 0, 0, 1},
                                                  (const double[2]){0, 1}, (const double[2]){0, 1}},
                               out, NULL);
}

static enum gd_status create_revolution(void *out)
{
    static const double knots[] = {0, 0, 0, 1, 1, 1}, points[3][2] = {{1, 0}, {2, 1}, {1, 2}};
    return gd_parametric_revolution(
        &(struct gd_profile){.degree = 2, .count = 3, .knots = knots, .points = points}, out, NULL);
}

static enum gd_status nearest(void *out)
{
    return gd_parametric_nearest(sheet, (struct gd_vec3){2, 2, 2}, NULL, out, NULL);
}

static enum gd_status build_tessellation(void *out)
{
    return gd_tessellation_build(sphere, &(struct gd_tessellation_options){.faces = 200}, NULL, out,
                                 NULL);
}

static enum gd_status build_even_tessellation(void *out)
{
    return gd_tessellation_build(sheet, &(struct gd_tessellation_options){.steps = {5, 7}}, NULL,
                                 out, NULL);
}

static enum gd_status build_near_tessellation(void *out)
{
    return gd_tessellation_build(sheet, &(struct gd_tessellation_options){.deviation = 0.1}, NULL,
                                 out, NULL);
}

static enum gd_status build_polyline(void *out)
{
    return gd_domain_curve_polyline(
        sheet,
        &(struct gd_domain_polyline){(const double[3][2]){{0.1, 0.1}, {0.4, 0.2}, {0.5, 0.6}}, 3},
        NULL, out, NULL);
}

static enum gd_status build_bspline(void *out)
{
    static const double knots[] = {0, 0, 0, 1, 1, 1};
    return gd_domain_curve_bspline(
        sheet,
        &(struct gd_domain_bspline){2, knots,
                                    (const double[3][2]){{0.1, 0.1}, {0.4, 0.2}, {0.5, 0.6}}, 3},
        NULL, out, NULL);
}

static enum gd_status build_iso(void *out)
{
    return gd_domain_curve_iso(tube, GD_ISO_V, 0.3, out, NULL);
}

static enum gd_status build_point(void *out)
{
    return gd_domain_curve_point(tube, 0.3, 0.3, out, NULL);
}

static enum gd_status solve(const struct gd_tessellation *on, const struct gd_domain_curve *from,
                            const struct gd_domain_curve *to,
                            const struct gd_geodesic_options *options, void *out)
{
    struct gd_detail detail = {0};
    return gd_geodesic_solve(
        on, &(struct gd_geodesic_request){.from = from, .to = to, .options = options}, NULL, out,
        &detail);
}

static enum gd_status solve_tube(void *out)
{
    return solve(on_tube, tube_a, tube_b, NULL, out);
}

static enum gd_status solve_minima(void *out)
{
    return solve(on_tube, tube_a, tube_b, &(struct gd_geodesic_options){.all_minima = true}, out);
}

static enum gd_status solve_loop(void *out)
{
    return solve(on_tube, tube_a, tube_loop, NULL, out);
}

static enum gd_status solve_meeting(void *out)
{
    return solve(on_tube, tube_loop, tube_loop, NULL, out);
}

static enum gd_status solve_sphere(void *out)
{
    return solve(on_sphere, sphere_a, sphere_b, NULL, out);
}

static enum gd_status solve_sheet(void *out)
{
    return solve(on_sheet, sheet_a, sheet_b, NULL, out);
}

static enum gd_status solve_as_the_paper(void *out)
{
    return solve(on_sheet, sheet_a, sheet_b,
                 &(struct gd_geodesic_options){.control_points = 12, .degree = 3}, out);
}

static enum gd_status sample(void *out)
{
    return gd_geodesic_sample(tube, &found.items[0], SAMPLED, out, NULL);
}

static enum gd_status in_space(void *out)
{
    static const double knots[] = {0, 0, 0, 0.5, 1, 1, 1}, straight[] = {0, 0, 1, 1};
    static const struct gd_vec3 bent[] = {{0, 0, 0}, {1, 2, 0}, {2, -2, 1}, {3, 0, 0}},
                                line[] = {{0, 3, 3}, {3, 2, 2}};
    return gd_space_distance(
        &(struct gd_space_curve){.degree = 2, .count = 4, .knots = knots, .points = bent},
        &(struct gd_space_curve){.degree = 1, .count = 2, .knots = straight, .points = line}, out,
        NULL);
}

static enum gd_status nearest_trimmed(void *out)
{
    return gd_parametric_nearest(plate, (struct gd_vec3){0.5, 0.5, 0.2}, NULL, out, NULL);
}

static enum gd_status tessellate_trimmed(void *out)
{
    return gd_tessellation_build(plate, &(struct gd_tessellation_options){.faces = 200}, NULL, out,
                                 NULL);
}

static enum gd_status solve_trimmed(void *out)
{
    return gd_geodesic_solve(
        on_plate, &(struct gd_geodesic_request){.from = plate_a, .to = plate_b}, NULL, out, NULL);
}

static const struct operation items[] = {
    {"NURBS surface", &a_surface, create_nurbs, GD_OK, NULL},
    {"torus", &a_surface, create_torus, GD_OK, NULL},
    {"helicoid", &a_surface, create_helicoid, GD_OK, NULL},
    {"graph", &a_surface, create_graph, GD_OK, NULL},
    {"surface of revolution", &a_surface, create_revolution, GD_OK, NULL},
    {"nearest point of a NURBS", &a_foot, nearest, GD_OK, NULL},
    {"tessellation", &a_tessellation, build_tessellation, GD_OK, NULL},
    {"tessellation in even steps", &a_tessellation, build_even_tessellation, GD_OK, NULL},
    {"tessellation to a deviation", &a_tessellation, build_near_tessellation, GD_OK, NULL},
    {"polyline in the domain", &a_domain_curve, build_polyline, GD_OK, NULL},
    {"B-spline in the domain", &a_domain_curve, build_bspline, GD_OK, NULL},
    {"iso-parametric curve", &a_domain_curve, build_iso, GD_OK, NULL},
    {"point of the domain", &a_domain_curve, build_point, GD_OK, NULL},
    {"geodesic-like curve on a torus", &geodesics, solve_tube, GD_OK, NULL},
    {"geodesic-like curves, all minima", &geodesics, solve_minima, GD_OK, NULL},
    {"geodesic-like curve to a curve", &geodesics, solve_loop, GD_OK, NULL},
    {"geodesic-like curve of curves that meet", &geodesics, solve_meeting, GD_OK, NULL},
    {"geodesic-like curve on a sphere", &geodesics, solve_sphere, GD_OK, NULL},
    {"geodesic-like curve on a sheet", &geodesics, solve_sheet, GD_OK, NULL},
    {"geodesic-like curve of one B-spline", &geodesics, solve_as_the_paper, GD_OK, NULL},
    {"trimmed surface", &a_surface, trim_sheet, GD_OK, NULL},
    {"nearest point of a trimmed surface", &a_foot, nearest_trimmed, GD_OK, NULL},
    {"tessellation of a trimmed surface", &a_tessellation, tessellate_trimmed, GD_OK, NULL},
    {"shortest path in a trimmed domain", &geodesics, solve_trimmed, GD_OK, NULL},
    {"places of a geodesic-like curve", &some_places, sample, GD_OK, NULL},
    {"distance of curves in space", &a_space_foot, in_space, GD_OK, NULL},
};

const struct operations parametric_operations = {open_surfaces, items, COUNT(items)};
