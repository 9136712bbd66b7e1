/* Connect: converts a control mesh to a net, and validates that the mesh is a manifold. */
#pragma once

#include "subdiv/net.h"

/* A side, and its edge as a sort key. */
struct gd__edge_key {
    uint64_t key; /* lower vertex << 32 | higher */
    uint32_t side;
};

struct gd__connecting {
    struct gd__arena *arena;    /* the arrays of the net */
    struct gd__arena scratch;   /* freed by the caller, also after a failure */
    struct gd__edge_key *edges; /* all sides, sorted by edge; set by gd__net_connect */
};

/* Creates the net without tags: points, faces, twins, and an infinitely sharp boundary. If all
 * faces have `arity` (4 or 3) corners, the net has no `first`. Errors: those of
 * gd_subdivision_create that concern points and faces. */
GD_MUST_USE enum gd_status gd__net_connect(const struct gd_polygons *polygons, uint32_t arity,
                                           struct gd__connecting *connecting, struct gd__net *net,
                                           struct gd_detail *detail);

/* Applies the tags and the boundary rule to a net of gd__net_connect. Errors: those of
 * gd_subdivision_create that concern tags. */
GD_MUST_USE enum gd_status gd__apply_tags(const struct gd_control_mesh *mesh,
                                          struct gd__connecting *connecting, struct gd__net *net,
                                          struct gd_detail *detail);
