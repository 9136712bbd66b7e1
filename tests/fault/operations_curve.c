/* Operations on curves: splines, shortening, resampling, offsets, cuts. */
#include "tests/fault/operations.h"

#include <stdlib.h>

#include "gd/cut.h"
#include "gd/offset.h"
#include "gd/resampling.h"
#include "gd/shortening.h"
#include "gd/spline.h"
#include "tests/samples/samples.h"
#include "tests/support/test.h"

enum { PLACES = 5 };

static struct gd_mesh *mesh, *ring;
static struct gd_point places[PLACES];
static struct gd_curve open_line, closed_line, around;
static struct gd_spline spline;
static const struct gd_spline_request request = {.points = places, .count = 3, .alpha = 0.5};

static struct gd_curve resolve(const struct gd_mesh *on, const struct gd_curve_request *wanted)
{
    struct gd_curve curve;
    check_ok(gd_curve_resolve(on, wanted, NULL, &curve, NULL), NULL);
    return curve;
}

static void open_curves(void)
{
    struct gd_polygons polygons, tube;
    struct rng rng = {6};
    check_ok(sample_terrain(10, 0.5, 3, &polygons), NULL);
    check_ok(sample_torus(8, 6, 2, 0.7, &tube), NULL);
    mesh = test_mesh(&polygons);
    ring = test_mesh(&tube);
    for (int i = 0; i < PLACES; i++)
        places[i] = test_point(mesh, test_random_place(&polygons, &rng));
    open_line = resolve(mesh, &(struct gd_curve_request){
                                  .kind = GD_CURVE_POINTS, .points = places, .count = PLACES});
    closed_line = resolve(
        mesh, &(struct gd_curve_request){
                  .kind = GD_CURVE_POINTS, .points = places, .count = PLACES, .closed = true});
    struct gd_point stops[4];
    for (uint32_t i = 0; i < 4; i++)
        stops[i] = test_point(ring, (struct test_place){.face = i * tube.polygon_count / 4,
                                                        .weight = {0.3, 0.3, 0.4}});
    around =
        resolve(ring, &(struct gd_curve_request){
                          .kind = GD_CURVE_POINTS, .points = stops, .count = 4, .closed = true});
    check_ok(gd_spline_build(mesh, &request, NULL, &spline, NULL), NULL);
    gd_polygons_free(&polygons);
    gd_polygons_free(&tube);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void digest_spline(struct digest *digest, const void *out)
{
    const struct gd_spline *made = out;
    for (uint32_t i = 0; i < made->count; i++)
        for (int k = 0; k < 3; k++) digest_path(digest, &made->segments[i].arms[k]);
}

static void discard_spline(void *out)
{
    gd_spline_free(out);
}

static void digest_line(struct digest *digest, const void *out)
{
    const struct gd_spline_line *line = out;
    digest_path(digest, &line->path);
    for (uint32_t i = 0; i < line->count; i++) digest_number(digest, line->places[i].speed);
}

static void discard_line(void *out)
{
    gd_spline_line_free(out);
}

static void digest_resolved(struct digest *digest, const void *out)
{
    digest_curve(digest, out);
}

static void discard_resolved(void *out)
{
    gd_curve_free(out);
}

static void digest_shortened(struct digest *digest, const void *out)
{
    const struct gd_shortening *shortened = out;
    digest_curve(digest, &shortened->curve);
    digest_number(digest, shortened->turn);
}

static void discard_shortened(void *out)
{
    gd_shortening_free(out);
}

static void digest_resampled(struct digest *digest, const void *out)
{
    const struct gd_resampling *resampled = out;
    digest_curve(digest, &resampled->curve);
    digest_path(digest, &(struct gd_path){.count = resampled->count, .points = resampled->points});
}

static void discard_resampled(void *out)
{
    gd_resampling_free(out);
}

static void digest_isoline(struct digest *digest, const void *out)
{
    const struct gd_isoline *found = out;
    for (uint32_t i = 0; i < found->line_count; i++) digest_number(digest, found->lines[i].length);
}

static void discard_isoline(void *out)
{
    gd_isoline_free(out);
}

static void digest_cut(struct digest *digest, const void *out)
{
    const struct gd_cut *cut = out;
    for (uint32_t i = 0; i < cut->piece_count; i++) {
        const struct gd_cut_piece *piece = &cut->pieces[i];
        const struct gd_polygons *p = &piece->polygons;
        digest_number(digest, piece->area);
        digest_bytes(digest, piece->face_map, piece->face_count * sizeof *piece->face_map);
        if (p->positions)
            digest_bytes(digest, p->positions, p->position_count * sizeof *p->positions);
    }
}

static void discard_cut(void *out)
{
    gd_cut_free(out);
}

static const struct answer a_spline = {sizeof(struct gd_spline), digest_spline, discard_spline};
static const struct answer a_line = {sizeof(struct gd_spline_line), digest_line, discard_line};
static const struct answer a_curve = {sizeof(struct gd_curve), digest_resolved, discard_resolved};
static const struct answer a_shortening = {sizeof(struct gd_shortening), digest_shortened,
                                           discard_shortened};
static const struct answer a_resampling = {sizeof(struct gd_resampling), digest_resampled,
                                           discard_resampled};
static const struct answer an_isoline = {sizeof(struct gd_isoline), digest_isoline,
                                         discard_isoline};
static const struct answer a_cut = {sizeof(struct gd_cut), digest_cut, discard_cut};

/* --- calls ------------------------------------------------------------------------------------ */

static enum gd_status build_spline(void *out)
{
    struct gd_detail detail = {0};
    return gd_spline_build(mesh, &request, NULL, out, &detail);
}

static enum gd_status build_by_the_paper(void *out)
{
    struct gd_spline_request other = request;
    other.tangent_rule = GD_TANGENT_PAPER;
    other.closed = true;
    return gd_spline_build(mesh, &other, NULL, out, NULL);
}

static enum gd_status sample(struct gd_spline_sampling how, void *out)
{
    struct gd_detail detail = {0};
    how.spline = &spline;
    return gd_spline_sample(mesh, &how, NULL, out, &detail);
}

static enum gd_status sample_steps(void *out)
{
    return sample((struct gd_spline_sampling){.per_segment = 4}, out);
}

static enum gd_status sample_evenly(void *out)
{
    return sample((struct gd_spline_sampling){.even = 7}, out);
}

static enum gd_status sample_to_tolerance(void *out)
{
    return sample((struct gd_spline_sampling){.tolerance = 0.02}, out);
}

static enum gd_status sample_parameters(void *out)
{
    double parameters[2] = {spline.segments[0].begin, spline.segments[0].end};
    return sample((struct gd_spline_sampling){.parameters = parameters, .count = 2}, out);
}

static enum gd_status spline_as_curve(void *out)
{
    struct gd_spline_request other = request;
    other.sampling = &(struct gd_spline_sampling){.per_segment = 3};
    return gd_spline_curve(mesh, &other, NULL, out, NULL);
}

static enum gd_status shorten_open(void *out)
{
    return gd_curve_shorten(mesh, &(struct gd_shortening_request){&open_line, 2, 4}, NULL, out,
                            NULL);
}

static enum gd_status shorten_closed(void *out)
{
    return gd_curve_shorten(ring, &(struct gd_shortening_request){&around, 3, 0}, NULL, out, NULL);
}

static enum gd_status straighten_closed(void *out)
{
    return gd_curve_shorten(ring, &(struct gd_shortening_request){&around, 0, 0}, NULL, out, NULL);
}

static enum gd_status resample(void *out)
{
    return gd_curve_resample(mesh, &(struct gd_resampling_request){&open_line, 6}, NULL, out, NULL);
}

static enum gd_status offset(void *out)
{
    return gd_curve_offset(mesh, &(struct gd_offset_request){&open_line, 0.1}, NULL, out, NULL);
}

static enum gd_status cut(const struct gd_cut_request *wanted, void *out)
{
    struct gd_detail detail = {0};
    return gd_cut_along(mesh, wanted, NULL, out, &detail);
}

static enum gd_status cut_all(void *out)
{
    return cut(&(struct gd_cut_request){.curve = &closed_line}, out);
}

static enum gd_status cut_inside(void *out)
{
    return cut(
        &(struct gd_cut_request){.curve = &closed_line, .inside = &(struct gd_point){.element = 0}},
        out);
}

static enum gd_status cut_select(void *out)
{
    return cut(&(struct gd_cut_request){.curve = &closed_line, .select_only = true}, out);
}

static enum gd_status cut_open(void *out)
{
    return gd_cut_along(ring, &(struct gd_cut_request){.curve = &around}, NULL, out, NULL);
}

static const struct operation items[] = {
    {"spline", &a_spline, build_spline, GD_OK, NULL},
    {"closed spline by the paper", &a_spline, build_by_the_paper, GD_OK, NULL},
    {"spline in steps", &a_line, sample_steps, GD_OK, NULL},
    {"spline evenly", &a_line, sample_evenly, GD_OK, NULL},
    {"spline to a tolerance", &a_line, sample_to_tolerance, GD_OK, NULL},
    {"spline at parameters", &a_line, sample_parameters, GD_OK, NULL},
    {"spline as a curve", &a_curve, spline_as_curve, GD_OK, NULL},
    {"shortening, open", &a_shortening, shorten_open, GD_OK, NULL},
    {"shortening, closed", &a_shortening, shorten_closed, GD_OK, NULL},
    {"closed geodesic", &a_shortening, straighten_closed, GD_OK, NULL},
    {"resampling", &a_resampling, resample, GD_OK, NULL},
    {"offset", &an_isoline, offset, GD_OK, NULL},
    {"cut", &a_cut, cut_all, GD_OK, NULL},
    {"cut, one piece", &a_cut, cut_inside, GD_OK, NULL},
    {"cut, selection", &a_cut, cut_select, GD_OK, NULL},
    {"cut that opens", &a_cut, cut_open, GD_OK, NULL},
};

const struct operations curve_operations = {open_curves, items, COUNT(items)};
