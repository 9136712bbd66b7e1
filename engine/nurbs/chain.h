/* Chain: a curve in the parameter domain as B-spline pieces. The pieces are joined at the lines of
 * the surface, where the surface is not smooth (gd/parametric.h).
 *
 * DESIGN
 * - Each piece is a clamped B-spline c(t), t in [0, 1], in one smooth cell of the surface; only a
 *   `whole` piece may cross cells. The first and the last control point of a piece are the places
 *   of the adjacent joints.
 * - A joint is an end of a piece: two pieces meet there, or the path ends. It is fixed, or has one
 *   unknown. At an end of the path on a curve, the unknown is the parameter of that curve. Where
 *   the path crosses a line of the surface, or ends in a pole, it is the coordinate along the line
 *   or along the pole.
 * - The length of the chain is F = sum of sqrt(2 E_k), E_k = 1/2 int |d/dt x(c_k)|^2 dt. For fixed
 *   ends of a piece, E_k is least for the geodesic of constant speed between them, and then sqrt(2
 *   E_k) is the geodesic's length. Therefore the pieces need no common speed, and the minimum of F
 *   over control points and joints is the shortest path. With one piece it is the minimum of the
 *   paper's energy.
 * - In closed directions coordinates may leave [low, high]. */
#pragma once

#include "gd/control.h"
#include "gd/geodesic_like.h"
#include "nurbs/curve.h"
#include "nurbs/gauss.h"
#include "base/pace.h"

#define GD__CHAIN_DEGREE_MOST GD_GEODESIC_DEGREE_MOST
#define GD__CHAIN_ORDER_MOST  (GD__CHAIN_DEGREE_MOST + 1)

enum gd__joint_kind { GD__JOINT_FIXED, GD__JOINT_CURVE, GD__JOINT_LINE };

struct gd__joint {
    enum gd__joint_kind kind;
    double at;        /* the unknown: parameter on the curve, or coordinate along the line */
    double low, high; /* bounds of `at`, which may be infinite */
    /* For GD__JOINT_FIXED, the joint's place. For GD__JOINT_CURVE, the whole periods that are added
       to the curve's places. */
    double place[2];
    /* For GD__JOINT_CURVE, the curve (borrowed). If `whole` is true, the joint can be anywhere on
       the curve. Otherwise only the polynomial of `interval` is used. */
    const struct gd_domain_curve *curve;
    uint32_t interval;
    bool whole;
    /* For GD__JOINT_LINE, coordinate `axis` has the constant `value`. If the line is a pole that a
       curve passes, `curve` is this curve and `passes` its parameter at the pole. Otherwise `curve`
       is NULL. */
    int axis;
    double value, passes;
};

/* The basis functions that do not vanish at a quadrature node, with derivatives. */
struct gd__node {
    double value[GD__CHAIN_ORDER_MOST], first[GD__CHAIN_ORDER_MOST], second[GD__CHAIN_ORDER_MOST];
};

struct gd__piece {
    struct gd__cell cell;
    bool whole; /* true if the piece crosses cells; `cell` is then unused */
    uint32_t spans;
    double *knots;          /* spans + 1 + 2 degree knots, clamped */
    double (*points)[2];    /* spans + degree control points */
    struct gd__node *nodes; /* one for each quadrature point of each span */
};

struct gd__chain {
    const struct gd_parametric *surface; /* borrowed */
    uint32_t degree, piece_count;
    struct gd__piece *pieces;
    struct gd__joint *joints; /* piece_count + 1 */
    struct gd__pace *pace;    /* borrowed; counts the steps of loops over spans */
};

static inline uint32_t gd__piece_points(const struct gd__chain *chain,
                                        const struct gd__piece *piece)
{
    return piece->spans + chain->degree;
}

static inline int gd__chain_gauss(const struct gd__chain *chain)
{
    return (int)chain->degree + 2;
}

/* Creates a chain with spans[i] spans in piece i, evenly spaced knots, and zero points. The chain
 * is one block, to be freed by free(). Returns NULL if memory is exhausted. */
struct gd__chain *gd__chain_create(const struct gd_parametric *surface, struct gd__pace *pace,
                                   uint32_t degree, uint32_t piece_count, const uint32_t *spans);

/* Returns the size of such a chain in bytes. */
size_t gd__chain_bytes(uint32_t degree, uint32_t piece_count, const uint32_t *spans);

/* Computes the quadrature nodes from the knots. */
void gd__chain_prepare(struct gd__chain *chain);

/* Returns a joint that can move along a line of the domain. The line passes through the place `at`,
 * and coordinate `axis` is constant on it. */
struct gd__joint gd__joint_on_line(const struct gd_parametric *surface, int axis,
                                   const double at[2]);

/* Computes the place of a joint for the value `at` of its unknown, and the first two derivatives by
 * the unknown. */
void gd__joint_jet(const struct gd__joint *joint, double at, struct gd__curve_jet *out);

/* Sets the pieces' end points to the joints' places. */
void gd__chain_attach(struct gd__chain *chain);

/* Computes c, c', c'' of a piece at a node of a span. */
void gd__piece_node(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                    int node, struct gd__curve_jet *out);

/* Computes c, c', c'' of a piece at the parameter t in a span. */
void gd__piece_at(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                  double t, struct gd__curve_jet *out);

/* Computes the surface's jet at a place, in the piece's cell. */
void gd__piece_jet(const struct gd__chain *chain, const struct gd__piece *piece, const double at[2],
                   struct gd_jet *out);

/* Returns the velocity in space at the beginning (side 0) or the end (side 1) of a chain. Sets *x
 * to the surface's jet there. */
struct gd_vec3 gd__chain_velocity(const struct gd__chain *chain, int side, struct gd_jet *x);

/* Returns the error of the chain's length due to the rounding of its ends' coordinates. */
double gd__chain_rounding(const struct gd__chain *chain);

/* Returns the error of the chain's length because its pieces leave their cells by up to
 * GD_TOL_CELL: the sum of the distances in space between the ends of spans, computed in the piece's
 * cell, and the surface. Rounding errors do not count. The sum is 0 if the surface's parameters are
 * smooth across the lines. */
double gd__chain_straying(const struct gd__chain *chain);

/* Returns the total number of spans. */
uint32_t gd__chain_spans(const struct gd__chain *chain);

/* Returns a chain for the same curve with the marked spans halved; `marked` has an item for each
 * span, in the order of the pieces. Returns NULL if memory is exhausted. */
struct gd__chain *gd__chain_refine(const struct gd__chain *chain, const bool *marked);

/* Returns the velocity d/dt x(c), from the jet of a place. */
static inline struct gd_vec3 gd__velocity(const struct gd_jet *x, const double first[2])
{
    return gd_vec3_along(gd_vec3_scale(x->u, first[0]), first[1], x->v);
}

/* Returns the acceleration d^2/dt^2 x(c), by the chain rule. */
static inline struct gd_vec3 gd__acceleration(const struct gd_jet *x, const struct gd__curve_jet *c)
{
    struct gd_vec3 a = gd__velocity(x, c->second);
    a = gd_vec3_along(a, c->first[0] * c->first[0], x->uu);
    a = gd_vec3_along(a, 2 * c->first[0] * c->first[1], x->uv);
    return gd_vec3_along(a, c->first[1] * c->first[1], x->vv);
}
