/* Domain curve: a curve in the parameter domain of a surface, in a request:
 *
 *     {"polyline": [[u, v]…], "closed"?}
 *     | {"bspline": {"degree", "knots", "control_points"}, "closed"?}
 *     | {"iso": "u" | "v", "value", "range"?}
 *
 * Its parameter is: along a polyline the number of the corner, of a B-spline its knots', of an iso
 * line the other coordinate. */
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

struct proto_domain_curve { /* all zero: none */
    enum proto_domain_curve_kind kind;
    struct proto_uvs points; /* the point, the corners, the control points */
    uint32_t degree;
    double *knots;
    uint32_t knot_count;
    bool wants_closed; /* "closed": true */
    enum gd_iso fixed;
    double value, range[2];
    bool has_range;
    char place[32]; /* in the request */
};

/* The curve, or the point [u, v], that is the document's member. invalid_request, too_large,
 * insufficient_memory. Freed by proto_domain_curve_free. */
bool proto_domain_curve_decode(const json_t *document, const char *member,
                               struct proto_domain_curve *out, struct proto_problem *problem);
bool proto_domain_curve_decode_point(const json_t *document, const char *member,
                                     struct proto_domain_curve *out, struct proto_problem *problem);
void proto_domain_curve_free(struct proto_domain_curve *curve); /* a second time is harmless */

/* The curve on its surface. A polyline that is to be closed and is not gets its first corner again
 * at its end. invalid_request; point_not_on_surface (with the point that lies outside the domain);
 * insufficient_memory; what `control`, which may be NULL, says. The caller releases
 * `*out`. Cost: some 30 evaluations a span, and 60 for each line of the surface that is crossed. */
bool proto_domain_curve_locate(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct proto_problem *problem);

#endif
