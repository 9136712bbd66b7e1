/* NURBS: the object of the kind `nurbs`: a parametric surface, and the tessellation on which its
 * shortest paths are first looked for. */
#ifndef SERVER_SURFACES_NURBS_SURFACE_H
#define SERVER_SURFACES_NURBS_SURFACE_H

#include "gd/tessellation.h"
#include "proto/nurbs.h"

struct server_surface;

struct server_nurbs {
    struct gd_parametric *surface;
    struct proto_nurbs_form form;
    /* NULL: the surface has none (it is flat somewhere, or too large), */
    struct gd_tessellation *tessellation;
    enum gd_status refusal; /* and why */
    struct gd_detail detail;
};

/* That of a surface of this kind; borrowed. */
const struct server_nurbs *server_nurbs_of(const struct server_surface *surface);

#endif
