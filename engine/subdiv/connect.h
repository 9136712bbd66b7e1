/* Connect: a control mesh becomes a net, if it is a surface. */
#ifndef GD_SUBDIV_CONNECT_H
#define GD_SUBDIV_CONNECT_H

#include "subdiv/net.h"

/* A side under its edge. */
struct gd__edge_key {
    uint64_t key; /* lower vertex << 32 | higher */
    uint32_t side;
};

/* Makes the net without tags: points, faces, twins, the boundary infinitely sharp. `edges` gets all
 * sides sorted by edge; the caller frees it, and `*net`. `arity` is 4 or 3, what all faces must
 * have for the net to have no `first`. Errors: those of gd_subdivision_create that concern points
 * and faces. */
GD_MUST_USE enum gd_status gd__net_connect(const struct gd_polygons *polygons, uint32_t arity,
                                           struct gd__net *net, struct gd__edge_key **edges,
                                           struct gd_detail *detail);

/* Writes the tags and the boundary rule into a net that gd__net_connect made. Errors: those of
 * gd_subdivision_create that concern tags. */
GD_MUST_USE enum gd_status gd__apply_tags(const struct gd_control_mesh *mesh,
                                          const struct gd__edge_key *edges, struct gd__net *net,
                                          struct gd_detail *detail);

#endif
