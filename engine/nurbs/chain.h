/* Chain: a curve in the parameter domain as B-spline pieces joined at the lines of the surface.
 *
 * DESIGN
 * - Each piece is a clamped B-spline c(t), t in [0, 1], that lies in one smooth cell of the surface
 *   (or, while it is `whole`, in any). Its first and last control points are the places of the
 *   joints around it.
 * - A joint is fixed, or has one unknown: the parameter on a curve that the path begins or ends on,
 *   or the coordinate along a line of the surface that it crosses there (also along a pole that it
 *   ends in).
 * - The length of the chain is F = sum of sqrt(2 E_k), E_k = 1/2 int |d/dt x(c_k)|^2 dt: for given
 *   ends of the piece E_k is least for the geodesic between them at constant speed, and then sqrt(2
 *   E_k) is its length. So the pieces need no common speed, and the minimum of F over control
 *   points and joints is the shortest path. With one piece it is the energy of the paper.
 * - Coordinates of closed directions go on beyond [low, high]. */
#ifndef GD_NURBS_CHAIN_H
#define GD_NURBS_CHAIN_H

#include "gd/control.h"
#include "gd/geodesic_like.h"
#include "nurbs/curve.h"
#include "nurbs/gauss.h"
#include "nurbs/watch.h"

#define GD__CHAIN_DEGREE_MOST GD_GEODESIC_DEGREE_MOST
#define GD__CHAIN_ORDER_MOST  (GD__CHAIN_DEGREE_MOST + 1)

enum gd__joint_kind { GD__JOINT_FIXED, GD__JOINT_CURVE, GD__JOINT_LINE };

struct gd__joint {
    enum gd__joint_kind kind;
    double at;        /* the unknown: parameter on the curve, coordinate along the line */
    double low, high; /* its bounds, maybe infinite */
    /* FIXED: the place. CURVE: added to the curve's places, whole periods. */
    double place[2];
    /* CURVE: by the polynomial of one interval, or, where `whole`, by all of the curve.
       Borrowed. */
    const struct gd_domain_curve *curve;
    uint32_t interval;
    bool whole;
    /* LINE: coordinate `axis` is `value`. In a pole that a curve (`curve`, else NULL) passes: the
     * curve's parameter there. */
    int axis;
    double value, passes;
};

/* The functions that do not vanish at a quadrature node. */
struct gd__node {
    double value[GD__CHAIN_ORDER_MOST], first[GD__CHAIN_ORDER_MOST], second[GD__CHAIN_ORDER_MOST];
};

struct gd__piece {
    struct gd__cell cell;
    bool whole; /* `cell` does not count */
    uint32_t spans;
    double *knots;          /* spans + 1 + 2 degree, clamped */
    double (*points)[2];    /* spans + degree */
    struct gd__node *nodes; /* spans * gauss points */
};

struct gd__chain {
    const struct gd_parametric *surface; /* borrowed */
    uint32_t degree, piece_count;
    struct gd__piece *pieces;
    struct gd__joint *joints; /* piece_count + 1 */
    struct gd__watch *watch;  /* borrowed: what goes through all spans looks at it */
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

/* A chain with room for pieces of so many spans each, in one block: even knots, points zero. NULL:
 * no memory. Free it by free(). */
struct gd__chain *gd__chain_create(const struct gd_parametric *surface, struct gd__watch *watch,
                                   uint32_t degree, uint32_t piece_count, const uint32_t *spans);

/* Bytes of such a chain. */
size_t gd__chain_bytes(uint32_t degree, uint32_t piece_count, const uint32_t *spans);

/* Fills the nodes from the knots; once they are set. */
void gd__chain_prepare(struct gd__chain *chain);

/* Place of a joint and its two derivatives by the unknown. */
void gd__joint_jet(const struct gd__joint *joint, double at, struct gd__curve_jet *out);

/* Sets the pieces' end points to the joints' places. */
void gd__chain_attach(struct gd__chain *chain);

/* c, c', c'' of a piece at a node of a span. */
void gd__piece_node(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                    int node, struct gd__curve_jet *out);

/* ... and at t in a span. */
void gd__piece_at(const struct gd__chain *chain, const struct gd__piece *piece, uint32_t span,
                  double t, struct gd__curve_jet *out);

/* The surface there, as the piece sees it. */
void gd__piece_jet(const struct gd__chain *chain, const struct gd__piece *piece, const double at[2],
                   struct gd_jet *out);

/* Velocity in space at the beginning (side 0) or the end (1) of a chain, and the place. */
struct gd_vec3 gd__chain_velocity(const struct gd__chain *chain, int side, struct gd_jet *x);

/* How far the chain's ends may be off because their coordinates are rounded, in sum. */
double gd__chain_rounding(const struct gd__chain *chain);

/* Total number of spans. */
uint32_t gd__chain_spans(const struct gd__chain *chain);

/* A chain for the same curve with the marked spans (in order through all pieces) halved. NULL: no
 * memory. */
struct gd__chain *gd__chain_refine(const struct gd__chain *chain, const bool *marked);

/* d/dt x(c): the velocity from a place's jet. */
static inline struct gd_vec3 gd__velocity(const struct gd_jet *x, const double first[2])
{
    return gd_vec3_along(gd_vec3_scale(x->u, first[0]), first[1], x->v);
}

#endif
