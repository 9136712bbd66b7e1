/* Domain curve: a polyline, a B-spline or an iso line in the parameter domain of a surface. It is
 * parametrized by the corners' numbers, by the knots, or by the other coordinate. */
#ifndef PROTO_DOMAIN_CURVE_H
#define PROTO_DOMAIN_CURVE_H

#include "gd/domain_curve.h"
#include "proto/values/uv.h"

#define PROTO_DOMAIN_CURVE_POINTS 4096 /* most corners or control points of a curve */

enum proto_domain_curve_kind {
    PROTO_DOMAIN_CURVE_POINT,
    PROTO_DOMAIN_CURVE_POLYLINE,
    PROTO_DOMAIN_CURVE_BSPLINE,
    PROTO_DOMAIN_CURVE_ISO
};

struct proto_domain_curve { /* all zero: no curve */
    enum proto_domain_curve_kind kind;
    struct proto_uvs points; /* the point, the corners or the control points */
    uint32_t degree;
    double *knots;
    uint32_t knot_count;
    bool wants_closed; /* "closed": true */
    enum gd_iso fixed;
    double value, range[2];
    bool has_range;
    char place[32]; /* its place in the request */
};

/* Decodes the document's member: a curve or a point [u, v]. Problems: invalid_request, too_large,
 * insufficient_memory. Freed by proto_domain_curve_free. */
bool proto_domain_curve_decode(const json_t *document, const char *member,
                               struct proto_domain_curve *out, struct proto_problem *problem);
bool proto_domain_curve_decode_point(const json_t *document, const char *member,
                                     struct proto_domain_curve *out, struct proto_problem *problem);
void proto_domain_curve_free(struct proto_domain_curve *curve); /* may be called again */

/* Lays the curve on its surface. An open polyline that is to be closed gets its first corner
 * appended. Problems: invalid_request; point_not_on_surface (with the point outside the domain);
 * insufficient_memory; those of `control`, which may be NULL. The caller releases `*out`. Cost:
 * some 30 evaluations a span, and 60 for each line of the surface that is crossed. */
bool proto_domain_curve_locate(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct proto_problem *problem);

#endif
