#include "nurbs/chain.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/tolerance.h"
#include "nurbs/bspline.h"

static size_t piece_bytes(uint32_t degree, uint32_t spans)
{
    return (spans + 1 + 2 * degree) * sizeof(double) + (spans + degree) * sizeof(double[2]) +
           spans * (degree + 2) * sizeof(struct gd__node);
}

size_t gd__chain_bytes(uint32_t degree, uint32_t piece_count, const uint32_t *spans)
{
    size_t bytes = sizeof(struct gd__chain) + sizeof(struct gd__joint);
    for (uint32_t i = 0; i < piece_count; i++)
        bytes +=
            sizeof(struct gd__piece) + sizeof(struct gd__joint) + piece_bytes(degree, spans[i]);
    return bytes;
}

static char *chain_carve(char **at, size_t bytes)
{
    char *begin = *at;
    *at += bytes;
    return begin;
}

struct gd__chain *gd__chain_create(const struct gd_parametric *surface, struct gd__pace *pace,
                                   uint32_t degree, uint32_t piece_count, const uint32_t *spans)
{
    char *at = calloc(1, gd__chain_bytes(degree, piece_count, spans));
    if (!at) return NULL;
    struct gd__chain *chain = (void *)chain_carve(&at, sizeof *chain);
    *chain = (struct gd__chain){
        .surface = surface, .degree = degree, .piece_count = piece_count, .pace = pace};
    chain->pieces = (void *)chain_carve(&at, piece_count * sizeof *chain->pieces);
    chain->joints = (void *)chain_carve(&at, (piece_count + 1) * sizeof *chain->joints);
    for (uint32_t i = 0; i < piece_count; i++) {
        struct gd__piece *piece = &chain->pieces[i];
        uint32_t knots = spans[i] + 1 + 2 * degree;
        piece->spans = spans[i];
        piece->knots = (void *)chain_carve(&at, knots * sizeof *piece->knots);
        piece->points = (void *)chain_carve(&at, (spans[i] + degree) * sizeof *piece->points);
        piece->nodes = (void *)chain_carve(&at, spans[i] * (degree + 2) * sizeof *piece->nodes);
        for (uint32_t k = 0; k < knots; k++)
            piece->knots[k] = k < degree              ? 0
                              : k > degree + spans[i] ? 1
                                                      : (double)(k - degree) / spans[i];
    }
    return chain;
}

void gd__chain_prepare(struct gd__chain *chain)
{
    int gauss = gd__chain_gauss(chain);
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        struct gd__piece *piece = &chain->pieces[i];
        for (uint32_t span = 0; span < piece->spans; span++) {
            const double *knot = piece->knots + chain->degree + span;
            for (int g = 0; g < gauss; g++) {
                struct gd__basis basis;
                double t = knot[0] + (knot[1] - knot[0]) * gd__gauss(gauss)->node[g];
                gd__basis(chain->degree, piece->knots, chain->degree + span, t, &basis);
                struct gd__node *node = &piece->nodes[span * (uint32_t)gauss + (uint32_t)g];
                memcpy(node->value, basis.value, sizeof node->value);
                memcpy(node->first, basis.first, sizeof node->first);
                memcpy(node->second, basis.second, sizeof node->second);
            }
        }
    }
}

struct gd__joint gd__joint_on_line(const struct gd_parametric *surface, int axis,
                                   const double at[2])
{
    const struct gd_axis *along = surface->axis[1 - axis];
    return (struct gd__joint){.kind = GD__JOINT_LINE,
                              .at = at[1 - axis],
                              .low = along->closed ? -INFINITY : along->low,
                              .high = along->closed ? INFINITY : along->high,
                              .axis = axis,
                              .value = at[axis]};
}

void gd__joint_jet(const struct gd__joint *joint, double at, struct gd__curve_jet *out)
{
    *out = (struct gd__curve_jet){0};
    switch (joint->kind) {
    case GD__JOINT_FIXED:
        memcpy(out->at, joint->place, sizeof out->at);
        break;
    case GD__JOINT_CURVE:
        if (joint->whole)
            gd__curve_jet(joint->curve, at, out);
        else
            gd__curve_jet_in(joint->curve, joint->interval, at, out);
        for (int k = 0; k < 2; k++) out->at[k] += joint->place[k];
        break;
    case GD__JOINT_LINE:
        out->at[joint->axis] = joint->value;
        out->at[1 - joint->axis] = at;
        out->first[1 - joint->axis] = 1;
        break;
    }
}

void gd__chain_attach(struct gd__chain *chain)
{
    for (uint32_t i = 0; i <= chain->piece_count; i++) {
        struct gd__curve_jet jet;
        gd__joint_jet(&chain->joints[i], chain->joints[i].at, &jet);
        if (i < chain->piece_count) memcpy(chain->pieces[i].points[0], jet.at, sizeof jet.at);
        if (!i) continue;
        struct gd__piece *before = &chain->pieces[i - 1];
        memcpy(before->points[gd__piece_points(chain, before) - 1], jet.at, sizeof jet.at);
    }
}

static void chain_combine(const struct gd__chain *chain, const double (*points)[2],
                          const double *value, const double *first, const double *second,
                          struct gd__curve_jet *out)
{
    *out = (struct gd__curve_jet){0};
    gd__basis_sum(chain->degree, value, points, out->at);
    gd__basis_sum(chain->degree, first, points, out->first);
    gd__basis_sum(chain->degree, second, points, out->second);
}

void gd__piece_node(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                    int node, struct gd__curve_jet *out)
{
    const struct gd__node *n =
        &piece->nodes[span * (uint32_t)gd__chain_gauss(chain) + (uint32_t)node];
    chain_combine(chain, (const double(*)[2])piece->points + span, n->value, n->first, n->second,
                  out);
}

void gd__piece_at(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                  double t, struct gd__curve_jet *out)
{
    struct gd__basis basis;
    gd__basis(chain->degree, piece->knots, chain->degree + span, t, &basis);
    chain_combine(chain, (const double(*)[2])piece->points + span, basis.value, basis.first,
                  basis.second, out);
}

void gd__piece_jet(const struct gd__chain *chain, const struct gd__piece *piece, const double at[2],
                   struct gd_jet *out)
{
    if (piece->whole)
        gd__surface_at(chain->surface, at, out);
    else
        gd__surface_jet(chain->surface, piece->cell, at, out);
}

struct gd_vec3 gd__chain_velocity(const struct gd__chain *chain, int side, struct gd_jet *x)
{
    const struct gd__piece *piece = &chain->pieces[side ? chain->piece_count - 1 : 0];
    struct gd__curve_jet c;
    gd__piece_at(chain, piece, side ? piece->spans - 1 : 0, side, &c);
    gd__piece_jet(chain, piece, c.at, x);
    return gd__velocity(x, c.first);
}

double gd__chain_rounding(const struct gd__chain *chain)
{
    double sum = 0;
    for (int side = 0; side < 2; side++) {
        const struct gd__joint *joint = &chain->joints[side ? chain->piece_count : 0];
        struct gd__curve_jet c;
        struct gd_jet x;
        gd__joint_jet(joint, joint->at, &c);
        gd__piece_jet(chain, &chain->pieces[side ? chain->piece_count - 1 : 0], c.at, &x);
        sum += 0.5 * DBL_EPSILON *
               (fabs(c.at[0]) * gd_vec3_length(x.u) + fabs(c.at[1]) * gd_vec3_length(x.v));
    }
    return sum;
}

double gd__chain_straying(const struct gd__chain *chain)
{
    const struct gd_parametric *surface = chain->surface;
    double sum = 0, rounding = gd__chain_rounding(chain) + GD_TOL_COINCIDE * surface->size +
                               GD_TOL_LOCATE * surface->farthest;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        const struct gd__piece *piece = &chain->pieces[i];
        for (uint32_t end = 0; end <= piece->spans && !piece->whole; end++) {
            struct gd__curve_jet c;
            struct gd_jet x;
            gd__piece_at(chain, piece, end ? end - 1 : 0, piece->knots[chain->degree + end], &c);
            gd__piece_jet(chain, piece, c.at, &x);
            double apart = gd_vec3_distance(x.x, gd__surface_position(surface, c.at));
            if (apart > rounding) sum += apart;
        }
    }
    return sum;
}

uint32_t gd__chain_spans(const struct gd__chain *chain)
{
    uint32_t spans = 0;
    for (uint32_t i = 0; i < chain->piece_count; i++) spans += chain->pieces[i].spans;
    return spans;
}

/* --- refinement ------------------------------------------------------------------------------- */

/* Inserts the knot t into a clamped B-spline of *count points. The arrays must have room. Boehm
 * 1980; The NURBS Book, section 5.2. */
static void insert_knot(uint32_t degree, double *knots, double (*points)[2], uint32_t *count,
                        double t)
{
    uint32_t span = gd__basis_span(degree, *count, knots, t);
    for (uint32_t i = *count; i > span; i--) memcpy(points[i], points[i - 1], sizeof *points);
    for (uint32_t i = span; i > span - degree; i--) {
        double part = (t - knots[i]) / (knots[i + degree] - knots[i]);
        for (int k = 0; k < 2; k++)
            points[i][k] = part * points[i][k] + (1 - part) * points[i - 1][k];
    }
    memmove(knots + span + 2, knots + span + 1, (*count + degree - span) * sizeof *knots);
    knots[span + 1] = t;
    (*count)++;
}

static void refine_piece(uint32_t degree, const struct gd__piece *from, const bool *marked,
                         struct gd__piece *to)
{
    uint32_t count = from->spans + degree;
    memcpy(to->knots, from->knots, (from->spans + 1 + 2 * degree) * sizeof *to->knots);
    memcpy(to->points, from->points, count * sizeof *to->points);
    to->cell = from->cell;
    to->whole = from->whole;
    for (uint32_t i = 0; i < from->spans; i++) {
        if (!marked[i]) continue;
        const double *knot = from->knots + degree + i;
        insert_knot(degree, to->knots, to->points, &count, 0.5 * (knot[0] + knot[1]));
    }
}

struct gd__chain *gd__chain_refine(const struct gd__chain *chain, const bool *marked)
{
    uint32_t *spans = malloc(chain->piece_count * sizeof *spans);
    if (!spans) return NULL;
    const bool *mark = marked;
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        spans[i] = chain->pieces[i].spans;
        for (uint32_t k = 0; k < chain->pieces[i].spans; k++) spans[i] += *mark++;
    }
    struct gd__chain *finer =
        gd__chain_create(chain->surface, chain->pace, chain->degree, chain->piece_count, spans);
    free(spans);
    if (!finer) return NULL;
    memcpy(finer->joints, chain->joints, (chain->piece_count + 1) * sizeof *chain->joints);
    for (uint32_t i = 0; i < chain->piece_count; i++) {
        refine_piece(chain->degree, &chain->pieces[i], marked, &finer->pieces[i]);
        marked += chain->pieces[i].spans;
    }
    gd__chain_prepare(finer);
    return finer;
}
