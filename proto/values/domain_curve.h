/* Domain curve: a polyline, a B-spline or an iso line in the parameter domain of a surface. On a
 * polyline, the parameter is the number of the corner. On a B-spline, the knots give the parameter.
 * On an iso line, the parameter is the coordinate that is not constant. struct proto_domain_curve
 * is in generated/requests.h. */
#pragma once

#include "gd/domain_curve.h"
#include "generated/requests.h"

/* Decode the document's member: a curve or a point [u, v], which becomes the form
 * PROTO_DOMAIN_CURVE_POINT with one item in `polyline`. Problems: invalid_request, too_large,
 * insufficient_memory. The caller frees the result by proto_domain_curve_free. */
bool proto_domain_curve_decode_member(const json_t *document, const char *member,
                                      struct proto_domain_curve *out,
                                      struct proto_problem *problem);
bool proto_domain_curve_decode_point(const json_t *document, const char *member,
                                     struct proto_domain_curve *out, struct proto_problem *problem);

/* Creates the curve on its surface. If the request closes an open polyline, the first corner is
 * appended. Problems: invalid_request; point_not_on_surface (with the point outside the domain);
 * insufficient_memory; those of `control`, which may be NULL. The caller releases `*out`. Cost:
 * about 30 evaluations for each span, and 60 for each crossing of a line where the surface is not
 * smooth. */
bool proto_domain_curve_locate(const struct gd_parametric *surface,
                               const struct proto_domain_curve *curve,
                               const struct gd_control *control, struct gd_domain_curve **out,
                               struct proto_problem *problem);
