/* Picture nets: layers of a figure that show how a smooth surface is made: lines of constant
 * parameters, other curves in the domain, and control nets. */
#ifndef SERVER_API_SURFACES_PICTURE_NETS_H
#define SERVER_API_SURFACES_PICTURE_NETS_H

#include "server/api/surfaces/picture_drawing.h"

/* Draw layer i. On failure return false with the problem. The problem's pointer is relative to the
 * body of the layer, or, for a curve, to an object with the member "curve". Only NURBS surfaces
 * have a domain. */
bool server_domain_curve_draw(struct server_picture_layers *layers, struct server_query *query,
                              uint32_t i);
bool server_isoparametric_draw(struct server_picture_layers *layers, struct server_query *query,
                               uint32_t i);
bool server_control_net_draw(struct server_picture_layers *layers, struct server_query *query,
                             uint32_t i);

#endif
