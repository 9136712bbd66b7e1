#include "nurbs/answer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nurbs/bspline.h"
#include "nurbs/energy.h"

/* A curve that is not divided into cells is integrated over many short intervals, because the
 * surface is not smooth where its lines cross a span. */
enum { PANELS = 32 };

void gd__answer_free(struct gd_geodesic *geodesic)
{
    for (uint32_t i = 0; i < geodesic->piece_count; i++) {
        free(geodesic->pieces[i].knots);
        free(geodesic->pieces[i].points);
    }
    free(geodesic->pieces);
}

void gd_geodesics_free(struct gd_geodesics *geodesics)
{
    if (!geodesics) return;
    for (uint32_t i = 0; i < geodesics->count; i++) gd__answer_free(&geodesics->items[i]);
    free(geodesics->items);
    *geodesics = (struct gd_geodesics){0};
}

static enum gd_status copy_piece(const struct gd__chain *chain, const struct gd__piece *piece,
                                 struct gd_geodesic_piece *out)
{
    uint32_t points = gd__piece_points(chain, piece), knots = points + chain->degree + 1;
    *out = (struct gd_geodesic_piece){.degree = chain->degree, .count = points};
    out->knots = malloc(knots * sizeof *out->knots);
    out->points = malloc(points * sizeof *out->points);
    if (!out->knots || !out->points) return GD_NO_MEMORY;
    memcpy(out->knots, piece->knots, knots * sizeof *out->knots);
    memcpy(out->points, piece->points, points * sizeof *out->points);
    return GD_OK;
}

static enum gd_status copy_pieces(const struct gd__candidate *candidate, struct gd_geodesic *out)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < candidate->parts; i++) count += candidate->part[i].chain->piece_count;
    out->pieces = calloc(count, sizeof *out->pieces);
    enum gd_status status = out->pieces ? GD_OK : GD_NO_MEMORY;
    for (uint32_t i = 0; i < candidate->parts && !status; i++) {
        const struct gd__chain *chain = candidate->part[i].chain;
        for (uint32_t k = 0; k < chain->piece_count && !status; k++)
            status = copy_piece(chain, &chain->pieces[k], &out->pieces[out->piece_count++]);
    }
    return status;
}

/* Computes length, curvature and speed defect of all pieces. */
static void answer_measure(const struct gd__candidate *candidate, struct gd_geodesic *out)
{
    double uneven = 0;
    for (uint32_t i = 0; i < candidate->parts; i++) {
        const struct gd__chain *chain = candidate->part[i].chain;
        for (uint32_t k = 0; k < chain->piece_count; k++) {
            const struct gd__piece *piece = &chain->pieces[k];
            double length = 0;
            for (uint32_t span = 0; span < piece->spans; span++) {
                double bend, part;
                gd__energy_bend(chain, piece, span, &bend, &part);
                out->curvature += bend;
                length += piece->whole
                              ? gd__energy_length(chain, piece, span, GD__GAUSS_LEAST, PANELS)
                              : part;
            }
            out->length += length;
            uneven += fabs(2 * gd__energy_value(chain, piece) - length * length);
        }
    }
    out->speed_defect = uneven / (out->length * out->length);
}

/* Computes the parameter and the angle at an end of the path. If the end is a point instead of a
 * curve, they are 0 and pi / 2. */
static void set_end(const struct gd__chain *chain, int side, double *parameter, double *angle)
{
    const struct gd__joint *joint = &chain->joints[side ? chain->piece_count : 0];
    *parameter = 0;
    *angle = M_PI_2;
    if (!joint->curve) return;
    struct gd__curve_jet c;
    struct gd_jet x;
    bool is_pole = joint->kind == GD__JOINT_LINE;
    double turns, at = is_pole ? joint->passes : joint->at;
    struct gd_vec3 path = gd__chain_velocity(chain, side, &x);
    if (is_pole) {
        gd__curve_jet(joint->curve, at, &c);
        gd__surface_at(chain->surface, c.at, &x);
    } else {
        gd__joint_jet(joint, at, &c);
    }
    struct gd_vec3 curve = gd__velocity(&x, c.first);
    *parameter = gd__curve_reduce(joint->curve, at, &turns);
    *angle = atan2(gd_vec3_length(gd_vec3_cross(path, curve)), gd_vec3_dot(path, curve));
}

static void set_verdict(const struct gd__candidate *candidate, struct gd_geodesic *out)
{
    out->is_minimum = gd__candidate_is_minimum(candidate);
    if (!out->is_minimum) out->warnings |= GD_GEODESIC_NOT_MINIMAL;
    if (candidate->parts > 1) out->warnings |= GD_GEODESIC_THROUGH_POLE;
    if (candidate->is_family) out->warnings |= GD_GEODESIC_FAMILY;
    for (uint32_t i = 0; i < candidate->parts; i++) {
        const struct gd__solution *part = &candidate->part[i];
        out->error += part->error;
        out->iterations += part->iterations;
        out->residual = fmax(out->residual, sqrt(2 * part->report.decrement));
        if (!part->converged) out->warnings |= GD_GEODESIC_NOT_CONVERGED;
        if (part->report.contact) out->warnings |= GD_GEODESIC_BOUNDARY_CONTACT;
        if (part->corner) out->warnings |= GD_GEODESIC_CURVE_CORNER;
        if (part->report.flat) out->warnings |= GD_GEODESIC_FAMILY;
    }
}

enum gd_status gd__answer_make(const struct gd__candidate *candidate,
                               const struct gd_domain_curve *const ends[2], struct gd_geodesic *out)
{
    struct gd_geodesic answer = {0};
    enum gd_status status = copy_pieces(candidate, &answer);
    const struct gd__pace *pace = candidate->part[0].chain->pace;
    if (!status) answer_measure(candidate, &answer);
    if (!status) status = pace->status;
    if (status) {
        gd__answer_free(&answer);
        return status;
    }
    set_end(candidate->part[0].chain, 0, &answer.from_parameter, &answer.from_angle);
    set_end(candidate->part[candidate->parts - 1].chain, 1, &answer.to_parameter, &answer.to_angle);
    gd__candidate_turns(candidate, ends, answer.turns);
    set_verdict(candidate, &answer);
    *out = answer;
    return GD_OK;
}

static void piece_place(const struct gd_geodesic_piece *piece, double t, double at[2])
{
    struct gd__basis basis;
    uint32_t span = gd__basis_span(piece->degree, piece->count, piece->knots, t);
    gd__basis(piece->degree, piece->knots, span, t, &basis);
    at[0] = at[1] = 0;
    gd__basis_sum(piece->degree, basis.value,
                  (const double(*)[2])piece->points + (span - piece->degree), at);
}

enum gd_status gd_geodesic_sample(const struct gd_parametric *surface,
                                  const struct gd_geodesic *geodesic, uint32_t count,
                                  double (*uv)[2], struct gd_vec3 *xyz)
{
    if (count < 2 || !geodesic->piece_count) return GD_INVALID_ARGUMENT;
    for (uint32_t i = 0; i < count; i++) {
        double place = (double)i / (count - 1) * geodesic->piece_count, at[2];
        uint32_t piece =
            place < geodesic->piece_count ? (uint32_t)place : geodesic->piece_count - 1;
        piece_place(&geodesic->pieces[piece], place - piece, at);
        /* rounding may move the control point slightly beyond the border */
        for (int k = 0; k < 2; k++) {
            const struct gd_axis *axis = surface->axis[k];
            if (!axis->closed) at[k] = fmin(fmax(at[k], axis->low), axis->high);
        }
        if (uv) memcpy(uv[i], at, sizeof at);
        if (xyz) xyz[i] = gd__surface_position(surface, at);
    }
    return GD_OK;
}
